//! What a run knows about itself, as the metadata `truth` of its log.

use std::collections::BTreeMap;

use super::{
    machine::{JOINTS, Start},
    run::Run,
};

/// Named texts. Lists are separated by blanks; times count from the first stamp of the log.
pub(crate) fn entries(run: &Run, defects: &[(&str, String)]) -> BTreeMap<String, String> {
    let mut entries: BTreeMap<String, String> =
        defects.iter().map(|(key, value)| ((*key).to_owned(), value.clone())).collect();
    entries.insert("generator".to_owned(), "cargo run --release --example sample_logs".to_owned());
    entries.insert("seed".to_owned(), run.seed.to_string());
    for (place, name) in run.joint_names().into_iter().enumerate() {
        let mut insert = |key: &str, value: String| entries.insert(format!("{name}.{key}"), value);
        let joint = JOINTS[run.order[place]];
        insert("dead_time_up_s", joint.dead_time_s[0].to_string());
        insert("dead_time_down_s", joint.dead_time_s[1].to_string());
        insert("lag_s", joint.lag_s.to_string());
        insert("dead_band_rad_s", format!("{:.6}", joint.dead_band_rad_s));
        insert("gain_1_s", joint.gain_1_s.to_string());
        insert("offset_rad", format!("{:.6}", run.offsets_rad[place]));
        let starts = &run.motions[place].starts;
        insert("starts", starts.len().to_string());
        insert("asked_s", list(starts, |start| format!("{:.3}", start.asked_s)));
        insert("leaves_s", list(starts, |start| format!("{:.3}", start.leaves_s)));
        insert("peak_rad", list(starts, |start| format!("{:.6}", start.peak_rad)));
    }
    entries
}

fn list(starts: &[Start], text: impl Fn(&Start) -> String) -> String {
    starts.iter().map(text).collect::<Vec<_>>().join(" ")
}
