//! `replan`: from the logs of runs to a plan and a command for the next one.

mod command;
mod document;
mod failure;
mod last;
mod limits;
mod outcome;
mod predicted;
mod retime;
mod samples;

use std::{ops::ControlFlow, path::PathBuf};

use rayon::prelude::*;

pub use command::{Commanded, JointCommand};
pub use document::ReplanDocument;
pub use failure::ReplanFailure;
pub use limits::{HeldTo, Origin};
pub use outcome::{Before, Replanned, Search};
pub use predicted::{Predicted, PredictedTransition, predicted};

use super::fit::{self, LimitsFile};
use crate::{
    fit::{Compensation, Fit, JointFit},
    log::{ReadOptions, Recording},
    plan::{PlanEvaluation, Setup},
    remark::{Code, Remarks},
    replay::Rules,
    series::{Series, Track},
    task::{Ceilings, Objective, Objectives},
};
use last::Last;
use samples::sampled;

/// What to plan again, and what may be changed.
#[derive(Debug, Clone)]
pub struct Inputs {
    /// Runs, each a file or a bag directory; the plan is that of the last.
    pub logs: Vec<PathBuf>,
    /// What to read of each.
    pub read: ReadOptions,
    /// A file with limits in place of a fit to the runs.
    pub limits: Option<PathBuf>,
    /// The task in place of that in the last log.
    pub task: Option<PathBuf>,
    /// Whether the plan stays as it is.
    pub keep_plan: bool,
    /// Whether a command is made.
    pub precompensate: bool,
    /// How far a command may leave its plan.
    pub compensation: Compensation,
    /// How much longer the plan may take, as a share.
    pub time_growth: f64,
    /// How much rougher it may be and how much more power it may take, as a share.
    pub cost_growth: f64,
    /// Evaluations of the search.
    pub evaluations: u64,
    /// Seed of the search.
    pub seed: u64,
    /// Thresholds of transitions.
    pub rules: Rules,
}

impl Default for Inputs {
    fn default() -> Self {
        Self {
            logs: Vec::new(),
            read: ReadOptions::default(),
            limits: None,
            task: None,
            keep_plan: false,
            precompensate: true,
            compensation: Compensation::default(),
            time_growth: 0.0,
            cost_growth: 0.1,
            evaluations: 20_000,
            seed: 1,
            rules: Rules::default(),
        }
    }
}

/// Timings of the search that are looked at with their commands.
const CANDIDATES: usize = 6;

/// A new timing must be expected to lower the sum of all peaks by this share; otherwise the proven one stays.
const WORTH: f64 = 0.02;

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
    let observed = fit::observed(&inputs.logs, &inputs.read).map_err(fit::FitFailure::from)?;
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
fn machine(inputs: &Inputs, observed: &[Recording]) -> Result<(Fit, Vec<String>, Remarks), ReplanFailure> {
    if let Some(path) = &inputs.limits {
        let file = LimitsFile::read(path)?;
        let joints = observed.iter().flat_map(|run| &run.measured.tracks).map(Track::name);
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

/// A plan: times of movement, s, where it is one of the task's, and its samples.
type Sampled = (Option<Vec<f64>>, Series);

/// Plans to look at with their commands: the last one first.
fn candidates(last: &Last, search: Option<&Search>) -> Result<Vec<Sampled>, ReplanFailure> {
    let (Some(search), Some(request)) = (search, &last.request) else {
        return Ok(vec![(None, last.plan.clone())]);
    };
    let kept = search.start.iter().filter(|_| search.keeps());
    let others = search.front.iter().map(|timing| &timing.interval_s);
    let all: Vec<&Vec<f64>> = kept.chain(others).take(CANDIDATES + 1).collect();
    if all.is_empty() {
        return Ok(vec![(None, last.plan.clone())]);
    }
    let sample = |interval_s: &Vec<f64>| -> Result<Sampled, ReplanFailure> {
        let motion = request.setup.motion(&request.setup.times_s(interval_s))?;
        Ok((Some(interval_s.clone()), sampled(&request.setup, &motion)?))
    };
    all.into_iter().map(sample).collect()
}

/// A plan with its command and what is expected of it.
pub(super) struct Candidate {
    pub(super) interval_s: Option<Vec<f64>>,
    pub(super) plan: Series,
    pub(super) command: Option<Commanded>,
    pub(super) predicted: Predicted,
}

impl Candidate {
    fn of(
        inputs: &Inputs,
        fit: &Fit,
        setup: Option<&Setup>,
        interval_s: Option<Vec<f64>>,
        plan: Series,
    ) -> Result<Self, ReplanFailure> {
        let command = if inputs.precompensate {
            let made = command::commanded(fit, &plan, inputs.compensation, setup)?;
            made.joints.iter().any(|joint| joint.compensation.applied).then_some(made)
        } else {
            None
        };
        let sent = command.as_ref().map_or(&plan, |command| &command.series);
        let predicted = predicted(fit, &plan, sent, &inputs.rules)?;
        Ok(Self { interval_s, plan, command, predicted })
    }
}

/// The first unless another is expected to be better by enough.
fn choose(made: Vec<Candidate>) -> Option<Candidate> {
    let mut all = made.into_iter();
    let first = all.next()?;
    let most = (1.0 - WORTH) * first.predicted.sum_of_peaks_rad;
    let better = all.min_by(|a, b| a.predicted.sum_of_peaks_rad.total_cmp(&b.predicted.sum_of_peaks_rad));
    Some(better.filter(|better| better.predicted.sum_of_peaks_rad < most).unwrap_or(first))
}
