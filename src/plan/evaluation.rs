//! One plan, evaluated: its objectives and how near it comes to every limit.

use super::{Evaluator, Margin, PlanError, Setup, Via, excess, via::Through};
use crate::{
    series::JointKind,
    task::{Objective, Objectives},
};

/// A plan with its objectives, its costs by joint and its margins.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanEvaluation {
    /// Arrival at each key point, s, dwells counted.
    pub times_s: Vec<f64>,
    /// Time of movement from each key point to the next, s.
    pub interval_s: Vec<f64>,
    /// Free points that it passes between the key points; none of a timing alone.
    pub via: Vec<Via>,
    /// What it costs.
    pub objectives: Objectives,
    /// Sum of what it exceeds its limits by, as shares of them; 0 if all hold.
    pub violation: f64,
    /// How the joints move.
    pub joint_kinds: Vec<JointKind>,
    /// Root mean square jerk by joint, rad/s³; m/s³ of one that slides.
    pub rms_jerk_rad_s3: Vec<f64>,
    /// Root mean square power by joint, W.
    pub rms_power_w: Vec<f64>,
    /// Work that the joints do and take up, J.
    pub energy_j: f64,
    /// Every limit, with where the plan comes nearest to it.
    pub margins: Vec<Margin>,
}

impl PlanEvaluation {
    /// The same curve with so many times the time of each interval, dwells as they are; `None` where the task does not have it.
    pub(crate) fn paced(&self, setup: &Setup, by: f64) -> Option<Self> {
        const ROUNDED: f64 = 1e-9;
        let interval_s = setup.intervals_s(&self.times_s).ok()?;
        let [least_s, most_s] = setup.interval_s;
        let allowed = |s: &f64| (least_s * (1.0 - ROUNDED)..=most_s * (1.0 + ROUNDED)).contains(s);
        let paced_s: Vec<f64> = interval_s.iter().map(|s| by * s).collect();
        if !paced_s.iter().all(allowed) {
            return None;
        }
        let times_s = setup.times_s(&paced_s);
        // Before it arrives each interval takes its part of the new time.
        let at = |t_s: f64| {
            let next = self.times_s.partition_point(|arrival_s| *arrival_s < t_s).clamp(1, interval_s.len());
            times_s[next] - by * (self.times_s[next] - t_s)
        };
        let via: Vec<Via> = self.via.iter().map(|via| Via { t_s: at(via.t_s), ..via.clone() }).collect();
        Self::through(setup, &times_s, &via).ok()
    }

    /// Time of movement, s: without dwells.
    pub(crate) fn moving_s(&self, setup: &Setup) -> f64 {
        self.objectives[Objective::Duration] - setup.resting_s()
    }

    /// Judges arrivals at the key points, s.
    ///
    /// # Errors
    ///
    /// [`PlanError`] if they are no times for this task.
    pub fn of(setup: &Setup, times_s: &[f64]) -> Result<Self, PlanError> {
        Self::through(setup, times_s, &[])
    }

    /// Judges arrivals at the key points, s, and free points between them.
    ///
    /// # Errors
    ///
    /// [`PlanError`] if they are no plan for this task.
    pub fn through(setup: &Setup, times_s: &[f64], via: &[Via]) -> Result<Self, PlanError> {
        let interval_s = setup.intervals_s(times_s)?;
        let Through { setup, interval_s: own_s } = setup.through(times_s, via)?;
        let (setup, motion) = (&setup, &setup.template);
        let mut evaluator = Evaluator::new(setup);
        // The motion is of the same times, so there is one.
        let objectives = evaluator.evaluate(setup, &own_s).unwrap_or(Objectives::NONE);
        let rms_jerk_rad_s3 = evaluator.rms_jerk_rad_s3().to_vec();
        let (rms_power_w, energy_j) = (evaluator.rms_power_w(), evaluator.energy_j(setup));
        let margins = setup.margins(motion, &mut evaluator);
        let broken = margins.iter().filter(|margin| margin.broken());
        // A sum of nothing would be minus zero.
        let violation = broken.fold(0.0, |sum, margin| sum + excess(margin.share));
        let times_s = times_s.to_vec();
        Ok(Self {
            times_s,
            interval_s,
            via: via.to_vec(),
            objectives,
            violation,
            joint_kinds: setup.joint_kinds().collect(),
            rms_jerk_rad_s3,
            rms_power_w,
            energy_j,
            margins,
        })
    }

    /// How many times as slow all broken limits are kept; `None` if none is broken, or one that time does not mend.
    pub fn slower(&self) -> Option<f64> {
        let all: Option<Vec<f64>> = self.broken().into_iter().map(Margin::slower).collect();
        all?.into_iter().reduce(f64::max)
    }

    /// Limits that are broken, the worst first.
    pub fn broken(&self) -> Vec<&Margin> {
        let mut broken: Vec<&Margin> = self.margins.iter().filter(|margin| margin.broken()).collect();
        broken.sort_by(|a, b| b.share.total_cmp(&a.share));
        broken
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{arm::Arm, task::Task};

    #[test]
    fn a_plan_at_another_pace_keeps_its_dwells_and_the_bounds_of_its_intervals() {
        let task = Task::parse(include_str!("../../sample-logs/tasks/task-1.toml")).unwrap();
        let setup = Setup::new(&task, Arm::sample().unwrap()).unwrap();
        let [least_s, most_s] = task.interval_s;
        let plan = PlanEvaluation::of(&setup, &setup.times_s(&[6.0; 5])).unwrap();
        let slower = plan.paced(&setup, 1.5).unwrap();
        let intervals_s = setup.intervals_s(&slower.times_s).unwrap();
        assert!(intervals_s.iter().all(|s| (s - 9.0).abs() < 1e-9), "{intervals_s:?}");
        assert!((slower.moving_s(&setup) - 1.5 * plan.moving_s(&setup)).abs() < 1e-9);
        assert_eq!(plan.paced(&setup, 1.01 * most_s / 6.0), None);
        assert_eq!(plan.paced(&setup, 0.99 * least_s / 6.0), None);
    }
}
