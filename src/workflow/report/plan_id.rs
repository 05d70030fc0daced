//! Which plan a run followed, told by its planned curves: equal from run to run, whatever the phase of the samples.
//!
//! Samples of one plan differ from run to run by where they fall in time, so the curves themselves have no common
//! hash. What stays: the joints, their starts and reversals in order, where each joint rests before a start and at
//! the end, and how long it all takes. Places are told apart by [`PLACE`], durations by [`DURATION`]. A value near
//! the border of two steps may fall into either: such a run then counts as one of another plan. Two plans that differ
//! by less than the steps everywhere count as one.

use super::identity::hash;
use crate::{
    replay::{Kind, Replay},
    series::Pair,
};

/// Rests farther apart than this are two places, rad or m.
const PLACE: f64 = 0.01;
/// Durations that differ by more than this share are two.
const DURATION: f64 = 0.05;
/// Keeps numbers that people choose, such as a tenth, away from the borders of the steps.
const ASIDE: f64 = 0.381_966;

/// The plan of a run; `None` if nothing in it starts.
pub(super) fn plan_id(pairs: &[Pair], replay: &Replay) -> Option<String> {
    let starts = replay.transitions.iter().map(|start| start.planned_onset_s);
    let first_s = starts.clone().reduce(f64::min)?;
    let stops = replay.stops.iter().filter_map(|stop| stop.planned_s);
    let last_s = stops.chain(starts).fold(first_s, f64::max);
    let mut pairs: Vec<&Pair> = pairs.iter().collect();
    pairs.sort_by(|a, b| a.name.cmp(&b.name));
    let mut features: Vec<String> = vec![step((last_s - first_s).max(1e-3).ln(), DURATION)];
    for pair in pairs {
        features.push(format!("{} {}", pair.name, pair.kind.unit()));
        let own = replay.transitions.iter().filter(|start| start.joint == pair.name);
        for (k, start) in own.enumerate() {
            features.push(format!("{} {}", start.kind.name(), start.direction));
            // Where the first motion begins is where the machine happened to stand.
            if start.kind == Kind::Start && k > 0 {
                let before = pair
                    .t_s
                    .partition_point(|t_s| *t_s <= start.planned_onset_s - 0.5 * replay.rules.min_rest_s);
                features.extend(
                    before.checked_sub(1).and_then(|i| pair.planned.get(i)).map(|at| step(*at, PLACE)),
                );
            }
        }
        features.extend(pair.planned.last().map(|at| step(*at, PLACE)));
    }
    Some(hash(features))
}

/// The number of the step that a value is in.
fn step(value: f64, width: f64) -> String {
    format!("{:.0}", (value / width + ASIDE).floor())
}
