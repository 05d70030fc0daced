//! The level of a joint in each run: that which is left when each start's own level is taken off.

use std::collections::BTreeMap;

use super::{
    blocks::{blocks, centred, count},
    history::{By, Event, Scatters, Values},
    joint_trend::FEWEST_RUNS,
    own_change::OwnLevels,
    run::{Run, days},
};
use crate::math::{column_levels, median, range, row_weights, step_scatter, trend};

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
    let own = Matrix { weights: weights(&scatters), rows, scatters };
    let alike = if metric == By::Peak { own.in_proportion(runs.len()) } else { own };
    (runs, alike.rows, alike.weights)
}

/// Starts by run, with what each scatters by and says.
struct Matrix {
    rows: Vec<Vec<f64>>,
    scatters: Vec<Option<f64>>,
    weights: Vec<f64>,
}

/// Starts that scatter by more than this share of the usual scatter, and by less than the other, scatter as is usual: the scatter of a few
/// runs is not known better, and that of a start which seems quiet by chance is one whose steps from run to run are small for its
/// range, so that it looks as if it drifted.
const AS_USUAL: [f64; 2] = [0.33, 2.0];

/// How much each start says: one over the square of its scatter, alike where that may be the usual one.
fn weights(scatters: &[Option<f64>]) -> Vec<f64> {
    let usual = median(scatters.iter().flatten().copied().collect());
    let surely =
        |own: f64| if own < AS_USUAL[0] * usual { own / AS_USUAL[0] } else { usual.max(own / AS_USUAL[1]) };
    row_weights(&scatters.iter().map(|own| own.map(surely)).collect::<Vec<_>>())
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
        let scaled = Self { weights: weights(&scatters), rows, scatters };
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

/// How blocks of one joint lie to one another, less what their plans make.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Link {
    /// By block, from the first one on, in the unit of the joint; of peak errors as a share of what is usual.
    pub(super) above: Vec<f64>,
    /// The largest standard error of these, in the same, beyond what the runs of the joint scatter by.
    pub(super) error: f64,
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
    /// The block of each of these: runs of one share starts with one another.
    pub(super) blocks: Vec<usize>,
    /// Each start, and what it is like in the middle; of peak errors the logarithm.
    pub(super) starts: Vec<(Event, f64)>,
    /// How its blocks lie to one another, where other machines tell it.
    pub(super) link: Option<Link>,
}

impl Leveled {
    /// Without its names; `None` for too few runs.
    pub(super) fn of(metric: By, runs: &[Run], values: &Values, scatters: (&str, &Scatters)) -> Option<Self> {
        let (own, rows, weights) = matrix(metric, values, FEWEST_RUNS, scatters);
        let runs: Vec<&Run> = own.iter().filter_map(|run| runs.get(*run)).collect();
        let at_days: Vec<f64> = runs.iter().map(|run| days(run)).collect();
        let levels = points(&at_days, &column_levels(&rows, &weights, own.len()));
        let blocks = blocks(&rows, own.len());
        let often = values.iter().filter(|(_, of_runs)| of_runs.len() >= FEWEST_RUNS);
        let typical = |of_runs: &BTreeMap<usize, f64>| {
            let typical = median(of_runs.values().copied().collect());
            if metric == By::Peak { typical.ln() } else { typical }
        };
        let starts = often.map(|(event, of_runs)| (event.clone(), typical(of_runs))).collect();
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
            blocks,
            starts,
            ..Self::default()
        })
    }

    /// The block that a start is in.
    pub(super) fn block_of(&self, row: usize) -> usize {
        let first = self.rows[row].iter().position(|value| value.is_finite());
        first.and_then(|run| self.blocks.get(run)).copied().unwrap_or_default()
    }

    /// What a change of one in the unit of a link is in that of the joint.
    pub(super) fn unit_of_link(&self) -> f64 {
        if self.metric == By::Peak { self.usual } else { 1.0 }
    }

    /// The standard error of the difference of two blocks by what runs scatter by within blocks, in the unit of a link.
    pub(super) fn noise_between(&self, two: [usize; 2]) -> f64 {
        let (levels, blocks) =
            (self.levels.iter().map(|level| level.1).collect::<Vec<_>>(), self.level_blocks());
        let freedom = (levels.len() as f64 - count(&blocks) as f64).max(1.0);
        let squares: f64 = centred(&levels, &blocks).iter().map(|off| off * off).sum();
        let runs = |own: usize| blocks.iter().filter(|block| **block == own).count().max(1) as f64;
        (squares / freedom * (1.0 / runs(two[0]) + 1.0 / runs(two[1]))).sqrt() / self.unit_of_link()
    }

    /// The block of each level.
    pub(super) fn level_blocks(&self) -> Vec<usize> {
        let known = |at: f64| self.at_days.iter().position(|days| (days - at).abs() <= 0.0);
        let block = |at: f64| known(at).and_then(|run| self.blocks.get(run)).copied().unwrap_or_default();
        self.levels.iter().map(|level| block(level.0)).collect()
    }

    /// With its blocks where other machines tell that they lie.
    pub(super) fn linked(mut self, link: Option<Link>) -> Self {
        if let Some(link) = link {
            let above: Vec<f64> = link.above.iter().map(|above| above * self.unit_of_link()).collect();
            self.set_blocks(&above);
            self.link = Some(link);
        }
        self
    }

    /// Levels that lie by so much above what the starts of each block are in the middle.
    fn set_blocks(&mut self, above: &[f64]) {
        let mut levels = vec![f64::NAN; self.at_days.len()];
        for (block, above) in above.iter().enumerate() {
            let rows: Vec<usize> = (0..self.rows.len()).filter(|row| self.block_of(*row) == block).collect();
            let weights: Vec<f64> = rows.iter().map(|row| self.weights[*row]).collect();
            let rows: Vec<Vec<f64>> = rows.into_iter().map(|row| self.rows[row].clone()).collect();
            let own = column_levels(&rows, &weights, levels.len());
            // Where each start is as it is in the middle.
            let middle =
                |values: Vec<f64>| median(values.into_iter().filter(|value| value.is_finite()).collect());
            let off = |row: &Vec<f64>| row.iter().zip(&own).map(|(value, level)| value - level).collect();
            let zero = |row: &Vec<f64>| middle(row.clone()) - middle(off(row));
            let all: f64 = weights.iter().sum();
            let zero = rows.iter().zip(&weights).map(|(row, weight)| weight * zero(row)).sum::<f64>() / all;
            for (level, own) in levels.iter_mut().zip(&own).filter(|(_, own)| own.is_finite()) {
                *level = own - zero + above;
            }
        }
        let middle = median(levels.iter().copied().filter(|level| level.is_finite()).collect());
        let levels: Vec<f64> = levels.into_iter().map(|level| level - middle).collect();
        self.levels = points(&self.at_days, &levels);
    }

    /// The slope of what the other machines did at the instants of the levels, where it is hardly chance.
    pub(super) fn shared_per_day(&self, common: &[f64]) -> Option<f64> {
        const CHANCE: f64 = 0.01;
        let at = self.levels.iter().map(|level| level.0);
        let found = trend(&at.zip(common.iter().copied()).collect::<Vec<_>>())?;
        (found.p < CHANCE).then_some(found.slope)
    }

    /// Its levels, where those of all blocks can be compared.
    pub(super) fn own_levels(&self) -> OwnLevels {
        let known = self.link.is_some() || count(&self.level_blocks()) < 2;
        OwnLevels(if known { self.levels.clone() } else { Vec::new() })
    }

    /// Less what the other machines did at the same instants.
    pub(super) fn less(mut self, common: Option<Vec<f64>>) -> Self {
        let Some(common) = common.filter(|common| common.len() == self.levels.len()) else { return self };
        self.less_common = true;
        // A run without any value has no level.
        let known: Vec<(f64, f64)> = self.levels.iter().map(|level| level.0).zip(common).collect();
        let of = |at: f64| known.iter().find(|one| (one.0 - at).abs() <= 0.0).map_or(0.0, |one| one.1);
        for row in &mut self.rows {
            row.iter_mut().zip(&self.at_days).for_each(|(value, at)| *value -= of(*at));
        }
        if self.link.is_some() {
            for (at, level) in &mut self.levels {
                *level -= of(*at);
            }
            return self;
        }
        // Starts of two plans that no run has both of share no level: what is common must be gone before their levels are made alike.
        let levels = column_levels(&self.rows, &self.weights, self.at_days.len());
        self.levels = points(&self.at_days, &levels);
        self
    }
}

/// Those that are known.
pub(super) fn points(at: &[f64], values: &[f64]) -> Vec<(f64, f64)> {
    at.iter().copied().zip(values.iter().copied()).filter(|(_, value)| value.is_finite()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_start_that_seems_quiet_says_no_more_than_others_and_one_that_is_does() {
        let equal = |weights: &[f64]| weights.iter().all(|weight| (weight / weights[0] - 1.0).abs() < 1e-9);
        assert!(equal(&weights(&[Some(1.0), Some(0.5), Some(1.8), None])));
        let [quiet, usual, noisy] =
            [0, 1, 3].map(|at| weights(&[Some(0.1), Some(1.0), Some(1.0), Some(6.0)])[at]);
        assert!(quiet > 5.0 * usual && noisy < 0.2 * usual, "{quiet} {usual} {noisy}");
    }
}
