//! One evaluation: the objectives of a plan and how near it comes to every limit.

use super::{KEPT_SHARE, Setup, limit::Limit, mesh::Mesh};
use crate::{
    spline::Motion,
    task::{Objective, Objectives},
};

/// Parts, so many times as many as for power itself, on which its magnitude is integrated.
const FINELY: usize = 24;

/// A timing with its objectives.
#[derive(Debug, Clone, PartialEq)]
pub struct Timing {
    /// Time of movement from each key point to the next, s.
    pub interval_s: Vec<f64>,
    /// What it costs.
    pub objectives: Objectives,
    /// Sum of the excess over its limits, as [`Evaluator::violation`]; 0 if all hold.
    pub violation: f64,
}

/// Evaluates plans of one setup, one after the other; allocates nothing after the first.
#[derive(Debug, Clone)]
pub struct Evaluator {
    pub(super) motion: Motion,
    pub(super) mesh: Mesh,
    t_s: Vec<f64>,
    rms_jerk: Vec<f64>,
    /// Share of each limit, by row.
    pub(super) shares: Vec<f64>,
    /// The same on each piece and of each sign, `[row][piece][sign]`, after [`Evaluator::evaluate_peaks`]: smooth in
    /// the times where the largest of all has a kink.
    pub(super) peaks: Vec<f64>,
    /// Least and largest value at the nodes, by quantity and joint, then by row of the mesh.
    pub(super) extents: Vec<[f64; 2]>,
}

impl Evaluator {
    /// Memory for a setup.
    pub fn new(setup: &Setup) -> Self {
        Self {
            motion: setup.template.clone(),
            mesh: Mesh::new(setup),
            t_s: Vec::new(),
            rms_jerk: vec![0.0; setup.joint_count()],
            shares: vec![0.0; Limit::rows(setup.joint_count())],
            peaks: Vec::new(),
            extents: Vec::new(),
        }
    }

    /// Objectives of the plan with these times of movement between key points, s, under the setup
    /// that this evaluator was made for; `None` if they make no motion.
    ///
    /// f2 is exact; f3 is by eight Gauss nodes a piece, or a part of it where a joint turns far, to 1e-6. Power is joint
    /// speed times torque (paper, eq. 5). `DIFFERENCE(eq. 4, 5)`: means over time in place of sums over sampling
    /// points, which grow with their number.
    pub fn evaluate(&mut self, setup: &Setup, interval_s: &[f64]) -> Option<Objectives> {
        let found = self.objectives(setup, interval_s)?;
        self.limit_shares(setup);
        Some(found)
    }

    /// As [`Evaluator::evaluate`], with the peaks of each piece, which take half as long again.
    pub(super) fn evaluate_peaks(&mut self, setup: &Setup, interval_s: &[f64]) -> Option<Objectives> {
        let found = self.objectives(setup, interval_s)?;
        self.limit_peaks(setup);
        Some(found)
    }

    fn objectives(&mut self, setup: &Setup, interval_s: &[f64]) -> Option<Objectives> {
        self.t_s.clear();
        self.t_s.push(0.0);
        let mut now_s = 0.0;
        for (interval_s, dwell_s) in interval_s.iter().zip(&setup.dwell_before_s) {
            now_s += dwell_s + interval_s;
            self.t_s.push(now_s);
        }
        self.motion.retime(&self.t_s).ok()?;
        self.motion.rms_jerk(&mut self.rms_jerk);
        self.mesh.integrate(setup, &self.motion);
        Some(Objectives::NONE.map_plan(|objective| self.objective(objective)))
    }

    /// One objective of the plan evaluated last; not known of those that need a machine.
    fn objective(&self, objective: Objective) -> f64 {
        match objective {
            Objective::Duration => self.motion.duration_s(),
            Objective::RmsJerk => self.rms_jerk.iter().sum(),
            Objective::RmsPower => self.joint_power_w().sum(),
            Objective::StartError => f64::INFINITY,
        }
    }

    fn joint_power_w(&self) -> impl Iterator<Item = f64> {
        let duration_s = self.motion.duration_s();
        self.mesh.squared_power.iter().map(move |sum| (sum / duration_s).sqrt())
    }

    /// Sum over limits of the excess of the plan evaluated last, each as a share of its limit, 10 at most.
    pub fn violation(&self) -> f64 {
        self.shares.iter().map(|share| excess(*share)).sum()
    }

    /// Root mean square jerk by joint of the plan evaluated last, rad/s³.
    pub fn rms_jerk_rad_s3(&self) -> &[f64] {
        &self.rms_jerk
    }

    /// Root mean square power by joint of the plan evaluated last, W.
    pub fn rms_power_w(&self) -> Vec<f64> {
        self.joint_power_w().collect()
    }

    /// Work that the joints do and take up together in the plan evaluated last, J; what was evaluated is forgotten but for
    /// its motion.
    pub(super) fn energy_j(&mut self, setup: &Setup) -> f64 {
        self.mesh.integrate_finely(setup, &self.motion, FINELY);
        self.mesh.energy_j
    }
}

/// How far a share exceeds its limit: 0 to 10, and 0 of one that is kept but for rounding. At a dead centre the share has no bound.
pub fn excess(share: f64) -> f64 {
    if share <= KEPT_SHARE { 0.0 } else { (share - 1.0).min(10.0) }
}
