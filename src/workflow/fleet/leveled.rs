//! The level of a joint in each run: that which is left when each start's own level is taken off.

use std::collections::BTreeMap;

use super::{
    course::course,
    history::{By, Event, Scatters, Values},
    joint_trend::{FEWEST_RUNS, JointTrend, Level},
    run::{Run, date, days},
    stepped::best_step,
};
use crate::math::{
    begins, column_levels, median, range, row_weights, step_scatter, theil_sen, trend, weighted_median,
};

/// The starts that enough runs have, as rows by run, with what each row says; and those runs. A start that scatters on
/// all machines says little, however quiet it was on this one. Peak errors grow and scatter in proportion, those of a fast start
/// by more: so each row is scaled to the level of the middle one, or the slowest start would say it all.
pub(super) fn matrix(
    metric: By,
    values: &Values,
    fewest: usize,
    (joint, scatters): (&str, &Scatters),
) -> (Vec<usize>, Vec<Vec<f64>>, Vec<f64>) {
    let often = || values.values().filter(|of_runs| of_runs.len() >= fewest);
    let mut runs: Vec<usize> = often().flat_map(|of_runs| of_runs.keys().copied()).collect();
    runs.sort_unstable();
    runs.dedup();
    let row = |of_runs: &BTreeMap<usize, f64>| {
        runs.iter().map(|run| of_runs.get(run).copied().unwrap_or(f64::NAN)).collect()
    };
    let rows: Vec<Vec<f64>> = often().map(row).collect();
    let events = values.iter().filter(|(_, of_runs)| of_runs.len() >= fewest);
    let scatter = |(event, of_runs): (&Event, &BTreeMap<usize, f64>)| {
        let own = step_scatter(of_runs.values().copied());
        let usual = scatters.get(&(joint.to_owned(), event.clone())).copied();
        own.into_iter().chain(usual).reduce(f64::max)
    };
    let scatters: Vec<Option<f64>> = events.map(scatter).collect();
    let own = Matrix { weights: row_weights(&scatters), rows, scatters };
    let alike = if metric == By::Peak { own.in_proportion(runs.len()) } else { own };
    (runs, alike.rows, alike.weights)
}

/// Starts by run, with what each scatters by and says.
struct Matrix {
    rows: Vec<Vec<f64>>,
    scatters: Vec<Option<f64>>,
    weights: Vec<f64>,
}

/// Levels of starts that change by an amount, not in proportion, differ from run to run by so much less where they are not scaled.
const NOT_IN_PROPORTION: f64 = 0.9;

impl Matrix {
    /// The rows scaled to the level of the middle one where what changes does so in proportion: a worn valve adds more to the error of a
    /// fast start, and an offset of a sensor as much to each.
    fn in_proportion(self, runs: usize) -> Self {
        let levels = row_levels(&self.rows, &self.weights, runs);
        let middle = median(levels.clone());
        let share = |level: &f64| if *level > 0.0 { middle / level } else { 1.0 };
        let shares: Vec<f64> = levels.iter().map(share).collect();
        let rows = self.rows.iter().zip(&shares);
        let rows: Vec<Vec<f64>> =
            rows.map(|(row, share)| row.iter().map(|value| value * share).collect()).collect();
        let scatters: Vec<Option<f64>> = self
            .scatters
            .iter()
            .zip(&shares)
            .map(|(scatter, share)| scatter.map(|own| own * share))
            .collect();
        let scaled = Self { weights: row_weights(&scatters), rows, scatters };
        if self.roughness(runs) < NOT_IN_PROPORTION * scaled.roughness(runs) { self } else { scaled }
    }

    /// By how much the levels of runs differ from that of the one before, in all, over the most that two of them do.
    fn roughness(&self, runs: usize) -> f64 {
        let levels = column_levels(&self.rows, &self.weights, runs);
        let levels: Vec<f64> = levels.into_iter().filter(|level| level.is_finite()).collect();
        let [low, high] = range(levels.iter().copied());
        levels.windows(2).map(|two| (two[1] - two[0]).abs()).sum::<f64>()
            / (high - low).max(f64::MIN_POSITIVE)
    }
}

/// The level of each row, less what all rows do alike in the runs that it is of; as a factor.
fn row_levels(rows: &[Vec<f64>], weights: &[f64], runs: usize) -> Vec<f64> {
    let log = |value: &f64| if *value > 0.0 { value.ln() } else { f64::NAN };
    let logs: Vec<Vec<f64>> = rows.iter().map(|row| row.iter().map(log).collect()).collect();
    let common = column_levels(&logs, &vec![1.0; weights.len()], runs);
    let level = |row: &Vec<f64>| {
        let own = row.iter().zip(&common).map(|(log, common)| log - common);
        median(own.filter(|own| own.is_finite()).collect()).exp()
    };
    logs.iter().map(level).collect()
}

/// One metric of one joint.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Leveled {
    pub(super) machine: String,
    pub(super) joint: String,
    /// Of the starts that it is of; absent of both.
    pub(super) direction: Option<i8>,
    pub(super) metric: By,
    pub(super) unit: String,
    /// When each run began, days since 1970, and its level, whose median is zero.
    pub(super) levels: Vec<(f64, f64)>,
    /// What the starts are like in the middle.
    pub(super) usual: f64,
    /// Whether what other machines did at the same time is taken off.
    pub(super) less_common: bool,
    /// By start, and by instant of a run.
    pub(super) rows: Vec<Vec<f64>>,
    pub(super) weights: Vec<f64>,
    pub(super) at_days: Vec<f64>,
    /// The log of each of these.
    pub(super) logs: Vec<String>,
}

impl Leveled {
    /// Without its names; `None` for too few runs.
    pub(super) fn of(metric: By, runs: &[Run], values: &Values, scatters: (&str, &Scatters)) -> Option<Self> {
        let (own, rows, weights) = matrix(metric, values, FEWEST_RUNS, scatters);
        let runs: Vec<&Run> = own.iter().filter_map(|run| runs.get(*run)).collect();
        let at_days: Vec<f64> = runs.iter().map(|run| days(run)).collect();
        let levels = points(&at_days, &column_levels(&rows, &weights, own.len()));
        let usual = median(rows.iter().flatten().copied().filter(|value| value.is_finite()).collect());
        let logs = runs.iter().map(|run| run.log.clone()).collect();
        (levels.len() >= FEWEST_RUNS).then(|| Self {
            metric,
            levels,
            usual,
            rows,
            weights,
            at_days,
            logs,
            ..Self::default()
        })
    }

    /// The slope of what the other machines did at the instants of the levels, where it is hardly chance.
    pub(super) fn shared_per_day(&self, common: &[f64]) -> Option<f64> {
        const CHANCE: f64 = 0.01;
        let at = self.levels.iter().map(|level| level.0);
        let found = trend(&at.zip(common.iter().copied()).collect::<Vec<_>>())?;
        (found.p < CHANCE).then_some(found.slope)
    }

    /// Less what the other machines did at the same instants.
    pub(super) fn less(mut self, common: Option<Vec<f64>>) -> Self {
        let Some(common) = common.filter(|common| common.len() == self.levels.len()) else { return self };
        // A run without any value has no level.
        let known: Vec<(f64, f64)> = self.levels.iter().map(|level| level.0).zip(common).collect();
        let of = |at: f64| known.iter().find(|one| (one.0 - at).abs() <= 0.0).map_or(0.0, |one| one.1);
        for row in &mut self.rows {
            row.iter_mut().zip(&self.at_days).for_each(|(value, at)| *value -= of(*at));
        }
        // Starts of two plans that no run has both of share no level: what is common must be gone before their levels are made alike.
        let levels = column_levels(&self.rows, &self.weights, self.at_days.len());
        self.levels = points(&self.at_days, &levels);
        self.less_common = true;
        self
    }

    /// Its trend; `None` where all runs are of one instant.
    pub(super) fn trend(&self) -> Option<JointTrend> {
        let Self { rows, weights, levels, at_days, .. } = self;
        let whole = trend(levels)?;
        let first = levels.first()?.0;
        // A rate is that of the days that it is said of.
        let since = |from: &f64| levels.iter().filter(|(at, _)| at >= from).copied().collect::<Vec<_>>();
        let begins = begins(levels).filter(|from| since(from).len() >= FEWEST_RUNS).unwrap_or(first);
        let found = trend(&since(&begins))?;
        let of_row = |row: &Vec<f64>| {
            let later: Vec<(f64, f64)> =
                points(at_days, row).into_iter().filter(|(at, _)| *at >= begins).collect();
            theil_sen(&later)
        };
        let slope = weighted_median(rows.iter().map(of_row).zip(weights.iter().copied()).collect());
        let [low, high] = found.interval;
        // The levels that are known for fewer days than the starts are tell another slope.
        let slope = if (low..=high).contains(&slope) { slope } else { found.slope };
        let level = |(at_days, level): &(f64, f64)| {
            let log = self.at_days.iter().position(|at| (at - at_days).abs() <= 0.0);
            let log = log.and_then(|at| self.logs.get(at)).cloned().unwrap_or_default();
            Level { at_days: *at_days, value: level + self.usual, log, page: None }
        };
        let early =
            rows.iter().flat_map(|row| points(at_days, row).into_iter().take(3)).map(|(_, value)| value);
        Some(JointTrend {
            machine: self.machine.clone(),
            joint: self.joint.clone(),
            direction: self.direction,
            metric: self.metric,
            unit: self.unit.clone(),
            slope_per_day: slope,
            interval_95: [low, high],
            p_value: whole.p,
            q_value: 1.0,
            step: best_step(levels),
            course: course(&levels.iter().map(|(at, level)| (*at, level + self.usual)).collect::<Vec<_>>()),
            less_common: self.less_common,
            since: date(begins),
            starts: rows.len(),
            runs: levels.len(),
            days: levels.last()?.0 - levels.first()?.0,
            changing_days: levels.last()?.0 - begins,
            level: median(early.collect()),
            levels: levels.iter().map(level).collect(),
            ..JointTrend::default()
        })
    }
}

/// Those that are known.
fn points(at: &[f64], values: &[f64]) -> Vec<(f64, f64)> {
    at.iter().copied().zip(values.iter().copied()).filter(|(_, value)| value.is_finite()).collect()
}
