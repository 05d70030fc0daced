//! Findings of `replan`.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{
    Candidate, Commanded, Decision, HeldTo, PastRun, Predicted, ReplanFailure, Response,
    command::{SHARPEST, gentle},
    last::Last,
    peaks::of_plan,
};
use crate::{
    fit::Fit,
    log::{Recording, WriteError},
    math::mean,
    plan::{PlanEvaluation, Timing},
    remark::{Code, Remarks},
    replay::{Replay, Rules},
    series::{JointKind, Series, moving_s},
    task::{Ceilings, Objective, Objectives},
    workflow::{
        carried::{
            Carried, Promise,
            plan_log::{Command, PlanLog, Planned},
            rest::PLAN_LEAD_S,
        },
        plan::{PlanDocument, PlanRequest, Shaping},
    },
};

/// Less of a correction than this is worth a remark.
const LEAST_SHARE: f64 = 0.85;

/// Motion that was not measured is named from here on, s: lost samples are shorter.
const LEAST_UNSEEN_S: f64 = 0.2;

/// The last run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Before {
    /// Starts and reversals that were measured.
    pub measured_transitions: usize,
    /// Mean of their peak errors, rad; null without any.
    pub measured_mean_peak_rad: Option<f64>,
    /// The largest of them, rad.
    pub measured_worst_peak_rad: Option<f64>,
    /// The same of joints that turn and of those that slide.
    pub measured_peaks: Vec<MeasuredPeaks>,
    /// Of the plan, s; from the first to the last motion where its times are not known.
    pub duration_s: f64,
    /// Prediction for what was sent in it.
    pub predicted: Predicted,
}

/// Peak errors of the transitions of joints of one kind; of those that slide a metre stands for a radian.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct MeasuredPeaks {
    /// How the joints move.
    pub kind: JointKind,
    /// Their mean, rad; null without any.
    pub mean_rad: Option<f64>,
    /// The largest, rad.
    pub worst_rad: Option<f64>,
}

impl MeasuredPeaks {
    fn of(kind: JointKind, found: &Replay) -> Self {
        let own = found.transitions.iter().filter(|transition| transition.joint_kind == kind);
        let peaks_rad: Vec<f64> = own.map(|transition| transition.peak_error).collect();
        let mean_rad = (!peaks_rad.is_empty()).then(|| mean(&peaks_rad));
        Self { kind, mean_rad, worst_rad: peaks_rad.into_iter().reduce(f64::max) }
    }
}

impl Before {
    pub(super) fn of(recording: &Recording, last: &Last, predicted: Predicted, rules: &Rules) -> Self {
        let found = of_plan(recording, last.span_s, rules);
        let is_of = |kind: &JointKind| last.plan.tracks.iter().any(|track| track.kind() == *kind);
        let kinds = [JointKind::Turns, JointKind::Slides].into_iter().filter(is_of);
        let measured_peaks = kinds.map(|kind| MeasuredPeaks::of(kind, &found)).collect();
        Self {
            measured_transitions: found.transitions.len(),
            measured_mean_peak_rad: found.mean_peak_rad(),
            measured_worst_peak_rad: found.peaks_rad().reduce(f64::max),
            measured_peaks,
            duration_s: last.motion().map_or(last.duration_s, |motion| motion.duration_s()),
            predicted,
        }
    }
}

/// A search for other timings.
#[derive(Debug, Clone, PartialEq)]
pub struct Search {
    /// Timings on the Pareto front, least predicted start error first.
    pub front: Vec<Timing>,
    /// The plans to look at: the first of them, in the shape asked for.
    pub plans: Vec<PlanEvaluation>,
    /// What was free in them.
    pub shaping: Shaping,
    /// Evaluations made.
    pub evaluations: u64,
    /// Ceilings on the objectives.
    pub ceilings: Ceilings,
    /// Limits of each joint in the search.
    pub held: Vec<HeldTo>,
    /// What the pump gives at least, m³/s, where that is less than its arm says.
    pub pump_flow_m3_s: Option<f64>,
    /// The last plan under the same limits.
    pub evaluation: Option<PlanEvaluation>,
}

impl Search {
    /// Whether the last plan keeps the limits and ceilings of the search.
    pub fn keeps(&self) -> bool {
        self.evaluation.as_ref().is_some_and(|evaluation| {
            evaluation.broken().iter().all(|margin| margin.share < 1.0 + 1e-6)
                && evaluation.objectives.within(&self.ceilings)
        })
    }
}

/// A plan and a command for the next run.
#[derive(Debug, Clone)]
pub struct Replanned {
    /// The machine that it was made for.
    pub fit: Fit,
    /// Logs that the machine was fitted to.
    pub fitted_to: Vec<String>,
    /// The last run.
    pub before: Before,
    /// Prediction for the next run.
    pub after: Predicted,
    /// How each joint that the fit knows will answer.
    pub responses: Vec<Response>,
    /// Of the new plan, s; from the first to the last motion where its times are not known.
    pub duration_s: f64,
    /// Whether the key points got other times.
    pub retimed: bool,
    /// The search, if there was one.
    pub search: Option<Search>,
    /// The new plan under the task's own limits; `None` without a task or its times.
    pub evaluation: Option<PlanEvaluation>,
    /// Objectives of the last plan, where they are known.
    pub objectives_before: Option<Objectives>,
    /// The command, if one was made.
    pub command: Option<Commanded>,
    /// Runs of the plan so far.
    pub past: Past,
    /// Where the joints should be.
    pub plan: Series,
    /// When the times of the task's plan count from, s.
    pub starts_s: Option<f64>,
    /// Points a second of the trajectory to send.
    pub points_hz: f64,
    /// Whether a delay of the measurement was given, and taken off.
    pub delay_known: bool,
    /// Why nothing was learnt from the newest run, where that is so.
    pub newest_left_out: Option<(Code, String)>,
    /// The task.
    pub request: Option<PlanRequest>,
    /// Doubts.
    pub remarks: Remarks,
    /// Where the controller takes trajectories, as far as the last log tells.
    pub trajectory: Option<String>,
    carried: Carried,
}

/// The runs of the plan so far, and what follows from them.
#[derive(Debug, Clone, PartialEq)]
pub struct Past {
    /// In their order.
    pub runs: Vec<PastRun>,
    /// Logs of other plans, of which the machine is learnt alone.
    pub others: Vec<String>,
    /// Whether to go on.
    pub decision: Decision,
    /// Share of the correction that was asked for.
    pub gain: f64,
    /// Share of the usual gain that the newest command's promise leaves.
    pub trust: f64,
}

/// Share of a correction that is careful.
pub(super) const CAREFUL: f64 = 0.5;

/// What of a correction limits leave out.
fn limited(command: &Commanded, remarks: &mut Remarks) {
    if let Some((share, limit)) = command.smaller {
        let message = format!(
            "{:.0} % of the usual step is taken on all joints: more of it would break the limit of {}",
            100.0 * share,
            limit.name()
        );
        remarks.add(Code::BeyondLimit, 1, message);
    }
    for joint in command.joints.iter().filter(|joint| joint.share < LEAST_SHARE) {
        let why = match joint.because {
            Some(limit) if !command.margins.is_empty() => format!("break the limit of {}", limit.name()),
            _ => format!(
                "accelerate it to more than {SHARPEST} times its plan and more than {} a second squared, and no limit of it is known",
                joint.kind.says(gentle(joint.kind))
            ),
        };
        let message = format!(
            "{:.0} % of the correction of {} is applied: more of it would {why}",
            100.0 * joint.share,
            joint.name
        );
        remarks.add(Code::BeyondLimit, 1, message);
    }
}

/// What is said where the last plan, slowed down to the fitted limits, takes longer between two key points than its task allows, s.
fn longer(search: &Search, most_s: f64) -> Option<String> {
    let evaluation = search.evaluation.as_ref()?;
    let needed_s = evaluation.slower()? * evaluation.interval_s.iter().copied().fold(0.0, f64::max);
    (needed_s > most_s).then(|| {
        format!(
            "its task allows {most_s:.2} s at most between two key points, and {needed_s:.2} s are needed: a larger interval_s there, and \
             --max-time-growth-percent"
        )
    })
}

pub(super) fn replanned(
    (fit, fitted_to): (Fit, Vec<String>),
    (last, delay_known): (Last, bool),
    before: Before,
    past: Past,
    search: Option<Search>,
    chosen: Candidate,
    mut remarks: Remarks,
) -> Result<Replanned, ReplanFailure> {
    let Candidate { new, plan, points_hz, command, predicted, responses } = chosen;
    let setup = last.request.as_ref().map(|request| &request.setup);
    let retimed = new.is_some();
    let last_evaluation = setup.map(|setup| last.evaluation(setup)).transpose()?.flatten();
    let objectives_before = last_evaluation.as_ref().map(|evaluation| evaluation.objectives);
    let evaluation = match (setup, &new) {
        (Some(setup), Some(new)) => Some(PlanEvaluation::through(setup, &new.times_s, &new.via)?),
        _ => last_evaluation,
    };
    if let Some(search) = search.as_ref().filter(|search| search.plans.is_empty() && !search.keeps()) {
        let (what, shape) = match search.shaping {
            Shaping::Timing => ("timing", ", --shape free another shape"),
            Shaping::Free(_) => ("plan", ""),
        };
        let longer = last.request.as_ref().and_then(|request| longer(search, request.task.interval_s[1]));
        let gives = longer.unwrap_or_else(|| format!("--max-time-growth-percent gives it more{shape}"));
        let message = format!(
            "no {what} was found that keeps the fitted limits within the time, jerk and power that are allowed: the plan stays; {gives}"
        );
        remarks.add(Code::BeyondLimit, 1, message);
    }
    if let Some(command) = &command {
        for joint in command.joints.iter().filter(|joint| joint.unseen_s > LEAST_UNSEEN_S) {
            let message = format!(
                "nothing was measured of {} for {:.2} s in which its plan moves: nothing is learnt there, and its correction \
                 fades to none",
                joint.name, joint.unseen_s
            );
            remarks.add(Code::Gap, 1, message);
        }
        for joint in command.joints.iter().filter(|joint| joint.shifted_rad != 0.0) {
            let message = format!(
                "{} rests {} from its plan before and after all motion: its zero is shifted, or its load holds it off; no correction \
                 mends that, and none is made for it",
                joint.name,
                joint.kind.says(joint.shifted_rad)
            );
            remarks.add(Code::UnlikePlan, 1, message);
        }
        for (joint, stop) in command.joints.iter().filter_map(|joint| Some((joint, joint.held?))) {
            let message = format!(
                "{} comes to {} and no farther, whatever is sent: a stop, a limit switch or a load holds it, {} before the end of its \
                 plan; no command moves it there, and none pushes more than the plan does. A task that ends before it is what helps",
                joint.name,
                joint.kind.says(stop.at_rad),
                joint.kind.says(stop.beyond_rad)
            );
            remarks.add(Code::BeyondLimit, 1, message);
        }
        for (joint, chance) in command.joints.iter().filter_map(|joint| Some((joint, joint.by_chance?))) {
            let message = format!(
                "{} left in its motion from {:.2} s on what neither its other motions nor another run tell of: {} at most, {} in the others; \
                 something held it by chance, such as an interlock or a load that stuck, or a sensor failed. It is not learnt until it \
                 comes again in a next run",
                joint.name,
                chance.from_s,
                joint.kind.says(chance.peak_rad),
                joint.kind.says(chance.usual_rad)
            );
            remarks.add(Code::UnlikePlan, 1, message);
        }
        for joint in command.joints.iter().filter(|joint| joint.stalled_rad > 0.0) {
            let message = format!(
                "{} more of a correction gained nothing on {}, or spoilt it: a limit that no file tells may hold it, such as its valve or a \
                 pump that joints share, and more time is what helps then; the smaller correction is as good there. Or what was sent came \
                 at another time than that of its plan",
                joint.kind.says(joint.stalled_rad),
                joint.name
            );
            remarks.add(Code::BeyondLimit, 1, message);
        }
        limited(command, &mut remarks);
    }
    let duration_s =
        evaluation.as_ref().map_or(last.duration_s, |evaluation| evaluation.objectives[Objective::Duration]);
    let starts_s = if retimed { Some(PLAN_LEAD_S) } else { last.starts_s };
    Ok(Replanned {
        fit,
        fitted_to,
        before,
        after: predicted,
        responses,
        duration_s,
        retimed,
        search,
        evaluation,
        objectives_before,
        command,
        past,
        plan,
        starts_s,
        points_hz,
        delay_known,
        newest_left_out: None,
        request: last.request,
        trajectory: last.trajectory,
        remarks,
        carried: last.carried,
    })
}

impl Replanned {
    /// How long after its first sample the plan first moves, s: what is sent counts on a clock of its own.
    pub fn moves_after_s(&self) -> Option<f64> {
        Some(moving_s(&self.plan)?[0] - self.plan.span_s()?[0])
    }

    /// What is expected of the next run.
    pub fn promise(&self) -> Promise {
        Promise::new(
            [self.after.mean_peak_rad, self.after.mean_peak_margin_rad],
            Some(self.after.transitions.len()),
        )
    }

    /// The bytes of the log: plan and command as channels of their own, and the task with the new plan.
    ///
    /// # Errors
    ///
    /// [`WriteError`] for joint names that no log can hold.
    pub fn log(&self, provenance: BTreeMap<String, String>, rate_hz: f64) -> Result<Vec<u8>, WriteError> {
        let mut carried = match (&self.request, &self.evaluation) {
            (Some(request), Some(evaluation)) => {
                let (title, joints) = (&request.task.title, request.setup.joint_names());
                let plan = PlanDocument::evaluated(title, &joints, evaluation, true);
                Carried::default().with_plan(&request.files, &plan)
            }
            _ => self.carried.clone(),
        }
        .with_provenance(provenance)
        .with_promise(&self.promise());
        if let Some(starts_s) = self.starts_s {
            carried = carried.with_starts_s(starts_s);
        }
        if let Some(topic) = &self.trajectory {
            carried = carried.with_trajectory_topic(topic);
        }
        PlanLog {
            plan: Planned::Series(&self.plan),
            command: self.command.as_ref().filter(|made| made.applied()).map(|made| Command {
                series: &made.series,
                acceleration_rad_s2: if made.exact { &made.acceleration_rad_s2 } else { &[] },
            }),
            arm: self.request.as_ref().map(|request| &request.setup.arm().chain),
            trajectory: self.trajectory.as_deref(),
            carried: &carried,
            rate_hz,
            points_hz: self.points_hz,
        }
        .bytes()
    }
}
