//! Degrees and where each puts its knots.

use multiversion::multiversion;

/// Degree of the spline; each has as many coefficients as conditions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Degree {
    /// 5, knots at the key points; speed and acceleration given at the ends. Of all curves
    /// through the key points it has the least integral of jerk squared.
    Quintic,
    /// 6, knots at the mid-intervals; speed, acceleration and jerk given at the ends.
    #[default]
    Sextic,
    /// 7, knots at the key points; speed, acceleration and jerk given at the ends.
    Septic,
}

impl Degree {
    /// The number.
    pub const fn order(self) -> usize {
        match self {
            Self::Quintic => 5,
            Self::Sextic => 6,
            Self::Septic => 7,
        }
    }

    /// Control points that the conditions at one end fix: position and derivatives.
    pub(super) const fn fixed(self) -> usize {
        match self {
            Self::Quintic => 3,
            Self::Sextic | Self::Septic => 4,
        }
    }
}

/// Knots and the reciprocals of their differences.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Knots {
    pub(super) degree: usize,
    /// The knots, ends repeated `degree + 1` times, interior ones distinct.
    pub(super) u: Vec<f64>,
    /// `[width - 1][i]`: 1 / (u[i + width] - u[i]) for widths up to the degree.
    reciprocals: Vec<f64>,
}

impl Knots {
    /// Room for the knots of `points` key points.
    pub(super) fn of(degree: Degree, points: usize) -> Self {
        let p = degree.order();
        let interior = if degree == Degree::Sextic { points - 1 } else { points - 2 };
        let count = 2 * (p + 1) + interior;
        Self { degree: p, u: vec![0.0; count], reciprocals: vec![0.0; p * count] }
    }

    /// Places the knots for these times, as many as there is room for.
    pub(super) fn place(&mut self, t_s: &[f64]) {
        let (p, count) = (self.degree, self.u.len());
        let (Some(&start), Some(&end)) = (t_s.first(), t_s.last()) else { return };
        self.u[..=p].fill(start);
        self.u[count - p - 1..].fill(end);
        let interior = &mut self.u[p + 1..count - p - 1];
        if interior.len() + 1 == t_s.len() {
            for (knot, pair) in interior.iter_mut().zip(t_s.windows(2)) {
                *knot = 0.5 * (pair[0] + pair[1]);
            }
        } else {
            for (knot, t) in interior.iter_mut().zip(&t_s[1..]) {
                *knot = *t;
            }
        }
        invert(&self.u, &mut self.reciprocals);
    }

    /// 1 / (u[i + width] - u[i]), 1/s, at `i` and after.
    #[inline]
    pub(super) fn reciprocals(&self, i: usize, width: usize) -> &[f64] {
        &self.reciprocals[(width - 1) * self.u.len() + i..width * self.u.len()]
    }

    #[inline]
    pub(super) fn controls(&self) -> usize {
        self.u.len() - self.degree - 1
    }

    /// Distinct knots, ascending: ends of the polynomial pieces.
    #[inline]
    pub(super) fn breaks(&self) -> &[f64] {
        &self.u[self.degree..self.u.len() - self.degree]
    }

    /// Index of the piece that holds `t_s`; the first or last one outside.
    #[inline]
    pub(super) fn piece(&self, t_s: f64) -> usize {
        let breaks = self.breaks();
        breaks[1..breaks.len() - 1].partition_point(|knot| *knot <= t_s)
    }
}

/// One over the difference of knots, `[width - 1][i]`, by the widest vector unit of the processor.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn invert(u: &[f64], reciprocals: &mut [f64]) {
    for (row, width) in reciprocals.chunks_exact_mut(u.len()).zip(1..) {
        for ((reciprocal, low), high) in row.iter_mut().zip(u).zip(&u[width..]) {
            // Infinite where both ends are repeated knots; no span straddles those.
            *reciprocal = 1.0 / (high - low);
        }
    }
}
