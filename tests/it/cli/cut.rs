//! What was cut, and what is not alike: nothing is learnt from what nobody measured, and no number is of two units.

use std::{fs, path::Path};

use serde_json::Value;

use crate::support::{clean, json, run_line, said, sample, scratch};

fn with(names: &[&str]) -> tempfile::TempDir {
    let folder = scratch();
    for name in names {
        fs::copy(sample(name), folder.path().join(name)).unwrap();
    }
    folder
}

#[test]
fn a_plan_that_was_cut_in_its_motion_is_not_planned_again() {
    let folder = with(&["panel-install.mcap", "task-1-run.mcap"]);
    let whole = fs::read(folder.path().join("task-1-run.mcap")).unwrap();
    fs::write(folder.path().join("torn.mcap"), &whole[..100_000]).unwrap();
    for line in [
        "replan panel-install.mcap --keep-plan --to 21 -o next.mcap",
        "replan torn.mcap --keep-plan -o next.mcap",
    ] {
        let (code, _, error) = said(&run_line(folder.path(), line));
        assert!(
            code == 1 && error.contains("the log was cut, and no arm stops at once"),
            "{line}: {code} {error}"
        );
        assert!(!folder.path().join("next.mcap").exists());
    }
    let begun = "replan panel-install.mcap --keep-plan --from 5 -o next.mcap";
    let (code, _, error) = said(&run_line(folder.path(), begun));
    assert!(code == 1 && error.contains("begins at") && error.contains("no arm starts at once"), "{error}");
    assert!(!folder.path().join("next.mcap").exists());
}

/// An operator stops the master: what it writes of the set values stands, and so does the plan, or the plan alone goes on.
#[test]
fn a_run_that_was_broken_off_is_none_of_its_plan_whatever_stands() {
    let folder = with(&["task-1-run.mcap"]);
    let folder = folder.path();
    let (_, text, _) = said(&run_line(folder, "export task-1-run.mcap --csv"));
    let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let time = header.iter().position(|name| *name == "time_s").unwrap();
    let table = |name: &str, stands: &[&str]| {
        let stands: Vec<bool> = header.iter().map(|name| stands.iter().any(|of| name.contains(of))).collect();
        let mut held: Vec<&str> = Vec::new();
        let row = |row| {
            let now: Vec<&str> = str::split(row, ',').collect();
            let stopped = now[time].parse::<f64>().is_ok_and(|t_s| t_s >= 12.0);
            if !stopped {
                held.clone_from(&now);
            }
            let of = |k: usize| match header[k].ends_with("_rad_s") {
                _ if !stopped || !stands[k] => now[k],
                true => "0",
                false => held[k],
            };
            (0..now.len()).map(of).collect::<Vec<_>>().join(",") + "\n"
        };
        fs::write(folder.join(name), text.lines().map(row).collect::<String>()).unwrap();
    };
    table("plan-too.csv", &["_planned_", "_command_", "_measured_"]);
    table("sent.csv", &["_command_", "_measured_"]);
    for (log, told) in [("plan-too.csv", "stops at once"), ("sent.csv", "the machine was stopped")] {
        let line = format!("replan task-1-run.mcap {log} -o next.mcap");
        let (code, out, error) = said(&run_line(folder, &line));
        assert!(code == 1 && error.contains(told), "{log}: {code} {out} {error}");
        assert!(!folder.join("next.mcap").exists());
    }
}

#[test]
fn a_gap_in_the_measurement_teaches_nothing() {
    let folder = with(&["gaps.mcap"]);
    let planned = json(folder.path(), "replan gaps.mcap --keep-plan");
    let joints = planned["command"].as_array().unwrap();
    let of = |joint: &Value, key: &str| joint[key].as_f64().unwrap();
    let reported = json(folder.path(), "report gaps.mcap");
    for joint in joints {
        let own =
            reported["joints"].as_array().unwrap().iter().find(|one| one["name"] == joint["name"]).unwrap();
        let peak = own["tracking_error"]["peak"].as_f64().unwrap();
        assert!(of(joint, "peak_correction_rad") < 1.3 * peak, "{joint:#} {peak}");
    }
    // Nor is it expected of the next run.
    let (before, after) =
        (of(&planned["before"], "measured_worst_peak_rad"), of(&planned["after"], "worst_peak_rad"));
    assert!(after < 1.5 * before, "{before} {after}");
    let unseen = joints.iter().map(|joint| of(joint, "unseen_s")).fold(0.0, f64::max);
    assert!(unseen > 1.0, "{unseen}");
    assert!(planned["remarks"].to_string().contains("nothing is learnt there"), "{}", planned["remarks"]);
}

#[test]
fn a_start_at_the_cut_end_of_a_log_is_not_unanswered() {
    let folder = with(&["task-1-run.mcap"]);
    let cut = json(folder.path(), "report task-1-run.mcap --to 4.05");
    let starts = cut["transitions"].as_array().unwrap();
    assert!(!starts.is_empty() && starts.iter().all(|start| start["answer"] != "never"), "{starts:#?}");
}

#[test]
fn a_peak_that_a_gap_cuts_short_is_told_to_be_at_least_that() {
    let folder = scratch();
    // Half a second of growing error after the start at 2 s, then nothing for three seconds.
    let row = |k: i32| {
        let t_s = f64::from(k) * 0.02;
        let plan = 20.0 * (t_s - 2.0).clamp(0.0, 2.0);
        let measured = 20.0 * (t_s - 2.3).clamp(0.0, 2.0) * 0.5;
        format!("{t_s:.2},{plan:.4},{measured:.4}\n")
    };
    let table = |until: i32| {
        let rows: String = (0..400).filter(|k| *k < until || *k > 275).map(row).collect();
        format!("t,boom_set_deg,boom_act_deg\n{rows}")
    };
    for (name, until, says) in [("gap.csv", 126, true), ("whole.csv", 400, false)] {
        fs::write(folder.path().join(name), table(until)).unwrap();
        let found = json(folder.path(), &format!("report {name}"));
        assert_eq!(
            found["remarks"].to_string().contains("at a gap or with the log, the first one boom at 2.0"),
            says,
            "{name} {found:#}"
        );
    }
    let found = json(folder.path(), "report whole.csv --to 2.5");
    assert!(!found["remarks"].to_string().contains("still grows"), "{found:#}");
}

#[test]
fn lengths_and_angles_of_one_joint_are_not_compared_and_not_joined() {
    let folder = with(&["task-1-run.mcap"]);
    let hydraulics = sample("arm/hydraulics.toml").display().to_string();
    let line = format!("export task-1-run.mcap --hydraulics {hydraulics} --as cylinders -o lengths.csv");
    let (code, _, error) = said(&run_line(folder.path(), &line));
    assert!(code == 0 || code == 3, "{error}");
    let (code, _, error) = said(&run_line(folder.path(), "compare task-1-run.mcap lengths.csv"));
    assert!(code == 1 && error.contains("angles and lengths are not compared"), "{code} {error}");
    let line = format!("join lengths.csv --plan task-1-run.mcap --hydraulics {hydraulics} -o joined.mcap");
    let (code, _, error) = said(&run_line(folder.path(), &line));
    assert!(code == 1 && error.contains("give a plan in lengths"), "{code} {error}");
    assert!(!folder.path().join("joined.mcap").exists());
}

#[test]
fn a_page_does_not_replace_the_plan_nor_a_file_that_was_read() {
    let folder = with(&["task-1-run.mcap"]);
    clean(folder.path(), "fit task-1-run.mcap -o limits.toml");
    let limits = fs::read(folder.path().join("limits.toml")).unwrap();
    for page in ["next.mcap", "limits.toml", "task-1-run.mcap", "-"] {
        let line =
            format!("replan task-1-run.mcap --limits limits.toml --keep-plan -o next.mcap --html {page}");
        let (code, _, error) = said(&run_line(folder.path(), &line));
        assert!(code == 1 || code == 2, "{page}: {code} {error}");
        assert!(!folder.path().join("next.mcap").exists() && !folder.path().join("-").exists(), "{page}");
        assert_eq!(fs::read(folder.path().join("limits.toml")).unwrap(), limits);
    }
}

#[test]
fn no_command_is_made_across_a_hole_in_the_plan_and_limits_hide_no_doubt() {
    let folder = with(&["panel-install.mcap"]);
    let whole = clean(folder.path(), "export panel-install.mcap --csv");
    let without = |name: &str, [from_s, to_s]: [f64; 2]| {
        let kept = |line: &&str| {
            let t_s = line.split(',').nth(1).and_then(|cell| cell.parse().ok());
            t_s.is_none_or(|t_s: f64| t_s < from_s || t_s > to_s)
        };
        let lines: Vec<&str> = whole.lines().filter(kept).collect();
        fs::write(folder.path().join(name), lines.join("\n")).unwrap();
    };
    without("hole.csv", [8.0, 10.5]);
    let (code, _, error) = said(&run_line(folder.path(), "replan hole.csv --keep-plan -o next.mcap"));
    assert!(code == 1 && error.contains("is missing from 7.99 s to 10.5"), "{error}");
    assert!(error.contains("moves by") && !folder.path().join("next.mcap").exists(), "{error}");
    // At rest nothing is missed, but it is said, whether the machine is fitted or given.
    without("still.csv", [0.5, 1.9]);
    let fitted = run_line(folder.path(), "fit panel-install.mcap -o limits.toml");
    assert!(fitted.status.code().is_some_and(|code| code == 0 || code == 3));
    for line in
        ["replan still.csv --keep-plan --json", "replan still.csv --keep-plan --limits limits.toml --json"]
    {
        let (code, text, _) = said(&run_line(folder.path(), line));
        assert!(code == 3 && text.contains("nothing is computed across them"), "{line}: {code}");
    }
}

/// A folder in which a run and the next command lie, and one of two days, is no recording in parts.
#[test]
fn files_of_one_folder_that_are_hours_apart_are_no_one_run() {
    let folder = scratch();
    let folder = folder.path();
    let table = |name: &str, from: &str| {
        let row = |k: u32| format!("{from}:{:06.3},{},{}\n", 0.02 * f64::from(k), k % 7, k % 7);
        let rows: String = (0..500).map(row).collect();
        let text = format!("time,boom_set_deg,boom_act_deg\n{rows}");
        fs::write(folder.join("a.csv"), text).unwrap();
        let (code, out, error) = said(&run_line(folder, &format!("import a.csv -o runs/{name}.mcap")));
        assert!(code == 0 || code == 3, "{out}{error}");
    };
    fs::create_dir(folder.join("runs")).unwrap();
    table("one", "2026-05-04 10:00");
    table("two", "2026-05-04 10:01");
    let (code, out, _) = said(&run_line(folder, "report runs"));
    assert!(
        code == 3 && out.contains("Two runs? one.mcap (10.0 s) and two.mcap (10.0 s) are 50.0 s apart"),
        "{out}"
    );
    let (_, page, _) = said(&run_line(folder, "report runs --html"));
    let first = page.split("<div class=\"card ").nth(1).unwrap();
    assert!(
        first.starts_with("bad\"") && first.contains("Two runs?") && first.contains("hydrotrace compare"),
        "{first}"
    );
    // Joints of other names make no other case.
    let other =
        fs::read_to_string(folder.join("a.csv")).unwrap().replace("boom", "stick").replace("10:01", "19:01");
    fs::write(folder.join("b.csv"), other).unwrap();
    said(&run_line(folder, "import b.csv -o other.mcap"));
    let (code, _, error) = said(&run_line(folder, "report runs/one.mcap other.mcap"));
    assert!(
        code == 1 && error.contains("9.0 hours apart") && error.contains("hydrotrace fleet"),
        "{code}: {error}"
    );
    table("three", "2026-05-05 10:01");
    for line in ["report runs", "fit runs", "replan runs --keep-plan -o next.mcap"] {
        let (code, _, error) = said(&run_line(folder, line));
        assert!(
            code == 1 && error.contains("24.0 hours apart") && error.contains("three.mcap"),
            "{line}: {error}"
        );
    }
    // What a recorder calls one bag is one, however long it paused.
    let bag = "rosbag2_bagfile_information:\n  storage_identifier: mcap\n  relative_file_paths: [one.mcap, three.mcap]\n";
    fs::write(folder.join("runs/metadata.yaml"), bag).unwrap();
    let (code, out, error) = said(&run_line(folder, "report runs"));
    assert!(code == 0 || code == 3, "{out}{error}");
}

/// A table whose plan, in motion until 4.5 s and from 7 s to 9.5 s, was recorded to an instant.
fn in_two(folder: &Path, name: &str, span_s: [f64; 2]) {
    let ramp = |t_s: f64| 0.5 - 0.5 * (std::f64::consts::PI * (t_s / 2.5).clamp(0.0, 1.0)).cos();
    let plan = |t_s: f64| 10.0 * ramp(t_s - 2.0) + 8.0 * ramp(t_s - 7.0);
    let rows = (0..1400).map(|k| 0.01 * f64::from(k)).filter(|t_s| (span_s[0]..span_s[1]).contains(t_s));
    let rows = rows.map(|t_s| format!("{t_s:.2},{:.4},{:.4}\n", plan(t_s), plan(t_s - 0.1)));
    let text = format!("t_s,boom_set_deg,boom_act_deg\n{}", rows.collect::<String>());
    fs::write(folder.join(name), text).unwrap();
}

#[test]
fn a_log_that_ends_or_begins_in_a_rest_of_a_plan_that_goes_on_is_no_run_of_it() {
    let folder = scratch();
    let folder = folder.path();
    in_two(folder, "a.csv", [0.0, 14.0]);
    for (span_s, says) in [([0.0, 6.5], "moves on after it"), ([5.5, 14.0], "moves before it")] {
        in_two(folder, "b.csv", span_s);
        let (code, _, error) = said(&run_line(folder, "replan a.csv b.csv --keep-plan -o next.mcap"));
        assert!(code == 1 && error.contains("b.csv") && error.contains(says), "{code}: {error}");
        assert!(!folder.join("next.mcap").exists());
    }
    // One that rests where the other moves on has another plan.
    in_two(folder, "b.csv", [0.0, 14.0]);
    let (code, out, error) = said(&run_line(folder, "replan a.csv b.csv --keep-plan -o next.mcap"));
    assert!(code == 0 || code == 3, "{code}: {out}{error}");
}
