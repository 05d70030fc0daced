//! Trends that outliers do not bend: the Theil-Sen slope, Kendall's test, and where a trend begins.

use statrs::distribution::{ContinuousCDF, Normal};

use super::{mad, median, quantile_sorted};

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

/// The robust scatter of a row's steps, to which neither a trend nor a jump adds; NaN: no value. `None` for fewer than
/// three steps.
pub fn step_scatter(row: impl Iterator<Item = f64>) -> Option<f64> {
    let known: Vec<f64> = row.filter(|value| value.is_finite()).collect();
    let steps: Vec<f64> = known.windows(2).map(|two| two[1] - two[0]).collect();
    (steps.len() >= 3).then(|| mad(&steps))
}

/// A row quieter than this share of the usual scatter says no more than one just so quiet.
const LEAST_SCATTER: f64 = 0.2;

/// How much each row says: one over the square of its scatter. Those of unknown scatter are taken to be as is usual.
pub fn row_weights(scatters: &[Option<f64>]) -> Vec<f64> {
    let usual = median(scatters.iter().flatten().copied().collect());
    if usual.is_nan() || usual <= 0.0 {
        return vec![1.0; scatters.len()];
    }
    scatters.iter().map(|scatter| scatter.unwrap_or(usual).max(LEAST_SCATTER * usual).powi(-2)).collect()
}

/// The value that half of the weight lies below; with equal weights the median. NaN for no values.
pub fn weighted_median(mut values: Vec<(f64, f64)>) -> f64 {
    values.retain(|(value, weight)| value.is_finite() && *weight > 0.0);
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = values.iter().map(|(_, weight)| weight).sum();
    let mut below = 0.0;
    for (k, (value, weight)) in values.iter().enumerate() {
        below += weight;
        let beyond = below - 0.5 * total;
        if beyond.abs() <= 1e-9 * total {
            return values.get(k + 1).map_or(*value, |(next, _)| 0.5 * (value + next));
        }
        if beyond > 0.0 {
            return *value;
        }
    }
    f64::NAN
}

/// Values by row and column as the sum of a row's and a column's own level, both medians (Tukey's median polish), that of
/// a column weighted by what each row says; gives the levels of the columns, whose median is zero. NaN: no value. A
/// column without values has none.
pub fn column_levels(rows: &[Vec<f64>], weights: &[f64], columns: usize) -> Vec<f64> {
    const SWEEPS: usize = 20;
    let known = |values: Vec<f64>| values.into_iter().filter(|value| value.is_finite()).collect::<Vec<f64>>();
    let mut levels = begun(rows, weights, columns);
    for _ in 0..SWEEPS {
        let of_rows: Vec<f64> = rows
            .iter()
            .map(|row| median(known(row.iter().zip(&levels).map(|(value, level)| value - level).collect())))
            .collect();
        let next = |column: usize| {
            let rest = rows.iter().zip(&of_rows).zip(weights);
            weighted_median(
                rest.filter_map(|((row, own), weight)| Some((row.get(column)? - own, *weight))).collect(),
            )
        };
        levels = (0..columns).map(next).collect();
        let centre = median(known(levels.clone()));
        for level in &mut levels {
            *level -= centre;
        }
    }
    levels
}

/// Levels to begin with: what rows differ by is told by columns that are next to each other, for rows of which no column has two share
/// none, and each has its middle elsewhere.
fn begun(rows: &[Vec<f64>], weights: &[f64], columns: usize) -> Vec<f64> {
    const SWEEPS: usize = 3;
    const NEAR: usize = 2;
    let known: Vec<Vec<(usize, f64)>> = (0..columns)
        .map(|at| {
            let values = rows.iter().enumerate().filter_map(|(row, values)| Some((row, *values.get(at)?)));
            values.filter(|(_, value)| value.is_finite()).collect()
        })
        .collect();
    let finite = |row: &[f64]| row.iter().copied().filter(|value| value.is_finite()).collect::<Vec<f64>>();
    let mut own: Vec<f64> = rows.iter().map(|row| median(finite(row))).collect();
    let level = |at: usize, own: &[f64], but: Option<usize>| {
        let others = known[at].iter().filter(|(row, _)| Some(*row) != but);
        weighted_median(others.map(|(row, value)| (value - own[*row], weights[*row])).collect())
    };
    for _ in 0..SWEEPS {
        for (row, values) in rows.iter().enumerate() {
            let beside = |at: usize| {
                let near = (0..=NEAR).flat_map(|by| [at.checked_sub(by), Some(at + by)]).flatten();
                let mut near = near.filter(|at| *at < columns).map(|at| level(at, &own, Some(row)));
                near.find(|level| level.is_finite())
            };
            let off = values.iter().enumerate().filter(|(_, value)| value.is_finite());
            let off: Vec<f64> = off.filter_map(|(at, value)| Some(value - beside(at)?)).collect();
            if !off.is_empty() {
                own[row] = median(off);
            }
        }
    }
    (0..columns)
        .map(|at| level(at, &own, None))
        .map(|level| if level.is_finite() { level } else { 0.0 })
        .collect()
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
    fn rows_that_share_no_column_are_on_one_level_by_their_neighbours() {
        // Three rows in turn, the last one mostly after the level rises by 2.
        let of = |column: usize| if column < 20 { [0, 1][column % 2] } else { [0, 2, 1][column % 3] };
        let value = |column: usize| [1.0, 5.0, 9.0][of(column)] + if column < 24 { 0.0 } else { 2.0 };
        let rows: Vec<Vec<f64>> = (0..3)
            .map(|row| (0..48).map(|at| if of(at) == row { value(at) } else { f64::NAN }).collect())
            .collect();
        let levels = column_levels(&rows, &[1.0; 3], 48);
        let step = |at: usize| levels[at] - levels[0];
        assert!(
            (0..24).all(|at| step(at).abs() < 1e-9) && (24..48).all(|at| (step(at) - 2.0).abs() < 1e-9),
            "{levels:?}"
        );
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
    fn levels_of_columns_do_not_depend_on_which_rows_lack_a_value() {
        let rows: Vec<Vec<f64>> =
            (0..6).map(|r| (0..5).map(|c| 10.0 * f64::from(r) + f64::from(c)).collect()).collect();
        let mut some = rows.clone();
        // The row with the largest values is there early only.
        some[5][3] = f64::NAN;
        some[5][4] = f64::NAN;
        for table in [rows, some] {
            assert_eq!(column_levels(&table, &weights(&table), 5), [-2.0, -1.0, 0.0, 1.0, 2.0]);
        }
        assert!(column_levels(&[vec![1.0, f64::NAN]], &[1.0], 2)[1].is_nan());
    }

    fn weights(rows: &[Vec<f64>]) -> Vec<f64> {
        let scatters: Vec<Option<f64>> = rows.iter().map(|row| step_scatter(row.iter().copied())).collect();
        row_weights(&scatters)
    }

    #[test]
    fn a_quiet_row_says_more_than_noisy_ones() {
        let noise = [0.4, -0.9, 1.0, -0.2, -1.1, 0.8, 0.1, -0.7];
        let row = |scale: f64, shift: usize| -> Vec<f64> {
            (0..8).map(|k| 0.1 * k as f64 + scale * noise[(k + shift) % 8]).collect()
        };
        let rows = [row(0.01, 0), row(1.0, 1), row(1.0, 3), row(1.0, 6)];
        let levels = column_levels(&rows, &weights(&rows), 8);
        for (k, level) in levels.iter().enumerate() {
            assert!((level - (0.1 * k as f64 - 0.35)).abs() < 0.1, "{levels:?}");
        }
        close(weighted_median(vec![(3.0, 1.0), (1.0, 1.0), (2.0, 1.0), (4.0, 1.0)]), 2.5);
        close(weighted_median(vec![(1.0, 1.0), (2.0, 5.0), (f64::NAN, 9.0), (9.0, 1.0)]), 2.0);
        assert!(weighted_median(Vec::new()).is_nan());
        assert_eq!(weights(&[vec![1.0; 6], vec![2.0; 6]]), [1.0, 1.0]);
        let unknown = row_weights(&[Some(1.0), None, Some(1.0), Some(0.01)]);
        assert!(
            unknown
                .iter()
                .zip([1.0, 1.0, 1.0, 25.0])
                .all(|(found, expected)| (found - expected).abs() < 1e-9)
        );
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
