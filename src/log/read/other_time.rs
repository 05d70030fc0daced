//! Finds measurements that follow their plan at another time: clocks that differ, or a run at another speed.

use crate::{
    math::{deviation, quantile, range, whole},
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

/// A motion that repeats itself fits as well a period later: a shift that leaves so much more of the motion, and with shifts between that
/// leave more than this share of it, is as good as the best, and the smallest of these is told, a lead counting so many times as a lag.
const ALIKE: f64 = 0.1;
const BETWEEN: f64 = 0.5;
const LEAD_COUNTS: f64 = 2.0;

/// Shifts between these are what machines do, s.
const USUAL_S: [f64; 2] = [-0.1, 1.0];

/// What is late may be a delay, as of a clock, and the lag of so many equal filters, as of set values, which takes up to so many tenths
/// of it: more is lag than is late where a plan ends early.
const FILTERS: [u32; 3] = [1, 2, 3];
const MOST_TENTHS: u32 = 12;

/// A change of what joints are late by from the first third of a run to the last that is none of the machine, s: so many joints change
/// so, each by this share as much as the one in the middle, and about half of it until the middle third.
const DRIFTS_S: f64 = 0.12;
const DRIFTING: usize = 2;
const DRIFTS_ALIKE: f64 = 0.4;
const EVENLY: std::ops::RangeInclusive<f64> = 0.25..=0.75;
/// The plan is as fast in each part, within this factor.
const AS_FAST: f64 = 1.4;
/// A part tells where the plan moves in it by this share of its motion.
const PART_TELLS: f64 = 0.3;

/// Durations by planned durations that machines keep.
const USUAL_PACE: [f64; 2] = [0.97, 1.03];

/// Another speed leaves less than this share of what a lag leaves.
const LESS_THAN_LAG: f64 = 0.5;

/// Share of its range after which a joint has begun to move, and before which it has not ended.
const BEGUN: f64 = 0.05;

/// Says that the joints follow their plan, but earlier, much later, slower or faster; of one clock only the last two.
pub(super) fn message(planned: &Series, measured: &Series, one_clock: bool) -> Option<String> {
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
    if !one_clock && late_s > USUAL_S[1] && left < LEFT[1] && delay_s > USUAL_S[1] {
        return Some(format!(
            "the joints move {late_s:.2} s after their plan, all of them, more than machines lag: the clocks of plan and \
             measurement differ, or the plan was stamped before it was started. --measured-delay-ms={:.0} puts one onto \
             the other, but takes the lag of the machine off, too",
            1e3 * late_s
        ));
    }
    another_pace(&joints, as_it_is, left_by_lag)
        .or_else(|| if one_clock { None } else { clocks_apart(&joints) })
}

/// Says that the run took another time than its plan, if that explains what is left.
fn another_pace(joints: &[Both], as_it_is: f64, left_by_lag: f64) -> Option<String> {
    let pace = Pace::of(joints)?;
    let usual = (USUAL_PACE[0]..=USUAL_PACE[1]).contains(&pace.ratio);
    let planned_s = |t_s: f64| pace.planned_s + (t_s - pace.measured_s) / pace.ratio;
    let left = apart(joints, |joint, t_s| joints[joint].planned.held_at(planned_s(t_s)).position);
    // The lag of a machine smears a short motion, which then seems to take longer.
    (!usual && left < LEFT[1] * as_it_is && left < LESS_THAN_LAG * left_by_lag).then(|| {
        format!(
            "the joints take {:.2} times as long as their plan: was the machine run at another speed (override)? Errors at \
             the same instant say little then, the distance to the path does",
            pace.ratio
        )
    })
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
        let Some([from_s, to_s]) = start_s(joint.planned) else { return false };
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

/// From when a plan leaves rest until it has gone a twentieth of its range, s.
fn start_s(planned: &Track) -> Option<[f64; 2]> {
    const LEFT: f64 = 0.002;
    let (t_s, q) = (planned.t_s(), planned.position());
    let [lowest, highest] = range(q.iter().copied());
    let gone = |share: f64| q.iter().position(|x| (x - q[0]).abs() > share * (highest - lowest));
    Some([t_s[gone(LEFT)?], t_s[gone(BEGUN)?]])
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

    fn lasts_s(&self) -> Option<f64> {
        Some(self.came.last()?[0] - self.came.first()?[0])
    }

    /// Root mean square speed of the plan, a second.
    fn planned_speed(&self) -> f64 {
        let at: Vec<f64> = self.came.iter().map(|[t_s, _]| self.planned.held_at(*t_s).position).collect();
        let squares: f64 = at.windows(2).map(|two| (two[1] - two[0]).powi(2)).sum();
        squares.sqrt() / self.lasts_s().unwrap_or(f64::INFINITY)
    }

    /// The three parts of a run; none of one in which the joint hardly moves.
    fn parts(&self) -> [Option<Both<'a>>; 3] {
        let each = self.came.len() / 3;
        [0, 1, 2].map(|part| {
            let came = self.came[part * each..(part + 1) * each].to_vec();
            let planned: Vec<f64> = came.iter().map(|[t_s, _]| self.planned.held_at(*t_s).position).collect();
            let (motion, moved) =
                (deviation(&planned), deviation(&came.iter().map(|[_, q]| *q).collect::<Vec<f64>>()));
            let tells = motion > PART_TELLS * self.motion && moved > MOVED * motion;
            tells.then_some(Both { planned: self.planned, measured: self.measured, came, motion })
        })
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
        let before = whole(steps);
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
    let at = |shift_s: f64| (apart(joints, |joint, t_s| plan(joint, t_s - shift_s)), shift_s);
    let mut best = (f64::INFINITY, 0.0);
    let mut reach_s = WIDEST_S;
    for step_s in STEPS_S {
        let tried = tried_s(best.1 - reach_s, best.1 + reach_s, step_s).map(at);
        best = tried.fold(best, |best, one| if one.0 < best.0 { one } else { best });
        reach_s = step_s;
    }
    let (left, best_s) = best;
    if (USUAL_S[0]..=STEPS_S[0]).contains(&best_s) {
        return best_s;
    }
    let tried: Vec<(f64, f64)> =
        tried_s(-best_s.abs(), LEAD_COUNTS * best_s.abs(), STEPS_S[1]).map(at).collect();
    let ridge = |shift_s: f64| {
        let between = tried.iter().filter(|(_, s)| (s - shift_s) * (s - best_s) < 0.0);
        between.map(|(left, _)| *left).fold(0.0, f64::max) > left + BETWEEN
    };
    let valleys = tried.windows(3).filter(|w| w[1].0 <= w[0].0 && w[1].0 <= w[2].0).map(|w| w[1]);
    let alike = valleys.filter(|(also, shift_s)| *also <= left + ALIKE && ridge(*shift_s));
    let counts = |shift_s: f64| shift_s.max(-LEAD_COUNTS * shift_s);
    let found = alike.map(|(_, shift_s)| shift_s).chain([best_s]);
    found.min_by(|a, b| counts(*a).total_cmp(&counts(*b))).unwrap_or(best_s)
}

/// Shifts from one to another in steps, s.
fn tried_s(from_s: f64, to_s: f64, step_s: f64) -> impl Iterator<Item = f64> {
    std::iter::successors(Some(from_s), move |shift_s| Some(shift_s + step_s))
        .take_while(move |shift_s| *shift_s <= to_s)
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
        // No zero below zero: a lag of that is no number.
        let lag_s = if shift_s > 0.0 { 0.1 * f64::from(tenths) * shift_s } else { 0.0 };
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
mod tests;
