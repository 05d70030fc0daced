//! Paired differences: the Wilcoxon signed-rank test and the interval of a mean.

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Most differences for which every assignment of signs is counted.
const MOST_EXACT: usize = 25;

/// A signed-rank test; differences of zero are left out (Wilcoxon 1945, doi:10.2307/3001968).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SignedRank {
    /// Differences above zero.
    pub positive: usize,
    /// Differences below zero.
    pub negative: usize,
    /// Sum of the ranks of the positive differences, ties sharing their mean rank.
    pub rank_sum: f64,
    /// Two-sided probability of such a sum by chance; 1 without differences.
    pub p: f64,
    /// Whether `p` is exact, ties included; else it is the normal approximation, corrected for ties
    /// and continuity.
    pub exact: bool,
}

/// Tests whether paired differences centre on zero; NaN counts as zero. O(n log n), and O(n³) up to
/// the 25 differences for which `p` is exact.
pub fn signed_rank(differences: &[f64]) -> SignedRank {
    let mut ordered: Vec<f64> = differences.iter().copied().filter(|d| d.abs() > 0.0).collect();
    ordered.sort_unstable_by(|a, b| a.abs().total_cmp(&b.abs()));
    // Twice the rank, so that the mean rank of ties stays whole.
    let mut doubled: Vec<usize> = Vec::with_capacity(ordered.len());
    let mut ties = 0.0;
    for equal in ordered.chunk_by(|a, b| a.abs() >= b.abs()) {
        let (before, count) = (doubled.len(), equal.len());
        doubled.extend(std::iter::repeat_n(2 * before + count + 1, count));
        ties += (count as f64).powi(3) - count as f64;
    }
    let sum: usize = ordered.iter().zip(&doubled).filter(|(d, _)| **d > 0.0).map(|(_, rank)| rank).sum();
    let positive = ordered.iter().filter(|d| **d > 0.0).count();
    let exact = ordered.len() <= MOST_EXACT;
    let p = if exact { exact_p(&doubled, sum) } else { normal_p(ordered.len(), sum, ties) };
    SignedRank { positive, negative: ordered.len() - positive, rank_sum: sum as f64 / 2.0, p, exact }
}

/// Twice the share of sign assignments whose sum is as far out; ranks and sum are doubled.
fn exact_p(doubled: &[usize], sum: usize) -> f64 {
    let total: usize = doubled.iter().sum();
    // `ways[s]`: assignments of signs with the sum s.
    let mut ways = vec![0.0_f64; total + 1];
    ways[0] = 1.0;
    let mut reached = 0;
    for &rank in doubled {
        reached += rank;
        for s in (rank..=reached).rev() {
            ways[s] += ways[s - rank];
        }
    }
    // The distribution is symmetric.
    let tail: f64 = ways.iter().take(sum.min(total - sum) + 1).sum();
    (2.0 * tail / ways.iter().sum::<f64>()).min(1.0)
}

/// By the normal approximation; `sum` is doubled, `ties` is the sum of t³ - t over groups of ties.
fn normal_p(count: usize, sum: usize, ties: f64) -> f64 {
    let n = count as f64;
    let variance = n * (n + 1.0) * (2.0 * n + 1.0) / 24.0 - ties / 48.0;
    let off = (sum as f64 / 2.0 - n * (n + 1.0) / 4.0).abs();
    let z = (off - 0.5).max(0.0) / variance.sqrt();
    (2.0 * Normal::standard().cdf(-z)).min(1.0)
}

/// Half the 95 % interval of the mean of all values, which come in groups that vary together: Student's t
/// on the cluster-robust standard error (Liang and Zeger 1986, doi:10.1093/biomet/73.1.13). Groups of one
/// value give the interval of the paired t-test. Needs three groups.
pub fn half_interval(groups: &[Vec<f64>]) -> Option<f64> {
    let groups: Vec<&Vec<f64>> = groups.iter().filter(|group| !group.is_empty()).collect();
    let m = groups.len() as f64;
    let t = (groups.len() >= 3).then(|| StudentsT::new(0.0, 1.0, m - 1.0).ok())??;
    let n = groups.iter().map(|group| group.len()).sum::<usize>() as f64;
    let mean = groups.iter().flat_map(|group| group.iter()).sum::<f64>() / n;
    let square: f64 = groups.iter().map(|group| group.iter().map(|v| v - mean).sum::<f64>().powi(2)).sum();
    Some(t.inverse_cdf(0.975) * (square * m / (m - 1.0)).sqrt() / n)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hamilton depression scale before minus after, Hollander and Wolfe 1973, p. 29; the example
    /// of R's `wilcox.test`.
    const DEPRESSION: [f64; 9] = [0.952, -0.147, 1.022, 0.43, 0.62, 0.59, 0.49, -0.08, 0.01];

    fn close(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-12 * expected.abs().max(1.0), "{found} is not {expected}");
    }

    #[test]
    fn p_is_that_of_r_and_scipy_where_it_is_exact() {
        // wilcox.test(x, y, paired = TRUE): V = 40, p-value = 0.03906 (two-sided).
        let test = signed_rank(&DEPRESSION);
        close(test.rank_sum, 40.0);
        close(test.p, 0.039_062_5);
        assert!(test.exact && (test.positive, test.negative) == (7, 2));
        // scipy.stats.wilcoxon, its own example: Darwin's plants.
        let plants =
            [6.0, 8.0, 14.0, 16.0, 23.0, 24.0, 28.0, 29.0, 41.0, -48.0, 49.0, 56.0, 60.0, -67.0, 75.0];
        close(signed_rank(&plants).p, 0.041_259_765_625);
        let most: Vec<f64> =
            (0..25).map(|k| f64::from(k * 11 % 25 - 9) / 3.0 + 0.01 * f64::from(k)).collect();
        close(signed_rank(&most).p, 0.048_262_417_316_436_77);
    }

    #[test]
    fn ties_share_their_rank_and_zeros_are_left_out() {
        // All 2^8 assignments of signs, counted by brute force.
        let test = signed_rank(&[1.0, 1.0, -1.0, 2.0, 2.0, 3.0, -3.0, 4.0, 0.0, -0.0]);
        close(test.rank_sum, 27.5);
        close(test.p, 0.242_187_5);
        assert_eq!((test.positive, test.negative), (6, 2));
    }

    #[test]
    fn p_is_that_of_scipy_where_it_is_approximate() {
        // scipy.stats.wilcoxon(d, method="asymptotic", correction=True).
        let distinct: Vec<f64> =
            (0..40).map(|k| f64::from(k * 37 % 41 - 14) / 7.0 + 0.013 * f64::from(k)).collect();
        let test = signed_rank(&distinct);
        assert!((test.p - 4.399_208_569_498_262_6e-4).abs() < 1e-9 && !test.exact, "{test:?}");
        let tied: Vec<f64> = (0..33).map(|k| f64::from(k * 7 % 11 - 4)).collect();
        assert!((signed_rank(&tied).p - 0.090_409_229_364_442_36).abs() < 1e-9);
    }

    #[test]
    fn nothing_or_no_difference_proves_nothing() {
        for none in [&[][..], &[0.0; 40], &[f64::NAN]] {
            let test = signed_rank(none);
            assert_eq!((test.positive, test.negative), (0, 0));
            close(test.p, 1.0);
        }
        close(signed_rank(&[1.0, 2.0, 3.0, 4.0, 5.0]).p, 0.0625);
    }

    #[test]
    fn the_interval_is_that_of_the_paired_t_test() {
        // scipy.stats.t.interval(0.95, 8, mean, sem) is 0.103778..0.759999.
        let alone: Vec<Vec<f64>> = DEPRESSION.iter().map(|&d| vec![d]).collect();
        close(half_interval(&alone).unwrap(), 0.328_110_176_616_720_4);
        assert_eq!(half_interval(&alone[..2]), None);
    }

    #[test]
    fn saying_everything_twice_makes_no_interval_narrower() {
        let alone: Vec<Vec<f64>> = DEPRESSION.iter().map(|&d| vec![d]).collect();
        let twice: Vec<Vec<f64>> = DEPRESSION.iter().map(|&d| vec![d, d]).collect();
        close(half_interval(&twice).unwrap(), half_interval(&alone).unwrap());
    }
}
