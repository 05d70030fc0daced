//! The plan of a choice, in the shape asked for.

use super::{PlanRequest, failure::PlanFailure};
use crate::{
    plan::{
        Choice, NoChoice, NoShape, PlanError, PlanEvaluation, Rule, Setup, Shape, Timing, choose,
        fastest_shape, shape, smoother,
    },
    task::{Ceilings, Objective, Task, Weights},
};

/// Whether the chosen plan keeps the shape that its times give it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Shaping {
    /// It does.
    #[default]
    Timing,
    /// Free points between the key points give it another; that many pieces an interval, by default as the task asks.
    Free(Option<usize>),
}

/// What a free shape gained.
#[derive(Debug, Clone, PartialEq)]
pub struct Shaped {
    /// The plan of the same rule by times alone; `None` where no times alone keep all limits.
    pub timing: Option<PlanEvaluation>,
    /// Pieces that every interval between key points was split into.
    pub pieces: usize,
}

/// The plan of a choice.
pub(super) struct Made {
    pub(super) plan: PlanEvaluation,
    /// What its free shape gained, if one was sought and found.
    pub(super) shaped: Option<Shaped>,
    /// Why it has none, where one was sought.
    pub(super) no_shape: Option<NoShape>,
}

impl Made {
    /// # Errors
    ///
    /// [`PlanError`] of a choice from another task.
    pub(super) fn of(
        setup: &Setup,
        task: &Task,
        choice: &Choice,
        shaping: Shaping,
    ) -> Result<Self, PlanError> {
        let timing = PlanEvaluation::of(setup, &setup.times_s(&choice.timing.interval_s))?;
        Ok(match shaping {
            Shaping::Timing => Self { plan: timing, shaped: None, no_shape: None },
            Shaping::Free(pieces) => match of_choice(setup, task, choice, pieces) {
                Ok(Shape { evaluation, pieces, .. }) => Self {
                    plan: evaluation,
                    shaped: Some(Shaped { timing: Some(timing), pieces }),
                    no_shape: None,
                },
                Err(why) => Self { plan: timing, shaped: None, no_shape: Some(why) },
            },
        })
    }
}

/// The plan that a rule chooses from a front, in the shape asked for. A free shape may keep a ceiling that times alone are above.
///
/// # Errors
///
/// [`PlanFailure`] if no plan keeps to the ceilings, with what comes nearest, or the front is empty.
pub(super) fn chosen(
    setup: &Setup,
    task: &Task,
    shaping: Shaping,
    (front, rule): (&[Timing], (Rule, Option<Weights>)),
) -> Result<(Choice, Made), PlanFailure> {
    let nearest = match choose(setup, front, &task.ceilings, rule) {
        Ok(choice) => {
            let made = Made::of(setup, task, &choice, shaping)?;
            return Ok((choice, made));
        }
        Err(NoChoice::Ceilings { nearest }) => *nearest,
        Err(NoChoice::Empty) => return Err(PlanError::Times { found: 0, expected: 1 }.into()),
    };
    let times_s = setup.times_s(&nearest.interval_s);
    // The fastest may keep ceilings that nothing else is found within.
    let fastest = (Rule::Best(Objective::Duration), None);
    for rule in [rule, fastest] {
        if shaping != Shaping::Timing
            && let Ok(free) = choose(setup, front, &Ceilings::NONE, rule)
        {
            let choice = free.above(nearest.clone(), &task.ceilings);
            let made = Made::of(setup, task, &choice, shaping)?;
            if made.shaped.is_some() {
                return Ok((choice, made));
            }
        }
    }
    Err(PlanFailure::Ceilings { nearest: Box::new(PlanEvaluation::of(setup, &times_s)?) })
}

/// The fastest plan in a free shape where no plan by times alone keeps all limits; `nearest`: that which breaks them least.
///
/// # Errors
///
/// [`PlanFailure`] if no free shape is asked for, or none keeps the limits, with what comes nearest.
pub(super) fn without_front(
    request: &PlanRequest,
    nearest: Option<Timing>,
    shaping: Shaping,
) -> Result<(Choice, Made), PlanFailure> {
    let PlanRequest { task, setup, .. } = request;
    let nearest = nearest.ok_or(PlanError::Times { found: 0, expected: setup.interval_count() + 1 })?;
    if let Shaping::Free(pieces) = shaping
        && let Ok(Shape { evaluation, pieces, .. }) = fastest_shape(setup, &nearest, &task.ceilings, pieces)
    {
        let shaped = Some(Shaped { timing: None, pieces });
        let made = Made { plan: evaluation, shaped, no_shape: None };
        return Ok((Choice::without_front(nearest, &task.ceilings), made));
    }
    let nearest = Box::new(PlanEvaluation::of(setup, &setup.times_s(&nearest.interval_s))?);
    let longest_s = request.longest_s(&nearest);
    Err(PlanFailure::Infeasible { nearest, stopping_s: request.stopping_s(), longest_s })
}

/// The smoothest shape keeps the time of its choice, unless that is above a ceiling.
fn of_choice(setup: &Setup, task: &Task, choice: &Choice, pieces: Option<usize>) -> Result<Shape, NoShape> {
    let above = !choice.timing.objectives.within(&task.ceilings);
    if above && choice.rule == Rule::Best(Objective::RmsJerk) {
        return smoother(setup, &choice.timing, &task.ceilings, pieces);
    }
    shape(setup, choice, &task.ceilings, pieces)
}
