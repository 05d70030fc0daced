//! Whether both sides were measured alike.

use std::collections::BTreeMap;

use crate::{
    remark::{Code, Remarks},
    replay::JointReplay,
    workflow::{report::Report, sensed::Sensed},
};

fn of(joint: &str, reports: &[Report]) -> Sensed {
    let own = || reports.iter().filter_map(|r| r.replay.joints.iter().find(|own| own.name == joint));
    let mean = |of: &dyn Fn(&JointReplay) -> f64| own().map(of).sum::<f64>() / own().count().max(1) as f64;
    Sensed {
        noise: mean(&|joint| joint.noise.sigma),
        interval_s: mean(&|joint| joint.sample_interval_s),
        peak_error: mean(&|joint| joint.tracking_error.peak),
    }
}

/// Doubts whether a change is the machine's where noise or rate of the measurement changed.
pub(super) fn sensed_alike(joints: &[String], sides: [&[Report]; 2], remarks: &mut Remarks) {
    let mut found: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for name in joints {
        let [before, after] = sides.map(|reports| of(name, reports));
        let what = if before.other_noise(after) {
            let more = before.noise.max(after.noise) / before.noise.min(after.noise);
            let side = if after.noise > before.noise { "after" } else { "before" };
            if more.is_finite() {
                format!("noise or step of the measurement is {more:.1} times as large {side}")
            } else {
                format!("the measurement has noise or a step {side}, and on the other side none at all")
            }
        } else if before.other_rate(after) {
            let [before_hz, after_hz] = [before, after].map(|side| 1.0 / side.interval_s);
            format!("sampled at {before_hz:.0} Hz before and at {after_hz:.0} Hz after")
        } else {
            continue;
        };
        found.entry(what).or_default().push(name);
    }
    for (what, names) in found {
        let message = format!(
            "{}: {what}: peaks of noisier or denser samples are larger by themselves, and delays of noisier or sparser ones later; \
             compare runs that were measured alike",
            names.join(", ")
        );
        remarks.add(Code::MeasuredOtherwise, names.len() as u64, message);
    }
}
