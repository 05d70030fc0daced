//! `join` of a log in which another command of the same plan was sent: the plans are so alike that each fits where another was sent.

use crate::support::{clean as done, json, made, run_line as hydrotrace, sample, stderr, stdout};

/// A folder with a plan and its run, and what these lines make of them.
fn folder(lines: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::copy(sample("tasks/task-1.toml"), at.join("task-1.toml")).unwrap();
    let begun = [
        "plan task-1.toml --times 0,4.49,8.09,12.39,18.79,21.85 -o plan.mcap",
        "simulate plan.mcap -o run.mcap",
    ];
    for line in begun.iter().chain(lines) {
        made(at, line);
    }
    folder
}

#[test]
fn another_command_of_the_same_plan_is_refused_with_its_share_at_a_given_time_too() {
    let folder = folder(&[
        "replan run.mcap --keep-plan --gain 0.5 -o half.mcap",
        "replan run.mcap --keep-plan -o all.mcap",
        "simulate half.mcap -o sent.mcap",
    ]);
    let at = folder.path();
    for given in ["", " --at 2"] {
        let line =
            format!("join sent.mcap --planned /command/joint_states -o joined.mcap --plan all.mcap{given}");
        let run = hydrotrace(at, &line);
        let said = stderr(&run);
        assert!(run.status.code() == Some(1) && !at.join("joined.mcap").exists(), "{line}: {said}");
        let (_, share) = said.split_once("with about ").unwrap_or_default();
        let share: f64 = share.split(' ').next().and_then(|share| share.parse().ok()).unwrap_or(f64::NAN);
        assert!((share - 50.0).abs() < 5.0 && said.contains("--gain"), "{line}: {said}");
    }
}

/// A PLC's set value is what was sent to it: the corrected command, which a table calls its plan.
#[test]
fn what_a_table_calls_its_plan_may_be_what_was_sent() {
    let folder = folder(&[
        "replan run.mcap --keep-plan -o next.mcap",
        "simulate next.mcap -o whole.mcap",
        "export whole.mcap --csv --planned /command/joint_states -o plc.csv",
        "join plc.csv --plan next.mcap -o joined.mcap",
    ]);
    let at = folder.path();
    let [joined, whole] = ["joined", "whole"].map(|name| json(at, &format!("report {name}.mcap")));
    let peaks_rad = |report: &serde_json::Value| {
        let starts = report["transitions"].as_array().unwrap().iter();
        starts.filter_map(|start| start["peak_error"].as_f64()).sum::<f64>()
    };
    let [found, expected] = [&joined, &whole].map(peaks_rad);
    assert!((found / expected - 1.0).abs() < 0.05, "{found} {expected}");
    assert!(joined["promised"].is_object(), "{}", joined["promised"]);
}

#[test]
fn a_recording_that_lacks_the_beginning_or_the_end_of_the_plan_is_told() {
    let folder = folder(&["replan run.mcap --keep-plan -o next.mcap", "simulate next.mcap -o whole.mcap"]);
    let at = folder.path();
    for (range, end) in [("--from 6", "beginning"), ("--to 24", "end")] {
        done(at, &format!("export whole.mcap --csv --planned /command/joint_states {range} -o part.csv"));
        let run = hydrotrace(at, "join part.csv --plan next.mcap -o joined.mcap");
        let said = stdout(&run);
        let told = said.contains(&format!(" s of the plan's motion at its {end}"));
        assert!(run.status.code() == Some(3) && told, "{range}: {said}{}", stderr(&run));
        std::fs::remove_file(at.join("joined.mcap")).unwrap();
        std::fs::remove_file(at.join("part.csv")).unwrap();
    }
}
