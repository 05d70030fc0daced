//! What can be wrong with the description of an arm, or asked of it in vain.

use std::fmt::Display;

use thiserror::Error;

use crate::units::Degrees;

/// Why a description is refused, or a pose not reached.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ArmError {
    /// The text is not of its language.
    #[error("{file} cannot be read: {reason}")]
    Syntax {
        /// File, or what stands for it.
        file: String,
        /// The parser's words, with line where it gives one.
        reason: String,
    },
    /// More text or deeper nesting than any arm needs.
    #[error("{file}: {found} {quantity}, at most {limit} are read")]
    TooLarge {
        /// File, or what stands for it.
        file: String,
        /// What is counted.
        quantity: &'static str,
        /// How many there are.
        found: usize,
        /// How many are allowed.
        limit: usize,
    },
    /// An element that contradicts another one or makes no sense.
    #[error("{file}: {element}: found {found}, expected {expected}")]
    Unexpected {
        /// File, or what stands for it.
        file: String,
        /// The element, as a person would look for it.
        element: String,
        /// What it says.
        found: String,
        /// What it may say.
        expected: String,
    },
    /// The end of the chain is not given and could be any of these links.
    #[error("{file}: the tool could be any of {}; name one", tools.join(", "))]
    SeveralTools {
        /// File, or what stands for it.
        file: String,
        /// The link at which the chain branches, and links without children.
        tools: Vec<String>,
    },
    /// Joints between base and tool whose positions are not known.
    #[error("{file}: the link {tool} cannot be placed without the positions of {}", joints.join(", "))]
    JointsMissing {
        /// File, or what stands for it.
        file: String,
        /// The link that is the tool.
        tool: String,
        /// Joints on the way to it.
        joints: Vec<String>,
    },
    /// No posture within the limits has the tool there; what the nearest attempt leaves.
    #[error("the tool pose is out of reach by {distance_m:.4} m and {}", Degrees(*angle_rad))]
    Unreachable {
        /// Remaining distance, m.
        distance_m: f64,
        /// Remaining rotation, rad.
        angle_rad: f64,
    },
}

/// Speaks for one file.
pub(super) struct Witness<'a>(pub(super) &'a str);

impl Witness<'_> {
    pub(super) fn unexpected(
        &self,
        element: impl Into<String>,
        found: impl Display,
        expected: impl Into<String>,
    ) -> ArmError {
        ArmError::Unexpected {
            file: self.0.to_owned(),
            element: element.into(),
            found: found.to_string(),
            expected: expected.into(),
        }
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
