//! The shape of a front: the surface `x_1^p + ... + x_m^p = 1` that comes nearest to it.
//!
//! # References
//!
//! Panichella 2022, doi 10.1145/3512290.3528732, section 3; corners after Panichella 2019,
//! doi 10.1145/3321707.3321839. Differences: objectives are divided by the range of the front before corners are
//! looked for, so that their scale does not matter; the exponent is that of the point whose largest objective is
//! least, where the paper takes the one at the least Euclidean distance. On a sphere all are at the same distance,
//! and with larger exponents those at the corners are nearest, whose own exponent is next to chance: of 23 runs on
//! DTLZ2 with three objectives 5 lost most of the middle of the front.

use super::normalize::inverse_intercepts;

/// Exponents beyond these are those of no front: the least and the largest one.
const EXPONENTS: (f64, f64) = (0.1, 20.0);
/// Newton's method ends after a step of this, or after so many.
const PRECISION: f64 = 1e-3;
const STEPS: usize = 100;
/// How far the axes lean into the objectives where corners are looked for, so that no point is one for its exact
/// zeros alone.
const TILT: f64 = 1e-6;
/// A surface whose exponent is so near to 1 counts as a plane.
const FLAT: f64 = 0.05;

/// Where a front lies and how it is curved.
#[derive(Debug, Clone, Default)]
pub(super) struct Shape {
    ideal: Vec<f64>,
    /// What one unit of each normalised objective is worth.
    span: Vec<f64>,
    p: f64,
    middle: Vec<f64>,
}

impl Shape {
    /// Fits a front, `[n][m]` in one slice. Returns the places of its corners: the points nearest to each
    /// axis, `m` different ones or as many as there are.
    pub(super) fn fit(&mut self, front: &[f64], m: usize) -> Vec<usize> {
        let of = |k: usize| front.iter().skip(k).step_by(m).copied();
        self.ideal.clear();
        self.ideal.extend((0..m).map(|k| of(k).fold(f64::INFINITY, f64::min)));
        self.span.clear();
        self.span.extend((0..m).map(|k| of(k).fold(f64::NEG_INFINITY, f64::max) - self.ideal[k]));
        for span in self.span.iter_mut().filter(|span| !(**span > 0.0 && span.is_finite())) {
            *span = 1.0;
        }
        self.p = 1.0;
        self.middle.resize(m, 0.0);
        let mut points = front.to_vec();
        points.chunks_exact_mut(m).for_each(|point| self.apply(point));
        let corners = corners(&points, m);
        if corners.len() < m {
            return corners;
        }
        let mut matrix: Vec<f64> = corners.iter().flat_map(|&i| points[i * m..][..m].to_vec()).collect();
        let mut inverse = vec![1.0; m];
        if inverse_intercepts(&mut matrix, &mut inverse) {
            self.span.iter_mut().zip(&inverse).for_each(|(span, inverse)| *span /= inverse);
            points.chunks_exact_mut(m).for_each(|f| f.iter_mut().zip(&inverse).for_each(|(f, i)| *f *= i));
        }
        let largest = |i: usize| points[i * m..][..m].iter().fold(f64::NEG_INFINITY, |most, &f| most.max(f));
        let others = (0..points.len() / m).filter(|i| !corners.contains(i));
        let central = others.min_by(|&a, &b| largest(a).total_cmp(&largest(b)));
        if let Some(i) = central {
            self.p = exponent(&points[i * m..][..m]);
        }
        corners
    }

    /// Normalises objectives in place, `[m]`: 0 is the ideal, 1 the intercept.
    pub(super) fn apply(&self, f: &mut [f64]) {
        for ((f, ideal), span) in f.iter_mut().zip(&self.ideal).zip(&self.span) {
            *f = (*f - ideal) / span;
        }
    }

    /// How far a normalised point is from the ideal: its norm of exponent `p`.
    pub(super) fn distance(&self, point: &[f64]) -> f64 {
        norm(point, self.p)
    }

    /// Moves a normalised point onto the surface, along the line to the ideal.
    pub(super) fn project(&self, point: &mut [f64]) {
        let norm = norm(point, self.p);
        if norm > 0.0 {
            for f in point {
                *f /= norm;
            }
        }
    }

    /// Distance of two points on the surface along it, by way of the point between them.
    pub(super) fn apart(&mut self, a: &[f64], b: &[f64]) -> f64 {
        if (self.p - 1.0).abs() < FLAT {
            return euclidean(a, b);
        }
        let mut middle = std::mem::take(&mut self.middle);
        middle.iter_mut().zip(a.iter().zip(b)).for_each(|(middle, (a, b))| *middle = 0.5 * a + 0.5 * b);
        self.project(&mut middle);
        let apart = euclidean(a, &middle) + euclidean(b, &middle);
        self.middle = middle;
        apart
    }
}

/// The point nearest to each axis, none of them twice.
fn corners(points: &[f64], m: usize) -> Vec<usize> {
    let mut corners = Vec::with_capacity(m);
    for axis in 0..m {
        let tilted = |k: usize| TILT + f64::from(u8::from(k == axis));
        let length = (0..m).map(|k| tilted(k).powi(2)).sum::<f64>();
        let aside = |i: usize| {
            let point = &points[i * m..][..m];
            let along = point.iter().enumerate().map(|(k, f)| f * tilted(k)).sum::<f64>() / length;
            point.iter().enumerate().map(|(k, f)| (f - along * tilted(k)).powi(2)).sum::<f64>()
        };
        let free = (0..points.len() / m).filter(|i| !corners.contains(i));
        corners.extend(free.min_by(|&a, &b| aside(a).total_cmp(&aside(b))));
    }
    corners
}

/// The exponent of the surface through a point: the root of `ln(x_1^p + ... + x_m^p)` by Newton's
/// method, 1 if it has none.
fn exponent(point: &[f64]) -> f64 {
    let mut p = 1.0;
    for _ in 0..STEPS {
        let (mut sum, mut slope) = (0.0, 0.0);
        for f in point.iter().filter(|f| **f > 0.0) {
            let power = f.powf(p);
            sum += power;
            slope += power * f.ln();
        }
        let step = sum.ln() * sum / slope;
        p -= step;
        if step.is_nan() || step.abs() <= PRECISION {
            break;
        }
    }
    if p.is_finite() && p > EXPONENTS.0 { p.min(EXPONENTS.1) } else { 1.0 }
}

/// Norm of exponent `p` of a point; what is below 0 counts as 0.
fn norm(point: &[f64], p: f64) -> f64 {
    let most = point.iter().fold(0.0_f64, |most, &f| most.max(f));
    if !(most > 0.0 && most.is_finite()) {
        return most;
    }
    most * point.iter().map(|f| (f / most).max(0.0).powf(p)).sum::<f64>().powf(1.0 / p)
}

fn euclidean(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::das_dennis;

    /// Points of a surface, each objective in a unit and from an origin of its own.
    fn surface(p: f64) -> Vec<f64> {
        let mut points = das_dennis(3, 12).unwrap();
        for point in points.chunks_exact_mut(3) {
            let norm = norm(point, p);
            for (f, (unit, origin)) in point.iter_mut().zip([(1e-3, 5.0), (1.0, 0.0), (1e3, -7e3)]) {
                *f = *f / norm * unit + origin;
            }
        }
        points
    }

    #[test]
    fn the_exponent_of_a_surface_is_found_whatever_the_units() {
        for p in [0.4, 1.0, 2.0, 5.0] {
            let mut shape = Shape::default();
            let corners = shape.fit(&surface(p), 3);
            assert_eq!(corners.len(), 3);
            assert!((shape.p - p).abs() < 1e-3 * p, "{p}: {}", shape.p);
            let want = [1e-3, 1.0, 1e3];
            assert!(shape.span.iter().zip(want).all(|(got, want)| (got / want - 1.0).abs() < 1e-9));
        }
    }

    #[test]
    fn distances_follow_the_surface() {
        let mut shape = Shape::default();
        shape.fit(&surface(2.0), 3);
        // A quarter of a circle, by two chords.
        let arc = shape.apart(&[1.0, 0.0, 0.0], &[0.0, 1.0, 0.0]);
        assert!((arc - 4.0 * (std::f64::consts::PI / 8.0).sin()).abs() < 1e-3, "{arc}");
        shape.fit(&surface(1.0), 3);
        assert!((shape.apart(&[1.0, 0.0, 0.0], &[0.0, 1.0, 0.0]) - 2.0_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn a_point_without_an_exponent_counts_as_on_a_plane() {
        for point in [[0.0, 0.0], [1.0, 1.0], [2.0, 3.0], [0.5, 0.0], [f64::NAN, 0.5], [f64::INFINITY, 0.1]] {
            assert!((exponent(&point) - 1.0).abs() < 1e-12, "{point:?}: {}", exponent(&point));
        }
        assert!((exponent(&[0.99, 0.99]) - 20.0).abs() < 1e-12);
    }
}
