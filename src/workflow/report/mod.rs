//! `report`: from a log to the tracking error of every joint and transition.

use std::path::PathBuf;

use serde::Serialize;

pub mod advice;

use super::{
    carried::{Carried, PLAN, Schedule},
    plan::PlanDocument,
};
use crate::{
    log::{LogError, ReadOptions, SourceInfo, read_recording},
    remark::{Code, Remarks},
    replay::{Answer, Profiles, Replay, Rules, planned_starts, replay},
    series::{Pair, Series, align},
};

/// What to analyse, how, and what must hold.
#[derive(Debug, Clone, Default)]
pub struct Inputs {
    /// Files or bag directories of one run.
    pub logs: Vec<PathBuf>,
    /// What to read, where the log alone does not tell.
    pub read: ReadOptions,
    /// Thresholds and windows.
    pub rules: Rules,
    /// Limits that the caller sets.
    pub gates: Gates,
}

/// Limits that a run must keep; `None` is no limit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Gates {
    /// Peak error in any transition, rad.
    pub max_transition_peak_rad: Option<f64>,
    /// Root mean square error of any joint over the run, rad.
    pub max_rms_rad: Option<f64>,
    /// Peak error of any joint over the run, rad.
    pub max_peak_rad: Option<f64>,
    /// Root mean square error of any joint at standstill, rad.
    pub max_standstill_rms_rad: Option<f64>,
    /// Delay of any start, s; a start that is never answered exceeds every limit, one whose answer has no
    /// instant is not judged.
    pub max_onset_delay_s: Option<f64>,
    /// Velocity lag of any joint, s.
    pub max_lag_s: Option<f64>,
}

/// A limit and the worst that was found against it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct GateResult {
    /// Which limit.
    pub gate: Gate,
    /// The limit, in SI units.
    pub limit: f64,
    /// The worst value, in the unit of the limit; `None` where nothing could be measured, or a
    /// start was never answered.
    pub worst: Option<f64>,
    /// The joint it was found at.
    pub joint: Option<String>,
    /// When, s; for a mean over the run when the error peaked.
    pub time_s: Option<f64>,
    /// Whether the limit is kept.
    pub kept: bool,
}

/// A quantity that can be limited.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Gate {
    /// Peak error in a transition, rad.
    TransitionPeak,
    /// Root mean square error of a joint, rad.
    Rms,
    /// Peak error of a joint, rad.
    Peak,
    /// Root mean square error of a joint at standstill, rad.
    StandstillRms,
    /// Delay of a start, s.
    OnsetDelay,
    /// Velocity lag, s.
    Lag,
}

/// How the plan of one joint met its measurement.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Alignment {
    /// The joint.
    pub joint: String,
    /// Measured samples with a plan.
    pub matched: usize,
    /// Measured samples without one, left out.
    pub unmatched: usize,
    /// Continuous stretches.
    pub segments: usize,
}

/// A report, before it is rendered.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Names of the files of the run, without their folders.
    pub logs: Vec<String>,
    /// Whether the log holds the task of its plan, so that a gentler plan can be made from it.
    pub holds_task: bool,
    /// Where the data come from.
    pub source: SourceInfo,
    /// How plan and measurement were matched, by joint.
    pub alignment: Vec<Alignment>,
    /// What was found.
    pub replay: Replay,
    /// The limits that were set, each with its outcome.
    pub gates: Vec<GateResult>,
    /// What was doubtful.
    pub remarks: Remarks,
    /// Each joint's error over the run, in the order of its joints.
    pub profiles: Profiles,
    /// The aligned samples, for plots.
    pub pairs: Vec<Pair>,
    /// When the key points of the task are passed, where the log tells.
    pub schedule: Option<Schedule>,
    /// The plans that the run's own was chosen from, where its log carries them.
    pub front: Option<PlanDocument>,
}

impl Report {
    /// Whether every limit is kept.
    pub fn gates_kept(&self) -> bool {
        self.gates.iter().all(|gate| gate.kept)
    }
}

/// Analyses one run.
///
/// # Errors
///
/// [`LogError`] if the log cannot be read or holds no planned and measured joints.
///
/// ```
/// use hydrotrace::workflow::report::{Inputs, run};
///
/// let logs = vec!["sample-logs/panel-install.mcap".into()];
/// let report = run(&Inputs { logs, ..Inputs::default() })?;
/// assert!(report.replay.transitions.len() > 10 && report.gates_kept());
/// # Ok::<(), hydrotrace::log::LogError>(())
/// ```
pub fn run(inputs: &Inputs) -> Result<Report, LogError> {
    let recording = read_recording(&inputs.logs, &inputs.read)?;
    let carried = Carried::of(&recording);
    let schedule = Schedule::of(&carried);
    let mut remarks = recording.remarks;
    let mut pairs = Vec::new();
    let mut alignment = Vec::new();
    for planned in &recording.planned.tracks {
        let Some(measured) = recording.measured.track(planned.name()) else { continue };
        let Some(pair) = align(planned, measured) else {
            let message = format!("{} has no plan while it was measured; left out", planned.name());
            remarks.add(Code::UnpairedJoint, 1, message);
            continue;
        };
        ::log::debug!("{}: {} samples aligned, {} without a plan", pair.name, pair.matched, pair.unmatched);
        alignment.push(Alignment {
            joint: pair.name.clone(),
            matched: pair.matched,
            unmatched: pair.unmatched,
            segments: pair.segments.len(),
        });
        pairs.push(pair);
    }
    if pairs.is_empty() {
        return Err(no_overlap(&recording.planned, &recording.measured));
    }
    remark_unseen(&recording.planned, &pairs, inputs, &mut remarks);
    let replay = replay(&pairs, &inputs.rules);
    ::log::info!("{} joints aligned, {} transitions found", pairs.len(), replay.transitions.len());
    let gates = gates(&inputs.gates, &replay);
    let front = front(&carried, &mut remarks);
    let name = |path: &PathBuf| path.file_name().map(|name| name.to_string_lossy().into_owned());
    Ok(Report {
        logs: inputs.logs.iter().filter_map(name).collect(),
        holds_task: carried.task().is_some(),
        source: recording.source,
        alignment,
        replay,
        gates,
        remarks,
        profiles: Profiles::of(&pairs),
        pairs,
        schedule,
        front,
    })
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

fn no_overlap(planned: &Series, measured: &Series) -> LogError {
    let [planned_s, measured_s] = [planned, measured].map(|side| side.span_s().unwrap_or_default());
    LogError::NoOverlap { planned_s, measured_s }
}

/// Measured samples without a plan are usual before and after a run; more than half is not.
const MOST_UNMATCHED: f64 = 0.5;

/// What the plan asked for and the measurement did not see, and the other way round.
fn remark_unseen(planned: &Series, pairs: &[Pair], inputs: &Inputs, remarks: &mut Remarks) {
    for pair in pairs {
        let all = pair.matched + pair.unmatched;
        if pair.unmatched as f64 > MOST_UNMATCHED * all as f64 {
            // One line for all joints.
            let message = "measured samples have no plan at their time, more than half of a joint's; left out; a \
                           start is only seen where the plan also shows the rest before it";
            remarks.add(Code::Unmatched, pair.unmatched as u64, message);
        }
        let Some(track) = planned.track(&pair.name) else { continue };
        let hidden = planned_starts(track, &inputs.rules)
            .into_iter()
            .filter(|at_s| {
                !pair.segments.iter().any(|s| (pair.t_s[s.start]..=pair.t_s[s.end - 1]).contains(at_s))
            })
            .count();
        let message = format!("planned starts of {} lie where nothing was measured; not judged", pair.name);
        remarks.add(Code::Unmatched, hidden as u64, message);
    }
}

/// Where a limited quantity was found: value, joint, time.
type Found<'a> = (Option<f64>, &'a str, Option<f64>);

fn gates(limits: &Gates, replay: &Replay) -> Vec<GateResult> {
    let joints = || replay.joints.iter();
    let transitions = || replay.transitions.iter();
    let mut results = Vec::new();
    let mut check = |gate, limit: Option<f64>, found: Vec<Found<'_>>| {
        if let Some(limit) = limit {
            results.push(worst(gate, limit, found));
        }
    };
    check(
        Gate::TransitionPeak,
        limits.max_transition_peak_rad,
        transitions()
            .map(|t| (Some(t.peak_error_rad), t.joint.as_str(), Some(t.planned_onset_s + t.time_to_peak_s)))
            .collect(),
    );
    check(
        Gate::Rms,
        limits.max_rms_rad,
        joints()
            .map(|j| (Some(j.tracking_error.rms_rad), j.name.as_str(), Some(j.tracking_error.peak_time_s)))
            .collect(),
    );
    check(
        Gate::Peak,
        limits.max_peak_rad,
        joints()
            .map(|j| (Some(j.tracking_error.peak_rad), j.name.as_str(), Some(j.tracking_error.peak_time_s)))
            .collect(),
    );
    check(
        Gate::StandstillRms,
        limits.max_standstill_rms_rad,
        joints()
            .filter_map(|j| {
                let error = j.standstill_error?;
                Some((Some(error.rms_rad), j.name.as_str(), Some(error.peak_time_s)))
            })
            .collect(),
    );
    check(
        Gate::OnsetDelay,
        limits.max_onset_delay_s,
        transitions()
            .filter(|t| matches!(t.answer, Answer::Timed | Answer::Never))
            .map(|t| (t.onset_delay_s, t.joint.as_str(), Some(t.planned_onset_s)))
            .collect(),
    );
    check(
        Gate::Lag,
        limits.max_lag_s,
        // A joint that is asked to move and shows no lag within the range looked at is later.
        joints().filter(|j| j.plan_moves).map(|j| (j.lag_s, j.name.as_str(), None)).collect(),
    );
    results
}

/// The worst of what was found; what could not be measured is worse than any number.
fn worst(gate: Gate, limit: f64, found: Vec<Found<'_>>) -> GateResult {
    let of = |value: Option<f64>| value.unwrap_or(f64::INFINITY);
    let worst = found.into_iter().max_by(|a, b| of(a.0).total_cmp(&of(b.0)));
    match worst {
        Some((value, joint, time_s)) => GateResult {
            gate,
            limit,
            worst: value,
            joint: Some(joint.to_owned()),
            time_s,
            kept: of(value) <= limit,
        },
        None => GateResult { gate, limit, worst: None, joint: None, time_s: None, kept: true },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::series::JointKind;

    #[test]
    fn a_start_that_was_never_answered_breaks_every_limit_on_delay() {
        let found = vec![(Some(0.1), "a", Some(1.0)), (None, "b", Some(2.0))];
        let result = worst(Gate::OnsetDelay, 10.0, found);
        assert_eq!((result.kept, result.worst, result.joint.as_deref()), (false, None, Some("b")));
    }

    /// A joint that follows 12 degrees in 3 s from 4 s on, having crept before, or does not.
    fn replayed(follows: bool) -> Replay {
        let t_s: Vec<f64> = (0..1000).map(|k| 0.01 * f64::from(k)).collect();
        let ramp = |t: f64| 0.07 * (t - 4.0).clamp(0.0, 3.0);
        let creep = |t: f64| 0.005 * (t - 1.0).clamp(0.0, 3.0);
        let angle = |of: &dyn Fn(f64) -> f64| t_s.iter().map(|t| of(*t)).collect::<Vec<f64>>();
        let pair = Pair {
            name: "a".into(),
            kind: JointKind::Turns,
            planned: angle(&ramp),
            planned_velocity: None,
            measured: angle(&|t| if follows { creep(t) + ramp(t) } else { 0.0 }),
            segments: std::iter::once(0..t_s.len()).collect(),
            planned_interval_s: 0.01,
            matched: t_s.len(),
            unmatched: 0,
            t_s,
        };
        replay(&[pair], &Rules::default())
    }

    #[test]
    fn only_a_start_that_is_never_answered_breaks_a_limit_on_delay_for_want_of_one() {
        let limits = Gates { max_onset_delay_s: Some(0.3), ..Gates::default() };
        let judged = |follows: bool| gates(&limits, &replayed(follows)).remove(0);
        assert_eq!((judged(true).kept, judged(true).worst, judged(true).joint), (true, None, None));
        assert_eq!((judged(false).kept, judged(false).joint.as_deref()), (false, Some("a")));
    }

    #[test]
    fn the_limit_itself_is_kept() {
        assert!(worst(Gate::Rms, 0.1, vec![(Some(0.1), "a", None)]).kept);
    }
}
