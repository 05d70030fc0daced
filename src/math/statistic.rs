//! Order statistics.

/// The `p` quantile of ascending values by linear interpolation between order statistics
/// (Hyndman and Fan's type 7, as `numpy.quantile`); NaN for no values.
pub fn quantile_sorted(ascending: &[f64], p: f64) -> f64 {
    let Some(last) = ascending.len().checked_sub(1) else {
        return f64::NAN;
    };
    let place = p.clamp(0.0, 1.0) * last as f64;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 <= place <= last")]
    let below = place.floor() as usize;
    let above = (below + 1).min(last);
    ascending[below] + (place - below as f64) * (ascending[above] - ascending[below])
}

/// The `p` quantile of values in any order; NaN for no values. O(n log n).
pub fn quantile(mut values: Vec<f64>, p: f64) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    quantile_sorted(&values, p)
}

/// The median; NaN for no values.
pub fn median(values: Vec<f64>) -> f64 {
    quantile(values, 0.5)
}

/// The median absolute deviation from the median, unscaled; NaN for no values.
pub fn mad(values: &[f64]) -> f64 {
    let centre = median(values.to_vec());
    median(values.iter().map(|v| (v - centre).abs()).collect())
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "exact by construction")]
mod tests {
    use super::*;

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
    fn the_mad_ignores_one_wild_value() {
        assert_eq!(mad(&[1.0, 2.0, 3.0, 4.0, 1e9]), 1.0);
    }
}
