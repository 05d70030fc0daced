//! A bound in the unit of joints that are not there, which would be taken for one.

use thiserror::Error;

use crate::series::JointKind;

/// A bound that no joint is held by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("no joint of the {of} {moves}, so that {option} bounds nothing; say {other}")]
pub struct IdleBound {
    /// What the joints are of: a plan, a run.
    pub of: &'static str,
    /// How the joints that it would bound move.
    pub moves: &'static str,
    /// The option.
    pub option: &'static str,
    /// That of the joints that there are.
    pub other: &'static str,
}

/// Refuses a bound of joints that turn, or of joints that slide, where there are none; `given` says which of the two options
/// there is.
pub(super) fn check(
    of: &'static str,
    given: [bool; 2],
    [of_turns, of_slides]: [&'static str; 2],
    kinds: &(impl Iterator<Item = JointKind> + Clone),
) -> Result<(), IdleBound> {
    let none = |kind: JointKind| kinds.clone().all(|own| own != kind);
    match given {
        [true, _] if none(JointKind::Turns) => {
            Err(IdleBound { of, moves: "turns", option: of_turns, other: of_slides })
        }
        [_, true] if none(JointKind::Slides) => {
            Err(IdleBound { of, moves: "slides", option: of_slides, other: of_turns })
        }
        _ => Ok(()),
    }
}
