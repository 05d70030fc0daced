//! Whether both sides were measured alike.

use std::collections::BTreeMap;

use crate::{
    remark::{Code, Remarks},
    workflow::report::Report,
};

/// Noise, or time between samples, that is larger by this on one side changes peaks and delays by itself.
const APART: f64 = 1.6;

/// Noise that is this share of the peak error of the run at most changes no peak that counts.
const LITTLE: f64 = 0.005;

/// Doubts whether a change is the machine's where noise or rate of the measurement changed.
pub(super) fn sensed_alike(joints: &[String], sides: [&[Report]; 2], remarks: &mut Remarks) {
    let mut found: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for name in joints {
        // Mean noise, time between samples and peak error of a side.
        let of = |reports: &[Report]| {
            let own = reports.iter().filter_map(|r| r.replay.joints.iter().find(|joint| joint.name == *name));
            let of = |joint: &crate::replay::JointReplay| {
                let peak = joint.tracking_error.peak;
                [joint.noise.sigma, joint.sample_interval_s, peak]
            };
            let all: Vec<[f64; 3]> = own.map(of).collect();
            [0, 1, 2].map(|i| all.iter().map(|values| values[i]).sum::<f64>() / all.len().max(1) as f64)
        };
        let [before, after] = sides.map(of);
        let apart = |i: usize| before[i].max(after[i]) > APART * before[i].min(after[i]);
        let noisy = before[0].max(after[0]) > LITTLE * before[2].min(after[2]);
        let what = if apart(0) && noisy {
            let more = before[0].max(after[0]) / before[0].min(after[0]);
            let side = if after[0] > before[0] { "after" } else { "before" };
            format!("noise or step of the measurement is {more:.1} times as large {side}")
        } else if apart(1) {
            let [before_hz, after_hz] = [before[1], after[1]].map(|interval_s| 1.0 / interval_s);
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
