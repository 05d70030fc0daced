//! Distances from the true front to a set.

/// Inverted generational distance: the mean over the reference points of the Euclidean
/// distance to the nearest member of `set`.
///
/// Both sets are `[n][objectives]` in one slice. A member with an objective that is NaN counts for nothing. Infinite
/// for an empty set, NaN for no reference points and for slices of another width. O(n x n).
///
/// DIFFERENCE(eq. 10): the paper sums over the set and divides by the number of reference
/// points; the definition (Bosman and Thierens 2003) sums over the reference points.
pub fn igd(set: &[f64], reference: &[f64], objectives: usize) -> f64 {
    mean_nearest(set, reference, objectives, |gap| gap)
}

/// IGD+ (Ishibuchi et al. 2015): as [`igd`], but only objectives in which the member is worse
/// than the reference point count, which makes it agree with dominance.
pub fn igd_plus(set: &[f64], reference: &[f64], objectives: usize) -> f64 {
    mean_nearest(set, reference, objectives, |gap| if gap < 0.0 { 0.0 } else { gap })
}

fn mean_nearest(set: &[f64], reference: &[f64], objectives: usize, part: impl Fn(f64) -> f64) -> f64 {
    let m = objectives.max(1);
    if !set.len().is_multiple_of(m) || !reference.len().is_multiple_of(m) {
        return f64::NAN;
    }
    let nearest = reference.chunks_exact(m).map(|z| {
        let squares = set
            .chunks_exact(m)
            .map(|a| a.iter().zip(z).map(|(a, z)| part(a - z)).map(|gap| gap * gap).sum::<f64>());
        squares.fold(f64::INFINITY, f64::min).sqrt()
    });
    nearest.sum::<f64>() / (reference.len() / m) as f64
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "exact by construction")]
mod tests {
    use super::*;

    #[test]
    fn a_better_point_costs_distance_but_not_distance_plus() {
        let reference = [1.0, 1.0];
        assert_eq!(igd(&[0.0, 1.0], &reference, 2), 1.0);
        assert_eq!(igd_plus(&[0.0, 1.0], &reference, 2), 0.0);
        assert_eq!(igd_plus(&[4.0, 5.0], &reference, 2), 5.0);
        assert_eq!(igd(&[], &reference, 2), f64::INFINITY);
        for distance in [igd, igd_plus] {
            assert!(distance(&[0.1, 0.2, 0.3], &reference, 2).is_nan());
            assert!(distance(&reference, &[0.1, 0.2, 0.3], 2).is_nan());
        }
    }
}
