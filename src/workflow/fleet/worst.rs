//! `fleet worst`: the joints of all machines by what their starts are usually like, the worst first.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{
    failure::FleetFailure,
    history::{By, Filter, History},
    map::{Map, maps},
    run::{date, days},
};
use crate::{
    document::PROGRAM,
    math::{median, quantile},
    remark::Remarks,
    replay::Rules,
    series::JointKind,
};

/// What the format is called.
const FORMAT: &str = "hydrotrace.fleet-worst.v1";

/// The joints of a fleet, the worst first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Worst {
    /// Always "hydrotrace.fleet-worst.v1".
    pub format: String,
    /// Name and version of the program that wrote it.
    pub program: String,
    /// What joints are ranked by.
    pub by: By,
    /// Runs that were looked at.
    pub runs: usize,
    /// Machines that they are of.
    pub machines: usize,
    /// By the median, of joints that turn and joints that slide by the error band of settling: 0.1 deg counts as much as 2 mm.
    pub joints: Vec<WorstJoint>,
    /// How the machines did over the days.
    pub map: Option<Map>,
    /// Doubts about the data.
    pub remarks: Remarks,
}

/// A joint of a machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct WorstJoint {
    /// The machine.
    pub machine: String,
    /// The joint.
    pub joint: String,
    /// Unit of the values: "s", "rad" or "m".
    pub unit: String,
    /// Median over all starts (by lag: over all runs).
    pub median: f64,
    /// 95 % of the starts stay below.
    pub p95: f64,
    /// The largest.
    pub largest: f64,
    /// The log of the largest.
    pub log: String,
    /// When the run of the largest began, UTC; null where neither its stamps nor its name say.
    pub at: Option<String>,
    /// Against the median of all machines at the same starts: larger by this share; null where none is shared.
    pub above_fleet: Option<f64>,
    /// Starts.
    pub starts: usize,
    /// Runs.
    pub runs: usize,
}

impl WorstJoint {
    /// The kind of joint that values in its unit are of; `None` of times.
    pub fn kind(&self) -> Option<JointKind> {
        [JointKind::Turns, JointKind::Slides].into_iter().find(|kind| kind.unit() == self.unit)
    }
}

/// Ranks what the filter lets through.
///
/// # Errors
///
/// [`FleetFailure`] if there is no dataset, or no such machine in it.
pub fn worst(root: &Path, filter: &Filter, by: By) -> Result<Worst, FleetFailure> {
    let history = History::read_all(root, filter)?;
    let (usual, shared) = (history.usual(by), history.shared(by));
    let mut joints = Vec::new();
    let wanted = |machine: &str| filter.machine.as_ref().is_none_or(|wanted| wanted == machine);
    for ((axis, metric), values) in &history.values {
        if *metric != by || !wanted(&axis.machine) {
            continue;
        }
        let all: Vec<f64> = values.values().flat_map(|of| of.values().copied()).collect();
        let each = values.values().flat_map(|of| of.iter());
        let Some((run, largest)) = each.clone().max_by(|a, b| a.1.total_cmp(b.1)) else { continue };
        let mut runs: Vec<usize> = each.map(|(run, _)| *run).collect();
        runs.sort_unstable();
        runs.dedup();
        let shares = values.iter().flat_map(|(event, of)| {
            let key = (axis.joint.as_str(), event);
            let usual = usual.get(&key).copied().filter(|usual| *usual > 0.0 && shared.contains(&key));
            of.values().filter_map(move |value| Some(value / usual? - 1.0))
        });
        let shares: Vec<f64> = shares.collect();
        let run = history.runs.get(*run);
        joints.push(WorstJoint {
            machine: axis.machine.clone(),
            joint: axis.joint.clone(),
            unit: if by == By::Peak { axis.unit.clone() } else { "s".to_owned() },
            median: median(all.clone()),
            p95: quantile(all.clone(), 0.95),
            largest: *largest,
            log: run.map(|run| run.log.clone()).unwrap_or_default(),
            at: run.filter(|run| run.is_dated()).and_then(|run| date(days(run))),
            above_fleet: (!shares.is_empty()).then(|| median(shares)),
            starts: all.len(),
            runs: runs.len(),
        });
    }
    let rules = Rules::default();
    let bands =
        |joint: &WorstJoint| joint.kind().map_or(joint.median, |kind| rules.bands(kind, joint.median));
    joints.sort_by(|a, b| bands(b).total_cmp(&bands(a)));
    Ok(Worst {
        format: FORMAT.to_owned(),
        program: PROGRAM.to_owned(),
        by,
        runs: history.runs.len(),
        machines: history.machines().len(),
        map: maps(&history, &[by], wanted).pop(),
        joints,
        remarks: history.remarks,
    })
}
