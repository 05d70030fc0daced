//! What can be wrong with the description of an arm, or asked of it in vain.

use std::fmt::Display;

use thiserror::Error;

use crate::units::Degrees;

/// Why a description is refused, or a pose not reached.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message says what each field is")]
pub enum ArmError {
    #[error("{file} cannot be read: {reason}")]
    Syntax { file: String, reason: String },
    #[error("{file}: {found} {quantity}, at most {limit} are read")]
    TooLarge { file: String, quantity: &'static str, found: usize, limit: usize },
    #[error("{file}: {element}: found {found}, expected {expected}")]
    Unexpected { file: String, element: String, found: String, expected: String },
    /// The end of the chain is not given and could be any of these links.
    #[error("{file}: the tool could be any of {}; name one (in a task: tool = \"{}\")", tools.join(", "), tools.first().map_or("", String::as_str))]
    SeveralTools { file: String, tools: Vec<String> },
    #[error("{file}: the link {tool} cannot be placed without the positions of {}", joints.join(", "))]
    JointsMissing { file: String, tool: String, joints: Vec<String> },
    /// No posture within the limits has the tool there; what the nearest attempt leaves.
    #[error(
        "the tool pose is out of reach by {} and {}{}",
        if (ROUNDED..1e-6).contains(distance_m) { format!("{distance_m:.1e} m") } else { format!("{:.3} mm", 1e3 * distance_m) },
        if (ROUNDED..NEARLY[1]).contains(angle_rad) { format!("{angle_rad:.1e} rad") } else { Degrees(*angle_rad).to_string() },
        if *distance_m < NEARLY[0] && *angle_rad < NEARLY[1] {
            "; the arm comes no nearer, as one of few joints does that cannot choose all of a pose: give this key point by its joints"
        } else {
            ""
        }
    )]
    Unreachable { distance_m: f64, angle_rad: f64 },
}

/// Less is rounding, m and rad.
const ROUNDED: f64 = 1e-12;

/// A pose that is missed by no more is rounded, m and rad.
const NEARLY: [f64; 2] = [1e-3, 2e-3];

pub(super) struct Witness<'a>(pub(super) &'a str);

impl Witness<'_> {
    pub(super) fn unexpected(
        &self,
        element: impl Into<String>,
        found: impl Display,
        expected: impl Into<String>,
    ) -> ArmError {
        let (file, element, found) = (self.0.to_owned(), element.into(), found.to_string());
        ArmError::Unexpected { file, element, found, expected: expected.into() }
    }

    pub(super) fn syntax(&self, reason: &dyn Display) -> ArmError {
        ArmError::Syntax { file: self.0.to_owned(), reason: reason.to_string() }
    }

    pub(super) fn at_most(&self, quantity: &'static str, found: usize, limit: usize) -> Result<(), ArmError> {
        if found <= limit {
            return Ok(());
        }
        Err(ArmError::TooLarge { file: self.0.to_owned(), quantity, found, limit })
    }
}
