//! Steps within one sample that no joint can make.

use crate::{
    math::quantile,
    remark::{Code, Remarks},
    series::{JointKind, Track},
};

/// A step of a plan that no joint can follow: rad or m, and rad/s or m/s; larger than the steps beside it by the factor.
const LEAST_STEP: f64 = 0.2;
const STEP_SPEED: f64 = 20.0;
const STEP_ALONE: f64 = 10.0;

/// A measured step that no joint makes is so many times the usual one, which nineteen of twenty stay below, and that of its plan,
/// and no less than this, rad and m, nor than joints go between two samples at this speed, rad/s and m/s; so many steps tell.
const BY_USUAL: f64 = 5.0;
const USUAL: f64 = 0.95;
const LEAST: [f64; 2] = [0.01, 0.005];
const LEAST_SPEED: [f64; 2] = [0.5, 0.25];
const TELL: usize = 20;

/// So many are none of a sensor that is held.
const FEW_STEPS: u64 = 10;

/// So many bad samples in a row that come back to within this share of their distance are left out.
const FEW: usize = 5;
const BACK: f64 = 0.1;

/// Remarks on a plan that jumps.
pub(super) fn of_plan(track: &Track, remarks: &mut Remarks) {
    let Some(Jumps { count, most, at_s }) = Jumps::of(track, LEAST_STEP, is_far) else { return };
    let message = format!(
        "steps of the plan of {} within one sample, the largest of {} at {at_s:.2} s: the plan itself jumps, which no joint can follow \
         at once, so its error begins with the step",
        track.name(),
        track.kind().says(most)
    );
    remarks.add(Code::PlanJumps, count, message);
}

/// Remarks on a measurement that jumps and stays there, while there is a plan.
pub(super) fn of_measurement(planned: &Track, track: &Track, remarks: &mut Remarks) {
    let has_plan = |to_s: f64| planned.at(to_s).is_some();
    let own = least_step(planned, track);
    let own = own.and_then(|least| Jumps::of(track, least, |_, [_, to_s]| has_plan(to_s)));
    // A sensor that is held makes many.
    let few = own.filter(|jumps| jumps.count <= FEW_STEPS);
    let any = || Jumps::of(track, LEAST_STEP, |step, span_s| is_far(step, span_s) && has_plan(span_s[1]));
    let Some(Jumps { count, most, at_s }) = few.or_else(any) else { return };
    let message = format!(
        "steps of the measured {} within one sample, the largest of {} at {at_s:.2} s: no joint moves so, and errors from there on are \
         the sensor's (a fault value, a lost reference, another zero, a slip, samples that were held)",
        track.name(),
        track.kind().says(most)
    );
    remarks.add(Code::Implausible, count, message);
}

/// Whether a step over a span of time, s, is none of any joint.
fn is_far(step: f64, [from_s, to_s]: [f64; 2]) -> bool {
    step > LEAST_STEP.max(STEP_SPEED * (to_s - from_s))
}

/// Whether no step is larger.
fn is_calm(position: &[f64], step: f64) -> bool {
    position.windows(2).fold(true, |calm, w| calm & ((w[1] - w[0]).abs() <= step))
}

/// A measurement without few samples in a row that lie where no joint goes and comes back from; `None` where there are none.
pub(super) fn without_excursions(planned: &Track, track: &Track) -> Option<Track> {
    let q = track.position();
    let least = least_step(planned, track)?;
    let mut bad = Vec::new();
    for part in track.segments() {
        let mut k = part.start + 1;
        while k + 1 < part.end {
            let far = |at: usize| (q[at] - q[k - 1]).abs();
            let away = (k..(k + FEW).min(part.end - 1)).take_while(|at| far(*at) > least);
            let after = away.last().map(|last| last + 1);
            // As near as it began, by a step back, and after a rest or a motion that has none.
            let nearest = after.map(|after| (k..after).map(far).fold(f64::INFINITY, f64::min));
            match after.zip(nearest).filter(|(after, nearest)| far(*after) < BACK * nearest) {
                Some((after, _)) => {
                    bad.extend(k..after);
                    k = after + 1;
                }
                None => k += 1,
            }
        }
    }
    if bad.is_empty() { None } else { track.keeping(|k| bad.binary_search(&k).is_err()) }
}

/// What no joint moves within one sample, by its plan and what it usually does; `None` where none of its steps is as large.
fn least_step(planned: &Track, track: &Track) -> Option<f64> {
    let q = track.position();
    let slides = usize::from(track.kind() == JointKind::Slides);
    let least = LEAST[slides].max(LEAST_SPEED[slides] * track.sample_interval_s());
    if is_calm(q, least) {
        return None;
    }
    let steps: Vec<f64> = q.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|step| *step > 0.0).collect();
    if steps.len() < TELL {
        return None;
    }
    let mut cursor = 0;
    let plan = track.t_s().iter().map(|t_s| planned.held_after(&mut cursor, *t_s).position);
    let plan: Vec<f64> = plan.collect();
    let planned = plan.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|step| *step > 0.0).collect();
    let usual = [steps, planned].map(|steps: Vec<f64>| quantile(steps, USUAL));
    Some(least.max(BY_USUAL * usual[0].max(usual[1])))
}

/// Steps of a track that no joint can make.
struct Jumps {
    count: u64,
    /// The largest, rad or m, and when, s.
    most: f64,
    at_s: f64,
}

impl Jumps {
    /// Those of more than this, of which this holds by their size and from when to when they last, s, and that stand alone; `None` of
    /// none.
    fn of(track: &Track, least: f64, counts: impl Fn(f64, [f64; 2]) -> bool) -> Option<Self> {
        let (t_s, position) = (track.t_s(), track.position());
        let mut found = Self { count: 0, most: 0.0, at_s: 0.0 };
        if is_calm(position, least) {
            return None;
        }
        for part in track.segments() {
            let step = |k: usize| (position[k] - position[k - 1]).abs();
            for k in part.start + 1..part.end {
                let beside = || [k - 1, k + 1].into_iter().filter(|k| (part.start + 1..part.end).contains(k));
                let counts = step(k) > least && counts(step(k), [t_s[k - 1], t_s[k]]);
                if counts && step(k) > STEP_ALONE * beside().map(step).fold(0.0, f64::max) {
                    found.count += 1;
                    if step(k) > found.most {
                        (found.most, found.at_s) = (step(k), t_s[k]);
                    }
                }
            }
        }
        (found.count > 0).then_some(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(t: f64) -> f64 {
        0.2 * (t - 2.0).clamp(0.0, 4.0)
    }

    fn noise(t: f64) -> f64 {
        1e-4 * (1e7 * t * t).sin()
    }

    fn of(course: impl Fn(f64) -> f64) -> (Remarks, Option<usize>) {
        let track = |at: &dyn Fn(f64) -> f64| Track::sampled("a", 1000, at);
        let (planned, measured) = (track(&plan), track(&|t| course(t) + noise(t)));
        let mut remarks = Remarks::default();
        of_measurement(&planned, &measured, &mut remarks);
        (remarks, without_excursions(&planned, &measured).map(|own| own.len()))
    }

    #[test]
    fn a_slip_is_told_and_what_joints_do_is_not() {
        let (remarks, left) = of(|t| plan(t - 0.2) - if t < 7.0 { 0.0 } else { 0.05 });
        assert_eq!((remarks.as_slice().len(), left), (1, None));
        assert!(
            remarks.as_slice()[0].message.contains("2.8") && remarks.as_slice()[0].message.contains("7.00 s")
        );
        let stairs = |t: f64| plan((10.0 * (t - 0.2)).floor() / 10.0);
        let breaks_away =
            |t: f64| plan(t - 0.2) + if t < 3.0 { 0.0 } else { 0.02 * (t - 3.0).min(0.1) / 0.1 };
        for course in [&(|t: f64| plan(t - 0.2)) as &dyn Fn(f64) -> f64, &stairs, &breaks_away] {
            let (remarks, left) = of(course);
            assert!(remarks.as_slice().is_empty() && left.is_none(), "{remarks:?} {left:?}");
        }
    }

    #[test]
    fn a_jump_of_a_joint_that_stands_is_told_and_a_jog_by_hand_between_slow_samples_is_kept() {
        let track = |rate_hz: f64, at: &dyn Fn(f64) -> f64| {
            let t_s: Vec<f64> = (0..200).map(|k| f64::from(k) / rate_hz).collect();
            Track::new("a", t_s.clone(), t_s.iter().map(|t_s| at(*t_s)).collect::<Vec<f64>>(), &[]).unwrap()
        };
        let mut remarks = Remarks::default();
        let steps = track(100.0, &|t| if t < 1.0 { 0.0 } else { 0.5 });
        of_measurement(&track(100.0, &|_| 0.0), &steps, &mut remarks);
        assert_eq!(remarks.as_slice().len(), 1);
        let jogs = track(1.0, &|t| noise(t) + if (90.5..93.5).contains(&t) { 0.1 } else { 0.0 });
        assert_eq!(without_excursions(&track(1.0, &|_| 0.0), &jogs), None);
    }

    #[test]
    fn few_bad_samples_are_left_out_also_up_and_down() {
        let at = |t: f64, from: f64, to: f64| t > from - 0.005 && t < to + 0.005;
        let bad = |t: f64| match t {
            t if at(t, 4.0, 4.0) => 0.5,
            t if at(t, 4.01, 4.01) => -0.5,
            t if at(t, 7.0, 7.02) => 0.3,
            _ => 0.0,
        };
        assert_eq!(of(|t| plan(t - 0.2) + bad(t)).1, Some(995));
    }
}
