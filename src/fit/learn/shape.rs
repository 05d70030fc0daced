//! A correction as a smooth curve that keeps the room around its plan: a quintic B-spline on a regular grid whose
//! control points are held.
//!
//! A derivative of a B-spline lies between its own control points, so a bound on them is a bound on the whole
//! curve. The correction nearest to a wanted one, with its jerk weighed so that it is a low-pass without delay, is
//! a quadratic programme; zero is always in its bounds.

use std::ops::Range;

use super::super::model::STEP_S;
use crate::math::{Columns, quadratic_programme};

/// Steps between knots.
const KNOT: usize = 10;

/// Distance of the knots, s.
const KNOT_S: f64 = KNOT as f64 * STEP_S;

/// Degree of the spline; its third derivative is continuous.
const DEGREE: usize = 5;

/// Share of what known limits leave that is used: a controller's curve goes a little beyond the command's samples.
pub const SHARE: f64 = 0.95;

/// What a joint may do beside its plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Room {
    /// Lowest and highest angle, rad, speed, rad/s, acceleration, rad/s², and jerk, rad/s³; infinite without a limit.
    pub limits: [[f64; 2]; 4],
    /// Angle, speed, acceleration and jerk of the plan, every [`STEP_S`].
    pub planned: Vec<[f64; 4]>,
    /// Lowest and highest speed by step, rad/s, as rods, pump and tool have it; empty where they leave any.
    pub speed_rad_s: Vec<[f64; 2]>,
    /// Share of the room that is used: [`SHARE`] of known limits, all of a guess.
    pub share: f64,
}

impl Room {
    /// For what was sent already: it had its share of known limits, of which another would clip it a little more each time, and of
    /// others nobody knows more than that it was sent.
    pub(super) fn of_sent(self) -> Option<Self> {
        (self.share < 1.0).then_some(Self { share: 1.0, ..self })
    }

    /// Least and largest correction of a derivative over some samples, zero included.
    fn bounds(&self, derivative: usize, samples: Range<usize>) -> [f64; 2] {
        let [low, high] = self.limits[derivative];
        let end = samples.end.min(self.planned.len());
        let inside = self.planned.get(samples.start.min(end)..end).unwrap_or_default();
        let (mut least, mut most) = (f64::NEG_INFINITY, f64::INFINITY);
        for (k, planned) in inside.iter().map(|planned| planned[derivative]).enumerate() {
            let own = self.speed_rad_s.get(samples.start + k).filter(|_| derivative == 1);
            let [low, high] = own.map_or([low, high], |[least, most]| [low.max(*least), high.min(*most)]);
            (least, most) = (least.max(low - planned), most.min(high - planned));
        }
        [least.min(0.0), most.max(0.0)]
    }
}

/// A correction on the steps: angle, rad, speed, rad/s, and acceleration, rad/s².
pub(super) type Curve = Vec<[f64; 3]>;

/// What a correction is to be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wanted<'a> {
    /// By step, rad.
    pub(super) correction_rad: &'a [f64],
    /// Frequency at which half of it is left, Hz.
    pub(super) cut_off_hz: f64,
    /// Largest, rad.
    pub(super) most_rad: f64,
}

/// The curve next to what is wanted, zero outside of `free` and, with its first four derivatives, at the ends of
/// each stretch of it.
pub(super) fn shaped(wanted: Wanted, free: &[Range<usize>], room: Option<&Room>) -> Curve {
    let mut curve = vec![[0.0; 3]; wanted.correction_rad.len()];
    for stretch in free {
        let end = stretch.end.min(curve.len());
        let knots = end.saturating_sub(stretch.start + 1) / KNOT;
        let Some(count) = knots.checked_sub(DEGREE).filter(|count| *count > 0) else { continue };
        let basis = Basis::new();
        let part = Part { from: stretch.start, count, basis: &basis };
        let Some(control_rad) = part.solve(wanted, room) else { continue };
        part.add(&control_rad, &mut curve);
    }
    curve
}

/// Values of one B-spline at the steps of its support, by derivative.
struct Basis {
    of: [Vec<f64>; 4],
}

impl Basis {
    fn new() -> Self {
        const SIGNED_CHOICES: [f64; 7] = [1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0];
        const FACTORIAL: [f64; 4] = [120.0, 24.0, 6.0, 2.0];
        let value = |derivative: usize, step: usize| {
            let u = step as f64 / KNOT as f64;
            let power = 5 - i32::try_from(derivative).unwrap_or_default();
            let terms =
                SIGNED_CHOICES.iter().enumerate().map(|(i, sign)| sign * (u - i as f64).max(0.0).powi(power));
            terms.sum::<f64>() / FACTORIAL[derivative] / KNOT_S.powi(5 - power)
        };
        Self { of: [0, 1, 2, 3].map(|k| (0..=(DEGREE + 1) * KNOT).map(|step| value(k, step)).collect()) }
    }

    /// Sum over steps of the products of two splines so many knots apart.
    fn overlap(&self, derivative: usize, apart: usize) -> f64 {
        let values = &self.of[derivative];
        values.iter().zip(values.iter().skip(apart * KNOT)).map(|(a, b)| a * b).sum()
    }
}

/// One stretch.
struct Part<'a> {
    from: usize,
    count: usize,
    basis: &'a Basis,
}

impl Part<'_> {
    /// Control points, rad; `None` if the solver finds none.
    fn solve(&self, wanted: Wanted, room: Option<&Room>) -> Option<Vec<f64>> {
        let n = self.count;
        let scale_rad = wanted.most_rad.max(1e-6);
        // The gain of the least squares with this weight of the jerk is 1 / (1 + (f / cut-off)^6).
        let weight = (2.0 * std::f64::consts::PI * wanted.cut_off_hz).powi(-6);
        let near: Vec<f64> = (0..=DEGREE)
            .map(|apart| (self.basis.overlap(0, apart) + weight * self.basis.overlap(3, apart)) / KNOT as f64)
            .collect();
        let mut p = Columns::default();
        for j in 0..n {
            p.column((j.saturating_sub(DEGREE)..=j).map(|i| (i, near[j - i])));
        }
        let q: Vec<f64> = (0..n)
            .map(|j| {
                let steps = wanted.correction_rad.iter().skip(self.from + j * KNOT);
                -steps.zip(&self.basis.of[0]).map(|(d, b)| d * b).sum::<f64>() / KNOT as f64 / scale_rad
            })
            .collect();
        let rows = self.rows(wanted, room, scale_rad);
        let mut columns: Vec<Vec<(usize, f64)>> = vec![Vec::new(); n];
        for (row, (entries, _)) in rows.iter().enumerate() {
            for &(column, value) in entries {
                columns[column].push((row, value));
            }
        }
        let mut a = Columns::default();
        for column in columns {
            a.column(column.into_iter());
        }
        let b: Vec<f64> = rows.iter().map(|(_, most)| *most).collect();
        let (x, _) = quadratic_programme(p, &q, a, &b)?;
        Some(x.iter().map(|x| x * scale_rad).collect())
    }

    /// Bounds on control points: entries by column, and the largest value of their sum, both by `scale_rad`.
    fn rows(&self, wanted: Wanted, room: Option<&Room>, scale_rad: f64) -> Vec<(Vec<(usize, f64)>, f64)> {
        const DIFFERENCES: [&[f64]; 4] = [&[1.0], &[1.0, -1.0], &[1.0, -2.0, 1.0], &[1.0, -3.0, 3.0, -1.0]];
        let mut rows = Vec::new();
        let most = wanted.most_rad / scale_rad;
        for j in 0..self.count {
            rows.push((vec![(j, 1.0)], most));
            rows.push((vec![(j, -1.0)], most));
        }
        let Some(room) = room else { return rows };
        for (derivative, weights) in DIFFERENCES.into_iter().enumerate() {
            let unit = scale_rad / KNOT_S.powi(i32::try_from(derivative).unwrap_or_default());
            for j in 0..self.count + derivative {
                let from = self.from + j * KNOT;
                let bounds = room.bounds(derivative, from..from + (DEGREE + 1 - derivative) * KNOT + 1);
                for (way, bound) in [(-1.0, -bounds[0]), (1.0, bounds[1])] {
                    if !bound.is_finite() {
                        continue;
                    }
                    let entries = weights.iter().enumerate().filter_map(|(back, weight)| {
                        let column = j.checked_sub(back).filter(|column| *column < self.count)?;
                        Some((column, way * weight))
                    });
                    rows.push((entries.collect(), room.share * bound / unit));
                }
            }
        }
        rows
    }

    fn add(&self, control_rad: &[f64], curve: &mut [[f64; 3]]) {
        for (j, control) in control_rad.iter().enumerate() {
            let steps = curve.iter_mut().skip(self.from + j * KNOT);
            for (step, state) in steps.take((DEGREE + 1) * KNOT).enumerate() {
                for (value, basis) in state.iter_mut().zip(&self.basis.of) {
                    *value += control * basis[step];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: usize = 1200;

    fn wanted(correction_rad: &[f64]) -> Wanted<'_> {
        Wanted { correction_rad, cut_off_hz: 1.2, most_rad: 0.1 }
    }

    #[test]
    fn slow_corrections_pass_and_ends_are_at_rest() {
        let slow: Vec<f64> =
            (0..N).map(|k| 0.02 * (std::f64::consts::PI * k as f64 / N as f64).sin().powi(4)).collect();
        let curve = shaped(wanted(&slow), std::slice::from_ref(&(50..1150)), None);
        for (k, (state, slow)) in curve.iter().zip(&slow).enumerate().take(1000).skip(200) {
            assert!((state[0] - slow).abs() < 1e-4, "{k}: {} {slow}", state[0]);
        }
        for k in (0..=50).chain(1150..N) {
            assert!(curve[k].iter().all(|x| x.abs() < 1e-15), "{k} {:?}", curve[k]);
        }
        // Speeds and accelerations are the derivatives of the angles.
        for k in 1..N - 1 {
            let speed = (curve[k + 1][0] - curve[k - 1][0]) / (2.0 * STEP_S);
            let rise = (curve[k + 1][1] - curve[k - 1][1]) / (2.0 * STEP_S);
            assert!((speed - curve[k][1]).abs() < 1e-5 && (rise - curve[k][2]).abs() < 1e-3, "{k}");
        }
    }

    #[test]
    fn a_step_is_softened_until_every_limit_is_kept_and_no_more() {
        let step: Vec<f64> = (0..N).map(|k| if (400..800).contains(&k) { 0.05 } else { 0.0 }).collect();
        let planned = (0..N).map(|k| [0.0, 0.05 * (k as f64 * 0.01).sin(), 0.1, 0.0]).collect();
        let room = Room {
            limits: [[-0.02, 0.03], [-0.1, 0.1], [-0.2, 0.2], [-0.4, 0.4]],
            planned,
            speed_rad_s: Vec::new(),
            share: 1.0,
        };
        let curve = shaped(wanted(&step), std::slice::from_ref(&(0..N)), Some(&room));
        let (mut nearest, mut before) = ([0.0_f64; 4], 0.0);
        for (state, planned) in curve.iter().zip(&room.planned) {
            let jerk = (state[2] - before) / STEP_S;
            before = state[2];
            let all = [state[0], state[1], state[2], jerk];
            assert!(state[0] > -0.02 - 1e-9 && state[0] < 0.03 + 1e-9);
            for k in 1..4 {
                let share = (planned[k] + all[k]).abs() / room.limits[k][1];
                assert!(share < 1.0 + 1e-6, "{k}: {share}");
                nearest[k] = nearest[k].max(share);
            }
            nearest[0] = nearest[0].max(state[0] / 0.03);
        }
        assert!(nearest.iter().any(|share| *share > 0.95), "{nearest:?}");
    }

    #[test]
    fn a_plan_at_its_limit_or_beyond_leaves_no_room_but_zero() {
        let step = vec![0.05; N];
        let planned = vec![[0.0, 0.1, 0.2, 0.4]; N];
        let room = Room {
            limits: [[-1.0, 1.0], [-0.1, 0.1], [-0.1, 0.1], [-0.1, 0.1]],
            planned,
            speed_rad_s: Vec::new(),
            share: 1.0,
        };
        let curve = shaped(wanted(&step), std::slice::from_ref(&(0..N)), Some(&room));
        assert!(curve.iter().all(|state| state[0].abs() < 1e-6));
        assert!(shaped(wanted(&step), &[0..40, 100..101], None).iter().all(|state| state[0] == 0.0));
    }
}
