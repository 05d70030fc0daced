//! Why a CSV file does not become a log.

use std::path::PathBuf;

use thiserror::Error;

use crate::{log::WriteError, suggest::suggestion};

/// Why a CSV file does not become a log. Lines and columns count from 1.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CsvError {
    /// The file system said no.
    #[error("cannot open {}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The file is something else.
    #[error("{file} is no CSV file: {found}; {fix}")]
    NotText {
        /// The file.
        file: String,
        /// What it is.
        found: String,
        /// What to do.
        fix: &'static str,
    },
    /// The file has no two rows of as many cells, or no numbers in them.
    #[error(
        "found no table of numbers in {file}: {found}; two columns or more are expected; if the cells are \
         separated by something else, say --separator CHAR"
    )]
    NoTable {
        /// The file.
        file: String,
        /// What was found.
        found: String,
    },
    /// A column that the caller named.
    #[error(
        "no column {column:?} (for {option}){}; the columns are {present}",
        suggestion(nearest.as_deref())
    )]
    NoColumn {
        /// The column looked for.
        column: String,
        /// What named it.
        option: String,
        /// A column of nearly that name.
        nearest: Option<String>,
        /// The columns.
        present: String,
    },
    /// A header that the caller named stands over several columns.
    #[error(
        "column {column:?} (for {option}) occurs {count} times; say which one by its number, such as #{first}"
    )]
    SameHeader {
        /// The header.
        column: String,
        /// What named it.
        option: String,
        /// How often it occurs.
        count: usize,
        /// Number of the first.
        first: usize,
    },
    /// Two columns would be the same angle.
    #[error("columns {columns} both look like the {what} of {joint}; say which with {option} {joint}=#N,...")]
    Twice {
        /// Headers and numbers of both.
        columns: String,
        /// Such as "planned position".
        what: String,
        /// The joint.
        joint: String,
        /// The option that decides.
        option: &'static str,
    },
    /// One column is named for two things.
    #[error("column {column:?} (#{number}) is named for two things; one column is one angle of one joint")]
    SameColumn {
        /// Its header.
        column: String,
        /// Its number.
        number: usize,
    },
    /// No column is a joint's angle.
    #[error(
        "no column looks like a joint angle; the columns are {present}; name them with \
         --planned JOINT=COLUMN,... and --measured JOINT=COLUMN,..., or in a file with --map"
    )]
    NoJoints {
        /// The columns.
        present: String,
    },
    /// Planned and measured columns are of different joints.
    #[error(
        "the planned columns are of {planned}, the measured ones of {measured}: no joint has both; say \
         --planned JOINT=COLUMN,... and --measured JOINT=COLUMN,... with the same joints"
    )]
    NoPair {
        /// Planned joints.
        planned: String,
        /// Measured joints.
        measured: String,
    },
    /// An interface of a joint that the log does not have.
    #[error("interface {interface:?} names the joint {joint:?}{}; the joints are {present}", suggestion(nearest.as_deref()))]
    NoJoint {
        /// The interface.
        interface: String,
        /// The joint.
        joint: String,
        /// A joint of nearly that name.
        nearest: Option<String>,
        /// The joints.
        present: String,
    },
    /// There is no time.
    #[error(
        "no column looks like a time{why}; the columns are {present}; say --time COLUMN, or --rate HZ if there is none"
    )]
    NoTime {
        /// What is wrong with those that do, or nothing.
        why: String,
        /// The columns.
        present: String,
    },
    /// A column of time that does not say its unit.
    #[error(
        "column {column:?} counts time in steps of {step}; say in what with --time-unit s|ms|us|ns, or give --rate HZ"
    )]
    TimeUnit {
        /// The column.
        column: String,
        /// The usual step.
        step: f64,
    },
    /// Angles that say no unit and fit none.
    #[error(
        "column {column:?} says no unit and reaches {reach}, too far for radians; say --degrees or --radians"
    )]
    AngleUnit {
        /// The column.
        column: String,
        /// Its largest value.
        reach: f64,
    },
    /// A column in a unit of something else.
    #[error(
        "column {column:?} is in {unit}, which is no {expected}; map another column or correct its header"
    )]
    WrongUnit {
        /// The column.
        column: String,
        /// The unit it states.
        unit: String,
        /// Such as "angle".
        expected: &'static str,
    },
    /// A column that is used and mostly holds no numbers.
    #[error(
        "{numbers} cells of column {column:?} are numbers with a decimal {decimal}, {bad} are not{example}; {fix}"
    )]
    NoNumbers {
        /// The column.
        column: String,
        /// Cells with a number.
        numbers: u64,
        /// "comma" or "point".
        decimal: &'static str,
        /// Cells with something else.
        bad: u64,
        /// What these hold, and where.
        example: String,
        /// What to try.
        fix: &'static str,
    },
    /// Most rows have no time.
    #[error(
        "{stamped} rows have a time between 1970 and 2038 in column {column:?}, {bad} have none{example}; {fix}"
    )]
    NoStamps {
        /// The column.
        column: String,
        /// Rows with a time.
        stamped: u64,
        /// Rows without.
        bad: u64,
        /// What these hold, and where.
        example: String,
        /// What to try.
        fix: &'static str,
    },
    /// A value of an option.
    #[error("{option} {found}: {expected} is expected")]
    Option {
        /// The option.
        option: &'static str,
        /// What was given.
        found: String,
        /// What is expected.
        expected: &'static str,
    },
    /// The map file.
    #[error("cannot use the map {}: {reason}", path.display())]
    MapFile {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// The log cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}
