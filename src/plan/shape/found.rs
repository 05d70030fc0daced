//! The shape of a chosen plan.

use super::{
    aim::{Aim, Pace},
    curve::{Bounds, Curve, Frame},
    descend::descend,
    pace::{factor, quickened},
};
use crate::{
    math::smooth_step,
    plan::{
        Choice, KEPT_SHARE, Limit, Margin, PlanEvaluation, Setup, Timing, Via, joint_limits::JointLimits,
    },
    task::{Ceilings, Objective},
    threads,
};

/// A plan whose shape is free.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// The plan, evaluated exactly; all limits and ceilings hold.
    pub evaluation: PlanEvaluation,
    /// Pieces that every interval between key points was split into.
    pub pieces: usize,
    /// Quadratic programmes solved.
    pub steps: usize,
}

/// Why a plan keeps the shape that its times give it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NoShape {
    /// More intervals than a descent of the shape takes.
    TooManyIntervals {
        /// Number of intervals.
        found: usize,
        /// As many as it takes.
        most: usize,
    },
    /// The plan found is broken by a limit that slowing down does not mend.
    Broken(Margin),
    /// What was found is no better by the rule that chose, or beyond a ceiling.
    NoGain,
}

/// Pieces of an interval at most.
pub const MOST_PIECES: u32 = 30;
/// Pieces that a motion is split into by default, and how many that is of an interval at least and most; at least two where a
/// motion has many. One of few intervals is worth more: 5 leave one interval 8 to 15 % slower than 20.
const PIECES: usize = 25;
const OF_FEW: [usize; 4] = [20, 20, 10, 8];
const FEWEST: [usize; 2] = [2, 4];
const DEFAULT_MOST: usize = 5;
/// The same of arms of few joints: pieces times joints.
const FEW_JOINTS: usize = 3;
const PIECES_OF_FEW_JOINTS: usize = 150;
const MOST_OF_FEW_JOINTS: usize = 8;
/// Pieces of a motion at most, by default and of a caller who says how many: the time of a step grows with their cube.
const MOST: [usize; 2] = [128, 256];
/// Quadratic programmes of a descent, and the gain of merit that is worth one.
const STEPS: usize = 80;
const ENOUGH: f64 = 1e-5;
/// Descents of the smoothest shape of a duration, each a little faster where limits made the last one slower.
const TRIES: usize = 3;
/// Slowings down, and the distance that they keep from a limit, as a share of it.
const SLOWINGS: i32 = 8;
const CLEAR: f64 = 1e-10;
/// A range that is passed by no more than this is kept by points a little nearer to its middle.
const ROUNDED: f64 = 1.0 + 1e-4;
/// Each slowing down is so many times stronger than the last.
const STRONGER: f64 = 3.0;
/// Room for the peaks of a load that move between the instants as a descent goes on.
const BETWEEN: f64 = 1.0 + 1e-4;
/// A plan slower than this many times what its descent ended with has met a limit that time does not mend.
const SLOWEST: f64 = 1.5;

/// The shape for a choice, from its times: better by the rule that chose, under every limit and the ceilings. Angles at
/// key points where the tool alone is given are sought, too.
///
/// `pieces`: of each interval, by default as many as make 25 altogether, two to five. Loads are looked at in the Gauss
/// nodes of the pieces; where they break a limit between them, the descent goes on within a tighter one, and the last
/// plan is slowed down until it holds.
///
/// # Errors
///
/// [`NoShape`] if the timing alone is better or all that there is.
pub fn shape(
    setup: &Setup,
    choice: &Choice,
    ceilings: &Ceilings,
    pieces: Option<usize>,
) -> Result<Shape, NoShape> {
    sought(setup, &choice.timing, Aim::of(choice), ceilings, pieces)
}

/// The smoothest shape within ceilings, from times that need not keep them; `pieces` as of [`shape`].
///
/// # Errors
///
/// [`NoShape`] if the timing is within them and smoother, or no shape is within them.
pub fn smoother(
    setup: &Setup,
    timing: &Timing,
    ceilings: &Ceilings,
    pieces: Option<usize>,
) -> Result<Shape, NoShape> {
    sought(setup, timing, Aim::smoother(ceilings), ceilings, pieces)
}

/// The fastest shape within ceilings, from times that need not keep the limits; `pieces` as of [`shape`].
///
/// # Errors
///
/// [`NoShape`] if the timing keeps them and is faster, or no shape does.
pub fn fastest_shape(
    setup: &Setup,
    timing: &Timing,
    ceilings: &Ceilings,
    pieces: Option<usize>,
) -> Result<Shape, NoShape> {
    sought(setup, timing, Aim::faster(ceilings), ceilings, pieces)
}

/// Where a descent begins.
#[derive(Debug, Clone, Copy)]
enum Begin<'a> {
    /// At the motion of the timing.
    Passing,
    /// Near one that stops at every key point, with these times of movement, s.
    Stopping(&'a [f64]),
}

/// Times from rest to rest between the key points, as joints allow by themselves, s.
fn stopping_s(setup: &Setup) -> Vec<f64> {
    // Largest speed, acceleration and jerk of the move that has no acceleration at its ends, over one unit in one.
    const PEAKS: [f64; 3] = [1.875, 5.7735, 60.0];
    let points = setup.template().points();
    let one = |interval: usize| {
        let ends = points.of(interval).iter().zip(points.of(interval + 1)).zip(&setup.limits);
        let of = |((from, to), limits): ((&f64, &f64), &JointLimits)| {
            let most = [limits.speed(to - from), limits.acceleration_rad_s2, limits.jerk_rad_s3];
            let each = PEAKS.into_iter().zip(most).zip([1.0, 0.5, 1.0 / 3.0]);
            each.map(|((peak, most), power)| (peak * (to - from).abs() / most).powf(power))
                .fold(0.0, f64::max)
        };
        ends.map(of).fold(0.0, f64::max).clamp(setup.interval_s[0], setup.interval_s[1])
    };
    (0..points.len().saturating_sub(1)).map(one).collect()
}

/// The free points of moves from rest to rest in place of those of a curve; where joints at a key point are free, they are its.
fn stopping((frame, mut curve): (Frame<'_>, Curve), pieces: usize) -> (Frame<'_>, Curve) {
    let joints = frame.joints();
    let keys = frame.key.clone();
    for ends in keys.windows(2) {
        for k in 1..pieces {
            let share = smooth_step(k as f64 / pieces as f64);
            for joint in 0..joints {
                let [from, to] = [ends[0], ends[1]].map(|point| curve.point_rad[point * joints + joint]);
                curve.point_rad[(ends[0] + k) * joints + joint] = from + share * (to - from);
            }
        }
    }
    (frame, curve)
}

/// From the times; where ceilings leave no better plan that way, from the shape that keeps them best.
fn sought(
    setup: &Setup,
    timing: &Timing,
    aim: Aim,
    ceilings: &Ceilings,
    pieces: Option<usize>,
) -> Result<Shape, NoShape> {
    let bound = |k: &Objective| ceilings[*k].is_finite();
    let stops = stopping_s(setup);
    let begun = |begin: Begin<'_>, first| sought_from(setup, (timing, begin), (first, aim), ceilings, pieces);
    // Where key points lie close together, or a pass would swing wide, the best curve near the one that stops is better.
    let (mut found, other) = threads::both(
        || begun(Begin::Passing, None),
        || {
            if aim.pace == Pace::Fastest {
                begun(Begin::Stopping(&stops), None)
            } else {
                Err(NoShape::NoGain)
            }
        },
    );
    if let Ok(other) = other
        && found.as_ref().map_or(true, |found| {
            aim.merit(&other.evaluation.objectives) < aim.merit(&found.evaluation.objectives)
        })
    {
        found = Ok(other);
    }
    let bounded = Objective::OF_PLAN.iter().any(bound);
    let none = |found: &Result<Shape, NoShape>| matches!(found, Err(NoShape::NoGain | NoShape::Broken(_)));
    for (begin, first) in [
        (Begin::Passing, Aim::fastest()),
        (Begin::Stopping(&stops), Aim::fastest()),
        (Begin::Passing, Aim::smoother(ceilings)),
    ] {
        if none(&found) && bounded {
            found = begun(begin, Some(first)).or(found);
        }
    }
    found
}

fn sought_from(
    setup: &Setup,
    (timing, begin): (&Timing, Begin<'_>),
    (first, mut aim): (Option<Aim>, Aim),
    ceilings: &Ceilings,
    pieces: Option<usize>,
) -> Result<Shape, NoShape> {
    let intervals = setup.interval_count();
    // A motion of many intervals has two pieces of each, too.
    let many = FEWEST[0] * intervals > MOST[0];
    let most = MOST[usize::from(pieces.is_some() || many)];
    let room = most / intervals.max(1);
    // Steps of few joints are quick.
    let (all, each) = if setup.joint_count() <= FEW_JOINTS {
        (PIECES_OF_FEW_JOINTS / setup.joint_count().max(1), MOST_OF_FEW_JOINTS)
    } else {
        (PIECES, DEFAULT_MOST)
    };
    let usual = (all / intervals.max(1)).clamp(FEWEST[1], each).min(room).max(FEWEST[0]);
    let usual = OF_FEW.get(intervals).copied().unwrap_or(usual);
    // More than a descent takes are as many as it does.
    let pieces = pieces.unwrap_or(usual).min(room.max(FEWEST[0])).clamp(1, MOST_PIECES as usize);
    if intervals * pieces > most {
        return Err(NoShape::TooManyIntervals { found: intervals, most: most / pieces });
    }
    let chosen = &timing.objectives;
    // A fine curve begins as the best of a coarser one.
    let mut coarse = pieces;
    while coarse > DEFAULT_MOST && coarse.is_multiple_of(2) {
        coarse /= 2;
    }
    let (mut frame, mut curve) = match begin {
        Begin::Passing => start(setup, &timing.interval_s, coarse),
        Begin::Stopping(interval_s) => start(setup, interval_s, coarse).map(|start| stopping(start, coarse)),
    }
    .ok_or(NoShape::NoGain)?;
    let mut steps = 0;
    if let Some(first) = first {
        let end = descend(&frame, curve, &first, (STEPS, ENOUGH)).ok_or(NoShape::NoGain)?;
        steps += end.steps;
        curve = end.curve;
    }
    while coarse < pieces {
        let end = descend(&frame, curve, &aim, (STEPS, ENOUGH)).ok_or(NoShape::NoGain)?;
        steps += end.steps;
        (frame, curve) = frame.refined(&end.curve, 2).map_err(|_| NoShape::NoGain)?;
        coarse *= 2;
    }
    let mut found = None;
    for tried in 1..=TRIES {
        let end = descend(&frame, curve, &aim, (STEPS, ENOUGH)).ok_or(NoShape::NoGain)?;
        steps += end.steps;
        curve = end.curve;
        let load = load(setup, &frame, &curve)?;
        let again = load > KEPT_SHARE && tried < TRIES;
        match kept(setup, &frame, &curve) {
            Ok(evaluation) if aim.pace == Pace::Fastest => found = Some(quickened(setup, evaluation)),
            Ok(evaluation) => found = Some(evaluation),
            Err(error) if !again && found.is_none() => return Err(error),
            Err(_) => {}
        }
        let slower = found
            .as_ref()
            .map_or(1.0, |found| found.objectives[Objective::Duration] / chosen[Objective::Duration]);
        if again {
            aim.guard *= load * BETWEEN;
        } else if slower > 1.0
            && let Pace::Within(within_s) = &mut aim.pace
        {
            *within_s *= (1.0 - 1e-6) / slower;
        } else if let Some(found) =
            found.as_ref().filter(|found| aim.pace == Pace::Sought && !found.objectives.within(ceilings))
        {
            // What a plan is slowed down by at last may bring it above a ceiling.
            let over = |k: Objective| (found.objectives[k] / ceilings[k] * (1.0 + 1e-6)).max(1.0);
            aim.ceilings = aim.ceilings.map_plan(|k| aim.ceilings[k] / over(k));
        } else {
            break;
        }
    }
    let evaluation = found.ok_or(NoShape::NoGain)?;
    let within = Objective::OF_PLAN.iter().all(|&k| evaluation.objectives[k] <= ceilings[k]);
    let kept = timing.violation <= 0.0 && chosen.within(ceilings);
    if within && (!kept || aim.merit(&evaluation.objectives) < aim.merit(chosen)) {
        Ok(Shape { evaluation, pieces, steps })
    } else {
        Err(NoShape::NoGain)
    }
}

/// The curve of a timing with free points.
fn start<'a>(setup: &'a Setup, interval_s: &[f64], pieces: usize) -> Option<(Frame<'a>, Curve)> {
    let template = setup.template();
    let points = template.points();
    let limits = setup.limits.iter();
    let frame = Frame {
        setup,
        poses: setup.poses.iter().enumerate().filter_map(|(point, pose)| Some((point, (*pose)?))).collect(),
        dwells: setup.dwells(),
        key: (0..points.len()).collect(),
        bounds: limits
            .map(|limits| Bounds {
                limits: [limits.judged_rad, limits.speed_rad_s, limits.acceleration(), limits.jerk()],
            })
            .collect(),
    };
    let point_rad = (0..points.len()).flat_map(|point| points.of(point).iter().copied()).collect();
    frame.refined(&Curve { interval_s: interval_s.to_vec(), point_rad }, pieces).ok()
}

/// The largest share that a curve has of a load's limit: of those that a descent sees at single instants.
fn load(setup: &Setup, frame: &Frame<'_>, curve: &Curve) -> Result<f64, NoShape> {
    let (times_s, via) = listed(frame, &curve.interval_s, &curve.point_rad);
    let evaluation = PlanEvaluation::through(setup, &times_s, &via).map_err(|_| NoShape::NoGain)?;
    let loads = evaluation.margins.iter().filter(|margin| !margin.limit.is_of_the_spline());
    Ok(loads.fold(0.0, |most, margin| most.max(margin.share)))
}

/// Brings the free points of a joint nearer to the middle of its range, by twice what the curve is beyond an end.
fn pulled(frame: &Frame<'_>, point_rad: &mut [f64], margin: &Margin) {
    let Some((joint, bounds)) = margin.joint.and_then(|joint| Some((joint, frame.bounds.get(joint)?))) else {
        return;
    };
    let [low, high] = bounds.limits[0];
    let (middle, by) = (0.5 * (low + high), 1.0 - 2.0 * (margin.share - 1.0));
    for (point, angles) in point_rad.chunks_exact_mut(frame.joints()).enumerate() {
        if !frame.is_given(point) && frame.pose(point).is_none() {
            angles[joint] = middle + by * (angles[joint] - middle);
        }
    }
}

/// The plan of a curve, slowed down until all limits hold exactly.
fn kept(setup: &Setup, frame: &Frame<'_>, curve: &Curve) -> Result<PlanEvaluation, NoShape> {
    let (mut interval_s, mut point_rad, mut slower) =
        (curve.interval_s.clone(), curve.point_rad.clone(), 1.0);
    for tried in 0..SLOWINGS {
        let (times_s, via) = listed(frame, &interval_s, &point_rad);
        let evaluation = PlanEvaluation::through(setup, &times_s, &via).map_err(|_| NoShape::NoGain)?;
        let Some(worst) = evaluation.broken().first().map(|margin| **margin) else { return Ok(evaluation) };
        if worst.limit == Limit::Position && worst.share < ROUNDED {
            pulled(frame, &mut point_rad, &worst);
            continue;
        }
        let by = evaluation.broken().into_iter().map(factor).fold(1.0, f64::max) * (1.0 + CLEAR);
        // A load that is nearly one at rest falls far less than time grows.
        let by = by.powf(STRONGER.powi(tried));
        slower *= by;
        if worst.limit == Limit::Position || slower > SLOWEST {
            return Err(NoShape::Broken(worst));
        }
        for s in &mut interval_s {
            *s *= by;
        }
        frame.clamp(&mut interval_s);
    }
    Err(NoShape::NoGain)
}

/// Arrivals at the key points, s, and the free points between them.
fn listed(frame: &Frame<'_>, interval_s: &[f64], point_rad: &[f64]) -> (Vec<f64>, Vec<Via>) {
    let (mut times_s, mut via) = (Vec::new(), Vec::new());
    let points = frame.times_s(interval_s).into_iter().zip(point_rad.chunks_exact(frame.joints()));
    for (point, (t_s, position_rad)) in points.enumerate() {
        if frame.key.binary_search(&point).is_ok() {
            times_s.push(t_s);
        }
        if !frame.is_given(point) {
            via.push(Via { t_s, position_rad: position_rad.to_vec() });
        }
    }
    (times_s, via)
}
