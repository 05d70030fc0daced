//! `join`: adds the plan to the log of a run that holds command and measurement, or writes the files of one run as one.

mod document;
mod gain;
mod gather;
mod place;

use std::path::{Path, PathBuf};

use thiserror::Error;

pub use document::Joined;
pub use gather::{Gathered, gather};

use super::carried::{
    plan_log::states,
    rest::{RUN_LEAD_S, RUN_TAIL_S},
    stamp::instants,
};
use crate::{
    document::PROGRAM,
    log::{
        Addition, LogError, LogFiles, PlanSample, ReadOptions, RecordedIn, Recording, Sides, SignalRole,
        TimeBase, Topics,
    },
    remark::Code,
    series::{Series, Track},
    text::shell_argument,
    units::{DEGREE_RAD, nanoseconds},
};
use place::Plan;

/// Run, plan and output of a join.
#[derive(Debug, Clone, Default)]
pub struct Inputs {
    /// Files or bag directories of one run.
    pub logs: Vec<PathBuf>,
    /// The log with the plan, and with the command that was made for it.
    pub plan: PathBuf,
    /// Topics of the run; its plan is the command.
    pub read: ReadOptions,
    /// When the first sample of the plan was sent, s from the start of the run's log; `None`: found by what
    /// was sent.
    pub at_s: Option<f64>,
    /// The log to write.
    pub output: PathBuf,
}

impl Inputs {
    /// An error for an output among the files of a folder that is read: it would be one of them the next time.
    fn check_output(&self) -> Result<(), JoinFailure> {
        let folder = self.output.parent().filter(|folder| !folder.as_os_str().is_empty());
        let folder = folder.unwrap_or(Path::new("."));
        let within = |log: &&PathBuf| {
            log.is_dir()
                && log.canonicalize().is_ok_and(|log| folder.canonicalize().is_ok_and(|out| out == log))
        };
        match self.logs.iter().find(within) {
            Some(log) => Err(JoinFailure::Inside { log: log.clone(), output: self.output.clone() }),
            None => Ok(()),
        }
    }
}

/// Why a plan was not joined.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message says what each field is")]
pub enum JoinFailure {
    #[error(transparent)]
    Log(#[from] LogError),
    #[error(
        "{} is in {}, which is read as one recording, and would be a part of it from then on; write it elsewhere",
        output.display(),
        log.display()
    )]
    Inside { log: PathBuf, output: PathBuf },
    /// The log does not hold what was sent, so the start of the plan is unknown.
    #[error(
        "the log of the run does not say what was sent, so that the start of its plan is unknown; name what was \
         sent, as below, or give the time of the plan's first sample with --at SECONDS"
    )]
    NothingSent(#[source] LogError),
    #[error(
        "the plan in {} is nowhere in what was sent on {topic}: no common joint, no motion, or a log that \
         holds too little of it; --planned names another topic, --at SECONDS the time",
        plan.display()
    )]
    Nowhere { plan: PathBuf, topic: String },
    #[error(
        "{joint} is a length in one of the log and {}, and an angle in the other: say --slides {joint} if it slides (in m; with =mm behind it \
         in mm), or, of joints with cylinders, give the plan in lengths, as `hydrotrace export PLAN --hydraulics FILE --as cylinders -o plan.csv` makes it",
        plan.display()
    )]
    OtherKind { plan: PathBuf, joint: String },
    #[error(
        "what was sent on {topic} is not what {} holds: where it fits best, at {at_s:.2} s, it leaves {:.0} % of \
         the motion (10 % at most); --planned names another topic, --at SECONDS the time",
        plan.display(), 100.0 * share
    )]
    SentOtherwise { plan: PathBuf, topic: String, at_s: f64, share: f64 },
    #[error(
        "what was sent on {topic} is the plan of {} with about {:.0} % of the correction of its command: another command of that plan was sent, \
         such as one of another --gain, and what it promised is another; give the log that was sent",
        plan.display(), 100.0 * share
    )]
    OtherShare { plan: PathBuf, topic: String, share: f64 },
    #[error(
        "what was sent on {topic} lasts {} than in {} by 3 % or more: no clocks are so far apart; was the plan run at another speed \
         (override), or are the times of the recording in another unit?",
        if *longer { "longer" } else { "shorter" },
        plan.display()
    )]
    OtherPace { plan: PathBuf, topic: String, longer: bool },
    #[error(
        "the log measures {measured} and the plan in {} moves {planned}: no joint of both; a plan whose joints have the names of the log is \
         needed, or a recording with those of the plan (of a table: hydrotrace import --measured JOINT=COLUMN)",
        plan.display()
    )]
    OtherJoints { plan: PathBuf, measured: String, planned: String },
    #[error(
        "a log is joined as it was recorded, in lengths of cylinders, and the plan beside it would be in angles: leave out \
         --hydraulics and give a plan in lengths; `hydrotrace export PLAN --hydraulics FILE --as cylinders` makes one"
    )]
    Cylinders,
    #[error(
        "the plan covers {:.2} to {:.2} s, the measurement {:.2} to {:.2} s: they have no time in common, as of two clocks, and no \
         report could be made; `hydrotrace join MEASUREMENT --plan PLAN --at SECONDS -o {}` puts the plan's first sample at \
         SECONDS of the measurement",
        planned_s[0], planned_s[1], measured_s[0], measured_s[1], shell_argument(output)
    )]
    Apart { planned_s: [f64; 2], measured_s: [f64; 2], output: PathBuf },
    #[error("the plan in {} lasts {duration_s:.0} s, {LONGEST_S} s are the most", plan.display())]
    TooLong { plan: PathBuf, duration_s: f64 },
    #[error("--at {at_s} puts the plan at {at_s:.2} to {:.2} s, outside the measurement, {:.2} to {:.2} s",
        at_s + duration_s, measured_s[0], measured_s[1])]
    Outside { at_s: f64, duration_s: f64, measured_s: [f64; 2] },
}

/// Longest plan, s.
const LONGEST_S: f64 = 36_000.0;
/// Joints within this angle of where they were rest, rad.
const RESTS_RAD: f64 = 0.05 * DEGREE_RAD;
/// Samples a second of the plan in the new log.
const RATE_HZ: f64 = 100.0;

/// Whether a file is a plan that can be joined.
///
/// # Errors
///
/// [`JoinFailure`]
pub fn check_plan(path: &Path) -> Result<(), JoinFailure> {
    read_plan(path).map(|_| ())
}

fn read_plan(path: &Path) -> Result<Plan, JoinFailure> {
    let plan = Plan::read(path)?;
    let [from_s, to_s] = plan.span_s();
    if to_s - from_s > LONGEST_S {
        return Err(JoinFailure::TooLong { plan: path.to_owned(), duration_s: to_s - from_s });
    }
    Ok(plan)
}

/// An error where the log measures no joint of the plan.
fn check_joints(plan: &Plan, measured: &Series, path: &Path) -> Result<(), JoinFailure> {
    if plan.planned.tracks.iter().any(|track| measured.track(track.name()).is_some()) {
        return Ok(());
    }
    let names = |series: &Series| series.tracks.iter().map(Track::name).collect::<Vec<_>>().join(", ");
    let (measured, planned) = (names(measured), names(&plan.planned));
    Err(JoinFailure::OtherJoints { plan: path.to_owned(), measured, planned })
}

/// Adds the plan at the time at which its command was sent.
///
/// # Errors
///
/// [`JoinFailure`], naming what is missing; nothing is written then.
pub fn run(inputs: &Inputs) -> Result<Joined, JoinFailure> {
    inputs.check_output()?;
    if inputs.read.cylinders.is_some() {
        return Err(JoinFailure::Cylinders);
    }
    let plan = read_plan(&inputs.plan)?;
    let files = LogFiles::with(inputs.logs.iter().cloned(), &inputs.read)?;
    let log = files.scan()?;
    // The measurement is enough if the caller says when the plan began.
    let sides = if inputs.at_s.is_some() { Sides::MeasurementAtLeast } else { Sides::Both };
    let run = log
        .read(&ReadOptions { sides, ..inputs.read.clone() }.wanting(&[SignalRole::Command]))
        .map_err(|error| match error {
            LogError::Missing { missing: "planned", .. } => JoinFailure::NothingSent(error),
            other => other.into(),
        })?;
    check_joints(&plan, &run.measured, &inputs.plan)?;
    // A run that was read without a plan has none.
    let sent = (!run.planned.tracks.is_empty()).then_some(&run.planned);
    let topic = format!("{}:{}", run.source.planned_topic, run.source.planned_field);
    // A missing plan is the reason for the join, no doubt.
    let mut remarks = run.remarks.clone().without(Code::PlanIsCommand).without(Code::OneSide);
    let [from_s, to_s] = plan.span_s();
    let (commanded, located) = match inputs.at_s {
        None => {
            let (commanded, found) = plan.place(&run.planned, &inputs.plan, &topic, &mut remarks)?;
            (commanded, Some(found))
        }
        Some(at_s) => (plan.commanded_at(sent, at_s - from_s, &inputs.plan, &topic, &mut remarks)?, None),
    };
    // The run's time at which the plan's own is 0.
    let zero_s = located.map_or_else(|| inputs.at_s.unwrap_or(0.0) - from_s, |located| located.at_s);
    // A table of set value and angle tells the plan, and what was sent for it is in its file.
    let is_plan = !commanded && !run.plan_is_command && run.source.planned_topic == Topics::default().planned;
    let keeps_plan = is_plan && plan.command.is_some() && located.is_some_and(|found| place::is_same(&found));
    if keeps_plan {
        remarks = remarks.without(Code::SentOtherwise);
        if let Some(command) = &run.command {
            plan.check_command(&command.series, &inputs.plan, &command.topic)?;
        }
    }
    // A table calls what was sent its plan.
    let replaces_plan =
        commanded && plan.command.is_some() && run.source.planned_topic == Topics::default().planned;
    let (start_s, end_s) = (zero_s + from_s, zero_s + to_s);
    let measured_s = run.measured.span_s().unwrap_or_default();
    if inputs.at_s.is_some() && (start_s > measured_s[1] || end_s < measured_s[0]) {
        return Err(JoinFailure::Outside { at_s: start_s, duration_s: to_s - from_s, measured_s });
    }
    let rest_s = sent.map_or([0.0; 2], |sent| rests_s(sent, [start_s, end_s], measured_s));
    // As logged if it differs from the made one, else as made: the log may be coarser.
    let otherwise = located.is_some_and(|found| !place::is_same(&found));
    let command = match (commanded, &plan.command, sent) {
        (_, _, Some(sent)) if otherwise => (sent, 0.0),
        (_, Some(command), _) if commanded || keeps_plan => (command, zero_s),
        _ => (&plan.planned, zero_s),
    };
    let names: Vec<&str> = plan.planned.tracks.iter().map(Track::name).collect();
    let begin_s = start_s - rest_s[0];
    let samples = instants(end_s + rest_s[1] - begin_s, RATE_HZ)
        .map(|t_s| t_s + begin_s)
        .filter(|t_s| (measured_s[0]..=measured_s[1]).contains(t_s))
        .map(|t_s| PlanSample {
            stamp_ns: run.source.epoch_ns + nanoseconds(t_s),
            planned: states(&plan.planned, &names, t_s - zero_s),
            command: states(command.0, &names, t_s - command.1),
        })
        .collect();
    let received = (run.source.time_base == TimeBase::Header).then_some(run.source.recorder_delay_s);
    // Later readers count from the first measurement: nothing else that they use is earlier.
    let starts_s = zero_s + plan.carried.starts_s().unwrap_or(0.0) - measured_s[0];
    let carried = plan.carried.with_starts_s(starts_s);
    let addition = Addition {
        joints: names.clone(),
        samples,
        log_delay_ns: received.flatten().map_or(0, |[middle_s, _]| nanoseconds(middle_s)),
        keeps_plan,
        replaces_plan,
        sent: sent
            .filter(|_| !keeps_plan && !replaces_plan)
            .map(|_| [run.source.planned_topic.as_str(), run.source.planned_field.as_str()]),
        recorded: recorded_in(&run, &inputs.read),
        files: carried.files(),
        metadata: carried.metadata(),
    };
    let messages = log.join(&addition, &inputs.output)?;
    Ok(Joined {
        format: document::FORMAT.to_owned(),
        program: PROGRAM.to_owned(),
        sent: located.map(|_| topic),
        sent_is_command: commanded,
        keeps_plan,
        at_s: start_s,
        rms_difference_rad: located.map(|found| found.rms_rad),
        other_places: located.map(|found| found.others),
        duration_s: to_s - from_s,
        rest_before_s: rest_s[0],
        rest_after_s: rest_s[1],
        joints: names.len(),
        messages,
        files: carried.names(),
        remarks,
        located,
        kinds: plan.planned.tracks.iter().map(Track::kind).collect(),
    })
}

/// In what the topics of a run are, as the caller says.
fn recorded_in(run: &Recording, read: &ReadOptions) -> RecordedIn {
    let mut recorded = RecordedIn { lengths: read.slides.clone(), ..RecordedIn::default() };
    if read.planned_in_degrees {
        recorded = recorded.with_degrees(&run.source.planned_topic).with_degrees(&Topics::default().command);
    }
    if read.measured_in_degrees {
        recorded = recorded.with_degrees(&run.source.measured_topic);
    }
    recorded
}

/// How long the command rests before and after a plan, as far as is measured, s.
fn rests_s(sent: &Series, [start_s, end_s]: [f64; 2], measured_s: [f64; 2]) -> [f64; 2] {
    [
        rest_s(sent, start_s, -1.0, RUN_LEAD_S.min(start_s - measured_s[0])),
        rest_s(sent, end_s, 1.0, RUN_TAIL_S.min(measured_s[1] - end_s)),
    ]
}

/// How long the command rests before or after an instant, s.
fn rest_s(sent: &Series, at_s: f64, direction: f64, most_s: f64) -> f64 {
    let rests = |away_s: &f64| {
        sent.tracks.iter().all(|track| {
            let away_rad = track.held_at(at_s + direction * away_s).position - track.held_at(at_s).position;
            away_rad.abs() < RESTS_RAD
        })
    };
    instants(most_s.max(0.0), RATE_HZ).take_while(rests).last().unwrap_or(0.0)
}
