//! Plans with their motions, for plots.

use super::{PlanFailure, PlanRequest, Planned};
use crate::plan::{PlanError, PlanEvaluation, SampledMotion};

/// Instants of the motion that is drawn, less one; of one among many, for all joints together.
const STEPS: u32 = 600;
const STEPS_OF_MANY: u32 = 480;
/// Motions of a front at most.
const MOST: usize = 60;

/// A plan with its motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// The plan.
    pub evaluation: PlanEvaluation,
    /// Its motion.
    pub motion: SampledMotion,
}

impl Course {
    /// Of one plan of a task.
    ///
    /// # Errors
    ///
    /// [`PlanFailure`] if its times are not those of the task.
    pub fn of(request: &PlanRequest, evaluation: &PlanEvaluation) -> Result<Self, PlanFailure> {
        Ok(Self::sampled(request, evaluation.clone(), STEPS)?)
    }

    /// Of plans of the front with their places in it, sixty at most: the best of each objective, and others evenly.
    ///
    /// # Errors
    ///
    /// [`PlanFailure`] if their times are not those of the task.
    pub fn of_front(request: &PlanRequest, planned: &Planned) -> Result<Vec<(usize, Self)>, PlanFailure> {
        let count = planned.times_s.len();
        let even = (0..count.min(MOST)).map(|k| k * count / count.min(MOST));
        let mut places: Vec<usize> = even.chain(planned.ends.iter().copied()).collect();
        places.sort_unstable();
        places.dedup();
        let steps = STEPS_OF_MANY / u32::try_from(planned.joints.len().max(1)).unwrap_or(u32::MAX);
        let course = |place: usize| {
            let evaluation = PlanEvaluation::of(&request.setup, &planned.times_s[place])?;
            Ok((place, Self::sampled(request, evaluation, steps.max(40))?))
        };
        let courses: Result<Vec<_>, PlanError> =
            places.into_iter().filter(|k| *k < count).map(course).collect();
        Ok(courses?)
    }

    fn sampled(request: &PlanRequest, evaluation: PlanEvaluation, steps: u32) -> Result<Self, PlanError> {
        let motion = SampledMotion::of(&request.setup, &evaluation, steps)?;
        Ok(Self { evaluation, motion })
    }
}
