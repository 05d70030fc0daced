//! Errors of reading and writing a log.

use std::path::{Path, PathBuf};

use thiserror::Error;

use super::{
    csv::CsvError,
    import_line::Given,
    options::{ReadOptions, TimeBase},
    unread::with_path,
};
use crate::{arm::ArmError, suggest::suggestion, text::shell_argument};

/// Why a log cannot be read or written; doubts about parts of it are remarks.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message says what each field is")]
pub enum LogError {
    #[error("cannot {action} {}{}", path.display(), meant_as_output(path, source))]
    File { action: &'static str, path: PathBuf, source: std::io::Error },
    #[error("{} is empty: no log and no table is in it", path.display())]
    Empty { path: PathBuf },
    #[error(
        "{} is not an MCAP file: found {found}, expected the bytes 89 4D 43 41 50 30 0D 0A; {}{}",
        path.display(),
        what.map(|what| format!("it is {what}: ")).unwrap_or_default(),
        with_path(fix, path)
    )]
    NotMcap { path: PathBuf, found: String, what: Option<&'static str>, fix: &'static str },
    #[error("{} {}", path.display(), of_table(path, source, given))]
    Table { path: PathBuf, source: Box<CsvError>, given: Given },
    #[error(transparent)]
    Map(Box<CsvError>),
    #[error("cannot read {}: {reason}", path.display())]
    Form { path: PathBuf, reason: String },
    #[error("{} holds no .mcap or .db3 file; give a recording or a ROS 2 bag directory", path.display())]
    EmptyBag { path: PathBuf },
    #[error("{} is no rosbag2 description: {reason}", path.display())]
    BagMetadata { path: PathBuf, reason: String },
    #[error("no topic {topic:?}{}; the log has {present}", suggestion(nearest.as_deref()))]
    NoTopic { topic: String, nearest: Option<String>, present: String },
    /// Columns of a table where a topic is asked for.
    #[error(
        "{columns:?} are columns of a table, not a topic: name them when it is imported, and give the log: {fix}"
    )]
    ColumnsNamed { columns: String, fix: String },
    /// An option would convert a second time.
    #[error(
        "{option} would convert {header:?} of {file} a second time: it was read in {unit}; leave {option} out, and where \
         the header is wrong, put that right"
    )]
    ConvertedBefore { option: &'static str, header: String, unit: String, file: String },
    #[error(
        "topic {topic:?} ({type_name}) has no joint angles{}{}; it has {present}",
        field.as_ref().map(|f| format!(" in field {f:?}")).unwrap_or_default(),
        suggestion(nearest.as_deref())
    )]
    NoField {
        topic: String,
        type_name: Box<str>,
        field: Option<Box<str>>,
        nearest: Option<Box<str>>,
        present: String,
    },
    #[error(
        "topic {topic:?} gives {found}{}; it has {present}; name one of these as {topic}:CHILD@PARENT, as transforms \
         are not put together from others",
        suggestion(nearest.as_deref())
    )]
    NoTransform { topic: String, found: String, nearest: Option<Box<str>>, present: Box<str> },
    #[error(
        "the plan is {planned}, the measurement {measured}: poses are compared in one frame, that behind the @, and \
         transforms are not put together from others; name two of one frame with --planned and --measured; the log has \
         {present}"
    )]
    FramesApart { planned: Box<str>, measured: Box<str>, present: Box<str> },
    #[error(
        "{apart}: poses are compared in one frame; choose topics of one frame, or, if these are one frame by two names, \
         name both topics with --planned and --measured"
    )]
    PosesApart { apart: String },
    #[error("found no {missing} joint angles; the log has {present}; name them with {fix}")]
    Missing { missing: &'static str, present: String, fix: String },
    #[error(
        "not all of the log could be read: {damage}; `hydrotrace recover {} -o saved.mcap` saves what can be. Of what was read: {error}",
        shell_argument(path)
    )]
    Damaged { error: Box<Self>, damage: String, path: PathBuf },
    #[error(
        "planned joints ({planned}) and measured joints ({measured}) have no name in common; \
         choose other topics with --planned and --measured, or give a topic that carries no names those of its joints, in \
         the order of its numbers, with --joints={given}; columns of other names are paired by `hydrotrace import LOG -o run.mcap --planned \
         JOINT=COLUMN,... --measured JOINT=COLUMN,...`"
    )]
    NoCommonJoint { planned: String, measured: String, given: String },
    #[error(
        "planned joints ({planned}) and measured joints ({measured}) are counted from different numbers: by their names each would be \
         paired with its neighbour; `hydrotrace import LOG -o run.mcap` says the line that pairs them in their order; if the names are \
         right, say --joints {common}"
    )]
    NumberedApart { planned: String, measured: String, common: String },
    #[error(
        "{topic} holds poses of a tool, and the log no angles of joints: what is fitted and sent is of joints; `hydrotrace report` compares \
         poses, too"
    )]
    PosesAlone { topic: String },
    #[error(
        "the plan covers {:.2} to {:.2} s, the measurement {:.2} to {:.2} s: they have no time in common; {}",
        planned_s[0], planned_s[1], measured_s[0], measured_s[1],
        if *no_other_clock { "give a plan and a measurement of one run, with times that count from one instant" } else { "if their clocks differ, try --time log, or put the plan in its place: `hydrotrace join MEASUREMENT --plan PLAN --at SECONDS -o run.mcap`" }
    )]
    NoOverlap { planned_s: [f64; 2], measured_s: [f64; 2], no_other_clock: bool },
    #[error(
        "nothing of {topic} lies {range}: it spans {spans_s:.2} s; --from and --to count in seconds from the first \
         sample of the run, as the times of a report do"
    )]
    NothingInRange { topic: String, range: String, spans_s: f64 },
    #[error("only the index was read, not the messages; `hydrotrace info --check {logs}` reads all of them")]
    NotLookedAt { logs: String },
    #[error(
        "the messages of {topics} cannot be drawn as they are; `hydrotrace export LOG -o run.csv` and \
         `hydrotrace import run.csv -o run.mcap` make a log of which they can"
    )]
    NothingToDraw { topics: String },
    #[error(
        "{} and {} both have {topic} for the same {shared_s:.2} s and are no parts of one run; give the one that \
         counts, or put the plan of the other into it with `hydrotrace join`",
        files[0], files[1]
    )]
    ToldTwice { topic: String, files: [String; 2], shared_s: f64 },
    #[error(
        "{} and {} are {:.1} hours apart in {topic}: they are not of one run; give the files of one run, `hydrotrace compare` two runs, \
         `hydrotrace fleet` many, or put the plan of one into the other with `hydrotrace join`",
        files[0],
        files[1],
        apart_s / 3600.0
    )]
    Apart { topic: String, files: [String; 2], apart_s: f64 },
    #[error("{field} is given as plan and as measurement; their difference would be nothing")]
    SameField { field: String },
    #[error("no joint {joint:?}{}; the log has {present}", suggestion(nearest.as_deref()))]
    NoJoint { joint: String, nearest: Option<String>, present: String },
    #[error("joint {joint:?} is named twice; a joint counts once")]
    JointTwice { joint: String },
    #[error("the {clock} time of topic {topic:?} is zero or stands still; {}", other_clock(clock))]
    NoClock { clock: &'static str, topic: String },
    #[error("{} has a plan in {topic} already: `hydrotrace report` it as it is; or, if what it calls the plan is what was sent, import the recorder's table with `--command JOINT=COLUMN,...` in place of `--planned`, and join that", path.display())]
    Planned { path: PathBuf, topic: String },
    #[error(transparent)]
    Remote(#[from] super::remote::RemoteError),
    #[error(transparent)]
    Cylinders(#[from] Box<ArmError>),
    #[error(
        "found no joint of {file} ({joints}) in the log, which has {present}; expected a joint by its name there, or its \
         cylinder, such as boom_cylinder for boom: call it so in the file, or name the topics with --planned and \
         --measured"
    )]
    NoCylinder { file: String, joints: String, present: String },
    #[error(
        "{side} positions of {joint} run {:.4} to {:.4} {unit}, expected {:.4} to {:.4} {unit} by the triangle of its \
         cylinder: none is left; {hint}",
        found[0], found[1], expected[0], expected[1]
    )]
    NoTriangle {
        joint: Box<str>,
        side: &'static str,
        found: Box<[f64; 2]>,
        expected: Box<[f64; 2]>,
        unit: &'static str,
        hint: Box<str>,
    },
    #[error("nothing is left to save of {}, and nothing was written: {damage}", path.display())]
    NothingLeft { path: PathBuf, damage: String },
    #[error("cannot write the log {}", path.display())]
    Copy { path: PathBuf, source: Box<dyn std::error::Error + Send + Sync> },
}

impl LogError {
    /// Whether something is not there that may be where nothing could be read.
    pub(super) fn is_of_something_not_found(&self) -> bool {
        matches!(
            self,
            Self::Missing { .. }
                | Self::NoTopic { .. }
                | Self::NoField { .. }
                | Self::NoTransform { .. }
                | Self::NoJoint { .. }
                | Self::NoCommonJoint { .. }
                | Self::NoOverlap { .. }
        )
    }

    /// With the options that the caller gave to read it, for the line to type next.
    pub fn given(mut self, options: &ReadOptions) -> Self {
        if let Self::Table { given, .. } = &mut self {
            *given = Given::of(options);
        }
        self
    }

    /// Wraps an I/O failure; use with `map_err`.
    pub(super) fn file(action: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::File { action, path, source }
    }
}

/// What is the matter with a table, and what to do where options mend it.
fn of_table(path: &Path, source: &CsvError, given: &Given) -> String {
    if let CsvError::AnotherHeader { .. } = source {
        return "holds more than one table".to_owned();
    }
    let (missing, does) = source.missing_options();
    format!(
        "is a table that leaves something open; `{}` {does}, and the log that it writes is read as any other{}",
        given.line(path, &missing),
        given.rest()
    )
}

/// What to do where a clock does not run that was asked for.
fn other_clock(clock: &str) -> &'static str {
    if clock == TimeBase::Log.name() { "leave --time out" } else { "try --time log or leave it out" }
}

/// What to do where a page or a text was named among the logs, as after an option that takes no file.
fn meant_as_output(path: &Path, source: &std::io::Error) -> String {
    let of_output = path.extension().is_some_and(|end| end == "html" || end == "md" || end == "svg");
    let missing = source.kind() == std::io::ErrorKind::NotFound;
    if missing && of_output {
        format!("; to write it, say -o {}", shell_argument(path))
    } else {
        String::new()
    }
}
