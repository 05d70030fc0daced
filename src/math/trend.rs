//! Trends that outliers do not bend: the Theil-Sen slope, Kendall's test, and where a trend begins.

use statrs::distribution::{ContinuousCDF, Normal};

use super::{median, quantile_sorted};

/// Most points for which every order is counted.
const MOST_EXACT: usize = 40;

/// A trend of values over time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trend {
    /// Median of the slopes between all pairs of points, per unit of time (Sen 1968,
    /// doi:10.1080/01621459.1968.10480934).
    pub slope: f64,
    /// 95 % interval of the slope by Kendall's test, without any assumption on the noise.
    pub interval: [f64; 2],
    /// Two-sided probability of such an order by chance (Kendall 1938, doi:10.1093/biomet/30.1-2.81).
    pub p: f64,
}

/// Slopes between all pairs of points of different times, ascending.
fn slopes(points: &[(f64, f64)]) -> Vec<f64> {
    let pairs = points.iter().enumerate().flat_map(|(k, a)| points[k + 1..].iter().map(move |b| (a, b)));
    let mut slopes: Vec<f64> = pairs
        .filter(|(a, b)| (b.0 - a.0).abs() > 0.0)
        .map(|(a, b)| (b.1 - a.1) / (b.0 - a.0))
        .filter(|slope| slope.is_finite())
        .collect();
    slopes.sort_unstable_by(f64::total_cmp);
    slopes
}

/// The median slope of points `(time, value)`; NaN where no two have different times. O(n² log n).
pub fn theil_sen(points: &[(f64, f64)]) -> f64 {
    quantile_sorted(&slopes(points), 0.5)
}

/// The trend of points `(time, value)`, no two of which are measured together; `None` for fewer than three points or
/// two times. O(n² log n), and O(n³) up to the forty points for which `p` is exact.
pub fn trend(points: &[(f64, f64)]) -> Option<Trend> {
    let slopes = slopes(points);
    if points.len() < 3 || slopes.is_empty() {
        return None;
    }
    let sum = slopes.iter().map(|slope| sign(*slope)).sum::<f64>();
    let n = points.len() as f64;
    // Ties in time or value only lessen the variance: without them the test is on the safe side.
    let sd = (n * (n - 1.0) * (2.0 * n + 5.0) / 18.0).sqrt();
    let p = if points.len() <= MOST_EXACT {
        exact_p(points.len(), sum.abs())
    } else {
        (2.0 * Normal::standard().cdf(-(sum.abs() - 1.0).max(0.0) / sd)).min(1.0)
    };
    let reach = 1.959_964 * sd / slopes.len() as f64;
    let interval = [0.5 * (1.0 - reach), 0.5 * (1.0 + reach)].map(|p| quantile_sorted(&slopes, p));
    Some(Trend { slope: quantile_sorted(&slopes, 0.5), interval, p })
}

fn sign(value: f64) -> f64 {
    if value > 0.0 {
        1.0
    } else if value < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// The share of all orders of `n` points whose sum of signs is as far from zero, either way.
fn exact_p(n: usize, sum: f64) -> f64 {
    // `shares[k]`: share of orders with `k` pairs the wrong way round.
    let mut shares = vec![1.0_f64];
    for m in 2..=n {
        let mut next = vec![0.0; shares.len() + m - 1];
        for (k, share) in shares.iter().enumerate() {
            next[k..k + m].iter_mut().for_each(|cell| *cell += share / m as f64);
        }
        shares = next;
    }
    let pairs = (n * (n - 1) / 2) as f64;
    let tail = shares.iter().enumerate().filter(|(k, _)| pairs - 2.0 * *k as f64 >= sum - 0.5);
    (2.0 * tail.map(|(_, share)| share).sum::<f64>()).min(1.0)
}

/// The time from which on the values change: the last point of a level before a straight line, chosen for the least
/// sum of magnitudes left over; the first time if the line explains more than any level before it.
pub fn begins(points: &[(f64, f64)]) -> Option<f64> {
    let mut points = points.to_vec();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let left = |k: usize| {
        let at = points[k].0;
        let level = median(points[..=k].iter().map(|point| point.1).collect());
        let after = &points[k + 1..];
        let slope =
            median(after.iter().map(|(t, y)| (y - level) / (t - at).max(f64::MIN_POSITIVE)).collect());
        points.iter().map(|(t, y)| (y - level - slope * (t - at).max(0.0)).abs()).sum::<f64>()
    };
    let whole = {
        let slope = theil_sen(&points);
        let level = median(points.iter().map(|(t, y)| y - slope * t).collect());
        points.iter().map(|(t, y)| (y - level - slope * t).abs()).sum::<f64>()
    };
    let best = (1..points.len().saturating_sub(2)).map(|k| (k, left(k))).min_by(|a, b| a.1.total_cmp(&b.1));
    // A level costs a parameter: it must leave a good part less.
    best.filter(|(_, left)| *left < 0.8 * whole)
        .map_or(points.first(), |(k, _)| points.get(k))
        .map(|point| point.0)
}

/// For each of several tests the least false-discovery rate at which it counts as found (Benjamini and Hochberg 1995,
/// doi:10.1111/j.2517-6161.1995.tb02031.x).
pub fn false_discovery(p: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..p.len()).collect();
    order.sort_by(|a, b| p[*b].total_cmp(&p[*a]));
    let mut q = vec![1.0; p.len()];
    let mut least = 1.0_f64;
    for (above, &at) in order.iter().enumerate() {
        least = least.min(p[at] * p.len() as f64 / (p.len() - above) as f64);
        q[at] = least;
    }
    q
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-6 * expected.abs().max(1.0), "{found} is not {expected}");
    }

    #[test]
    fn slope_and_p_are_those_of_scipy() {
        // scipy.stats.theilslopes(y, x), kendalltau(x, y, method="exact").
        let noise = [0.35, -0.2, 0.12, -0.4, 0.2, 0.0, -0.13, 0.4, -0.3, 0.25];
        let points = noise.iter().enumerate().map(|(k, noise)| (k as f64, 0.5 * k as f64 + noise));
        let found = trend(&points.collect::<Vec<_>>()).unwrap();
        close(found.slope, 0.507_142_857_142_857_1);
        close(found.p, 1.151_895_943_562_610_1e-4);
        // SciPy takes the slopes next to these quantiles: 0.415 and 0.59.
        assert!(
            (found.interval[0] - 0.415).abs() < 0.01 && (found.interval[1] - 0.59).abs() < 0.01,
            "{found:?}"
        );
        // All in order: two of ten factorial orders.
        let straight: Vec<(f64, f64)> = (0..10).map(|k| (f64::from(k), f64::from(k))).collect();
        close(trend(&straight).unwrap().p, 2.0 / 3_628_800.0);
        // scipy.stats.kendalltau(range(5), [1, 2, 3, 5, 4], method="exact")
        let five = [1.0, 2.0, 3.0, 5.0, 4.0].iter().enumerate().map(|(k, y)| (k as f64, *y));
        close(trend(&five.collect::<Vec<_>>()).unwrap().p, 1.0 / 12.0);
        assert_eq!(trend(&straight[..2]), None);
        assert_eq!(trend(&[(1.0, 0.0), (1.0, 2.0), (1.0, 3.0)]), None);
    }

    #[test]
    fn equal_values_prove_nothing_and_one_wild_value_bends_nothing() {
        let level: Vec<(f64, f64)> = (0..8).map(|k| (f64::from(k), 3.0)).collect();
        let found = trend(&level).unwrap();
        assert_eq!((found.slope, found.p), (0.0, 1.0));
        let mut wild: Vec<(f64, f64)> = (0..20).map(|k| (f64::from(k), 2.0 * f64::from(k))).collect();
        wild[7].1 = 1e6;
        close(theil_sen(&wild), 2.0);
    }

    #[test]
    fn the_exact_test_meets_the_normal_one() {
        let n = 40.0_f64;
        let sd = (n * (n - 1.0) * (2.0 * n + 5.0) / 18.0).sqrt();
        let normal = 2.0 * Normal::standard().cdf(-(200.0 - 1.0) / sd);
        assert!((exact_p(40, 200.0) - normal).abs() < 0.002);
    }

    #[test]
    fn a_trend_begins_where_the_level_ends() {
        let bent: Vec<(f64, f64)> = (0..12)
            .map(|k| (f64::from(k), (f64::from(k) - 5.0).max(0.0) + 0.01 * f64::from(k % 3)))
            .collect();
        close(begins(&bent).unwrap(), 5.0);
        let straight: Vec<(f64, f64)> =
            (0..12).map(|k| (f64::from(k), f64::from(k) + 0.3 * f64::from(k % 2))).collect();
        close(begins(&straight).unwrap(), 0.0);
    }

    #[test]
    fn q_values_are_those_of_r() {
        // p.adjust(c(0.01, 0.02, 0.03, 0.5), "BH")
        let q = false_discovery(&[0.01, 0.5, 0.02, 0.03]);
        for (found, expected) in q.iter().zip([0.04, 0.5, 0.04, 0.04]) {
            close(*found, expected);
        }
        assert!(false_discovery(&[]).is_empty());
    }
}
