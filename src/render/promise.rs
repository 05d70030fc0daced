//! What a command promised, beside what came.

use super::{kit::counted, metric::Units};
use crate::{series::JointKind, workflow::carried::Held};

/// In a sentence; `None` where nothing was measured. `of` says whose command it was, with a blank in front, `kinds` what its
/// joints are.
pub(super) fn sentence(held: &Held, kinds: impl Iterator<Item = JointKind>, of: &str) -> Option<String> {
    let kept = match (held.kept(), held.promised.promised_transitions) {
        (Some(kept), _) => format!(": {}", if kept { "kept" } else { "not kept" }),
        (None, Some(all)) => format!(" of the {all} that it is for: too few to judge it by"),
        (None, None) => return None,
    };
    let units = Units::of(kinds);
    let shown = |peak_rad: f64| units.mean(peak_rad);
    Some(format!(
        "The command{of} promised a mean peak of {} (below {} in nine runs of ten); {} came in {}{kept}.",
        shown(held.promised.mean_peak_rad),
        shown(held.promised.mean_peak_margin_rad),
        shown(held.measured_mean_peak_rad?),
        counted(held.transitions, "transition"),
    ))
}
