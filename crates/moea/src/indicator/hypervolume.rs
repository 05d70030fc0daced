//! Exact hypervolume.
//!
//! Slices along the last objective, each with the part of a point that later points do not
//! cover, which is a hypervolume of one dimension less (While, Bradstreet and Barone 2012,
//! doi 10.1109/TEVC.2010.2077298), down to a sweep in three dimensions.

/// Volume that `set` dominates within `reference`, all objectives minimised.
///
/// `set` is `[n][objectives]` in one slice, `reference` `[objectives]`. Points that are not
/// better than the reference in every objective, or not finite, count for nothing. NaN for a reference that is not finite
/// or a slice of another width, and no finite number where the volume is too large for one. O(n²) for three
/// objectives, at worst n times more for each further one (.02 s for 1500 points of a sphere of four, .03 s for 600 of five). Exact but for rounding, about 1e-15 a point.
pub fn hypervolume(set: &[f64], reference: &[f64]) -> f64 {
    let m = reference.len();
    if m == 0 {
        return 0.0;
    }
    if !set.len().is_multiple_of(m) || reference.iter().any(|r| !r.is_finite()) {
        return f64::NAN;
    }
    let points: Vec<f64> = set
        .chunks_exact(m)
        .filter(|p| p.iter().zip(reference).all(|(p, r)| p < r && p.is_finite()))
        .flatten()
        .copied()
        .collect();
    if m > 3 { lean(&points, m, reference) } else { volume(&points, m, reference) }
}

/// As [`volume`] but for the order of sums, several times as fast: of the points before, those that another one covers
/// without the last objective are dropped for good, and three dimensions are swept without asking who is dominated.
/// Contributions stay as [`volume`] has them: runs depend on their last digits.
fn lean(points: &[f64], m: usize, reference: &[f64]) -> f64 {
    if m <= 3 {
        return volume(points, m, reference);
    }
    let (flat, points) = (m - 1, sorted(points, m));
    let below = &reference[..flat];
    let mut before: Vec<&[f64]> = Vec::new();
    let mut total = 0.0;
    for point in points.chunks_exact(m) {
        let p = &point[..flat];
        if before.iter().any(|q| covers(q, p)) {
            continue;
        }
        let own: f64 = p.iter().zip(below).map(|(p, r)| r - p).product();
        let limited: Vec<f64> = before.iter().flat_map(|q| q.iter().zip(p).map(|(q, p)| q.max(*p))).collect();
        let shared = if flat == 3 {
            volume(&limited, flat, below)
        } else {
            lean(&undominated(&limited, flat), flat, below)
        };
        total += (own - shared) * (reference[flat] - point[flat]);
        before.retain(|q| !covers(p, q));
        before.push(p);
    }
    total
}

/// Whether `a` is nowhere worse than `b`.
fn covers(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).all(|(a, b)| a <= b)
}

fn volume(points: &[f64], m: usize, reference: &[f64]) -> f64 {
    match m {
        1 => reference[0] - points.iter().fold(reference[0], |best, &p| best.min(p)),
        2 => area(&sorted(points, 2), reference),
        3 => sweep(&sorted(points, 3), reference),
        _ => slices(&sorted(points, m), m, reference),
    }
}

/// Points in ascending order of their last objective.
fn sorted(points: &[f64], m: usize) -> Vec<f64> {
    let mut order: Vec<&[f64]> = points.chunks_exact(m).collect();
    order.sort_by(|a, b| a[m - 1].total_cmp(&b[m - 1]));
    order.concat()
}

/// Area under points in ascending order of the second objective.
fn area(points: &[f64], reference: &[f64]) -> f64 {
    let (mut total, mut left) = (0.0, reference[0]);
    for p in points.chunks_exact(2) {
        if p[0] < left {
            total += (left - p[0]) * (reference[1] - p[1]);
            left = p[0];
        }
    }
    total
}

/// Volume of points in ascending order of the third objective: a staircase of the first two
/// grows point by point, and its area counts from one height to the next.
fn sweep(points: &[f64], reference: &[f64]) -> f64 {
    // Steps with rising first and falling second objective.
    let mut stairs: Vec<(f64, f64)> = Vec::with_capacity(points.len() / 3);
    let (mut total, mut covered) = (0.0, 0.0);
    let mut height = f64::NAN;
    for p in points.chunks_exact(3) {
        if covered > 0.0 {
            total += covered * (p[2] - height);
        }
        height = p[2];
        let at = stairs.partition_point(|step| step.0 < p[0]);
        let above = if at > 0 { stairs[at - 1].1 } else { reference[1] };
        if above <= p[1] || stairs.get(at).is_some_and(|step| step.0 <= p[0] && step.1 <= p[1]) {
            continue;
        }
        let mut end = at;
        let (mut left, mut top) = (p[0], above);
        while let Some(step) = stairs.get(end).filter(|step| step.1 >= p[1]) {
            covered += (step.0 - left) * (top - p[1]);
            (left, top) = *step;
            end += 1;
        }
        let right = stairs.get(end).map_or(reference[0], |step| step.0);
        covered += (right - left) * (top - p[1]);
        stairs.splice(at..end, [(p[0], p[1])]);
    }
    if covered > 0.0 { total + covered * (reference[2] - height) } else { total }
}

/// Volume of points in ascending order of the last objective.
fn slices(points: &[f64], m: usize, reference: &[f64]) -> f64 {
    let flat = m - 1;
    let below = &reference[..flat];
    let mut total = 0.0;
    for (k, p) in points.chunks_exact(m).enumerate() {
        let before = points[..k * m].chunks_exact(m).map(|q| &q[..flat]);
        total += exclusive(&p[..flat], before, below) * (reference[flat] - p[flat]);
    }
    total
}

/// Volume of `p` that none of `others` covers; all are better than the reference in every objective.
pub(super) fn exclusive<'a>(p: &[f64], others: impl Iterator<Item = &'a [f64]>, reference: &[f64]) -> f64 {
    let m = reference.len();
    let own: f64 = p.iter().zip(reference).map(|(p, r)| r - p).product();
    let limited: Vec<f64> = others.flat_map(|q| q.iter().zip(p).map(|(q, p)| q.max(*p))).collect();
    own - volume(&undominated(&limited, m), m, reference)
}

/// Points that no other point is at least as good as everywhere; one of each repeated point.
fn undominated(points: &[f64], m: usize) -> Vec<f64> {
    let mut kept: Vec<&[f64]> = Vec::new();
    for p in points.chunks_exact(m) {
        if kept.iter().any(|q| covers(q, p)) {
            continue;
        }
        kept.retain(|q| !covers(p, q));
        kept.push(p);
    }
    kept.concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_have_their_volume_in_any_dimension() {
        for m in 1..7 {
            let reference = vec![1.0; m];
            assert!(
                (hypervolume(&vec![0.5; m], &reference) - 0.5_f64.powi(i32::try_from(m).unwrap())).abs()
                    < 1e-15
            );
        }
        // Two overlapping boxes in each dimension: union = sum - intersection.
        for m in 2..7 {
            let (mut a, mut b) = (vec![0.5; m], vec![0.5; m]);
            (a[0], b[m - 1]) = (0.0, 0.0);
            let half = 0.5_f64.powi(i32::try_from(m).unwrap());
            let volume = hypervolume(&[a, b].concat(), &vec![1.0; m]);
            assert!((volume - 3.0 * half).abs() < 1e-15, "{m}: {volume}");
        }
    }

    #[test]
    fn the_lean_way_gives_the_volume_of_the_plain_one() {
        let mut rng = crate::Random::of_survival(7);
        for (m, n) in [(4, 200), (4, 60), (5, 60), (6, 30), (7, 20)] {
            for kind in 0..3 {
                let mut points: Vec<f64> = (0..n * m).map(|_| rng.unit()).collect();
                for p in points.chunks_exact_mut(m) {
                    let length = p.iter().map(|p| p * p).sum::<f64>().sqrt();
                    match kind {
                        0 => p.iter_mut().for_each(|p| *p /= length),
                        // Many equal values and points.
                        1 => p.iter_mut().for_each(|p| *p = (4.0 * *p).floor() / 4.0),
                        _ => p.iter_mut().for_each(|p| *p = 1.0 - *p / length),
                    }
                }
                let reference = vec![1.1; m];
                let (lean, plain) = (hypervolume(&points, &reference), volume(&points, m, &reference));
                assert!(plain > 0.0 && (lean / plain - 1.0).abs() < 1e-12, "{m} {kind}: {lean} {plain}");
            }
        }
    }

    #[test]
    fn points_outside_the_reference_count_for_nothing() {
        assert!(hypervolume(&[1.0, 0.0, 0.5, 2.0, f64::INFINITY, 0.0], &[1.0, 1.0]).abs() < 1e-300);
        assert!(hypervolume(&[], &[1.0, 1.0, 1.0]).abs() < 1e-300);
    }
}
