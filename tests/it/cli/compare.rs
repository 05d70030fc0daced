//! `compare` as an operator meets it: runs before and after a change, of the sample logs and of a simulated
//! machine.

use std::{path::Path, sync::LazyLock};

use serde_json::Value;

use crate::support::{hold_to_schema, run_args as hydrotrace, samples, stderr, stdout, timed};

const SOUND: &str = "panel-install.mcap";

/// Task 1 on two machines, `lag.mcap` and `band.mcap`, and re-timed, `slow.mcap`.
static RUNS: LazyLock<tempfile::TempDir> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let done = |args: &[&str]| assert_eq!(hydrotrace(folder.path(), args).status.code(), Some(0), "{args:?}");
    let task = samples().join("tasks/task-1.toml");
    for (plan, times) in [("fast", "0,4.49,8.09,12.39,18.79,21.85"), ("slow", "0,5.5,10,15.2,23,27")] {
        let plan = format!("{plan}.plan.mcap");
        done(&["plan", task.to_str().unwrap(), "--times", times, "-o", &plan]);
    }
    for (plan, plant, run) in [
        ("fast", "lag-limited", "lag"),
        ("fast", "dead-band-limited", "band"),
        ("slow", "lag-limited", "slow"),
    ] {
        let (plan, run) = (format!("{plan}.plan.mcap"), format!("{run}.mcap"));
        done(&["simulate", &plan, "-o", &run, "--plant", plant]);
    }
    folder
});

fn json(folder: &Path, args: &[&str]) -> Value {
    let run = hydrotrace(folder, &[&["compare"], args, &["--json"]].concat());
    serde_json::from_slice(&run.stdout).unwrap_or_else(|_| panic!("{args:?}: {}", stderr(&run)))
}

fn list<'a>(document: &'a Value, name: &str) -> &'a Vec<Value> {
    document[name].as_array().unwrap()
}

/// The summary of peak errors over all transitions.
fn overall(document: &Value) -> &Value {
    list(document, "summaries").iter().find(|s| s["measure"] == "peak_error" && s["scope"] == "all").unwrap()
}

#[test]
fn a_run_compared_with_itself_shows_no_difference() {
    let run = hydrotrace(samples(), &["compare", SOUND, SOUND]);
    assert_eq!((run.status.code(), stderr(&run).as_str()), (Some(3), ""));
    assert!(stdout(&run).contains("The peak error at transitions is the same in 24 pairs; p = 1."));
    let document = json(samples(), &[SOUND, SOUND]);
    assert_eq!((&document["verdict"], &document["same_plan"]), (&"equal".into(), &true.into()));
    assert_eq!((list(&document, "pairs").len(), list(&document, "unpaired").len()), (24, 0));
    for pair in list(&document, "pairs") {
        for measure in ["peak_error", "rms_error", "onset_delay_s"] {
            assert_eq!(
                (pair[measure]["difference"].as_f64(), pair[measure]["ratio"].as_f64()),
                (Some(0.0), Some(1.0))
            );
        }
    }
    for summary in list(&document, "summaries") {
        assert_eq!(
            (summary["p_value"].as_f64(), summary["mean_difference"].as_f64()),
            (Some(1.0), Some(0.0))
        );
    }
    for figures in list(&document, "whole_run") {
        assert_eq!(figures["rms"]["ratio"], 1.0);
        assert_eq!(figures["peak_speed"]["difference"], 0.0);
    }
}

#[test]
fn swapping_before_and_after_negates_every_difference() {
    let there = json(RUNS.path(), &["lag.mcap", "band.mcap"]);
    let back = json(RUNS.path(), &["band.mcap", "lag.mcap"]);
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    let mut changed = 0;
    for (a, b) in list(&there, "pairs").iter().zip(list(&back, "pairs")) {
        assert_eq!((&a["joint"], &a["kind"], &a["direction"]), (&b["joint"], &b["kind"], &b["direction"]));
        let [d, e] = [a, b].map(|pair| number(&pair["peak_error"]["difference"]));
        assert!(d == -e, "{d} {e}");
        changed += usize::from(d != 0.0);
    }
    assert!(changed >= 12, "{changed} pairs changed");
    for (a, b) in list(&there, "summaries").iter().zip(list(&back, "summaries")) {
        let (p, q) = (number(&a["p_value"]), number(&b["p_value"]));
        assert!((p - q).abs() < 1e-12, "{p} {q}");
        let [[low, high], [l, h]] =
            [a, b].map(|s| [number(&s["interval_95"][0]), number(&s["interval_95"][1])]);
        assert!(low.is_nan() == l.is_nan() && (low.is_nan() || (low + h).abs() + (high + l).abs() < 1e-12));
        assert_eq!((&a["smaller"], &a["larger"]), (&b["larger"], &b["smaller"]));
    }
    assert_eq!((&there["verdict"], &back["verdict"]), (&"smaller".into(), &"larger".into()));
}

#[test]
fn a_machine_that_follows_better_is_found_to_in_five_lines() {
    let run = hydrotrace(RUNS.path(), &["compare", "lag.mcap", "band.mcap"]);
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    let text = stdout(&run);
    let short: Vec<&str> = text.lines().skip_while(|line| *line != "IN SHORT").skip(1).take(5).collect();
    assert!(short[0].starts_with("The peak error at transitions became smaller: "), "{text}");
    assert!(short[0].contains("95 % interval") && short[0].contains("p = 0.0"), "{text}");
    assert!(short[1].starts_with("This is of the starts of these runs"), "{text}");
    assert!(short[2].starts_with("At the tool: ") && short[2].contains(" mm at worst, "), "{text}");
    assert!(short[3].starts_with("Whole run, all joints: rms "), "{text}");
    assert!(
        short[4].starts_with("The same plan (") && short[4].contains("every transition is paired"),
        "{text}"
    );
    let document = json(RUNS.path(), &["lag.mcap", "band.mcap"]);
    let peak = overall(&document);
    let mean: f64 =
        list(&document, "pairs").iter().map(|p| p["peak_error"]["difference"].as_f64().unwrap()).sum();
    let pairs = list(&document, "pairs").len() as f64;
    assert!((peak["mean_difference"].as_f64().unwrap() - mean / pairs).abs() < 1e-12);
    // Joints that start together count once.
    assert!(peak["events"].as_u64() < peak["pairs"].as_u64());
}

#[test]
fn a_re_timed_plan_is_paired_by_the_key_points_of_its_task_and_nothing_is_guessed() {
    let document = json(RUNS.path(), &["lag.mcap", "slow.mcap"]);
    assert_eq!(document["same_plan"], false);
    let plan_s = |side: &str| document[side][0]["plan_duration_s"].as_f64().unwrap();
    assert!(
        (plan_s("after") - plan_s("before") - 5.15).abs() < 1.0,
        "{} {}",
        plan_s("before"),
        plan_s("after")
    );
    let pairs = list(&document, "pairs");
    assert!(!pairs.is_empty() && pairs.iter().all(|pair| pair["paired_by"] == "task"), "{pairs:?}");
    for side in ["before", "after"] {
        let alone = list(&document, "unpaired").iter().filter(|u| u["side"] == side).count();
        assert_eq!(document[side][0]["transitions"], pairs.len() + alone, "{side}");
    }
    let run = hydrotrace(RUNS.path(), &["compare", "lag.mcap", "slow.mcap"]);
    assert!(stdout(&run).contains("Different plans ("), "{}", stdout(&run));
}

#[test]
fn a_run_given_twice_counts_once() {
    let once = json(RUNS.path(), &["lag.mcap", "band.mcap"]);
    let more = ["lag.mcap", "band.mcap", "--more-before", "lag.mcap", "--more-after", "band.mcap"];
    let twice = json(RUNS.path(), &more);
    assert_eq!(
        (once["pairs"].clone(), once["summaries"].clone()),
        (twice["pairs"].clone(), twice["summaries"].clone())
    );
    assert_eq!(list(&twice, "before").len(), 1);
    let said = list(&twice, "remarks").iter().filter(|remark| remark["code"] == "same-run").count();
    assert_eq!(said, 2, "{}", twice["remarks"]);
}

#[test]
fn a_run_and_its_own_table_are_one_run() {
    let table = RUNS.path().join("lag-deg.csv");
    let run = hydrotrace(RUNS.path(), &["export", "lag.mcap", "--degrees", "-o", "lag-deg.csv"]);
    assert!(table.exists(), "{}", stderr(&run));
    let text = stdout(&hydrotrace(RUNS.path(), &["compare", "lag.mcap", "lag-deg.csv"]));
    assert!(text.contains("Both sides are one and the same run"), "{text}");
    assert!(!text.contains("chance could explain"), "{text}");
}

#[test]
fn exit_code_1_says_which_log_and_what_the_runs_have() {
    let run = hydrotrace(samples(), &["compare", SOUND, "no-such.mcap"]);
    assert_eq!((run.status.code(), run.stdout.len()), (Some(1), 0));
    assert!(
        stderr(&run).starts_with("error: no-such.mcap cannot be compared\n  because: "),
        "{}",
        stderr(&run)
    );
    let run = hydrotrace(samples(), &["compare", SOUND, SOUND, "--measured", "/joint_state"]);
    assert_eq!(run.status.code(), Some(1));
    assert!(stderr(&run).contains("did you mean \"/joint_states\"?"), "{}", stderr(&run));
    let other = RUNS.path().join("lag.mcap");
    let run = hydrotrace(samples(), &["compare", SOUND, other.to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(1));
    assert!(stderr(&run).contains("joint_1, joint_2") && stderr(&run).contains("J1, J2"), "{}", stderr(&run));
}

#[test]
fn an_output_that_is_a_run_is_refused_and_a_limit_that_is_no_number_is_bad_usage() {
    let sound = samples().join(SOUND);
    let sound = sound.to_str().unwrap();
    let run = hydrotrace(
        RUNS.path(),
        &["compare", "lag.mcap", sound, "--more-after", "band.mcap", "-o", "band.mcap"],
    );
    assert_eq!(run.status.code(), Some(1), "{}", stderr(&run));
    for limit in ["lots", "101"] {
        let run = hydrotrace(samples(), &["compare", SOUND, SOUND, "--min-peak-reduction-percent", limit]);
        assert_eq!(run.status.code(), Some(2));
    }
    assert_eq!(hydrotrace(samples(), &["compare", SOUND]).status.code(), Some(2));
}

#[test]
fn exit_code_3_shows_remarks_and_what_a_cut_run_lacks_in_every_format() {
    for format in [&[][..], &["--json"], &["--markdown"]] {
        let run = hydrotrace(samples(), &[&["compare", SOUND, "power-loss.mcap"], format].concat());
        assert_eq!(run.status.code(), Some(3), "{format:?}");
        let text = stdout(&run).replace('\\', "");
        for said in [
            "not-closed",
            "after: power-loss.mcap was not closed",
            "before: planned starts without a counterpart",
        ] {
            assert!(text.contains(said), "{format:?} lacks {said}:\n{text}");
        }
    }
    let document = json(samples(), &[SOUND, "power-loss.mcap"]);
    assert_eq!(document["same_plan"], true);
    let alone = list(&document, "unpaired");
    assert!(!alone.is_empty() && alone.iter().all(|u| u["side"] == "before"));
    assert!(alone.iter().all(|u| u["planned_onset_s"].as_f64().unwrap() > 30.0), "{alone:?}");
    assert_eq!(list(&document, "pairs").len() + alone.len(), 24);
}

#[test]
fn exit_code_4_says_which_limit_and_what_was_found() {
    let judged = |runs: [&str; 2], limit: &[&str]| {
        let run = hydrotrace(RUNS.path(), &[&["compare", runs[0], runs[1]], limit].concat());
        (run.status.code().unwrap(), stderr(&run))
    };
    let (better, worse) = (["lag.mcap", "band.mcap"], ["band.mcap", "lag.mcap"]);
    for (limit, value, said) in [
        ("--min-peak-reduction-percent", "99", "99.0 % at least"),
        ("--max-p", "0.000001", "p of a reduction"),
        ("--max-transition-growth-deg", "0", ""),
        // Nothing that slides: nothing to judge.
        ("--max-transition-growth-mm", "5", "nothing to judge; 5.00 mm at most"),
        ("--max-rms-ratio", "0.01", "0.010 at most"),
        ("--max-peak-ratio", "0.01", "0.010 at most"),
    ] {
        let (code, text) = judged(worse, &[limit, value]);
        assert!(code == 4 && text.starts_with("gate: Limit on ") && text.contains(said), "{limit}: {text}");
        assert_eq!(text.lines().count(), 1);
    }
    let kept = [
        "--min-peak-reduction-percent", "20", "--max-p", "0.05", "--max-rms-ratio", "0.8",
        "--max-peak-ratio", "0.8",
    ];
    assert_eq!(judged(better, &kept), (0, String::new()));
    assert_eq!(judged(better, &["--min-peak-reduction-percent", "99"]).0, 4);
    // Significant, but the wrong way.
    let (code, text) = judged(worse, &["--max-p", "0.05"]);
    assert!(code == 4 && text.contains("no reduction"), "{text}");
}

#[test]
fn json_is_as_the_schema_says_and_equal_calls_give_equal_bytes() {
    let gates = ["lag.mcap", "slow.mcap", "--max-p", "0.05", "--max-transition-growth-deg", "1"];
    for (folder, args) in [(RUNS.path(), &gates[..]), (samples(), &[SOUND, "gaps.mcap"])] {
        let document = json(folder, args);
        hold_to_schema(&document, "compare.v2");
        assert_eq!(document["format"], "hydrotrace.compare.v2");
        assert_eq!(document, json(folder, args));
    }
}

#[test]
fn a_joint_that_a_mean_hides_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let run = |boom_late_s: f64, stick_late_s: f64| {
        timed("t_s,boom_set_deg,boom_act_deg,stick_set_deg,stick_act_deg", (600, 0.02), |t_s| {
            let at = |late_s: f64| {
                10.0 - 10.0 * ((t_s - late_s - 2.0).clamp(0.0, 4.0) / 4.0 * std::f64::consts::PI).cos()
            };
            let (plan, boom, stick) = (at(0.0), at(boom_late_s), at(stick_late_s));
            format!("{t_s:.2},{plan:.4},{boom:.4},{plan:.4},{stick:.4}")
        })
    };
    let at = folder.path();
    for (file, boom_late_s, stick_late_s) in [
        ("before.csv", 0.4, 0.1),
        ("after.csv", 0.1, 0.2),
        ("better.csv", 0.1, 0.05),
        ("worse.csv", 0.5, 0.2),
    ] {
        std::fs::write(at.join(file), run(boom_late_s, stick_late_s)).unwrap();
    }
    let said = |after: &str| stdout(&hydrotrace(at, &["compare", "before.csv", after]));
    let line = said("after.csv");
    assert!(line.contains("Worse while others became better, by rms error: stick 0."), "{line}");
    for after in ["better.csv", "worse.csv"] {
        assert!(!said(after).contains("Worse while others"), "{after}");
    }
}
