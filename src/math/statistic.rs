//! Order statistics.

/// Least and largest of some values; the empty range from infinity to minus infinity for none.
pub fn range(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    values.into_iter().fold(none, |[least, most], value| [least.min(value), most.max(value)])
}

/// Sum of the products of two vectors.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// 0 of no values.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Root mean square; 0 for no values.
pub fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|x| x * x).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// Root mean square distance from the mean; 0 for no values.
pub fn deviation(values: &[f64]) -> f64 {
    let (count, mean) = (values.len().max(1) as f64, mean(values));
    (values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / count).sqrt()
}

/// The `p` quantile of ascending values by linear interpolation between order statistics
/// (Hyndman and Fan's type 7, as `numpy.quantile`); NaN for no values.
pub fn quantile_sorted(ascending: &[f64], p: f64) -> f64 {
    let Some((below, part)) = place(ascending.len(), p) else {
        return f64::NAN;
    };
    let above = (below + 1).min(ascending.len() - 1);
    ascending[below] + part * (ascending[above] - ascending[below])
}

/// The `p` quantile of values in any order, as [`quantile_sorted`]; NaN for no values. O(n).
pub fn quantile(mut values: Vec<f64>, p: f64) -> f64 {
    let Some((below, part)) = place(values.len(), p) else {
        return f64::NAN;
    };
    let (_, &mut low, above) = values.select_nth_unstable_by(below, f64::total_cmp);
    let high = above.iter().copied().min_by(f64::total_cmp).unwrap_or(low);
    // With nothing of the way to go, an infinite next value is none.
    if part > 0.0 { low + part * (high - low) } else { low }
}

/// The order statistic below the `p` quantile of `n` values, and the part of the way to the next.
fn place(n: usize, p: f64) -> Option<(usize, f64)> {
    let place = p.clamp(0.0, 1.0) * n.checked_sub(1)? as f64;
    let below = super::whole(place);
    Some((below, place - below as f64))
}

/// The median; NaN for no values.
pub fn median(values: Vec<f64>) -> f64 {
    quantile(values, 0.5)
}

/// What one of many steps takes: their median, or, where they come in bursts, their mean; 0 for none.
pub fn usual_step(steps: &[f64]) -> f64 {
    const TOGETHER: usize = 25;
    const BURSTS: f64 = 1.4;
    if steps.is_empty() {
        return 0.0;
    }
    let one = median(steps.to_vec());
    // Gaps are in few of them.
    let several = median(steps.chunks_exact(TOGETHER).map(mean).collect());
    if several > BURSTS * one { several } else { one }
}

/// Standard deviation of a normal distribution in units of its median absolute deviation.
pub const SIGMA_PER_MAD: f64 = 1.4826;

/// The median absolute deviation from the median, unscaled; NaN for no values.
pub fn mad(values: &[f64]) -> f64 {
    let centre = median(values.to_vec());
    median(values.iter().map(|v| (v - centre).abs()).collect())
}

/// The smallest difference between two of the values: those that repeat are known no better.
pub(super) fn quantum(values: &[f64]) -> f64 {
    let mut ascending = values.to_vec();
    ascending.sort_unstable_by(f64::total_cmp);
    let gaps = ascending.windows(2).map(|two| two[1] - two[0]).filter(|gap| *gap > 0.0);
    gaps.reduce(f64::min).unwrap_or(0.0)
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "exact by construction")]
mod tests {
    use super::*;

    #[test]
    fn a_step_in_a_burst_is_no_usual_one_and_neither_is_a_gap() {
        let bursts: Vec<f64> = (0..400).map(|k| if k % 5 == 0 { 0.049 } else { 0.000_25 }).collect();
        assert!((usual_step(&bursts) - 0.01).abs() < 1e-12);
        let even: Vec<f64> = (0..400).map(|k| if k % 100 == 7 { 60.0 } else { 0.01 }).collect();
        assert!((usual_step(&even) - 0.01).abs() < 1e-12);
        assert!((usual_step(&[0.01, 0.02, 9.0]) - 0.02).abs() < 1e-12 && usual_step(&[]) <= 0.0);
    }

    #[test]
    fn a_deviation_is_about_the_mean() {
        assert_eq!(
            [deviation(&[1.0, 5.0, 3.0, 3.0]), deviation(&[7.0]), deviation(&[])],
            [2.0_f64.sqrt(), 0.0, 0.0]
        );
    }

    #[test]
    fn quantiles_interpolate_as_numpy_does() {
        // numpy.quantile([1, 2, 4, 8], [0.25, 0.5, 0.95])
        let values = [1.0, 2.0, 4.0, 8.0];
        assert_eq!(
            [0.25, 0.5, 0.95].map(|p| quantile_sorted(&values, p)),
            [1.75, 3.0, 7.399_999_999_999_999]
        );
    }

    #[test]
    fn the_order_of_values_does_not_matter() {
        let values: Vec<f64> = (0..101).map(|k| f64::from(k * 37 % 101).sqrt()).collect();
        let mut ascending = values.clone();
        ascending.sort_unstable_by(f64::total_cmp);
        for p in [0.0, 0.01, 0.333, 0.5, 0.995, 1.0] {
            assert_eq!(quantile(values.clone(), p).to_bits(), quantile_sorted(&ascending, p).to_bits());
        }
        assert!(quantile(Vec::new(), 0.5).is_nan());
    }

    #[test]
    fn the_mad_ignores_one_wild_value() {
        assert_eq!(mad(&[1.0, 2.0, 3.0, 4.0, 1e9]), 1.0);
    }
}
