//! What a plan that keeps its limits leaves to be doubted.

use super::PlanRequest;
use crate::{
    plan::{BETWEEN, Interpolation, Limit, PlanError, PlanEvaluation},
    remark::{Code, Remarks},
    task::Objective,
};

/// Share by which a plan has to be above a ceiling to be told: less is not seen in what is printed.
const ABOVE: f64 = 1e-3;

/// Intervals are the shortest up to this times it, and a limit below this share holds no plan.
const SHORTEST: f64 = 1.01;
const FAR: f64 = 0.6;

impl PlanRequest {
    /// Remarks on a plan of the task: what a controller's curve breaks through the points of its trajectory.
    ///
    /// # Errors
    ///
    /// [`PlanError`] of a plan of another task.
    pub fn doubts(&self, plan: &PlanEvaluation) -> Result<Remarks, PlanError> {
        let (setup, mut remarks) = (&self.setup, Remarks::default());
        let motion = setup.motion_through(&plan.times_s, &plan.via)?;
        let points_hz = setup.points_hz(&motion);
        let own = |limit: Limit, joint| {
            let own = plan.margins.iter().find(|margin| (margin.limit, margin.joint) == (limit, joint));
            own.map_or(0.0, |own| own.share)
        };
        let between = setup.between(&motion, points_hz);
        // What the plan breaks itself is told with its limits.
        if let Some((how, margin)) = between.filter(|(_, m)| own(m.limit, m.joint) <= 1.0 + BETWEEN) {
            let curve = match how {
                Interpolation::Linear => "straight line",
                Interpolation::Cubic => "cubic",
                Interpolation::Quintic => "quintic",
            };
            let names = setup.joint_names();
            let of = margin.joint.and_then(|joint| names.get(joint)).map(|name| format!(" of {name}"));
            let message = format!(
                "through the points of its trajectory, {points_hz:.0} a second, a controller's {curve} comes to {:.0} % of the \
                 largest {}{} at {:.2} s, where the plan keeps it: send it as a stream, or look at what yours interpolates",
                100.0 * margin.share,
                margin.limit.name_of(margin.kind),
                of.unwrap_or_default(),
                margin.t_s
            );
            remarks.add(Code::BeyondLimit, 1, message);
        }
        if let Some(message) = self.unlimited(plan) {
            remarks.add(Code::InactiveBound, 1, message);
        }
        Ok(remarks)
    }

    /// What is said of a plan that nothing but the shortest interval keeps from being faster.
    fn unlimited(&self, plan: &PlanEvaluation) -> Option<String> {
        let shortest_s = self.task.interval_s[0];
        plan.interval_s.iter().all(|interval_s| *interval_s <= SHORTEST * shortest_s).then_some(())?;
        let rates = plan.margins.iter().filter(|margin| margin.limit != Limit::Position);
        let nearest = match rates.max_by(|a, b| a.share.total_cmp(&b.share)) {
            Some(margin) if margin.share > FAR => return None,
            Some(margin) => {
                format!("the nearest limit is {} at {:.0} %", margin.limit.name(), 100.0 * margin.share)
            }
            None => "no limit of speed, acceleration, jerk or load is known of any joint".to_owned(),
        };
        Some(format!(
            "nothing but the shortest interval that the task allows, {shortest_s} s (interval_s), keeps the plan from being faster; \
             {nearest}: are the key points in the unit that the task says, and are limits given?"
        ))
    }

    /// Ceilings that a plan is above, and by what share.
    pub fn above(&self, plan: &PlanEvaluation) -> Vec<(Objective, f64)> {
        let above = |&k: &Objective| (k, plan.objectives[k] / self.task.ceilings[k] - 1.0);
        Objective::OF_PLAN.iter().map(above).filter(|(_, share)| *share > ABOVE).collect()
    }
}
