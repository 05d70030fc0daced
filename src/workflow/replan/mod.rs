//! `replan`: from the logs of runs to a plan and a command for the next one.

mod changed;
mod checks;
mod command;
#[cfg(test)]
mod command_laws;
mod correctable;
mod course;
mod decision;
mod document;
mod failure;
mod history;
mod inputs;
mod last;
mod left_out;
mod limits;
mod machine;
mod one_way;
mod order;
mod outcome;
mod predicted;
mod retime;
mod same_way;
mod samples;
mod shape;
mod subject;
mod unclear;
mod undone;
mod warp;

use std::ops::ControlFlow;

pub use checks::{
    Check, Checks, Fastest, Finding, JointTrust, Level, Outside, Reason, Sharpest, TooFast, Verdict,
};
pub use command::{Commanded, JointCommand};
pub use course::{Drawn, JointCourse, courses};
pub use decision::{Decision, KeepReason, Overall};
pub use document::ReplanDocument;
pub use failure::ReplanFailure;
pub use history::PastRun;
pub use inputs::Inputs;
pub use limits::{HeldTo, Origin};
pub use outcome::{Before, Replanned, Search};
pub use predicted::{Predicted, PredictedTransition, Response, predicted, promised};
pub use unclear::Unclear;

use super::fit;
use crate::{
    fit::{Fit, JointFit, Learning, Step, Trial},
    log::Recording,
    math::range,
    plan::{PlanEvaluation, Setup},
    remark::Code,
    series::Series,
    task::{Ceilings, Objective, Objectives},
    threads,
    units::DEGREE_RAD,
    workflow::{carried::rest::PLAN_LEAD_S, names::told_apart, plan::Shaping},
};
use command::commanded;
use correctable::correctable;
use history::History;
use last::Last;
use left_out::without_useless;
use machine::machine;
use order::in_order;
use samples::sampled;
use subject::Subject;
use warp::Warp;

/// Timings of the search that are looked at with their commands.
const CANDIDATES: usize = 6;

/// A plan of a joint that travels less is to hold it, rad.
const MOVES_RAD: f64 = 0.5 * DEGREE_RAD;

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
    inputs.check()?;
    let observed = fit::observed(&inputs.logs, &inputs.read).map_err(fit::FitFailure::from)?;
    let (inputs, observed, mut doubts) = in_order(inputs, observed);
    let (inputs, observed, useless) = without_useless(&inputs, observed);
    doubts.extend(useless.doubts);
    let (inputs, observed) = (&inputs, &observed[..]);
    let path = inputs.logs.last().ok_or(ReplanFailure::NoLog)?;
    unspoilt(inputs, observed)?;
    let newest = observed.last().ok_or(ReplanFailure::NoLog)?;
    correctable(path, newest, &inputs.rules)?;
    let last = Last::of(path, newest, inputs)?;
    inputs.check_bounds(&last.plan)?;
    let names = told_apart(&inputs.logs);
    let mut history = History::of((&names, &inputs.logs), observed, &last.plan, &inputs.rules)?;
    let chosen = |places: &mut dyn Iterator<Item = usize>| -> (Vec<String>, Vec<&Recording>) {
        places.map(|k| (names[k].clone(), &observed[k])).unzip()
    };
    let mut fits = |places: &[usize]| {
        let (logs, observed) = chosen(&mut places.iter().copied());
        inputs.limits.is_none().then(|| fit::of(&logs, &observed).ok())?.map(|fitted| fitted.fit)
    };
    let (others, changed) = history.without_another_machine(&mut fits);
    let goes_on = history.follow(&mut fits);
    let (logs, own) = chosen(&mut (0..observed.len()).filter(|k| !others.contains(k)));
    let (fit, fitted_to, mut remarks) = machine(inputs, &logs, &own)?;
    remarks.extend(doubts);
    history.remark_changes(changed, goes_on, &mut remarks);
    // The fit is to what was sent, but the next command is to follow the plan.
    let doubts = observed.iter().flat_map(|run| run.remarks.as_slice());
    let sent = doubts.filter(|remark| remark.code == Code::PlanIsCommand);
    sent.for_each(|remark| remarks.add(remark.code, remark.count, remark.message.clone()));
    // Other timings that were made here carry their times.
    if last.times_s.is_none()
        && let Some(message) = same_way::said(&names, observed, &history.others)?
    {
        remarks.add(Code::Paused, 1, message);
    }
    for message in &last.elsewhere {
        remarks.add(Code::OtherFile, 1, message);
    }
    if inputs.task.is_none() {
        last.carried.remark_others(path, &mut remarks);
    }
    let learns = inputs.precompensate && history.begun() && !inputs.retime;
    let known = last.plan.tracks.iter().any(|t| fit.joint(t.name()).is_some_and(JointFit::trusted));
    if inputs.precompensate && !known {
        let best = fit.joints.iter().map(|joint| joint.held_out_r2).fold(f64::NEG_INFINITY, f64::max);
        if inputs.keep_plan || learns || last.request.is_none() {
            let why = Unclear::of(inputs.logs.len(), newest, &inputs.rules);
            return Err(ReplanFailure::Unpredictable { best, least: crate::fit::LEAST_SKILL, why });
        }
        let message = "no joint is predicted well enough for a command: only the plan changes";
        remarks.add(Code::PoorFit, 1, message);
    }
    let precompensates = inputs.precompensate && known;
    let sent = history.newest().map_or(&last.plan, |(sent, _)| sent);
    let before = Before::of(newest, &last, predicted(&fit, &last.plan, sent, &inputs.rules)?, &inputs.rules);
    let search = match &last.request {
        Some(request) if !inputs.keep_plan && !learns => {
            Some(searched(inputs, &fit, &last, request, observer)?)
        }
        _ => None,
    };
    if search.is_none() && !inputs.keep_plan && !learns && !precompensates {
        return Err(ReplanFailure::NoTask { path: path.clone() });
    }
    let setup = last.request.as_ref().map(|request| &request.setup);
    let decision = if learns { history.decision() } else { Decision::Send };
    let options = candidates(&last, search.as_ref())?;
    let mut maker =
        Maker { inputs, precompensates, fit: &fit, setup, last: &last, history: &history, decision };
    let made = threads::mapped(&options, || (), |(), (new, plan)| maker.candidate(new.clone(), plan.clone()));
    let mut chosen = choose(made.into_iter().collect::<Result<_, _>>()?)
        .ok_or_else(|| ReplanFailure::AtRest { path: path.clone() })?;
    // What is kept is no other correction, whatever is expected of it.
    if let Some(keep) = chosen.kept_instead(&history).filter(|_| maker.decision == Decision::Send) {
        maker.decision = keep;
        let kept = maker.candidate(None, last.plan.clone())?;
        // Joints that the kept run spoilt are sent something else.
        if kept.predicted.mean_peak_rad < chosen.predicted.mean_peak_rad {
            chosen = kept;
        } else {
            maker.decision = Decision::Send;
        }
    }
    let decision = maker.decision;
    if chosen.new.is_none() && chosen.astray() {
        return Err(ReplanFailure::Astray { path: path.clone() });
    }
    let past = outcome::Past {
        gain: inputs.learning.gain,
        trust: history.trust(),
        runs: history.runs,
        others: history.others,
        decision,
    };
    let last = (last, newest.source.measured_delay_s.is_some());
    let mut replanned = outcome::replanned((fit, fitted_to), last, before, past, search, chosen, remarks)?;
    replanned.newest_left_out = useless.newest;
    Ok(replanned)
}

/// An error for a run that is none of its plan.
fn unspoilt(inputs: &Inputs, observed: &[Recording]) -> Result<(), ReplanFailure> {
    for (path, recording) in inputs.logs.iter().zip(observed) {
        let remarks = recording.remarks.as_slice();
        if let Some(remark) = remarks.iter().find(|remark| remark.code.spoils_runs()) {
            return Err(ReplanFailure::Spoilt { path: path.clone(), why: remark.message.clone() });
        }
    }
    Ok(())
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
    let shaping = inputs.shape.unwrap_or_else(|| last.shaping());
    let evaluation = last.evaluation(&setup)?;
    let time = (1.0 + inputs.time_growth) * (1.0 + 1e-9);
    let growth = |objective| if objective == Objective::Duration { time } else { 1.0 + inputs.cost_growth };
    let unknown = Objectives::NONE.with(Objective::Duration, last.duration_s);
    let most = evaluation.as_ref().map_or(unknown, |evaluation| evaluation.objectives);
    let ceilings = Ceilings::NONE.map_plan(|k| (most[k] * growth(k)).min(task.ceilings[k]));
    let mut timings = |ceilings| {
        let budget = (inputs.evaluations, inputs.seed);
        retime::retimed(&setup, fit, start.as_deref(), ceilings, budget, &mut observer)
    };
    let mut found = timings(ceilings)?;
    if found.front.is_empty() && shaping != Shaping::Timing {
        let before = found.evaluations;
        found = timings(shape::roomy(ceilings))?;
        found.evaluations += before;
    }
    let best = &found.front[..found.front.len().min(CANDIDATES)];
    let known = start.as_deref().filter(|_| last.shaping() == Shaping::Timing);
    let plans = shape::shaped(&setup, best, (start.as_deref(), known), &ceilings, shaping)?;
    let retime::Timings { front, evaluations } = found;
    Ok(Search { front, plans, shaping, evaluations, ceilings, held, evaluation })
}

/// A plan under the limits of the search, where it is not the last one, and its samples.
type Sampled = (Option<PlanEvaluation>, Series);

/// Plans to look at with their commands: the last one first.
fn candidates(last: &Last, search: Option<&Search>) -> Result<Vec<Sampled>, ReplanFailure> {
    let (Some(search), Some(request)) = (search, &last.request) else {
        return Ok(vec![(None, last.plan.clone())]);
    };
    let sample = |plan: &PlanEvaluation| -> Result<Sampled, ReplanFailure> {
        let motion = request.setup.motion_through(&plan.times_s, &plan.via)?;
        Ok((Some(plan.clone()), sampled(&request.setup, &motion)?))
    };
    let others = search.plans.iter().map(sample);
    if search.keeps() || search.plans.is_empty() {
        return std::iter::once(Ok((None, last.plan.clone()))).chain(others).collect();
    }
    others.collect()
}

/// A plan with its command and what is expected of it.
pub(super) struct Candidate {
    /// The plan under the limits of the search, if it is not the last one.
    pub(super) new: Option<PlanEvaluation>,
    pub(super) plan: Series,
    /// Points a second of a trajectory to send.
    pub(super) points_hz: f64,
    pub(super) command: Option<Commanded>,
    pub(super) predicted: Predicted,
    pub(super) responses: Vec<Response>,
}

impl Candidate {
    /// What to keep where more error is expected of a correction of the last plan than its best run had.
    fn kept_instead(&self, history: &History) -> Option<Decision> {
        let corrects = self.new.is_none() && self.command.as_ref().is_some_and(Commanded::applied);
        history.better_than(self.predicted.mean_peak_rad).filter(|_| corrects)
    }

    /// Whether half of the joints that are to move, or more, do not follow.
    fn astray(&self) -> bool {
        let moves = |joint: &&JointCommand| {
            self.plan.track(&joint.name).is_some_and(|track| {
                let [lowest, highest] = range(track.position().iter().copied());
                highest - lowest > MOVES_RAD
            })
        };
        let joints = || self.command.iter().flat_map(|command| &command.joints).filter(moves);
        let astray = joints().filter(|joint| joint.step == Step::Astray).count();
        astray > 0 && 2 * astray >= joints().count()
    }
}

/// Makes candidates.
struct Maker<'a> {
    inputs: &'a Inputs,
    /// Whether a command is wanted and some joint is known well enough for one.
    precompensates: bool,
    fit: &'a Fit,
    setup: Option<&'a Setup>,
    last: &'a Last,
    history: &'a History,
    decision: Decision,
}

impl Maker<'_> {
    /// `new` is of another plan than the last; its runs say nothing of this one.
    fn candidate(&self, new: Option<PlanEvaluation>, plan: Series) -> Result<Candidate, ReplanFailure> {
        let Self { inputs, precompensates, fit, setup, last, history, decision } = self;
        let kept = new.is_none();
        let motion = match (&new, setup) {
            (Some(new), Some(setup)) => Some((setup.motion_through(&new.times_s, &new.via)?, PLAN_LEAD_S)),
            _ => last.motion().zip(last.starts_s),
        };
        let warped = new.as_ref().and_then(|new| self.warped(&new.times_s, &plan));
        let trials = match &warped {
            _ if kept => history.trials(),
            Some(measured) => vec![Trial { sent: &plan, measured }],
            None => Vec::new(),
        };
        let keep = match decision {
            Decision::Keep { run, .. } if kept => Some(*run),
            _ => None,
        };
        let gain = inputs.learning.gain * if kept { history.trust() } else { 1.0 };
        let anew = kept && history.anew();
        let learning = Learning { gain, keep, anew, follow: kept && history.follows, ..inputs.learning };
        let subject = Subject::new(&plan, motion, *setup);
        let points_hz = subject.points_hz;
        let command = precompensates.then(|| commanded(fit, &subject, &trials, learning)).transpose()?;
        let sent = command.as_ref().map_or(&plan, |command| &command.series);
        let newest = keep.unwrap_or(trials.len().saturating_sub(1));
        let times = (0..trials.len()).filter(|k| kept && history.same(*k, newest)).count();
        let base = trials.get(newest).map(|trial| (trial.sent, trial.measured, times));
        let joints = || command.iter().flat_map(|command| &command.joints);
        let learnt = |name: &str| {
            joints().find(|joint| joint.name == name).map_or((None, None), |one| (one.spread_rad, one.held))
        };
        let (predicted, responses) = promised(fit, &plan, sent, base, learnt, &inputs.rules)?;
        let predicted = if kept { predicted.unsteady(history.unsteady_rad()) } else { predicted };
        Ok(Candidate { new, plan, points_hz, command, predicted, responses })
    }

    /// What the newest run tells of another timing.
    fn warped(&self, new_s: &[f64], plan: &Series) -> Option<Series> {
        let Self { fit, last, history, .. } = self;
        let (starts_s, old_s) = (last.starts_s?, last.times_s.as_ref()?);
        let warp = Warp {
            old_s: old_s.iter().map(|t_s| starts_s + t_s).collect(),
            new_s: new_s.iter().map(|t_s| PLAN_LEAD_S + t_s).collect(),
        };
        warp.run(fit, plan, history.newest()?)
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
