//! Which changes of a fleet's joints are found: those that chance does not make, that matter, and that other machines do
//! not share.

use std::{collections::BTreeMap, path::Path};

use super::joint_trend::{FEWEST_RUNS, JointTrend, MOST_FALSE};
use crate::math::{SIGMA_PER_MAD, false_discovery, mad, mean, median, theil_sen};

/// Robust standard deviations of the fleet's changes that a change must stand out by to be found: less than that many
/// healthy joints change by, in a season or with other work.
const STANDS_OUT: f64 = 3.0;
/// Joints that tell what is usual, at least; of steps, those of other machines.
const FEWEST_JOINTS: usize = 10;
const FEWEST_OF_STEPS: usize = 4;
/// Half of a 95 % interval, in standard deviations.
const SIGMAS_OF_95: f64 = 1.96;
/// Runs before a step, and after it, that tell how others changed then, at least.
const FEWEST_OF_A_SIDE: usize = 3;
/// Days that are this share of others are nearly the same ones.
const MOST_OF_IT: f64 = 0.9;
/// A step, or what a trend makes from the first run to the last, that is a smaller share of the level is of no concern.
const RELEVANT: f64 = 0.02;

/// Which trends and steps are found. Both are tests of the same data, so they are corrected for together.
pub(super) fn judge(trends: &mut [JointTrend]) {
    let tell = stand_out(trends);
    let p_trend = trends.iter().map(|trend| trend.p_value);
    let p_step = trends.iter().map(|trend| trend.step.as_ref().map_or(1.0, |step| step.p_value));
    let q = false_discovery(&p_trend.chain(p_step).collect::<Vec<f64>>());
    let (q_trend, q_step) = q.split_at(trends.len());
    let steps = |(own, q): (&JointTrend, &f64)| {
        if *q < MOST_FALSE { elsewhere(trends, own) } else { None }
    };
    let elsewhere: Vec<Option<(f64, f64)>> = trends.iter().zip(q_step).map(steps).collect();
    for (k, trend) in trends.iter_mut().enumerate() {
        trend.q_value = q_trend[k];
        let usual = tell[k] && trend.stands_out.is_some_and(|out| out < STANDS_OUT);
        let least = RELEVANT * trend.level.abs();
        let drifts =
            trend.q_value < MOST_FALSE && !usual && (trend.slope_per_day * trend.days).abs() >= least;
        if let Some(step) = &mut trend.step {
            step.q_value = q_step[k];
            // What others changed by and what this one did are known so well only.
            let own = (step.interval_95[1] - step.interval_95[0]) / (2.0 * SIGMAS_OF_95);
            let beyond = elsewhere[k].is_none_or(|(middle, spread)| {
                (step.change - middle).abs() >= least.max(STANDS_OUT * spread.hypot(own))
            });
            let steps = step.q_value < MOST_FALSE && step.change.abs() >= least && beyond;
            trend.is_step = steps && (!drifts || step.left < 1.0);
            if trend.is_step {
                trend.since.clone_from(&step.by);
            }
        }
        trend.found = drifts || trend.is_step;
        if trend.found {
            trend.levels.iter_mut().for_each(|level| level.page = page_beside(&level.log));
        } else {
            trend.levels.clear();
        }
    }
}

/// By how much the joints of other machines changed when this one steps: the middle, and the spread as a robust standard
/// deviation. `None` where too few tell that. What one machine's joints share is its own.
fn elsewhere(trends: &[JointTrend], own: &JointTrend) -> Option<(f64, f64)> {
    let step = own.step.as_ref()?;
    let at_days = own.levels.get(step.runs_before)?.at_days;
    let change = |other: &JointTrend| {
        let side = |after: bool| -> Vec<f64> {
            let levels = other.levels.iter().filter(|level| (level.at_days >= at_days) == after);
            levels.map(|level| level.value).collect()
        };
        let [before, after] = [side(false), side(true)];
        let enough = before.len().min(after.len()) >= FEWEST_OF_A_SIDE;
        enough.then(|| mean(&after) - mean(&before))
    };
    let alike = |other: &&JointTrend| {
        let key = |trend: &JointTrend| (trend.metric, trend.direction, trend.unit.clone());
        other.machine != own.machine && key(other) == key(own)
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
            let alike = |other: &&JointTrend| {
                let key = |trend: &JointTrend| (trend.metric, trend.direction.is_some(), trend.unit.clone());
                key(other) == key(own)
            };
            let slopes: Vec<f64> =
                trends.iter().filter(alike).filter_map(|other| slope_over(other, span_days(own))).collect();
            (slopes.len() >= FEWEST_JOINTS, SIGMA_PER_MAD * mad(&slopes), median(slopes))
        })
    };
    let found: Vec<(bool, f64, f64)> = trends.iter().map(&mut usual).collect();
    for (trend, (_, spread, middle)) in trends.iter_mut().zip(&found) {
        trend.stands_out = (*spread > 0.0).then(|| (trend.slope_per_day - middle).abs() / spread);
    }
    found.into_iter().map(|(tells, ..)| tells).collect()
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
    use super::{super::joint_trend::Level, *};

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
}
