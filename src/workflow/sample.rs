//! One figure of many runs, and against that of other runs.

use serde::Serialize;

use crate::{math::quantile, moea::compare::compare};

/// One indicator over the seeds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Sample {
    /// Lower quartile.
    pub q1: f64,
    /// Median.
    pub median: f64,
    /// Upper quartile.
    pub q3: f64,
    /// Mean, as the paper prints it.
    pub mean: f64,
    /// Standard deviation; NaN for one run.
    pub sd: f64,
    /// Against the baseline, unless this is it or it was not run.
    pub against: Option<Against>,
}

/// How a sample compares with that of the baseline.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Against {
    /// Two-sided p of the rank-sum test, not corrected for the number of comparisons.
    pub p: f64,
    /// Probability that a run is better than one of the baseline, ties counted half (Vargha and
    /// Delaney's A).
    pub a12: f64,
    /// Whether p is below [`SIGNIFICANT`](crate::moea::compare::SIGNIFICANT), and for whom.
    pub verdict: Verdict,
}

/// How a comparison ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Significantly better.
    Win,
    /// No significant difference.
    Tie,
    /// Significantly worse.
    Loss,
}

impl Sample {
    /// Of one figure a run, against those of the baseline's runs; `less` says whether less is better.
    pub fn of(own: &[f64], rival: Option<&[f64]>, less: bool) -> Self {
        let [q1, median, q3] = quartiles(own);
        let against = rival.map(|rival| {
            let found = compare(own, rival);
            let better = if less { -found.sign() } else { found.sign() };
            Against {
                p: found.p,
                a12: if less { 1.0 - found.a12 } else { found.a12 },
                verdict: match better {
                    1 => Verdict::Win,
                    -1 => Verdict::Loss,
                    _ => Verdict::Tie,
                },
            }
        });
        let mean = own.iter().sum::<f64>() / own.len() as f64;
        let squares: f64 = own.iter().map(|value| (value - mean).powi(2)).sum();
        Self { q1, median, q3, mean, sd: (squares / (own.len() as f64 - 1.0)).sqrt(), against }
    }
}

/// Lower quartile, median and upper quartile.
pub(super) fn quartiles(values: &[f64]) -> [f64; 3] {
    [0.25, 0.5, 0.75].map(|p| quantile(values.to_vec(), p))
}

/// Wins, ties and losses among samples.
pub(super) fn tallied<'a>(samples: impl Iterator<Item = &'a Sample>) -> [usize; 3] {
    let mut counts = [0; 3];
    for against in samples.filter_map(|sample| sample.against) {
        match against.verdict {
            Verdict::Win => counts[0] += 1,
            Verdict::Tie => counts[1] += 1,
            Verdict::Loss => counts[2] += 1,
        }
    }
    counts
}

/// When to look at a run for its curve.
#[derive(Debug, Clone, Copy)]
pub(super) struct Watch {
    budget: u64,
    steps: u64,
    next: u64,
}

impl Watch {
    /// So many steps over a budget of evaluations, and the first population; never for no steps.
    pub(super) fn new(budget: u64, steps: u64) -> Self {
        Self { budget, steps, next: 0 }
    }

    /// Whether a step is due at so many evaluations; then it is counted as taken.
    pub(super) fn is_due(&mut self, evaluations: u64) -> bool {
        let made = u128::from(evaluations) * u128::from(self.steps);
        let due = self.steps > 0 && u128::from(self.next) * u128::from(self.budget) <= made;
        let due = due && self.next <= self.steps;
        if due {
            let reached = made / u128::from(self.budget.max(1));
            self.next = u64::try_from(reached).unwrap_or(u64::MAX).saturating_add(1);
        }
        due
    }
}

#[cfg(test)]
mod tests {
    use super::Watch;

    #[test]
    fn a_watch_looks_at_the_start_once_a_step_and_at_the_end() {
        let looks = |made: &[u64], steps| {
            let mut watch = Watch::new(1000, steps);
            made.iter().copied().filter(|&n| watch.is_due(n)).collect::<Vec<u64>>()
        };
        assert_eq!(looks(&[92, 184, 276, 900, 950, 992, 1000], 4), [92, 276, 900, 1000]);
        assert_eq!(looks(&[92, 1000], 0), [0_u64; 0]);
        assert_eq!(looks(&[700, 1000, 1000], 4), [700, 1000]);
    }
}
