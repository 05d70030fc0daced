//! The runs of both sides, and what they have in common.

use super::{
    change::{Change, Changes},
    pair::{Paired, Run, Side, TransitionPair, Unpaired},
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
        let [turning, sliding] = plans.map_or([None; 2], |plans| plans.most);
        Run {
            log: self.log.clone(),
            source: self.report.source.clone(),
            transitions: replay.transitions.iter().filter(|t| joints.contains(&t.joint)).count(),
            plan_duration_s: self.extent.plan_duration_s,
            stretch_s: self.extent.stretch_s,
            offset_s: self.matched.offset_s,
            plan_difference: turning.or(sliding),
            plan_difference_m: sliding.filter(|_| turning.is_some()),
            same_plan: plans.is_some_and(|plans| plans.same),
            promised: self.report.promised,
        }
    }

    /// Doubts about this run, with its name in front.
    pub(super) fn remark(
        &self,
        of_side: usize,
        joints: &[String],
        (unpaired, explained): (&[Unpaired], usize),
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
        remarks.add(Code::Unmatched, alone.saturating_sub(explained) as u64, message);
        if self.side == Side::Before && self.number > 1 && !self.matched.plans.is_some_and(|plans| plans.same)
        {
            let message =
                format!("{name}: another plan than that of the first run before; their means mix both");
            remarks.add(Code::NotSupported, 1, message);
        }
    }
}

/// Tells which run alone lacks starts that all the others have, so that they are compared in none; and of each run how
/// many of its starts another one lacks.
pub(super) fn lacking(all: &[Member<'_>], transitions: usize, remarks: &mut Remarks) -> Vec<usize> {
    let mut explained = vec![0; all.len()];
    if all.len() < 3 {
        return explained;
    }
    let has = |member: &Member<'_>, i: usize| member.matched.partners.get(i).is_some_and(Option::is_some);
    for (k, member) in all.iter().enumerate() {
        let others = |i: usize| all.iter().enumerate().all(|(other, member)| other == k || has(member, i));
        let alone = (0..transitions).filter(|&i| !has(member, i) && others(i)).count();
        // What the others hold beyond its end, or before its beginning, was cut from them.
        let cut = |other: &Member<'_>| other.extent.beyond.len();
        let of_others = all.iter().enumerate().filter(|(other, _)| *other != k).map(|(_, other)| cut(other));
        let cut = if cut(member) == 0 { of_others.min().unwrap_or(0) } else { 0 };
        let lacks = alone + cut;
        let message = format!(
            "{} {} lacks starts that every other run has, so that they are compared in none; leave {} out to compare them",
            member.side, member.number, member.log
        );
        remarks.add(Code::Unmatched, lacks as u64, message);
        for (_, explained) in explained.iter_mut().enumerate().filter(|(other, _)| *other != k) {
            *explained += lacks;
        }
    }
    explained
}

/// Transitions of the first run that every run has, and all that are left over.
pub(super) fn pairs<'a>(
    first: &Report,
    all: &[Member<'a>],
    joints: &[String],
) -> (Vec<Paired<'a>>, Vec<Unpaired>) {
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
        let of = |side: Side| -> Vec<(&'a Transition, PairedBy)> {
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
        let pair = TransitionPair {
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
        };
        let runs = [before, after].map(|side| side.into_iter().map(|(transition, _)| transition).collect());
        pairs.push(Paired { pair, runs });
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
