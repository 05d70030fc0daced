//! Why a problem cannot be run.

use thiserror::Error;

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
    #[error(
        "variable {index} cannot lie between {lower:e} and {upper:e}; bounds are numbers of at most 1e300, the lower first"
    )]
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
    #[error(
        "variable {index} is an integer, of which none is between {lower:e} and {upper:e} or one exceeds 1e15"
    )]
    Integer {
        /// Index of the variable.
        index: usize,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },
    /// An initial member has the wrong length or a value that is not finite.
    #[error("initial member {member} has {given} finite values, the problem has {wanted} variables")]
    Initial {
        /// Index of the member.
        member: usize,
        /// Number of finite values given.
        given: usize,
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
        "reference direction {index} has {sound} values not below 0, {wanted} are needed, finite and not all 0"
    )]
    Direction {
        /// Index of the direction.
        index: usize,
        /// Number of values that are not below 0.
        sound: usize,
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

/// How many violations of single constraints members need.
fn needed(members: usize, constraints: Option<usize>) -> String {
    let total = constraints.map(|constraints| members.saturating_mul(constraints));
    total.map_or_else(|| format!("a multiple of {members}"), |total| total.to_string())
}
