//! What a plan that keeps its limits leaves to be doubted.

use super::PlanRequest;
use crate::{
    plan::{BETWEEN, Evaluator, Interpolation, Limit, PlanError, PlanEvaluation, Setup, Timing, fastest},
    remark::{Code, Remarks},
    task::{Objective, Task},
};

/// Share by which a plan has to be above a ceiling to be told: less is not seen in what is printed.
const ABOVE: f64 = 1e-3;

/// Intervals are the shortest up to this times it, and a limit below this share holds no plan.
const SHORTEST: f64 = 1.01;
const FAR: f64 = 0.6;

/// Share of the time of the fastest plan that stops at every key point have to save to be told.
const SAVED: f64 = 0.03;

/// Times the longest interval that is tried at least where none keeps the limits.
const LONGER: f64 = 10.0;

/// Times that the nearest plan is slowed down by first.
const SLOWER: [f64; 4] = [1.2, 1.5, 2.0, 4.0];

/// Evaluations of its search, of which a tenth of a second has many.
const STOPPING: u64 = 1600;

impl PlanRequest {
    /// Remarks on the task itself, whatever its plan.
    pub(super) fn of_key_points(&self) -> Remarks {
        let (setup, mut remarks) = (&self.setup, Remarks::default());
        let weightless = setup.arm().chain.weightless();
        if !weightless.is_empty() && setup.payload_kg().iter().all(|mass_kg| *mass_kg <= 0.0) {
            let message = format!(
                "the arm's file gives no mass to what {} turns: torques and power of nothing",
                weightless.join(", ")
            );
            remarks.add(Code::NoMass, weightless.len() as u64, message);
        }
        let resists = setup.resisting();
        let message = format!(
            "damping and friction that the arm's file gives to {} are in no torque and power of a plan: at its speed limit {} of what a \
             joint may take",
            resists.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", "),
            resists.iter().map(|(_, share)| format!("{:.0} %", 100.0 * share)).collect::<Vec<_>>().join(", ")
        );
        remarks.add(Code::NotSupported, resists.len() as u64, message);
        if let [first, ..] = setup.stops() {
            let message = format!(
                "key point {} and the one beside it are the same: the arm stops there; dwell_s says for how long",
                first + 1
            );
            remarks.add(Code::EqualKeyPoints, setup.stops().len() as u64, message);
        }
        if let [first, ..] = setup.range_ends() {
            let message = format!(
                "the range of a joint ends at key point {}: the arm stops there; a little more range lets it pass",
                first + 1
            );
            remarks.add(Code::RangeEnd, setup.range_ends().len() as u64, message);
        }
        remarks
    }

    /// Duration of the fastest plan that stops at every key point, s, dwells included; `None` where every plan of the task does, or
    /// none keeps the limits.
    pub(super) fn stopping_s(&self) -> Option<f64> {
        let mut task = self.task.clone();
        let last = task.points.len().saturating_sub(1);
        let passed =
            |point: usize| !self.setup.stops().contains(&point) && !self.setup.range_ends().contains(&point);
        let mut more = false;
        for (point, key) in task.points.iter_mut().enumerate().take(last).skip(1) {
            more |= key.dwell_s.is_none() && passed(point);
            key.dwell_s = key.dwell_s.or(Some(0.0));
        }
        let fastest = more.then(|| self.fastest_of(&task))??;
        Some(fastest.objectives[Objective::Duration])
    }

    /// The longest interval of a plan that keeps all limits where intervals may be longer than the task has them, s; `None` where
    /// that makes none.
    pub(super) fn longest_s(&self, nearest: &PlanEvaluation) -> Option<f64> {
        let [shortest_s, longest_s] = self.task.interval_s;
        let longer = nearest.slower().unwrap_or(1.0).max(LONGER);
        let task = Task { interval_s: [shortest_s, longer * longest_s], ..self.task.clone() };
        // A load that is nearly one at rest falls so little with time that a search does not see it.
        let slower = |by: &f64| {
            let interval_s: Vec<f64> = nearest.interval_s.iter().map(|s| by * s).collect();
            self.setup.keeps(&interval_s, &mut Evaluator::new(&self.setup)).then_some(interval_s)
        };
        let found = SLOWER.iter().find_map(slower).or_else(|| Some(self.fastest_of(&task)?.interval_s))?;
        let longest = found.into_iter().fold(0.0, f64::max);
        (longest > longest_s).then_some(longest)
    }

    /// The fastest plan of a task like this, quickly; `None` where it has none.
    fn fastest_of(&self, task: &Task) -> Option<Timing> {
        fastest(&Setup::new(task, self.setup.arm().clone()).ok()?, STOPPING)
    }

    /// What is said of a task whose plans by times alone swing so far between key points that stops would be faster.
    pub(super) fn slower_than_stops(&self, fastest_s: f64) -> Remarks {
        let mut remarks = Remarks::default();
        if let Some(stopping_s) =
            self.stopping_s().filter(|stopping_s| *stopping_s < (1.0 - SAVED) * fastest_s)
        {
            let message = format!(
                "by times alone the fastest plan takes {fastest_s:.2} s, and one that stops at every key point (dwell_s = 0) \
                 {stopping_s:.2} s: between these key points a smooth curve swings far; --shape free seeks another"
            );
            remarks.add(Code::StopsAreFaster, 1, message);
        }
        remarks
    }

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
