//! What a command promised, beside what came.

use super::{
    kit::counted,
    metric::{lengths_as_angles, position},
};
use crate::{series::JointKind, workflow::carried::Held};

/// In a sentence; `None` where nothing was measured. `of` says whose command it was, with a blank in front, `kinds` what its
/// joints are.
pub(super) fn sentence(
    held: &Held,
    kinds: impl Iterator<Item = JointKind> + Clone,
    of: &str,
) -> Option<String> {
    let kept = if held.kept()? { "kept" } else { "not kept" };
    let kind = JointKind::common(kinds.clone());
    let shown = |peak_rad: f64| position(kind, peak_rad);
    let counts = lengths_as_angles(kinds).map_or(String::new(), |counts| format!(" ({counts})"));
    Some(format!(
        "The command{of} promised a mean peak of {} (below {} in nine runs of ten); {} came in {}{counts}: {kept}.",
        shown(held.promised.mean_peak_rad),
        shown(held.promised.mean_peak_margin_rad),
        shown(held.measured_mean_peak_rad?),
        counted(held.transitions, "transition"),
    ))
}
