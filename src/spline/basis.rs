//! B-spline basis functions by the Cox-de Boor recurrence, several instants at a time
//! (Piegl and Tiller, The NURBS Book, 2nd ed., algorithm A2.2).

use super::knots::Knots;

/// One more than the highest degree.
pub(super) const WIDTH: usize = 8;

/// Values of the basis functions that do not vanish on a piece, `[function][instant]`.
pub(super) type Row<const L: usize> = [[f64; L]; WIDTH];

/// Row of degree 0.
#[inline(always)]
pub(super) fn constant<const L: usize>() -> Row<L> {
    let mut row = [[0.0; L]; WIDTH];
    row[0] = [1.0; L];
    row
}

/// Turns the row of degree `to - 1` into that of degree `to`, for instants in one piece.
///
/// The row of degree g weighs the control points `piece..=piece + g` of the derivative of order `degree - g`.
#[inline(always)]
pub(super) fn raise<const L: usize>(
    row: &mut Row<L>,
    to: usize,
    knots: &Knots,
    piece: usize,
    t_s: &[f64; L],
) {
    let first = knots.degree + piece + 1 - to;
    let below = knots.u[first..first + to].iter().zip(&knots.u[first + to..]);
    let mut saved = [0.0; L];
    for ((values, (left, right)), reciprocal) in row.iter_mut().zip(below).zip(knots.reciprocals(first, to)) {
        for l in 0..L {
            let share = values[l] * reciprocal;
            values[l] = saved[l] + (right - t_s[l]) * share;
            saved[l] = (t_s[l] - left) * share;
        }
    }
    row[to.min(WIDTH - 1)] = saved;
}

#[inline(always)]
pub(super) fn row<const DEGREE: usize, const L: usize>(
    knots: &Knots,
    piece: usize,
    t_s: &[f64; L],
) -> Row<L> {
    let mut row = constant();
    for to in 1..=DEGREE {
        raise(&mut row, to, knots, piece, t_s);
    }
    row
}

/// Sums of control points times basis functions.
#[inline(always)]
pub(super) fn weigh<const L: usize>(control: &[f64], row: &Row<L>) -> [f64; L] {
    let mut sum = [0.0; L];
    for (c, weights) in control.iter().zip(row) {
        for l in 0..L {
            sum[l] += c * weights[l];
        }
    }
    sum
}
