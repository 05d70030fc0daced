//! Whether a plan is whole: it begins and ends at rest, and is not silent while a joint moves.

use std::{borrow::Cow, fmt};

use super::{JointKind, Series, SignalError, Track};
use crate::units::DEGREE_RAD;

/// Planned speed that is motion, rad/s, or m/s of joints that slide.
const MOVES: f64 = 0.05 * DEGREE_RAD;

/// Planned speed at which a plan does not end, rad/s or m/s, or this share of its largest speed if that is less; and how close to its
/// end that is looked for, s.
const fn cut_speed(kind: JointKind) -> f64 {
    match kind {
        JointKind::Turns => DEGREE_RAD,
        JointKind::Slides => 0.01,
    }
}
const CUT_SHARE: f64 = 0.3;
const CUT_S: f64 = 0.05;

/// The longest time without a plan within one motion, s.
const LONGEST_HOLE_S: f64 = 60.0;

/// Cuts with less silence than this, s, which a clock that was set makes, are no holes: between their sides a track goes on.
const BRIDGED_S: f64 = 0.3;

/// A joint that is so far away after a hole has moved within it, rad or m.
const MOVED: f64 = 1e-3;

/// A plan that goes on at this speed, rad/s, and m/s of joints that slide, over two stretches of so long, s, and then stands for longer
/// is halted; one whose speed falls before to this share comes to rest.
const fn halt_speed(kind: JointKind) -> f64 {
    match kind {
        JointKind::Turns => 5.0 * DEGREE_RAD,
        JointKind::Slides => 0.03,
    }
}
const HALT_S: f64 = 0.1;
const STANDS_S: f64 = 0.3;
const GOES_ON: f64 = 0.75;
/// A motion starts gently whose first stretch has less than this share of the speed of its second.
const GENTLY: f64 = 0.65;
/// Steps of a rounded position by which a stretch may seem too long.
const ROUNDED: f64 = 3.0;
/// Positions that differ by less are the same, rad or m.
const STILL: f64 = 1e-7;
/// Samples farther apart do not show how a plan stops, s.
const SPARSE_S: f64 = 0.025;

/// Where the motion of a joint is broken off.
#[derive(Debug, Clone, PartialEq)]
pub enum Broken {
    /// It begins or ends in motion: it was cut off, for no arm starts or stops at once.
    Cut {
        /// The joint.
        joint: String,
        /// Whether it turns or slides.
        kind: JointKind,
        /// Whether it is the beginning that is cut off, or the end.
        begins: bool,
        /// Its speed there, rad/s or m/s.
        speed: f64,
        /// The first or last instant, s.
        at_s: f64,
    },
    /// It stops at once, though it starts gently: the set values were held, as by an emergency stop.
    Halted {
        /// The joint.
        joint: String,
        /// Whether it turns or slides.
        kind: JointKind,
        /// Its speed before, rad/s or m/s.
        speed: f64,
        /// When it stops, s.
        at_s: f64,
    },
    /// It is missing while the joint moves.
    Hole {
        /// The joint.
        joint: String,
        /// Whether it turns or slides.
        kind: JointKind,
        /// How far it is away after the hole, rad or m.
        moved: f64,
        /// The last instant before it and the first one after it, s.
        hole_s: [f64; 2],
    },
}

impl Broken {
    /// Where a plan is broken in its newest motion, if it is; `None` for one that never moves.
    pub fn of(series: &Series) -> Option<Self> {
        let bridged = bridged(series).ok()?;
        let span_s = moving_s(&bridged)?;
        Self::cut(&bridged, span_s)
            .or_else(|| Self::hole(&bridged, span_s))
            .or_else(|| Self::halt(&bridged, span_s))
    }

    /// The instant between these, s, at which all joints that move stop at once and stand, though the motion began gently. Motions that
    /// all end so are how the plan is.
    pub(crate) fn halt(series: &Series, span_s: [f64; 2]) -> Option<Self> {
        let all = series.tracks.iter().flat_map(|track| Self::halts(series, track, span_s));
        let mut all: Vec<(f64, Self)> = all.collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (first_s, _) = all.first()?;
        let one = all.iter().all(|(at_s, _)| at_s - first_s < STANDS_S);
        all.into_iter().next().filter(|_| one).map(|(_, found)| found)
    }

    /// When a joint stops so, s.
    fn halts(series: &Series, track: &Track, [from_s, to_s]: [f64; 2]) -> Vec<(f64, Self)> {
        let mean = |track: &Track, [from_s, to_s]: [f64; 2]| {
            (track.held_at(to_s).position - track.held_at(from_s).position) / (to_s - from_s)
        };
        let least = halt_speed(track.kind());
        let (t_s, position) = (track.t_s(), track.position());
        let moved = |k: usize| (position[k] - position[k - 1]).abs();
        let (first, last) = (t_s.partition_point(|t| *t < from_s), t_s.partition_point(|t| *t <= to_s));
        let steps = || (first.max(1)..last).map(moved).filter(|moved| *moved > STILL);
        let off = ROUNDED * steps().fold(f64::INFINITY, f64::min) / HALT_S;
        let stands = |t_s: f64| {
            let still =
                |other: &Track| mean(other, [t_s, t_s + STANDS_S]).abs() < 0.02 * halt_speed(other.kind());
            series.tracks.iter().all(still)
        };
        let (mut begins_s, mut rested_s, mut found) = (None, f64::NEG_INFINITY, Vec::new());
        for k in first.max(1)..last.min(t_s.len().saturating_sub(1)) {
            if moved(k) <= STILL {
                continue;
            }
            if t_s[k] - rested_s > STANDS_S {
                begins_s = Some(t_s[k - 1]);
            }
            rested_s = t_s[k];
            let Some(begins_s) = begins_s.filter(|begins_s| t_s[k] > begins_s + 3.0 * HALT_S) else {
                continue;
            };
            if moved(k + 1) > STILL || t_s[k] - t_s[k - 1] > SPARSE_S {
                continue;
            }
            let before = mean(track, [t_s[k] - HALT_S, t_s[k]]);
            let earlier = mean(track, [t_s[k] - 2.0 * HALT_S, t_s[k] - HALT_S]);
            let goes_on = before.abs() - off > least.max(GOES_ON * earlier.abs()) && before * earlier > 0.0;
            let [begun, goes] = [0.0, HALT_S].map(|s| mean(track, [begins_s + s, begins_s + s + HALT_S]));
            if goes_on && begun.abs() < GENTLY * goes.abs() && stands(t_s[k]) {
                let (joint, kind) = (track.name().to_owned(), track.kind());
                found.push((t_s[k], Self::Halted { joint, kind, speed: before, at_s: t_s[k] }));
            }
        }
        found
    }

    /// The first joint that begins or ends in motion, of a motion between these instants, s.
    pub(crate) fn cut(series: &Series, [from_s, to_s]: [f64; 2]) -> Option<Self> {
        for track in &series.tracks {
            let (t_s, position) = (track.t_s(), track.position());
            let first = t_s.partition_point(|t| *t < from_s - CUT_S);
            let last = t_s.partition_point(|t| *t <= to_s + CUT_S).saturating_sub(1);
            let begins = track.segments().iter().any(|part| part.start == first && part.len() > 1);
            let ends = track.segments().iter().any(|part| part.end == last + 1 && part.len() > 1);
            // An end, its neighbour, and where the motion has its own.
            let first = (first, first + 1, from_s, true);
            let last = (last, last.wrapping_sub(1), to_s, false);
            let ends = [first].into_iter().filter(|_| begins).chain([last].into_iter().filter(|_| ends));
            for (at, next, _, begins) in ends.filter(|(at, _, end_s, _)| (t_s[*at] - end_s).abs() <= CUT_S) {
                let step = (position[at] - position[next]) / (t_s[at] - t_s[next]);
                let speed = track.velocity().map_or(step, |speed| speed[at]);
                let steps = t_s.windows(2).zip(position.windows(2));
                let largest = steps.map(|(t, q)| ((q[1] - q[0]) / (t[1] - t[0])).abs()).fold(0.0, f64::max);
                if speed.abs() > (CUT_SHARE * largest).clamp(MOVES, cut_speed(track.kind())) {
                    let (joint, kind) = (track.name().to_owned(), track.kind());
                    return Some(Self::Cut { joint, kind, begins, speed, at_s: t_s[at] });
                }
            }
        }
        None
    }

    /// The first hole in which a joint moves, between these instants, s.
    pub(crate) fn hole(series: &Series, [from_s, to_s]: [f64; 2]) -> Option<Self> {
        for track in &series.tracks {
            for two in track.segments().windows(2) {
                let (a, b) = (two[0].end - 1, two[1].start);
                let hole_s = [track.t_s()[a], track.t_s()[b]];
                let moved = track.position()[b] - track.position()[a];
                if hole_s[1] > from_s && hole_s[0] < to_s && moved.abs() > MOVED {
                    let (joint, kind) = (track.name().to_owned(), track.kind());
                    return Some(Self::Hole { joint, kind, moved, hole_s });
                }
            }
        }
        None
    }
}

impl fmt::Display for Broken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cut { joint, kind, begins, speed, at_s } => {
                let (does, speed) = (if *begins { "begins" } else { "ends" }, kind.says(*speed));
                write!(f, "{does} at {at_s:.2} s while {joint} moves at {speed} per second")
            }
            Self::Halted { joint, kind, speed, at_s } => {
                let speed = kind.says(*speed);
                write!(f, "stops at once at {at_s:.2} s while {joint} moves at {speed} per second")
            }
            Self::Hole { joint, kind, moved, hole_s: [from_s, to_s] } => {
                let moved = kind.says(*moved);
                write!(f, "is missing from {from_s:.2} s to {to_s:.2} s while {joint} moves by {moved}")
            }
        }
    }
}

/// The series with its short holes closed.
///
/// # Errors
///
/// [`SignalError`], which tracks do not have.
pub(crate) fn bridged(series: &Series) -> Result<Cow<'_, Series>, SignalError> {
    if series.tracks.iter().all(|track| track.segments().len() < 2) {
        return Ok(Cow::Borrowed(series));
    }
    let one = |track: &Track| {
        let (t_s, starts) = (track.t_s(), track.segments().iter().map(|part| part.start));
        let cuts: Vec<usize> = starts.filter(|k| *k > 0 && t_s[*k] - t_s[*k - 1] > BRIDGED_S).collect();
        let made = Track::of(track.kind(), track.name(), t_s.to_vec(), track.position().to_vec(), &cuts)?;
        track.velocity().map_or(Ok(made.clone()), |speed| made.with_velocity(speed.to_vec()))
    };
    Ok(Cow::Owned(Series { tracks: series.tracks.iter().map(one).collect::<Result<_, _>>()? }))
}

/// When the first joint starts to move and the last one stops, s, in the newest part of the log in which one moves.
pub(crate) fn moving_s(series: &Series) -> Option<[f64; 2]> {
    parts_s(series).into_iter().rev().find_map(|part_s| moving_within_s(series, part_s))
}

/// Parts of a log with holes between them in which no joint has a plan: a clock was set, or recording paused. What
/// lies on two sides of one is not one motion.
fn parts_s(series: &Series) -> Vec<[f64; 2]> {
    let span = |track: &Track| {
        let t_s = track.t_s().to_vec();
        track.segments().iter().map(move |part| [t_s[part.start], t_s[part.end - 1]]).collect::<Vec<_>>()
    };
    let mut all: Vec<[f64; 2]> = series.tracks.iter().flat_map(span).collect();
    all.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut parts: Vec<[f64; 2]> = Vec::new();
    for [from_s, to_s] in all {
        match parts.last_mut() {
            Some(part) if from_s - part[1] <= LONGEST_HOLE_S => part[1] = part[1].max(to_s),
            _ => parts.push([from_s, to_s]),
        }
    }
    parts
}

/// When a joint last moves before a motion and first after it, s, in the part of the log that holds it.
pub(crate) fn moves_beside_s(series: &Series, [from_s, to_s]: [f64; 2]) -> [Option<f64>; 2] {
    const ASIDE_S: f64 = 0.1;
    let holds = |part: &[f64; 2]| part[0] <= to_s && part[1] >= from_s;
    let Some([begin_s, end_s]) = parts_s(series).into_iter().find(holds) else { return [None; 2] };
    [
        moving_within_s(series, [begin_s, from_s - ASIDE_S]).map(|[_, last_s]| last_s),
        moving_within_s(series, [to_s + ASIDE_S, end_s]).map(|[first_s, _]| first_s),
    ]
}

fn moving_within_s(series: &Series, [begin_s, end_s]: [f64; 2]) -> Option<[f64; 2]> {
    let mut found: Option<[f64; 2]> = None;
    for track in &series.tracks {
        let (t_s, angle_rad) = (track.t_s(), track.position());
        let within = t_s.partition_point(|t| *t < begin_s)..t_s.partition_point(|t| *t <= end_s);
        let moving = |k: usize| {
            let fast = track.velocity().is_some_and(|speed| speed[k].abs() > MOVES);
            fast || (k > within.start
                && (angle_rad[k] - angle_rad[k - 1]).abs() > MOVES * (t_s[k] - t_s[k - 1]).max(1e-3))
        };
        let first = within.clone().find(|&k| moving(k));
        let last = within.clone().rev().find(|&k| moving(k));
        if let (Some(first), Some(last)) = (first, last) {
            let [from, to] = found.unwrap_or([f64::INFINITY, f64::NEG_INFINITY]);
            found = Some([from.min(t_s[first]), to.max(t_s[last])]);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::smooth_step;

    fn wave(missing: std::ops::Range<usize>, with_speed: bool) -> Track {
        let kept: Vec<usize> = (0..300).filter(|k| !missing.contains(k)).collect();
        let t_s: Vec<f64> = kept.iter().map(|k| *k as f64 * 0.02).collect();
        let position = t_s.iter().map(|t| (0.7 * t).sin()).collect();
        let made = Track::new("J", t_s.clone(), position, &[missing.start]).unwrap();
        if !with_speed {
            return made;
        }
        made.with_velocity(t_s.iter().map(|t| 0.7 * (0.7 * t).cos()).collect()).unwrap()
    }

    #[test]
    fn a_short_hole_is_closed_and_a_long_one_in_motion_refused() {
        for with_speed in [true, false] {
            let short = Series { tracks: vec![wave(100..110, with_speed)] };
            let whole = bridged(&short).unwrap();
            assert_eq!((short.tracks[0].segments().len(), whole.tracks[0].segments().len()), (2, 1));
            let there = whole.tracks[0].held_at(2.09);
            assert!((there.position - (0.7_f64 * 2.09).sin()).abs() < 4e-3, "{there:?}");
            assert_eq!(
                (Broken::hole(&whole, [0.0, 6.0]), Broken::hole(&short, [0.0, 6.0]).is_some()),
                (None, true)
            );
        }
        let long = Series { tracks: vec![wave(100..130, true)] };
        let long = bridged(&long).unwrap();
        let found = Broken::hole(&long, [0.0, 6.0]);
        assert!(
            matches!(&found, Some(Broken::Hole { hole_s: [a, b], .. }) if (a - 1.98).abs() + (b - 2.6).abs() < 1e-9),
            "{found:?}"
        );
        assert_eq!(Broken::hole(&long, [3.0, 6.0]), None);
    }

    #[test]
    fn a_plan_that_begins_or_ends_in_motion_is_cut_and_one_at_rest_is_whole() {
        let of = |within: std::ops::Range<i32>| {
            let t_s: Vec<f64> = within.map(|k| f64::from(k) * 0.02).collect();
            let position = t_s.iter().map(|t| smooth_step((t - 1.0) / 2.0)).collect();
            Broken::of(&Series { tracks: vec![Track::new("J", t_s, position, &[]).unwrap()] })
        };
        assert_eq!(of(0..200), None);
        assert!(matches!(of(90..200), Some(Broken::Cut { begins: true, .. })));
        assert!(matches!(of(0..110), Some(Broken::Cut { begins: false, .. })));
        assert_eq!(of(0..40), None, "it never moves");
    }

    #[test]
    fn a_plan_that_is_held_in_motion_is_halted_and_straight_lines_are_not() {
        let of = |gentle: bool, stopped_s: f64, resumes_s: f64, step: f64| {
            let position = |t: f64| {
                let t = if t < stopped_s { t } else { stopped_s.max(t - (resumes_s - stopped_s)) };
                let x = ((t - 1.0) / 4.0).clamp(0.0, 1.0);
                let at = if gentle { smooth_step(x) } else { x };
                if step > 0.0 { (at / step).round() * step } else { at }
            };
            Broken::of(&Series::sampled("J", 1200, position))
        };
        for resumes_s in [7.0, 99.0] {
            let found = of(true, 3.0, resumes_s, 0.0);
            assert!(
                matches!(found, Some(Broken::Halted { at_s, .. }) if (at_s - 3.0).abs() < 0.02),
                "{resumes_s} {found:?}"
            );
        }
        for step in [0.0, 1e-4, 1.745e-3] {
            assert_eq!(of(true, 20.0, 20.0, step), None, "{step}");
            assert_eq!(of(false, 20.0, 20.0, step), None, "{step}");
        }
    }

    #[test]
    fn short_ramps_of_rounded_plans_and_joints_that_take_over_are_no_halt() {
        // Gently to a speed, deg/s, and back to rest within a time, s; the second joint starts there, or crawls on.
        let of = |speed: f64, down_s: f64, step_deg: f64, rate_hz: f64, other: &dyn Fn(f64) -> f64| {
            let t_s: Vec<f64> = (0..1400).map(|k| f64::from(k) / rate_hz).filter(|t| *t < 14.0).collect();
            let at = |t: f64| {
                let ramp =
                    |s: f64, long_s: f64| 0.5 * s.clamp(0.0, long_s).powi(2) / long_s + (s - long_s).max(0.0);
                speed * (ramp(t - 1.013, 0.4) - ramp(t - 5.0, down_s))
            };
            let rounded = |deg: f64| if step_deg > 0.0 { (deg / step_deg).round() * step_deg } else { deg };
            let track = |name: &str, course: &dyn Fn(f64) -> f64| {
                let q = t_s.iter().map(|t| rounded(course(*t)) * DEGREE_RAD).collect();
                Track::new(name, t_s.clone(), q, &[]).unwrap()
            };
            Broken::of(&Series { tracks: vec![track("A", &at), track("B", other)] })
        };
        let rests = |_: f64| 0.0;
        for speed in [6.0, 12.0, 25.0] {
            for down_s in [0.05, 0.06, 0.08, 0.1, 0.12, 0.15, 0.3] {
                for step_deg in [0.0, 0.01, 0.1, 0.2] {
                    for rate_hz in [50.0, 100.0] {
                        let found = of(speed, down_s, step_deg, rate_hz, &rests);
                        assert_eq!(found, None, "{speed} {down_s} {step_deg} {rate_hz}");
                    }
                }
            }
        }
        let halted = |other: &dyn Fn(f64) -> f64| of(12.0, 1e-3, 0.0, 100.0, other).is_some();
        assert!(halted(&rests) && of(25.0, 1e-3, 0.1, 100.0, &rests).is_some());
        assert!(!halted(&|t| 3.0 * (t - 5.0).clamp(0.0, 4.0)), "another one takes over");
        assert!(!halted(&|t| 0.9 * (t - 0.5).clamp(0.0, 12.0)), "another one crawls on");
    }
}
