//! Whether speed is fed forward: a prior of what most controllers do makes one of loops that feed none.

use super::{
    estimate::{Estimate, Problem, Workspace},
    model::Model,
    parameters::{DEAD_TIME, LIMITS, POSITION_GAIN},
    set_values::RINGS,
};

/// Dead time, s, and position gain, 1/s, where descents start beside the estimate with a feed-forward.
const STARTS: [[f64; 2]; 3] = [[0.05, 1.2], [0.1, 2.4], [0.1, 4.0]];

/// A model that leaves less than this many times as much, as scales of the residuals, explains the data as well but for details.
const NEARLY: f64 = 1.3;

/// What leaving out a feed-forward, and late set values, makes of an estimate.
pub(super) enum FeedForward {
    /// The data do not show them: the estimate without costs less.
    None(Estimate),
    /// A loop without explains nearly as much.
    MayBeNone(Box<Model>),
    /// They do.
    Some,
}

impl FeedForward {
    pub(super) fn of(problem: &Problem, found: &Estimate, workspace: &mut Workspace) -> Self {
        let mut other = problem.clone();
        other.shown.feed_forward = false;
        other.shown.late = false;
        let before = problem.cost_at(&found.x, found.scale_rad, workspace);
        let place = |i: usize, value: f64| problem.priors.of(i).place(value);
        let anew = STARTS.map(|[dead_time_s, gain_1_s]| {
            let mut x = found.x.clone();
            x[..LIMITS].fill(0.0);
            x[DEAD_TIME] = place(DEAD_TIME, dead_time_s);
            x[POSITION_GAIN] = place(POSITION_GAIN, gain_1_s);
            x
        });
        let without = other.search(std::iter::once(found.x.clone()).chain(anew), workspace);
        let model = other.model(&without.x);
        if model.position_gain_1_s * model.lag_s() > RINGS {
            // A loop that would ring explains any oscillation.
            Self::Some
        } else if other.cost_at(&without.x, found.scale_rad, workspace) < before {
            Self::None(without)
        } else if without.scale_rad < NEARLY * found.scale_rad {
            Self::MayBeNone(Box::new(model))
        } else {
            Self::Some
        }
    }
}
