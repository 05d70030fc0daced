//! `replan`: from the logs of runs to a plan and a command for the next one.

mod candidate;
mod command;
mod document;
mod failure;
mod inputs;
mod last;
mod limits;
mod outcome;
mod predicted;
mod retime;
mod samples;

use std::ops::ControlFlow;

use rayon::prelude::*;

pub use command::{Commanded, JointCommand};
pub use document::ReplanDocument;
pub use failure::ReplanFailure;
pub use inputs::Inputs;
pub use limits::{HeldTo, Origin};
pub use outcome::{Before, Replanned};
pub use predicted::{Predicted, PredictedTransition, predicted};
pub use retime::Search;
pub use samples::{LEAD_S, TAIL_S};

use super::{
    fit::observe::Observed,
    fit::{self, LimitsFile},
};
use crate::{
    fit::{Fit, JointFit},
    plan::{PlanEvaluation, Setup},
    remark::{Code, Remarks},
    series::Track,
    task::{Ceilings, Objective, Objectives},
};
use candidate::{Candidate, candidates, choose};
use last::Last;

/// Plans again.
///
/// # Errors
///
/// [`ReplanFailure`] if the runs cannot be fitted, nothing may be changed, or the plan does not move.
pub fn run(
    inputs: &Inputs,
    observer: impl FnMut(u64) -> ControlFlow<()>,
) -> Result<Replanned, ReplanFailure> {
    let path = inputs.logs.last().ok_or(ReplanFailure::NoLog)?;
    if inputs.keep_plan && !inputs.precompensate {
        return Err(ReplanFailure::NothingToChange);
    }
    let observed = fit::observed(&inputs.logs, &inputs.wanted).map_err(fit::FitFailure::from)?;
    let (fit, fitted_to, mut remarks) = machine(inputs, &observed)?;
    let newest = observed.last().ok_or(ReplanFailure::NoLog)?;
    let last = Last::of(path, newest, inputs)?;
    if inputs.precompensate
        && !last.plan.tracks.iter().any(|t| fit.joint(t.name()).is_some_and(JointFit::trusted))
    {
        let best = fit.joints.iter().map(|joint| joint.held_out_r2).fold(f64::NEG_INFINITY, f64::max);
        if inputs.keep_plan {
            return Err(ReplanFailure::Unpredictable { best, least: crate::fit::LEAST_SKILL });
        }
        remarks.add(
            Code::PoorFit,
            1,
            "no joint is predicted well enough for a command: only the plan changes",
        );
    }
    let before =
        Before::of(newest, &last, predicted(&fit, &last.plan, &last.plan, &inputs.rules)?, &inputs.rules);
    let search = match &last.request {
        Some(request) if !inputs.keep_plan => Some(searched(inputs, &fit, &last, request, observer)?),
        _ => None,
    };
    if search.is_none() && !inputs.keep_plan {
        if !inputs.precompensate {
            return Err(ReplanFailure::NoTask { path: path.clone() });
        }
        let message =
            "the log holds no task, so the plan stays and only the command changes; --task names one";
        remarks.add(Code::NotSupported, 1, message);
    }
    let setup = last.request.as_ref().map(|request| &request.setup);
    let options = candidates(&last, search.as_ref())?;
    let made: Vec<Candidate> = options
        .into_par_iter()
        .map(|(interval_s, plan)| Candidate::of(inputs, &fit, setup, interval_s, plan))
        .collect::<Result<_, _>>()?;
    let chosen = choose(made).ok_or_else(|| ReplanFailure::AtRest { path: path.clone() })?;
    outcome::replanned(inputs, (fit, fitted_to), last, before, search, chosen, remarks)
}

/// The machine: fitted, or from a file; with the names of the logs behind it.
fn machine(inputs: &Inputs, observed: &[Observed]) -> Result<(Fit, Vec<String>, Remarks), ReplanFailure> {
    if let Some(path) = &inputs.limits {
        let file = LimitsFile::read(path)?;
        let joints = observed.iter().flat_map(|run| &run.recording.measured.tracks).map(Track::name);
        file.check_joints(path, joints)?;
        return Ok((file.fit, file.logs, Remarks::default()));
    }
    let fitted = fit::of(&inputs.logs, observed).map_err(fit::FitFailure::from)?;
    Ok((fitted.fit, fitted.runs.into_iter().map(|run| run.log).collect(), fitted.remarks))
}

/// Searches other timings of the task's key points.
fn searched(
    inputs: &Inputs,
    fit: &Fit,
    last: &Last,
    request: &super::plan::PlanRequest,
    mut observer: impl FnMut(u64) -> ControlFlow<()>,
) -> Result<Search, ReplanFailure> {
    let motion = last.motion();
    let (task, held) = limits::held(&request.task, &request.setup, fit, motion.as_ref());
    // The arm is that of the order; its files need not be read again.
    let setup = Setup::new(&task, request.setup.arm().clone())?;
    let start = last.times_s.as_ref().map(|times_s| setup.intervals_s(times_s)).transpose()?;
    let evaluation = last.times_s.as_ref().map(|times_s| PlanEvaluation::of(&setup, times_s)).transpose()?;
    let time = (1.0 + inputs.time_growth) * (1.0 + 1e-9);
    let growth = |objective| if objective == Objective::Duration { time } else { 1.0 + inputs.cost_growth };
    let unknown = Objectives::NONE.with(Objective::Duration, last.duration_s);
    let most = evaluation.as_ref().map_or(unknown, |evaluation| evaluation.objectives);
    let ceilings = Ceilings::NONE.map_plan(|k| (most[k] * growth(k)).min(task.ceilings[k]));
    let found = retime::retimed(
        &setup,
        fit,
        start.as_deref(),
        ceilings,
        (inputs.evaluations, inputs.seed),
        &mut observer,
    )?;
    Ok(Search { front: found.front, evaluations: found.evaluations, ceilings, held, start, evaluation })
}
