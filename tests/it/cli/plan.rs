//! `plan` as an operator meets it: exit codes, streams, the log that it writes.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Output,
};

use hydrotrace::log::{ReadOptions, survey};
use serde_json::Value;

use crate::support::{command, hold_to_schema, root, run_line, stderr, stdout};

const SIMULATION: &str = "sample-logs/tasks/simulation.toml";
const TASK_1: &str = "sample-logs/tasks/task-1.toml";
const A: &str = "0,2.01,3.77,5.79,6.53,8.85,10.48";
const C: &str = "0,1.51,5.09,10.23,15.67,18.98,23.27";

fn plan(args: &[&str], threads: &str) -> Output {
    command(root()).env("RAYON_NUM_THREADS", threads).arg("plan").args(args).output().unwrap()
}

fn json(run: &Output) -> Value {
    let document: Value = serde_json::from_slice(&run.stdout).unwrap();
    hold_to_schema(&document, "plan.v1");
    document
}

fn edited(folder: &Path, file: &str, from: &str, to: &str) -> PathBuf {
    let text = fs::read_to_string(root().join(file)).unwrap();
    assert!(text.contains(from), "{from} is not in {file}");
    let path = folder.join("task.toml");
    fs::write(&path, text.replace(from, to)).unwrap();
    path
}

#[test]
fn a_given_plan_is_judged_with_exit_code_0_if_it_keeps_its_limits_and_4_if_not() {
    let kept = plan(&[SIMULATION, "--times", A], "2");
    assert_eq!((kept.status.code(), stderr(&kept).as_str()), (Some(0), ""));
    assert!(stdout(&kept).contains("10.48          61.6945       306.67"), "{}", stdout(&kept));
    let broken = plan(&[SIMULATION, "--times", C, "--json"], "2");
    assert_eq!(broken.status.code(), Some(4));
    let document = json(&broken);
    assert_eq!((&document["feasible"], document["front"].as_array().map(Vec::len)), (&false.into(), Some(0)));
    let margins = document["chosen"]["margins"].as_array().unwrap();
    let range = margins.iter().find(|m| m["joint"] == "J3" && m["limit"] == "position").unwrap();
    assert!(range["share"].as_f64().unwrap() > 1.4 && range["t_s"].as_f64().unwrap() > 7.0, "{range}");
}

#[test]
fn the_front_as_json_has_what_scripts_need_and_remarks_go_to_standard_error() {
    let run = plan(&[TASK_1, "--json", "--evaluations", "2000"], "2");
    assert_eq!(run.status.code(), Some(3));
    assert!(stderr(&run).contains("inactive-bound") && stderr(&run).contains("max_rms_jerk_deg_s3"));
    let document = json(&run);
    let front = document["front"].as_array().unwrap();
    assert!(front.len() > 50);
    let (mut last_s, dwell_s) = (0.0, 2.0);
    for plan in front {
        let times_s: Vec<f64> =
            plan["times_s"].as_array().unwrap().iter().map(|t| t.as_f64().unwrap()).collect();
        assert_eq!(times_s.len(), 6);
        assert!(times_s[4] - times_s[3] > dwell_s);
        assert_eq!(plan["violation"].as_f64(), Some(0.0));
        assert!(plan["duration_s"].as_f64().unwrap() >= last_s);
        last_s = plan["duration_s"].as_f64().unwrap();
    }
    assert!(document["chosen"]["duration_s"].as_f64().unwrap() < 40.0);
    let evaluations = document["evaluations"].as_u64().unwrap();
    assert!((1000..=2600).contains(&evaluations), "{evaluations}");
    assert_eq!(document["seed"].as_u64(), Some(1));
}

#[test]
fn the_same_seed_gives_the_same_bytes_on_one_thread_and_on_three() {
    let folder = tempfile::tempdir().unwrap();
    let run = |threads: &str| {
        let log = folder.path().join("plan.mcap");
        let done = plan(&[TASK_1, "--evaluations", "1500", "-o", log.to_str().unwrap()], threads);
        (done.stdout, fs::read(log).unwrap())
    };
    let (one, three) = (run("1"), run("3"));
    assert_eq!(String::from_utf8(one.0), String::from_utf8(three.0));
    assert!(one.1 == three.1, "the logs differ");
}

#[test]
fn the_log_holds_the_plan_sample_by_sample_the_task_and_the_front() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("plan.mcap");
    let log = log.to_str().unwrap();
    assert_eq!(plan(&[SIMULATION, "--times", A, "-o", log, "--rate", "50"], "2").status.code(), Some(0));
    let found = survey(&[PathBuf::from(log)], &ReadOptions::default()).unwrap();
    let count = |topic: &str| found.topics.iter().find(|t| t.topic == topic).map(|t| t.messages);
    assert_eq!(count("/planned/joint_states"), Some(525));
    assert_eq!(count("/arm_controller/joint_trajectory"), Some(1));
    assert_eq!(found.attachments, ["task.toml", "plan.json"]);
}

#[test]
fn a_task_that_no_timing_keeps_says_what_binds_where_and_by_how_much() {
    let folder = tempfile::tempdir().unwrap();
    let slow = edited(folder.path(), SIMULATION, "J3 = 35", "J3 = 0.5");
    let log = folder.path().join("plan.mcap");
    let run = plan(&[slow.to_str().unwrap(), "--evaluations", "1000", "-o", log.to_str().unwrap()], "2");
    assert_eq!(run.status.code(), Some(1));
    assert!(run.stdout.is_empty() && !log.exists());
    let said = stderr(&run);
    assert!(said.contains("J3 speed is 2.7") && said.contains("0.50 deg/s is allowed"), "{said}");
    let (_, longest) = said.split_once("longest duration allowed, 20 s (interval_s)").expect(&said);
    let (_, enough) = longest.split_once(": with intervals up to ").expect(&said);
    let enough_s: f64 = enough.split(' ').next().unwrap().parse().unwrap();
    let text = std::fs::read_to_string(&slow).unwrap();
    let wider = text.replace("[0.3, 20.0]", &format!("[0.3, {enough_s}]"));
    assert_ne!(wider, text);
    std::fs::write(&slow, wider).unwrap();
    let kept = plan(&[slow.to_str().unwrap(), "--evaluations", "1000"], "2");
    assert_eq!(kept.status.code(), Some(0), "{}", stderr(&kept));
}

#[test]
fn the_exported_plan_has_speeds_of_a_joint_that_stands_too() {
    let folder = tempfile::tempdir().unwrap();
    let joint = |name: &str, from: &str| {
        format!(
            r#"<link name="{name}-link"/><joint name="{name}" type="continuous"><parent link="{from}"/><child link="{name}-link"/></joint>"#
        )
    };
    let arm = format!(
        r#"<robot name="r"><link name="base"/>{}{}</robot>"#,
        joint("a", "base"),
        joint("b", "a-link")
    );
    fs::write(folder.path().join("r.urdf"), arm).unwrap();
    let task = "title = \"t\"\narm = \"r.urdf\"\njoints = [\"a\", \"b\"]\n[[point]]\nangles_deg = { a = 0, b = 10 }\n[[point]]\n\
                angles_deg = { a = 50, b = 10 }\n[limits]\nspeed_deg_s = { a = 30, b = 30 }\n";
    fs::write(folder.path().join("task.toml"), task).unwrap();
    let made = run_line(folder.path(), "plan task.toml --choose fastest --evaluations 500 -o plan.mcap");
    assert!(matches!(made.status.code(), Some(0 | 3)), "{}", stderr(&made));
    let table = stdout(&run_line(folder.path(), "export plan.mcap --csv"));
    assert!(
        table.starts_with("stamp_ns,time_s,a_planned_rad,a_planned_rad_s,b_planned_rad,b_planned_rad_s\n"),
        "{table:.100}"
    );
    assert!(table.lines().skip(1).all(|line| line.ends_with(",0")));
}

/// A plan that has the longest intervals has no more time to buy anything by.
#[test]
fn a_plan_of_the_longest_intervals_says_so() {
    let said = stdout(&plan(&[TASK_1, "--choose", "smoothest", "--evaluations", "1000"], "2"));
    let folder = tempfile::tempdir().unwrap();
    let short = edited(folder.path(), TASK_1, "max_duration_s = 40.0", "max_duration_s = 400.0");
    let longest =
        stdout(&plan(&[short.to_str().unwrap(), "--choose", "smoothest", "--evaluations", "1000"], "2"));
    assert!(said.contains("1 % more time would buy"), "{said}");
    assert!(
        longest.contains("All intervals have the longest duration allowed, ")
            && !longest.contains("would buy"),
        "{longest}"
    );
}

#[test]
fn a_plan_that_nothing_but_the_shortest_interval_holds_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let long = edited(folder.path(), SIMULATION, "[0.3, 20.0]", "[9.0, 20.0]");
    let run = plan(&[long.to_str().unwrap(), "--choose", "fastest", "--evaluations", "1000"], "2");
    let said = stdout(&run);
    assert_eq!(run.status.code(), Some(3), "{said}");
    assert!(
        said.contains("nothing but the shortest interval that the task allows, 9 s (interval_s), keeps"),
        "{said}"
    );
    let days = plan(&[SIMULATION, "--times", "0,1e9,2e9,3e9,4e9,5e9,6e9", "-o", "days.mcap"], "2");
    assert!(stderr(&days).contains("has more than 10000000 samples"), "{}", stderr(&days));
}

#[test]
fn a_ceiling_that_no_plan_keeps_says_by_how_much_and_which_limits_bind() {
    let folder = tempfile::tempdir().unwrap();
    let quick = edited(folder.path(), TASK_1, "max_duration_s = 40.0", "max_duration_s = 10");
    let run = plan(&[quick.to_str().unwrap(), "--evaluations", "2000", "--json"], "2");
    assert_eq!(run.status.code(), Some(1));
    assert_eq!(json(&run)["feasible"], false);
    let said = stderr(&run);
    assert!(said.contains("time 12.4") && said.contains("the ceiling is 10.00 s"), "{said}");
    assert!(said.contains("limits that hold it there: ") && said.contains("J2 jerk at"), "{said}");
}

#[test]
fn wrong_tasks_and_times_name_file_line_and_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let task = edited(folder.path(), TASK_1, "J1 = 37.2", "J9 = 37.2");
    let run = plan(&[task.to_str().unwrap()], "2");
    assert_eq!(run.status.code(), Some(1));
    assert!(stderr(&run).contains("task.toml is no task\n  because: line "), "{}", stderr(&run));
    assert!(stderr(&run).contains("J9"));
    let short = plan(&[SIMULATION, "--times", "0,1,2"], "2");
    assert_eq!(short.status.code(), Some(1));
    assert!(stderr(&short).contains("3 times for 7 key points"), "{}", stderr(&short));
    let back = plan(&[SIMULATION, "--times", "0,2,1,3,4,5,6"], "2");
    assert_eq!(back.status.code(), Some(1));
    assert!(stderr(&back).contains("key point 3"), "{}", stderr(&back));
}

#[test]
fn a_given_plan_above_a_ceiling_and_a_controllers_curve_beyond_a_limit_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let task = edited(folder.path(), TASK_1, "max_duration_s = 40.0", "max_duration_s = 30.0");
    let times = ["--times", "0,8,14,22,30,36"];
    let long = plan(&[&[task.to_str().unwrap()], &times[..]].concat(), "2");
    assert_eq!(long.status.code(), Some(0), "{}", stderr(&long));
    assert!(stdout(&long).contains("It is 20.0 % above max_duration_s"), "{}", stdout(&long));
    assert!(!stdout(&plan(&[&[TASK_1], &times[..]].concat(), "2")).contains("above"));
    // Of degree five the jerk leaps from rest, which no points show a controller.
    let degree = fs::read_to_string(root().join(TASK_1)).unwrap();
    let degree = degree.lines().find(|line| line.starts_with("degree")).unwrap();
    let leaps = edited(folder.path(), TASK_1, degree, "degree = 5");
    let (log, task) = (folder.path().join("plan.mcap"), leaps.to_str().unwrap());
    let options =
        ["--evaluations", "3000", "--choose", "fastest", "--shape", "free", "-o", log.to_str().unwrap()];
    let run = plan(&[&[task], &options[..]].concat(), "2");
    assert_eq!(run.status.code(), Some(3), "{}", stderr(&run));
    assert!(stdout(&run).contains("a controller's quintic comes to"), "{}", stdout(&run));
    // Faster than times alone can be.
    let soon = edited(folder.path(), TASK_1, "max_duration_s = 40.0", "max_duration_s = 11.3");
    let soon = [soon.to_str().unwrap(), "--evaluations", "3000", "--choose", "fastest"];
    let alone = plan(&soon, "2");
    assert_eq!(alone.status.code(), Some(1));
    assert!(stderr(&alone).contains("--shape free"), "{}", stderr(&alone));
    let free = plan(&[&soon[..], &["--shape", "free", "--json"]].concat(), "2");
    assert!(json(&free)["chosen"]["duration_s"].as_f64().unwrap() <= 11.3);
}

#[test]
fn bad_usage_is_exit_code_2_and_names_what_is_allowed() {
    for (args, expected) in [
        (vec![SIMULATION, "--algorithm", "nsga4"], "nsga3"),
        (vec![SIMULATION, "--weights", "1,2"], "3 weights"),
        (vec![SIMULATION, "--evaluations", "500", "--generations", "3"], "cannot be used with"),
        (vec![SIMULATION, "--times", "0,2,4,6,7,9,10", "--choose", "fastest"], "cannot be used with"),
        (vec![SIMULATION, "--pieces", "4"], "add --shape free"),
    ] {
        let run = plan(&args, "2");
        assert_eq!(run.status.code(), Some(2), "{args:?}");
        assert!(stderr(&run).contains(expected), "{}", stderr(&run));
    }
}

#[test]
fn the_page_goes_where_the_output_ends_in_html_and_the_log_elsewhere() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let budget = ["--evaluations", "1500"];
    let page = plan(&[&[TASK_1, "--html", "-o", &file("plan.html")], &budget[..]].concat(), "2");
    assert_eq!((page.status.code(), stdout(&page).as_str()), (Some(3), ""));
    let text = fs::read_to_string(file("plan.html")).unwrap();
    for word in
        ["limits kept", "A, fastest", "How the front grew", "The motion that is shown", "inactive-bound"]
    {
        assert!(text.contains(word), "{word}");
    }
    let both = plan(&[&[TASK_1, "--html", "-o", &file("plan.mcap")], &budget[..]].concat(), "1");
    assert_eq!(stdout(&both), text);
    assert!(fs::read(file("plan.mcap")).unwrap().starts_with(b"\x89MCAP"));
    let given = plan(&[SIMULATION, "--times", A, "--html"], "1");
    assert_eq!(given.status.code(), Some(0));
    assert!(stdout(&given).contains("The motion"));
}

#[test]
fn the_front_grows_on_the_way_and_ends_with_the_hypervolume_told() {
    let found = json(&plan(&[TASK_1, "--json", "--evaluations", "6000"], "2"));
    let steps = found["convergence"].as_array().unwrap();
    let of = |step: &Value, name: &str| step[name].as_f64().unwrap();
    assert!((5..=66).contains(&steps.len()), "{}", steps.len());
    let (last, way) = steps.split_last().unwrap();
    assert_eq!(of(last, "hypervolume"), found["hypervolume"].as_f64().unwrap());
    for pair in way.windows(2) {
        assert!(of(&pair[0], "evaluations") < of(&pair[1], "evaluations"));
        assert!(of(&pair[0], "hypervolume") <= of(&pair[1], "hypervolume"));
    }
}

#[test]
fn no_plan_that_is_offered_breaks_a_limit_between_the_instants_that_a_search_looks_at() {
    // A pump so small that its flow is what binds: it peaks, with kinks, between those instants.
    let folder = tempfile::tempdir().unwrap();
    fs::copy(root().join("sample-logs/arm/arm.urdf"), folder.path().join("arm.urdf")).unwrap();
    let pump = "pump_flow_m3_s = 1.2e-4";
    let small = edited(folder.path(), "sample-logs/arm/hydraulics.toml", "pump_flow_m3_s = 6.6667e-4", pump);
    fs::rename(small, folder.path().join("hydraulics.toml")).unwrap();
    let arm = "arm = \"arm.urdf\"\nhydraulics = \"hydraulics.toml\"";
    let task = edited(folder.path(), TASK_1, "arm = \"sample\"", arm);
    let task = task.to_str().unwrap();
    for (rule, flow) in [("fastest", 0.99), ("ideal", 0.0)] {
        let found = plan(&[task, "--choose", rule, "--evaluations", "4000", "--json"], "2");
        let document = json(&found);
        let offered = document["front"].as_array().unwrap().iter().step_by(40).chain([&document["chosen"]]);
        for one in offered {
            let times: Vec<String> =
                one["times_s"].as_array().unwrap().iter().map(ToString::to_string).collect();
            let judged = plan(&[task, "--times", &times.join(",")], "2");
            assert_eq!(judged.status.code(), Some(0), "{times:?}: {}", stdout(&judged));
        }
        let limits = document["chosen"]["margins"].as_array().unwrap();
        let used = limits.iter().find(|limit| limit["limit"] == "pump_flow").unwrap();
        assert!(used["share"].as_f64().unwrap() >= flow, "{used}");
    }
}

/// Not one of them is broken by rounding.
#[test]
fn the_lines_of_the_page_make_the_plans_that_it_shows() {
    let folder = tempfile::tempdir().unwrap();
    let page = plan(&[TASK_1, "--html", "--evaluations", "1000"], "2");
    let page = stdout(&page);
    let data = page.split("<script id=\"choices\" type=\"application/json\">").nth(1).unwrap();
    let choices: Value = serde_json::from_str(data.split("</script>").next().unwrap()).unwrap();
    let choices = choices.as_array().unwrap();
    assert!((20..=64).contains(&choices.len()) && choices[0]["name"] == "chosen");
    let log = folder.path().join("plan.mcap").to_str().unwrap().to_owned();
    for choice in [&choices[0], &choices[1], &choices[choices.len() - 1]] {
        let line = choice["command"].as_str().unwrap();
        let words: Vec<&str> =
            line.split(' ').skip(2).map(|word| if word == "plan.mcap" { &log } else { word }).collect();
        let made = plan(&[&words[..], &["--json"]].concat(), "1");
        assert_eq!(made.status.code(), Some(0), "{line}: {}", stderr(&made));
        let duration_s = json(&made)["chosen"]["duration_s"].as_f64().unwrap();
        let said = choice["lines"][0].as_str().unwrap();
        assert_eq!(said, format!("time {duration_s:.2} s"));
    }
}

#[test]
fn plans_near_a_time_that_only_a_free_shape_keeps_are_listed_and_given_times_are_judged_alone() {
    let near = |shape: &str| {
        let line = [SIMULATION, "--evaluations", "1000", "--near", "6.6", "--shape", shape, "--json"];
        let document = json(&plan(&line, "2"));
        let entries = document["near"].as_array().unwrap().clone();
        entries.iter().map(|entry| entry["duration_s"].as_f64().unwrap()).fold(f64::INFINITY, f64::min)
    };
    let (timing_s, free_s) = (near("timing"), near("free"));
    assert!(free_s < timing_s - 0.1, "{free_s} {timing_s}");
    let folder = tempfile::tempdir().unwrap();
    let task =
        edited(folder.path(), SIMULATION, "arm = \"sample\"", &format!("arm = \"sample\"\ntimes_s = [{A}]"));
    let run = plan(&[task.to_str().unwrap(), "--near", "7"], "1");
    assert_eq!(run.status.code(), Some(2));
    assert!(stderr(&run).contains("the task gives times_s"), "{}", stderr(&run));
}
