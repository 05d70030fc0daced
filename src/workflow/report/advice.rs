//! What to do about what a report found.

use super::{Fault, Uncorrectable, outcome::Report};
use crate::{
    fit::SPARSEST_S,
    replay::{JointReplay, Transition, Verdict},
    series::{Broken, JointKind},
};

/// A next step, the most urgent first.
#[derive(Debug, Clone, PartialEq)]
pub enum Advice {
    /// The data are doubtful: so many kinds of doubt.
    ClearDoubts(usize),
    /// A joint leaves planned starts unanswered.
    FreeJoint {
        /// The joint.
        joint: String,
        /// Planned starts without an answer.
        unanswered: usize,
        /// All its planned starts, reversals included.
        starts: usize,
        /// Its planned reversals.
        reversals: usize,
    },
    /// The error is mostly lag.
    ShiftCommand {
        /// The joint with the largest error among those whose own is mostly lag, or else of all with a lag.
        joint: String,
        /// Its lag, s.
        lag_s: f64,
        /// Whether a command can be made from it: of joints sampled often enough, in a run of a whole plan.
        fits: bool,
    },
    /// The error lives in the transitions, most in those of a joint.
    EaseStarts {
        /// The joint with the largest peak.
        joint: String,
        /// Median delay of timed starts over all joints, s.
        delay_s: Option<f64>,
        /// The same.
        fits: bool,
        /// Whether a gentler plan can be made from it.
        gentler: bool,
    },
    /// The error lives outside the transitions, and joints are late throughout.
    ShortenLag {
        /// The joint that is latest.
        joint: String,
        /// By how much, s.
        lag_s: f64,
    },
    /// The error lives outside the transitions, and no lag explains it.
    LookOutside {
        /// The joint with the largest error.
        joint: String,
        /// When that is, s.
        time_s: f64,
    },
    /// Something happened that comes before any start.
    SeeTo(Fault),
    /// The error is noise of the sensors.
    LeaveIt {
        /// Of the joint with the largest error: noise and RMS error.
        noise: f64,
        /// The same.
        error: f64,
        /// Whether it turns or slides.
        kind: JointKind,
    },
    /// A fit says why no command can be made from the log.
    NoCommand(String),
    /// No command is corrected for the plan of the log.
    NotCorrected {
        /// Why.
        why: Uncorrectable,
        /// Whether a machine can be fitted to it.
        fits: bool,
    },
    /// No joint is asked to leave rest.
    RecordStarts,
    /// No command can be made from the log, because its plan is broken.
    RecordWhole(Broken),
    /// No limit was set, so nothing says whether this run is good enough.
    SetLimits,
    /// Whatever is changed: run again and compare.
    Compare,
}

/// What is measured of a tool is no joint, and no command is made of it.
const OF_TOOL: [&str; 3] = ["x", "y", "z"];

/// Lags below this are not worth a step, s.
const SMALL_LAG_S: f64 = 0.01;

/// What to do next; of a machine with a fault nothing of its starts.
pub fn advice(report: &Report) -> Vec<Advice> {
    let replay = &report.replay;
    let mut advice = Vec::new();
    advice.extend(report.fault.clone().map(Advice::SeeTo));
    if !report.remarks.is_empty() {
        advice.push(Advice::ClearDoubts(report.remarks.as_slice().len()));
    }
    let dead = match &report.fault {
        Some(Fault::Dead { joints, .. }) => joints.as_slice(),
        _ => &[],
    };
    // Beside a joint that is dead the others can be seen to.
    if report.fault.is_some() && (dead.is_empty() || 2 * dead.len() >= replay.joints.len()) {
        advice.push(Advice::Compare);
        return advice;
    }
    let stuck =
        replay.joints.iter().filter(|joint| joint.unanswered_starts > 0 && !dead.contains(&joint.name));
    advice.extend(stuck.max_by_key(|joint| joint.unanswered_starts).map(|joint| Advice::FreeJoint {
        joint: joint.name.clone(),
        unanswered: joint.unanswered_starts,
        starts: joint.starts,
        reversals: joint.reversals,
    }));
    let Some(worst) = report.worst() else {
        advice.push(Advice::RecordStarts);
        return advice;
    };
    let verdict = replay.together_with(worst.joint_kind).concentration.as_ref().map(|c| c.verdict);
    let sound = report.remarks.as_slice().iter().all(|remark| !remark.code.spoils_runs());
    let of_tool =
        |joint: &JointReplay| joint.kind == JointKind::Slides && OF_TOOL.contains(&joint.name.as_str());
    let tells = |joint: &JointReplay| !of_tool(joint) && joint.sample_interval_s <= SPARSEST_S;
    let could = sound && replay.joints.iter().any(tells);
    let whole = could && report.broken.is_none() && report.unfit.is_none();
    let fits = whole && report.uncorrectable.is_none();
    let noise = report.only_noise();
    if report.uncorrectable == Some(Uncorrectable::Identifies) {
        // Its strokes are beyond the machine: no work on starts helps.
    } else if let Some(joint) = noise {
        let (noise, error) = (joint.noise.sigma, joint.tracking_error.rms);
        advice.push(Advice::LeaveIt { noise, error, kind: joint.kind });
    } else if let Some((joint, lag_s)) = mostly_lag(report, worst.joint_kind) {
        advice.push(Advice::ShiftCommand { joint, lag_s, fits });
    } else if verdict == Some(Verdict::Elsewhere) {
        advice.extend(outside(report));
    } else {
        advice.push(Advice::EaseStarts {
            joint: worst.joint.clone(),
            delay_s: median_delay_s(&replay.transitions),
            fits,
            gentler: report.holds_task,
        });
    }
    let why = report.uncorrectable.clone().filter(|_| could && noise.is_none());
    advice.extend(why.map(|why| Advice::NotCorrected { why, fits: whole }));
    advice.extend(report.broken.clone().filter(|_| could).map(Advice::RecordWhole));
    let unfit = report.unfit.clone().filter(|_| could && report.broken.is_none() && noise.is_none());
    advice.extend(unfit.map(Advice::NoCommand));
    if report.gates.is_empty() {
        advice.push(Advice::SetLimits);
    }
    advice.push(Advice::Compare);
    advice
}

/// Where the error of joints of a kind is mostly lag: the joint to begin with and its lag, s.
fn mostly_lag(report: &Report, kind: JointKind) -> Option<(String, f64)> {
    report.replay.together_with(kind).lag_share.filter(|lag| lag.mostly)?;
    let joints = report.replay.joints.iter().filter(|joint| joint.kind == kind);
    let joints = joints.filter_map(|joint| Some((joint, joint.lag_s.filter(|s| *s > 0.0)?)));
    let own = |joint: &JointReplay| joint.lag_share.is_some_and(|lag| lag.mostly);
    let (joint, lag_s) = joints.max_by(|(a, _), (b, _)| {
        let rms_rad = |joint: &JointReplay| joint.tracking_error.rms;
        own(a).cmp(&own(b)).then(rms_rad(a).total_cmp(&rms_rad(b)))
    })?;
    Some((joint.name.clone(), lag_s))
}

fn outside(report: &Report) -> Option<Advice> {
    let joints = &report.replay.joints;
    let lags = joints.iter().filter_map(|joint| Some((joint, joint.lag_s?)));
    let latest = lags.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, lag_s)| *lag_s > SMALL_LAG_S);
    if let Some((joint, lag_s)) = latest {
        return Some(Advice::ShortenLag { joint: joint.name.clone(), lag_s });
    }
    let worst = joints.iter().max_by(|a, b| a.tracking_error.peak.total_cmp(&b.tracking_error.peak))?;
    Some(Advice::LookOutside { joint: worst.name.clone(), time_s: worst.tracking_error.peak_time_s })
}

fn median_delay_s(transitions: &[Transition]) -> Option<f64> {
    let delays: Vec<f64> = transitions.iter().filter_map(|t| t.onset_delay_s).collect();
    (!delays.is_empty()).then(|| crate::math::median(delays))
}
