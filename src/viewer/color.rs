//! Colours: the first run in the arm's own, others each in one of theirs.

use rerun::Color;

/// By run after the first.
const OTHERS: [[u8; 3]; 4] = [[38, 166, 154], [171, 99, 250], [239, 83, 80], [120, 190, 60]];
/// Of joints, in their order; told apart by people who see few colours (Okabe and Ito 2008).
const JOINTS: [[u8; 3]; 7] = [
    [230, 159, 0],
    [86, 180, 233],
    [0, 158, 115],
    [240, 228, 66],
    [100, 143, 255],
    [213, 94, 0],
    [204, 121, 167],
];
/// Of whatever is planned.
pub(super) const PLANNED: [u8; 3] = [185, 220, 255];

/// Of what is measured in a run; the first has the arm's own paint.
pub(super) fn run(index: usize) -> Color {
    let [r, g, b] = index.checked_sub(1).map_or([237, 135, 26], |i| OTHERS[i % OTHERS.len()]);
    Color::from_rgb(r, g, b)
}

pub(super) fn joint(index: usize) -> Color {
    let [r, g, b] = JOINTS[index % JOINTS.len()];
    Color::from_rgb(r, g, b)
}

/// Of a solid of the measured arm: its own in the first run.
pub(super) fn solid(rgba: [f64; 4], index: usize) -> Color {
    if index > 0 {
        return run(index);
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 255")]
    let [r, g, b, _] = rgba.map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8);
    Color::from_rgb(r, g, b)
}

/// Of a ghost's solids.
pub(super) fn ghost() -> Color {
    let [r, g, b] = PLANNED;
    Color::from_unmultiplied_rgba(r, g, b, 150)
}
