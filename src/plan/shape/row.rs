//! A value of a curve, linearised in control points and logarithms of intervals.

use crate::spline::WINDOW;

/// A value at a place and its slopes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Row {
    pub(super) segment: usize,
    /// The first of the segment's free control points that has weight.
    pub(super) first: usize,
    pub(super) joint: usize,
    /// By the joint's free control points from the first on.
    pub(super) control: [f64; 8],
    /// The same of other joints, where several make the value.
    pub(super) others: Vec<(usize, [f64; 8])>,
    /// The first interval with a slope.
    pub(super) first_interval: usize,
    /// By the logarithm of the interval.
    pub(super) interval: [f64; WINDOW],
    pub(super) value: f64,
}

impl Row {
    /// Joints and the slopes by their control points.
    pub(super) fn parts(&self) -> impl Iterator<Item = (usize, &[f64; 8])> {
        std::iter::once((self.joint, &self.control)).chain(self.others.iter().map(|(joint, c)| (*joint, c)))
    }

    pub(super) fn scaled(mut self, by: f64) -> Self {
        self.value *= by;
        let others = self.others.iter_mut().flat_map(|(_, control)| control);
        self.control.iter_mut().chain(&mut self.interval).chain(others).for_each(|slope| *slope *= by);
        self
    }

    /// A value that several joints make, from rows of their state, `[joint][order]`, and its slopes by them.
    pub(super) fn joined(state: &[Self], orders: usize, slope: impl Fn(usize) -> f64, value: f64) -> Self {
        let mut row = Self { others: Vec::new(), control: [0.0; 8], value, ..state[0].clone() };
        row.interval.fill(0.0);
        for (joint, own) in state.chunks_exact(orders).enumerate() {
            let mut control = [0.0; 8];
            for (order, own) in own.iter().enumerate() {
                let slope = slope(joint * orders + order);
                control.iter_mut().zip(own.control).for_each(|(to, by)| *to += slope * by);
                row.interval.iter_mut().zip(own.interval).for_each(|(to, by)| *to += slope * by);
            }
            if joint == 0 {
                row.control = control;
            } else {
                row.others.push((joint, control));
            }
        }
        row
    }
}
