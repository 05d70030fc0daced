//! What other programs are to draw of a log when they open the log itself.

use std::path::{Path, PathBuf};

use thiserror::Error;

use super::{super::report::analyse, Inputs};
use crate::{
    log::{
        Contents, DrawnTopic, Line, LineRole, Lines, LogError, LogFiles, ReadOptions, Recording, SignalRole,
        TimeBase, WantedSignal, contents, read_recording, recording_files,
    },
    remark::{Code, Remarks},
    replay::Rules,
    series::{JointKind, Track},
    units::NS_PER_S,
};

/// The program that draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum For {
    /// Foxglove, and Lichtblick.
    Foxglove,
    /// Rerun.
    Rerun,
}

/// Why there is nothing to draw.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message says what each field is")]
pub enum ChartsFailure {
    #[error(transparent)]
    Log(#[from] LogError),
    #[error("{} is {what}, which {program} does not open; {fix}", path.display())]
    Unopened { path: PathBuf, what: &'static str, program: &'static str, fix: String },
    #[error(
        "{} has its joints in messages of no form that is known, of which no line can be told to another program; {fix}",
        path.display()
    )]
    OnlyByWords { path: PathBuf, fix: String },
}

/// What a chart shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[expect(missing_docs, reason = "the names say it")]
pub enum Shown {
    Position,
    Error,
    Speed,
    Valve,
    Pressure,
    Effort,
}

/// Lines on one axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// What they are.
    pub shown: Shown,
    /// The joint; `None` if there is a line a joint.
    pub joint: Option<String>,
    /// Whether their joints turn or slide.
    pub kind: JointKind,
    /// The lines.
    pub lines: Vec<Line>,
}

/// The start with the largest error.
#[derive(Debug, Clone, PartialEq)]
pub struct Worst {
    /// Its joint.
    pub joint: String,
    /// When the plan starts, s since the first sample.
    pub at_s: f64,
    /// What to look at, s since the first message of the log.
    pub window_s: [f64; 2],
}

/// All charts of a log.
#[derive(Debug, Clone, PartialEq)]
pub struct Charts {
    /// Names of its files.
    pub files: Vec<String>,
    /// Topics of the lines.
    pub topics: Vec<DrawnTopic>,
    /// By what they show, then by joint.
    pub charts: Vec<Chart>,
    /// Topics with descriptions of the robot, if the log also says where its frames are.
    pub descriptions: Vec<String>,
    /// The start to look at first.
    pub worst: Option<Worst>,
    /// Whether times are those of the headers.
    pub by_header: bool,
    /// Doubts about the data.
    pub remarks: Remarks,
}

/// Before the worst start, s.
const BEFORE_S: f64 = 1.0;
/// After it, s, unless its error takes longer.
const AFTER_S: f64 = 3.0;

/// Finds what there is to draw of a log, and where in its messages it is.
///
/// # Errors
///
/// [`ChartsFailure`] if one of the programs does not open the log, or it holds nothing that could be drawn.
pub fn charts(inputs: &Inputs, programs: &[For]) -> Result<Charts, ChartsFailure> {
    for program in programs {
        for file in recording_files(&inputs.logs, &mut Remarks::default())? {
            opens(&file, *program)?;
        }
    }
    // Other programs see what was logged: lengths of cylinders stay lengths.
    let read = ReadOptions {
        sides: crate::log::Sides::Any,
        signals: vec![WantedSignal { role: SignalRole::Command, topic: inputs.command.clone() }],
        cylinders: None,
        ..inputs.read.clone()
    };
    let lines = LogFiles::with(inputs.logs.iter().cloned(), &read)?.lines(&read);
    let mut lines = lines.map_err(|error| only_by_words(inputs).unwrap_or(error.into()))?;
    let mut remarks = Remarks::default();
    let recording =
        match std::mem::replace(&mut lines.recording, Err(LogError::NotLookedAt { logs: String::new() })) {
            Ok(recording) => Some(recording),
            // What the caller named must be there.
            Err(error) if inputs.command.is_some() => return Err(error.into()),
            Err(_) => None,
        };
    let worst = recording.as_ref().and_then(|recording| worst(recording, lines.begins_ns));
    if let Some(recording) = &recording {
        remarks.extend(recording.remarks.clone().without(Code::PlanIsCommand));
    }
    remark(&lines, &mut remarks);
    let kind = |joint: &str| {
        let track = |recording: &Recording| {
            let track = recording.measured.track(joint).or_else(|| recording.planned.track(joint));
            track.map(Track::kind)
        };
        let asked = inputs.read.slides.contains_key(joint);
        let found = recording.as_ref().and_then(track);
        found.unwrap_or(if asked { JointKind::Slides } else { JointKind::Turns })
    };
    Ok(Charts {
        charts: sorted(&lines.lines, kind),
        files: lines.files,
        topics: lines.topics,
        descriptions: if lines.transforms { lines.descriptions } else { Vec::new() },
        worst,
        by_header: recording.is_some_and(|recording| recording.source.time_base == TimeBase::Header),
        remarks,
    })
}

/// Whether a program opens a file. What is no file, such as an address, is judged where it is read.
fn opens(file: &Path, program: For) -> Result<(), ChartsFailure> {
    let found = match contents(file) {
        Err(_) | Ok(Contents::Log { .. }) => return Ok(()),
        Ok(found) => found,
    };
    let import = import(file);
    let (what, fix) = match found {
        Contents::Recording(what) if program == For::Foxglove && what.starts_with("a database") => {
            return Ok(());
        }
        Contents::Recording(what) => {
            (what, "convert it to MCAP, for example with `ros2 bag convert`".to_owned())
        }
        Contents::Table(_) | Contents::Parquet(_) => ("a table", import),
        // What is nothing is said where it is read.
        _ => return Ok(()),
    };
    let program = match program {
        For::Foxglove => "Foxglove",
        For::Rerun => "Rerun",
    };
    Err(ChartsFailure::Unopened { path: file.to_owned(), what, program, fix })
}

/// What to do with a log without lines that is read by the words of its fields; `None` if it is not.
fn only_by_words(inputs: &Inputs) -> Option<ChartsFailure> {
    let path = inputs.logs.first()?;
    read_recording(&inputs.logs, &inputs.read).ok()?;
    let fix = import(path);
    Some(ChartsFailure::OnlyByWords { path: path.clone(), fix })
}

/// The line that makes a log of what other programs do not read.
fn import(path: &Path) -> String {
    format!("make a log of it with `hydrotrace import {} -o run.mcap`", crate::text::shell_argument(path))
}

fn remark(lines: &Lines, remarks: &mut Remarks) {
    let count = |topics: &[String]| topics.len() as u64;
    let message = format!(
        "the plan of {} is whole trajectories, which other programs do not draw over time; `hydrotrace export LOG -o \
         run.csv` and `hydrotrace import run.csv -o run.mcap` make a log with its samples",
        lines.trajectories.join(", ")
    );
    remarks.add(Code::NotSupported, count(&lines.trajectories), message);
    let message = format!(
        "the joints of {} change places from message to message, so that no place is one joint's; not drawn",
        lines.unsteady.join(", ")
    );
    remarks.add(Code::JointsChange, count(&lines.unsteady), message);
}

fn worst(recording: &Recording, begins_ns: u64) -> Option<Worst> {
    let analysis = analyse(recording, &Rules::default(), &mut Remarks::default());
    let start = analysis.replay.worst_first().into_iter().next()?;
    let begins_ns = i64::try_from(begins_ns).ok()?;
    let offset_s = recording.source.epoch_ns.checked_sub(begins_ns)? as f64 / NS_PER_S;
    let at_s = start.planned_onset_s;
    let after_s = (2.0 * start.time_to_peak_s).max(AFTER_S);
    let window_s = [at_s - BEFORE_S, at_s + after_s].map(|t_s| t_s + offset_s);
    Some(Worst { joint: start.joint.clone(), at_s, window_s })
}

/// Puts lines that belong together on one axis.
fn sorted(lines: &[Line], kind: impl Fn(&str) -> JointKind) -> Vec<Chart> {
    let mut charts: Vec<Chart> = Vec::new();
    for line in lines {
        let kind = kind(&line.joint);
        let (shown, apart) = match line.role {
            LineRole::Planned | LineRole::Measured | LineRole::Command => (Shown::Position, true),
            LineRole::PlannedSpeed | LineRole::MeasuredSpeed => (Shown::Speed, true),
            LineRole::CapPressure | LineRole::RodPressure | LineRole::SupplyPressure => {
                (Shown::Pressure, true)
            }
            LineRole::Error => (Shown::Error, false),
            LineRole::Valve => (Shown::Valve, false),
            LineRole::Effort => (Shown::Effort, false),
        };
        let joint = apart.then(|| line.joint.clone());
        let same = |chart: &&mut Chart| (chart.shown, &chart.joint, chart.kind) == (shown, &joint, kind);
        match charts.iter_mut().find(same) {
            Some(chart) => chart.lines.push(line.clone()),
            None => charts.push(Chart { shown, joint, kind, lines: vec![line.clone()] }),
        }
    }
    charts.sort_by_key(|chart| chart.shown);
    charts
}
