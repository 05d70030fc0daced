//! Finds a machine that was stopped while its plan went on.

use super::other_time::late_s as late_s_of;
use crate::{
    math::quantile,
    series::{JointKind, Series, Track},
    units::DEGREE_RAD,
};

/// Motion in half a second with which a joint stands: rad, and m.
const STANDS: [f64; 2] = [0.15 * DEGREE_RAD, 0.002];
const STEP_S: f64 = 0.5;
/// What swings is back after its period: four fifths of its samples meanwhile lie within so many times that of a joint that stands,
/// the plan comes back to less than this share of its own swing, and the joint swings by more than it.
const SWINGS: f64 = 2.0;
const OF_PLAN: f64 = 0.5;
const MIDDLE: [f64; 2] = [0.1, 0.9];

/// Motion of machine and plan that is worth a remark: rad, and m.
const MOVES: [f64; 2] = [3.0 * DEGREE_RAD, 0.03];

/// Share of that within a step with which a plan is on its way.
const WAY: f64 = 0.3;

/// A joint that was stopped stays farther off than so many times what it is off at other rests, and than this share of a
/// motion that is worth a remark.
const USUAL: f64 = 4.0;
const OFF: f64 = 0.2;

/// For so long after a stop a plan may go on, and before a start: machines lag, s.
const LAGS_S: f64 = 1.0;

/// What was found, from when to when the machine stood, s (infinite where it did from the first or to the last), and whether the run had followed its plan at the same time before: what had
/// not may be late.
pub(super) struct Stop {
    pub(super) stood_s: [f64; 2],
    pub(super) message: String,
    pub(super) in_time: bool,
}

/// Whiles in which all joints stand, or from then on, though the plan goes on, of one joint at least, for longer and
/// farther than machines lag.
pub(super) fn stops(planned: &Series, measured: &Series) -> Vec<Stop> {
    let mut late_s = None;
    let both = |track| Some((track, measured.track(Track::name(track))?));
    let joints: Vec<(&Track, &Track)> = planned.tracks.iter().filter_map(both).collect();
    let ends = |(_, came): &(&Track, &Track)| Some([*came.t_s().first()?, *came.t_s().last()?]);
    let common = joints.iter().filter_map(ends).reduce(|a, b| [a[0].max(b[0]), a[1].min(b[1])]);
    let Some([first_s, last_s]) = common else { return Vec::new() };
    if joints.iter().all(|(_, came)| travel(came, [first_s, last_s]) < least(came.kind(), MOVES)) {
        return Vec::new();
    }
    let mut found = Vec::new();
    for [stands_s, until_s] in standing(&joints, [first_s, last_s]) {
        let (at_first, for_good) = (stands_s < first_s + STEP_S, until_s + STEP_S > last_s);
        let from_s = comes_to_rest_s(&joints, stands_s);
        let to_s = if at_first { leaves_s(&joints, until_s) } else { until_s };
        // One that stands where its plan rests may be late.
        let on_its_way = joints.iter().any(|(plan, _)| {
            travel(plan, [stands_s - STEP_S, stands_s + STEP_S]) > WAY * least(plan.kind(), MOVES)
        });
        let left_behind = |joint: &&(&Track, &Track)| match (for_good, on_its_way) {
            _ if at_first => goes_on(joint, [stands_s - LAGS_S, to_s]),
            (true, true) => goes_on(joint, [stands_s, to_s]) || stays_off(joint, [stands_s, last_s]),
            (false, true) => goes_on(joint, [stands_s, to_s]) || passes(joint, [stands_s, to_s]),
            (true, false) => goes_on(joint, [stands_s, to_s]),
            (false, false) => false,
        };
        let names: Vec<&str> = joints.iter().filter(left_behind).map(|(plan, _)| plan.name()).collect();
        // One joint that leaves late at first has a dead band.
        if names.is_empty() || at_first && names.len() < 2 {
            continue;
        }
        let when = match (at_first, for_good) {
            (true, _) => format!("until {to_s:.1} s"),
            (false, true) => format!("from {from_s:.1} s on"),
            (false, false) => format!("from {from_s:.1} s until {to_s:.1} s"),
        };
        let what = if at_first {
            "was not ready (pump or drive off, not enabled)"
        } else {
            "was stopped (emergency stop, fault, hold)"
        };
        let names = names.join(", ");
        let message =
            format!("no joint moves {when}, though the plan of {names} goes on: the machine {what}");
        let late_s = *late_s.get_or_insert_with(|| late_s_of(planned, measured));
        let stood_s =
            [if at_first { f64::NEG_INFINITY } else { from_s }, if for_good { f64::INFINITY } else { to_s }];
        found.push(Stop { stood_s, message, in_time: followed(&joints, [first_s, stands_s], late_s) });
    }
    found
}

/// When the first joint leaves where it stood, s.
fn leaves_s(joints: &[(&Track, &Track)], stood_s: f64) -> f64 {
    let until = |(_, came): &(&Track, &Track)| {
        let after = samples(came).skip_while(|(t_s, _)| *t_s < stood_s);
        after.take_while(stays(came, stood_s)).last().map(|(t_s, _)| t_s)
    };
    joints.iter().filter_map(until).fold(f64::INFINITY, f64::min).max(stood_s)
}

/// When the last joint came to where it then stands, s.
fn comes_to_rest_s(joints: &[(&Track, &Track)], stands_s: f64) -> f64 {
    let since = |(_, came): &(&Track, &Track)| {
        let before = samples(came).rev().skip_while(|(t_s, _)| *t_s > stands_s);
        before.take_while(stays(came, stands_s)).last().map(|(t_s, _)| t_s)
    };
    joints.iter().filter_map(since).fold(f64::NEG_INFINITY, f64::max).min(stands_s)
}

/// Instants, s, and positions.
fn samples(track: &Track) -> impl DoubleEndedIterator<Item = (f64, f64)> + '_ {
    track.t_s().iter().copied().zip(track.position().iter().copied())
}

/// Whether a sample is where a joint stands at an instant.
fn stays(track: &Track, at_s: f64) -> impl Fn(&(f64, f64)) -> bool {
    let (place, near) = (track.held_at(at_s).position, least(track.kind(), STANDS));
    move |(_, q)| (q - place).abs() <= near
}

fn least(kind: JointKind, of: [f64; 2]) -> f64 {
    match kind {
        JointKind::Turns => of[0],
        JointKind::Slides => of[1],
    }
}

/// Whether a plan goes far while its joint stands, by more than machines lag at either end.
fn goes_on((plan, came): &(&Track, &Track), [from_s, to_s]: [f64; 2]) -> bool {
    let missed = travel(plan, [from_s + LAGS_S, to_s - LAGS_S]) - travel(came, [from_s, to_s]);
    missed > least(plan.kind(), MOVES)
}

/// Whether a plan goes far while its joint stands, and never rests meanwhile; the joint had gone along with it.
fn passes((plan, came): &(&Track, &Track), [from_s, to_s]: [f64; 2]) -> bool {
    let moves = least(plan.kind(), MOVES);
    let steps = (0..).map(|k| from_s + STEP_S * f64::from(k)).take_while(|at_s| at_s + STEP_S <= to_s);
    let went = |track: &Track| track.held_at(from_s).position - track.held_at(from_s - LAGS_S).position;
    to_s >= from_s + LAGS_S
        && travel(plan, [from_s, to_s]) - travel(came, [from_s, to_s]) > moves
        && went(plan) * went(came) > 0.0
        && steps.into_iter().all(|at_s| travel(plan, [at_s, at_s + STEP_S]) > 0.5 * WAY * moves)
}

/// Whether a joint that stands until the end of its log stays farther off its plan's end than it does elsewhere where the
/// plan rests.
fn stays_off((plan, came): &(&Track, &Track), [from_s, last_s]: [f64; 2]) -> bool {
    let off = |at_s: f64| (plan.held_at(at_s).position - came.held_at(at_s).position).abs();
    let rests = |at_s: f64| travel(plan, [at_s - LAGS_S, at_s]) <= least(plan.kind(), STANDS);
    let first_s = came.t_s().first().copied().unwrap_or(from_s);
    let before = (2..).map(|k| first_s + STEP_S * f64::from(k)).take_while(|at_s| *at_s < from_s - LAGS_S);
    let usual = before.filter(|at_s| rests(*at_s)).map(off).fold(0.0, f64::max);
    last_s >= from_s + LAGS_S
        && off(last_s) > (USUAL * usual).max(OFF * least(plan.kind(), MOVES))
        && travel(plan, [from_s, last_s]) > 0.5 * off(last_s)
}

/// Stretches in which all joints stand, s; a hole in the first one's samples ends one.
fn standing(joints: &[(&Track, &Track)], [first_s, last_s]: [f64; 2]) -> Vec<[f64; 2]> {
    let mut found: Vec<[f64; 2]> = Vec::new();
    let places = |t_s: f64| joints.iter().map(|(_, came)| came.held_at(t_s).position).collect::<Vec<_>>();
    let (mut at_s, mut before) = (first_s, places(first_s));
    for &next_s in joints.first().map_or(&[][..], |(_, came)| came.t_s()) {
        if next_s < at_s + STEP_S || next_s > last_s {
            continue;
        }
        let now = places(next_s);
        let moved = |k: usize| {
            let stands = least(joints[k].1.kind(), STANDS);
            (now[k] - before[k]).abs() > stands || swings_along(joints[k], [at_s, next_s])
        };
        if next_s < at_s + 2.0 * STEP_S && !(0..joints.len()).any(moved) {
            match found.last_mut().filter(|[_, to_s]| *to_s >= at_s) {
                Some(last) => last[1] = next_s,
                None => found.push([at_s, next_s]),
            }
        }
        (at_s, before) = (next_s, now);
    }
    found
}

/// Whether a joint swings to and fro with its plan; one that is shaken while its plan goes on or rests does not.
fn swings_along((plan, came): (&Track, &Track), span_s: [f64; 2]) -> bool {
    let [from, to] = span_s.map(|t_s| plan.held_at(t_s).position);
    let [asked, done] = [plan, came].map(|track| swing(track, span_s));
    asked > SWINGS * least(plan.kind(), STANDS)
        && (to - from).abs() < OF_PLAN * asked
        && done > OF_PLAN * asked
}

/// Whether the joints that moved in a span of time lay near their plan, that in the middle, by the planned motion; not those of a
/// machine that is late throughout, by so much, s, which lie nearer to a plan that is.
fn followed(joints: &[(&Track, &Track)], span_s: [f64; 2], late_s: f64) -> bool {
    const NEAR: f64 = 0.8;
    let in_time = apart(joints, span_s, 0.0);
    in_time < NEAR && (late_s <= LAGS_S || in_time <= apart(joints, span_s, late_s))
}

/// Distance of joints that moved in a span of time from their plan of so much before, that in the middle, by the planned motion.
fn apart(joints: &[(&Track, &Track)], [from_s, to_s]: [f64; 2], late_s: f64) -> f64 {
    let mut apart = Vec::new();
    for (plan, came) in joints {
        if travel(came, [from_s, to_s]) < least(came.kind(), MOVES) {
            continue;
        }
        let within = |t_s: &f64| (from_s..=to_s).contains(t_s);
        let pairs = came.t_s().iter().zip(came.position()).filter(|(t_s, _)| within(t_s));
        let wanted: Vec<(f64, f64)> =
            pairs.map(|(t_s, q)| (plan.held_at(*t_s - late_s).position, *q)).collect();
        let mean = wanted.iter().map(|(plan, _)| plan).sum::<f64>() / wanted.len() as f64;
        let motion = wanted.iter().map(|(plan, _)| (plan - mean).powi(2)).sum::<f64>();
        let error = wanted.iter().map(|(plan, came)| (plan - came).powi(2)).sum::<f64>();
        apart.push((error / motion).sqrt());
    }
    quantile(apart, 0.5)
}

/// Between lowest and highest position in a span of time.
fn travel(track: &Track, span_s: [f64; 2]) -> f64 {
    let [lowest, highest] = crate::math::range(within(track, span_s).iter().copied());
    (highest - lowest).max(0.0)
}

/// The same but for the outermost of its samples, which may be noise.
fn swing(track: &Track, span_s: [f64; 2]) -> f64 {
    let [low, high] = MIDDLE.map(|share| quantile(within(track, span_s).to_vec(), share));
    high - low
}

/// Positions in a span of time.
fn within(track: &Track, span_s: [f64; 2]) -> &[f64] {
    let [from, to] = span_s.map(|span_s| track.t_s().partition_point(|t_s| *t_s < span_s));
    track.position().get(from..to).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is said of a machine that follows, 0.2 s late, until it is stopped.
    fn said(stopped_s: f64, ends_s: f64) -> Vec<String> {
        of_course(ends_s, |t| t.min(stopped_s) - 0.2)
    }

    /// The same of one that is so far at each instant.
    fn of_course(ends_s: f64, course: impl Fn(f64) -> f64) -> Vec<String> {
        let stops = stops_of(ends_s, course).into_iter();
        stops.filter(|stop| stop.in_time).map(|stop| stop.message).take(1).collect()
    }

    fn stops_of(ends_s: f64, course: impl Fn(f64) -> f64) -> Vec<Stop> {
        let plan = |size: f64, t: f64| {
            size * (((t - 3.0) / 10.0).clamp(0.0, 1.0) - ((t - 15.0) / 5.0).clamp(0.0, 0.4))
        };
        let of = |ends_s: f64, came: &dyn Fn(f64) -> f64| {
            let t_s: Vec<f64> = (0..3000).map(|k| f64::from(k) * 0.01).filter(|t| *t < ends_s).collect();
            let track = |name: &str, size: f64| {
                let noise = |t: f64| 1e-4 * (1e3 * t).sin();
                let q = t_s.iter().map(|&t| plan(size, came(t)) + noise(t)).collect();
                Track::new(name, t_s.clone(), q, &[]).unwrap()
            };
            Series { tracks: vec![track("swing", 1.0), track("boom", -0.5)] }
        };
        stops(&of(30.0, &|t| t), &of(ends_s, &course))
    }

    #[test]
    fn a_machine_that_was_not_ready_is_told() {
        let found = stops_of(30.0, |t| if t < 6.0 { 0.0 } else { t - 0.2 });
        let one = found.first().map_or("", |stop| stop.message.as_str());
        assert!(one.contains("no joint moves until 6.") && one.contains("not ready"), "{one}");
        assert!(found[0].stood_s[0].is_infinite());
    }

    #[test]
    fn a_machine_that_was_stopped_is_told_and_one_that_ended_is_not() {
        for stopped_s in [6.0, 15.5] {
            let found = said(stopped_s, 30.0);
            let one = found.first().map_or("", String::as_str);
            let at_s = one.trim_start_matches("no joint moves from ").split(' ').next().unwrap_or_default();
            let late_s = at_s.parse::<f64>().unwrap_or(f64::NAN) - stopped_s;
            assert!(found.len() == 1 && late_s.abs() < 1.0, "{stopped_s}: {found:?}");
        }
        let held = of_course(30.0, |t| if t < 6.0 { t } else { (t - 4.0).max(6.0) });
        assert!(matches!(&held[..], [one] if one.contains(" until 10.0 s")), "{held:?}");
        assert_eq!(said(f64::INFINITY, 30.0), Vec::<String>::new());
        assert_eq!(said(f64::INFINITY, 9.0), Vec::<String>::new(), "a log that ends early");
        let late = said(16.0, 30.0);
        assert!(matches!(&late[..], [one] if one.contains(" on, though")), "{late:?}");
        assert_eq!(said(16.98, 30.0), Vec::<String>::new(), "almost at the end");
        let paused = of_course(30.0, |t| if t < 6.0 { t - 0.2 } else { (t - 1.7).max(5.8) });
        assert!(matches!(&paused[..], [one] if one.contains(" until 7.")), "{paused:?}");
        assert_eq!(said(0.0, 30.0), Vec::<String>::new(), "it never moved");
        assert_eq!(of_course(30.0, |t| t.min(10.0) - 3.0), Vec::<String>::new(), "it was late before");
    }

    #[test]
    fn a_joint_that_swings_twice_a_second_does_not_stand() {
        let swing = |late_s: f64| {
            Series::sampled("knee", 800, |t| 0.35 * (std::f64::consts::TAU * 2.0 * (t - late_s)).sin())
        };
        let found: Vec<String> =
            stops(&swing(0.0), &swing(0.03)).into_iter().map(|stop| stop.message).collect();
        assert_eq!(found, Vec::<String>::new());
        // One that stopped for good and is shaken by an engine stands, whatever its plan does.
        let plan = Series::sampled("boom", 3000, |t| 0.5 * (0.7 * t).sin());
        let shaken =
            Series::sampled("boom", 3000, |t| 0.5 * (0.7 * t.min(9.0)).sin() + 2.5e-3 * (14.0 * t).sin());
        let from_s: Vec<f64> = stops(&plan, &shaken).iter().map(|stop| stop.stood_s[0]).collect();
        assert!(matches!(from_s[..], [from_s] if (8.5..10.0).contains(&from_s)), "{from_s:?}");
    }
}
