//! A level of a joint that changes between two runs and stays.

use serde::{Deserialize, Serialize};

use super::{course::Change, run::date, when::within_95};
use crate::math::{line, mean, step, theil_sen};

/// A level that changes between two runs and stays.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct LevelStep {
    /// Runs before it.
    pub runs_before: usize,
    /// The last run before it, UTC.
    pub after: Option<String>,
    /// The first run with the new level, UTC.
    pub by: Option<String>,
    /// The last run that surely lies before it and the first one that surely lies after it (95 %), UTC.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub within_95: Option<[String; 2]>,
    /// From the one to the other, days.
    pub days: f64,
    /// Mean level after less mean level before, three runs at least on each side.
    pub change: f64,
    /// Its 95 % interval, by Student's t.
    pub interval_95: [f64; 2],
    /// Two-sided probability of such a step at any time by chance.
    pub p_value: f64,
    /// The same, corrected for the number of machines, joints and metrics (false-discovery rate).
    pub q_value: f64,
    /// Sum of squares that it leaves, over that which the trend leaves, or a level that begins to change at some run.
    pub left: f64,
}

/// A step that leaves more than this share of what a level that begins to change leaves may be one as well.
const SURELY: f64 = 0.8;

impl LevelStep {
    /// One of several changes.
    pub(super) fn of(change: &Change, (p_value, q_value): (f64, f64)) -> Self {
        Self {
            runs_before: change.runs_before,
            after: change.after.clone(),
            by: change.by.clone(),
            within_95: change.within_95.clone(),
            days: change.at_days[1] - change.at_days[0],
            change: change.change,
            interval_95: change.interval_95,
            p_value,
            q_value,
            // What took days is no jump.
            left: if change.per_day.is_some() { 1.0 } else { 0.0 },
        }
    }

    /// Whether it is surely no change over some days.
    pub fn is_sure(&self) -> bool {
        self.left < SURELY
    }
}

/// The step that explains the levels of the runs best, beside their trend.
pub(super) fn best_step(levels: &[(f64, f64)]) -> Option<LevelStep> {
    let values: Vec<f64> = levels.iter().map(|(_, level)| *level).collect();
    let found = step(&values)?;
    let slope = theil_sen(levels);
    let off: Vec<f64> = levels.iter().map(|(at, level)| level - slope * at).collect();
    let middle = off.iter().sum::<f64>() / off.len() as f64;
    let of_line: f64 = off.iter().map(|off| (off - middle).powi(2)).sum();
    let of_trend = (1..levels.len() - 1).map(|k| bent(levels, k)).fold(of_line, f64::min);
    let (before, after) = (levels.get(found.at.checked_sub(1)?)?.0, levels.get(found.at)?.0);
    let [low, high] = [&values[..found.at], &values[found.at..]].map(mean);
    Some(LevelStep {
        runs_before: found.at,
        after: date(before),
        by: date(after),
        within_95: within_95(levels, 0..levels.len(), |_| low, |_| high),
        days: after - before,
        change: found.change,
        interval_95: found.interval,
        p_value: found.p,
        q_value: 1.0,
        left: if of_trend > 0.0 { found.squares / of_trend } else { f64::MAX },
    })
}

/// Sum of squares that a level leaves which changes evenly from one of the runs on.
fn bent(levels: &[(f64, f64)], run: usize) -> f64 {
    let from = levels[run].0;
    let (since, values): (Vec<f64>, Vec<f64>) =
        levels.iter().map(|(at, level)| ((at - from).max(0.0), *level)).unzip();
    let slope = line(&since, &values).slope;
    let [x, y] = [&since, &values].map(|values| values.iter().sum::<f64>() / values.len() as f64);
    since.iter().zip(&values).map(|(since, value)| (value - y - slope * (since - x)).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_that_begins_to_grow_is_no_step_and_one_that_jumps_is() {
        let noise = |k: i32| 0.1 * f64::from(k * 7 % 5 - 2);
        let levels = |value: &dyn Fn(i32) -> f64| {
            (0..16).map(|k| (f64::from(k), value(k) + noise(k))).collect::<Vec<_>>()
        };
        let left = |value: &dyn Fn(i32) -> f64| best_step(&levels(value)).unwrap().left;
        assert!(left(&|k| f64::from((k - 8).max(0))) > 1.0);
        assert!(left(&|k| if k < 8 { 0.0 } else { 4.0 }) < 1.0);
        assert!(left(&|k| if k < 13 { 0.0 } else { 4.0 }) < 1.0);
    }
}
