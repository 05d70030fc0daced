//! Exact least and greatest values, and how far the curve swings beyond its key points.

use super::{Quantity, Spline};

/// A value and where it is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extremum {
    /// The value, rad and s.
    pub value: f64,
    /// When, s.
    pub t_s: f64,
}

/// The least and the greatest value over a stretch of time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extrema {
    /// The least.
    pub least: Extremum,
    /// The greatest.
    pub greatest: Extremum,
}

impl Extrema {
    /// The one of larger magnitude.
    pub fn peak(&self) -> Extremum {
        if self.least.value.abs() > self.greatest.value.abs() { self.least } else { self.greatest }
    }

    pub(super) fn widen(&mut self, value: f64, t_s: f64) {
        if value < self.least.value {
            self.least = Extremum { value, t_s };
        }
        if value > self.greatest.value {
            self.greatest = Extremum { value, t_s };
        }
    }
}

/// How far a joint leaves the range between two neighbouring key points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overshoot {
    /// Distance beyond the nearer key point, rad; positive above both, negative below, 0 for none.
    pub beyond_rad: f64,
    /// Where the joint is farthest out.
    pub at: Extremum,
}

impl Spline {
    /// Least and greatest control point: bounds of a quantity, much cheaper than [`Spline::extrema`] and never tighter.
    #[inline]
    pub fn hull(&self, joint: usize, quantity: Quantity) -> (f64, f64) {
        hull(self.control(joint, quantity))
    }

    /// Exact least and greatest value over the whole spline.
    pub fn extrema(&self, joint: usize, quantity: Quantity) -> Extrema {
        self.extrema_within(joint, quantity, self.span_s())
    }

    /// The value of largest magnitude over the whole spline.
    pub fn peak(&self, joint: usize, quantity: Quantity) -> Extremum {
        self.extrema(joint, quantity).peak()
    }

    /// Exact least and greatest value between two instants; those outside the spline count as its ends.
    ///
    /// On every piece whose hull could hold a new extremum, the roots of the derivative are
    /// isolated by Descartes' rule in Bernstein form and refined by Newton's method.
    pub fn extrema_within(&self, joint: usize, quantity: Quantity, (from_s, to_s): (f64, f64)) -> Extrema {
        let (start, end) = self.span_s();
        let (from_s, to_s) = (from_s.min(to_s).clamp(start, end), to_s.max(from_s).clamp(start, end));
        let functions = self.knots.degree + 1 - quantity.order();
        let control = self.control(joint, quantity);
        let breaks = self.knots.breaks();
        let mut extrema: Option<Extrema> = None;
        for piece in self.knots.piece(from_s)..=self.knots.piece(to_s) {
            let bounds = hull(&control[piece..piece + functions]);
            if extrema.is_some_and(|known| inside(bounds, &known)) {
                continue;
            }
            let (a, b) = (from_s.max(breaks[piece]), to_s.min(breaks[piece + 1]));
            let polynomial = self.bernstein(joint, quantity, piece, (a, b));
            let c = polynomial.coefficients();
            let (first, last) = (c[0], c[c.len() - 1]);
            let at_start = Extremum { value: first, t_s: a };
            let known = extrema.get_or_insert(Extrema { least: at_start, greatest: at_start });
            known.widen(first, a);
            known.widen(last, b);
            if !inside(hull(c), known) {
                polynomial.stationary(|x| known.widen(polynomial.at(x).0, a + x * (b - a)));
            }
        }
        // There is always a piece; the fallback keeps the function total.
        let nothing = Extremum { value: f64::NAN, t_s: from_s };
        extrema.unwrap_or(Extrema { least: nothing, greatest: nothing })
    }

    /// The greatest value between two instants, of the quantity or of its negative, if it exceeds `floor`; much cheaper
    /// than [`Spline::extrema_within`] where it does not.
    pub(crate) fn greatest_beyond(
        &self,
        (joint, quantity): (usize, Quantity),
        greatest: bool,
        (from_s, to_s): (f64, f64),
        floor: f64,
    ) -> Option<f64> {
        let (start, end) = self.span_s();
        let (from_s, to_s) = (from_s.clamp(start, end), to_s.clamp(start, end));
        let functions = self.knots.degree + 1 - quantity.order();
        let control = self.control(joint, quantity);
        let breaks = self.knots.breaks();
        let sign = if greatest { 1.0 } else { -1.0 };
        let top =
            |values: &[f64]| values.iter().fold(f64::NEG_INFINITY, |most, value| most.max(sign * value));
        let mut most = floor;
        for piece in self.knots.piece(from_s)..=self.knots.piece(to_s) {
            if top(&control[piece..piece + functions]) <= most {
                continue;
            }
            let within = (from_s.max(breaks[piece]), to_s.min(breaks[piece + 1]));
            let polynomial = self.bernstein(joint, quantity, piece, within);
            let c = polynomial.coefficients();
            let highest = top(c);
            if highest <= most {
                continue;
            }
            most = most.max(sign * c[0]).max(sign * c[c.len() - 1]);
            if highest > most {
                polynomial.stationary(|x| most = most.max(sign * polynomial.at(x).0));
            }
        }
        (most > floor).then_some(most)
    }

    /// How far a joint leaves the range of the key points `interval` and `interval + 1` between
    /// them: the larger of both sides.
    pub fn overshoot(&self, joint: usize, interval: usize) -> Overshoot {
        let ends = [self.points().of(interval)[joint], self.points().of(interval + 1)[joint]];
        let between = (self.t_s()[interval], self.t_s()[interval + 1]);
        let extrema = self.extrema_within(joint, Quantity::Position, between);
        let above = extrema.greatest.value - ends[0].max(ends[1]);
        let below = extrema.least.value - ends[0].min(ends[1]);
        // Key points themselves are met to rounding only.
        let rounding = 8.0 * f64::EPSILON * ends[0].abs().max(ends[1].abs());
        if above >= -below {
            Overshoot { beyond_rad: if above > rounding { above } else { 0.0 }, at: extrema.greatest }
        } else {
            Overshoot { beyond_rad: if below < -rounding { below } else { 0.0 }, at: extrema.least }
        }
    }
}

fn hull(coefficients: &[f64]) -> (f64, f64) {
    crate::math::range(coefficients.iter().copied()).into()
}

fn inside((least, most): (f64, f64), known: &Extrema) -> bool {
    least >= known.least.value && most <= known.greatest.value
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::{Degree, Ends, KeyPoints};

    #[test]
    fn what_exceeds_a_floor_is_the_greatest_and_nothing_else_is_told() {
        let t_s: Vec<f64> = (0..9).map(|i| f64::from(i) + 0.3 * f64::from(i % 3)).collect();
        let position = t_s.iter().map(|t| (1.7 * t).sin()).collect();
        let points = KeyPoints::new(1, position).unwrap();
        let spline = Spline::new(Degree::Sextic, points, &Ends::at_rest(1), &t_s).unwrap();
        for k in 0..400 {
            let from_s = 8.0 * (0.5 + 0.5 * f64::from(3 * k).sin());
            let within = (from_s, from_s + 0.4 * f64::from(k % 7));
            for quantity in Quantity::ALL {
                let known = spline.extrema_within(0, quantity, within);
                for (greatest, most) in [(true, known.greatest.value), (false, -known.least.value)] {
                    let found = |floor| spline.greatest_beyond((0, quantity), greatest, within, floor);
                    let near = |value: f64| (value - most).abs() < 1e-12 * (1.0 + most.abs());
                    assert!(found(most - 1e-3).is_some_and(near), "{quantity:?} {within:?} {most}");
                    assert_eq!(found(most + 1e-9), None, "{quantity:?} {within:?} {most}");
                }
            }
        }
    }
}
