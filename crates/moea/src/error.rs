//! Why a problem cannot be run.

use std::fmt;

use thiserror::Error;

use super::bounds::{FARTHEST, LARGEST_INTEGER};

/// Why a problem cannot be run with these settings.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum MoeaError {
    /// Nothing to vary.
    #[error("the problem has no variables")]
    NoVariables,
    /// Nothing to minimise.
    #[error("the problem has no objectives")]
    NoObjectives,
    /// A bound is no number of at most 1e300, or lower and upper are swapped.
    #[error("variable {index} cannot lie between {lower:e} and {upper:e}: {}", no_bounds(*lower, *upper))]
    Bounds {
        /// Index of the variable.
        index: usize,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },
    /// Not as many kinds as variables.
    #[error("{given} kinds of variables, there are {wanted} variables")]
    Kinds {
        /// Kinds given.
        given: usize,
        /// Number of variables.
        wanted: usize,
    },
    /// No whole number lies within the bounds of an integer, or they are too large.
    #[error("variable {index} is an integer between {lower:e} and {upper:e}: {}", no_integers(*lower, *upper))]
    Integer {
        /// Index of the variable.
        index: usize,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },
    /// An initial member has the wrong length or a value that is not finite.
    #[error("initial member {member} has {found}; the problem has {wanted} variables, of finite values")]
    Initial {
        /// Index of the member.
        member: usize,
        /// What is wrong with it.
        found: Unsound,
        /// Number of variables.
        wanted: usize,
    },
    /// A rate is not a probability, or a distribution index is negative.
    #[error("{name} is {value}; rates lie in 0 to 1, distribution indices in 0 to 1000")]
    Operator {
        /// Name of the setting.
        name: &'static str,
        /// What was given.
        value: f64,
    },
    /// More directions than anyone can mean.
    #[error("{divisions} divisions for {objectives} objectives give more than {most} directions")]
    TooManyDirections {
        /// Number of objectives.
        objectives: usize,
        /// Divisions asked for.
        divisions: usize,
        /// The limit.
        most: usize,
    },
    /// More objectives than anyone can mean.
    #[error("{objectives} objectives are more than {most}")]
    TooManyObjectives {
        /// Number of objectives.
        objectives: usize,
        /// The limit.
        most: usize,
    },
    /// A reference direction has the wrong length, a value below 0 or that is no number, or no length.
    #[error(
        "reference direction {index} has {found}; it needs {wanted} finite values, none below 0 and not all 0"
    )]
    Direction {
        /// Index of the direction.
        index: usize,
        /// What is wrong with it.
        found: Unsound,
        /// Number of objectives.
        wanted: usize,
    },
    /// No reference direction, or more than anyone can mean.
    #[error("{given} reference directions; there must be 1 to {most}")]
    DirectionCount {
        /// Directions given.
        given: usize,
        /// The limit.
        most: usize,
    },
    /// Values told are not as many as the members asked for need.
    #[error(
        "told {objectives} objectives and {violations} violations; {members} members need {wanted} and {members}"
    )]
    Told {
        /// Number of values of objectives told.
        objectives: usize,
        /// Number of violations told.
        violations: usize,
        /// Members asked for.
        members: usize,
        /// Values of objectives that they have.
        wanted: usize,
    },
    /// Violations of single constraints told are not as many as the members asked for need.
    #[error("told {violations} violations one by one; {members} members need {}", needed(*members, *constraints))]
    ToldEach {
        /// Number of violations told.
        violations: usize,
        /// Members asked for.
        members: usize,
        /// Constraints of the run; none before the first values are told.
        constraints: Option<usize>,
    },
    /// Values told again, or before anybody asked.
    #[error(
        "after {evaluations} evaluations values were told of members that were not asked for; call `ask` before each `tell`"
    )]
    NotAsked {
        /// Evaluations told so far.
        evaluations: u64,
    },
    /// A record is of another run.
    #[error(
        "after {evaluation} evaluations the record is of a run with other settings (with a budget, its length is one), of another version, or of a machine whose mathematical library rounds otherwise"
    )]
    Record {
        /// Evaluations that agree.
        evaluation: u64,
    },
    /// Values of a record are not those that were told.
    #[error("the values after {evaluation} evaluations of the record are damaged: their checksum is another")]
    Damaged {
        /// Evaluations before them.
        evaluation: u64,
    },
    /// A larger population than anyone can mean.
    #[error("a population of {wanted} is more than {most}")]
    TooManyMembers {
        /// Members asked for.
        wanted: usize,
        /// The limit.
        most: usize,
    },
}

/// What is wrong with a row of values.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Unsound {
    /// So many values, which are too few or too many.
    Length(usize),
    /// A value that cannot be.
    Value {
        /// Its index in the row.
        index: usize,
        /// The value.
        value: f64,
    },
    /// All values are 0.
    Zeros,
}

impl fmt::Display for Unsound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length(1) => write!(f, "1 value"),
            Self::Length(length) => write!(f, "{length} values"),
            Self::Value { index, value } => write!(f, "{value:e} as its value {index}"),
            Self::Zeros => write!(f, "only zeros"),
        }
    }
}

impl Unsound {
    /// What is wrong with a row that should have `wanted` values that are all `sound`.
    pub(super) fn of(row: &[f64], wanted: usize, sound: impl Fn(f64) -> bool) -> Option<Self> {
        if row.len() != wanted {
            return Some(Self::Length(row.len()));
        }
        let index = row.iter().position(|value| !sound(*value))?;
        Some(Self::Value { index, value: row[index] })
    }
}

/// Why bounds are none.
fn no_bounds(lower: f64, upper: f64) -> String {
    match [("lower", lower), ("upper", upper)]
        .iter()
        .find(|(_, bound)| bound.is_nan() || bound.abs() > FARTHEST)
    {
        Some((name, bound)) => format!("the {name} bound, {bound:e}, is no number of at most {FARTHEST:e}"),
        None => "the lower bound is above the upper one".to_owned(),
    }
}

/// Why an integer has no values within its bounds.
fn no_integers(lower: f64, upper: f64) -> String {
    match [("lower", lower), ("upper", upper)].iter().find(|(_, bound)| bound.abs() > LARGEST_INTEGER) {
        Some((name, bound)) => format!("the {name} bound, {bound:e}, is beyond {LARGEST_INTEGER:e}"),
        None => "no whole number lies there".to_owned(),
    }
}

/// How many violations of single constraints members need.
fn needed(members: usize, constraints: Option<usize>) -> String {
    let total = constraints.map(|constraints| members.saturating_mul(constraints));
    total.map_or_else(|| format!("a multiple of {members}"), |total| total.to_string())
}

#[cfg(test)]
mod tests {
    use crate::{Directions, Kind, Settings, Variables, settings::check};

    #[test]
    fn an_error_names_the_value_that_is_wrong_and_its_place() {
        let direction = |z: &[f64]| Directions::Own(vec![vec![1.0; 2], z.to_vec()]).points(2, 0).unwrap_err();
        let settings = |x: &[f64]| Settings { initial: vec![x.to_vec()], ..Settings::default() };
        let initial = |x: &[f64]| check((&[(0.0, 1.0); 2]).into(), 2, &settings(x)).map(|_| ()).unwrap_err();
        let bounds = |bounds: (f64, f64), kind: Kind| {
            check(Variables::new(vec![bounds], vec![kind]), 2, &Settings::default()).map(|_| ()).unwrap_err()
        };
        for (error, words) in [
            (direction(&[0.0, 0.0]), "reference direction 1 has only zeros; "),
            (direction(&[1.0, f64::INFINITY]), "reference direction 1 has inf as its value 1; "),
            (direction(&[-0.5, 1.0]), "reference direction 1 has -5e-1 as its value 0; "),
            (direction(&[1.0; 3]), "reference direction 1 has 3 values; it needs 2 "),
            (initial(&[0.5, f64::NAN]), "initial member 0 has NaN as its value 1; "),
            (initial(&[0.5]), "initial member 0 has 1 value; the problem has 2 "),
            (bounds((0.2, 0.8), Kind::Integer), "between 2e-1 and 8e-1: no whole number lies there"),
            (bounds((0.0, 1e16), Kind::Integer), "the upper bound, 1e16, is beyond 1e15"),
            (bounds((f64::NAN, 1.0), Kind::Real), "the lower bound, NaN, is no number of at most 1e300"),
            (bounds((2.0, 1.0), Kind::Real), "the lower bound is above the upper one"),
        ] {
            assert!(error.to_string().contains(words), "{error}");
        }
    }
}
