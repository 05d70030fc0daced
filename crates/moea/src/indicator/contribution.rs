//! Exact contributions to the hypervolume.

use super::hypervolume::exclusive;

/// Volume that each point of `set` dominates within `reference` and no other point does, `[n]`; all objectives
/// minimised.
///
/// `set` is `[n][objectives]` in one slice, `reference` `[objectives]`. Points that are dominated, repeated or not
/// better than the reference in every objective, or not finite, contribute nothing, and neither does any beside a reference that is
/// no number or where volumes are too large for one. NaN for each point, the incomplete one too, of a slice of another
/// width. O(n²) for two and three objectives where few
/// points border on one, at worst O(n³); about n times more for each further one. Exact but for rounding, about
/// 1e-15 of the largest box.
pub fn contributions(set: &[f64], reference: &[f64]) -> Vec<f64> {
    let m = reference.len().max(1);
    if !set.len().is_multiple_of(m) {
        return vec![f64::NAN; set.len().div_ceil(m)];
    }
    let points = Points { set, reference };
    (0..set.len() / m).map(|i| points.contribution(i, |_| true)).collect()
}

/// Points and what their volumes are measured from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Points<'a> {
    /// `[n][m]`.
    pub(crate) set: &'a [f64],
    /// `[m]`.
    pub(crate) reference: &'a [f64],
}

impl Points<'_> {
    /// Contribution of point `i` among those that count.
    pub(crate) fn contribution(&self, i: usize, counts: impl Fn(usize) -> bool) -> f64 {
        let m = self.reference.len();
        let point = |j: usize| &self.set[j * m..][..m];
        let inside = |j: usize| {
            point(j).iter().zip(self.reference).all(|(f, reference)| f < reference && f.is_finite())
        };
        if m == 0 || !inside(i) {
            return 0.0;
        }
        let others = (0..self.set.len() / m).filter(|&j| j != i && counts(j) && inside(j));
        exclusive(point(i), others.map(point), self.reference).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::indicator::hypervolume;

    #[test]
    fn a_slice_of_another_width_has_no_contributions() {
        let got = contributions(&[0.1, 0.2, 0.3], &[1.0, 1.0]);
        assert!(got.len() == 2 && got.iter().all(|got| got.is_nan()), "{got:?}");
    }

    #[test]
    fn a_contribution_is_the_volume_that_goes_with_its_point() {
        let wave = |i: usize, k: usize| ((7 * i + 3 * k + i * k) as f64).sin().abs();
        for m in 1..6 {
            let mut set: Vec<f64> = (0..12).flat_map(|i| (0..m).map(move |k| wave(i, k))).collect();
            // A repeated point, and one beyond the reference.
            set.extend_from_within(m..2 * m);
            set.extend(vec![2.0; m]);
            let reference = vec![0.9; m];
            let all = hypervolume(&set, &reference);
            let got = contributions(&set, &reference);
            assert_eq!(got.len(), 14);
            for (i, got) in got.iter().enumerate() {
                let without = [&set[..i * m], &set[(i + 1) * m..]].concat();
                let want = all - hypervolume(&without, &reference);
                assert!((got - want).abs() < 1e-14, "{m} objectives, point {i}: {got} {want}");
            }
            assert!(got.iter().any(|&got| got > 1e-3), "{m}");
        }
    }
}
