//! The points of a command as it is sent: how near what a controller makes of them comes to the limits.

use crate::{
    fit::STEP_S,
    math::{State, quintic, whole},
    plan::{Interpolation, Margin, Setup},
};

/// How something is interpolated, and how many steps a point lies after the one before.
pub(super) type Checked = (Interpolation, usize);

/// All margins, by interpolation: of the samples, and of the trajectory in the log; of that alone where its points are closer.
pub(super) fn checked(setup: &Setup, sent: &[Vec<State>], points_hz: f64) -> Vec<(Checked, Margin)> {
    let through = |stride: usize| {
        let every = |states: &Vec<State>| states.iter().copied().step_by(stride).collect();
        let points: Vec<Vec<State>> = sent.iter().map(every).collect();
        let found = setup.through_points(&points, stride as f64 * STEP_S).into_iter();
        found.map(move |(how, margin)| ((how, stride), margin))
    };
    let parts = whole((points_hz * STEP_S).round());
    if parts > 1 {
        let points: Vec<Vec<State>> = sent.iter().map(|states| closer(states, parts)).collect();
        let found = setup.through_points(&points, STEP_S / parts as f64).into_iter();
        return found.map(|(how, margin)| ((how, 1), margin)).collect();
    }
    let mut strides = vec![1, stride(points_hz)];
    strides.dedup();
    strides.into_iter().flat_map(through).collect()
}

/// So many states for each, as the log writes them between samples.
fn closer(states: &[State], parts: usize) -> Vec<State> {
    let step_s = STEP_S / parts as f64;
    let within = |pair: &[State]| -> Vec<State> {
        (0..parts).map(|k| quintic(pair[0], pair[1], STEP_S, k as f64 * step_s)).collect()
    };
    states.windows(2).flat_map(within).chain(states.last().copied()).collect()
}

/// Samples from one point of a trajectory to the next.
fn stride(points_hz: f64) -> usize {
    whole((1.0 / (points_hz * STEP_S)).round()).max(1)
}

/// Of each limit the margin that is used most.
pub(super) fn nearest(all: Vec<(Checked, Margin)>) -> Vec<Margin> {
    let mut tops: Vec<Margin> = Vec::new();
    for (_, margin) in all {
        match tops.iter_mut().find(|top| (top.limit, top.joint) == (margin.limit, margin.joint)) {
            Some(top) if top.share >= margin.share => {}
            Some(top) => *top = margin,
            None => tops.push(margin),
        }
    }
    tops
}
