//! One step: what it lessens and within what, and the curve that it leads to.

use std::collections::BTreeMap;

use super::{
    aim::Aim,
    curve::{Curve, Frame},
    factor::Bordered,
    interior::{Edge, PRICE, Programme},
    model::{Model, Row},
    point::Point,
};
use crate::spline::{Place, Quantity, WINDOW};

/// A share of a limit below this does not bound a step.
const FAR: f64 = 0.3;
/// Shares above this curve with the intervals as an exponential does.
const CURVED: f64 = 0.5;
/// Price of changing the shape, times the longest change of a logarithm: steps shorten in angles as in times.
const SHAPE_PRICE: f64 = 1e-5;
/// Curvature that keeps unknowns without any in place.
const LEAST: f64 = 1e-9;
const LEAST_INTERVAL: f64 = 1e-6;

/// Multipliers of limits, by limit and piece.
pub(super) type Multipliers = BTreeMap<usize, f64>;

pub(super) struct Step<'a> {
    model: &'a Model,
    border: usize,
    trust: f64,
    hessian: Bordered,
    gradient: Vec<f64>,
    edges: Vec<Edge>,
}

/// A step and what its model promises.
pub(super) struct Taken {
    pub(super) x: Vec<f64>,
    /// Change of merit, and the price of limits that stay broken.
    pub(super) worth: f64,
    /// Longest change of a logarithm.
    pub(super) length: f64,
    pub(super) multipliers: Multipliers,
}

impl<'a> Step<'a> {
    pub(super) fn of(
        frame: &Frame,
        (here, aim, trust): (&Point, &Aim, f64),
        model: &'a Model,
        multipliers: &Multipliers,
    ) -> Self {
        let hessian = Bordered::new(&model.unknowns);
        let gradient = vec![0.0; hessian.unknowns()];
        let edges = edges(frame, here, aim, trust);
        let border = hessian.border_start();
        let mut step = Self { model, border, trust, hessian, gradient, edges };
        step.merit(here, aim);
        step.curve_limits(multipliers);
        step.hessian.lift(LEAST, LEAST_INTERVAL);
        step
    }

    /// Slopes of the merit, and its curvature by Gauss and Newton.
    fn merit(&mut self, here: &Point, aim: &Aim) {
        // The mean of squared jerk has the duration in it.
        let (slope, width) = (aim.duration - 0.5 * aim.jerk, self.model.unknowns.border);
        for (i, s) in here.curve.interval_s.iter().enumerate() {
            self.gradient[self.border + i] += slope * s / here.duration_s;
            self.hessian.corner[i * width + i] += aim.duration.max(aim.jerk) * s / here.duration_s;
        }
        for (joint, row) in &self.model.jerk {
            // A joint that hardly moves has no relative change to speak of.
            let rms = here.joint_jerk[*joint].max(1e-9 * here.jerk_rad_s3);
            let weight = 1.0 / (here.jerk_rad_s3 * rms * here.duration_s);
            self.hessian.add_square(row, aim.jerk * weight, 0.0);
            let still = Row { interval: [0.0; WINDOW], ..row.clone() };
            self.hessian.add_square(&still, SHAPE_PRICE / self.trust * weight, 0.0);
            self.hessian.add(row, aim.jerk * weight * row.value, &mut self.gradient);
        }
    }

    /// Rates are nearly exponential in the logarithms of the intervals: their curvature by the last multipliers.
    fn curve_limits(&mut self, multipliers: &Multipliers) {
        let mut largest: BTreeMap<usize, &Row> = BTreeMap::new();
        for (number, row) in &self.model.shares {
            let known = largest.entry(*number).or_insert(row);
            if row.value.abs() > known.value.abs() {
                *known = row;
            }
        }
        for (number, row) in largest.into_iter().filter(|(_, row)| row.value.abs() > CURVED) {
            if let Some(multiplier) = multipliers.get(&number) {
                let still = Row { control: [0.0; 8], others: Vec::new(), ..row.clone() };
                self.hessian.add_square(&still, multiplier / row.value.abs(), 0.0);
            }
        }
    }

    /// The step that lessens the model most.
    pub(super) fn solve(&self) -> Taken {
        let near = |(number, row): &'a (usize, Row)| {
            (row.value.abs() > FAR).then(|| (*number, (row, row.value.signum())))
        };
        let (numbers, limits): (Vec<usize>, Vec<(&Row, f64)>) =
            self.model.shares.iter().filter_map(near).unzip();
        let programme = Programme {
            hessian: &self.hessian,
            gradient: &self.gradient,
            limits: &limits,
            passes: &self.model.passes,
            edges: &self.edges,
        };
        let (x, found) = programme.solve();
        let curved: f64 = self.hessian.times(&x).iter().zip(&x).map(|(a, b)| a * b).sum();
        let sloped: f64 = self.gradient.iter().zip(&x).map(|(a, b)| a * b).sum();
        let left = x[x.len() - 1];
        let mut multipliers = Multipliers::new();
        for (number, multiplier) in numbers.into_iter().zip(found) {
            *multipliers.entry(number).or_default() += multiplier;
        }
        let length = x[self.border..x.len() - 1].iter().fold(0.0, |most: f64, d| most.max(d.abs()));
        Taken { worth: sloped + 0.5 * curved + PRICE * left, length, multipliers, x }
    }

    /// The curve a part of the way: free points from the moved control points, key points as they must be.
    pub(super) fn moved(&self, frame: &Frame, here: &Point, taken: &Taken, part: f64) -> Option<Curve> {
        let joints = frame.joints();
        let mut curve = here.curve.clone();
        for (s, change) in curve.interval_s.iter_mut().zip(&taken.x[self.border..]) {
            *s *= (part * change).exp();
        }
        let mut motion = here.motion.clone();
        motion.retime(&frame.times_s(&curve.interval_s)).ok()?;
        let segments = motion.segments().iter().zip(here.motion.segments()).enumerate();
        for (index, (segment, before)) in segments {
            let (spline, (first, last)) = (&segment.spline, segment.ends());
            let (fixed, count) = (spline.fixed_controls(), spline.degree().order() + 1);
            for point in (first + 1..last).filter(|point| frame.key.binary_search(point).is_err()) {
                let weights = spline.weights(Place::Point(point - first));
                for joint in 0..joints {
                    let free = self.model.unknowns.free[index];
                    let ends = spline.control(joint, Quantity::Position);
                    let old = before.spline.control(joint, Quantity::Position);
                    let control = |i: usize| match i.checked_sub(fixed) {
                        Some(own) if own < free => {
                            old[i] + part * taken.x[self.hessian.index(index, joint, own)]
                        }
                        _ => ends[i],
                    };
                    let terms = weights.value[0].iter().enumerate().take(count);
                    curve.point_rad[point * joints + joint] =
                        terms.map(|(k, weight)| weight * control(weights.first_control + k)).sum();
                }
            }
        }
        Some(curve)
    }
}

/// Bounds of the logarithms of the intervals.
fn edges(frame: &Frame, here: &Point, aim: &Aim, trust: f64) -> Vec<Edge> {
    let interval_s = &here.curve.interval_s;
    let [low, high] = frame.interval_s;
    let mut edges = Vec::new();
    for ends in frame.key.windows(2) {
        let whole: f64 = interval_s[ends[0]..ends[1]].iter().sum();
        let shares =
            |sign: f64| (ends[0]..ends[1]).map(|i| (i, sign * interval_s[i] / whole)).collect::<Vec<_>>();
        edges.push(Edge { entries: shares(1.0), most: (high / whole).ln().max(0.0) });
        edges.push(Edge { entries: shares(-1.0), most: (whole / low).ln().max(0.0) });
    }
    if aim.within_s.is_finite() {
        let moving_s: f64 = interval_s.iter().sum();
        let entries = interval_s.iter().enumerate().map(|(i, s)| (i, s / moving_s)).collect();
        edges.push(Edge { entries, most: 0.0 });
    }
    for i in 0..interval_s.len() {
        edges.extend([1.0, -1.0].map(|sign| Edge { entries: vec![(i, sign)], most: trust }));
    }
    edges
}
