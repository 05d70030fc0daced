//! A fit as one JSON document.

use serde::Serialize;

use crate::{
    document,
    fit::{JointFit, LEAST_SKILL, LeftOut},
    remark::Remark,
    workflow::{
        fit::torque::JointTorque,
        fit::{Fitted, FittedRun},
    },
};

/// What logs say of a machine. Angles are radians, times seconds; pairs are for growing and for
/// shrinking angles.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Document<'a> {
    /// Always "hydrotrace.fit.v1".
    format: &'static str,
    /// Name and version of the program that wrote it.
    program: &'static str,
    /// The runs.
    runs: &'a [FittedRun],
    /// Each joint; every quantity has `value`, `interval` (95 %), `identified` and `lower_bound`.
    joints: &'a [JointFit],
    /// Torques of cylinders; empty without pressures and a task with cylinders in a log.
    torques: &'a [JointTorque],
    /// Joints that are sent and measured but hardly moved.
    left_out: &'a [LeftOut],
    /// What predicted peak errors are to be multiplied with so that nine of ten measured ones lie below.
    peak_margin: f64,
    /// Number of held-out starts behind the margin.
    margin_starts: usize,
    /// Least held-out R2 for which commands are made.
    least_held_out_r2: f64,
    /// Doubts; any makes the exit code 3.
    remarks: &'a [Remark],
}

/// A fit, SI units and radians throughout.
pub fn fit_json(fitted: &Fitted) -> String {
    document::pretty(&Document {
        format: "hydrotrace.fit.v1",
        program: document::PROGRAM,
        runs: &fitted.runs,
        joints: &fitted.fit.joints,
        torques: &fitted.torques,
        left_out: &fitted.fit.left_out,
        peak_margin: fitted.fit.peak_margin,
        margin_starts: fitted.fit.margin_starts,
        least_held_out_r2: LEAST_SKILL,
        remarks: fitted.remarks.as_slice(),
    })
}

#[cfg(test)]
mod tests {
    use super::Document;

    #[test]
    fn the_committed_schema_is_that_of_the_fit() {
        crate::schema::is_committed::<Document<'_>>("fit.v1.schema.json", "hydrotrace fit, version 1");
    }
}
