//! Doubts about joints that move before their plan.

use crate::{
    log::Recording,
    remark::{Code, Remarks},
    replay::{JointReplay, Replay, Rules, replay},
    series::Pair,
    workflow::carried::Carried,
};

/// Doubts a recording whose joints lead its plan, unless a command was sent beside it: that may have been made ahead of it.
pub(super) fn doubt_leads(recording: &Recording, remarks: &mut Remarks) {
    if Carried::of(recording).promise().is_some() || recording.command.is_some() {
        return;
    }
    let pairs = recording.pairs();
    remark_leads(&pairs, &replay(&pairs, &Rules::default()), remarks);
}

/// Joints whose speed follows the planned one this well tell which comes first.
const TELLING_CORRELATION: f64 = 0.9;
/// Set values and stamps are apart by as much, s, or by two samples.
const NOT_APART_S: f64 = 0.02;

/// Joints that move before their plan, unless the log says already that they do so at another time.
pub(super) fn remark_leads(pairs: &[Pair], replay: &Replay, remarks: &mut Remarks) {
    if remarks.as_slice().iter().any(|remark| remark.code == Code::OtherTime) {
        return;
    }
    let leads = |joint: &JointReplay| {
        let pair = pairs.iter().find(|pair| pair.name == joint.name)?;
        let apart_s = NOT_APART_S.max(2.0 * joint.sample_interval_s.max(pair.planned_interval_s));
        let (lag_s, [from_s, to_s]) = (joint.lag_s?, joint.lag_interval_s?);
        let telling = joint.lag_correlation.is_some_and(|correlation| correlation >= TELLING_CORRELATION);
        (telling && to_s < -apart_s).then(|| (joint.name.clone(), [-lag_s, -to_s, -from_s].map(|s| 1e3 * s)))
    };
    let leads: Vec<_> = replay.joints.iter().filter_map(leads).collect();
    if let Some((joint, [ms, least_ms, most_ms])) = leads.iter().max_by(|a, b| a.1[0].total_cmp(&b.1[0])) {
        let message = format!(
            "{joint} moves {ms:.0} ms (95 %: {least_ms:.0} to {most_ms:.0}) before its plan: are plan and measurement swapped \
             (--planned, --measured), or are they stamped by clocks that differ (--measured-delay-ms)?"
        );
        remarks.add(Code::BeforePlan, leads.len() as u64, message);
    }
}
