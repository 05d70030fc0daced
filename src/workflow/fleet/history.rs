//! What the dataset tells of machines over time: each metric of a joint by start and run.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

use serde::{Deserialize, Serialize};

use super::{
    doubts,
    failure::FleetFailure,
    once::{Logged, is_gone, one_a_run},
    other_joints,
    renamed::as_one,
    run::Run,
    sensed::{Measured, measured_otherwise},
    sources::changed_ns,
    store::{is_unfinished, parts},
    tables::{self, Name},
};
use crate::{
    log::{
        UNDATED_NS,
        dataset::{Cell, read_table},
    },
    math::{median, step_scatter},
    remark::{Code, Remarks},
    replay::{Answer, Rules},
    suggest::nearest,
    workflow::sensed::Sensed,
};

/// A metric that machines are judged by.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum By {
    /// Largest tracking error after a start, in the joint's unit.
    #[default]
    Peak,
    /// Dead time of a start, s.
    Delay,
    /// Lag of a joint over a run, s.
    Lag,
}

impl By {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Peak, Self::Delay, Self::Lag];
}

/// A joint of a machine.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Axis {
    pub(super) machine: String,
    pub(super) joint: String,
    pub(super) unit: String,
}

/// A start of a plan: what the same start is in another run.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Event {
    pub(super) plan_id: String,
    /// Among the planned starts of the joint, from 1; 0 stands for the whole run.
    pub(super) index: i64,
}

/// Values of one metric of one joint: by start, then by run.
pub(super) type Values = BTreeMap<Event, BTreeMap<usize, f64>>;

/// By joint and start.
pub(super) type Scatters = BTreeMap<(String, Event), f64>;

/// All runs, in order of time, and what was measured in them.
#[derive(Debug, Clone, Default)]
pub(super) struct History {
    pub(super) runs: Vec<Run>,
    pub(super) values: BTreeMap<(Axis, By), Values>,
    /// The direction of each start, 1 or -1.
    pub(super) directions: BTreeMap<(String, Event), i64>,
    pub(super) remarks: Remarks,
    /// Names of all joints.
    pub(super) joints: BTreeSet<String>,
}

/// Which part of the dataset is asked for.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Filter {
    /// One machine only.
    pub machine: Option<String>,
    /// One joint only.
    pub joint: Option<String>,
    /// Runs that began then or later only, microseconds since 1970.
    pub since_us: Option<i64>,
}

/// In so many runs at least, and in more than answer it since, a start has to be unanswered to count.
const FEWEST_UNANSWERED: usize = 3;

/// A planned start that lies farther than this from where it lies in most runs, counted from the first start of its
/// run, is another start, s.
const SAME_START_S: f64 = 0.3;

impl History {
    /// Reads the dated runs that the filter lets through; machines other than the one asked for are read if `others`
    /// says so.
    pub(super) fn read(root: &Path, filter: &Filter, others: bool) -> Result<Self, FleetFailure> {
        Self::read_if(root, filter, others, true)
    }

    /// Reads all runs that the filter lets through, of other machines too; of those without a date none began since one.
    pub(super) fn read_all(root: &Path, filter: &Filter) -> Result<Self, FleetFailure> {
        Self::read_if(root, filter, true, filter.since_us.is_some())
    }

    fn read_if(root: &Path, filter: &Filter, others: bool, dated: bool) -> Result<Self, FleetFailure> {
        let found = parts(root, Name::Runs)?;
        if found.is_empty() {
            return Err(FleetFailure::NoDataset { path: root.to_owned() });
        }
        let mut history = Self::default();
        let message = "a scan was ended before its last step; `hydrotrace fleet scan` finishes it";
        history.remarks.add(Code::NotClosed, u64::from(is_unfinished(root)), message);
        doubts::begun(root, &mut history.remarks);
        let (mut runs, mut starts, mut lags) = (Vec::new(), Vec::new(), Vec::new());
        for part in &found {
            for (name, columns, rows) in [
                (Name::Runs, &RUN[..], &mut runs),
                (Name::Transitions, &START[..], &mut starts),
                (Name::Joints, &JOINT[..], &mut lags),
            ] {
                let path = part.path(name);
                if name == Name::Runs || root.join(&path).exists() {
                    rows.extend(read(root, &path, name, columns)?);
                }
            }
        }
        let mut joints: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        for row in &lags {
            if let (Some(run), Some(joint)) = (row[0].as_text(), row[2].as_text()) {
                joints.entry(run.to_owned()).or_default().insert(joint.to_owned());
            }
        }
        let analysed = |row: &Vec<Cell>| Some((row[0].as_text()?.to_owned(), row[11].as_text()?.to_owned()));
        let analyses: BTreeMap<String, String> = runs.iter().filter_map(analysed).collect();
        history.take_runs(runs, &joints);
        let (mut spoilt, mut doubtful) = (BTreeSet::new(), BTreeSet::new());
        for path in found.iter().map(|part| part.path(Name::Remarks)).filter(|path| root.join(path).exists())
        {
            let rows = read(root, &path, Name::Remarks, &REMARK)?;
            let spoils = |row: &&Vec<Cell>| {
                row[1].as_text().is_some_and(|code| Code::SPOILS_RUNS.iter().any(|c| c.name() == code))
            };
            let of_order = rows.iter().filter(|row| row[1].as_text() == Some(&Code::DateOrder.name()));
            doubtful.extend(of_order.filter_map(|row| row[0].as_text().map(str::to_owned)));
            spoilt.extend(rows.iter().filter(spoils).filter_map(|row| row[0].as_text().map(str::to_owned)));
        }
        history.leave_out_spoilt(&spoilt);
        if let Some(machine) = &filter.machine {
            history.check(machine)?;
        }
        let wanted =
            |run: &Run| others || filter.machine.as_ref().is_none_or(|machine| *machine == run.machine);
        if dated {
            doubts::without_undated(&mut history.runs, &mut history.remarks);
        }
        doubts::dates(&mut history.runs, &mut history.remarks);
        doubts::orders(&history.runs, &doubtful, &mut history.remarks);
        history
            .runs
            .retain(|run| wanted(run) && filter.since_us.is_none_or(|since_us| run.started_us >= since_us));
        doubts::analyses(&history.runs, &analyses, &mut history.remarks);
        doubts::spelled(&history.runs, &mut history.remarks);
        let index: BTreeMap<String, usize> =
            history.runs.iter().enumerate().map(|(k, run)| (run.id.clone(), k)).collect();
        as_one(&history.runs, [&mut starts, &mut lags], &mut history.remarks);
        other_joints::as_one(&history.runs, [&mut starts, &mut lags], &mut history.remarks);
        history.joints = lags.iter().filter_map(|row| row[2].as_text().map(str::to_owned)).collect();
        history.check_joint(filter)?;
        let joint =
            |row: &Vec<Cell>| filter.joint.as_ref().is_none_or(|joint| row[2].as_text() == Some(joint));
        starts.retain(joint);
        lags.retain(joint);
        history.take_starts(&starts, &index);
        history.take_joints(&lags, &index);
        Ok(history)
    }

    fn take_runs(&mut self, rows: Vec<Vec<Cell>>, joints: &BTreeMap<String, BTreeSet<String>>) {
        let mut logged = Vec::new();
        let (mut failed, mut unnamed) = (0, 0);
        for row in rows {
            let text = |k: usize| row[k].as_text().map(str::to_owned);
            match (text(5).is_some(), text(1)) {
                (true, _) => failed += 1,
                (false, Some(machine)) => {
                    let started_us = row[2].as_whole().unwrap_or(UNDATED_NS / 1000);
                    let log = text(3).unwrap_or_default();
                    logged.push(Logged {
                        content: text(4).unwrap_or_default(),
                        duration_s: row[6].as_real().unwrap_or_default(),
                        errors: [row[8].as_real(), row[9].as_real()],
                        plan_is_command: row[7].is_set(),
                        is_gone: is_gone(&log),
                        changed_ns: row[10].as_text().and_then(changed_ns),
                        run: Run { id: text(0).unwrap_or_default(), machine, log, started_us },
                    });
                }
                (false, None) => unnamed += 1,
            }
        }
        self.runs = one_a_run(logged, joints, &mut self.remarks);
        self.remarks.add(Code::UnreadableLog, failed, "logs that could not be analysed; left out");
        self.remarks.add(Code::UnknownMachine, unnamed, "runs that name no machine; left out");
    }

    /// What came of another time than planned, or of a stop, says nothing of the machine.
    fn leave_out_spoilt(&mut self, ids: &BTreeSet<String>) {
        let all = self.runs.len();
        self.runs.retain(|run| !ids.contains(&run.id));
        let message = "runs at another time than their plan, or stopped on their way; left out";
        self.remarks.add(Code::OtherTime, (all - self.runs.len()) as u64, message);
    }

    fn check(&self, machine: &str) -> Result<(), FleetFailure> {
        let fault = |machine, nearest, present| FleetFailure::NoMachine { machine, nearest, present };
        check_name(machine, &self.machines(), fault)
    }

    /// That the joint that is asked for is one of those that are there.
    pub(super) fn check_joint(&self, filter: &Filter) -> Result<(), FleetFailure> {
        let fault = |joint, nearest, present| FleetFailure::NoJoint { joint, nearest, present };
        let present = self.joints.iter().map(String::as_str).collect();
        filter.joint.as_ref().map_or(Ok(()), |joint| check_name(joint, &present, fault))
    }

    fn take_starts(&mut self, rows: &[Vec<Cell>], index: &BTreeMap<String, usize>) {
        let run = |row: &Vec<Cell>| index.get(row[0].as_text()?).copied();
        let mut first_s: BTreeMap<usize, f64> = BTreeMap::new();
        // Joints that some runs do not log say nothing of when a run begins.
        let of_all = other_joints::of_all_runs(rows);
        let counts = |row: &&Vec<Cell>| {
            let joints =
                row[1].as_text().and_then(|plan| of_all.get(plan)).filter(|joints| !joints.is_empty());
            joints.is_none_or(|joints| row[2].as_text().is_some_and(|joint| joints.contains(joint)))
        };
        for row in rows.iter().filter(counts) {
            if let (Some(run), Some(at_s)) = (run(row), row[5].as_real()) {
                first_s.entry(run).and_modify(|first_s| *first_s = first_s.min(at_s)).or_insert(at_s);
            }
        }
        // When each start lies behind the first one of its run, over all runs of the plan.
        let mut behind: BTreeMap<(String, Event), Vec<f64>> = BTreeMap::new();
        let known = |row: &Vec<Cell>| {
            let (run, event) =
                (run(row)?, Event { plan_id: row[1].as_text()?.to_owned(), index: row[4].as_whole()? });
            Some((run, event, row[2].as_text()?.to_owned(), row[5].as_real()? - first_s.get(&run)?))
        };
        for (_, event, joint, at_s) in rows.iter().filter_map(known) {
            behind.entry((joint, event)).or_default().push(at_s);
        }
        let usual: BTreeMap<(String, Event), f64> =
            behind.into_iter().map(|(key, values)| (key, median(values))).collect();
        let mut never: BTreeMap<Axis, BTreeMap<Event, Vec<usize>>> = BTreeMap::new();
        for row in rows {
            let Some((run, event, joint, at_s)) = known(row) else { continue };
            let key = (joint, event);
            if usual.get(&key).is_none_or(|usual_s| (usual_s - at_s).abs() > SAME_START_S) {
                let message = "starts at another time than in most runs of their plan; left out";
                self.remarks.add(Code::Unmatched, 1, message);
                continue;
            }
            if let Some(direction) = row[9].as_whole() {
                self.directions.insert(key.clone(), direction);
            }
            let (joint, event) = key;
            let unit = row[3].as_text().unwrap_or("rad").to_owned();
            let axis = Axis { machine: self.runs[run].machine.clone(), joint, unit };
            if row[7].as_real().is_none() && row[8].as_text() == Some(Answer::Never.name()) {
                never.entry(axis.clone()).or_default().entry(event.clone()).or_default().push(run);
            }
            for (by, value) in [(By::Peak, row[6].as_real()), (By::Delay, row[7].as_real())] {
                let Some(value) = value else { continue };
                let of_axis = self.values.entry((axis.clone(), by)).or_default();
                of_axis.entry(event.clone()).or_default().insert(run, value);
            }
        }
        self.take_unanswered(never);
    }

    /// A joint that answers no more counts as late by all the time that is looked; once is no delay: it would be most of a mean.
    fn take_unanswered(&mut self, never: BTreeMap<Axis, BTreeMap<Event, Vec<usize>>>) {
        let late_s = Rules::default().transition_window_s;
        for (axis, events) in never {
            let delays = self.values.entry((axis, By::Delay)).or_default();
            for (event, runs) in events {
                let of_runs = delays.entry(event).or_default();
                let first = runs.iter().copied().min().unwrap_or_default();
                let answered = of_runs.range(first..).count();
                if runs.len() >= FEWEST_UNANSWERED && runs.len() > answered {
                    of_runs.extend(runs.into_iter().map(|run| (run, late_s)));
                }
            }
            delays.retain(|_, of_runs| !of_runs.is_empty());
        }
        self.values.retain(|_, values| !values.is_empty());
    }

    /// Lags, and how the joints were measured.
    fn take_joints(&mut self, rows: &[Vec<Cell>], index: &BTreeMap<String, usize>) {
        let mut measured = Measured::new();
        for row in rows {
            let text = |k: usize| row[k].as_text();
            let run = text(0).and_then(|run_id| index.get(run_id)).copied();
            let (Some(run), Some(plan), Some(joint)) = (run, text(1), text(2)) else { continue };
            if let [Some(noise), Some(interval_s), Some(peak_error)] = [5, 6, 7].map(|k| row[k].as_real()) {
                let own = measured.entry((self.runs[run].machine.clone(), joint.to_owned())).or_default();
                own.insert(run, Sensed { noise, interval_s, peak_error });
            }
            let Some(lag_s) = row[4].as_real() else { continue };
            let unit = text(3).unwrap_or("rad").to_owned();
            let axis = Axis { machine: self.runs[run].machine.clone(), joint: joint.to_owned(), unit };
            let event = Event { plan_id: plan.to_owned(), index: 0 };
            self.values.entry((axis, By::Lag)).or_default().entry(event).or_default().insert(run, lag_s);
        }
        measured_otherwise(&self.runs, &measured, &mut self.remarks);
    }

    /// The median of all machines at each start of each joint.
    pub(super) fn usual(&self, metric: By) -> BTreeMap<(&str, &Event), f64> {
        let mut usual: BTreeMap<(&str, &Event), Vec<f64>> = BTreeMap::new();
        for ((axis, _), values) in self.values.iter().filter(|((_, by), _)| *by == metric) {
            for (event, of) in values {
                usual.entry((axis.joint.as_str(), event)).or_default().extend(of.values());
            }
        }
        usual.into_iter().map(|(key, values)| (key, median(values))).collect()
    }

    /// The starts that more than one machine has.
    pub(super) fn shared(&self, metric: By) -> BTreeSet<(&str, &Event)> {
        let mut machines: BTreeMap<(&str, &Event), BTreeSet<&str>> = BTreeMap::new();
        for ((axis, _), values) in self.values.iter().filter(|((_, by), _)| *by == metric) {
            for event in values.keys() {
                machines.entry((axis.joint.as_str(), event)).or_default().insert(&axis.machine);
            }
        }
        machines.into_iter().filter(|(_, machines)| machines.len() > 1).map(|(key, _)| key).collect()
    }

    /// How much each start of each joint scatters from run to run: the median over the machines.
    pub(super) fn scatters(&self, metric: By) -> Scatters {
        let mut found: BTreeMap<(String, Event), Vec<f64>> = BTreeMap::new();
        for ((axis, _), values) in self.values.iter().filter(|((_, by), _)| *by == metric) {
            for (event, of) in values {
                let key = (axis.joint.clone(), event.clone());
                found.entry(key).or_default().extend(step_scatter(of.values().copied()));
            }
        }
        found.retain(|_, own| !own.is_empty());
        found.into_iter().map(|(key, own)| (key, median(own))).collect()
    }

    /// Names of all machines.
    pub(super) fn machines(&self) -> BTreeSet<&str> {
        self.runs.iter().map(|run| run.machine.as_str()).collect()
    }
}

/// That a name is one of those that are there; else what is wrong, by it, the nearest and all.
fn check_name(
    name: &str,
    present: &BTreeSet<&str>,
    fault: impl FnOnce(String, Option<String>, String) -> FleetFailure,
) -> Result<(), FleetFailure> {
    if present.contains(name) {
        return Ok(());
    }
    let all = present.iter().copied().collect::<Vec<_>>().join(", ");
    Err(fault(name.to_owned(), nearest(name, present.iter().copied()), all))
}

const RUN: [&str; 12] = [
    "run_id", "machine", "started_at", "log_uri", "log_sha256", "error", "duration_s", "plan_is_command",
    "rms", "peak", "log_etag", "analysis_id",
];
const START: [&str; 10] = [
    "run_id", "plan_id", "joint", "unit", "event_index", "planned_onset_s", "peak_error", "onset_delay_s",
    "answer", "direction",
];
const REMARK: [&str; 2] = ["run_id", "code"];
const JOINT: [&str; 8] =
    ["run_id", "plan_id", "joint", "unit", "lag_s", "noise", "sample_interval_s", "peak"];

fn read(root: &Path, path: &str, name: Name, columns: &[&str]) -> Result<Vec<Vec<Cell>>, FleetFailure> {
    let columns: Vec<_> = columns.iter().map(|column| tables::column(name, column)).collect();
    Ok(read_table(&root.join(path), &columns)?.rows)
}
