//! The whole loop through the built binary: what `fit`, `excite`, `replan` and `demo` promise holds in the
//! numbers of the runs that follow.

use std::{fs, path::Path};

use serde_json::Value;

use crate::support::{clean, json, run_line as hydrotrace, scratch, stderr};

/// The plan that the paper prints for task 1, and a run of it.
fn with_run() -> tempfile::TempDir {
    let folder = scratch();
    clean(folder.path(), "plan task-1.toml --times 0,7.744,15.307,22.863,30.976,38.72 -o plan.mcap");
    clean(folder.path(), "simulate plan.mcap -o run.mcap");
    folder
}

/// Mean transition peak of a run, rad.
fn mean_peak_rad(folder: &Path, log: &str) -> f64 {
    let report = json(folder, &format!("report {log}"));
    let peaks: Vec<f64> =
        report["transitions"].as_array().unwrap().iter().map(|t| t["peak_error"].as_f64().unwrap()).collect();
    peaks.iter().sum::<f64>() / peaks.len() as f64
}

#[test]
fn the_demo_tells_what_its_files_hold_and_they_are_those_of_the_commands_it_names() {
    let folder = scratch();
    let folder = folder.path();
    let told = clean(folder, "demo --dir demo");
    let demo = folder.join("demo");
    // By hand, in another folder.
    for line in told.lines().filter_map(|line| line.strip_prefix("$ hydrotrace ")) {
        let run = hydrotrace(folder, line);
        assert!(matches!(run.status.code(), Some(0 | 3)), "{line}: {}", stderr(&run));
    }
    for file in ["plan.mcap", "run-1.mcap", "limits.toml", "next.mcap", "run-2.mcap"] {
        assert!(fs::read(demo.join(file)).unwrap() == fs::read(folder.join(file)).unwrap(), "{file}");
    }
    let (before, after) = (mean_peak_rad(&demo, "run-1.mcap"), mean_peak_rad(&demo, "run-2.mcap"));
    assert!(after < 0.4 * before, "{before} {after}");
    let shown = format!("{:.3} deg in the mean", before.to_degrees());
    assert!(told.contains(&shown), "{shown}\n{told}");
    let comparison = json(&demo, "compare run-1.mcap run-2.mcap");
    let all = &comparison["summaries"][0];
    assert_eq!((&all["measure"], &all["scope"]), (&"peak_error".into(), &"all".into()));
    let shown = format!(
        "{:.3} -> {:.3} deg in the mean ({:+.0} %)",
        all["mean_before"].as_f64().unwrap().to_degrees(),
        all["mean_after"].as_f64().unwrap().to_degrees(),
        100.0 * all["relative_change"].as_f64().unwrap()
    );
    assert!(told.contains(&shown), "{shown}\n{told}");
    assert!(told.lines().count() < 45 && told.lines().all(|line| line.chars().count() <= 120), "{told}");
}

#[test]
fn the_next_run_keeps_what_replan_promises_and_compare_measures_it() {
    let folder = with_run();
    let folder = folder.path();
    let promised = json(folder, "replan run.mcap -o next.mcap");
    let (now, then) = (&promised["before"], &promised["after"]);
    assert!(promised["duration_s"].as_f64().unwrap() <= now["duration_s"].as_f64().unwrap());
    clean(folder, "simulate next.mcap -o run-2.mcap --seed 7");
    let measured = mean_peak_rad(folder, "run.mcap");
    assert!((now["measured_mean_peak_rad"].as_f64().unwrap() / measured - 1.0).abs() < 1e-9);
    let after = mean_peak_rad(folder, "run-2.mcap");
    assert!(after < 0.42 * measured, "{measured} {after}");
    // The promise is of the right size: within a half of what came, and the margin above it or nearly so.
    let expected = then["mean_peak_rad"].as_f64().unwrap();
    assert!((0.5..1.5).contains(&(expected / after)), "{expected} {after}");
    assert!(then["mean_peak_margin_rad"].as_f64().unwrap() > 0.85 * after);
    let run =
        hydrotrace(folder, "compare run.mcap run-2.mcap --min-peak-reduction-percent 50 --max-rms-ratio 0.5");
    assert!(matches!(run.status.code(), Some(0 | 3)), "{}", stderr(&run));
    let comparison = json(folder, "compare run.mcap run-2.mcap");
    let pairs = comparison["pairs"].as_array().unwrap();
    assert!(pairs.len() >= 12, "{} pairs", pairs.len());
    assert!(pairs.iter().all(|pair| pair["paired_by"] == "task"), "{pairs:?}");
    // The command was not taken for the plan.
    let source = json(folder, "report run-2.mcap")["source"]["planned_topic"].clone();
    assert_eq!(source, "/planned/joint_states");
}

#[test]
fn a_command_alone_needs_no_task_and_leaves_the_plan_as_it_was() {
    let folder = with_run();
    let folder = folder.path();
    clean(folder, "export run.mcap --csv -o run.csv");
    let run = hydrotrace(folder, "import run.csv -o field.mcap");
    assert!(matches!(run.status.code(), Some(0 | 3)), "{}", stderr(&run));
    let promised = json(folder, "replan field.mcap --keep-plan -o next.mcap");
    assert_eq!(promised["retimed"], false);
    assert_eq!(promised["command_margins"].as_array().unwrap().len(), 0, "no task, no limits");
    clean(folder, "simulate next.mcap -o run-2.mcap --seed 7");
    let (before, after) = (mean_peak_rad(folder, "run.mcap"), mean_peak_rad(folder, "run-2.mcap"));
    assert!(after < 0.45 * before, "{before} {after}");
    let comparison = json(folder, "compare run.mcap run-2.mcap");
    assert_eq!(comparison["after"][0]["same_plan"], true, "{}", comparison["after"][0]);
}

#[test]
fn half_the_gain_does_less_and_no_command_at_all_leaves_the_plan_alone_to_help() {
    let folder = with_run();
    let folder = folder.path();
    let peak = |line: &str| {
        let promised = json(folder, line);
        let off = promised["command"].as_array().unwrap().iter();
        let off = off.map(|joint| joint["peak_correction_rad"].as_f64().unwrap()).fold(0.0, f64::max);
        (promised["after"]["mean_peak_rad"].as_f64().unwrap(), off)
    };
    let whole = peak("replan run.mcap --keep-plan");
    let half = peak("replan run.mcap --keep-plan --gain 0.5");
    assert!(half.0 > 1.5 * whole.0 && half.1 < 0.8 * whole.1, "{half:?} {whole:?}");
    let plain = json(folder, "replan run.mcap --no-precompensation --evaluations 2000 -o next.mcap");
    assert_eq!(plain["command"].as_array().unwrap().len(), 0);
    let sum = |side: &Value| side["sum_of_peaks_rad"].as_f64().unwrap();
    assert!(sum(&plain["after"]) < 0.95 * sum(&plain["before"]["predicted"]), "{plain}");
    let topics = clean(folder, "info next.mcap");
    assert!(!topics.contains("/command"), "{topics}");
}

#[test]
fn limits_come_back_from_their_file_and_a_run_of_excite_identifies_the_speeds() {
    let folder = with_run();
    let folder = folder.path();
    let smooth = json(folder, "fit run.mcap -o limits.toml --html fit.html");
    let page = fs::read_to_string(folder.join("fit.html")).unwrap();
    for told in
        ["J6 in run.mcap", "Peak error after each start", "hydrotrace replan run.mcap", "dead band deg/s"]
    {
        assert!(page.contains(told), "{told}");
    }
    for joint in smooth["joints"].as_array().unwrap() {
        for limit in ["speed_limit_growing_rad_s", "acceleration_limit_shrinking_rad_s2"] {
            assert_eq!(joint[limit]["identified"], false);
            assert_eq!(joint[limit]["value"], Value::Null);
            assert!(joint[limit]["lower_bound"].as_f64().unwrap() > 0.0);
        }
        assert!(joint["held_out_r2"].as_f64().unwrap() > 0.3 && joint["lag_s"]["interval"].is_array());
    }
    let fitted = clean(folder, "replan run.mcap -o a.mcap --evaluations 1000 --json");
    let read = clean(folder, "replan run.mcap -o b.mcap --evaluations 1000 --json --limits limits.toml");
    assert!(
        fitted == read
            && fs::read(folder.join("a.mcap")).unwrap() == fs::read(folder.join("b.mcap")).unwrap()
    );
    clean(folder, "excite -o id.mcap");
    clean(folder, "simulate id.mcap -o id-run.mcap");
    let both = json(folder, "fit run.mcap id-run.mcap");
    for joint in both["joints"].as_array().unwrap() {
        let limit = &joint["speed_limit_growing_rad_s"];
        let value = limit["value"].as_f64().unwrap().to_degrees();
        assert!(limit["identified"] == true && (12.0..30.0).contains(&value), "{} {value}", joint["name"]);
        assert_eq!(joint["lag_s"]["identified"], true);
    }
}

#[test]
fn what_cannot_be_done_says_why_and_writes_nothing() {
    let folder = with_run();
    let folder = folder.path();
    fs::write(folder.join("broken.toml"), "format = \"hydrotrace.limits.v1\"\nlogs = []\n").unwrap();
    fs::write(folder.join("other.toml"), fs::read_to_string(folder.join("task-1.toml")).unwrap()).unwrap();
    for (line, code, said) in [
        ("replan run.mcap -o x.mcap --limits broken.toml", 1, "does not hold limits"),
        ("replan run.mcap -o x.mcap --limits other.toml", 1, "does not hold limits"),
        ("replan run.mcap -o x.mcap --limits nowhere.toml", 1, "cannot read nowhere.toml"),
        ("replan run.mcap -o x.mcap --keep-plan --no-precompensation", 2, "cannot be used with"),
        ("replan run.mcap -o x.mcap --gain 2", 2, "from 0 to 1"),
        ("replan run.mcap -o run.mcap", 1, "is an input"),
        ("replan plan.mcap -o x.mcap", 1, "no measured"),
        ("fit run.mcap --command /nowhere -o x.toml", 1, "/nowhere"),
        ("fit run.mcap -o run.mcap", 1, "is an input"),
        ("fit run.mcap --html run.mcap", 1, "is an input"),
        ("excite -o x.mcap --joint a=1:2", 2, "NAME=HOME:LOW:HIGH"),
        ("excite -o x.mcap --joint a=1:0.5:1.5", 1, "on one side at least"),
        ("demo --dir plan.mcap", 1, "cannot make the folder"),
    ] {
        let run = hydrotrace(folder, line);
        assert_eq!(run.status.code(), Some(code), "{line}: {}", stderr(&run));
        assert!(stderr(&run).contains(said), "{line}: {}", stderr(&run));
        assert!(!folder.join("x.mcap").exists(), "{line}");
    }
}
