//! A level that changes once and stays: between which two points, and by how much.

use statrs::distribution::{ContinuousCDF, StudentsT};

use super::statistic::quantum;

/// Points on each side of a step, at least.
const FEWEST: usize = 3;

/// The step that explains a series of values best.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// The first point after it.
    pub at: usize,
    /// Mean after less mean before.
    pub change: f64,
    /// Its 95 % interval, by Student's t, where the step is known to be there.
    pub interval: [f64; 2],
    /// Two-sided probability of such a step anywhere by chance: that of Student's t, times the places that were tried
    /// (Worsley 1979, doi:10.1080/01621459.1979.10482519).
    pub p: f64,
    /// Sum of squares that it leaves.
    pub squares: f64,
}

/// The step of a series in order; `None` for fewer than six values, or if none of them differs from another.
pub fn step(values: &[f64]) -> Option<Step> {
    let tried = values.len().checked_sub(2 * FEWEST)? + 1;
    let mean = |side: &[f64]| side.iter().sum::<f64>() / side.len() as f64;
    let squares = |side: &[f64]| {
        let mean = mean(side);
        side.iter().map(|value| (value - mean).powi(2)).sum::<f64>()
    };
    let left = |at: usize| squares(&values[..at]) + squares(&values[at..]);
    let (at, squares) = (FEWEST..FEWEST + tried)
        .map(|at| (at, left(at)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .filter(|(_, squares)| squares.is_finite())?;
    let change = mean(&values[at..]) - mean(&values[..at]);
    let (before, after) = (at as f64, (values.len() - at) as f64);
    let freedom = before + after - 2.0;
    let variance = (squares / freedom).max(quantum(values).powi(2) / 12.0);
    let error = (variance * (1.0 / before + 1.0 / after)).sqrt();
    let t = StudentsT::new(0.0, 1.0, freedom).ok().filter(|_| change.abs() > 0.0)?;
    let one = 2.0 * t.cdf(-(change / error).abs());
    let half = t.inverse_cdf(0.975) * error;
    Some(Step {
        at,
        change,
        interval: [change - half, change + half],
        p: (one * tried as f64).min(1.0),
        squares,
    })
}

#[cfg(test)]
mod tests {
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, StandardNormal, StudentT};

    use super::*;

    #[test]
    fn a_step_is_found_where_it_is() {
        let values = [0.456, 0.454, 0.461, 0.461, 0.453, 0.413, 0.418, 0.286, 0.289, 0.311, 0.311, 0.270];
        let found = step(&values).unwrap();
        assert_eq!(found.at, 7);
        // The t-test of SciPy for equal variances, values[7:] and values[:7]: p and interval; seven places were tried.
        assert!((found.p / (7.0 * 1.070_697_605_017_341e-7) - 1.0).abs() < 1e-6, "{found:?}");
        assert!((found.interval[0] + 0.177_081_770_350_539).abs() < 1e-9, "{found:?}");
        assert!((found.interval[1] + 0.126_403_943_935_175).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn values_that_repeat_are_known_to_their_smallest_difference() {
        let found = step(&[0.35, 0.35, 0.35, 0.36, 0.36, 0.36]).unwrap();
        assert!(found.p > 0.005 && found.interval[0] > 0.0 && found.interval[0] < 0.005, "{found:?}");
    }

    #[test]
    fn equal_values_and_few_have_none() {
        assert_eq!(step(&[1.0; 12]), None);
        assert_eq!(step(&[1.0, 1.0, 1.0, 2.0, 2.0]), None);
        assert_eq!(step(&[]), None);
        assert_eq!(step(&[0.0, 1.0, f64::NAN, 3.0, 4.0, 5.0, 6.0]), None);
    }

    #[test]
    fn noise_has_a_step_no_more_often_than_p_says() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
        let heavy = StudentT::new(3.0).unwrap();
        for count in [6, 12, 30] {
            for is_heavy in [false, true] {
                let mut draw =
                    || if is_heavy { heavy.sample(&mut rng) } else { StandardNormal.sample(&mut rng) };
                let found =
                    |_| step(&(0..count).map(|_| draw()).collect::<Vec<f64>>()).is_some_and(|s| s.p < 0.05);
                let share = (0..2000).map(found).filter(|found| *found).count() as f64 / 2000.0;
                assert!(share < 0.065, "{count} values, heavy tails {is_heavy}: {share}");
            }
        }
    }
}
