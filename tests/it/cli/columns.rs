//! Tables as people write them: lengths, sums, maps, and tables given as they are.

use std::fs;

use serde_json::Value;

use super::csv::{import, moves, report, sample, trace};
use crate::support::{run_args as hydrotrace, said, timed};

#[test]
fn a_header_says_lengths_plans_and_measurements_in_many_ways() {
    // Header, arguments, and what became of the columns: joint, unit, and the length of the planned stroke.
    for (header, scale, args, joint, unit) in [
        ("t_s,boom_set_mm,boom_act_mm", 1000.0, &[][..], "boom", "mm"),
        ("t_s,boom_set_cm,boom_act_cm", 100.0, &[], "boom", "cm"),
        ("t_s,boom_set_m,boom_act_m", 1.0, &[], "boom", "m"),
        ("t_s,boom set [mm],boom act [mm]", 1000.0, &[], "boom", "mm"),
        ("t_s,boom set,boom act", 1000.0, &["--slides", "BOOM=mm"], "boom", "mm"),
        ("t_s,J1_planned_rad,J1_actual_rad", 1.0, &[], "J1", "rad"),
        ("t_s,q_d_1,q_1", 1.0, &[], "joint_1", "rad"),
        ("t_s,Boom Sp,Boom Ms", 1.0, &[], "Boom", "rad"),
        (
            "t_s,a [bar],b [bar]",
            57.3,
            &["--planned", "B=a [bar]", "--measured", "B=b [bar]", "--degrees"],
            "B",
            "deg",
        ),
        ("t_s,q_set_1,q_act_1,remark,operator", 1.0, &[], "joint_1", "rad"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a.csv"), trace(header, 1.0, ",", scale)).unwrap();
        let import = [&["import", "a.csv", "-o", "a.mcap", "--json"], args].concat();
        let (code, text, error) = said(&hydrotrace(folder.path(), &import));
        assert!(code == 0 || code == 3, "{header}: {error}");
        let read: Value = serde_json::from_str(&text).unwrap();
        crate::support::hold_to_schema(&read, "import.v1");
        let columns = read["understood"]["columns"].as_array().unwrap();
        let found: Vec<_> =
            columns.iter().map(|c| (c["becomes"].as_str().unwrap(), c["joint"].as_str().unwrap())).collect();
        assert_eq!(found, [("planned position", joint), ("measured position", joint)], "{header}");
        assert!(columns.iter().all(|column| column["unit"] == unit), "{header}: {columns:?}");
        let found = report(folder.path(), "a.mcap");
        let of_joint = &found["joints"][0];
        assert_eq!(of_joint["unit"], if unit.ends_with('m') { "m" } else { "rad" }, "{header}");
        // The measurement is 0.1 s late at up to 0.26 a second.
        let peak = of_joint["tracking_error"]["peak"].as_f64().unwrap();
        assert!((peak - 0.026).abs() < 0.001, "{header}: {peak}");
    }
}

#[test]
fn a_plan_may_be_a_sum_and_a_map_keeps_how_a_file_was_read() {
    let text = timed("t_s,boom_measured_rad,boom_error,raw", (500, 0.02), |t_s| {
        let [planned, measured] = moves(t_s);
        format!("{t_s},{measured},{},{}", planned - measured, 1000.0 * planned + 12.0)
    });
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.csv"), &text).unwrap();
    let peak = || report(folder.path(), "a.mcap")["joints"][0]["tracking_error"]["peak"].as_f64().unwrap();
    let import = |args: &[&str]| {
        let all = [&["import", "a.csv", "-o", "a.mcap", "--force"], args].concat();
        said(&hydrotrace(folder.path(), &all))
    };
    for plan in
        ["boom=measured+error", "boom=boom_measured_rad+#3", "boom=0.001*raw-0.012", "boom=raw/1000 - 0.012"]
    {
        let (code, _, error) = import(&["--planned", plan, "--radians", "--save-map", "arm.toml"]);
        assert_eq!(code, 0, "{plan}: {error}");
        let said = peak();
        assert!((said - 0.026).abs() < 0.001, "{plan}: {said}");
        let (code, _, error) = import(&["--map", "arm.toml"]);
        assert_eq!((code, peak()), (0, said), "{plan}: {error}");
    }
    let (code, _, error) = import(&["--planned", "boom=measured+nothing"]);
    assert!(code == 1 && error.contains("nothing"), "{code} {error}");
    let (code, _, error) = import(&["--slides", "stick=mm"]);
    assert!(code == 1 && error.contains("--slides names the joint \"stick\""), "{code} {error}");
    let valve = |column: &str| import(&["--planned", "boom=measured+error", "--interface", column]);
    let (code, _, error) = valve("valve_command:BOOM=0.001*raw");
    assert_eq!(code, 0, "{error}");
    let (code, out, error) = valve("valve_command:BOOM=raw");
    assert!(code == 3 && out.contains("reach farther than their full travel"), "{out}{error}");
}

#[test]
fn signals_to_valves_in_percent_are_shares() {
    let text = timed("t_s,boom_set_rad,boom_act_rad,boom_valve_%", (200, 0.05), |t_s| {
        let [planned, measured] = moves(t_s);
        format!("{t_s},{planned},{measured},{}", 80.0 * t_s.sin())
    });
    let (code, out, error) = import(&text, &["--interface", "valve_command:boom=boom_valve_%", "--json"]);
    assert!(code == 0 && out.contains("percent, by its header"), "{code} {out}{error}");
}

#[test]
fn a_signal_to_a_valve_that_is_called_a_command_is_no_position() {
    // What is sent opens the valve about its middle of 7.5, and the joint moves at 4 deg/s for each of it, 0.2 s late.
    let duty = |t_s: f64| 7.5 + (0.9 * t_s).sin() - 1.4 * (0.31 * t_s).cos() * (0.05 * t_s).sin();
    let mut boom_deg = 20.0;
    let text = timed("Time,Boom Ms,Boom Cmd,Boom Error", (1200, 0.05), |t_s| {
        boom_deg += 0.05 * 4.0 * (duty(t_s - 0.2) - 7.5);
        format!("{t_s},{boom_deg},{},{}", duty(t_s), 0.2 * (t_s).sin())
    });
    let (code, out, error) = import(&text, &["--degrees"]);
    assert!(code == 3 && out.contains("valve_command      Boom"), "{out}{error}");
    assert!(out.contains("taken as signals to the valves") && !out.contains("plan-is-command"), "{out}");
    assert!(out.contains("say --planned Boom=measured+error"), "{out}");
    let (code, out, _) = import(&text, &["--degrees", "--planned", "Boom=measured+error"]);
    assert!(code == 3 && out.contains("valve_command") && !out.contains("one-side"), "{out}");
    let (code, out, _) = import(&text, &["--degrees", "--command", "Boom=Boom Cmd"]);
    assert!(code == 3 && out.contains("command position"), "{out}");
}

#[test]
fn a_unit_that_is_not_known_is_told_and_a_factor_says_what_it_is() {
    let turns = trace("t_s,boom_set [E],boom_act [E]", 1.0, ",", 1.0 / std::f64::consts::TAU);
    let (code, out, error) = import(&turns, &[]);
    assert!(code == 3 && out.contains("no unit that is known (\"E\" is none)"), "{out}{error}");
    let factor = ["--planned", "boom=360*boom_set [E]", "--measured", "boom=360*boom_act [E]", "--degrees"];
    let (code, out, error) = import(&turns, &factor);
    assert_eq!(code, 0, "{out}{error}");
    let far = trace("t_s,boom_set [E],boom_act [E]", 1.0, ",", 60.0);
    let (code, _, error) = import(far, &[]);
    assert!(code == 1 && error.contains("(\"E\" is none)") && error.contains("FACTOR*COLUMN"), "{error}");
}

#[test]
fn a_ragged_first_row_is_counted_and_the_header_kept() {
    let text = trace("t_s,q_set_1,q_act_1", 1.0, ",", 1.0).replacen('\n', "\n0\n", 1);
    let (code, out, error) = import(text, &["--radians"]);
    assert_eq!(code, 3, "{error}");
    assert!(out.contains("between the header and the first row"), "{out}");
}

#[test]
fn a_table_is_reported_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.csv"), trace("t_s,boom_set_mm,boom_act_mm", 1.0, ",", 1000.0)).unwrap();
    let found = report(folder.path(), "a.csv");
    assert_eq!((&found["joints"][0]["name"], &found["joints"][0]["unit"]), (&"boom".into(), &"m".into()));
    assert_eq!(found["logs"][0]["name"], "a.csv");
    let log = sample("gaps.mcap");
    hydrotrace(folder.path(), &["export", &log, "--parquet", "-o", "a.parquet"]);
    let (before, after) = (report(folder.path(), &log), report(folder.path(), "a.parquet"));
    for part in ["joints", "transitions", "stops", "whole_run"] {
        assert_eq!(before[part], after[part], "{part}");
    }
    fs::write(folder.path().join("b.csv"), "t,boom_act_rad\n0,1\n1,2\n2,2\n3,2\n").unwrap();
    let (code, _, error) = said(&hydrotrace(folder.path(), &["report", "b.csv"]));
    assert!(
        code == 1 && error.contains("hydrotrace import b.csv --planned boom=COLUMN -o b.mcap"),
        "{code} {error}"
    );
}

/// Rows at 50 Hz of a time, an angle in degrees and a length in mm that are late by a time, s.
fn late(header: &str, late_s: f64) -> String {
    timed(header, (600, 0.02), |t_s| {
        let moved = 1.0 - ((t_s - late_s - 2.0).clamp(0.0, 4.0) / 4.0 * std::f64::consts::PI).cos();
        format!("{t_s:.2},{:.4},{:.4}", 10.0 * moved, 200.0 * moved)
    })
}

#[test]
fn a_table_that_says_neither_side_is_the_plan_where_a_plan_is_asked_for_or_it_is_called_one() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let (bare, measured) = ("t_s,boom_deg,teleskop_mm", "t_s,boom_ist_deg,teleskop_ist_mm");
    for (file, header, late_s) in
        [("plan.csv", bare, 0.0), ("a.csv", bare, 0.0), ("run.csv", bare, 0.2), ("ist.csv", measured, 0.2)]
    {
        fs::write(at.join(file), late(header, late_s)).unwrap();
    }
    let (code, text, error) =
        said(&hydrotrace(at, &["join", "run.csv", "--plan", "a.csv", "--at", "0", "-o", "j.mcap"]));
    assert!(code == 0 && text.contains("plan  11.98 s of 2 joints"), "{text}{error}");
    let worst = |args: &[&str]| {
        let (code, text, error) = said(&hydrotrace(at, args));
        let line = text.lines().find(|line| line.starts_with("Worst start")).map(str::to_owned);
        (code, line.unwrap_or_else(|| panic!("{args:?} {text}{error}")), text)
    };
    let (code, joined, _) = worst(&["report", "j.mcap"]);
    assert!(code == 0 && joined.contains(" at 2.0") && joined.contains(" ms after its plan"), "{joined}");
    for measured in ["run.csv", "ist.csv"] {
        let (code, line, text) = worst(&["report", measured, "plan.csv"]);
        assert!(code == 3 && text.contains("taken as the plan because the file is called so"), "{text}");
        assert_eq!(line, joined);
    }
    let (code, _, error) = said(&hydrotrace(at, &["report", "run.csv", "a.csv"]));
    assert!(code == 1 && error.contains("found no planned joint angles"), "{error}");
}

/// What was sent stands in for the plan of each joint that has none, whatever others have.
#[test]
fn a_joint_that_has_a_command_alone_is_reported_beside_one_that_has_a_plan() {
    let head = "t_s,boom_cmd_rad,boom_pos_rad,swing_setpoint_rad,swing_actual_rad";
    let text = timed(head, (500, 0.02), |t_s| {
        let [p, m] = moves(t_s);
        format!("{t_s},{p},{m},{p},{m}")
    });
    let (code, out, error) = import(&text, &[]);
    assert!(code == 3 && error.is_empty(), "{code}: {error}");
    assert_eq!(became(&out, "boom_cmd_rad"), "planned position", "{out}");
    assert!(out.contains("plan-is-command x1") && out.contains("\"boom_cmd_rad\""), "{out}");
    // Where all have one, a command is one.
    let both = text.replace("boom_pos_rad,", "boom_pos_rad,boom_plan_rad,");
    let both = both.lines().enumerate().map(|(k, line)| {
        if k == 0 {
            return format!("{line}\n");
        }
        let cells: Vec<&str> = line.split(',').collect();
        format!("{},{},{},{},{},{}\n", cells[0], cells[1], cells[2], cells[1], cells[3], cells[4])
    });
    let (code, out, _) = import(both.collect::<String>(), &[]);
    assert!(code == 0 && became(&out, "boom_cmd_rad") == "command position", "{code}: {out}");
}

/// What a column became.
fn became(out: &str, column: &str) -> String {
    let row = out.lines().find(|line| line.split_whitespace().next() == Some(column)).unwrap_or_default();
    row.split_whitespace().skip(1).take(2).collect::<Vec<_>>().join(" ")
}

#[test]
fn a_list_in_a_cell_is_a_joint_for_each_number() {
    let text = timed("Time,joint_names,desired.positions,actual.positions", (500, 0.02), |t_s| {
        let [p, m] = moves(t_s);
        format!("{t_s},\"['elbow', 'wrist']\",\"({p}, 0.5)\",\"({m}, 0.5)\"")
    });
    let (code, out, error) = import(&text, &["--radians"]);
    assert!(code == 0 && error.is_empty(), "{code}: {out}{error}");
    assert_eq!(became(&out, "elbow.desired.positions"), "planned position", "{out}");
    assert_eq!(became(&out, "wrist.actual.positions"), "measured position", "{out}");
}

/// The log that an import writes is doubted as its table is, until an option settles it.
#[test]
fn what_an_import_guessed_is_said_of_its_log_too() {
    let text = trace("t_s,boom_set,boom_act", 1.0, ",", 1.0);
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.csv"), text).unwrap();
    let run = |args: &[&str]| said(&hydrotrace(folder.path(), args));
    assert_eq!(run(&["import", "a.csv", "-o", "a.mcap"]).0, 3);
    let (code, out, _) = run(&["report", "a.mcap"]);
    assert!(
        code == 3 && out.contains("taken as rad") && out.contains("when a.csv was imported"),
        "{code}: {out}"
    );
    let (code, out, _) = run(&["report", "a.csv"]);
    assert!(code == 3 && out.matches("taken as rad").count() == 1, "{code}: {out}");
    assert_eq!(run(&["import", "a.csv", "--radians", "-o", "a.mcap", "--force"]).0, 0);
    assert_eq!(run(&["report", "a.mcap"]).0, 0);
}
