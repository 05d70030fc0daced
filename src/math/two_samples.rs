//! Two samples with different scatter: Welch's test.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// The difference of the means of two samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Mean of the second minus mean of the first.
    pub value: f64,
    /// 95 % interval of it.
    pub interval: [f64; 2],
    /// Two-sided probability of such a difference by chance.
    pub p: f64,
}

/// Mean and the variance of it.
fn mean(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (mean, values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0) / n)
}

/// Welch's t-test (1947, doi:10.1093/biomet/34.1-2.28) of the difference `after - before - usual`, where `usual` comes
/// with a standard error of its own and the difference is known no better than `least_error`; `None` for fewer than
/// three values on a side, or without any scatter.
pub fn difference(
    before: &[f64],
    after: &[f64],
    (usual, usual_error, least_error): (f64, f64, f64),
) -> Option<Difference> {
    if before.len() < 3 || after.len() < 3 {
        return None;
    }
    let ((b, vb), (a, va)) = (mean(before), mean(after));
    let freedom =
        (va + vb).powi(2) / (va.powi(2) / (after.len() - 1) as f64 + vb.powi(2) / (before.len() - 1) as f64);
    let error = ((va + vb).max(least_error.powi(2)) + usual_error.powi(2)).sqrt();
    let value = a - b - usual;
    let t = StudentsT::new(0.0, 1.0, freedom).ok().filter(|_| error > 0.0 && value.is_finite())?;
    let half = t.inverse_cdf(0.975) * error;
    Some(Difference { value, interval: [value - half, value + half], p: 2.0 * t.cdf(-(value / error).abs()) })
}

/// Student's t-test of the difference `after - before`, where the values of both sides scatter alike: fewer than three on a side tell their
/// scatter by those of the other; `None` with fewer than two degrees of freedom, or without any scatter.
pub fn pooled_difference(before: &[f64], after: &[f64]) -> Option<Difference> {
    let freedom = (before.len() + after.len()).checked_sub(2)?;
    if before.is_empty() || after.is_empty() || freedom < 2 {
        return None;
    }
    let of = |values: &[f64]| {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        (mean, values.iter().map(|value| (value - mean).powi(2)).sum::<f64>())
    };
    let ((b, squares_b), (a, squares_a)) = (of(before), of(after));
    let each = 1.0 / before.len() as f64 + 1.0 / after.len() as f64;
    let error = ((squares_b + squares_a) / freedom as f64 * each).sqrt();
    let t = StudentsT::new(0.0, 1.0, freedom as f64).ok().filter(|_| error > 0.0 && (a - b).is_finite())?;
    let (value, half) = (a - b, t.inverse_cdf(0.975) * error);
    Some(Difference { value, interval: [value - half, value + half], p: 2.0 * t.cdf(-(value / error).abs()) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_test_of_scipy() {
        // SciPy's Welch test (equal_var=False) of after and before, its p value and confidence interval.
        let found = difference(&[1.0, 2.0, 3.3, 4.0], &[3.0, 4.5, 5.0, 6.0, 8.0], (0.0, 0.0, 0.0)).unwrap();
        assert!((found.p - 0.037_975_036_373_697_51).abs() < 1e-9, "{found:?}");
        assert!((found.interval[0] - 0.200_673_133_965_830_53).abs() < 1e-9, "{found:?}");
        assert!((found.interval[1] - 5.249_326_866_034_169).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn of_few_on_a_side_it_is_the_pooled_test_of_scipy() {
        // SciPy's test of equal variances (equal_var=True) of after and before.
        let found = pooled_difference(&[1.179, 1.034], &[1.376, 1.063, 1.414, 0.972, 1.148, 0.987]).unwrap();
        assert!((found.p - 0.729_716_234_789_806_2).abs() < 1e-9, "{found:?}");
        assert_eq!(pooled_difference(&[1.0], &[1.1, 1.2]), None);
        assert_eq!(pooled_difference(&[1.0; 2], &[1.0; 2]), None);
    }

    #[test]
    fn what_is_usual_is_taken_off_and_makes_it_less_certain() {
        let (before, after) = ([1.0, 1.1, 0.9], [3.0, 3.1, 2.9]);
        let plain = difference(&before, &after, (0.0, 0.0, 0.0)).unwrap();
        let less = difference(&before, &after, (0.5, 0.2, 0.3)).unwrap();
        assert!((less.value - 1.5).abs() < 1e-12 && less.p > plain.p);
        assert_eq!(difference(&before[..2], &after, (0.0, 0.0, 0.0)), None);
        assert_eq!(difference(&[1.0; 4], &[1.0; 4], (0.0, 0.0, 0.0)), None);
    }
}
