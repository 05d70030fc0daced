//! A plan for the next run as one JSON document.

use serde::Serialize;

use super::joint_name;
use crate::{
    document,
    plan::Objectives,
    remark::Remark,
    workflow::replan::{Before, HeldTo, JointCommand, Predicted, Replanned},
};

/// What to send next and what is expected of it. Angles are radians, times seconds.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Document<'a> {
    /// Always "hydrotrace.replan.v1".
    format: &'static str,
    /// Name and version of the program that wrote it.
    program: &'static str,
    /// Logs that the machine was fitted to.
    fitted_to: &'a [String],
    /// The last run.
    before: &'a Before,
    /// What is expected of the next.
    after: &'a Predicted,
    /// From the first to the last motion of the new plan, s.
    duration_s: f64,
    /// Whether the key points got other times.
    retimed: bool,
    /// Time, s, jerk, rad/s³, and power, W, of the last plan; null where its task is not known.
    objectives_before: Option<[f64; 3]>,
    /// The same of the new plan.
    objectives_after: Option<[f64; 3]>,
    /// Arrivals at the key points of the new plan, s.
    times_s: Option<&'a [f64]>,
    /// Evaluations of the search; null without one.
    evaluations: Option<u64>,
    /// What the search held each joint to.
    held_to: &'a [HeldTo],
    /// The command by joint; empty without one.
    command: &'a [JointCommand],
    /// How near the command comes to the limits of the task's arm.
    command_margins: Vec<CommandMargin>,
    /// Doubts; any makes the exit code 3.
    remarks: &'a [Remark],
}

/// A limit and where the command comes nearest to it.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct CommandMargin {
    /// The quantity.
    limit: String,
    /// The joint; null for a limit of the arm as a whole.
    joint: Option<String>,
    /// Its value there, SI.
    value: f64,
    /// What is allowed.
    allowed: f64,
    /// Share of what is allowed.
    share: f64,
    /// When, s since the start of the log.
    t_s: f64,
}

/// A plan for the next run, SI units and radians throughout.
pub fn replan_json(replanned: &Replanned) -> String {
    let search = replanned.search.as_ref();
    let evaluation = replanned.evaluation.as_ref();
    let command = replanned.command.as_ref();
    let margin = |margin: &crate::plan::Margin| CommandMargin {
        limit: crate::render::plan::name(margin.limit).replace(' ', "_"),
        joint: joint_name(replanned, margin.joint),
        value: margin.value,
        allowed: margin.allowed,
        share: margin.share,
        t_s: margin.t_s,
    };
    document::pretty(&Document {
        format: "hydrotrace.replan.v1",
        program: document::PROGRAM,
        fitted_to: &replanned.fitted_to,
        before: &replanned.before,
        after: &replanned.after,
        duration_s: replanned.duration_s,
        retimed: replanned.retimed,
        objectives_before: replanned.objectives_before.as_ref().map(Objectives::as_array),
        objectives_after: evaluation.map(|evaluation| evaluation.objectives.as_array()),
        times_s: evaluation.map(|evaluation| evaluation.times_s.as_slice()),
        evaluations: search.map(|search| search.evaluations),
        held_to: search.map_or(&[], |search| search.held.as_slice()),
        command: command.map_or(&[], |command| command.joints.as_slice()),
        command_margins: command
            .map_or_else(Vec::new, |command| command.margins.iter().map(margin).collect()),
        remarks: replanned.remarks.as_slice(),
    })
}

#[cfg(test)]
mod tests {
    use super::Document;

    #[test]
    fn the_committed_schema_is_that_of_the_next_plan() {
        crate::schema::is_committed::<Document<'_>>("replan.v1.schema.json", "hydrotrace replan, version 1");
    }
}
