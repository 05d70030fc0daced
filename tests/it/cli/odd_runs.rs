//! Logs that are cut, have gaps, or hold joints at unlike rates, of which reports once said what was untrue.

use std::{fmt::Write as _, fs, path::Path};

use serde_json::Value;

use crate::support::{run_line as hydrotrace, said};

/// Ten degrees up in 4 s from 2 s on, and so on every 9 s.
fn plan(t: f64) -> f64 {
    let cycle = (t / 9.0).floor();
    let share = ((t - 9.0 * cycle - 2.0) / 4.0).clamp(0.0, 1.0);
    let up = 10.0 * (share - (std::f64::consts::TAU * share).sin() / std::f64::consts::TAU);
    if cycle.rem_euclid(2.0) < 0.5 { up } else { 10.0 - up }
}

/// A table of a joint that follows its plan 0.1 s late, `kick` beside.
fn write(
    folder: &Path,
    name: &str,
    seconds: u32,
    measured: impl Fn(f64) -> f64,
    keeps: impl Fn(f64) -> bool,
) {
    let mut text = String::from("t_s,planned_boom_deg,measured_boom_deg\n");
    for t in (0..seconds * 100).map(|k| 0.01 * f64::from(k)).filter(|t| keeps(*t)) {
        writeln!(text, "{t:.2},{:.5},{:.5}", plan(t), measured(t)).unwrap();
    }
    fs::write(folder.join(name), text).unwrap();
}

fn json(folder: &Path, line: &str) -> (Value, i32) {
    let (code, text, error) = said(&hydrotrace(folder, &format!("{line} --json")));
    (serde_json::from_str(&text).unwrap_or_else(|_| panic!("{line}: {error}")), code)
}

#[test]
fn a_delay_that_is_taken_off_leaves_a_stretch_whole() {
    let folder = tempfile::tempdir().unwrap();
    let late = |t: f64| plan(t - 0.5) + if (30.0..30.3).contains(&(t - 0.5)) { 3.0 } else { 0.0 };
    write(folder.path(), "run.csv", 36, late, |_| true);
    let peak = |more: &str| {
        let (report, _) = json(folder.path(), &format!("report run.csv --measured-delay-ms 500 {more}"));
        report["joints"][0]["tracking_error"]["peak"].as_f64().unwrap()
    };
    let deg = std::f64::consts::PI / 180.0;
    assert!((peak("--to 30.4") - 3.0 * deg).abs() < 0.01 * deg, "{}", peak("--to 30.4"));
    assert!(peak("--to 29.9") < 0.01 * deg && peak("--from 29.8") > 2.9 * deg);
}

#[test]
fn a_gap_within_the_last_rest_is_no_end_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let off = |t: f64| plan(t.min(8.0)) - 0.5 * (t / 8.0).min(1.0);
    let mut text = String::from("t_s,planned_boom_deg,measured_boom_deg\n");
    for t in (0..2400).map(|k| 0.01 * f64::from(k)).filter(|t| !(14.0..15.2).contains(t)) {
        writeln!(text, "{t:.2},{:.5},{:.5}", plan(t.min(8.0)), off(t)).unwrap();
    }
    fs::write(folder.path().join("run.csv"), text).unwrap();
    let urdf = r#"<robot name="r"><link name="a"/><link name="b"/><link name="tip"/>
<joint name="boom" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/></joint>
<joint name="end" type="fixed"><origin xyz="3 0 0"/><parent link="b"/><child link="tip"/></joint></robot>"#;
    fs::write(folder.path().join("arm.urdf"), urdf).unwrap();
    let (report, code) = json(folder.path(), "report run.csv --urdf arm.urdf --max-end-error-mm 40");
    let rests = report["tool"]["rests"].as_array().unwrap();
    assert_eq!((rests.len(), rests[0]["at_end"].as_bool()), (1, Some(true)), "{rests:?}");
    assert!(code != 4 && rests[0]["to_s"].as_f64().unwrap() > 23.0, "{code} {rests:?}");
}

#[test]
fn parts_of_a_recording_are_as_long_as_asked_for_whatever_the_rate_at_first() {
    let folder = tempfile::tempdir().unwrap();
    // A burst at first, then 20 rows a second for a bit more than two minutes.
    let stamps = (0..30).map(|k| 0.001 * f64::from(k)).chain((1..2620).map(|k| 0.05 * f64::from(k)));
    let mut text = String::from("t_s,planned_boom_deg,measured_boom_deg\n");
    for t in stamps {
        writeln!(text, "{t:.3},{:.4},{:.4}", plan(t), plan(t - 0.1)).unwrap();
    }
    fs::write(folder.path().join("in.csv"), text).unwrap();
    let input = fs::File::open(folder.path().join("in.csv")).unwrap();
    let run = crate::support::command(folder.path())
        .args(["record", "--part-minutes", "1", "-o", "rec.mcap"])
        .stdin(input)
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", crate::support::stderr(&run));
    let parts = fs::read_dir(folder.path()).unwrap().filter_map(Result::ok);
    let parts = parts.filter(|file| file.path().extension().is_some_and(|end| end == "mcap")).count();
    assert_eq!(parts, 3);
}

#[test]
fn a_plan_too_slow_to_tell_a_lag_from_breaks_no_limit_on_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = String::from("t_s,planned_boom_deg,measured_boom_deg\n");
    for t in (0..6000).map(|k| 0.01 * f64::from(k)) {
        writeln!(text, "{t:.2},{:.5},{:.5}", 0.08 * t, 0.08 * t - 0.005).unwrap();
    }
    fs::write(folder.path().join("run.csv"), text).unwrap();
    let (_, text, _) = said(&hydrotrace(folder.path(), "report run.csv --max-lag-ms 200"));
    assert!(text.contains("nothing to judge") && !text.contains("no lag in the range"), "{text}");
}

#[test]
fn runs_that_were_split_stay_split_in_the_table_that_is_exported() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = String::from("t_s,planned_boom_deg,measured_boom_deg\n");
    for t in (0..2).flat_map(|_| (0..400).map(|k| 0.02 * f64::from(k))) {
        writeln!(text, "{t:.2},{:.5},{:.5}", plan(t), plan(t - 0.2)).unwrap();
    }
    fs::write(folder.path().join("two.csv"), text).unwrap();
    let (code, ..) = said(&hydrotrace(folder.path(), "export two.csv -o again.csv"));
    assert_eq!(code, 3);
    let starts = |log: &str| {
        let (report, _) = json(folder.path(), &format!("report {log}"));
        report["transitions"].as_array().unwrap().iter().map(|start| start["onset_delay_s"].clone()).collect()
    };
    let [found, again]: [Vec<Value>; 2] = ["two.csv", "again.csv"].map(starts);
    assert!(found.len() == 2 && again == found, "{found:?} {again:?}");
}

#[test]
fn a_second_that_lacks_rows_is_left_out_and_moves_no_start() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = String::from("t_s,planned_boom_deg,measured_boom_deg\n");
    for k in (0..1000).filter(|k| !(110..135).contains(k)) {
        let t = 0.02 * f64::from(k);
        writeln!(text, "{},{:.5},{:.5}", t.floor(), plan(t), plan(t - 0.2)).unwrap();
    }
    fs::write(folder.path().join("run.csv"), text).unwrap();
    let (report, code) = json(folder.path(), "report run.csv");
    let said = report["remarks"].to_string();
    assert!(code == 3 && said.contains("25 rows of steps that lack some are left out"), "{said}");
    let lag_s = report["joints"][0]["lag_s"].as_f64().unwrap();
    assert!((lag_s - 0.2).abs() < 0.005, "{lag_s}");
}

#[test]
fn a_plan_that_is_elsewhere_behind_a_gap_and_rests_there_is_read_to_its_end() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "run.csv", 9, |t| plan(t - 0.1), |t| !(2.5..7.0).contains(&t));
    let (report, _) = json(folder.path(), "report run.csv");
    let rest = report["joints"][0]["standstill_error"]["rms"].as_f64().unwrap();
    assert!(rest < 1e-4, "{rest}");
}
