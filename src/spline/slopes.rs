//! Weights of control points in the curve and its derivatives, with their exact slopes by the intervals between points: forward
//! differentiation of the Cox-de Boor recurrence.

use std::ops::{Add, Mul, Sub};

use super::{Degree, Quantity, Spline, basis::WIDTH};

/// Intervals that the knots about one piece depend on, at most.
pub const WINDOW: usize = 13;

/// A value and its slopes by the intervals of a window.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Sloped {
    value: f64,
    slope: [f64; WINDOW],
}

/// What a piece's control points weigh at an instant: `[order][control]`.
///
/// The instant stays at its share of the piece, or at its point, while the intervals change.
#[derive(Debug, Clone, PartialEq)]
pub struct Weights {
    /// The first control point that has weight; the last is `degree` further on.
    pub first_control: usize,
    /// The first interval of the window.
    pub first_interval: usize,
    /// By order of derivative and control point, 1/s to the power of the order.
    pub value: [[f64; WIDTH]; 4],
    /// Slopes of the same by interval, per s.
    pub slope: [[[f64; WINDOW]; WIDTH]; 4],
}

/// An instant that moves with the intervals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// A share from 0 to 1 of a polynomial piece.
    Piece(usize, f64),
    /// A point of the spline.
    Point(usize),
}

impl Spline {
    /// Number of polynomial pieces.
    pub fn pieces(&self) -> usize {
        self.knots.breaks().len() - 1
    }

    /// Control points at each end that the motion there fixes.
    pub fn fixed_controls(&self) -> usize {
        self.degree().fixed()
    }

    /// Calls `found` with every share of a piece, inside (0, 1), at which a quantity's slope changes sign, and the
    /// quantity there, rad and s; extra places may be among them.
    pub fn stationary(
        &self,
        joint: usize,
        quantity: Quantity,
        piece: usize,
        mut found: impl FnMut(f64, f64),
    ) {
        let breaks = self.knots.breaks();
        let polynomial = self.bernstein(joint, quantity, piece, (breaks[piece], breaks[piece + 1]));
        polynomial.stationary(|share| found(share, polynomial.at(share).0));
    }

    /// Weights of the control points at a place, with their slopes by the intervals between the points.
    ///
    /// A place outside the spline counts as its last piece or point.
    pub fn weights(&self, place: Place) -> Weights {
        let t_s = self.t_s();
        let last = self.pieces() - 1;
        // The sextic's point lies in the piece of its own number, the others' is where that piece starts.
        let (Place::Piece(piece, _) | Place::Point(piece)) = place;
        let piece = piece.min(last);
        let degree = self.degree().order();
        let frame = Frame { spline: self, first: first_interval(self.degree(), piece) };
        let knots: Vec<Sloped> = (1..=2 * degree).map(|k| frame.knot(piece + k)).collect();
        let at = match place {
            Place::Piece(_, share) => {
                let (from, to) = (knots[degree - 1], knots[degree]);
                from + (to - from) * Sloped::constant(share)
            }
            Place::Point(point) => frame.point(point.min(t_s.len() - 1)),
        };
        let mut weights = Weights {
            first_control: piece,
            first_interval: frame.first,
            value: [[0.0; WIDTH]; 4],
            slope: [[[0.0; WINDOW]; WIDTH]; 4],
        };
        let mut row = [Sloped::constant(0.0); WIDTH];
        row[0] = Sloped::constant(1.0);
        for to in 1..=degree {
            raise(&mut row, to, degree, &knots, at);
            let order = degree - to;
            if order < 4 {
                for (k, weight) in lowered(row, order, degree, &knots).into_iter().enumerate() {
                    weights.value[order][k] = weight.value;
                    weights.slope[order][k] = weight.slope;
                }
            }
        }
        weights
    }
}

/// The first interval that the knots about a piece depend on.
fn first_interval(degree: Degree, piece: usize) -> usize {
    match degree {
        Degree::Sextic => piece.saturating_sub(6),
        Degree::Quintic | Degree::Septic => (piece + 1).saturating_sub(degree.order()),
    }
}

/// Times since the point where the window begins.
struct Frame<'a> {
    spline: &'a Spline,
    first: usize,
}

impl Frame<'_> {
    fn point(&self, point: usize) -> Sloped {
        let t_s = self.spline.t_s();
        let mut slope = [0.0; WINDOW];
        slope[..point.saturating_sub(self.first).min(WINDOW)].fill(1.0);
        Sloped { value: t_s[point] - t_s[self.first], slope }
    }

    /// A knot by its number, ends repeated.
    fn knot(&self, number: usize) -> Sloped {
        let (degree, last) = (self.spline.degree(), self.spline.t_s().len() - 1);
        let inner = number.saturating_sub(degree.order());
        if degree == Degree::Sextic {
            // Knot i lies midway between the points i - 1 and i.
            if inner == 0 || inner > last {
                return self.point(if inner == 0 { 0 } else { last });
            }
            return (self.point(inner - 1) + self.point(inner)) * Sloped::constant(0.5);
        }
        self.point(inner.min(last))
    }
}

/// From the row of degree `to - 1` to that of degree `to`; `knots` are those from one after the piece's first on.
fn raise(row: &mut [Sloped; WIDTH], to: usize, degree: usize, knots: &[Sloped], at: Sloped) {
    let mut saved = Sloped::constant(0.0);
    for j in 0..to {
        let (left, right) = (knots[degree - to + j], knots[degree + j]);
        let share = row[j] * (right - left).reciprocal();
        row[j] = saved + (right - at) * share;
        saved = (at - left) * share;
    }
    row[to] = saved;
}

/// Weights of the control points of position from those of a derivative's.
fn lowered(mut row: [Sloped; WIDTH], order: usize, degree: usize, knots: &[Sloped]) -> [Sloped; WIDTH] {
    for level in (1..=order).rev() {
        let mut below = [Sloped::constant(0.0); WIDTH];
        for (i, weight) in row.iter().enumerate().take(degree - level + 1) {
            let width = knots[degree + i] - knots[level + i - 1];
            let term = *weight * width.reciprocal() * Sloped::constant((degree + 1 - level) as f64);
            below[i] = below[i] - term;
            below[i + 1] = below[i + 1] + term;
        }
        row = below;
    }
    row
}

impl Sloped {
    const fn constant(value: f64) -> Self {
        Self { value, slope: [0.0; WINDOW] }
    }

    fn reciprocal(self) -> Self {
        let value = 1.0 / self.value;
        Self { value, slope: self.slope.map(|slope| -slope * value * value) }
    }
}

impl Add for Sloped {
    type Output = Self;

    fn add(mut self, other: Self) -> Self {
        self.value += other.value;
        self.slope.iter_mut().zip(other.slope).for_each(|(own, other)| *own += other);
        self
    }
}

impl Sub for Sloped {
    type Output = Self;

    fn sub(mut self, other: Self) -> Self {
        self.value -= other.value;
        self.slope.iter_mut().zip(other.slope).for_each(|(own, other)| *own -= other);
        self
    }
}

impl Mul for Sloped {
    type Output = Self;

    fn mul(mut self, other: Self) -> Self {
        for (own, slope) in self.slope.iter_mut().zip(other.slope) {
            *own = *own * other.value + self.value * slope;
        }
        self.value *= other.value;
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::{Ends, KeyPoints};

    fn spline(degree: Degree, interval_s: &[f64]) -> Spline {
        let mut t_s = vec![0.0];
        for interval_s in interval_s {
            t_s.push(t_s[t_s.len() - 1] + interval_s);
        }
        let position: Vec<f64> = (0..t_s.len()).map(|i| (i as f64 * 1.7).sin()).collect();
        let points = KeyPoints::new(1, position).unwrap();
        Spline::new(degree, points, &Ends::at_rest(1), &t_s).unwrap()
    }

    #[test]
    fn weights_times_control_points_are_the_curve_and_slopes_are_difference_quotients() {
        let interval_s: Vec<f64> = (0..11).map(|i| 0.5 + 0.13 * f64::from(i % 4)).collect();
        for degree in [Degree::Quintic, Degree::Sextic, Degree::Septic] {
            let here = spline(degree, &interval_s);
            let pieces = here.pieces();
            let places = (0..pieces).map(|i| Place::Piece(i, 0.3)).chain((0..12).map(Place::Point));
            for place in places {
                let found = here.weights(place);
                let breaks = here.knots.breaks();
                let t_s = match place {
                    Place::Piece(i, share) => breaks[i] + share * (breaks[i + 1] - breaks[i]),
                    Place::Point(i) => here.t_s()[i],
                };
                let sample = here.at(t_s);
                for quantity in Quantity::ALL {
                    let control = &here.control(0, Quantity::Position)[found.first_control..];
                    let sum: f64 =
                        control.iter().zip(found.value[quantity.order()]).map(|(c, w)| c * w).sum();
                    let want = sample.of(quantity, 0)[0];
                    assert!(
                        (sum - want).abs() < 1e-9 * want.abs().max(1.0),
                        "{degree:?} {place:?} {sum} {want}"
                    );
                }
                for k in 0..interval_s.len() {
                    let beside = |step: f64| {
                        let mut moved = interval_s.clone();
                        moved[k] += step;
                        spline(degree, &moved).weights(place)
                    };
                    let (after, before) = (beside(1e-5), beside(-1e-5));
                    for order in 0..4 {
                        for c in 0..WIDTH {
                            let quotient = (after.value[order][c] - before.value[order][c]) / 2e-5;
                            let within = k.checked_sub(found.first_interval).filter(|i| *i < WINDOW);
                            let slope = within.map_or(0.0, |i| found.slope[order][c][i]);
                            let scale = quotient.abs().max(10.0);
                            assert!(
                                (slope - quotient).abs() < 1e-6 * scale,
                                "{degree:?} {place:?} {k} {order} {c}: {slope} {quotient}"
                            );
                        }
                    }
                }
            }
        }
    }
}
