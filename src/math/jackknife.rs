//! How well a number is known, by its values without one part of the data each.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// Half the 95 % interval of a number by its values without one part each (Miller 1974), with Student's t; `None` of fewer than three.
pub fn jackknife(without: &[f64]) -> Option<f64> {
    let n = without.len() as f64;
    let t = (without.len() >= 3).then(|| StudentsT::new(0.0, 1.0, n - 1.0).ok())??;
    let mean = without.iter().sum::<f64>() / n;
    let squares: f64 = without.iter().map(|value| (value - mean).powi(2)).sum();
    Some(t.inverse_cdf(0.975) * (squares * (n - 1.0) / n).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_mean_it_is_the_interval_of_the_mean() {
        let values = [1.0, 2.0, 4.0, 8.0, 9.0];
        let n = values.len() as f64;
        let sum: f64 = values.iter().sum();
        let without = values.map(|value| (sum - value) / (n - 1.0));
        let variance = values.iter().map(|value| (value - sum / n).powi(2)).sum::<f64>() / (n - 1.0);
        // Student's t of four degrees of freedom.
        let half = 2.776_445 * (variance / n).sqrt();
        assert!((jackknife(&without).unwrap() - half).abs() < 1e-6);
        assert_eq!(jackknife(&without[..2]), None);
    }
}
