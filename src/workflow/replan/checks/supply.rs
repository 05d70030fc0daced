//! A supply that gave less than joints asked for together.

use super::{Check, Finding, Level, Replanned};
use crate::fit::Supply;

/// A plan that asks for no more than this share beyond what the pump gives is not told.
const LITTLE: f64 = 0.03;

/// That the pressure fell, where the plan asks the pump for more than it gave, or where nothing tells that it is another plan.
pub(super) fn check(replanned: &Replanned) -> Option<Check> {
    let supply = replanned.fit.supply?;
    let request = replanned.request.as_ref();
    let asked_m3_s = request.and_then(|own| Supply::asked_m3_s(&replanned.plan, own.setup.arm()));
    let asks = asked_m3_s
        .zip(supply.gives_m3_s())
        .map_or(!replanned.retimed, |(asked, gives)| asked > (1.0 + LITTLE) * gives);
    asks.then_some(Check { level: Level::Caution, finding: Finding::Supply { supply, asked_m3_s } })
}
