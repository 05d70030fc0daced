//! `report`: from a log to the tracking error of every joint and transition.

pub mod advice;
mod analysis;
mod backward;
mod document;
mod failure;
mod fault;
mod findings;
mod gates;
mod identity;
mod outcome;
mod plan_id;
mod saturated;
mod tool;
mod why;

use std::{collections::BTreeMap, path::PathBuf};

pub use super::correctable::Uncorrectable;
pub use analysis::{Analysis, analyse};
use analysis::{aligned, remark_edges, taken};
pub use backward::Backward;
pub use document::Document;
pub use failure::ReportFailure;
pub use fault::Leaves;
#[cfg(feature = "parquet")]
pub(in crate::workflow) use findings::reported;
pub use findings::{Findings, analysis_id, findings};
pub use gates::{GateResult, Gates};
#[cfg(feature = "parquet")]
pub(crate) use identity::hash;
pub use identity::{LogFile, log_files};
pub use outcome::{Alignment, Fault, Report, Travel};
pub use saturated::Saturated;
pub use tool::Tool;
pub use why::{DelayModel, LateStart, Part, Why};
use why::{Ready, Unready};

use super::{
    carried::{Carried, PLAN, Schedule},
    correctable::uncorrectable,
    fit::supply_of,
    leads::remark_leads,
    plan::PlanDocument,
};
use crate::{
    arm::ArmError,
    input_file,
    log::{LogError, ReadOptions, Recording, SignalRole, TimeBase, TimeRange, read_recording},
    remark::{Code, Remarks},
    replay::{Profiles, Replay, Rules, Transition},
    series::{Broken, Pair, PosePair},
};

/// What to analyse, how, and what must hold.
#[derive(Debug, Clone, Default)]
pub struct Inputs {
    /// Files or bag directories of one run.
    pub logs: Vec<PathBuf>,
    /// What to read, where the log alone does not tell.
    pub read: ReadOptions,
    /// The URDF of the arm, in place of what the log holds of it.
    pub urdf: Option<PathBuf>,
    /// The link of the URDF that is the tool; `None`: where the arm ends.
    pub tool: Option<String>,
    /// Thresholds and windows.
    pub rules: Rules,
    /// Limits that the caller sets.
    pub gates: Gates,
    /// By what it is said why starts come late.
    pub delay_model: DelayModel,
    /// Whether command, valves and pressures are wanted too, for plots.
    pub with_signals: bool,
    /// By joint, from when to when it is judged, s; all of it without.
    pub stretches_s: BTreeMap<String, [f64; 2]>,
}

/// Analyses one run.
///
/// # Errors
///
/// [`ReportFailure`] if the log cannot be read or holds no planned and measured joints, or if the URDF that was given
/// is of no arm.
///
/// ```
/// use hydrotrace::workflow::report::{Inputs, run};
///
/// let logs = vec!["sample-logs/panel-install.mcap".into()];
/// let report = run(&Inputs { logs, ..Inputs::default() })?;
/// assert!(report.replay.transitions.len() > 10 && report.gates_kept());
/// # Ok::<(), hydrotrace::workflow::report::ReportFailure>(())
/// ```
pub fn run(inputs: &Inputs) -> Result<Report, ReportFailure> {
    report(read_recording(&inputs.logs, &inputs.read_options()?)?, inputs)
}

impl Inputs {
    /// What is to be read of a log for this report.
    fn read_options(&self) -> Result<ReadOptions, ReportFailure> {
        let mut read = self.read.clone();
        if let Some(path) = &self.urdf {
            let failed = |source| ReportFailure::Read { path: path.clone(), source };
            read.description = Some(input_file::read_to_string(path).map_err(failed)?);
        }
        let plotted: &[SignalRole] = if self.with_signals { &SignalRole::OF_DRIVES } else { &[] };
        Ok(read.wanting(self.delay_model.signals()).wanting(plotted).wanting(&[SignalRole::SupplyPressure]))
    }
}

/// Analyses the recording that was read of the logs.
///
/// # Errors
///
/// [`ReportFailure`] if plan and measurement never overlap, or if the arm that was given is none.
pub fn report(mut recording: Recording, inputs: &Inputs) -> Result<Report, ReportFailure> {
    let carried = Carried::of(&recording);
    let mut remarks = recording.remarks.clone();
    carried.remark_altered(&mut remarks);
    let broken = carried.broken(&recording);
    let uncorrectable = uncorrectable(&recording, &inputs.rules);
    let model = inputs.delay_model.ready(&recording);
    let sides = [&recording.planned, &recording.measured];
    // The rows of a table have one time.
    let no_other_clock = recording.source.time_base == TimeBase::Log || recording.source.origin.is_some();
    let [planned_s, measured_s] = sides.map(|side| side.span_s().unwrap_or_default());
    let supply = supply_of(&[&recording], None);
    let (alignment, pairs) = aligned(taken(&mut recording), &inputs.rules, &mut remarks);
    let pairs = stretches(pairs, &inputs.stretches_s);
    if pairs.is_empty() {
        return Err(LogError::NoOverlap { planned_s, measured_s, no_other_clock }.into());
    }
    let Analysis { alignment, pairs, replay } = Analysis::of(alignment, pairs, &inputs.rules);
    if inputs.stretches_s.is_empty() {
        remark_edges(&replay, &mut remarks);
    }
    // A command that was made ahead of its plan may have joints lead it.
    if carried.promise().is_none() && inputs.read.measured_delay_ns.is_none() {
        remark_leads(&pairs, &replay, &mut remarks);
    }
    let arm = match tool::arm(&recording, &carried, inputs, &pairs) {
        // A joint that the log lacks is no fault of what was given.
        Some(Err(why))
            if (inputs.urdf.is_some() || inputs.tool.is_some())
                && !matches!(why, ArmError::JointsMissing { .. }) =>
        {
            return Err(ReportFailure::Arm(Box::new(why)));
        }
        arm => arm,
    };
    let poses = recording.poses.take().and_then(|poses| PosePair::of(&poses.planned, &poses.measured));
    let tool = match poses {
        Some(poses) => Tool::of_poses(&poses, &inputs.rules),
        None => Tool::of(arm, &pairs, &inputs.rules),
    };
    let explained = |ready: Ready| ready.why(&pairs, &replay).map_err(|error| error.to_string());
    let unfit = match &model {
        Some(Ok(ready)) => ready.unfit(),
        Some(Err(Unready::Fit(why))) => Some(why.clone()),
        _ => None,
    };
    let why = model.map(|model| model.map_err(Unready::message).and_then(explained));
    match broken {
        Some(Broken::Cut { begins: false, at_s, .. }) => remark_cut(at_s, &replay, &mut remarks),
        // Where the caller wants a part, its end is no news.
        _ if inputs.stretches_s.is_empty() && inputs.read.range == TimeRange::default() => {
            remark_unfinished(&pairs, &replay, &mut remarks);
        }
        _ => {}
    }
    let gates = inputs.gates.judge(&replay, tool.found(), &pairs);
    let front = front(&carried, &mut remarks);
    let name = |path: &PathBuf| path.file_name().map(|name| name.to_string_lossy().into_owned());
    let named = |key: &str| recording.metadata.values().find_map(|entries| entries.get(key).cloned());
    let stood_s = recording.stood_s;
    let report = Report {
        fault: None,
        unfit,
        uncorrectable,
        logs: inputs.logs.iter().filter_map(name).collect(),
        paths: inputs.logs.clone(),
        machine: named("machine"),
        run: named("run"),
        promised: carried.promise().map(|promise| promise.held(replay.peaks_rad())),
        holds_task: carried.task().is_some(),
        broken,
        schedule: Schedule::of(&carried),
        source: recording.source,
        alignment,
        replay,
        tool,
        why,
        gates,
        remarks,
        supply,
        profiles: Profiles::of(&pairs),
        command: recording.command.filter(|_| inputs.with_signals),
        signals: if inputs.with_signals { recording.signals } else { BTreeMap::new() },
        pairs,
        front,
    };
    Ok(Report { fault: Fault::of(&report, stood_s), ..report })
}

/// The pairs over the stretches asked for; those of equal stamps share them, as they did.
fn stretches(pairs: Vec<Pair>, stretches_s: &BTreeMap<String, [f64; 2]>) -> Vec<Pair> {
    let mut parts: Vec<Pair> = Vec::with_capacity(pairs.len());
    for pair in pairs {
        let Some(stretch_s) = stretches_s.get(&pair.name) else {
            parts.push(pair);
            continue;
        };
        let Some(mut part) = pair.within(*stretch_s) else { continue };
        if let Some(before) = parts.last().filter(|before| before.t_s == part.t_s) {
            part.t_s = before.t_s.clone();
        }
        parts.push(part);
    }
    parts
}

/// Starts whose window ends with the plan, in motion: their errors may have become larger.
fn remark_cut(at_s: f64, replay: &Replay, remarks: &mut Remarks) {
    let cut = |start: &&Transition| start.window_s[1] >= at_s - start.time_resolution_s;
    let starts: Vec<&Transition> = replay.transitions.iter().filter(cut).collect();
    if let Some(last) = starts.iter().max_by(|a, b| a.planned_onset_s.total_cmp(&b.planned_onset_s)) {
        let message = format!(
            "starts whose plan is cut off in motion, the last one {} at {:.2} s, {:.2} s before the end: what came later \
             is in no figure",
            last.joint,
            last.planned_onset_s,
            at_s - last.planned_onset_s
        );
        remarks.add(Code::Unmatched, starts.len() as u64, message);
    }
}

/// Starts whose error is largest where the samples end, at a gap or with the log, before the window does: it may have
/// become larger.
fn remark_unfinished(pairs: &[Pair], replay: &Replay, remarks: &mut Remarks) {
    let unfinished = |start: &&Transition| {
        let of_joint = |pair: &&Pair| pair.name == start.joint;
        let ends = |pair: &Pair| pair.spans_s().any(|[_, to_s]| (to_s - start.window_s[1]).abs() < 1e-9);
        let full_s = start.planned_onset_s + replay.rules.transition_window_s;
        let peak_s = start.planned_onset_s + start.time_to_peak_s;
        start.peak_error > replay.rules.sizes(start.joint_kind).settle_band
            && start.window_s[1] < full_s
            && peak_s >= start.window_s[1] - start.time_resolution_s
            && pairs.iter().find(of_joint).is_some_and(ends)
    };
    let starts: Vec<&Transition> = replay.transitions.iter().filter(unfinished).collect();
    if let Some(first) = starts.iter().min_by(|a, b| a.planned_onset_s.total_cmp(&b.planned_onset_s)) {
        let message = format!(
            "starts whose error still grows where the samples end, at a gap or with the log, the first one {} at {:.2} s: \
             their peak error is that much at least",
            first.joint, first.planned_onset_s
        );
        remarks.add(Code::Unmatched, starts.len() as u64, message);
    }
}

fn front(carried: &Carried, remarks: &mut Remarks) -> Option<PlanDocument> {
    match carried.plan()? {
        Ok(plan) => Some(plan),
        Err(error) => {
            remarks.add(Code::NotSupported, 1, format!("{PLAN} in the log is broken, left out: {error}"));
            None
        }
    }
}
