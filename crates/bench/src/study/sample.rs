//! One measure over the seeds, and against the same measure of the baseline.

use std::cmp::Ordering;

use hydrotrace::math::quantile;
use serde::{Deserialize, Deserializer, Serialize};
use statrs::stats_tests::{
    Alternative,
    mannwhitneyu::{MannWhitneyUMethod, mannwhitneyu},
};

/// One measure over the seeds. JSON has no infinities: a value that is not finite is null there.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Sample {
    /// Lower quartile.
    #[serde(deserialize_with = "finite")]
    #[cfg_attr(test, schemars(with = "Option<f64>"))]
    pub q1: f64,
    /// Median.
    #[serde(deserialize_with = "finite")]
    #[cfg_attr(test, schemars(with = "Option<f64>"))]
    pub median: f64,
    /// Upper quartile.
    #[serde(deserialize_with = "finite")]
    #[cfg_attr(test, schemars(with = "Option<f64>"))]
    pub q3: f64,
    /// Mean.
    #[serde(deserialize_with = "finite")]
    #[cfg_attr(test, schemars(with = "Option<f64>"))]
    pub mean: f64,
    /// Standard deviation; NaN for one seed.
    #[serde(deserialize_with = "finite")]
    #[cfg_attr(test, schemars(with = "Option<f64>"))]
    pub sd: f64,
    /// Against the baseline; absent for the baseline, or if it was not run.
    pub against: Option<Against>,
}

/// Reads null as NaN.
pub(crate) fn finite<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or(f64::NAN))
}

/// How a sample compares with the baseline's.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Against {
    /// Two-sided p of the rank-sum test, not corrected for the number of comparisons.
    pub p: f64,
    /// Probability that a run is better than one of the baseline, ties counted half (Vargha and
    /// Delaney's A).
    pub a12: f64,
    /// Who is better, if p is below 0.05.
    pub verdict: Verdict,
}

/// How a comparison ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Significantly better.
    Win,
    /// No significant difference.
    Tie,
    /// Significantly worse.
    Loss,
}

/// Level of significance.
const SIGNIFICANT: f64 = 0.05;

impl Sample {
    /// Summarises one value a seed, and compares with the baseline's values; `less` says that less
    /// is better.
    pub fn of(own: &[f64], rival: Option<&[f64]>, less: bool) -> Self {
        let [q1, median, q3] = quartiles(own);
        let mean = own.iter().sum::<f64>() / own.len() as f64;
        let squares: f64 = own.iter().map(|value| (value - mean).powi(2)).sum();
        let sd = (squares / (own.len() as f64 - 1.0)).sqrt();
        Self { q1, median, q3, mean, sd, against: rival.map(|rival| Against::of(own, rival, less)) }
    }
}

impl Against {
    /// Compares two samples; p is 1 and A is 0.5 if one is empty or all values are equal.
    pub fn of(own: &[f64], rival: &[f64], less: bool) -> Self {
        let test = mannwhitneyu(
            own,
            rival,
            MannWhitneyUMethod::AsymptoticInclContinuityCorrection,
            Alternative::TwoSided,
        );
        let p = test.map_or(1.0, |(_, p)| if p.is_finite() { p } else { 1.0 });
        let pairs = own.iter().flat_map(|a| rival.iter().map(move |b| a.partial_cmp(b)));
        let larger: f64 = pairs
            .map(|order| match order {
                Some(Ordering::Greater) => 1.0,
                Some(Ordering::Equal) => 0.5,
                _ => 0.0,
            })
            .sum();
        let count = (own.len() * rival.len()) as f64;
        let a12 = if count > 0.0 { larger / count } else { 0.5 };
        let a12 = if less { 1.0 - a12 } else { a12 };
        let verdict = match (p < SIGNIFICANT, a12 > 0.5) {
            (false, _) => Verdict::Tie,
            (true, true) => Verdict::Win,
            (true, false) => Verdict::Loss,
        };
        Self { p, a12, verdict }
    }
}

/// Lower quartile, median and upper quartile.
pub fn quartiles(values: &[f64]) -> [f64; 3] {
    [0.25, 0.5, 0.75].map(|p| quantile(values.to_vec(), p))
}

/// Wins, ties and losses among samples.
pub(super) fn tallied<'a>(samples: impl Iterator<Item = &'a Sample>) -> [usize; 3] {
    let mut counts = [0; 3];
    for against in samples.filter_map(|sample| sample.against) {
        counts[against.verdict as usize] += 1;
    }
    counts
}
