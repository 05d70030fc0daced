//! Figures of many runs as cells of a table.

use super::NONE;
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

/// That many significant digits.
pub(super) fn significant(value: f64, digits: u8) -> String {
    if !value.is_finite() {
        return value.to_string();
    }
    #[expect(clippy::cast_possible_truncation, reason = "an exponent")]
    let exponent = if value == 0.0 { 0 } else { value.abs().log10().floor() as i32 };
    let after = i32::from(digits.max(1)) - 1;
    let places = |count: i32| usize::try_from(count).unwrap_or(0);
    if exponent < -2 {
        format!("{value:.*e}", places(after))
    } else {
        format!("{value:.*}", places(after - exponent))
    }
}

#[cfg(test)]
mod tests {
    use super::significant;

    #[test]
    fn figures_keep_their_digits_at_every_size() {
        let values = [343.91, 19.4134, 1.18, 0.0557, 0.000_123_45, 12_345.6, 0.0, f64::INFINITY];
        let shown = values.map(|value| significant(value, 4));
        assert_eq!(shown, ["343.9", "19.41", "1.180", "0.05570", "1.234e-4", "12346", "0.000", "inf"]);
    }
}
