//! The runs of both sides, and what they have in common.

use super::{
    change::{Change, Changes},
    pair::{Run, Side, TransitionPair, Unpaired},
    pairing::{Match, PairedBy},
    stretch::Extent,
};
use crate::{
    remark::{Code, Remarks},
    replay::{Answer, Metric, Transition},
    workflow::report::Report,
};

/// A run among those compared.
pub(super) struct Member<'a> {
    pub(super) side: Side,
    /// Among those of its side, from 1.
    pub(super) number: usize,
    pub(super) log: String,
    pub(super) report: &'a Report,
    pub(super) extent: &'a Extent,
    /// How it corresponds to the first run before.
    pub(super) matched: Match,
}

impl Member<'_> {
    pub(super) fn run(&self, joints: &[String]) -> Run {
        let replay = &self.report.replay;
        let plans = self.matched.plans;
        Run {
            log: self.log.clone(),
            source: self.report.source.clone(),
            transitions: replay.transitions.iter().filter(|t| joints.contains(&t.joint)).count(),
            plan_duration_s: self.extent.plan_duration_s,
            stretch_s: self.extent.stretch_s,
            offset_s: self.matched.offset_s,
            plan_difference: plans.map(|plans| plans.most_rad),
            same_plan: plans.is_some_and(|plans| plans.same),
            promised: self.report.promised,
        }
    }

    /// Doubts about this run, with its name in front.
    pub(super) fn remark(
        &self,
        of_side: usize,
        joints: &[String],
        unpaired: &[Unpaired],
        remarks: &mut Remarks,
    ) {
        let name = if of_side > 1 { format!("{} {}", self.side, self.number) } else { self.side.to_string() };
        for remark in self.report.remarks.as_slice() {
            remarks.add(remark.code, remark.count, format!("{name}: {}", remark.message));
        }
        for joint in self.report.replay.joints.iter().filter(|joint| !joints.contains(&joint.name)) {
            let message = format!("{name}: {} is not in every run; left out", joint.name);
            remarks.add(Code::UnpairedJoint, 1, message);
        }
        let alone = unpaired.iter().filter(|u| u.side == self.side && u.run == self.number).count();
        let message = format!("{name}: planned starts without a counterpart in every other run; left out");
        remarks.add(Code::Unmatched, alone as u64, message);
        if self.side == Side::Before && self.number > 1 && !self.matched.plans.is_some_and(|plans| plans.same)
        {
            let message =
                format!("{name}: another plan than that of the first run before; their means mix both");
            remarks.add(Code::NotSupported, 1, message);
        }
    }
}

/// Transitions of the first run that every run has, and all that are left over.
pub(super) fn pairs(
    first: &Report,
    all: &[Member<'_>],
    joints: &[String],
) -> (Vec<TransitionPair>, Vec<Unpaired>) {
    let mut pairs = Vec::new();
    let mut used: Vec<Vec<bool>> =
        all.iter().map(|m| vec![false; m.report.replay.transitions.len()]).collect();
    for (i, transition) in first.replay.transitions.iter().enumerate() {
        let partners: Option<Vec<(usize, PairedBy)>> =
            all.iter().map(|member| member.matched.partners.get(i).copied().flatten()).collect();
        let Some(partners) = partners else { continue };
        for (used, (j, _)) in used.iter_mut().zip(&partners) {
            if let Some(used) = used.get_mut(*j) {
                *used = true;
            }
        }
        let of = |side: Side| -> Vec<(&Transition, PairedBy)> {
            let members = all.iter().zip(&partners).filter(|(member, _)| member.side == side);
            members.filter_map(|(m, (j, by))| Some((m.report.replay.transitions.get(*j)?, *by))).collect()
        };
        let (before, after) = (of(Side::Before), of(Side::After));
        let change = |metric: &Metric<Transition>| {
            let values = |side: &[(&Transition, PairedBy)]| {
                side.iter().map(|(t, _)| metric.number(t)).collect::<Vec<_>>()
            };
            Change::of_runs(&values(&before), &values(&after))
        };
        let worst = |side: &[(&Transition, PairedBy)]| {
            side.iter().map(|(t, _)| t.answer).max().unwrap_or(Answer::Timed)
        };
        let by = [PairedBy::Order, PairedBy::Task]
            .into_iter()
            .find(|way| before.iter().chain(&after).any(|(_, by)| by == way));
        pairs.push(TransitionPair {
            joint: transition.joint.clone(),
            joint_kind: transition.joint_kind,
            kind: transition.kind,
            direction: transition.direction,
            planned_onset_before_s: transition.planned_onset_s,
            planned_onset_after_s: after
                .first()
                .map_or(transition.planned_onset_s, |(t, _)| t.planned_onset_s),
            paired_by: by.unwrap_or(PairedBy::Clock),
            answer_before: worst(&before),
            answer_after: worst(&after),
            changes: Changes::of(change),
        });
    }
    let alone = |(member, used): (&Member<'_>, Vec<bool>)| {
        let within = member.report.replay.transitions.iter().zip(used).filter(|(_, used)| !used);
        let left = within.map(|(t, _)| t).chain(&member.extent.beyond);
        left.filter(|t| joints.contains(&t.joint))
            .map(|t| Unpaired {
                side: member.side,
                run: member.number,
                joint: t.joint.clone(),
                joint_kind: t.joint_kind,
                kind: t.kind,
                direction: t.direction,
                planned_onset_s: t.planned_onset_s,
                peak_error: t.peak_error,
            })
            .collect::<Vec<_>>()
    };
    (pairs, all.iter().zip(used).flat_map(alone).collect())
}
