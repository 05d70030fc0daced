//! Trends and steps of levels in blocks that nothing joins: each block has a level of its own, so that only what is within blocks counts.

use statrs::distribution::{ContinuousCDF as _, Normal, StudentsT};

use super::{
    blocks::{centred, count, tell_step},
    joint_trend::FEWEST_OF_A_SIDE,
    run::date,
    stepped::LevelStep,
};
use crate::math::{Trend, quantile_sorted};

/// Half of a 95 % interval of the normal distribution, in standard deviations.
const SIGMAS_OF_95: f64 = 1.959_964;

/// Levels of runs `(days, level)` and the block of each.
pub(super) struct Within<'a> {
    pub(super) levels: &'a [(f64, f64)],
    pub(super) blocks: &'a [usize],
}

/// What a course within blocks leaves of the levels.
struct Left {
    /// By how much the levels change with it.
    change: f64,
    /// The sum of its squares about the means of the blocks.
    spread: f64,
    squares: f64,
}

impl Within<'_> {
    /// Of the pairs of runs of one block: Theil and Sen's slope, and Kendall's test by the normal distribution, which is on the safe side
    /// of few runs. `None` where too few are of one block.
    pub(super) fn trend(&self) -> Option<Trend> {
        let runs = || self.levels.iter().zip(self.blocks).enumerate();
        let mut slopes: Vec<f64> = runs()
            .flat_map(|(k, own)| runs().skip(k + 1).map(move |(_, later)| (own, later)))
            .filter(|((a, of_a), (b, of_b))| of_a == of_b && (b.0 - a.0).abs() > 0.0)
            .map(|((a, _), (b, _))| (b.1 - a.1) / (b.0 - a.0))
            .filter(|slope| slope.is_finite())
            .collect();
        slopes.sort_unstable_by(f64::total_cmp);
        let sum = |is: fn(&f64) -> bool| slopes.iter().filter(|slope| is(slope)).count() as f64;
        let sum = (sum(|slope| *slope > 0.0) - sum(|slope| *slope < 0.0)).abs();
        let variance = |block: usize| {
            let n = self.blocks.iter().filter(|own| **own == block).count() as f64;
            n * (n - 1.0) * (2.0 * n + 5.0) / 18.0
        };
        let sd = (0..count(self.blocks)).map(variance).sum::<f64>().sqrt();
        let reach = SIGMAS_OF_95 * sd / slopes.len() as f64;
        let at = |p: f64| quantile_sorted(&slopes, p);
        (slopes.len() > 2).then(|| Trend {
            slope: at(0.5),
            interval: [at(0.5 * (1.0 - reach).max(0.0)), at(0.5 * (1.0 + reach).min(2.0))],
            p: (2.0 * Normal::standard().cdf(-(sum - 1.0).max(0.0) / sd)).min(1.0),
        })
    }

    /// What the levels leave of a course, each block about its mean.
    fn left(&self, course: impl Fn(usize) -> f64) -> Left {
        let values: Vec<f64> = self.levels.iter().map(|level| level.1).collect();
        let course: Vec<f64> = (0..values.len()).map(course).collect();
        let [x, y] = [&course, &values].map(|values| centred(values, self.blocks));
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let spread = dot(&x, &x);
        let change = if spread > 0.0 { dot(&x, &y) / spread } else { 0.0 };
        Left { change, spread, squares: (dot(&y, &y) - change * change * spread).max(0.0) }
    }

    /// The step that explains the levels best, where blocks tell it: with blocks of their own levels one side and the other differ by a
    /// mean within them.
    pub(super) fn best_step(&self) -> Option<LevelStep> {
        let n = self.levels.len();
        let sides = FEWEST_OF_A_SIDE..(n + 1).saturating_sub(FEWEST_OF_A_SIDE);
        let tried: Vec<usize> = sides.filter(|at| tell_step(self.blocks, *at)).collect();
        let step = |at: usize| self.left(move |run| if run < at { 0.0 } else { 1.0 });
        let ways = tried.len() as f64;
        let (at, found) =
            tried.into_iter().map(|at| (at, step(at))).min_by(|a, b| a.1.squares.total_cmp(&b.1.squares))?;
        let freedom = (n as f64 - count(self.blocks) as f64 - 1.0).max(1.0);
        let error = (found.squares / freedom / found.spread).sqrt().max(f64::MIN_POSITIVE);
        let t = StudentsT::new(0.0, 1.0, freedom).ok().filter(|_| found.change.abs() > 0.0)?;
        let half = t.inverse_cdf(0.975) * error;
        let days = |run: usize| self.levels[run].0;
        let bent = |from: usize| self.left(move |run| (days(run) - days(from)).max(0.0)).squares;
        let of_trend = (1..n - 1).map(bent).fold(self.left(days).squares, f64::min);
        Some(LevelStep {
            runs_before: at,
            after: date(days(at - 1)),
            by: date(days(at)),
            within_95: None,
            days: days(at) - days(at - 1),
            change: found.change,
            interval_95: [found.change - half, found.change + half],
            p_value: (2.0 * t.cdf(-(found.change / error).abs()) * ways).min(1.0),
            q_value: 1.0,
            left: if of_trend > 0.0 { found.squares / of_trend } else { f64::MAX },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sixteen runs a day apart, the second half on another level that says nothing.
    fn levels(of: impl Fn(usize) -> f64) -> (Vec<(f64, f64)>, Vec<usize>) {
        let noise = |k: usize| 0.1 * ((k * 7 % 5) as f64 - 2.0);
        let off = |k: usize| if k < 8 { 0.0 } else { 50.0 };
        let levels = (0..16).map(|k| (k as f64, of(k) + noise(k) + off(k))).collect();
        (levels, (0..16).map(|k| k / 8).collect())
    }

    #[test]
    fn what_lies_between_blocks_is_neither_trend_nor_step_and_what_lies_within_is() {
        let of = |own: &dyn Fn(usize) -> f64| {
            let (levels, blocks) = levels(own);
            let within = Within { levels: &levels, blocks: &blocks };
            (within.trend().unwrap(), within.best_step().unwrap())
        };
        let (trend, step) = of(&|_| 0.0);
        assert!(trend.p > 0.3 && step.p_value > 0.3, "{trend:?} {step:?}");
        let (trend, step) = of(&|k| k as f64);
        assert!((trend.slope - 1.0).abs() < 0.05 && trend.p < 1e-5 && step.left > 1.0, "{trend:?} {step:?}");
        assert!(trend.interval[0] > 0.9 && trend.interval[1] < 1.1, "{trend:?}");
        let (_, step) = of(&|k| if k < 12 { 0.0 } else { 3.0 });
        assert!(step.runs_before == 12 && (step.change - 3.0).abs() < 0.2, "{step:?}");
        assert!(step.p_value < 1e-6 && step.left < 0.5 && step.interval_95[0] > 2.7, "{step:?}");
        let (_, step) = of(&|k| if k < 8 { 0.0 } else { 3.0 });
        assert!(step.p_value > 0.3, "of the day on which the blocks meet nothing is known: {step:?}");
    }
}
