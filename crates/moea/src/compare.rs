//! How good a population is on a problem with a known front, and whether two samples differ.

use std::cmp::Ordering;

use statrs::stats_tests::{
    Alternative,
    mannwhitneyu::{MannWhitneyUMethod, mannwhitneyu},
};

use super::{
    Population,
    benchmark::Benchmark,
    indicator::{hypervolume, igd, igd_plus},
};

/// Quality of one population.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quality {
    /// Inverted generational distance, smaller is better.
    pub igd: f64,
    /// IGD+, smaller is better.
    pub igd_plus: f64,
    /// Hypervolume, larger is better: objectives are divided by 1.1 times the largest on the
    /// front, and the reference point is (1, ..., 1). The whole box counts as 1.
    pub hypervolume: f64,
}

/// What a population is measured against.
#[derive(Debug, Clone, PartialEq)]
pub struct Yardstick {
    front: Vec<f64>,
    nadir: Vec<f64>,
}

/// How far beyond the front the hypervolume's reference point lies.
const BEYOND: f64 = 1.1;

impl Yardstick {
    /// Measures against a front, `[n][objectives]` in one slice.
    pub fn new(front: Vec<f64>, objectives: usize) -> Self {
        let m = objectives.max(1);
        let nadir =
            (0..m).map(|k| front.iter().skip(k).step_by(m).fold(0.0_f64, |most, &f| most.max(f))).collect();
        Self { front, nadir }
    }

    /// Measures against at most about `count` points of the true front.
    pub fn of(problem: &Benchmark, count: usize) -> Self {
        Self { front: problem.front(count), nadir: problem.nadir() }
    }

    /// Number of points that distances are measured to.
    pub fn points(&self) -> usize {
        self.front.len() / self.nadir.len().max(1)
    }

    /// The hypervolume's reference point in the problem's own objectives, `[objectives]`.
    pub fn reference(&self) -> Vec<f64> {
        self.nadir.iter().map(|nadir| BEYOND * nadir).collect()
    }

    /// Quality of the feasible members of a population.
    pub fn measure(&self, population: &Population) -> Quality {
        let m = self.nadir.len();
        let set: Vec<f64> = (0..population.len())
            .filter(|&i| population.is_feasible(i))
            .flat_map(|i| population.f(i).iter().copied())
            .collect();
        let scaled: Vec<f64> = set
            .chunks_exact(m)
            .flat_map(|f| f.iter().zip(&self.nadir).map(|(f, nadir)| f / (BEYOND * nadir)))
            .collect();
        Quality {
            igd: igd(&set, &self.front, m),
            igd_plus: igd_plus(&set, &self.front, m),
            hypervolume: hypervolume(&scaled, &vec![1.0; m]),
        }
    }
}

/// Two samples side by side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison {
    /// Lower quartile, median and upper quartile of the first sample.
    pub first: [f64; 3],
    /// The same of the second.
    pub second: [f64; 3],
    /// Two-sided p of the Wilcoxon rank-sum test (normal approximation, ties corrected).
    pub p: f64,
    /// Probability that a draw of the first exceeds one of the second, ties counted half
    /// (Vargha and Delaney's A).
    pub a12: f64,
}

/// Level at which a difference counts.
pub const SIGNIFICANT: f64 = 0.05;

/// Compares two samples; p is 1 and A is 0.5 when one is empty or all values are equal.
pub fn compare(first: &[f64], second: &[f64]) -> Comparison {
    let quartiles = |v: &[f64]| {
        let mut v = v.to_vec();
        v.sort_unstable_by(f64::total_cmp);
        [0.25, 0.5, 0.75].map(|p| quantile_sorted(&v, p))
    };
    let test = mannwhitneyu(
        first,
        second,
        MannWhitneyUMethod::AsymptoticInclContinuityCorrection,
        Alternative::TwoSided,
    );
    let p = test.map_or(1.0, |(_, p)| if p.is_finite() { p } else { 1.0 });
    let wins: f64 = first
        .iter()
        .flat_map(|a| {
            second.iter().map(move |b| match a.partial_cmp(b) {
                Some(Ordering::Greater) => 1.0,
                Some(Ordering::Equal) => 0.5,
                _ => 0.0,
            })
        })
        .sum();
    let pairs = (first.len() * second.len()) as f64;
    let a12 = if pairs > 0.0 { wins / pairs } else { 0.5 };
    Comparison { first: quartiles(first), second: quartiles(second), p, a12 }
}

/// The `p` quantile of ascending values by linear interpolation (`numpy.quantile`); NaN for no values.
fn quantile_sorted(ascending: &[f64], p: f64) -> f64 {
    let Some(last) = ascending.len().checked_sub(1) else { return f64::NAN };
    let place = p * last as f64;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 <= place <= last")]
    let below = place.floor() as usize;
    let (low, part) = (ascending[below], place - below as f64);
    // With nothing of the way to go, an infinite next value is none.
    if part > 0.0 { low + part * (ascending[(below + 1).min(last)] - low) } else { low }
}

impl Comparison {
    /// 1 if the first sample is significantly larger, -1 if smaller, else 0.
    pub fn sign(&self) -> i8 {
        match (self.p < SIGNIFICANT, self.a12 > 0.5) {
            (false, _) => 0,
            (true, true) => 1,
            (true, false) => -1,
        }
    }
}
