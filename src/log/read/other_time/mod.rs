//! Finds measurements that follow their plan at another time: clocks that differ, or a run at another speed.

mod behind;
mod both;
mod pace;

pub(super) use behind::Behind;
use both::{Both, FAR, LEFT, USUAL_S, apart, lagged, shift_s};
use pace::another_pace;

use crate::{
    math::{quantile, range},
    series::Series,
};

/// What is left of an error that every joint has because it is before its plan.
const LEFT_BY_ALL: f64 = 0.7;

/// A change of what joints are late by from the first third of a run to the last that is none of the machine, s: so many joints change
/// so, each by this share as much as the one in the middle, and about half of it until the middle third.
const DRIFTS_S: f64 = 0.12;
const DRIFTING: usize = 2;
const DRIFTS_ALIKE: f64 = 0.4;
const EVENLY: std::ops::RangeInclusive<f64> = 0.25..=0.75;
/// Share of time by which clocks run apart at most, where it changes so.
const SLIGHTLY: f64 = 0.02;
/// The plan is as fast in each part, within this factor.
const AS_FAST: f64 = 1.4;

/// Says that the joints follow their plan, but earlier, much later, slower or faster; of one clock only the last two.
pub(super) fn message(planned: &Series, measured: &Series, one_clock: bool) -> Option<String> {
    let joints = Both::all(planned, measured);
    let apart = |planned_s: &dyn Fn(f64) -> f64| {
        apart(&joints, |joint, t_s| joints[joint].planned.held_at(planned_s(t_s)).position)
    };
    let as_it_is = apart(&|t_s| t_s);
    if !as_it_is.is_finite() || as_it_is < FAR {
        return None;
    }
    let late_s = shift_s(&joints);
    let left = apart(&|t_s| t_s - late_s) / as_it_is;
    // What leaves more may be joints that lead each by itself, which is no clock unless all of them do.
    let all_before = || joints.len() > 1 && (0..joints.len()).all(|k| shift_s(&joints[k..=k]) < USUAL_S[0]);
    if !one_clock
        && late_s < USUAL_S[0]
        && (left < LEFT[0] || left < LEFT_BY_ALL && all_before())
        && !leave_in_time(&joints, late_s)
    {
        return Some(format!(
            "the joints move {:.2} s before their plan from their starts on, as no machine does that is sent its plan in time: the clocks \
             of plan and measurement differ, or the controller looks ahead. \
             --measured-delay-ms={:.0} puts one onto the other, but takes the lag of the machine off, too; --measured-delay-ms=0 \
             says that both are of one clock",
            -late_s,
            1e3 * late_s
        ));
    }
    let (left_by_lag, delay_s) = lagged(&joints, late_s);
    // Steadily, and by so little, clocks run apart.
    let steady =
        || drift(&joints).is_some_and(|[from_s, to_s, over_s]| (to_s - from_s).abs() < SLIGHTLY * over_s);
    let pace = another_pace(&joints, as_it_is, left_by_lag);
    if pace.is_none()
        && !steady()
        && let Some(behind) = Behind::of(planned, measured)
    {
        return Some(behind.message(planned));
    }
    if !one_clock && late_s > USUAL_S[1] && left < LEFT[1] && delay_s > USUAL_S[1] {
        return Some(format!(
            "the joints move {late_s:.2} s after their plan, all of them, more than machines lag: the clocks of plan and \
             measurement differ, or the plan was stamped before it was started. --measured-delay-ms={:.0} puts one onto \
             the other, but takes the lag of the machine off, too",
            1e3 * late_s
        ));
    }
    pace.or_else(|| if one_clock { None } else { clocks_apart(&joints) })
}

/// Says that joints come later and later, or earlier and earlier.
fn clocks_apart(joints: &[Both]) -> Option<String> {
    let [first_s, last_s, over_s] = drift(joints)?;
    Some(format!(
        "the joints are {first_s:.2} s behind their plan at first and {last_s:.2} s at the end, and it changes steadily: the clocks of \
         plan and measurement seem to run {:.1} % apart, or the machine goes on changing; delays, lags and what a fit says of them are \
         wrong by that. --time publish or log takes one clock for both where the log has one; --measured-delay-ms=0 says that both are \
         of one clock",
        100.0 * (last_s - first_s).abs() / over_s
    ))
}

/// By how much most joints are behind their plan in the first part of the run and in the last one, s, and from the middle of the one to
/// that of the other, s, where it changes steadily and alike.
fn drift(joints: &[Both]) -> Option<[f64; 3]> {
    let late = |joint: &Both| match joint.parts() {
        [Some(first), Some(middle), Some(last)] => {
            // A joint at its speed limit, or in its dead band, is later the faster or the slower its plan.
            let [slowest, fastest] = range([&first, &middle, &last].map(Both::planned_speed));
            (fastest <= AS_FAST * slowest).then(|| [first, middle, last].map(|part| shift_s(&[part])))
        }
        _ => None,
    };
    let each: Vec<[f64; 3]> = joints.iter().filter_map(late).collect();
    if each.len() < DRIFTING {
        return None;
    }
    let of = |at: fn(&[f64; 3]) -> f64| quantile(each.iter().map(at).collect(), 0.5);
    let change_s = of(|late| late[2] - late[0]);
    let steadily = |late: &&[f64; 3]| {
        let share = (late[1] - late[0]) / (late[2] - late[0]);
        EVENLY.contains(&share) && ((late[2] - late[0]) / change_s - 1.0).abs() < DRIFTS_ALIKE
    };
    let alike = each.iter().filter(steadily).count();
    let over_s = joints.iter().filter_map(Both::lasts_s).fold(0.0, f64::max) * 2.0 / 3.0;
    let counts = change_s.abs() > DRIFTS_S && alike >= DRIFTING && 4 * alike >= 3 * each.len();
    counts.then(|| [of(|late| late[0]), of(|late| late[2]), over_s])
}

/// Whether most joints leave rest nearer to their plan as it is than to one of so much before, s: they lead later on, as those do whose
/// controller asks for too much speed, and by no clock.
fn leave_in_time(joints: &[Both], late_s: f64) -> bool {
    let in_time = |joint: &&Both| {
        let Some([from_s, to_s]) = joint.start_s() else { return false };
        let track = joint.measured;
        let within = |t_s: &f64| (from_s + late_s..=to_s).contains(t_s);
        let came = track.t_s().iter().zip(track.position()).filter(|(t_s, _)| within(t_s));
        let [as_it_is, shifted] = came.fold([0.0; 2], |sums, (t_s, q)| {
            let off = |by_s: f64| (q - joint.planned.held_at(t_s - by_s).position).powi(2);
            [sums[0] + off(0.0), sums[1] + off(late_s)]
        });
        as_it_is < shifted
    };
    2 * joints.iter().filter(in_time).count() > joints.len()
}

/// By how much all joints together seem to be late, s; zero of none.
pub(super) fn late_s(planned: &Series, measured: &Series) -> f64 {
    let joints = Both::all(planned, measured);
    if joints.is_empty() { 0.0 } else { shift_s(&joints) }
}

#[cfg(test)]
mod tests;
