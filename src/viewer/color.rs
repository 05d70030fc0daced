//! Colours: the first run has those of the arm, each other run one of its own.

use rerun::Color;

/// By run after the first.
const OTHERS: [[u8; 3]; 4] = [[38, 190, 200], [190, 110, 255], [239, 83, 80], [120, 200, 60]];
const FIRST: [u8; 3] = [237, 135, 26];
/// Of joints, in their order; safe for colour-blind readers (Okabe and Ito 2008).
const JOINTS: [[u8; 3]; 7] = [
    [230, 159, 0],
    [86, 180, 233],
    [0, 158, 115],
    [240, 228, 66],
    [100, 143, 255],
    [213, 94, 0],
    [204, 121, 167],
];
const PLANNED: [u8; 3] = [185, 220, 255];
/// Of axes and text.
pub(super) const AXIS: [u8; 3] = [130, 135, 145];

/// Of what is measured in a run; the first has the arm's own paint.
pub(super) fn run(index: usize) -> Color {
    let [r, g, b] = of(index);
    Color::from_rgb(r, g, b)
}

/// Of what is planned in a run: pale.
pub(super) fn planned(index: usize) -> Color {
    let [r, g, b] = if index == 0 { PLANNED } else { of(index).map(|c| 255 - (255 - c) / 3) };
    Color::from_rgb(r, g, b)
}

pub(super) fn joint(index: usize) -> Color {
    let [r, g, b] = JOINTS[index % JOINTS.len()];
    Color::from_rgb(r, g, b)
}

/// Of a solid of the first run: its own.
pub(super) fn own(rgba: [f64; 4]) -> Color {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 255")]
    let [r, g, b, _] = rgba.map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8);
    Color::from_rgb(r, g, b)
}

/// Of solids that others are seen through: those of a ghost (`None`) or of a run.
pub(super) fn clear(run: Option<usize>, opacity: u8) -> Color {
    let [r, g, b] = run.map_or(PLANNED, of);
    Color::from_unmultiplied_rgba(r, g, b, opacity)
}

fn of(run: usize) -> [u8; 3] {
    run.checked_sub(1).map_or(FIRST, |i| OTHERS[i % OTHERS.len()])
}
