//! `replan` over several runs: what older ones still tell, and what holds for the next line.

use std::fs;

use super::replan::{check, table, with_run};
use crate::support::{
    clean, fleet::small_log, json, made, run_line, said, sample, scratch, stderr, stdout, timed,
};

#[test]
fn a_task_that_begins_elsewhere_is_refused_and_bounds_hold_for_the_next_line() {
    let folder = with_run();
    let folder = folder.path();
    let task = fs::read_to_string(folder.join("task-1.toml")).unwrap();
    let first = task.find("angles_deg = { J1 = ").unwrap();
    let (before, angles) = task.split_at(first + "angles_deg = { J1 = ".len());
    let end = angles.find(',').unwrap();
    let moved = format!("{before}{}{}", angles[..end].parse::<f64>().unwrap() + 15.0, &angles[end..]);
    fs::write(folder.join("moved.toml"), moved).unwrap();
    let run = run_line(folder, "replan run.mcap --task moved.toml -o next.mcap");
    assert_eq!(run.status.code(), Some(1), "{}", stdout(&run));
    assert!(stderr(&run).contains("beside the first key point of the task (J1)"), "{}", stderr(&run));
    assert!(!folder.join("next.mcap").exists());
    let run = run_line(folder, "replan run.mcap --keep-plan --max-correction-deg 1 -o next.mcap");
    let line =
        stdout(&run).lines().find(|line| line.contains("replan run.mcap after.mcap")).map(str::to_owned);
    assert_eq!(
        line.as_deref().map(str::trim),
        Some("hydrotrace replan run.mcap after.mcap --max-correction-deg=1 -o next-2.mcap")
    );
}

#[test]
fn a_plan_of_another_task_is_no_next_plan_of_this_one() {
    let folder = with_run();
    let folder = folder.path();
    let task = fs::read_to_string(folder.join("task-1.toml")).unwrap();
    // The joint goes farther in the middle: no longer way, and no plan that is there passes it.
    fs::write(folder.join("other.toml"), task.replace("J1 = 37.2, J2", "J1 = 33.2, J2")).unwrap();
    let kept = run_line(folder, "replan run.mcap --task other.toml --keep-plan -o kept.mcap");
    let said = format!("{}{}", stdout(&kept), stderr(&kept));
    assert!(said.contains("does not pass key point 2") && said.contains("nor does the next"), "{said}");
    let next = run_line(folder, "replan run.mcap --task other.toml --evaluations 2000 -o next.mcap");
    let said = format!("{}{}", stdout(&next), stderr(&next));
    let passes = said.contains("the next plan passes it") && !said.contains("plan     unchanged");
    assert!(passes || next.status.code() == Some(1) && said.contains("no plan of the task"), "{said}");
}

#[test]
fn a_machine_that_has_changed_is_learnt_anew() {
    let folder = with_run();
    let folder = folder.path();
    made(folder, "replan run.mcap --keep-plan -o next.mcap");
    clean(folder, "simulate next.mcap --plant position-only -o run-2.mcap --seed 2");
    clean(folder, "simulate run.mcap --plant position-only -o run-3.mcap --seed 3");
    let next = json(folder, "replan run.mcap run-2.mcap run-3.mcap --keep-plan -o next-2.mcap");
    let runs = next["runs"].as_array().unwrap().len();
    assert!(next["remarks"].to_string().contains("machine-changed") && runs == 2, "{}", next["remarks"]);
    // What is promised is of the machine as it is.
    let promised = check(&next, "outlook")["expected"]["mean_peak_rad"].as_f64().unwrap();
    clean(folder, "simulate next-2.mcap --plant position-only -o run-4.mcap --seed 4");
    let came = json(folder, "report run-4.mcap")["promised"]["measured_mean_peak_rad"].as_f64().unwrap();
    assert!((0.5..2.0).contains(&(came / promised)), "{promised} rad promised, {came} rad came");
}

/// A recorder of fewer samples than the plan has: what lies between its samples is interpolated.
#[test]
fn a_plan_that_was_sent_as_it_is_and_recorded_at_20_hz_is_no_correction() {
    let folder = scratch();
    let folder = folder.path();
    run_line(folder, "plan task-1.toml --choose fastest --evaluations 1000 -o plan.mcap");
    run_line(folder, "simulate plan.mcap -o recorded.mcap");
    let table = stdout(&run_line(folder, "export recorded.mcap --csv"));
    let names: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let kept = |k: &usize| {
        let name = names[*k];
        name == "time_s" || name.ends_with("_planned_rad") || name.ends_with("_measured_rad")
    };
    let line = |line: &str| -> String {
        let cells = line.split(',').enumerate().filter(|(k, _)| kept(k));
        cells.map(|(_, cell)| cell).collect::<Vec<_>>().join(",") + "\n"
    };
    let whole = |text: &&str| !text.split(',').enumerate().any(|(k, cell)| kept(&k) && cell.is_empty());
    let rows = table.lines().skip(1).filter(whole).step_by(5).map(line);
    let head = line(&table.lines().next().unwrap().replace("_planned_", "_command_"));
    fs::write(folder.join("rows.csv"), head + &rows.collect::<String>()).unwrap();
    run_line(folder, "import rows.csv -o rows.mcap");
    let joined = run_line(folder, "join rows.mcap --plan plan.mcap -o run.mcap");
    assert!(matches!(joined.status.code(), Some(0 | 3)), "{}", stderr(&joined));
    let next = json(folder, "replan run.mcap --keep-plan -o next.mcap");
    assert_eq!(next["runs"][0]["corrected"], false);
    let reasons = &check(&next, "gain")["reasons"];
    assert_eq!(reasons.to_string(), r#"["first_command"]"#);
}

/// What was begun with half of a correction ends where the whole would have: the step over a dead band is in no error.
#[test]
fn a_careful_first_command_is_followed_by_its_rest() {
    let folder = with_run();
    let folder = folder.path();
    made(folder, "replan run.mcap --keep-plan --gain 0.5 -o half.mcap");
    made(folder, "simulate half.mcap -o run-2.mcap --seed 2");
    let next = json(folder, "replan run.mcap run-2.mcap --keep-plan -o rest.mcap");
    let steps = || next["command"].as_array().unwrap().iter().map(|joint| &joint["step"]);
    let rests = steps().filter(|step| step["by"] == "rest");
    let shares: Vec<f64> = rests.map(|step| step["share"].as_f64().unwrap()).collect();
    assert!(2 * shares.len() > steps().count(), "{}", next["command"]);
    assert!(shares.iter().all(|share| *share > 0.99), "{shares:?}");
    // Sent twice, to see how runs differ, it is no correction that gained nothing.
    clean(folder, "simulate half.mcap -o again.mcap --seed 12");
    let next = json(folder, "replan run.mcap run-2.mcap again.mcap --keep-plan");
    assert_eq!(next["decision"]["what"], "send", "{}", next["decision"]);
    let rests = next["command"].as_array().unwrap().iter().filter(|joint| joint["step"]["by"] == "rest");
    assert!(2 * rests.count() > shares.len(), "{}", next["command"]);
    clean(folder, "simulate rest.mcap -o run-3.mcap --seed 3");
    made(folder, "replan run.mcap --keep-plan -o whole.mcap");
    clean(folder, "simulate whole.mcap -o direct.mcap --seed 3");
    let mean = |log: &str| {
        json(folder, &format!("report {log}"))["promised"]["measured_mean_peak_rad"].as_f64().unwrap()
    };
    let [half, rest, whole] = ["run-2.mcap", "run-3.mcap", "direct.mcap"].map(mean);
    assert!(
        rest < 1.1 * whole && rest < 0.6 * half,
        "half {half} rad, its rest {rest} rad, the whole {whole} rad"
    );
}

/// With a careful gain no command comes twice, so that none tells by itself that the machine answers otherwise.
#[test]
fn what_was_sent_to_another_machine_is_not_sent_again_though_no_command_came_twice() {
    let folder = with_run();
    let folder = folder.path();
    made(folder, "replan run.mcap --keep-plan --gain 0.5 -o next-2.mcap");
    made(folder, "simulate next-2.mcap -o run-2.mcap --seed 2");
    clean(folder, "replan run.mcap run-2.mcap --keep-plan --gain 0.5 -o next-3.mcap");
    clean(folder, "simulate next-3.mcap --plant lag-limited -o run-3.mcap --seed 3");
    let next = json(folder, "replan run.mcap run-2.mcap run-3.mcap --keep-plan -o next-4.mcap");
    assert!(next["remarks"].to_string().contains("moved otherwise in run-3.mcap"), "{}", next["remarks"]);
    assert_eq!(next["runs"].as_array().unwrap().len(), 1, "{}", next["runs"]);
    clean(folder, "simulate next-4.mcap --plant lag-limited -o run-4.mcap --seed 4");
    let mean = |log: &str| {
        json(folder, &format!("report {log}"))["promised"]["measured_mean_peak_rad"].as_f64().unwrap()
    };
    let (before, after) = (mean("run-3.mcap"), mean("run-4.mcap"));
    assert!(after < 0.5 * before, "{before} rad, then {after}");
}

/// A new timing is sent with the correction that it needs; its errors are small then, and bound no later correction.
#[test]
fn learning_goes_on_after_a_new_timing_that_was_sent_with_a_wide_correction() {
    let folder = with_run();
    let folder = folder.path();
    clean(folder, "simulate run.mcap --plant lag-limited -o slow.mcap --seed 1");
    clean(folder, "replan slow.mcap -o next.mcap --evaluations 4000");
    clean(folder, "simulate next.mcap --plant lag-limited -o slow-2.mcap --seed 2");
    let next = json(folder, "replan slow.mcap slow-2.mcap --evaluations 1000");
    assert_eq!(next["decision"]["what"], "send", "{}", next["decision"]);
    let peak = |key: &str| -> f64 {
        let all = next["command"].as_array().unwrap().iter().map(|joint| joint[key].as_f64().unwrap());
        all.fold(0.0, f64::max)
    };
    assert!(peak("peak_correction_rad") > 0.024, "{}", peak("peak_correction_rad"));
    // More than 1.5 deg, as was sent.
    assert!(peak("most_correction_rad") > 0.03, "{}", peak("most_correction_rad"));
    assert!(peak("most_correction_rad") >= peak("peak_correction_rad"));
}

/// A machine that lags by seconds is well known and asks for a command that takes the tool somewhere else.
#[test]
fn a_command_that_takes_the_tool_a_metre_off_its_plan_is_not_to_be_sent() {
    let folder = with_run();
    let folder = folder.path();
    let plant = fs::read_to_string(sample("plant/position-only.toml")).unwrap();
    let slow = plant.replace("position_gain_1_s = 2.0", "position_gain_1_s = 0.25");
    fs::write(folder.join("slow.toml"), slow).unwrap();
    clean(folder, "simulate run.mcap --plant slow.toml -o slow.mcap");
    for (line, level) in
        [("replan slow.mcap --keep-plan", "stop"), ("replan slow.mcap --keep-plan --gain 0.5", "caution")]
    {
        let next = json(folder, line);
        assert_eq!(check(&next, "leave")["level"], level, "{}", check(&next, "leave"));
    }
    assert!(
        stdout(&run_line(folder, "replan slow.mcap --keep-plan")).contains("send less of it (--gain 0.5)")
    );
}

/// Set values of a PLC that go from target to target, and a joint that follows them at 8 deg/s, 0.25 s late.
#[test]
fn a_plan_that_steps_is_reported_and_fitted_and_no_command_is_made_of_it() {
    let folder = scratch();
    let targets = [(0.0, 0.0), (2.0, 12.0), (7.0, -5.0), (12.0, 6.0), (17.0, 0.0)];
    let set = |t_s: f64| targets.iter().rev().find(|(at_s, _)| t_s >= *at_s).map_or(0.0, |(_, set)| *set);
    let mut measured: f64 = 0.0;
    let table = timed("time_s,boom_set_deg,boom_act_deg", (1100, 0.02), |t_s| {
        measured += (2.0 * (set(t_s - 0.25) - measured)).clamp(-8.0, 8.0) * 0.02;
        format!("{t_s:.2},{},{measured:.4}", set(t_s))
    });
    fs::write(folder.path().join("run.csv"), table).unwrap();
    let said = |line: &str| said(&run_line(folder.path(), line));
    let (_, text, _) = said("report run.csv");
    assert!(text.contains("boom  "), "{text}");
    let (code, text, error) = said("fit run.csv -o limits.toml");
    assert!(code == 0 || code == 3, "{error}");
    assert!(text.contains("8.0 (") && !text.contains("replan run.csv"), "{text}");
    let (code, _, error) = said("replan run.csv --limits limits.toml -o next.mcap");
    assert_eq!(code, 1, "{error}");
    assert!(
        error.contains("the plan of boom steps by 12.00 deg at 2.00 s: no joint follows a step"),
        "{error}"
    );
    assert!(!folder.path().join("next.mcap").exists());
}

#[test]
fn a_command_that_is_returned_to_is_not_stopped_for_what_a_later_one_promised() {
    let folder = with_run();
    let folder = folder.path();
    let worn = "title = 'worn'\nbase = 'default'\n[encoder]\nbacklash_deg = 0.6\n";
    fs::write(folder.join("worn.toml"), worn).unwrap();
    made(folder, "replan run.mcap --keep-plan -o next-1.mcap");
    made(folder, "simulate next-1.mcap -o run-2.mcap --seed 7");
    clean(folder, "replan run.mcap run-2.mcap --keep-plan -o next-2.mcap");
    clean(folder, "simulate next-2.mcap -o run-3.mcap --plant worn.toml");
    let kept = json(folder, "replan run.mcap run-2.mcap run-3.mcap --keep-plan");
    assert_eq!(kept["decision"]["what"], "keep", "{}", kept["decision"]);
    assert_eq!(kept["decision"]["run"], 1, "{}", kept["decision"]);
    let promise = check(&kept, "promise");
    let [came, bound] = [&promise["measured_mean_peak_rad"], &promise["promised"]["mean_peak_margin_rad"]];
    assert!(came.as_f64() > bound.as_f64().map(|bound| 2.0 * bound), "{promise}");
    assert_eq!((&promise["level"], &kept["checks"]["verdict"]), (&"caution".into(), &"check_first".into()));
}

/// A fleet's recorder writes run.mcap every day.
#[test]
fn logs_of_one_name_are_told_apart_by_their_folders() {
    let folder = with_run();
    let folder = folder.path();
    for day in ["mon", "tue", "wed"] {
        fs::create_dir(folder.join(day)).unwrap();
    }
    fs::rename(folder.join("run.mcap"), folder.join("mon/run.mcap")).unwrap();
    clean(folder, "replan mon/run.mcap --keep-plan -o next.mcap");
    clean(folder, "simulate next.mcap -o tue/run.mcap --seed 2");
    clean(folder, "simulate next.mcap --plant lag-limited -o wed/run.mcap --seed 3");
    let both = "mon/run.mcap tue/run.mcap";
    for (line, keys) in [
        ("replan --keep-plan", ["runs", "fitted_to"]),
        ("fit", ["runs", "runs"]),
        ("compare", ["before", "after"]),
    ] {
        let found = json(folder, &format!("{line} {both}"));
        for (key, log) in keys.into_iter().zip(["\"mon/run.mcap\"", "\"tue/run.mcap\""]) {
            assert!(found[key].to_string().contains(log), "{line}: {}", found[key]);
        }
    }
    // Limits of one machine leave more where another was at work, though its log has the same name.
    clean(folder, "fit mon/run.mcap -o limits.toml");
    let left = |log: &str| {
        let next = json(folder, &format!("replan {log} --keep-plan --limits limits.toml"));
        check(&next, "outlook")["expected"]["mean_peak_margin_rad"].as_f64().unwrap()
    };
    let [own, other] = ["mon/run.mcap", "wed/run.mcap"].map(left);
    assert!(other > 1.5 * own, "{own} {other}");
}

/// As a table rounds them, two logs of a plan are not alike to the sample.
#[test]
fn the_line_that_fit_prints_names_every_run_of_the_plan() {
    let folder = with_run();
    let folder = folder.path();
    made(folder, "replan run.mcap --keep-plan -o next.mcap");
    made(folder, "simulate next.mcap -o run-2.mcap --seed 2");
    run_line(folder, "export run.mcap --csv -o all.csv");
    let text = fs::read_to_string(folder.join("all.csv")).unwrap();
    // From elsewhere on, and with every second row.
    let rows: Vec<&str> = text
        .lines()
        .enumerate()
        .filter(|(k, _)| k % 2 == 0 && !(1..61).contains(k))
        .map(|(_, row)| row)
        .collect();
    fs::write(folder.join("run.csv"), rows.join("\n") + "\n").unwrap();
    let (_, fitted, _) = said(&run_line(folder, "fit run.csv run-2.mcap -o limits.toml"));
    assert!(fitted.contains("hydrotrace replan run.csv run-2.mcap"), "{fitted}");
}

#[test]
fn a_log_that_ends_with_its_plan_is_told_to_hide_what_comes_after() {
    let folder = with_run();
    let folder = folder.path();
    let line = |options: &str| stdout(&run_line(folder, &format!("replan run.mcap --keep-plan {options}")));
    let duration_s = json(folder, "replan run.mcap --keep-plan")["duration_s"].as_f64().unwrap();
    assert!(!line("").contains("is judged in no run"), "{}", line(""));
    let cut = line(&format!("--to {}", 1.4 + duration_s));
    assert!(cut.contains("run.mcap ends 0.") && cut.contains("is judged in no run"), "{cut}");
}

#[test]
fn a_machine_that_oscillates_by_itself_is_refused_with_its_frequency() {
    let folder = with_run();
    let folder = folder.path();
    let hunts = |joint: usize, t_s: f64, angle_rad: f64| angle_rad + 0.08 * (7.0 * t_s + joint as f64).sin();
    table(folder, "run.mcap", "all.csv", hunts);
    let all = fs::read_to_string(folder.join("all.csv")).unwrap();
    // Of one joint: another one may be explained by chance.
    let kept =
        |name: &str| name == "time_s" || name.starts_with("J1_planned") || name.starts_with("J1_measured");
    let kept: Vec<bool> = all.lines().next().unwrap().split(',').map(kept).collect();
    let row = |row: &str| {
        let cells: Vec<&str> =
            row.split(',').zip(&kept).filter(|(_, kept)| **kept).map(|(cell, _)| cell).collect();
        cells.join(",") + "\n"
    };
    fs::write(folder.join("hunts.csv"), all.lines().map(row).collect::<String>()).unwrap();
    let run = run_line(folder, "replan hunts.csv -o next.mcap");
    assert_eq!(run.status.code(), Some(1), "{}", stdout(&run));
    let said = stderr(&run);
    assert!(said.contains("J1 oscillates by itself at 1.1"), "{said}");
}

/// A pattern of names gives `run-10` before `run-2`.
#[test]
fn the_newest_run_is_that_by_its_stamps() {
    let folder = scratch();
    let folder = folder.path();
    for (day, name) in [(1, "run-1"), (2, "run-2"), (10, "run-10")] {
        let bytes = small_log("M1", day, 40 + day as u64, [0.15, 0.2]);
        fs::write(folder.join(format!("{name}.mcap")), bytes).unwrap();
    }
    let [right, wrong] = ["run-1.mcap run-2.mcap run-10.mcap", "run-1.mcap run-10.mcap run-2.mcap"]
        .map(|runs| json(folder, &format!("replan {runs} --keep-plan -o next.mcap --force")));
    let logs = |found: &serde_json::Value| -> Vec<String> {
        found["runs"].as_array().unwrap().iter().map(|run| run["log"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!((logs(&wrong), logs(&wrong)[2].as_str()), (logs(&right), "run-10.mcap"));
    assert!(wrong["remarks"].to_string().contains("taken as run-1.mcap, run-2.mcap, run-10.mcap"), "{wrong}");
    assert!(!right["remarks"].to_string().contains("reordered"), "{}", right["remarks"]);
    assert_eq!(right["command"], wrong["command"]);
}
