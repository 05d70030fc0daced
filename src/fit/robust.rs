//! Errors that are neither normal nor independent.

use crate::math::{SIGMA_PER_MAD, median};

/// Huber's constant: 95 % efficient on normal errors (Huber 1964, doi:10.1214/aoms/1177703732).
const TUNING: f64 = 1.345;

/// Samples in one batch.
const BATCH: usize = 100;

/// Robust scale of residuals around zero; not below `floor`.
pub(super) fn scale(residuals: impl Iterator<Item = f64>, floor: f64) -> f64 {
    let sigma = SIGMA_PER_MAD * median(residuals.map(f64::abs).collect());
    if sigma.is_nan() { floor } else { sigma.max(floor) }
}

/// Weight of a residual in scales.
pub(super) fn weight(residual: f64) -> f64 {
    let magnitude = residual.abs();
    if magnitude <= TUNING { 1.0 } else { TUNING / magnitude }
}

/// Cost of a residual in scales.
pub(super) fn cost(residual: f64) -> f64 {
    let magnitude = residual.abs();
    if magnitude <= TUNING { 0.5 * residual * residual } else { TUNING * (magnitude - 0.5 * TUNING) }
}

/// Statistical inefficiency: correlated residuals per effective sample, by batch means (variance of the means times
/// the batch length, divided by the variance); at least 1.
pub(super) fn inefficiency(residuals: &[f64]) -> f64 {
    let variance = |values: &[f64]| {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / values.len() as f64
    };
    let means: Vec<f64> =
        residuals.chunks_exact(BATCH).map(|batch| batch.iter().sum::<f64>() / BATCH as f64).collect();
    if means.len() < 2 {
        return BATCH as f64;
    }
    let ratio = variance(&means) * BATCH as f64 / variance(residuals);
    if ratio.is_finite() { ratio.clamp(1.0, BATCH as f64) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn independent_residuals_count_in_full_and_slow_ones_by_their_batches() {
        let white: Vec<f64> = (0..2000_u32).map(|k| f64::from(k * 7919 % 1009) / 1009.0 - 0.5).collect();
        assert!(inefficiency(&white) < 1.5, "{}", inefficiency(&white));
        let slow: Vec<f64> = (0..2000).map(|k| (f64::from(k) / 300.0).sin()).collect();
        assert!(inefficiency(&slow) > 90.0);
    }

    #[test]
    fn weight_is_the_slope_of_the_cost() {
        for r in [-3.0, -1.0, 0.2, 1.3, 5.0] {
            let slope = (cost(r + 1e-6) - cost(r - 1e-6)) / 2e-6;
            assert!((slope - weight(r) * r).abs() < 1e-6);
        }
    }
}
