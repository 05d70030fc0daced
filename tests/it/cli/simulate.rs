//! `simulate` as an operator meets it: from a task to a run that `report` judges.

use std::fs;

use hydrotrace::log::{ReadOptions, read_recording};

use crate::support::{clean, run_args as hydrotrace, scratch, stderr};

/// A folder with the plan that the paper prints for task 1.
fn planned() -> tempfile::TempDir {
    let folder = scratch();
    clean(folder.path(), "plan task-1.toml --times 0,7.744,15.307,22.863,30.976,38.72 -o plan.mcap");
    folder
}

#[test]
fn a_run_of_a_plan_is_a_log_in_which_joints_start_late_and_carries_its_task() {
    let folder = planned();
    let run = hydrotrace(folder.path(), &["simulate", "plan.mcap", "-o", "run.mcap"]);
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    let log = folder.path().join("run.mcap");
    let recording = read_recording(&[log], &ReadOptions::default()).unwrap();
    assert!(recording.remarks.is_empty(), "{:?}", recording.remarks);
    let names: Vec<&str> = recording.attachments.iter().map(|file| file.name.as_str()).collect();
    assert_eq!(names, ["task.toml", "plan.json"]);
    assert!(recording.metadata.contains_key("hydrotrace.plant"));
    // Rests before and after; the payload is taken up in between.
    let planned = recording.planned.track("J1").unwrap();
    let end_s = planned.t_s().last().unwrap();
    assert!((end_s - (2.0 + 38.72 + 3.0)).abs() < 0.05, "{end_s}");
    let report = hydrotrace(folder.path(), &["report", "run.mcap", "--json"]);
    let report: serde_json::Value = serde_json::from_slice(&report.stdout).unwrap();
    let starts: Vec<_> =
        report["transitions"].as_array().unwrap().iter().filter(|t| t["kind"] == "start").collect();
    assert!(starts.len() >= 8, "{} starts", starts.len());
    let late = starts.iter().filter(|t| t["onset_delay_s"].as_f64().is_some_and(|s| s > 0.05)).count();
    assert!(2 * late > starts.len(), "{late} of {} are late", starts.len());
}

#[test]
fn equal_seeds_give_equal_bytes_and_another_machine_another_run() {
    let folder = planned();
    let run = |name: &str, more: &[&str]| {
        let args = [&["simulate", "plan.mcap", "-o", name], more].concat();
        assert_eq!(hydrotrace(folder.path(), &args).status.code(), Some(0));
        fs::read(folder.path().join(name)).unwrap()
    };
    let first = run("a.mcap", &[]);
    assert!(first == run("b.mcap", &["--seed", "1"]));
    assert!(first != run("c.mcap", &["--seed", "2"]));
    assert!(first != run("d.mcap", &["--plant", "lag-limited"]));
}

#[test]
fn an_unknown_plant_names_the_known_ones_and_a_log_without_a_plan_what_it_has() {
    let folder = planned();
    let run = hydrotrace(folder.path(), &["simulate", "plan.mcap", "-o", "run.mcap", "--plant", "lag"]);
    assert_eq!(run.status.code(), Some(1));
    assert!(stderr(&run).contains("dead-band-limited, default, lag-limited"), "{}", stderr(&run));
    assert!(!folder.path().join("run.mcap").exists());
    let same = hydrotrace(folder.path(), &["simulate", "plan.mcap", "-o", "plan.mcap"]);
    assert_eq!(same.status.code(), Some(1));
}
