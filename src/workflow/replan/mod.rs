//! `replan`: from the logs of runs to a plan and a command for the next one.

mod candidate;
mod changed;
mod checks;
mod command;
#[cfg(test)]
mod command_laws;
mod course;
mod decision;
mod document;
mod failure;
mod held;
mod history;
mod inputs;
mod last;
mod left_out;
mod limits;
mod machine;
mod one_way;
mod order;
mod out_of_time;
mod outcome;
mod parts;
mod peaks;
mod points;
mod predicted;
mod retime;
mod said_of_change;
mod same_way;
mod samples;
mod sent_as_plan;
mod shape;
mod subject;
mod unclear;
mod undone;
mod warp;

use std::ops::ControlFlow;

pub use checks::{
    Check, Checks, Fastest, Finding, JointTrust, Left, Level, Outside, Reason, Sharpest, Steep, TooFast,
    Verdict,
};
pub use command::{Commanded, JointCommand};
pub use course::{Drawn, JointCourse, courses};
pub use decision::{Decision, KeepReason, Overall};
pub use document::ReplanDocument;
pub use failure::ReplanFailure;
pub use history::PastRun;
pub use inputs::Inputs;
pub use limits::{HeldTo, Origin};
pub use outcome::{Before, MeasuredPeaks, Replanned, Search};
pub use predicted::{OfRuns, Predicted, PredictedTransition, Response, predicted, promised};
pub use unclear::Unclear;

use super::fit;
use crate::{
    arm::Arm,
    fit::{Fit, JointFit, Supply},
    log::Recording,
    plan::{PlanEvaluation, Setup, Timing, fastest},
    remark::{Code, Remarks},
    task::{Ceilings, Objective, Objectives},
    workflow::{correctable::uncorrectable, names::told_apart, plan::Shaping},
};
use candidate::{Candidate, Maker, Sampled, asks_too_much, decided};
use history::History;
use last::Last;
use left_out::without_useless;
use machine::machine;
use order::in_order;
use out_of_time::out_of_time;
use samples::sampled;

/// Timings of the search that are looked at with their commands.
const CANDIDATES: usize = 6;

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
    if let Some(why) = uncorrectable(newest, &inputs.rules) {
        return Err(ReplanFailure::of(path, why));
    }
    let names = told_apart(&inputs.logs);
    let last = Last::of(path, newest, inputs)?;
    inputs.check_bounds(&last.plan)?;
    let mut history = History::of((&names, &inputs.logs), observed, &last.plan, &inputs.rules)?;
    judged(path, &names, observed, &history, &mut doubts)?;
    parts::remark((&inputs.logs, &names), observed, &history.others, &mut doubts);
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
    let (fit, fitted_to, mut remarks) = machine(inputs, &logs, &own, last.arm())?;
    remarks.extend(doubts);
    history.remark_changes(changed, &mut remarks);
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
    if inputs.task.is_none() {
        last.carried.remark_others(path, &mut remarks);
    }
    let learns = inputs.precompensate && history.begun() && !inputs.retime;
    let learns = learns && (inputs.keep_plan || last.elsewhere.is_empty());
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
    let maker = Maker { inputs, precompensates, fit: &fit, setup, last: &last };
    let options = maker.within_shared(candidates(path, &last, search.as_ref())?);
    let (chosen, decision) = decided(&maker, &mut history, &options, learns)?;
    if precompensates && chosen.new.is_some() && chosen.command.is_none() {
        let message = "joints were held back by what they share, so that the run does not tell how they go in a slower plan: the plan \
                       changes without a correction, and its own run tells the next";
        remarks.add(Code::PoorFit, 1, message);
    }
    last.remark_elsewhere(chosen.new.is_some(), &mut remarks);
    if let Some(message) = goes_on.filter(|_| history.follows) {
        remarks.add(Code::MachineChanged, 1, message);
    }
    if chosen.new.is_none() && chosen.astray() {
        return Err(ReplanFailure::Astray { path: path.clone() });
    }
    if chosen.new.is_some() {
        for message in limits::beyond_shown(&fit, [&last.plan, &chosen.plan]) {
            remarks.add(Code::BeyondLimit, 1, message);
        }
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

/// An error for a newest plan that is another one with its correction, and remarks on logs that end before their plan does.
fn judged(
    path: &std::path::Path,
    names: &[String],
    observed: &[Recording],
    history: &History,
    doubts: &mut Remarks,
) -> Result<(), ReplanFailure> {
    if let Some(other) = sent_as_plan::behind(names, observed, &history.others)? {
        return Err(ReplanFailure::SentAsPlan { path: path.to_owned(), other: other.to_owned() });
    }
    for (log, by_s) in &history.cut_off {
        let message = format!(
            "{log} ends {by_s:.1} s before its plan does: its machine is learnt, of its error nothing"
        );
        doubts.add(Code::Stopped, 1, message);
    }
    Ok(())
}

/// An error for a run that is none of its plan.
fn unspoilt(inputs: &Inputs, observed: &[Recording]) -> Result<(), ReplanFailure> {
    for (path, recording) in inputs.logs.iter().zip(observed) {
        let remarks = recording.remarks.as_slice();
        let spoilt = remarks.iter().find(|remark| remark.code.spoils_runs());
        let spoilt = spoilt.map(|remark| remark.message.clone());
        // Those that others tell of are left out.
        if let Some(why) = spoilt.or_else(|| out_of_time(recording).map(|(_, why)| why)) {
            return Err(ReplanFailure::Spoilt { path: path.clone(), why });
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
    let Arm { chain, hydraulics } = request.setup.arm().clone();
    let gives_m3_s = fit.supply.as_ref().and_then(Supply::gives_m3_s);
    let pump_flow_m3_s = gives_m3_s.filter(|flow| *flow > 0.0 && *flow < hydraulics.pump_flow_m3_s());
    let hydraulics = hydraulics.with_pump_flow_m3_s(pump_flow_m3_s.unwrap_or(f64::INFINITY));
    let setup = Setup::new(&task, Arm { chain, hydraulics })?;
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
    if asks_too_much(fit, &last.plan, Some(&setup)) {
        found.front = within_shared(fit, &setup, found.front)?;
    }
    let best = &found.front[..found.front.len().min(CANDIDATES)];
    let known = start.as_deref().filter(|_| last.shaping() == Shaping::Timing);
    // A free shape begins at some times, however slow, where neither the last ones are known nor others are within what is allowed.
    let some = || fastest(&setup, inputs.evaluations / FOR_SOME).map(|timing| timing.interval_s);
    let none = start.is_none() && best.is_empty() && shaping != Shaping::Timing;
    let from = if none { some() } else { start.clone() };
    let plans = shape::shaped(&setup, best, (from.as_deref(), known), &ceilings, shaping)?;
    let retime::Timings { front, evaluations } = found;
    Ok(Search { front, plans, shaping, evaluations, ceilings, held, pump_flow_m3_s, evaluation })
}

/// Share of the evaluations for times that a free shape begins at.
const FOR_SOME: u64 = 10;

/// Timings in their order, those first that ask for no more than joints share.
fn within_shared(fit: &Fit, setup: &Setup, front: Vec<Timing>) -> Result<Vec<Timing>, ReplanFailure> {
    let (mut within, mut beyond) = (Vec::new(), Vec::new());
    for timing in front {
        let plan = sampled(setup, &setup.motion(&setup.times_s(&timing.interval_s))?)?;
        if asks_too_much(fit, &plan, Some(setup)) { beyond.push(timing) } else { within.push(timing) }
    }
    within.extend(beyond);
    Ok(within)
}

/// Plans to look at with their commands: the last one first, unless it is one of another task.
fn candidates(
    path: &std::path::Path,
    last: &Last,
    search: Option<&Search>,
) -> Result<Vec<Sampled>, ReplanFailure> {
    let (Some(search), Some(request)) = (search, &last.request) else {
        return Ok(vec![(None, last.plan.clone())]);
    };
    let sample = |plan: &PlanEvaluation| -> Result<Sampled, ReplanFailure> {
        let motion = request.setup.motion_through(&plan.times_s, &plan.via)?;
        Ok((Some(plan.clone()), sampled(&request.setup, &motion)?))
    };
    let others = search.plans.iter().map(sample);
    if let Some(missed) = last.elsewhere.first() {
        let (path, missed) = (path.to_owned(), missed.clone());
        return if search.plans.is_empty() {
            Err(ReplanFailure::NoWay { path, missed })
        } else {
            others.collect()
        };
    }
    // A plan whose times are not known is one that was run all the same.
    if search.keeps() || search.evaluation.is_none() || search.plans.is_empty() {
        return std::iter::once(Ok((None, last.plan.clone()))).chain(others).collect();
    }
    others.collect()
}
