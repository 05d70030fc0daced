//! What a report found.

use std::{collections::BTreeMap, path::PathBuf};

use serde::{Deserialize, Serialize};

use super::{gates::GateResult, tool::Tool, why::Why};
use crate::{
    fit::Supply,
    log::{Command, SignalRole, SourceInfo},
    math::range,
    remark::{Code, Remark, Remarks},
    replay::{JointReplay, Profiles, Replay, Swing, swings},
    series::{Broken, Pair, Signal},
    workflow::{
        carried::{Held, Schedule},
        correctable::Uncorrectable,
        plan::PlanDocument,
    },
};

/// How the plan of one joint met its measurement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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

/// What is to be seen to before any start.
#[derive(Debug, Clone, PartialEq)]
pub enum Fault {
    /// The machine stood while its plan went on.
    Stopped {
        /// From when, s; `None` if from the beginning.
        from_s: Option<f64>,
        /// Until when, s; `None` if to the end.
        to_s: Option<f64>,
    },
    /// Joints that never move although their plans do.
    Dead {
        /// The joints.
        joints: Vec<String>,
        /// Planned starts of the dead ones.
        starts: usize,
    },
}

/// A report, before it is rendered.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Names of the files of the run, without their folders.
    pub logs: Vec<String>,
    /// The files and bag directories themselves.
    pub paths: Vec<PathBuf>,
    /// The machine, if metadata of the log name it.
    pub machine: Option<String>,
    /// The run, if metadata of the log name it.
    pub run: Option<String>,
    /// What the command of this run promised, beside what came, if the log carries it.
    pub promised: Option<Held>,
    /// Whether the log holds the task of its plan, so that a gentler plan can be made from it.
    pub holds_task: bool,
    /// Where the plan is broken, so that no command can be made of it.
    pub broken: Option<Broken>,
    /// Where the data come from.
    pub source: SourceInfo,
    /// How plan and measurement were matched, by joint.
    pub alignment: Vec<Alignment>,
    /// What was found.
    pub replay: Replay,
    /// What that makes at the tool.
    pub tool: Tool,
    /// Why starts come late, if that was asked for; or why it cannot be told.
    pub why: Option<Result<Why, String>>,
    /// The limits that were set, each with its outcome.
    pub gates: Vec<GateResult>,
    /// What is to be seen to before any start.
    pub fault: Option<Fault>,
    /// The supply, where its pressure was logged and fell while joints moved.
    pub supply: Option<Supply>,
    /// Why no command can be made from it, as far as a fit was asked for and says so.
    pub unfit: Option<String>,
    /// Why no command is corrected for its plan.
    pub uncorrectable: Option<Uncorrectable>,
    /// What was doubtful.
    pub remarks: Remarks,
    /// Each joint's error over the run, in the order of its joints.
    pub profiles: Profiles,
    /// The aligned samples, for plots.
    pub pairs: Vec<Pair>,
    /// What was sent, for plots, if that was asked for and is in the log.
    pub command: Option<Command>,
    /// Valves and pressures likewise, by joint.
    pub signals: BTreeMap<SignalRole, Vec<Signal>>,
    /// When the key points of the task are passed, where the log tells.
    pub schedule: Option<Schedule>,
    /// The plans that the run's own was chosen from, where its log carries them.
    pub front: Option<PlanDocument>,
}

/// A joint at rest is measured within this many standard deviations of its noise.
const NOISE_SIGMAS: f64 = 10.0;

/// How far something moves in all.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Travel {
    /// Of the plan.
    pub planned: f64,
    /// Of the joint.
    pub measured: f64,
    /// Whether the joint moves by no more than noise does.
    pub rests: bool,
    /// Whether the joint clearly goes as far as its plan, which is too slow or too short for a planned motion.
    pub small: bool,
}

/// A stroke is clear that is so many standard deviations of its noise, and followed where the joint goes as far within this share.
const CLEAR_SIGMAS: f64 = 50.0;
/// And at least this, rad or m.
const CLEAR: f64 = 1e-6;
const ALIKE: f64 = 0.2;

impl Report {
    /// Joints that swing though their plans do not.
    pub fn swings(&self) -> Vec<Swing> {
        swings(&self.pairs, &self.replay)
    }

    /// How far a joint and its plan move in all, in its unit.
    pub fn travel(&self, joint: &JointReplay) -> Travel {
        let own = || self.pairs.iter().filter(|pair| pair.name == joint.name);
        let span = |[lowest, highest]: [f64; 2]| (highest - lowest).max(0.0);
        let planned = span(range(own().flat_map(|pair| pair.planned.iter().copied())));
        let measured = span(range(own().flat_map(|pair| pair.measured.iter().copied())));
        let least = self.replay.rules.sizes(joint.kind).min_travel;
        let rests = measured <= least.max(NOISE_SIGMAS * joint.noise.sigma);
        let small = !joint.plan_moves && is_clear([planned, measured], joint.noise.sigma);
        Travel { planned, measured, rests, small }
    }

    /// What was said of files that look like a run each.
    pub fn several_runs(&self) -> Option<&str> {
        let of = |remark: &&Remark| remark.code == Code::SeveralRuns;
        self.remarks.as_slice().iter().find(of).map(|remark| remark.message.as_str())
    }

    /// Whether every limit is kept.
    pub fn gates_kept(&self) -> bool {
        self.gates.iter().all(|gate| gate.kept)
    }
}

/// Whether a joint clearly goes as far as its plan.
fn is_clear([planned, measured]: [f64; 2], sigma: f64) -> bool {
    planned > (CLEAR_SIGMAS * sigma).max(CLEAR) && (measured - planned).abs() <= ALIKE * planned
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_stroke_is_clear_above_noise_and_shaking_is_none() {
        assert!(is_clear([3e-3, 3.01e-3], 2e-6) && is_clear([24e-6, 24.1e-6], 15e-9));
        assert!(!is_clear([0.0, 1e-4], 1e-5) && !is_clear([1e-4, 1.1e-4], 1e-5) && !is_clear([0.0; 2], 0.0));
    }
}
