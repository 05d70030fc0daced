//! Which plan a run followed, told by its planned curves: equal from run to run, whatever the phase of the samples.
//!
//! Samples of one plan differ from run to run by where they fall in time, so the curves themselves have no common
//! hash. What stays: the joints that start, their starts and reversals in order, where each joint rests before a start and at
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
        // One that stands all along, such as a gripper that came later, makes no other plan of what moves.
        if !replay.transitions.iter().any(|start| start.joint == pair.name) {
            continue;
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        math::smooth_step,
        replay::{Rules, replay},
        series::{Track, align},
    };

    #[test]
    fn a_joint_that_stands_makes_no_other_plan_and_one_that_moves_does() {
        let joint = |name: &str, by_rad: f64| {
            let course = |late_s: f64| move |t: f64| by_rad * smooth_step((t - 3.0 - late_s) / 4.0);
            align(&Track::sampled(name, 1200, course(0.0)), &Track::sampled(name, 1200, course(0.2))).unwrap()
        };
        let id = |pairs: &[Pair]| plan_id(pairs, &replay(pairs, &Rules::default()));
        let alone = id(&[joint("boom", 0.4)]);
        assert!(alone.is_some());
        assert_eq!(id(&[joint("boom", 0.4), joint("gripper", 0.0)]), alone);
        assert_ne!(id(&[joint("boom", 0.4), joint("gripper", 0.2)]), alone);
    }
}
