//! One plan, evaluated: its objectives and how near it comes to every limit.

use super::{Evaluator, Margin, PlanError, Setup, Via, excess, via::Through};
use crate::{series::JointKind, task::Objectives};

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
    /// The same curve in so many times the time; `None` where the task does not have it.
    pub(crate) fn paced(&self, setup: &Setup, by: f64) -> Option<Self> {
        let first_s = self.times_s.first().copied()?;
        let at = |t_s: f64| first_s + by * (t_s - first_s);
        let times_s: Vec<f64> = self.times_s.iter().map(|t_s| at(*t_s)).collect();
        let via: Vec<Via> = self.via.iter().map(|via| Via { t_s: at(via.t_s), ..via.clone() }).collect();
        Self::through(setup, &times_s, &via).ok()
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

    /// Limits that are broken, the worst first.
    pub fn broken(&self) -> Vec<&Margin> {
        let mut broken: Vec<&Margin> = self.margins.iter().filter(|margin| margin.broken()).collect();
        broken.sort_by(|a, b| b.share.total_cmp(&a.share));
        broken
    }
}
