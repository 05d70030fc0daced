//! Why a task cannot be planned at all.

use thiserror::Error;

use crate::{arm::ArmError, moea::MoeaError, series::JointKind, spline::SplineError};

/// A distance, with digits where it is small.
fn by(kind: JointKind, distance: f64) -> String {
    if distance < 1e-3 { format!("{distance:.3e} {}", kind.unit()) } else { kind.says(distance) }
}

/// Why a task does not fit its arm, or cannot be searched.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message says what each field is")]
pub enum PlanError {
    /// A task that was built in code and does not hold what its documentation says.
    #[error("the task has other {what} than expected: {expected}")]
    Task { what: &'static str, expected: String },
    #[error(
        "the task's joints are {task}, those of the arm are {arm}; name every joint of the arm in the task, or, where the arm ends before \
         the others, as before a gripper, the link at which it does: tool = \"LINK\""
    )]
    JointsDiffer { task: String, arm: String },
    #[error(
        "the joint {joint} {}", match arm {
            JointKind::Slides => "slides by the arm's description, and the task has it in degrees; give its positions_mm, speed_mm_s and \
                so on",
            JointKind::Turns => "turns by the arm's description, and the task has it in millimetres; give its angles_deg, speed_deg_s and \
                so on",
        }
    )]
    KindsDiffer { joint: String, arm: JointKind },
    #[error(
        "the task limits the rod speed of {joint} to {rod_speed_m_s} m/s, and no cylinder of {joint} is known, so that nothing keeps it: \
         name the file of its cylinders (hydraulics = \"FILE\") or leave {joint} out of limits.rod_speed_m_s"
    )]
    NoCylinder { joint: String, rod_speed_m_s: f64 },
    #[error("key point {point} cannot be reached")]
    Unreachable {
        /// Number of the key point, from 1.
        point: usize,
        source: ArmError,
    },
    #[error(
        "key point {point} has {joint} at {}, its range is {} to {}: {} beyond it; move the key point or widen the range",
        kind.says(*found_rad), kind.says(*lowest_rad), kind.says(*highest_rad),
        by(*kind, (lowest_rad - found_rad).max(found_rad - highest_rad))
    )]
    PointOutside {
        /// Number of the key point, from 1.
        point: usize,
        joint: String,
        kind: JointKind,
        found_rad: f64,
        lowest_rad: f64,
        highest_rad: f64,
    },
    #[error("the {end} asks {joint} for a {quantity} of {share:.2} times its limit")]
    EndOutside { end: &'static str, joint: String, quantity: &'static str, share: f64 },
    /// Two joints as one, or a payload beyond what numbers hold.
    #[error("a payload of {payload_kg} kg is no mass")]
    Payload { payload_kg: f64 },
    #[error("the key points and times make no plan")]
    Spline(#[from] SplineError),
    #[error("{found} times for {expected} key points; give each key point's arrival, dwells counted, from 0")]
    Times { found: usize, expected: usize },
    #[error("the times begin at {found_s} s; the first is the departure, from which the others count: 0")]
    Begins { found_s: f64 },
    #[error(
        "free point {point}, of {angles} angles for {joints} joints at {t_s} s, is not on the way between two key points"
    )]
    Via {
        /// Number of the free point, from 1.
        point: usize,
        t_s: f64,
        angles: usize,
        joints: usize,
    },
    #[error("the search cannot be run so")]
    Search(#[from] MoeaError),
}
