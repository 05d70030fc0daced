//! How many points a trajectory needs, so that a controller keeps between them what the plan keeps.

use super::{Evaluator, Interpolation, Margin, Setup};
use crate::{
    math::State,
    spline::{Motion, Quantity, Samples},
};

/// Points a second of a trajectory, fewest first.
pub const POINTS_HZ: [f64; 5] = [25.0, 50.0, 100.0, 200.0, 400.0];

/// Share by which a curve through points may lie beyond a limit that the plan lies at.
pub const BETWEEN: f64 = 1e-3;

impl Setup {
    /// Points a second of a motion's trajectory: 25, or as many more, up to 400, as it takes that no curve of a controller through
    /// them breaks a limit of what is sent by more than [`BETWEEN`]. 25 where the motion breaks one itself: no points mend that.
    pub fn points_hz(&self, motion: &Motion) -> f64 {
        let keeps = |hz: &f64| {
            let found = self.through_points(&states(motion, 1.0 / hz), 1.0 / hz);
            found.iter().all(|(_, margin)| margin.share <= 1.0 + BETWEEN)
        };
        let [least, more @ ..] = &POINTS_HZ;
        let broken = |margin: &Margin| margin.share > 1.0 + BETWEEN && !margin.limit.is_load();
        if keeps(least) || self.margins(motion, &mut Evaluator::new(self)).iter().any(broken) {
            return *least;
        }
        more.iter().copied().find(keeps).unwrap_or(*least)
    }

    /// Margins of curves through points, by all that a controller may make of them.
    ///
    /// `points`: states every `step_s`, by joint of the arm.
    pub fn through_points(&self, points: &[Vec<State>], step_s: f64) -> Vec<(Interpolation, Margin)> {
        let of = |how| {
            let found = self.command_margins(points, step_s, how).into_iter();
            found.map(move |margin| (how, margin))
        };
        Interpolation::ALL.into_iter().flat_map(of).collect()
    }
}

/// States of each joint every so often, until all rest.
pub(super) fn states(motion: &Motion, step_s: f64) -> Vec<Vec<State>> {
    let (mut samples, end_s) = (Samples::default(), motion.duration_s());
    let steps = (0_u32..).map(|k| f64::from(k) * step_s);
    let mut t_s: Vec<f64> = steps.take_while(|t_s| *t_s < end_s - 0.01 * step_s).collect();
    t_s.push(end_s);
    motion.sample(&t_s, Quantity::Acceleration, &mut samples);
    let of = |joint| {
        let state = |k| State {
            position: samples.of(Quantity::Position, joint)[k],
            velocity: samples.of(Quantity::Velocity, joint)[k],
            acceleration: samples.of(Quantity::Acceleration, joint)[k],
        };
        (0..t_s.len()).map(state).collect()
    };
    (0..motion.joints()).map(of).collect()
}
