//! `compare`: what a change did to the tracking error of a task, from runs before and after it.

mod change;
mod document;
mod figures;
mod gates;
mod idle;
mod member;
mod pair;
mod pairing;
mod plans;
mod same;
mod same_day;
mod sensed;
mod stretch;
mod summary;
mod tested;

use std::path::PathBuf;

use thiserror::Error;

pub use change::{Change, Changes};
pub use document::Comparison;
pub use figures::Figures;
pub use gates::{Form, Gate, GateResult, Gates};
pub use idle::Idle;
pub use pair::{Run, Side, TransitionPair, Unpaired};
pub use pairing::PairedBy;
pub use summary::{Scope, Summary};
pub use tested::Verdict;

use super::{
    names::told_apart,
    report::{self, Report, ReportFailure},
};
use crate::{
    document::PROGRAM,
    log::ReadOptions,
    remark::{Code, Remarks},
    replay::{PEAK_ERROR, Rules},
    series::JointKind,
};
use document::FORMAT;
use figures::{figures, tool};
use member::{Member, lacking, pairs};
use pairing::matched;
use same::{each_once, each_run_once, is_one_run, is_same};
use sensed::sensed_alike;
use stretch::cut_alike;
use summary::{overall, summaries, worst};

/// What to compare, how, and what must hold.
#[derive(Debug, Clone, Default)]
pub struct Inputs {
    /// Runs before the change, each a file or a bag directory.
    pub before: Vec<PathBuf>,
    /// Runs after it.
    pub after: Vec<PathBuf>,
    /// What to read of each, where the log alone does not tell.
    pub read: ReadOptions,
    /// Thresholds and windows.
    pub rules: Rules,
    /// Limits that the caller sets.
    pub gates: Gates,
}

/// Why nothing was compared.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message says what each field is")]
pub enum CompareFailure {
    #[error("{} cannot be compared", path.display())]
    Run { path: PathBuf, source: ReportFailure },
    #[error("found no run {0} the change, expected at least one")]
    NoRun(Side),
    #[error(
        "{joint} is logged in {} in {} and in {} in {}: angles and lengths are not compared; --hydraulics turns lengths of \
         cylinders into angles, --slides names joints that slide",
        kinds[0].unit(), logs[0].display(), kinds[1].unit(), logs[1].display()
    )]
    MixedKinds { joint: String, kinds: [JointKind; 2], logs: Box<[PathBuf; 2]> },
    #[error(
        "the runs have no joint in common: {before} before, {after} after; --joints names joints of topics that name none, and \
         `hydrotrace import` gives those of a table other names (--planned NAME=COLUMN, --measured NAME=COLUMN)"
    )]
    NoCommonJoint { before: String, after: String },
}

/// A joint must move in the same way in all runs.
fn check_kinds(joints: &[String], reports: &[&Report]) -> Result<(), CompareFailure> {
    for name in joints {
        let of = |report: &&Report| {
            let joint = report.replay.joints.iter().find(|joint| joint.name == *name)?;
            Some((joint.kind, report.paths.first().cloned().unwrap_or_default()))
        };
        let mut found = reports.iter().filter_map(of);
        let Some((kind, log)) = found.next() else { continue };
        if let Some((other, there)) = found.find(|(other, _)| *other != kind) {
            let (kinds, logs) = ([kind, other], Box::new([log, there]));
            return Err(CompareFailure::MixedKinds { joint: name.clone(), kinds, logs });
        }
    }
    Ok(())
}

/// Compares runs of a task before and after a change; values of several runs of a side are averaged before
/// they are compared.
///
/// # Errors
///
/// [`CompareFailure`] if a run cannot be analysed or the runs share no joint.
pub fn run(inputs: &Inputs) -> Result<Comparison, CompareFailure> {
    let mut remarks = Remarks::default();
    let before = each_once(Side::Before, &inputs.before, &mut remarks);
    let after = each_once(Side::After, &inputs.after, &mut remarks);
    let inputs = &Inputs { before, after, ..inputs.clone() };
    let (paths_before, mut before) =
        each_run_once(Side::Before, analysed(inputs, &inputs.before)?, &mut remarks);
    let (paths_after, mut after) = each_run_once(Side::After, analysed(inputs, &inputs.after)?, &mut remarks);
    let inputs = &Inputs { before: paths_before, after: paths_after, ..inputs.clone() };
    let first = before.first().ok_or(CompareFailure::NoRun(Side::Before))?;
    let first_after = after.first().ok_or(CompareFailure::NoRun(Side::After))?;
    let has = |report: &Report, name: &str| report.replay.joints.iter().any(|joint| joint.name == name);
    let joints: Vec<String> = first
        .replay
        .joints
        .iter()
        .map(|joint| joint.name.clone())
        .filter(|name| before.iter().chain(&after).all(|report| has(report, name)))
        .collect();
    if joints.is_empty() {
        let names = |report: &Report| {
            report.replay.joints.iter().map(|joint| joint.name.as_str()).collect::<Vec<_>>().join(", ")
        };
        return Err(CompareFailure::NoCommonJoint { before: names(first), after: names(first_after) });
    }

    check_kinds(&joints, &before.iter().chain(&after).collect::<Vec<_>>())?;
    let extents = cut_alike(inputs, &joints, &mut before.iter_mut().chain(&mut after).collect::<Vec<_>>())?;
    let (extents_before, extents_after) = extents.split_at(before.len());
    let first = before.first().ok_or(CompareFailure::NoRun(Side::Before))?;
    let mut all: Vec<Member> = Vec::new();
    let mut logs = told_apart(&[&inputs.before[..], &inputs.after].concat()).into_iter();
    for (side, reports, extents) in
        [(Side::Before, &before, extents_before), (Side::After, &after, extents_after)]
    {
        for (k, ((report, extent), log)) in reports.iter().zip(extents).zip(&mut logs).enumerate() {
            let matched = matched(first, report, &joints);
            all.push(Member { side, number: k + 1, log, report, extent, matched });
        }
    }
    let (paired, unpaired) = pairs(first, &all, &joints);
    for (k, a) in inputs.before.iter().enumerate() {
        let is_it = |(other, b): &(usize, &PathBuf)| is_same(a, b) || is_one_run(&before[k], &after[*other]);
        for (_, b) in inputs.after.iter().enumerate().filter(is_it) {
            let (a, b) = (a.display(), b.display());
            let same = "are one and the same run; their difference says nothing";
            remarks.add(Code::SameRun, 1, format!("{a} before and {b} after {same}"));
        }
    }
    let explained = lacking(&all, first.replay.transitions.len(), &mut remarks);
    for (member, explained) in all.iter().zip(explained) {
        let of_side = all.iter().filter(|other| other.side == member.side).count();
        member.remark(of_side, &joints, (&unpaired, explained), &mut remarks);
    }
    sensed_alike(&joints, [&before, &after], &mut remarks);
    let summaries = summaries(&paired, &joints, &inputs.rules);
    let by_runs = summaries.iter().any(|summary| summary.by_runs.is_some());
    same_day::told([&before, &after], by_runs, &mut remarks);
    let pairs: Vec<TransitionPair> = paired.into_iter().map(|paired| paired.pair).collect();
    let whole_run = figures(&before, &after, &joints, &inputs.rules);
    let tool = tool(&before, &after);
    // A run that was not to move has little error, and proves nothing.
    let moves = |side: &[Report]| side.iter().all(|run| run.replay.joints.iter().any(|j| j.plan_moves));
    let alike = moves(&before) == moves(&after);
    let judged = (if alike { &whole_run[..] } else { &[] }, tool.as_ref().filter(|_| alike));
    let gates = inputs.gates.judge(&pairs, &summaries, judged);
    let runs = |side: Side| all.iter().filter(|m| m.side == side).map(|m| m.run(&joints)).collect();
    let (runs_before, runs_after): (Vec<Run>, Vec<Run>) = (runs(Side::Before), runs(Side::After));
    let same_plan = runs_after.iter().all(|run| run.same_plan);
    if !same_plan && !gates.is_empty() {
        let message = "the limits are judged between runs of different plans, and what changed is that of the plans too: compare runs of \
                       one plan where it is the machine that is judged";
        remarks.add(Code::OtherPlan, 1, message);
    }
    let samples = |reports: &mut [Report]| {
        reports.first_mut().map_or_else(Vec::new, |report| std::mem::take(&mut report.pairs))
    };
    Ok(Comparison {
        format: FORMAT.to_owned(),
        program: PROGRAM.to_owned(),
        same_plan,
        before: runs_before,
        after: runs_after,
        joints: joints.clone(),
        verdict: worst(&overall(&summaries, PEAK_ERROR)),
        summaries,
        pairs,
        unpaired,
        whole_run,
        tool,
        gates_kept: gates.iter().all(|gate| gate.kept),
        gates,
        rules: inputs.rules.clone(),
        remarks,
        samples: [samples(&mut before), samples(&mut after)],
    })
}

fn analysed(inputs: &Inputs, logs: &[PathBuf]) -> Result<Vec<Report>, CompareFailure> {
    let analyse = |path: &PathBuf| {
        let (logs, read, rules) = (vec![path.clone()], inputs.read.clone(), inputs.rules.clone());
        let inputs = report::Inputs { logs, read, rules, ..report::Inputs::default() };
        report::run(&inputs).map_err(|source| CompareFailure::Run { path: path.clone(), source })
    };
    logs.iter().map(analyse).collect()
}
