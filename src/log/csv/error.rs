//! Why a CSV file does not become a log.

use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::{
    log::{WriteError, unread::with_path},
    suggest::suggestion,
    text::{shell_argument, shell_word},
};

/// Why a CSV file does not become a log. Lines and columns count from 1.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message says what each field is")]
pub enum CsvError {
    #[error("cannot open {}", path.display())]
    File { path: PathBuf, source: std::io::Error },
    #[error("{file} is no CSV file: {found}; {}", with_path(fix, file))]
    NotText { file: String, found: String, fix: &'static str },
    #[error(
        "found no table of numbers in {file}: {found}; two columns or more are expected; if the cells are \
         separated by something else, say --separator CHAR"
    )]
    NoTable { file: String, found: String },
    #[error(
        "no column {column:?} (for {option}){}; the columns are {present}",
        suggestion(nearest.as_deref())
    )]
    NoColumn { column: String, option: String, nearest: Option<String>, present: String },
    #[error(
        "column {column:?} (for {option}) occurs {count} times; say which one by its number, such as #{first}"
    )]
    SameHeader { column: String, option: String, count: usize, first: usize },
    #[error("columns {columns} both look like the {what} of {joint}; say which with {option} {joint}=#N,...")]
    Twice { columns: String, what: String, joint: String, option: &'static str },
    #[error("column {column:?} (#{number}) is named for two things; one column is one angle of one joint")]
    SameColumn { column: String, number: usize },
    #[error(
        "column {column:?} tells several machines apart ({known}), and a log is of one; say which with \
         --only '{column}={first}', or --only '{column}=*' if all rows are of one"
    )]
    Machines { column: String, known: String, first: String },
    #[error("no row has {value:?} in column {column:?}; there are {known}")]
    NoMachine { column: String, value: String, known: String },
    #[error(
        "no column looks like a joint angle{why}; the columns are {present}; name them with \
         --planned JOINT=COLUMN,... and --measured JOINT=COLUMN,..., or in a file with --map"
    )]
    NoJoints { why: String, present: String },
    #[error(
        "column {column:?} is in {unit}, which is no angle or length; say what one is with \
         --planned JOINT=FACTOR*COLUMN,... --measured JOINT=FACTOR*COLUMN,... --degrees, or --slides JOINT=mm of a joint \
         that slides"
    )]
    OddUnit { column: String, unit: &'static str },
    #[error(
        "the planned columns are of {planned}, the measured ones of {measured}: no joint has both; say \
         --planned JOINT=COLUMN,... and --measured JOINT=COLUMN,... with the same joints"
    )]
    NoPair { planned: String, measured: String },
    #[error(
        "planned columns are of {planned}, measured ones of {measured}: they are counted from different numbers; say which belong together, \
         such as {}",
        options.join(" ")
    )]
    NumberedApart { planned: String, measured: String, options: Vec<String> },
    /// An orientation beside a position without a unit.
    #[error(
        "columns qx, qy, qz and qw are the orientation of a tool, and its position says no unit: write it into the headers of x, y and z, \
         such as x_m or x_mm"
    )]
    PoseUnit,
    #[error(
        "columns qx, qy, qz and qw are the orientation of a tool, and no column is its position: no joint of an arm; give those of x, y and z, \
         with their unit, too"
    )]
    OrientationAlone,
    #[error("{what} names the joint {joint:?}{}; the joints are {present}", suggestion(nearest.as_deref()))]
    NoJoint { what: String, joint: String, nearest: Option<String>, present: String },
    #[error(
        "no column looks like a time{why}; the columns are {present}; {}",
        if let Some(time) = by_number.first() {
            let rises = time.strip_prefix("--time ").map(|column| format!(" ({} rises from row to row as a time does; which of two columns is the plan is a guess, for the measured one follows it)", column.trim_matches('\'')));
            format!("name columns by their number, such as {}{}", by_number.join(" "), rises.unwrap_or_default())
        } else if why.is_empty() { "say --time COLUMN, or --rate HZ if there is none".to_owned() }
        else { "rows of one instant may be of several joints: call the column that names the joint \"joint\"; else say --rate HZ if a row comes HZ times a second, or --time COLUMN".to_owned() }
    )]
    NoTime { why: String, present: String, by_number: Vec<String> },
    #[error(
        "column {column:?} counts time in steps of {step}; say in what with --time-unit s|ms|us|ns|min|h, or give --rate HZ"
    )]
    TimeUnit { column: String, step: f64 },
    #[error(
        "column {column:?} {says} and reaches {}, too far for radians; say --degrees, --radians, or \
         --slides JOINT=mm of a joint that slides{}",
        reach.round(),
        if says.contains("known") {
            "; or what one is with --planned JOINT=FACTOR*COLUMN,... --measured JOINT=FACTOR*COLUMN,... --degrees"
        } else {
            ""
        }
    )]
    AngleUnit { column: String, says: String, reach: f64 },
    #[error(
        "column {column:?} {says} and reaches {}, too far for degrees, too: is it in steps of an encoder? Say what \
         one is with --planned JOINT=FACTOR*COLUMN,... --measured JOINT=FACTOR*COLUMN,... --degrees, or --slides \
         JOINT=mm of a joint that slides; --planned and --measured that name the other columns leave it out",
        reach.round()
    )]
    Counts { column: String, says: String, reach: f64 },
    /// A recording cannot look at what is to come.
    #[error(
        "column {column:?} says no unit, and a recording cannot tell by what is to come; say --degrees, --radians, \
         or --slides JOINT=mm of a joint that slides"
    )]
    NoUnit { column: String },
    /// What only a whole table tells.
    #[error(
        "what comes has {had}, which is understood of whole tables only: save the lines in a file, and `hydrotrace import` it; or say \
         with --time, --planned and --measured which columns count"
    )]
    NotByRows { had: &'static str },
    #[error(
        "the header, line {line}, has {names} names and every row has {cells} cells: which of them has no name cannot be \
         told; correct the header, or name columns by their number, such as --time '#1' --planned 'JOINT=#2' \
         --measured 'JOINT=#3'"
    )]
    ShortHeader { line: u64, names: usize, cells: usize },
    #[error(
        "line {line} is a header with other columns than line {first}: what is below it has another meaning; give the rows \
         above and below it as two files{}",
        two_files(file, *line)
    )]
    AnotherHeader { file: String, line: u64, first: u64 },
    #[error(
        "column {column:?} is in {unit}, which is no {expected}; map another column or correct its header"
    )]
    WrongUnit { column: String, unit: String, expected: &'static str },
    #[error("{text:?} adds {} to {}; columns of one unit are expected", units[0], units[1])]
    MixedUnits { text: String, units: [String; 2] },
    #[error(
        "the columns of {joint} are in {} and in {}; a joint turns (rad, deg) or slides (m, cm, mm)",
        units[0], units[1]
    )]
    MixedKinds { joint: String, units: [String; 2] },
    #[error(
        "{numbers} cells of column {column:?} are numbers with a decimal {decimal}, {bad} are not{example}; {fix}"
    )]
    NoNumbers {
        column: String,
        numbers: u64,
        decimal: &'static str,
        bad: u64,
        example: String,
        fix: &'static str,
    },
    #[error(
        "{stamped} rows have a time between 1970 and 2038 in column {column:?}, {bad} have {have}{example}; {fix}"
    )]
    NoStamps {
        column: String,
        stamped: u64,
        bad: u64,
        have: &'static str,
        example: String,
        fix: &'static str,
    },
    #[error(
        "column {column:?} has single numbers and, in line {line}, {cell}, which is none with a decimal {decimal}: a negative one is expected \
         to be of one number, such as (1{}5); write a sign, or say --decimal-{}",
        if *decimal == "comma" { ',' } else { '.' },
        if *decimal == "comma" { "point" } else { "comma" }
    )]
    Parentheses { column: String, line: u64, cell: String, decimal: &'static str },
    #[error("{option} {found}: {expected} is expected")]
    Option { option: &'static str, found: String, expected: &'static str },
    #[error("cannot use the map {}: {reason}", path.display())]
    MapFile { path: PathBuf, reason: String },
    #[error(transparent)]
    Write(#[from] WriteError),
}

impl CsvError {
    /// With the path of the file as it was given in the lines to type.
    pub(in crate::log) fn at(mut self, path: &Path) -> Self {
        if let Self::AnotherHeader { file, .. } | Self::NotText { file, .. } = &mut self {
            *file = path.to_string_lossy().into_owned();
        }
        self
    }

    /// The options that are missing most likely, and what an import with them does.
    pub(in crate::log) fn missing_options(&self) -> (Vec<String>, &'static str) {
        match self {
            Self::AngleUnit { .. } => (vec!["--degrees".to_owned()], "reads it if its angles are in degrees"),
            Self::NoTime { by_number, .. } if !by_number.is_empty() => {
                (by_number.clone(), "reads it if those columns are the right ones")
            }
            Self::NumberedApart { options, .. } => {
                (options.clone(), "reads it if the first of each side belong together")
            }
            Self::NoTime { .. } => {
                (vec!["--rate HZ".to_owned()], "reads it if a row comes HZ times a second")
            }
            Self::Machines { column, first, .. } => (
                vec![format!("--only {}", shell_word(&format!("{column}={first}")))],
                "reads the rows of the first",
            ),
            _ => (Vec::new(), "takes options for that"),
        }
    }
}

/// Lines that make two files of one that is no packed one, from a line on.
fn two_files(file: &str, line: u64) -> String {
    let path = Path::new(file);
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    if ["gz", "zst", "zstd"].contains(&ending.to_lowercase().as_str()) {
        return String::new();
    }
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let dot = if ending.is_empty() { "" } else { "." };
    let part = |number: u32| shell_argument(path.with_file_name(format!("{stem}-{number}{dot}{ending}")));
    let (whole, above) = (shell_argument(path), line.saturating_sub(1));
    format!(", by `head -n {above} {whole} > {}` and `tail -n +{line} {whole} > {}`", part(1), part(2))
}
