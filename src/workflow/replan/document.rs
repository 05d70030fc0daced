//! The document of `replan`: what to send next and what is expected of it.

use serde::{Deserialize, Serialize};

use super::{Before, Checks, Decision, HeldTo, JointCommand, PastRun, Predicted, Replanned};
use crate::{
    document::{PROGRAM, pretty},
    remark::Remark,
    task::Objectives,
    workflow::plan::MarginEntry,
};

const FORMAT: &str = "hydrotrace.replan.v3";

/// The plan and command of the next run with their predicted errors. Angles are radians, times seconds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ReplanDocument {
    /// Always "hydrotrace.replan.v3".
    pub format: String,
    /// Name and version of the program that wrote it.
    pub program: String,
    /// Logs that the machine was fitted to.
    pub fitted_to: Vec<String>,
    /// Whether it is safe to send, and why.
    pub checks: Checks,
    /// The last run.
    pub before: Before,
    /// Runs of this plan so far.
    pub runs: Vec<PastRun>,
    /// Whether the new command is worth sending.
    pub decision: Decision,
    /// Share of the usual gain that is left: less than one where the newest run came above its promise.
    pub trust: f64,
    /// Prediction for the next run.
    pub after: Predicted,
    /// From the first to the last motion of the new plan, s.
    pub duration_s: f64,
    /// Whether the key points got other times.
    pub retimed: bool,
    /// Objectives of the last plan; null if its task is not known.
    pub objectives_before: Option<Objectives>,
    /// The same of the new plan.
    pub objectives_after: Option<Objectives>,
    /// Arrivals at the key points of the new plan, s.
    pub times_s: Option<Vec<f64>>,
    /// Evaluations of the search; null without one.
    pub evaluations: Option<u64>,
    /// Limits of each joint in the search.
    pub held_to: Vec<HeldTo>,
    /// Flow of the pump that a new plan is held to, m³/s, where the runs show less than the arm says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pump_flow_m3_s: Option<f64>,
    /// The command by joint; empty without one.
    pub command: Vec<JointCommand>,
    /// How near the command comes to the limits of the task's arm.
    pub command_margins: Vec<MarginEntry>,
    /// Doubts; any makes the exit code 3.
    pub remarks: Vec<Remark>,
}

impl ReplanDocument {
    /// Of a plan for the next run.
    pub fn of(replanned: &Replanned) -> Self {
        let (search, command) = (replanned.search.as_ref(), replanned.command.as_ref());
        let evaluation = replanned.evaluation.as_ref();
        let joints = replanned.request.as_ref().map_or_else(Vec::new, |request| request.setup.joint_names());
        Self {
            format: FORMAT.to_owned(),
            program: PROGRAM.to_owned(),
            fitted_to: replanned.fitted_to.clone(),
            checks: Checks::of(replanned),
            before: replanned.before.clone(),
            runs: replanned.past.runs.clone(),
            decision: replanned.past.decision.clone(),
            trust: replanned.past.trust,
            after: replanned.after.clone(),
            duration_s: replanned.duration_s,
            retimed: replanned.retimed,
            objectives_before: replanned.objectives_before,
            objectives_after: evaluation.map(|evaluation| evaluation.objectives),
            times_s: evaluation.map(|evaluation| evaluation.times_s.clone()),
            evaluations: search.map(|search| search.evaluations),
            held_to: search.map_or_else(Vec::new, |search| search.held.clone()),
            pump_flow_m3_s: search.and_then(|search| search.pump_flow_m3_s),
            command: command.map_or_else(Vec::new, |command| command.joints.clone()),
            command_margins: command
                .map_or_else(Vec::new, |command| MarginEntry::all(&command.margins, &joints)),
            remarks: replanned.remarks.as_slice().to_vec(),
        }
    }

    /// The document as text.
    pub fn json(&self) -> String {
        pretty(self)
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::workflow::replan::{Inputs, run};

    #[test]
    fn a_document_reads_back_as_it_was_written() {
        let log = concat!(env!("CARGO_MANIFEST_DIR"), "/sample-logs/task-1-run.mcap");
        let inputs = Inputs { logs: vec![log.into()], evaluations: 600, ..Inputs::default() };
        let written = ReplanDocument::of(&run(&inputs, |_| ControlFlow::Continue(())).unwrap());
        let text = written.json();
        let read: ReplanDocument = serde_json::from_str(&text).unwrap();
        assert_eq!(read.json(), text);
        assert!(read.objectives_before.is_some() && !read.held_to.is_empty());
    }
}
