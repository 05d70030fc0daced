//! Set values as drives and event logs write them: in counts, in steps, only now and then.

use std::{fmt::Write as _, fs, path::Path};

use serde_json::Value;

use super::csv::report;

/// How late the joint is, s.
const LATE_S: f64 = 0.13;

/// A table of so many rows a second, 20 s long, of a set value and of a joint that is late and goes to it over so many hundredths of a
/// second; `set` is asked at each row.
fn table((rate_hz, over): (u32, u32), set: impl Fn(f64) -> f64, cell: impl Fn(u32, f64) -> String) -> String {
    let head = "t_s,boom_set_deg,boom_act_deg\n".to_owned();
    (0..20 * rate_hz).fold(head, |mut text, k| {
        let t_s = f64::from(k) / f64::from(rate_hz);
        let before = |back: u32| set((t_s - LATE_S - 0.01 * f64::from(back)).max(0.0));
        let came = (0..over).map(before).sum::<f64>() / f64::from(over);
        writeln!(text, "{t_s:.4},{},{came:.4}", cell(k, set(t_s))).unwrap();
        text
    })
}

fn written(_: u32, value: f64) -> String {
    format!("{value:.4}")
}

/// The report on a table, and its timed starts: when they were planned, and between what their delays lie.
fn starts(folder: &Path, text: &str) -> (Value, Vec<(f64, [f64; 2])>) {
    fs::write(folder.join("run.csv"), text).unwrap();
    let found = report(folder, "run.csv");
    let number = |of: &Value| of.as_f64().unwrap();
    let all = found["transitions"].as_array().unwrap().iter();
    let timed = all.filter(|one| one["kind"] == "start" && one["answer"] == "timed");
    let starts = timed.map(|one| {
        let interval = &one["onset_delay_interval_s"];
        (number(&one["planned_onset_s"]), [number(&interval[0]), number(&interval[1])])
    });
    let starts = starts.collect();
    (found, starts)
}

#[test]
fn a_count_before_a_motion_is_no_start_of_it() {
    const COUNT: f64 = 360.0 / 4096.0;
    let folder = tempfile::tempdir().unwrap();
    for (rate_hz, back_s) in [(30, f64::INFINITY), (100, f64::INFINITY), (100, 1.1)] {
        let set = |t_s: f64| {
            let count = if (1.0..back_s).contains(&t_s) { COUNT } else { 0.0 };
            let rise = |from: f64, over: f64| {
                let x = ((t_s - from) / over).clamp(0.0, 1.0);
                x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)
            };
            ((20.0 * (rise(4.0, 1.0) - rise(9.0, 3.0)) + 30.0 * rise(14.0, 2.0)) / COUNT).round() * COUNT
                - count
        };
        let (_, starts) = starts(folder.path(), &table((rate_hz, 1), set, written));
        assert!(starts.len() >= 3, "{rate_hz} {back_s}: {starts:?}");
        for (planned_s, [low_s, high_s]) in starts {
            let near = [4.0, 9.0, 14.0].iter().any(|from| (from - 0.1..from + 0.4).contains(&planned_s));
            assert!(
                near && low_s < LATE_S + 0.02 && high_s > LATE_S - 0.02,
                "{rate_hz} {back_s}: {planned_s} {low_s} {high_s}"
            );
        }
    }
}

#[test]
fn each_step_between_two_angles_is_a_start_however_many_there_are() {
    let folder = tempfile::tempdir().unwrap();
    let set = |t_s: f64| if (t_s / 0.8).floor().rem_euclid(2.0) > 0.0 { 10.0 } else { 0.0 };
    let (found, starts) = starts(folder.path(), &table((100, 25), set, written));
    assert_eq!((starts.len(), &found["joints"][0]["starts"]), (24, &Value::from(24)));
    assert!(starts.iter().all(|(_, [low_s, high_s])| (*low_s..=*high_s).contains(&LATE_S)), "{starts:?}");
}

#[test]
fn set_values_that_are_written_now_and_then_hold_until_the_next() {
    let folder = tempfile::tempdir().unwrap();
    let set = |t_s: f64| {
        if (2.0..9.47).contains(&t_s) {
            15.0
        } else if t_s < 2.0 {
            5.0
        } else {
            8.0
        }
    };
    let number = |of: &Value| of["joints"][0]["tracking_error"]["rms"].as_f64().unwrap();
    let (whole, _) = starts(folder.path(), &table((100, 25), set, written));
    for refreshed in [100, 400, 4000] {
        let cell = |k: u32, value: f64| {
            let changes = [0, 200, 947].contains(&k);
            if changes || k.is_multiple_of(refreshed) { format!("{value:.4}") } else { String::new() }
        };
        let (found, starts) = starts(folder.path(), &table((100, 25), set, cell));
        assert!((number(&found) / number(&whole) - 1.0).abs() < 0.05, "{refreshed}: {}", found["joints"][0]);
        assert_eq!(starts.len(), 2, "{refreshed}");
        let remarks = found["remarks"].to_string();
        assert!(remarks.contains("held until the next"), "{refreshed}: {remarks}");
    }
}

#[test]
fn what_an_observer_estimates_gives_way_to_what_was_measured() {
    let folder = tempfile::tempdir().unwrap();
    let set = |t_s: f64| 10.0 * (0.5 * t_s).sin();
    let text = table((100, 1), set, written);
    let (before, _) = starts(folder.path(), &text);
    let text: String = text
        .lines()
        .map(|line| {
            if line.starts_with('t') {
                format!("{line},boom_estimate_deg\n")
            } else {
                format!("{line},1.5\n")
            }
        })
        .collect();
    let (beside, _) = starts(folder.path(), &text);
    assert_eq!(before["joints"][0]["tracking_error"], beside["joints"][0]["tracking_error"]);
    assert!(beside["remarks"].to_string().contains("says the same of a joint"), "{}", beside["remarks"]);
}
