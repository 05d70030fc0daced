//! Finds measurements that follow their plan at another time: clocks that differ, or a run at another speed.

use crate::{
    math::{deviation, quantile},
    series::{Series, Track},
};

/// Instants at which plan and measurement are compared.
const INSTANTS: usize = 400;

/// Planned motion, root mean square distance from its mean, of a joint that can tell: rad or m.
const TELLS: f64 = 0.01;

/// Measured motion by planned motion of a joint that can tell.
const MOVED: f64 = 0.5;

/// Runs whose joints lie this far from their plan, root mean square by planned motion, are looked at.
const FAR: f64 = 0.05;

/// What is left of that if the time is the reason: of what no machine does, and of what one at its limits does in part.
const LEFT: [f64; 2] = [0.4, 0.2];

/// What is left of an error that every joint has because it is before its plan.
const LEFT_BY_ALL: f64 = 0.7;

/// Shifts that are tried, s, by coarse and by fine steps.
const WIDEST_S: f64 = 15.0;
const STEPS_S: [f64; 2] = [0.25, 0.01];

/// A search for a shift looks at a plan in steps, s, up to so many; one that is longer is looked up each time.
const PLAN_STEP_S: f64 = 0.02;
const MOST_STEPS: f64 = 1e6;

/// Shifts between these are what machines do, s.
const USUAL_S: [f64; 2] = [-0.1, 1.0];

/// What is late may be a delay, as of a clock, and the lag of so many equal filters, as of set values, which takes up to so many tenths
/// of it: more is lag than is late where a plan ends early.
const FILTERS: [u32; 3] = [1, 2, 3];
const MOST_TENTHS: u32 = 12;

/// Durations by planned durations that machines keep.
const USUAL_PACE: [f64; 2] = [0.97, 1.03];

/// Another speed leaves less than this share of what a lag leaves.
const LESS_THAN_LAG: f64 = 0.5;

/// Share of its range after which a joint has begun to move, and before which it has not ended.
const BEGUN: f64 = 0.05;

/// Says that the joints follow their plan, but earlier, much later, slower or faster.
pub(super) fn message(planned: &Series, measured: &Series) -> Option<String> {
    let both = |track| Both::of(track, measured.track(track.name())?);
    let joints: Vec<Both> = planned.tracks.iter().filter_map(both).collect();
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
    if late_s < USUAL_S[0] && (left < LEFT[0] || left < LEFT_BY_ALL && all_before()) {
        return Some(format!(
            "the joints move {:.2} s before their plan, which no machine does: the clocks of plan and measurement differ. \
             --measured-delay-ms={:.0} puts one onto the other, but takes the lag of the machine off, too",
            -late_s,
            1e3 * late_s
        ));
    }
    let (left_by_lag, delay_s) = lagged(&joints, late_s);
    if late_s > USUAL_S[1] && left < LEFT[1] && delay_s > USUAL_S[1] {
        return Some(format!(
            "the joints move {late_s:.2} s after their plan, all of them, more than machines lag: the clocks of plan and \
             measurement differ, or the plan was stamped before it was started. --measured-delay-ms={:.0} puts one onto \
             the other, but takes the lag of the machine off, too",
            1e3 * late_s
        ));
    }
    let pace = Pace::of(&joints)?;
    let usual = (USUAL_PACE[0]..=USUAL_PACE[1]).contains(&pace.ratio);
    let planned_s = |t_s: f64| pace.planned_s + (t_s - pace.measured_s) / pace.ratio;
    let left = apart(&planned_s);
    // The lag of a machine smears a short motion, which then seems to take longer.
    (!usual && left < LEFT[1] * as_it_is && left < LESS_THAN_LAG * left_by_lag).then(|| {
        format!(
            "the joints take {:.2} times as long as their plan: was the machine run at another speed (override)? Errors at \
             the same instant say little then, the distance to the path does",
            pace.ratio
        )
    })
}

/// By how much all joints together seem to be late, s; zero of none.
pub(super) fn late_s(planned: &Series, measured: &Series) -> f64 {
    let both = |track| Both::of(track, measured.track(Track::name(track))?);
    let joints: Vec<Both> = planned.tracks.iter().filter_map(both).collect();
    if joints.is_empty() { 0.0 } else { shift_s(&joints) }
}

/// A joint's plan, and some of its measurement.
struct Both<'a> {
    planned: &'a Track,
    measured: &'a Track,
    /// Instant, s, and position, while there is a plan.
    came: Vec<[f64; 2]>,
    /// Root mean square distance of the plan from its mean.
    motion: f64,
}

impl<'a> Both<'a> {
    /// `None` for a joint that is not planned to move, or did not.
    fn of(planned: &'a Track, measured: &'a Track) -> Option<Self> {
        let [first_s, last_s] = [planned.t_s().first()?, planned.t_s().last()?];
        let within = measured.t_s().partition_point(|t_s| t_s < first_s)
            ..measured.t_s().partition_point(|t_s| t_s <= last_s);
        let (t_s, q) = (measured.t_s().get(within.clone())?, measured.position().get(within)?);
        let step = t_s.len().div_ceil(INSTANTS).max(1);
        let came: Vec<[f64; 2]> = t_s.iter().zip(q).step_by(step).map(|(t_s, q)| [*t_s, *q]).collect();
        let motion =
            deviation(&came.iter().map(|[t_s, _]| planned.held_at(*t_s).position).collect::<Vec<f64>>());
        let moved = deviation(&came.iter().map(|[_, q]| *q).collect::<Vec<f64>>());
        (motion > TELLS && moved > MOVED * motion).then_some(Self { planned, measured, came, motion })
    }

    /// Root mean square error by planned motion, where the plan is so.
    fn apart(&self, plan: impl Fn(f64) -> f64) -> f64 {
        let square = |[t_s, q]: &[f64; 2]| (q - plan(*t_s)).powi(2);
        (self.came.iter().map(square).sum::<f64>() / self.came.len() as f64).sqrt() / self.motion
    }
}

/// A plan in even steps, with lines between them.
struct Steps {
    first_s: f64,
    position: Vec<f64>,
}

impl Steps {
    /// `None` if the plan is so long that steps would take more memory than they are worth.
    fn of(planned: &Track) -> Option<Self> {
        let [first_s, last_s] = [*planned.t_s().first()?, *planned.t_s().last()?];
        let steps = ((last_s - first_s) / PLAN_STEP_S).ceil();
        if steps > MOST_STEPS {
            return None;
        }
        let mut cursor = 0;
        let at = |k: f64| planned.held_after(&mut cursor, first_s + k * PLAN_STEP_S).position;
        let position =
            std::iter::successors(Some(0.0), |k| (*k < steps).then_some(k + 1.0)).map(at).collect();
        Some(Self { first_s, position })
    }

    /// Behind so many filters of a time constant, s.
    fn lagged(&self, filters: u32, time_s: f64) -> Self {
        let follow = 1.0 - (-PLAN_STEP_S / time_s).exp();
        let mut position = self.position.clone();
        for _ in 0..filters {
            let mut now = position[0];
            for at in &mut position {
                now += follow * (*at - now);
                *at = now;
            }
        }
        Self { first_s: self.first_s, position }
    }

    /// Before the first step and after the last, the plan holds.
    fn at(&self, t_s: f64) -> f64 {
        let steps = ((t_s - self.first_s) / PLAN_STEP_S).clamp(0.0, (self.position.len() - 1) as f64);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the steps")]
        let before = steps as usize;
        let (from, to) = (self.position[before], self.position[(before + 1).min(self.position.len() - 1)]);
        from + (steps - steps.floor()) * (to - from)
    }
}

/// That of the joint in the middle, by the position that the plan of each has at an instant; NaN without a joint.
fn apart(joints: &[Both], plan: impl Fn(usize, f64) -> f64) -> f64 {
    let each = joints.iter().enumerate();
    quantile(each.map(|(joint, both)| both.apart(|t_s| plan(joint, t_s))).collect(), 0.5)
}

/// By how much the measurement is later than a plan that it follows best, s.
fn shift_s(joints: &[Both]) -> f64 {
    let steps: Vec<Option<Steps>> = joints.iter().map(|joint| Steps::of(joint.planned)).collect();
    let plan = |joint: usize, t_s: f64| match &steps[joint] {
        Some(steps) => steps.at(t_s),
        None => joints[joint].planned.held_at(t_s).position,
    };
    let mut best = (f64::INFINITY, 0.0);
    let mut reach_s = WIDEST_S;
    for step_s in STEPS_S {
        let middle_s = best.1;
        let mut shift_s = middle_s - reach_s;
        while shift_s <= middle_s + reach_s {
            let apart = apart(joints, |joint, t_s| plan(joint, t_s - shift_s));
            if apart < best.0 {
                best = (apart, shift_s);
            }
            shift_s += step_s;
        }
        reach_s = step_s;
    }
    best.1
}

/// Of a delay and a lag that are so late together the pair that leaves least: what that is, and the delay, s. No lag is told from a plan
/// too long for steps.
fn lagged(joints: &[Both], shift_s: f64) -> (f64, f64) {
    let Some(steps) = joints.iter().map(|joint| Steps::of(joint.planned)).collect::<Option<Vec<Steps>>>()
    else {
        let left = apart(joints, |joint, t_s| joints[joint].planned.held_at(t_s - shift_s).position);
        return (left, shift_s);
    };
    let pair = |(filters, tenths): (u32, u32)| {
        let lag_s = (0.1 * f64::from(tenths) * shift_s).max(0.0);
        let delay_s = shift_s - lag_s;
        let plans: Vec<Steps> =
            steps.iter().map(|steps| steps.lagged(filters, lag_s / f64::from(filters))).collect();
        (apart(joints, |joint, t_s| plans[joint].at(t_s - delay_s)), delay_s)
    };
    let tried =
        FILTERS.into_iter().flat_map(|filters| (0..=MOST_TENTHS).map(move |tenths| (filters, tenths)));
    tried.map(pair).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, shift_s))
}

/// Where a motion begins in plan and measurement, s, and how much longer the measured one takes.
struct Pace {
    planned_s: f64,
    measured_s: f64,
    ratio: f64,
}

impl Pace {
    /// Of the joint that moves most.
    fn of(joints: &[Both]) -> Option<Self> {
        let joint = joints.iter().max_by(|a, b| a.motion.total_cmp(&b.motion))?;
        let [planned, measured] = [motion_s(joint.planned)?, motion_s(joint.measured)?];
        let ratio = (measured[1] - measured[0]) / (planned[1] - planned[0]);
        ratio.is_finite().then_some(Self { planned_s: planned[0], measured_s: measured[0], ratio })
    }
}

/// When a joint has left where it begins, and when it is not yet where it ends, s.
fn motion_s(track: &Track) -> Option<[f64; 2]> {
    let (t_s, q) = (track.t_s(), track.position());
    let (lowest, highest) =
        q.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &q| (a.min(q), b.max(q)));
    let far = |from: f64, q: f64| (q - from).abs() > BEGUN * (highest - lowest);
    let first = q.iter().position(|x| far(q[0], *x))?;
    let last = q.iter().rposition(|x| far(q[q.len() - 1], *x))?;
    Some([t_s[first], t_s[last]])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(at_s: impl Fn(f64) -> f64) -> Series {
        let step = |t: f64| {
            let x = t.clamp(0.0, 1.0);
            x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)
        };
        let plan = |joint: f64, t: f64| joint * (step((t - 4.0) / 8.0) - 0.6 * step((t - 20.0) / 6.0));
        let t_s: Vec<f64> = (0..4000).map(|k| f64::from(k) * 0.01).collect();
        let track = |name: &str, size: f64| {
            let q = t_s.iter().map(|&t| plan(size, at_s(t))).collect();
            Track::new(name, t_s.clone(), q, &[]).unwrap()
        };
        Series { tracks: vec![track("swing", 1.0), track("boom", -0.5), track("stick", 0.8)] }
    }

    fn said(at_s: impl Fn(f64) -> f64) -> Option<String> {
        message(&series(|t| t), &series(at_s))
    }

    #[test]
    fn clocks_that_differ_and_another_speed_are_told() {
        for (by_s, told) in
            [(-2.0, "2.00 s before"), (-0.8, "0.80 s before"), (3.0, "3.00 s after"), (9.3, "9.30 s")]
        {
            let found = said(|t| t - by_s);
            assert!(found.as_ref().is_some_and(|one| one.contains(told)), "{by_s}: {found:?}");
        }
        for (pace, told) in [(1.25, "1.25 times as long"), (0.7, "0.70 times as long"), (1.4, "1.40 times")] {
            let found = said(|t| 4.0 + (t - 4.0) / pace);
            assert!(found.as_ref().is_some_and(|one| one.contains(told)), "{pace}: {found:?}");
        }
    }

    #[test]
    fn what_machines_do_is_not() {
        assert_eq!(said(|t| t), None);
        assert_eq!(said(|t| t - 0.6), None);
        assert_eq!(said(|_| 0.0), None, "none moves");
        let plan = series(|t| t);
        for share in [0.9, 0.7, 0.5, 0.35] {
            let limited = |track: &Track| {
                let fastest = track.position().windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
                let mut now = track.position()[0];
                let follow = |q: &f64| {
                    now += (q - now).clamp(-share * fastest, share * fastest);
                    now
                };
                let q = track.position().iter().map(follow).collect();
                Track::new(track.name(), track.t_s(), q, &[]).unwrap()
            };
            let measured = Series { tracks: plan.tracks.iter().map(limited).collect() };
            assert_eq!(message(&plan, &measured), None, "all at {share} of the speed that is asked");
        }
        assert_eq!(said(|t| t.min(10.0)), None, "they stop for good");
        // A short motion behind a delay and a lag takes longer, and no other speed.
        let short = |at_s: f64| {
            let x = ((at_s - 4.0) / 1.2).clamp(0.0, 1.0);
            0.5 * x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)
        };
        let t_s: Vec<f64> = (0..1200).map(|k| f64::from(k) * 0.01).collect();
        let mut now = 0.0;
        let follow = |t: &f64| {
            now += (short(t - 0.1) - now) * (1.0 - (-0.01_f64 / 0.25).exp());
            now
        };
        let measured = Track::new("boom", t_s.clone(), t_s.iter().map(follow).collect(), &[]).unwrap();
        let planned = Track::new("boom", t_s.clone(), t_s.iter().map(|t| short(*t)).collect(), &[]).unwrap();
        let [planned, measured] = [planned, measured].map(|track| Series { tracks: vec![track] });
        assert_eq!(message(&planned, &measured), None, "a short motion");
    }

    #[test]
    fn a_slow_filter_of_set_values_is_no_clock_and_hides_none() {
        let plan = series(|t| t);
        let said = |filters: u32, lag_s: f64, late_s: f64| {
            let behind = |track: &Track| {
                let time_s = lag_s / f64::from(filters);
                let mut q = track.position().to_vec();
                for _ in 0..filters {
                    let mut now = q[0];
                    for at in &mut q {
                        now += (*at - now) * (1.0 - (-0.01 / time_s).exp());
                        *at = now;
                    }
                }
                Track::new(track.name(), track.t_s(), q, &[]).unwrap()
            };
            let measured = Series { tracks: series(|t| t - late_s).tracks.iter().map(behind).collect() };
            message(&plan, &measured)
        };
        for (filters, lag_s) in [(1, 1.4), (2, 1.1), (2, 1.6), (3, 1.8)] {
            assert_eq!(said(filters, lag_s, 0.0), None, "{filters} filters, {lag_s} s together");
        }
        // One filter as slow as the clock is late looks like three without a clock: that is not told.
        for (filters, lag_s) in [(1, 0.3), (1, 0.44), (2, 0.8), (2, 1.1), (2, 1.6), (3, 1.8)] {
            let late = said(filters, lag_s, 1.5);
            assert!(late.is_some(), "{filters} filters, {lag_s} s together, on another clock");
        }
    }
}
