//! Commands for machines that nobody knows: identification runs, runs in which a valve was dead, limits that no task says.

use std::{fs, path::Path};

use crate::support::{clean, fleet::smooth, json, run_line, said, sample, scratch};

/// A joint that follows a plan by its distance times a gain, and no faster than `most_deg_s`.
pub(super) fn followed(plan: impl Iterator<Item = (f64, f64)>, gain_1_s: f64, most_deg_s: f64) -> String {
    let (mut text, mut now) = ("t_s,boom_planned_deg,boom_measured_deg\n".to_owned(), None);
    for (t_s, planned) in plan {
        let (before_s, mut at) = now.unwrap_or((t_s, planned));
        at += (t_s - before_s) * (gain_1_s * (planned - at)).clamp(-most_deg_s, most_deg_s);
        text += &format!("{t_s:.2},{planned:.5},{at:.5}\n");
        now = Some((t_s, at));
    }
    text
}

/// Six moves between 30 and 50 deg of so many seconds each, by time.
pub(super) fn moves(takes_s: f64) -> impl Iterator<Item = (f64, f64)> {
    (0..7500).map(move |k| {
        let t_s = 0.01 * f64::from(k);
        let moves = (0..6).map(|k| [20.0, -20.0][k % 2] * smooth((t_s - 2.0 - 11.0 * k as f64) / takes_s));
        (t_s, 30.0 + moves.sum::<f64>())
    })
}

fn commanded_deg(folder: &Path, log: &str) -> [f64; 2] {
    let (_, table, _) = said(&run_line(folder, &format!("export {log} --degrees --csv")));
    let column =
        table.lines().next().unwrap().split(',').position(|name| name == "boom_command_deg").unwrap();
    let angles = table.lines().skip(1).filter_map(|row| row.split(',').nth(column)?.parse::<f64>().ok());
    angles
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], angle| [least.min(angle), most.max(angle)])
}

#[test]
fn a_command_without_known_limits_stays_near_the_range_of_its_plan() {
    let folder = scratch();
    let folder = folder.path();
    fs::write(folder.join("slow.csv"), followed(moves(5.0), 3.0, 4.5)).unwrap();
    let next = json(folder, "replan slow.csv -o next.mcap");
    let [least, most] = commanded_deg(folder, "next.mcap");
    assert!(least > 28.0 && most < 52.0, "{least} to {most}");
    // That is no reason to do nothing.
    assert!(least < 29.0 && most > 51.0, "{least} to {most}");
    let mean = |of: &serde_json::Value| of["mean_peak_rad"].as_f64().unwrap();
    assert!(mean(&next["after"]) < 0.8 * mean(&next["before"]["predicted"]), "{}", next["after"]);
}

/// Known limits of speed that the plan stays far from hold no command back.
#[test]
fn a_joint_that_only_lags_is_sent_ahead_though_its_limits_are_known() {
    let folder = scratch();
    let folder = folder.path();
    clean(folder, "excite -o id.mcap --joint boom=40:25:55");
    let (_, text, _) = said(&run_line(folder, "export id.mcap --degrees --csv"));
    let column = |name| text.lines().next().unwrap().split(',').position(|own| own == name).unwrap();
    let [time, angle] = ["time_s", "boom_planned_deg"].map(column);
    let strokes = text.lines().skip(1).map(|row| {
        let cell = |k: usize| row.split(',').nth(k).unwrap().parse::<f64>().unwrap();
        (cell(time), cell(angle))
    });
    fs::write(folder.join("id.csv"), followed(strokes, 0.6, 6.0)).unwrap();
    fs::write(folder.join("slow.csv"), followed(moves(9.0), 0.6, 6.0)).unwrap();
    let (_, said, _) = said(&run_line(folder, "fit id.csv -o limits.toml"));
    assert!(said.contains("boom   6.1 ("), "{said}");
    run_line(folder, "replan slow.csv --limits limits.toml -o next.mcap");
    let [least, most] = commanded_deg(folder, "next.mcap");
    assert!(least < 28.0 && most > 52.0, "{least} to {most}");
}

#[test]
fn an_identification_run_is_fitted_and_not_corrected_whoever_recorded_it() {
    let folder = scratch();
    let folder = folder.path();
    clean(folder, "excite -o id.mcap --task task-1.toml");
    clean(folder, "simulate id.mcap -o id-run.mcap");
    let (_, text, _) = said(&run_line(folder, "export id-run.mcap --degrees --csv"));
    fs::write(folder.join("id-run.csv"), text).unwrap();
    for log in ["id-run.mcap", "id-run.csv"] {
        let (code, out, error) = said(&run_line(folder, &format!("fit {log} -o limits.toml --force")));
        assert!(code != 1 && out.contains("hydrotrace replan RUN.mcap --limits"), "{code} {out} {error}");
        let (code, _, error) =
            said(&run_line(folder, &format!("replan {log} --limits limits.toml -o next.mcap")));
        assert!(code == 1 && error.contains("is an identification run"), "{code} {error}");
        assert!(!folder.join("next.mcap").exists());
    }
}

#[test]
fn a_run_in_which_a_valve_was_dead_teaches_nothing() {
    let folder = scratch();
    let folder = folder.path();
    fs::copy(sample("task-1-run.mcap"), folder.join("run-0.mcap")).unwrap();
    let (_, text, _) = said(&run_line(folder, "export run-0.mcap --degrees --csv"));
    let column = text.lines().next().unwrap().split(',').position(|name| name == "J3_measured_deg").unwrap();
    let rows = text.lines().enumerate().map(|(k, row)| {
        let mut cells: Vec<&str> = row.split(',').collect();
        if k > 0 && !cells[column].is_empty() {
            cells[column] = "-20.0";
        }
        cells.join(",") + "\n"
    });
    fs::write(folder.join("dead.csv"), rows.collect::<String>()).unwrap();
    clean(folder, "simulate run-0.mcap -o run-2.mcap --seed 2");
    let next = json(folder, "replan run-0.mcap dead.csv run-2.mcap --keep-plan");
    assert!(next["remarks"].to_string().contains("J3 hardly moves in it"), "{}", next["remarks"]);
    assert_eq!(next["runs"].as_array().unwrap().len(), 2, "{}", next["runs"]);
    let step = &next["command"].as_array().unwrap()[2];
    assert!(step["peak_correction_rad"].as_f64().unwrap() > 0.001, "{step}");
    // The newest one teaches as little, and no command is kept for what came of it.
    let next = json(folder, "replan run-0.mcap run-2.mcap dead.csv --keep-plan");
    assert!(next["remarks"].to_string().contains("dead.csv: J3 hardly moves in it"), "{}", next["remarks"]);
    assert_eq!(next["runs"].as_array().unwrap().len(), 2, "{}", next["runs"]);
    // Nor does it, or a run that was stopped in motion, teach what the machine can do.
    let rows: Vec<&str> = text.lines().collect();
    let moving = 1 + rows.len() / 3;
    let held = rows.iter().enumerate().map(|(k, row)| match row.split_once(',') {
        Some((time, _)) if k > moving => format!("{time},{}\n", rows[moving].split_once(',').unwrap().1),
        _ => format!("{row}\n"),
    });
    fs::write(folder.join("stopped.csv"), held.collect::<String>()).unwrap();
    let alone = json(folder, "fit run-0.mcap run-2.mcap");
    let all = json(folder, "fit run-0.mcap dead.csv stopped.csv run-2.mcap");
    assert_eq!(alone["joints"], all["joints"]);
    let remarks = all["remarks"].to_string();
    assert!(remarks.contains("dead.csv: J3 hardly moves in it"), "{remarks}");
    assert!(remarks.contains("stopped.csv: its plan stops at once"), "{remarks}");
    let only = json(folder, "fit stopped.csv");
    assert!(only["remarks"].to_string().contains("what the stop did is taken for the machine's"), "{only}");
}

#[test]
fn a_run_whose_set_values_were_held_is_no_plan_to_send_and_one_given_twice_counts_once() {
    let folder = scratch();
    let folder = folder.path();
    // Held at 15 s, in the second move, for so long.
    let write = |file: &str, held_s: f64| {
        let plan: Vec<(f64, f64)> = moves(4.0).collect();
        let at = |t_s: f64| plan[((100.0 * t_s).round() as usize).min(plan.len() - 1)].1;
        let course = plan.iter().map(|(t_s, _)| (*t_s, at(t_s.min(15.0_f64.max(t_s - held_s)))));
        fs::write(folder.join(file), followed(course, 4.0, 99.0)).unwrap();
    };
    for (file, held_s) in [("run.csv", 0.0), ("stop.csv", 99.0), ("pause.csv", 3.0)] {
        write(file, held_s);
    }
    for stopped in ["stop.csv", "pause.csv"] {
        let (code, _, error) = said(&run_line(folder, &format!("replan {stopped} --keep-plan -o next.mcap")));
        assert!(code == 1 && error.contains("stops at once at 15.0"), "{stopped} {code} {error}");
        assert!(!folder.join("next.mcap").exists());
        let next = json(folder, &format!("replan {stopped} run.csv --keep-plan"));
        let said = next["remarks"].to_string();
        assert!(said.contains(&format!("{stopped}: its plan stops at once at 15.0")), "{said}");
        assert_eq!(next["runs"].as_array().unwrap().len(), 1, "{}", next["runs"]);
    }
    let next = json(folder, "replan run.csv run.csv --keep-plan");
    assert!(next["remarks"].to_string().contains("the same recording as run.csv"), "{}", next["remarks"]);
    assert_eq!(next["runs"].as_array().unwrap().len(), 1, "{}", next["runs"]);
}

#[test]
fn a_plan_that_is_faster_than_its_joint_is_told_with_both_speeds() {
    let folder = scratch();
    let folder = folder.path();
    let said_of = |most_deg_s: f64| {
        fs::write(folder.join("run.csv"), followed(moves(4.0), 3.0, most_deg_s)).unwrap();
        let (_, said, _) = said(&run_line(folder, "replan run.csv"));
        said
    };
    let slow = said_of(5.0);
    let line =
        slow.lines().find(|line| line.starts_with("CARE  Too fast")).unwrap_or_else(|| panic!("{slow}"));
    assert!(
        line.contains("The plan of boom goes up to 9.3") && line.contains("a slower plan does"),
        "{line}"
    );
    assert!(!said_of(30.0).contains("Too fast"));
}
