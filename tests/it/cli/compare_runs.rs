//! `compare` of several runs a side: what differs from run to run is no change.

use std::{fmt::Write as _, fs, path::Path};

use serde_json::Value;

use crate::support::{fleet::smooth, run_line, stdout};

const JOINTS: [&str; 3] = ["boom", "stick", "swing"];

/// Two moves of each joint, one after the other, in all 12 starts; the joints are behind by these times, s.
fn run(folder: &Path, name: &str, behind_s: [f64; 3], hz: f64, until_s: f64) {
    let planned = |joint: usize, t_s: f64| {
        let moves = (0..4).map(|k| {
            let direction = if k % 2 == 0 { 12.0 } else { -12.0 };
            direction * smooth((t_s - 2.0 - 12.0 * f64::from(k) - 4.0 * joint as f64) / 3.0)
        });
        moves.sum::<f64>()
    };
    let mut text = "time_s".to_owned();
    for joint in JOINTS {
        write!(text, ",{joint}_planned_deg,{joint}_measured_deg").unwrap();
    }
    let mut t_s = 0.0;
    while t_s <= until_s {
        write!(text, "\n{t_s:.4}").unwrap();
        for (joint, behind_s) in behind_s.into_iter().enumerate() {
            write!(text, ",{:.5},{:.5}", planned(joint, t_s), planned(joint, t_s - behind_s)).unwrap();
        }
        t_s += 1.0 / hz;
    }
    fs::write(folder.join(name), text).unwrap();
}

/// How much further behind than usual the runs are.
const SCATTER: [[f64; 5]; 2] = [[0.90, 1.05, 1.10, 0.97, 1.00], [1.04, 0.93, 1.00, 1.12, 0.95]];

/// Five runs a side, of joints that are behind by these times before and after, s; the line that compares them.
fn five(folder: &Path, behind_s: [[f64; 3]; 2]) -> String {
    let mut line = "compare b0.csv a0.csv".to_owned();
    for (side, (scatter, behind_s)) in ["b", "a"].iter().zip(SCATTER.iter().zip(behind_s)) {
        for (k, scatter) in scatter.iter().enumerate() {
            run(folder, &format!("{side}{k}.csv"), behind_s.map(|s| s * scatter), 50.0, 54.0);
            if k > 0 {
                let option = if *side == "b" { "before" } else { "after" };
                write!(line, " --more-{option} {side}{k}.csv").unwrap();
            }
        }
    }
    line
}

#[test]
fn what_differs_from_run_to_run_is_no_change_of_the_machine() {
    let folder = tempfile::tempdir().unwrap();
    let line = five(folder.path(), [[0.2; 3]; 2]);
    let found = run_line(folder.path(), &line);
    assert!(stdout(&found).contains("what differs from run to run could explain it"), "{}", stdout(&found));
    let document: Value =
        serde_json::from_slice(&run_line(folder.path(), &format!("{line} --json")).stdout).unwrap();
    assert_eq!(document["verdict"], "not-shown");
    for summary in document["summaries"].as_array().unwrap() {
        let [low, high] = [0, 1].map(|end| summary["interval_95"][end].as_f64().unwrap());
        assert!(low < 0.0 && high > 0.0 && summary["by_runs"] == serde_json::json!([5, 5]), "{summary}");
    }
    // Of one run a side nobody knows.
    let found = stdout(&run_line(folder.path(), "compare b0.csv a0.csv"));
    assert!(found.contains("became larger") && found.contains("Three runs a side tell it apart"), "{found}");
}

#[test]
fn the_joint_that_changed_is_named_though_the_others_did_not() {
    let folder = tempfile::tempdir().unwrap();
    let line = five(folder.path(), [[0.4, 0.1, 0.2], [0.2, 0.1, 0.2]]);
    let found = stdout(&run_line(folder.path(), &line));
    let named =
        found.lines().find(|line| line.starts_with("By joint, where the interval clearly leaves out zero"));
    let named = named.unwrap_or_else(|| panic!("{found}"));
    assert!(named.contains("peak error boom -") && named.contains("start delay boom -"), "{named}");
    assert!(!named.contains("stick") && !named.contains("swing"), "{named}");
}

#[test]
fn runs_that_were_measured_otherwise_and_a_run_that_ends_early_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let line = five(folder.path(), [[0.2; 3]; 2]);
    run(folder.path(), "sparse.csv", [0.2; 3], 10.0, 54.0);
    let found = run_line(folder.path(), "compare b4.csv sparse.csv");
    assert_eq!(found.status.code(), Some(3));
    assert!(stdout(&found).contains("sampled at 50 Hz before and at 10 Hz after"), "{}", stdout(&found));
    run(folder.path(), "a2.csv", [0.2; 3], 50.0, 30.0);
    let found = stdout(&run_line(folder.path(), &line));
    assert!(found.contains("unmatched x5  after 3 lacks starts that every other run has"), "{found}");
    assert!(!found.contains("before 1: planned starts without a counterpart"), "{found}");
}

/// What moves from its first sample on has no rest to cut.
#[test]
fn plans_that_move_all_the_time_are_compared_whole() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, period_s: f64, until_s: f64, off_deg: f64| {
        let mut text = "time_s,boom_planned_deg,boom_measured_deg".to_owned();
        for t_s in (0..).map(|k| 0.02 * f64::from(k)).take_while(|t_s| *t_s < until_s) {
            let planned = 20.0 * (std::f64::consts::TAU * t_s / period_s).sin();
            // Farthest off at the end.
            let off = off_deg * (t_s - until_s + 1.0).max(0.2);
            write!(text, "\n{t_s:.2},{planned:.5},{:.5}", planned - off).unwrap();
        }
        fs::write(folder.path().join(name), text).unwrap();
    };
    // After the last reversal the plan moves on for 2 s before, for 0.5 s after.
    write("before.csv", 8.0, 24.0, 5.0);
    write("after.csv", 6.0, 17.0, 5.2);
    let (code, document) = {
        let run = run_line(folder.path(), "compare before.csv after.csv --max-peak-ratio 1.1 --json");
        (run.status.code(), serde_json::from_slice::<Value>(&run.stdout).unwrap())
    };
    assert!(code != Some(4) && document["gates_kept"] == true, "{code:?} {}", document["gates"]);
    assert!(document["before"][0]["stretch_s"].is_null(), "{}", document["before"][0]);
    let peak = &document["whole_run"][0]["peak"]["before"];
    assert!((peak.as_f64().unwrap().to_degrees() - 4.9).abs() < 0.05, "{peak}");
}
