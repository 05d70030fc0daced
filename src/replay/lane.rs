//! What each joint does over a run, for one glance: it waits, in vain or not, follows or settles.

use super::{Answer, Kind, Replay, Stop, Transition};

/// What a joint does in a stretch of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// The plan has left rest, the joint has not.
    Waits,
    /// The same, and the joint never does.
    Never,
    /// Plan and joint move.
    Follows,
    /// The plan is at rest again, the joint is not.
    Settles,
}

/// A stretch of a run in one phase, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// What the joint does.
    pub phase: Phase,
    /// Where it begins.
    pub from_s: f64,
    /// Where it ends, not before.
    pub to_s: f64,
}

/// Shorter ones are no stretches, s.
const LEAST_S: f64 = 0.02;

/// The stretches of a joint, in the order of time and apart from each other; between them plan and joint rest.
///
/// Where the instant of an answer is not known, the joint follows from the plan's start on. `seen_s` are the joint's
/// stretches without a gap: a motion that a gap cuts ends there, and one whose plan is under way where a stretch begins is
/// followed from there.
pub fn lane(found: &Replay, joint: &str, seen_s: &[[f64; 2]]) -> Vec<Stretch> {
    seen_s.iter().flat_map(|seen_s| between(found, joint, *seen_s)).collect()
}

/// The stretches between two gaps.
fn between(found: &Replay, joint: &str, [begin_s, end_s]: [f64; 2]) -> Vec<Stretch> {
    let within = |s: f64| s >= begin_s && s <= end_s;
    let of = |start: &&Transition| start.joint == joint && within(start.planned_onset_s);
    let starts: Vec<&Transition> = found.transitions.iter().filter(of).collect();
    let stops: Vec<&Stop> = found.stops.iter().filter(|stop| stop.joint == joint).collect();
    let mut lane = Vec::with_capacity(3 * starts.len() + 1);
    // Under way where the stretch begins: its first stop, or turn, has no start before it.
    let first_s = starts.first().map_or(end_s, |start| start.planned_onset_s);
    let opens_to_s = match starts.first() {
        Some(start) if start.kind == Kind::Reversal => Some(first_s),
        _ => stops.iter().filter_map(|stop| stop.planned_s).find(|s| within(*s) && *s <= first_s),
    };
    lane.extend(opens_to_s.filter(|to_s| *to_s > begin_s).map(|to_s| Stretch {
        phase: Phase::Follows,
        from_s: begin_s,
        to_s,
    }));
    for (k, start) in starts.iter().enumerate() {
        let from_s = start.planned_onset_s;
        let next = starts.get(k + 1);
        let next_s = next.map_or(end_s, |next| next.planned_onset_s);
        let stop = stops.iter().find(|stop| stop.planned_s.is_some_and(|s| s > from_s && s <= next_s));
        let rests_s = stop.and_then(|stop| stop.planned_s);
        // Without a stop the plan turns, or moves to where the stretch ends.
        let moves_to_s = rests_s.unwrap_or(next_s).min(next_s);
        let answers_s = match (start.answer, start.measured_onset_s) {
            (Answer::Never, _) => moves_to_s,
            (_, onset_s) => onset_s.unwrap_or(from_s).min(next_s).max(from_s),
        };
        // A joint that left and is not seen to come to rest settles on.
        let settled_s = stop.map(|stop| stop.measured_s.unwrap_or(next_s));
        let settled_s = settled_s.filter(|_| {
            start.answer == Answer::Timed
                || start.answer != Answer::Never && stop.is_some_and(|stop| stop.measured_s.is_some())
        });
        let waits = if start.answer == Answer::Never { Phase::Never } else { Phase::Waits };
        let ends = [
            (waits, from_s, answers_s),
            (Phase::Follows, answers_s, moves_to_s),
            (Phase::Settles, moves_to_s.max(answers_s), settled_s.unwrap_or(moves_to_s).min(next_s)),
        ];
        let stretches = ends.into_iter().filter(|(_, from_s, to_s)| to_s - from_s > LEAST_S);
        lane.extend(stretches.map(|(phase, from_s, to_s)| Stretch { phase, from_s, to_s }));
    }
    lane
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        replay::{Rules, replay},
        series::{Track, align},
    };

    /// Strokes of 2 s that begin at these instants, planned and measured, back and forth.
    fn run(planned_s: &[f64], measured_s: &[f64], to_s: f64) -> Replay {
        let t_s: Vec<f64> = (0..1000).map(|k| 0.01 * f64::from(k)).take_while(|t| *t < to_s).collect();
        let track = |starts_s: &[f64]| {
            let at = |t: &f64| {
                let stroke = |(k, from): (usize, &f64)| {
                    let sign = if k % 2 == 0 { 0.1 } else { -0.1 };
                    sign * (t - from).clamp(0.0, 2.0)
                };
                starts_s.iter().enumerate().map(stroke).sum()
            };
            Track::new("boom", t_s.clone(), t_s.iter().map(at).collect::<Vec<f64>>(), &[]).unwrap()
        };
        let pairs: Vec<_> = align(&track(planned_s), &track(measured_s)).into_iter().collect();
        replay(&pairs, &Rules::default())
    }

    /// Speeds are of windows: where a joint comes to rest is known to less than two tenths of a second.
    fn assert_is(lane: &[Stretch], expected: &[(Phase, f64, f64)]) {
        let alike = |(one, (phase, from_s, to_s)): (&Stretch, &(Phase, f64, f64))| {
            one.phase == *phase && (one.from_s - from_s).abs() < 0.2 && (one.to_s - to_s).abs() < 0.2
        };
        assert!(lane.len() == expected.len() && lane.iter().zip(expected).all(alike), "{lane:?}");
    }

    #[test]
    fn a_late_joint_waits_follows_and_settles() {
        let found = run(&[1.0, 6.0], &[1.5, 6.3], 10.0);
        let expected = [
            (Phase::Waits, 1.0, 1.5),
            (Phase::Follows, 1.5, 3.0),
            (Phase::Settles, 3.0, 3.5),
            (Phase::Waits, 6.0, 6.3),
            (Phase::Follows, 6.3, 8.0),
            (Phase::Settles, 8.0, 8.3),
        ];
        assert_is(&lane(&found, "boom", &[[0.0, 10.0]]), &expected);
        assert!(lane(&found, "stick", &[[0.0, 10.0]]).is_empty());
    }

    /// Its own stop is none, and its window ends before the plan turns.
    #[test]
    fn a_long_motion_that_turns_is_followed_to_where_it_turns() {
        let found = run(&[1.0, 3.0], &[1.2, 3.2], 8.0);
        let lane = lane(&found, "boom", &[[0.0, 8.0]]);
        assert!(
            lane.iter().any(|one| one.phase == Phase::Follows && (one.to_s - 3.0).abs() < 0.1),
            "{lane:?}"
        );
    }

    #[test]
    fn a_joint_that_is_not_seen_to_come_to_rest_settles_on() {
        let found = run(&[1.0], &[1.9], 3.6);
        let expected = [(Phase::Waits, 1.0, 1.9), (Phase::Follows, 1.9, 3.0), (Phase::Settles, 3.0, 3.6)];
        assert_is(&lane(&found, "boom", &[[0.0, 3.6]]), &expected);
    }

    #[test]
    fn starts_that_are_dated_within_each_other_make_no_panic() {
        let mut found = run(&[1.0, 6.0], &[1.5, 6.3], 10.0);
        found.transitions[0].planned_onset_s = 6.5;
        found.transitions[0].measured_onset_s = Some(9.0);
        assert!(!lane(&found, "boom", &[[0.0, 10.0]]).is_empty());
    }

    #[test]
    fn a_joint_that_never_answers_is_told_for_as_long_as_its_plan_moves() {
        let found = run(&[1.0], &[], 8.0);
        assert_is(&lane(&found, "boom", &[[0.0, 10.0]]), &[(Phase::Never, 1.0, 3.0)]);
    }

    #[test]
    fn a_gap_ends_a_motion_and_one_under_way_begins_behind_it() {
        let found = run(&[1.0, 6.0], &[1.5, 6.3], 10.0);
        let expected = [
            (Phase::Waits, 1.0, 1.5),
            (Phase::Follows, 1.5, 2.0),
            (Phase::Follows, 2.5, 3.0),
            (Phase::Waits, 6.0, 6.2),
            (Phase::Follows, 7.0, 8.0),
        ];
        assert_is(&lane(&found, "boom", &[[0.0, 2.0], [2.5, 6.2], [7.0, 10.0]]), &expected);
    }

    #[test]
    fn stretches_ascend_and_stay_apart_where_the_log_ends_in_motion() {
        for to_s in [1.2, 1.9, 2.6, 4.0, 6.4, 7.0] {
            let found = run(&[1.0, 6.0], &[1.6, 6.6], to_s);
            let lane = lane(&found, "boom", &[[0.0, to_s]]);
            assert!(
                lane.iter().all(|one| one.from_s < one.to_s && one.to_s < to_s + 1e-9),
                "{to_s}: {lane:?}"
            );
            assert!(lane.windows(2).all(|two| two[0].to_s <= two[1].from_s), "{to_s}: {lane:?}");
        }
    }
}
