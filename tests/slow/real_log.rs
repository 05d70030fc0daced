//! A log of a real arm that nobody here wrote; not part of the project, so named by a variable.
//!
//! Facts about it were found with other tools: six joints start together near 28.45 s and again
//! near 34.6 to 35.2 s, the seventh never moves, the error peaks at 0.0788 rad on the sixth,
//! lags are near 60 ms (joints 1 to 4) and 120 ms (5 and 6).
//!
//! Dead times read off its samples, from the first planned one above rest to the first measured
//! one 0.03 deg above rest, are 0.10 to 0.16 s on joints 1 to 4 and 6. At 0.05 deg/s, where
//! hydrotrace dates both, the first joints leave up to 30 ms earlier. The fifth sticks, and jumps
//! between 28.69 and 28.71 s, 0.22 to 0.24 s after its plan.

use serde_json::Value;

use crate::support::run_at_root;

fn report() -> Value {
    let log = std::env::var("HYDROTRACE_REAL_LOG").expect("HYDROTRACE_REAL_LOG names the log");
    let run = run_at_root(&["report", &log, "--json"]);
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    serde_json::from_slice(&run.stdout).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

#[test]
#[ignore = "needs the real log: HYDROTRACE_REAL_LOG=..."]
fn the_real_log_reports_what_other_tools_found() {
    let report = report();
    let source = &report["source"];
    assert_eq!(source["time_base"], "header");
    assert_eq!(source["messages"], 2206);
    assert_eq!(source["planned_topic"], "/arm_right_controller/state");
    let joints = report["joints"].as_array().unwrap();
    assert_eq!(joints.len(), 7);
    assert_eq!((&joints[6]["moves"], &joints[6]["lag_s"]), (&Value::Bool(false), &Value::Null));
    let peaks: Vec<f64> = joints.iter().map(|j| number(&j["tracking_error"]["peak"])).collect();
    assert!((peaks[5] - 0.0788).abs() < 0.0001, "{peaks:?}");
    assert!(peaks.iter().all(|p| *p <= peaks[5]), "{peaks:?}");
    for (index, joint) in joints.iter().enumerate().take(6) {
        let lag_s = number(&joint["lag_s"]);
        let expected_s = if index < 4 { 0.055 } else { 0.117 };
        assert!((lag_s - expected_s).abs() < 0.012, "joint {} lags {lag_s} s", index + 1);
        assert!(number(&joint["lag_correlation"]) > 0.99);
        let name = &joint["name"];
        let first = report["transitions"].as_array().unwrap().iter().find(|t| &t["joint"] == name).unwrap();
        let delay_s = number(&first["onset_delay_s"]);
        let most_s = number(&first["onset_delay_interval_s"][1]);
        let expected_s = if index == 4 { 0.21..0.25 } else { 0.06..0.21 };
        assert!(expected_s.contains(&delay_s) && most_s > 0.10, "{name} answers after {delay_s} s");
        let onsets: Vec<f64> = report["transitions"]
            .as_array()
            .unwrap()
            .iter()
            .filter(|t| &t["joint"] == name)
            .map(|t| number(&t["planned_onset_s"]))
            .collect();
        assert!(onsets.iter().any(|t| (t - 28.45).abs() < 0.06), "{name}: {onsets:?}");
        assert!(onsets.iter().any(|t| (34.5..35.25).contains(t)), "{name}: {onsets:?}");
    }
}
