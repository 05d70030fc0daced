//! Figures of many runs as cells of a table.

use super::kit::NONE;
use crate::workflow::moea::{FEW_SEEDS, Sample, Verdict};

/// How to read [`against`].
pub(super) const AGAINST: &str = "Against nsga3: win or loss where the two-sided rank-sum test gives p < 0.05, not \
     corrected for the number of comparisons; A is the probability that a run is better than one of nsga3 (Vargha \
     and Delaney), 0.5 for no difference.";

/// Which runs the figures are of.
pub(super) fn seeds(first: u64, count: u64) -> String {
    match count {
        1 => format!("One seed, {first}"),
        n => format!("Medians and quartiles of {n} seeds, {first} to {}", first.wrapping_add(n - 1)),
    }
}

/// A warning where the seeds are few.
pub(super) fn few(count: u64) -> Option<String> {
    let few = count < FEW_SEEDS;
    few.then(|| format!("Fewer than {FEW_SEEDS} seeds: quartiles and p say little; more come with --seeds."))
}

/// Median and quartiles.
pub(super) fn sample(sample: &Sample, show: impl Fn(f64, u8) -> String) -> String {
    format!("{} ({}, {})", show(sample.median, 4), show(sample.q1, 3), show(sample.q3, 3))
}

/// Verdict, p and A against the baseline.
pub(super) fn against(sample: &Sample) -> String {
    sample.against.map_or(NONE.to_owned(), |against| {
        let word = match against.verdict {
            Verdict::Win => "win",
            Verdict::Tie => "tie",
            Verdict::Loss => "loss",
        };
        let p = if against.p < 0.001 { "<.001".to_owned() } else { format!("{:.3}", against.p) };
        format!("{word} {} {:.2}", p.trim_start_matches('0'), against.a12)
    })
}

/// Wins, ties and losses.
pub(super) fn counts([wins, ties, losses]: [usize; 3]) -> String {
    format!("{wins} {ties} {losses}")
}
