//! One step: what it lessens and within what, and the curve that it leads to.

use std::collections::BTreeMap;

use super::{
    aim::{Aim, Pace},
    curve::{Curve, Frame},
    factor::Bordered,
    interior::{Ceiling, Edge, PRICE, Programme, Solved},
    loads::LOADS,
    model::Model,
    point::Point,
    row::Row,
};
use crate::{
    spline::{Place, Quantity, WINDOW},
    task::{Objective, Weights},
};

/// A share of a limit below this does not bound a step.
const FAR: f64 = 0.3;
/// Shares above this curve with the intervals as an exponential does.
const CURVED: f64 = 0.5;
/// The shortest piece: across a shorter one a derivative would step, and a controller that goes through points 0.01 s
/// apart would leave the curve. As a share of an even one and in seconds, the longer, but at most the last share.
const SHORTEST: f64 = 0.1;
const SHORTEST_S: f64 = 0.1;
const EVEN: f64 = 0.6;
/// Price of changing the shape, times the longest change of a logarithm: steps shorten in angles as in times.
const SHAPE_PRICE: f64 = 1e-3;
/// Price of changing the angles at a key point, 1/rad², times the longest change of a logarithm: the tool stays where
/// it is to the first order alone.
const POSTURE_PRICE: f64 = 0.05;
/// Curvature that keeps unknowns without any in place.
const LEAST: f64 = 1e-9;
const LEAST_INTERVAL: f64 = 1e-6;

/// Multipliers of a step.
#[derive(Debug, Clone)]
pub(super) struct Multipliers {
    /// By limit and piece.
    limits: BTreeMap<usize, f64>,
    /// Of ceilings.
    ceilings: Weights,
}

impl Default for Multipliers {
    fn default() -> Self {
        Self { limits: BTreeMap::new(), ceilings: Weights::ZERO }
    }
}

pub(super) struct Step<'a> {
    model: &'a Model,
    border: usize,
    trust: f64,
    hessian: Bordered,
    gradient: Vec<f64>,
    edges: Vec<Edge>,
    ceilings: Vec<(Objective, Ceiling)>,
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
        frame: &Frame<'_>,
        (here, aim, trust): (&Point, &Aim, f64),
        model: &'a Model,
        multipliers: &Multipliers,
    ) -> Self {
        let hessian = Bordered::new(&model.unknowns);
        let gradient = vec![0.0; hessian.unknowns()];
        let edges = edges(frame, here, aim, trust);
        let border = hessian.border_start();
        let mut step = Self { model, border, trust, hessian, gradient, edges, ceilings: Vec::new() };
        step.merit(here, aim, &multipliers.ceilings);
        step.curve_limits(&multipliers.limits);
        for row in &model.postures {
            let still = Row { interval: [0.0; WINDOW], ..row.clone() };
            step.hessian.add_square(&still, POSTURE_PRICE / trust, 0.0);
        }
        step.hessian.lift(LEAST, LEAST_INTERVAL);
        step
    }

    /// Slopes of merit and ceilings, and the curvature of both by Gauss and Newton.
    fn merit(&mut self, here: &Point, aim: &Aim, multipliers: &Weights) {
        let slopes = aim.slopes(&here.objectives);
        for &objective in Objective::OF_PLAN.iter().filter(|k| slopes[**k] > 0.0) {
            let own = self.slope(here, objective);
            self.gradient.iter_mut().zip(own).for_each(|(to, by)| *to += slopes[objective] * by);
        }
        self.ceilings = aim
            .beyond(&here.objectives)
            .map(|(objective, value)| (objective, Ceiling { slope: self.slope(here, objective), value }))
            .collect();
        let most = slopes.plan().iter().fold(0.0, |most: f64, slope| most.max(*slope));
        let width = self.model.unknowns.border;
        for (i, s) in here.curve.interval_s.iter().enumerate() {
            self.hessian.corner[i * width + i] += most * s / here.duration_s();
        }
        for (objective, rows) in
            [(Objective::RmsJerk, &self.model.jerk), (Objective::RmsPower, &self.model.power)]
        {
            let price = slopes[objective] + multipliers[objective];
            for (joint, row) in rows {
                let weight = weight(here, objective, *joint);
                self.hessian.add_square(row, price * weight, 0.0);
                if objective == Objective::RmsJerk {
                    let still = Row { interval: [0.0; WINDOW], ..row.clone() };
                    self.hessian.add_square(&still, SHAPE_PRICE / self.trust * weight, 0.0);
                }
            }
        }
    }

    /// Slope of an objective's logarithm by all unknowns.
    fn slope(&self, here: &Point, objective: Objective) -> Vec<f64> {
        let mut slope = vec![0.0; self.gradient.len()];
        // A mean has the duration in it.
        let (rows, by): (&[_], _) = match objective {
            Objective::RmsJerk => (&self.model.jerk, -0.5),
            Objective::RmsPower => (&self.model.power, -0.5),
            _ => (&[], 1.0),
        };
        for (i, s) in here.curve.interval_s.iter().enumerate() {
            slope[self.border + i] += by * s / here.duration_s();
        }
        for (joint, row) in rows {
            self.hessian.add(row, weight(here, objective, *joint) * row.value, &mut slope);
        }
        slope
    }

    /// Rates are nearly exponential in the logarithms of the intervals: their curvature by the last multipliers.
    fn curve_limits(&mut self, multipliers: &BTreeMap<usize, f64>) {
        let mut largest: BTreeMap<usize, &Row> = BTreeMap::new();
        for (number, row) in self.model.shares.iter().filter(|(number, _)| *number < LOADS) {
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
        self.solved(&self.model.shares)
    }

    /// The step that lessens the model most, with limits as they are where another step ends (Fletcher 1982,
    /// doi:10.1007/BFb0120951). `there` has the model of that end, with rows at the same places.
    pub(super) fn corrected(&self, taken: &Taken, there: &Model) -> Taken {
        let mut shares = self.model.shares.clone();
        for ((number, row), (_, end)) in shares.iter_mut().zip(&there.shares) {
            // Loads have rows where they are near their limits, which differ from place to place.
            if *number >= LOADS {
                break;
            }
            let moved: f64 = self.hessian.entries(row).map(|(i, a)| a * taken.x[i]).sum();
            row.value = end.value - moved;
        }
        self.solved(&shares)
    }

    fn solved(&self, shares: &[(usize, Row)]) -> Taken {
        let near = |(at, (number, _)): (usize, &(usize, Row))| {
            let was = self.model.shares[at].1.value;
            (was.abs() > FAR).then_some((*number, at, was.signum()))
        };
        let near: Vec<(usize, usize, f64)> = shares.iter().enumerate().filter_map(near).collect();
        let numbers = near.iter().map(|(number, ..)| *number);
        let limits: Vec<(&Row, f64)> = near.iter().map(|(_, at, sign)| (&shares[*at].1, *sign)).collect();
        let programme = Programme {
            hessian: &self.hessian,
            gradient: &self.gradient,
            limits: &limits,
            passes: &self.model.passes,
            edges: &self.edges,
            ceilings: self.ceilings.iter().map(|(_, ceiling)| ceiling).collect(),
        };
        let Solved { x, limits: found, ceilings } = programme.solve();
        let curved: f64 = self.hessian.times(&x).iter().zip(&x).map(|(a, b)| a * b).sum();
        let sloped: f64 = self.gradient.iter().zip(&x).map(|(a, b)| a * b).sum();
        let left = x[x.len() - 1];
        let mut multipliers = Multipliers::default();
        for (number, multiplier) in numbers.zip(found) {
            *multipliers.limits.entry(number).or_default() += multiplier;
        }
        for ((objective, _), multiplier) in self.ceilings.iter().zip(ceilings) {
            multipliers.ceilings[*objective] = multiplier;
        }
        let length = x[self.border..x.len() - 1].iter().fold(0.0, |most: f64, d| most.max(d.abs()));
        Taken { worth: sloped + 0.5 * curved + PRICE * left, length, multipliers, x }
    }

    /// The curve a part of the way: free points from the moved control points, key points as they must be.
    pub(super) fn moved(&self, frame: &Frame<'_>, here: &Point, taken: &Taken, part: f64) -> Option<Curve> {
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
            for point in (first + 1..last).filter(|point| !frame.is_given(*point)) {
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
                if let Some(pose) = frame.pose(point) {
                    let angles = &mut curve.point_rad[point * joints..][..joints];
                    angles.copy_from_slice(&frame.setup.arm.chain.onto(pose, angles)?);
                }
            }
        }
        Some(curve)
    }
}

/// Weight of the squares of a joint in the logarithm of a mean that sums over joints.
fn weight(here: &Point, objective: Objective, joint: usize) -> f64 {
    let rms = if objective == Objective::RmsJerk { &here.joint_jerk } else { &here.joint_power };
    let sum = here.objectives[objective];
    // A joint that hardly moves has no relative change to speak of.
    1.0 / (sum * rms[joint].max(1e-9 * sum) * here.duration_s())
}

/// Bounds of the logarithms of the intervals.
fn edges(frame: &Frame<'_>, here: &Point, aim: &Aim, trust: f64) -> Vec<Edge> {
    let interval_s = &here.curve.interval_s;
    let [low, high] = frame.setup.interval_s;
    let mut edges = Vec::new();
    for ends in frame.key.windows(2) {
        let whole: f64 = interval_s[ends[0]..ends[1]].iter().sum();
        let shares =
            |sign: f64| (ends[0]..ends[1]).map(|i| (i, sign * interval_s[i] / whole)).collect::<Vec<_>>();
        edges.push(Edge { entries: shares(1.0), most: (high / whole).ln().max(0.0) });
        edges.push(Edge { entries: shares(-1.0), most: (whole / low).ln().max(0.0) });
    }
    if matches!(aim.pace, Pace::Within(_)) {
        let moving_s: f64 = interval_s.iter().sum();
        let entries = interval_s.iter().enumerate().map(|(i, s)| (i, s / moving_s)).collect();
        edges.push(Edge { entries, most: 0.0 });
    }
    for i in 0..interval_s.len() {
        let key = frame.key.partition_point(|key| *key <= i);
        let own = frame.key[key - 1]..frame.key[key];
        let whole: f64 = interval_s[own.clone()].iter().sum();
        let even_s = whole / own.len() as f64;
        let shortest_s = (EVEN * even_s).min(SHORTEST_S.max(SHORTEST * even_s));
        let shorter = (interval_s[i] / shortest_s).ln().clamp(0.0, trust);
        edges.push(Edge { entries: vec![(i, 1.0)], most: trust });
        edges.push(Edge { entries: vec![(i, -1.0)], most: shorter });
    }
    edges
}
