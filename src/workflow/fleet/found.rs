//! Which changes of a fleet's joints are found: those that chance does not make, that matter, and that other machines do
//! not share.

use std::{collections::BTreeMap, path::Path};

use super::{
    course::Change,
    history::By,
    joint_trend::{FEWEST_OF_A_SIDE, FEWEST_RUNS, JointTrend, MOST_FALSE},
    stepped::LevelStep,
};
use crate::math::{SIGMA_PER_MAD, false_discovery, mad, mean, median, theil_sen};

/// Robust standard deviations of the fleet's changes that a change must stand out by to be found: less than that many
/// healthy joints change by, in a season or with other work.
const STANDS_OUT: f64 = 3.0;
/// Joints that tell what is usual, at least; of steps, those of other machines.
const FEWEST_JOINTS: usize = 10;
const FEWEST_OF_STEPS: usize = 4;
/// Half of a 95 % interval, in standard deviations.
const SIGMAS_OF_95: f64 = 1.96;
/// Days that are this share of others are nearly the same ones.
const MOST_OF_IT: f64 = 0.9;
/// A step, or what a trend makes from the first run to the last, that is a smaller share of the level is of no concern.
const RELEVANT: f64 = 0.02;

/// Which trends and steps are found. Both are tests of the same data, so they are corrected for together.
pub(super) fn judge(trends: &mut [JointTrend]) {
    let tell = stand_out(trends);
    let p_trend = trends.iter().map(|trend| trend.p_value);
    let q = false_discovery(&p_trend.chain(trends.iter().map(p_change)).collect::<Vec<f64>>());
    let (q_trend, q_change) = q.split_at(trends.len());
    // Of the two ways to change the one that chance makes more often is less sure by as much.
    let q_of = |p: fn(&JointTrend) -> Option<f64>| -> Vec<f64> {
        let each = trends.iter().zip(q_change).map(|(trend, q)| {
            let share = p(trend).map_or(f64::INFINITY, |p| p / least_p(trend).max(f64::MIN_POSITIVE));
            (q * share.max(1.0)).min(1.0)
        });
        each.collect()
    };
    let (q_step, q_course) = (q_of(p_step), q_of(p_course));
    let (q_step, q_course) = (&q_step[..], &q_course[..]);
    // One of them found is a change found; which way it changed is told by its own levels, whatever else is asked for.
    let q_least: Vec<f64> = (0..trends.len()).map(|k| q_trend[k].min(q_step[k]).min(q_course[k])).collect();
    let at_step = |own: &JointTrend| Some(own.levels.get(own.step.as_ref()?.runs_before)?.at_days);
    let steps = |(own, q): (&JointTrend, &f64)| {
        if *q < MOST_FALSE { elsewhere(trends, own, at_step(own)?) } else { None }
    };
    let elsewhere: Vec<Option<(f64, f64)>> = trends.iter().zip(&q_least).map(steps).collect();
    let changes = |(own, q): (&JointTrend, &f64)| {
        let is_course = *q < MOST_FALSE && p_course(own).is_some_and(|p| p < MOST_FALSE);
        if is_course { changes(trends, own) } else { Vec::new() }
    };
    let changes: Vec<Vec<Change>> = trends.iter().zip(&q_least).map(changes).collect();
    for ((k, trend), changes) in trends.iter_mut().enumerate().zip(changes) {
        trend.q_value = q_trend[k];
        let usual = tell[k] && trend.stands_out.is_some_and(|out| out < STANDS_OUT);
        let least = RELEVANT * trend.level.abs();
        let surely = q_least[k] < MOST_FALSE;
        let one_way = trend.interval_95[0] * trend.interval_95[1] >= 0.0;
        let by = (trend.slope_per_day * trend.changing_days).abs();
        let span = span_days(trend);
        let is_own = trend.own.slope(trend.slope_per_day, [span[1] - trend.changing_days, span[1]]);
        let drifts = surely && one_way && !usual && by >= least && is_own;
        if let Some(step) = &mut trend.step {
            step.q_value = q_step[k];
            let beyond = beyond(step.change, step.interval_95, least, elsewhere[k]);
            let at = |run: usize| trend.levels.get(run).map_or(0.0, |level| level.at_days);
            let is_own =
                trend.own.step(step.change, [at(step.runs_before.saturating_sub(1)), at(step.runs_before)]);
            let steps = surely && step.change.abs() >= least && beyond && is_own;
            // What a drift explains nearly as well is one: its growth a day is the smaller claim.
            trend.is_step = steps && (!drifts || step.is_sure());
            if trend.is_step {
                step.q_value = q_least[k];
                trend.since.clone_from(&step.by);
            }
        }
        if drifts {
            trend.q_value = q_least[k];
        }
        trend.found = drifts || trend.is_step;
        if let Some((last, course)) = changes.last().zip(trend.course.as_ref()) {
            (trend.found, trend.is_step) = (true, last.per_day.is_none());
            (trend.slope_per_day, trend.interval_95) = course.ends;
            // What grew and then stayed changed within days.
            trend.is_step |= course.ends.0.abs() <= 0.0;
            if trend.is_step {
                trend.step = Some(LevelStep::of(last, (course.p_value, q_least[k])));
                trend.since.clone_from(&last.by);
            } else {
                trend.q_value = q_least[k];
                trend.since.clone_from(&last.after);
            }
            trend.line.clone_from(&course.line);
            trend.changes = changes;
        }
        if trend.found {
            trend.levels.iter_mut().for_each(|level| level.page = page_beside(&level.log));
        } else {
            trend.levels.clear();
        }
    }
}

fn p_step(trend: &JointTrend) -> Option<f64> {
    trend.step.as_ref().map(|step| step.p_value)
}

fn p_course(trend: &JointTrend) -> Option<f64> {
    trend.course.as_ref().map(|course| course.p_value)
}

fn least_p(trend: &JointTrend) -> f64 {
    p_step(trend).into_iter().chain(p_course(trend)).fold(1.0, f64::min)
}

/// Probability of a step or a course by chance, of which the surer one counts.
fn p_change(trend: &JointTrend) -> f64 {
    let ways = p_step(trend).into_iter().chain(p_course(trend)).count() as f64;
    (ways.max(1.0) * least_p(trend)).min(1.0)
}

/// Whether a change is clearly more than that of others: the middle of these, and their spread.
fn beyond(change: f64, [low, high]: [f64; 2], least: f64, others: Option<(f64, f64)>) -> bool {
    // What others changed by and what this one did are known so well only.
    let own = (high - low) / (2.0 * SIGMAS_OF_95);
    others.is_none_or(|(middle, spread)| (change - middle).abs() >= least.max(STANDS_OUT * spread.hypot(own)))
}

/// What of a course matters, and is not what the joints of other machines do in the same days.
fn changes(trends: &[JointTrend], own: &JointTrend) -> Vec<Change> {
    let least = RELEVANT * own.level.abs();
    let own_change = |change: &&Change| {
        let others = match change.per_day {
            None => elsewhere(trends, own, change.at_days[1]),
            Some(_) => elsewhere_between(trends, own, change.at_days),
        };
        is_own(own, change)
            && change.change.abs() >= least
            && beyond(change.change, change.interval_95, least, others)
    };
    let all = || own.course.iter().flat_map(|course| &course.changes);
    // A course is as sure as its largest change: where that is of the others, the rest is not known.
    let largest = all().max_by(|a, b| a.change.abs().total_cmp(&b.change.abs()));
    if largest.is_some_and(|change| !is_own(own, change)) {
        return Vec::new();
    }
    all().filter(own_change).cloned().collect()
}

/// Whether a change is in the joint's own levels, too.
fn is_own(own: &JointTrend, change: &Change) -> bool {
    match change.per_day {
        None => own.own.step(change.change, change.at_days),
        Some((per_day, _)) => own.own.slope(per_day, change.at_days),
    }
}

/// What trends are compared with one another.
fn kind(trend: &JointTrend) -> (By, bool, &str) {
    (trend.metric, trend.direction.is_some(), &trend.unit)
}

/// By how much the joints of other machines changed between two days: the middle, and the spread as a robust standard deviation.
fn elsewhere_between(trends: &[JointTrend], own: &JointTrend, days: [f64; 2]) -> Option<(f64, f64)> {
    let alike = |other: &&JointTrend| other.machine != own.machine && kind(other) == kind(own);
    let share = |other: &JointTrend| if own.metric == By::Peak { own.level / other.level } else { 1.0 };
    let change = |other: &JointTrend| Some(share(other) * slope_over(other, days)? * (days[1] - days[0]));
    let changes: Vec<f64> =
        trends.iter().filter(alike).filter_map(change).filter(|c| c.is_finite()).collect();
    (changes.len() >= FEWEST_JOINTS).then(|| (median(changes.clone()), SIGMA_PER_MAD * mad(&changes)))
}

/// By how much the joints of other machines changed when this one steps: the middle, and the spread as a robust standard
/// deviation. `None` where too few tell that. What one machine's joints share is its own.
fn elsewhere(trends: &[JointTrend], own: &JointTrend, at_days: f64) -> Option<(f64, f64)> {
    let share = |other: &JointTrend| if own.metric == By::Peak { own.level / other.level } else { 1.0 };
    let change = |other: &JointTrend| {
        let side = |after: bool| -> Vec<f64> {
            let levels = other.levels.iter().filter(|level| (level.at_days >= at_days) == after);
            levels.map(|level| level.value).collect()
        };
        let [before, after] = [side(false), side(true)];
        let enough = before.len().min(after.len()) >= FEWEST_OF_A_SIDE;
        enough.then(|| share(other) * (mean(&after) - mean(&before))).filter(|change| change.is_finite())
    };
    let alike = |other: &&JointTrend| {
        other.machine != own.machine && kind(other) == kind(own) && other.direction == own.direction
    };
    // The same joint elsewhere tells more: a cold day makes more of a fast joint.
    let same = |other: &&JointTrend| alike(other) && other.joint == own.joint;
    let same: Vec<f64> = trends.iter().filter(same).filter_map(change).collect();
    let tell = |changes: &Vec<f64>| changes.len() >= FEWEST_OF_STEPS;
    let all = || trends.iter().filter(alike).filter_map(change).collect();
    let changes = Some(same).filter(tell).or_else(|| Some(all()).filter(tell))?;
    Some((median(changes.clone()), SIGMA_PER_MAD * mad(&changes)))
}

fn page_beside(log: &str) -> Option<String> {
    let page = Path::new(log).with_extension("html").canonicalize().ok()?;
    page.is_file().then(|| page.to_str().map(str::to_owned))?
}

/// Says by how much each slope differs from what is usual for its metric over its days; gives whether enough joints tell that.
fn stand_out(trends: &mut [JointTrend]) -> Vec<bool> {
    let mut known: BTreeMap<_, (bool, f64, f64)> = BTreeMap::new();
    let mut usual = |own: &JointTrend| {
        let span = span_days(own).map(f64::to_bits);
        let key = (own.metric, own.direction.is_some(), own.unit.clone(), span);
        *known.entry(key).or_insert_with(|| {
            let alike = |other: &&JointTrend| kind(other) == kind(own);
            let slope = |other: &JointTrend| Some(slope_over(other, span_days(own))? / scale(other));
            let slopes: Vec<f64> =
                trends.iter().filter(alike).filter_map(slope).filter(|s| s.is_finite()).collect();
            (slopes.len() >= FEWEST_JOINTS, SIGMA_PER_MAD * mad(&slopes), median(slopes))
        })
    };
    let found: Vec<(bool, f64, f64)> = trends.iter().map(&mut usual).collect();
    for (trend, (_, spread, middle)) in trends.iter_mut().zip(&found) {
        let own = trend.slope_per_day / scale(trend);
        trend.stands_out = (*spread > 0.0).then(|| (own - middle).abs() / spread);
    }
    found.into_iter().map(|(tells, ..)| tells).collect()
}

/// What a slope is a share of where joints are compared: peak errors change in proportion, a fast joint's by more.
fn scale(trend: &JointTrend) -> f64 {
    if trend.metric == By::Peak && trend.level > 0.0 { trend.level } else { 1.0 }
}

/// The first and the last day of a trend.
fn span_days(trend: &JointTrend) -> [f64; 2] {
    let ends = trend.levels.first().zip(trend.levels.last());
    ends.map_or([0.0; 2], |(first, last)| [first.at_days, last.at_days])
}

/// The slope of a trend over some days: its own where they are most of its days, else that of its levels in them; `None` of too
/// few. What a fleet has in common, such as the weather, makes more of a slope the shorter it is.
fn slope_over(trend: &JointTrend, [from, to]: [f64; 2]) -> Option<f64> {
    let inside: Vec<(f64, f64)> = (trend.levels.iter())
        .filter(|level| (from..=to).contains(&level.at_days))
        .map(|level| (level.at_days, level.value))
        .collect();
    if trend.levels.is_empty() || inside.len() as f64 >= MOST_OF_IT * trend.levels.len() as f64 {
        return Some(trend.slope_per_day).filter(|_| trend.days >= MOST_OF_IT * (to - from));
    }
    (inside.len() >= FEWEST_RUNS).then(|| theil_sen(&inside))
}

#[cfg(test)]
mod tests {
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::{
        super::{course::course, joint_trend::Level, stepped::best_step},
        *,
    };

    /// Eight machines of which the third goes its own way, judged.
    fn judged(of_third: impl Fn(f64) -> f64, days: u32) -> JointTrend {
        let trend = |machine: u32| {
            let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(u64::from(machine));
            let mut noise = || -> f64 { StandardNormal.sample(&mut rng) };
            let own = |day: u32| if machine == 2 { of_third(f64::from(day)) } else { 0.0 };
            let points: Vec<(f64, f64)> =
                (0..days).step_by(3).map(|day| (f64::from(day), 2.4 + own(day) + 0.02 * noise())).collect();
            let level = |(at_days, value): &(f64, f64)| Level {
                at_days: *at_days,
                value: *value,
                log: String::new(),
                page: None,
            };
            let found = crate::math::trend(&points).unwrap();
            JointTrend {
                machine: machine.to_string(),
                joint: "stick".into(),
                slope_per_day: found.slope,
                interval_95: found.interval,
                p_value: found.p,
                step: best_step(&points),
                course: course(&points),
                days: f64::from(days),
                changing_days: f64::from(days),
                level: 2.4,
                levels: points.iter().map(level).collect(),
                ..JointTrend::default()
            }
        };
        let mut trends: Vec<JointTrend> = (0..8).map(trend).collect();
        judge(&mut trends);
        assert!(trends.iter().enumerate().all(|(k, trend)| k == 2 || !trend.found), "{trends:?}");
        trends.swap_remove(2)
    }

    #[test]
    fn what_grows_from_a_day_on_grows_by_that_and_once_it_is_mended_by_nothing() {
        let worn = |day: f64| if (60.0..100.0).contains(&day) { 0.03 * (day - 60.0) } else { 0.0 };
        let found = judged(worn, 100);
        assert!(found.found && !found.is_step && (found.growth_per_day() - 0.03).abs() < 0.002, "{found:?}");
        assert!(found.since.as_deref().is_some_and(|since| since < "1970-03-05"), "{:?}", found.since);
        let found = judged(worn, 150);
        let step = found.step.as_ref().unwrap();
        assert!(found.is_step && (step.change + 1.2).abs() < 0.1 && found.changes.len() == 2, "{found:?}");
        assert!(found.growth_per_day() < 0.0, "a limit on growth is kept");
        let found = judged(|day| if (40.0..85.0).contains(&day) { 0.6 } else { 0.0 }, 150);
        let changes: Vec<f64> = found.changes.iter().map(|change| change.change).collect();
        assert!(
            matches!(changes.as_slice(), [up, down] if (up - 0.6).abs() < 0.05 && (down + 0.6).abs() < 0.05),
            "{found:?}"
        );
        let found = judged(|day| 0.03 * (day - 60.0).clamp(0.0, 30.0), 150);
        let step = found.step.as_ref().unwrap();
        assert!(
            found.is_step && (step.change - 0.9).abs() < 0.1 && !step.is_sure(),
            "it grew, and stays: {found:?}"
        );
        let found = judged(|_| 0.0, 150);
        assert!(!found.found && found.changes.is_empty());
    }

    #[test]
    fn what_a_fleet_has_in_common_for_some_days_is_no_trend_of_a_machine_that_was_there_for_these_alone() {
        // All machines rise for ten days and fall for ten; one was there for the first ten.
        let trend = |machine: u32, days: u32| {
            let noise = |day: u32| 0.1 * f64::from((day * 7 + machine * 3) % 5);
            let at = |day: u32| f64::from(day.min(20 - day)) + noise(day);
            let levels: Vec<Level> = (0..days)
                .map(|day| Level {
                    at_days: f64::from(day),
                    value: 10.0 + at(day),
                    log: String::new(),
                    page: None,
                })
                .collect();
            let points: Vec<(f64, f64)> = levels.iter().map(|level| (level.at_days, level.value)).collect();
            JointTrend {
                machine: machine.to_string(),
                joint: "boom".into(),
                slope_per_day: theil_sen(&points),
                p_value: if days < 20 { 1e-9 } else { 0.5 },
                days: f64::from(days),
                changing_days: f64::from(days),
                level: 10.0,
                levels,
                ..JointTrend::default()
            }
        };
        let mut trends: Vec<JointTrend> =
            (0..12).map(|machine| trend(machine, if machine < 1 { 10 } else { 20 })).collect();
        judge(&mut trends);
        assert!(!trends[0].found, "{:?}", trends[0].stands_out);
        // Of one that alone rises it is one.
        let mut trends: Vec<JointTrend> = (0..12).map(|machine| trend(machine, 20)).collect();
        trends[0] = trend(0, 10);
        for level in trends.iter_mut().skip(1).flat_map(|trend| &mut trend.levels) {
            level.value = 10.0 + 0.1 * (level.at_days % 3.0);
        }
        judge(&mut trends);
        assert!(trends[0].found, "{:?}", trends[0].stands_out);
    }

    #[test]
    fn what_is_judged_beside_it_makes_a_step_no_line() {
        let noise = |k: u32| 0.3 * f64::from(k * 7 % 5) - 0.6;
        let of = |level: &dyn Fn(u32) -> f64, beside: usize| {
            let points: Vec<(f64, f64)> =
                (0..12).map(|k| (f64::from(k), 3.0 + level(k) + noise(k))).collect();
            let found = crate::math::trend(&points).unwrap();
            let own = JointTrend {
                slope_per_day: found.slope,
                interval_95: found.interval,
                p_value: found.p,
                step: best_step(&points),
                changing_days: 11.0,
                level: 3.0,
                ..JointTrend::default()
            };
            let mut trends = vec![JointTrend { p_value: 1.0, ..JointTrend::default() }; beside];
            trends.push(own);
            judge(&mut trends);
            trends.pop().map(|trend| (trend.found, trend.is_step)).unwrap()
        };
        for beside in [0, 10, 100] {
            assert_eq!(of(&|k| if k < 6 { 0.0 } else { 5.0 }, beside), (true, true), "{beside}");
            assert_eq!(of(&|k| 0.6 * f64::from(k), beside), (true, false), "{beside}");
        }
    }
}
