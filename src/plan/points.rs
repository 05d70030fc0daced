//! How many points a trajectory needs, so that a controller keeps between them what the plan keeps.

use super::{Evaluator, Interpolation, Limit, Margin, Setup};
use crate::{
    math::State,
    spline::{Motion, Quantity, Samples},
};

/// Points a second of a trajectory, fewest first.
pub const POINTS_HZ: [f64; 5] = [25.0, 50.0, 100.0, 200.0, 400.0];

/// Share by which a curve through points may lie beyond a limit that the plan lies at.
pub const BETWEEN: f64 = 1e-3;

/// No log is written of a longer motion, s, nor a trajectory sent.
const LONGEST_S: f64 = 1e5;

/// A last step that is a smaller share of a whole one tells no jerk.
const SHORT: f64 = 0.25;

impl Setup {
    /// Points a second of a motion's trajectory: 25, or as many more, up to 400, as it takes that no curve of a controller through
    /// them breaks a limit of what is sent by more than [`BETWEEN`]. 25 where the motion breaks one itself: no points mend that.
    pub fn points_hz(&self, motion: &Motion) -> f64 {
        self.points_hz_after(motion, 0.0)
    }

    /// The same of a motion that begins so long after the first point, s: other instants of it are points then.
    pub fn points_hz_after(&self, motion: &Motion, begins_s: f64) -> f64 {
        let [least, .., most] = POINTS_HZ;
        let broken = |margin: &Margin| margin.share > 1.0 + BETWEEN && !margin.limit.is_load();
        let keeps = |hz: &f64| self.between_after(motion, begins_s, *hz).is_none();
        if !keeps(&least) && self.margins(motion, &mut Evaluator::new(self)).iter().any(broken) {
            return least;
        }
        POINTS_HZ.into_iter().find(keeps).unwrap_or(most)
    }

    /// The limit that the curve of a controller breaks most, by more than [`BETWEEN`], through points that a motion passes so
    /// often; `None` if none does.
    pub fn between(&self, motion: &Motion, points_hz: f64) -> Option<(Interpolation, Margin)> {
        self.between_after(motion, 0.0, points_hz)
    }

    fn between_after(
        &self,
        motion: &Motion,
        begins_s: f64,
        points_hz: f64,
    ) -> Option<(Interpolation, Margin)> {
        if motion.duration_s() > LONGEST_S {
            return None;
        }
        let step_s = 1.0 / points_hz;
        let first_s = -begins_s.rem_euclid(step_s);
        let points = states(motion, first_s, step_s);
        // The last step ends with the motion.
        let whole = points.first().map_or(0, Vec::len).saturating_sub(2);
        let before_s = first_s + whole as f64 * step_s;
        let rest_s = motion.duration_s() - before_s;
        let part = |of: std::ops::RangeFrom<usize>, most: usize| -> Vec<Vec<State>> {
            points.iter().map(|joint| joint[of.clone()].iter().copied().take(most).collect()).collect()
        };
        let mut found = self.through_points(&part(whole.., 2), rest_s);
        for (_, margin) in &mut found {
            margin.t_s += before_s;
        }
        // By the cube of so short a time rounding alone makes a jerk.
        found.retain(|(_, margin)| margin.limit != Limit::Jerk || rest_s > SHORT * step_s);
        if whole > 0 {
            found.extend(self.through_points(&part(0.., whole + 1), step_s));
        }
        found.retain(|(_, margin)| margin.share > 1.0 + BETWEEN);
        found.into_iter().max_by(|a, b| a.1.share.total_cmp(&b.1.share))
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

/// States of each joint every so often from an instant on, before the motion at rest, until all rest.
pub(super) fn states(motion: &Motion, first_s: f64, step_s: f64) -> Vec<Vec<State>> {
    let (mut samples, end_s) = (Samples::default(), motion.duration_s());
    let steps = (0_u32..).map(|k| first_s + f64::from(k) * step_s);
    let mut t_s: Vec<f64> = steps.take_while(|t_s| *t_s < end_s - 0.01 * step_s).collect();
    t_s.push(end_s);
    motion.sample(&t_s, Quantity::Acceleration, &mut samples);
    let of = |joint| {
        let of = |quantity, k: usize| if t_s[k] < 0.0 { 0.0 } else { samples.of(quantity, joint)[k] };
        let state = |k| State {
            position: samples.of(Quantity::Position, joint)[k],
            velocity: of(Quantity::Velocity, k),
            acceleration: of(Quantity::Acceleration, k),
        };
        (0..t_s.len()).map(state).collect()
    };
    (0..motion.joints()).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{arm::Arm, math::whole, plan::fastest, task::Task};

    #[test]
    fn points_are_as_close_as_a_motion_that_begins_between_two_of_them_needs() {
        let task = Task::parse(include_str!("../../sample-logs/tasks/task-1.toml")).unwrap();
        let setup = Setup::new(&task, Arm::sample().unwrap()).unwrap();
        let interval_s = fastest(&setup, 1600).unwrap().interval_s;
        let motion = setup.motion(&setup.times_s(&interval_s)).unwrap();
        // As a log has it: at rest for a while, then the motion, then at rest.
        let worst = |begins_s: f64, hz: f64| {
            let count = 2 + whole(((begins_s + motion.duration_s()) * hz).ceil());
            let state = |joint: usize, k: usize| {
                let t_s = (k as f64 / hz - begins_s).clamp(0.0, motion.duration_s());
                let sample = motion.at(t_s);
                let of = |quantity| sample.of(quantity, joint)[0];
                State {
                    position: of(Quantity::Position),
                    velocity: of(Quantity::Velocity),
                    acceleration: of(Quantity::Acceleration),
                }
            };
            let joint = |joint| (0..count).map(|k| state(joint, k)).collect();
            let points: Vec<Vec<State>> = (0..motion.joints()).map(joint).collect();
            let margins = setup.through_points(&points, 1.0 / hz).into_iter();
            margins.map(|(_, margin)| margin.share).fold(0.0, f64::max)
        };
        for k in 0_u32..16 {
            let begins_s = 1.0 + 0.0025 * f64::from(k);
            let share = worst(begins_s, setup.points_hz_after(&motion, begins_s));
            assert!(share <= 1.0 + BETWEEN, "{begins_s} s: {share}");
        }
    }
}
