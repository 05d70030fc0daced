//! "Safe to send?": the checks of `replan`, in its document and on its page.

use std::{fs, path::Path};

use serde_json::Value;

use crate::support::{clean, hold_to_schema, json, made, run_line, sample, scratch, stderr, stdout};

/// A folder with the sample run of task 1.
pub(super) fn with_run() -> tempfile::TempDir {
    let folder = scratch();
    fs::copy(sample("task-1-run.mcap"), folder.path().join("run.mcap")).unwrap();
    folder
}

/// The check of this name.
pub(super) fn check<'a>(document: &'a Value, what: &str) -> &'a Value {
    let list = document["checks"]["list"].as_array().unwrap();
    list.iter().find(|check| check["what"] == what).unwrap_or_else(|| panic!("no {what}: {list:?}"))
}

fn page(folder: &Path, line: &str) -> String {
    let run = run_line(folder, &format!("{line} --html page.html"));
    assert!(matches!(run.status.code(), Some(0 | 3)), "{line}: {}", stderr(&run));
    fs::read_to_string(folder.join("page.html")).unwrap()
}

#[test]
fn a_first_correction_is_advised_by_half_and_half_of_it_is_safe_to_send() {
    let folder = with_run();
    let folder = folder.path();
    let whole = json(folder, "replan run.mcap --keep-plan");
    hold_to_schema(&whole, "replan.v3");
    assert_eq!(whole["checks"]["verdict"], "half_first");
    assert_eq!(check(&whole, "gain")["reasons"], serde_json::json!(["first_command"]));
    let half = json(folder, "replan run.mcap --keep-plan --gain 0.5");
    assert_eq!(half["checks"]["verdict"], "send");
    for what in ["ends", "rest", "limits", "trust", "outlook", "leave", "gain"] {
        assert_eq!(check(&half, what)["level"], "good", "{what}");
    }
    let distance = |document: &Value| check(document, "leave")["distance_rad"].as_f64().unwrap();
    let largest = |document: &Value| {
        let joints = document["command"].as_array().unwrap();
        joints.iter().map(|joint| joint["peak_correction_rad"].as_f64().unwrap()).fold(0.0, f64::max)
    };
    assert!((distance(&whole) - largest(&whole)).abs() < 1e-3 * distance(&whole));
    assert!(distance(&half) < 0.6 * distance(&whole));
    let nearest = &check(&whole, "limits")["nearest"][0];
    let most = |key: &str| {
        let margins = whole[key].as_array().unwrap().iter();
        margins.map(|margin| margin["share"].as_f64().unwrap()).fold(0.0, f64::max)
    };
    assert_eq!(nearest["share"].as_f64().unwrap(), most("command_margins"), "{nearest}");
    assert_eq!(check(&whole, "trust")["joints"].as_array().unwrap().len(), 6);
}

#[test]
fn a_plan_at_its_limits_may_be_corrected_and_sent_whatever_its_shape() {
    let folder = scratch();
    let folder = folder.path();
    fs::copy(sample("tasks/task-1.toml"), folder.join("task.toml")).unwrap();
    for shape in ["timing", "free", "free --pieces 20"] {
        let planned = format!(
            "plan task.toml --choose fastest --evaluations 1000 --shape {shape} -o plan.mcap --force"
        );
        for line in [planned.as_str(), "simulate plan.mcap -o run.mcap --force"] {
            let run = run_line(folder, line);
            assert!(matches!(run.status.code(), Some(0 | 3)), "{line}: {}", stderr(&run));
        }
        let next = json(folder, "replan run.mcap --keep-plan --gain 0.5");
        let limits = check(&next, "limits");
        assert_eq!(limits["broken"], 0, "{shape}: {limits}");
        let joints = next["command"].as_array().unwrap();
        let corrected = joints.iter().filter(|joint| joint["share"].as_f64().unwrap() > 0.7).count();
        assert!(corrected >= 5, "{shape}: {joints:#?}");
    }
}

#[test]
fn a_new_plan_may_have_a_free_shape_and_has_one_where_the_last_one_had() {
    let folder = scratch();
    let folder = folder.path();
    fs::copy(sample("tasks/task-1.toml"), folder.join("task.toml")).unwrap();
    for line in [
        "plan task.toml --choose fastest --evaluations 1000 --shape free -o plan.mcap",
        "simulate plan.mcap -o run.mcap",
        "replan run.mcap --no-precompensation --max-time-growth-percent 5 --evaluations 1000 -o next.mcap",
        "simulate next.mcap -o again.mcap",
        "replan again.mcap --keep-plan --gain 0.5 -o corrected.mcap",
    ] {
        let run = run_line(folder, line);
        assert!(matches!(run.status.code(), Some(0 | 3)), "{line}: {}", stderr(&run));
        if line.contains("growth") {
            let text = stdout(&run);
            assert!(text.contains("re-timed in a free shape"), "{text}");
            // The time that was allowed is taken.
            assert!(!text.contains("--max-time-growth-percent"), "{text}");
        }
    }
    let of = |line: &str| {
        let next = json(folder, line);
        assert_eq!(check(&next, "limits")["broken"], 0, "{line}");
        next["after"]["sum_of_peaks_rad"].as_f64().unwrap()
    };
    let both = of("replan run.mcap --max-time-growth-percent 5 --evaluations 1000");
    let times = of("replan run.mcap --max-time-growth-percent 5 --evaluations 1000 --shape timing");
    assert!(both <= times, "{both} {times}");
}

#[test]
fn the_page_answers_with_verdict_checks_commands_and_every_joint_and_fetches_nothing() {
    let folder = with_run();
    let folder = folder.path();
    let whole = page(folder, "replan run.mcap --keep-plan -o next.mcap");
    assert!(whole.contains("Send half of the correction first: no correction of this plan was sent before."));
    for words in [
        "<code>hydrotrace replan run.mcap --keep-plan --gain 0.5 -o careful.mcap</code>",
        "<code>hydrotrace join RUN.mcap --plan careful.mcap -o after.mcap</code>",
        "<code>hydrotrace compare run.mcap after.mcap</code>",
        "default-src 'none'; script-src 'sha256-",
        "<li class=\"care\"><span class=\"mark\">CARE</span><b>Size of step</b>",
        "90 % of starts",
    ] {
        assert!(whole.contains(words), "{words}");
    }
    assert!(!whole.contains("src=\"http") && !whole.contains("href=\"http"));
    let data = whole.split("<script id=\"data\" type=\"application/json\">").nth(1).unwrap();
    let charts: Vec<Value> = serde_json::from_str(data.split("</script>").next().unwrap()).unwrap();
    let names: Vec<&str> = charts.iter().map(|chart| chart["title"].as_str().unwrap()).collect();
    assert_eq!(names, ["J1", "J2", "J3", "J4", "J5", "J6"]);
    for chart in &charts {
        let roles = |panel: usize| -> Vec<&str> {
            let series = chart["panels"][panel]["series"].as_array().unwrap();
            series.iter().map(|series| series["role"].as_str().unwrap()).collect()
        };
        assert!(
            roles(0).starts_with(&["planned", "error", "measured"]) && roles(2).starts_with(&["planned"])
        );
        assert_eq!(roles(1), ["band", "band", "error", "measured"]);
    }
    let guides = charts.iter().filter(|chart| chart["panels"].to_string().contains("\"guide\""));
    assert_eq!(guides.count(), 6, "no limit is drawn");
    let half = page(folder, "replan run.mcap --keep-plan --gain 0.5");
    assert!(half.contains("Yes, send it: all 7 checks are good.") && !half.contains("careful.mcap"));
    assert!(half.contains("-o next.mcap</code>"), "nothing says how to write it");
    let kept = run_line(folder, "replan run.mcap --keep-plan --html run.mcap");
    assert!(kept.status.code() == Some(1) && stderr(&kept).contains("is an input"), "{}", stderr(&kept));
}

#[test]
fn a_limit_that_is_broken_and_a_loop_that_hunts_stop_it() {
    let folder = with_run();
    let folder = folder.path();
    let task = fs::read_to_string(folder.join("task-1.toml")).unwrap();
    let tight = task.replace("speed_deg_s = { J1 = 15,", "speed_deg_s = { J1 = 2,");
    fs::write(folder.join("tight.toml"), tight).unwrap();
    let broken = json(folder, "replan run.mcap --keep-plan --task tight.toml");
    assert_eq!(
        (&broken["checks"]["verdict"], &check(&broken, "limits")["level"]),
        (&"do_not_send".into(), &"stop".into())
    );
    assert!(check(&broken, "limits")["broken"].as_u64().unwrap() > 0);
    clean(folder, "plan task-1.toml --times 0,7.744,15.307,22.863,30.976,38.72 -o plan.mcap");
    clean(folder, "simulate plan.mcap --plant cascade -o hunts.mcap");
    let run = run_line(folder, "replan hunts.mcap --keep-plan");
    assert!(
        stdout(&run).contains("Do not send it: joints oscillating by themselves ("),
        "{}{}",
        stdout(&run),
        stderr(&run)
    );
    assert!(stdout(&run).contains("Oscillating by themselves: "), "{}", stdout(&run));
}

#[test]
fn a_log_without_a_task_asks_for_a_look_at_the_limits_and_a_promise_is_held_to_what_came() {
    let folder = with_run();
    let folder = folder.path();
    clean(folder, "export run.mcap --csv -o run.csv");
    let run = run_line(folder, "import run.csv -o field.mcap");
    assert!(matches!(run.status.code(), Some(0 | 3)), "{}", stderr(&run));
    let field = json(folder, "replan field.mcap --keep-plan --gain 0.5");
    assert_eq!(field["checks"]["verdict"], "check_first");
    assert_eq!(check(&field, "limits")["nearest"], serde_json::json!([]));
    assert_eq!(check(&field, "rest")["level"], "good", "{}", check(&field, "rest"));
    made(folder, "replan run.mcap --keep-plan -o next.mcap");
    made(folder, "simulate next.mcap -o run-2.mcap --seed 7");
    let second = json(folder, "replan run.mcap run-2.mcap --evaluations 1000");
    let promise = check(&second, "promise");
    assert_eq!((&promise["level"], &promise["log"]), (&"good".into(), &"run-2.mcap".into()), "{promise}");
    assert!(
        promise["measured_mean_peak_rad"].as_f64() <= promise["promised"]["mean_peak_margin_rad"].as_f64()
    );
    assert_ne!(second["checks"]["verdict"], "half_first", "{}", second["checks"]);
    assert_eq!(check(&second, "gain")["reasons"], serde_json::json!([]));
}

/// The export of a log: its columns, and its rows of cells.
fn exported(folder: &Path, log: &str) -> (Vec<String>, Vec<Vec<String>>) {
    let run = run_line(folder, &format!("export {log} -o rows.csv --force"));
    assert!(run.status.success(), "{}", stderr(&run));
    let text = fs::read_to_string(folder.join("rows.csv")).unwrap();
    let cells = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
    let mut lines = text.lines().map(cells);
    (lines.next().unwrap(), lines.collect())
}

/// The log as a table; measured angles by joint, time and angle.
pub(super) fn table(folder: &Path, log: &str, path: &str, measured: impl Fn(usize, f64, f64) -> f64) {
    let (header, rows) = exported(folder, log);
    let time = header.iter().position(|name| name == "time_s").unwrap();
    let mut csv = header.join(",") + "\n";
    for row in rows {
        let t_s = row[time].parse::<f64>().unwrap();
        let cell = |(name, value): (&String, &String)| match name.strip_suffix("_measured_rad") {
            Some(joint) if !value.is_empty() => {
                measured(joint[1..].parse().unwrap(), t_s, value.parse().unwrap()).to_string()
            }
            _ => value.clone(),
        };
        csv += &(header.iter().zip(&row).map(cell).collect::<Vec<_>>().join(",") + "\n");
    }
    fs::write(folder.join(path), csv).unwrap();
}

#[test]
fn of_a_machine_that_cannot_be_predicted_no_command_is_made() {
    let folder = with_run();
    let folder = folder.path();
    fs::copy(sample("tasks/task-1.toml"), folder.join("task.toml")).unwrap();
    made(folder, "replan run.mcap --keep-plan -o sent.mcap");
    made(folder, "simulate sent.mcap -o run-2.mcap");
    let wanders = |joint: usize, t_s: f64, angle_rad: f64| {
        angle_rad + 0.1 * (0.02 * t_s * t_s + joint as f64).sin() * (1.7 * t_s).cos()
    };
    table(folder, "run.mcap", "odd.csv", wanders);
    table(folder, "run-2.mcap", "second.csv", wanders);
    for line in ["odd.csv", "odd.csv --task task.toml --keep-plan", "second.csv --task task.toml"] {
        let run = run_line(folder, &format!("replan {line} -o next.mcap"));
        assert_eq!(run.status.code(), Some(1), "{line}: {}", stdout(&run));
        assert!(stderr(&run).contains("no joint is predicted well enough"), "{line}: {}", stderr(&run));
        assert!(!folder.join("next.mcap").exists(), "{line}");
    }
    let planned = json(folder, "replan odd.csv --task task.toml --evaluations 1000 -o next.mcap");
    assert!(planned["remarks"].to_string().contains("only the plan changes"), "{}", planned["remarks"]);
    assert_eq!(planned["command"], serde_json::json!([]));
    table(folder, "run.mcap", "stray.csv", |_, _, angle_rad| 0.9 - angle_rad);
    let run = run_line(folder, "replan stray.csv -o stray.mcap");
    assert_eq!(run.status.code(), Some(1), "{}", stdout(&run));
    assert!(!folder.join("stray.mcap").exists());
}

#[test]
fn a_joint_in_another_frame_than_its_plan_is_told_and_left_alone() {
    let folder = with_run();
    let folder = folder.path();
    table(folder, "run.mcap", "odd.csv", |joint, _, angle_rad| match joint {
        2 => -angle_rad,
        5 => angle_rad + 0.2,
        _ => angle_rad,
    });
    let next = json(folder, "replan odd.csv -o next.mcap");
    for said in ["J2 moves against its plan", "J5 was measured 11.44 deg beside its plan"] {
        assert!(next["remarks"].to_string().contains(said), "{said}: {}", next["remarks"]);
    }
    let joints = next["command"].as_array().unwrap();
    let by = |joint: &Value| joint["step"]["by"].as_str().unwrap().to_owned();
    let by: Vec<String> = joints.iter().map(by).collect();
    assert_eq!(by, ["first", "astray", "first", "first", "astray", "first"]);
    assert!(check(&next, "leave")["distance_rad"].as_f64().unwrap() < 0.05, "{}", check(&next, "leave"));
    let trust = check(&next, "trust");
    assert_eq!(
        (&trust["level"], &trust["joints"][1]["astray"]),
        (&"caution".into(), &true.into()),
        "{trust}"
    );
    assert!(page(folder, "replan odd.csv").contains("Not following the plan"));
}

#[test]
fn a_joint_that_is_stuck_is_expected_to_stay_so_and_the_others_are_corrected() {
    let folder = with_run();
    let folder = folder.path();
    let noise = std::cell::RefCell::new(0_u32);
    table(folder, "run.mcap", "stuck.csv", |joint, _, angle_rad| {
        let mut state = noise.borrow_mut();
        *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        if joint == 2 { 0.9 + 4e-4 * (f64::from(*state) / f64::from(u32::MAX) - 0.5) } else { angle_rad }
    });
    let next = json(folder, "replan stuck.csv -o next.mcap");
    let last_rad = next["before"]["measured_mean_peak_rad"].as_f64().unwrap();
    let next_rad = next["after"]["mean_peak_rad"].as_f64().unwrap();
    assert!((0.7 * last_rad..last_rad).contains(&next_rad), "{last_rad} {next_rad}");
    let trust = check(&next, "trust");
    let stuck = &trust["joints"][1];
    assert_eq!(stuck["astray"], true, "{trust}");
    assert_eq!(stuck["frequency_hz"], Value::Null, "{trust}");
    assert!(stuck["held_out_r2"].as_f64().unwrap() >= -1.0, "{trust}");
}

#[test]
fn after_corrections_that_gained_nothing_the_plan_is_sent_as_it_is() {
    let folder = with_run();
    let folder = folder.path();
    made(folder, "replan run.mcap --keep-plan -o sent.mcap");
    made(folder, "simulate sent.mcap -o run-2.mcap");
    clean(folder, "replan run.mcap --keep-plan --gain 0.6 -o less.mcap");
    clean(folder, "simulate less.mcap -o run-3.mcap");
    for (run, path, by) in [("run-2.mcap", "bad-1.csv", 0.03), ("run-3.mcap", "bad-2.csv", 0.031)] {
        table(folder, run, path, |_, t_s, angle_rad| angle_rad + by * (0.6 * t_s).sin());
    }
    clean(folder, "simulate run.mcap -o again.mcap --seed 9");
    let line = "replan run.mcap bad-1.csv bad-2.csv again.mcap --evaluations 1000 -o next.mcap";
    let said = stdout(&run_line(folder, line));
    for part in ["Send the plan as it is", "2 corrections gained nothing", "command  is the plan"] {
        assert!(said.contains(part), "{part}: {said}");
    }
    assert!(!stdout(&run_line(folder, "info next.mcap")).contains("/command/joint_states"));
}

#[test]
fn of_a_run_whose_clocks_differ_no_command_is_made() {
    let folder = with_run();
    let folder = folder.path();
    for (delay_ms, told) in [(2500, "s before their plan"), (-2500, "s after their plan")] {
        let taken_off = format!("run.mcap --measured-delay-ms={delay_ms}");
        let report = run_line(folder, &format!("report {taken_off}"));
        assert_eq!(report.status.code(), Some(3), "{told}: {}", stderr(&report));
        assert!(stdout(&report).contains(told), "{told}: {}", stdout(&report));
        let next = run_line(folder, &format!("replan {taken_off} -o next.mcap"));
        assert_eq!(next.status.code(), Some(1), "{told}: {}", stdout(&next));
        assert!(stderr(&next).contains(told), "{told}: {}", stderr(&next));
        assert!(!folder.join("next.mcap").exists(), "{told}");
    }
}

#[test]
fn of_a_run_that_was_stopped_no_command_is_made() {
    let folder = with_run();
    let folder = folder.path();
    let stood = std::cell::RefCell::new([0.0; 7]);
    table(folder, "run.mcap", "stopped.csv", |joint, t_s, angle_rad| {
        if t_s < 33.0 {
            stood.borrow_mut()[joint] = angle_rad;
        }
        stood.borrow()[joint] + 1e-4 * (1e3 * t_s).sin()
    });
    let report = run_line(folder, "report stopped.csv");
    assert!(stdout(&report).contains("stopped x1"), "{}", stdout(&report));
    let next = run_line(folder, "replan stopped.csv -o next.mcap");
    assert_eq!(next.status.code(), Some(1), "{}", stdout(&next));
    assert!(stderr(&next).contains("the machine was stopped"), "{}", stderr(&next));
    assert!(!folder.join("next.mcap").exists());
}

#[test]
fn a_joint_that_slides_is_corrected_by_metres_as_one_that_turns_is_by_radians() {
    let folder = with_run();
    let folder = folder.path();
    let (header, rows) = exported(folder, "run.mcap");
    let column = |name: &str| header.iter().position(|cell| cell == name).unwrap();
    let [planned, measured, t_s] = ["J1_planned_rad", "J1_measured_rad", "time_s"].map(column);
    let mut csv = "time_s,boom_planned_rad,boom_measured_rad,tele_planned_mm,tele_measured_mm\n".to_owned();
    for row in rows.iter().filter(|row| !row[planned].is_empty() && !row[measured].is_empty()) {
        let mm = |cell: &str| 1e3 * cell.parse::<f64>().unwrap();
        let [plan, came] = [&row[planned], &row[measured]];
        csv += &format!("{},{plan},{came},{},{}\n", row[t_s], mm(plan), mm(came));
    }
    fs::write(folder.join("crane.csv"), csv).unwrap();
    let document = json(folder, "replan crane.csv --keep-plan -o next.mcap");
    let [boom, tele] = [0, 1].map(|k| &document["command"][k]);
    assert_eq!((&boom["kind"], &tele["kind"]), (&"turns".into(), &"slides".into()));
    let of = |joint: &Value| joint["peak_correction_rad"].as_f64().unwrap();
    assert!((of(boom) - of(tele)).abs() < 1e-9 && of(boom) > 1e-3, "{boom} {tele}");
    let page = page(folder, "replan crane.csv --keep-plan");
    let mm = format!("corrected by up to {:.2} mm", 1e3 * of(tele));
    assert!(page.contains(&mm) && page.contains("Length (mm)") && page.contains("Angle (deg)"), "{mm}");
    let compared = run_line(folder, "compare crane.csv crane.csv");
    for kind in ["that turn", "that slide"] {
        let said = format!("at transitions of joints {kind} is the same in 3 pairs");
        assert!(stdout(&compared).contains(&said), "{}", stdout(&compared));
    }
    let (header, rows) = exported(folder, "next.mcap");
    let column =
        |name: &str| header.iter().position(|cell| cell == name).unwrap_or_else(|| panic!("{header:?}"));
    let number = |row: &[String], name: &str| row[column(name)].parse::<f64>().unwrap();
    let off = |joint: &str, unit: &str| {
        let apart = |row: &Vec<String>| {
            number(row, &format!("{joint}_command_{unit}")) - number(row, &format!("{joint}_planned_{unit}"))
        };
        rows.iter().map(apart).fold(0.0, |most: f64, apart| most.max(apart.abs()))
    };
    assert!((off("tele", "m") - off("boom", "rad")).abs() < 1e-9 && off("boom", "rad") > 1e-3);
    let moves = |row: &Vec<String>| number(row, "tele_planned_m");
    assert!(rows.iter().map(moves).fold(0.0, f64::max) > 0.8, "it moves in metres");
}
