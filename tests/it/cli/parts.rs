//! Files that are one run together: parts of a recording, plan and measurement in a file each.

use std::{fmt::Write as _, fs};

use crate::support::{clean, hold_to_schema, json, run_line, said, scratch};

/// Degrees of a plan that moves twice, rests between, and ends elsewhere.
fn plan_deg(t_s: f64) -> f64 {
    let moves = |from_s: f64, by_deg: f64| {
        let x = ((t_s - from_s) / 3.0).clamp(0.0, 1.0);
        by_deg * x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)
    };
    10.0 + moves(2.0, 30.0) + moves(9.0, 15.0)
}

/// Rows of these instants, with the columns that are wanted; the joint is 0.2 s late.
fn table(rows: std::ops::Range<usize>, columns: &[&str]) -> String {
    let mut table = format!("time_s,{}", columns.join(","));
    for k in rows {
        let t_s = k as f64 * 0.02;
        write!(table, "\n{:.2}", 1_772_000_000.0 + t_s).unwrap();
        for column in columns {
            let at_s = if column.contains("act") { t_s - 0.2 } else { t_s };
            write!(table, ",{:.5}", plan_deg(at_s)).unwrap();
        }
    }
    table + "\n"
}

#[test]
fn the_parts_of_a_run_become_one_log_and_no_command_is_made_of_a_part() {
    let folder = scratch();
    let at = folder.path();
    let both = ["boom_set_deg", "boom_act_deg"];
    for (name, rows) in [("run", 0..350), ("run-2", 350..800), ("cut", 0..520), ("cut-2", 520..800)] {
        fs::write(at.join("part.csv"), table(rows, &both)).unwrap();
        clean(at, &format!("import part.csv -o {name}.mcap"));
    }
    let gathered = clean(at, "join run.mcap run-2.mcap -o whole.mcap --json");
    hold_to_schema(&serde_json::from_str(&gathered).unwrap(), "gathered.v1");
    // In whatever order a shell names them.
    clean(at, "join run-2.mcap run.mcap -o turned.mcap");
    assert!(fs::read(at.join("turned.mcap")).unwrap() == fs::read(at.join("whole.mcap")).unwrap());
    let starts = |line: &str| json(at, line)["transitions"].as_array().unwrap().len();
    assert_eq!((starts("report run.mcap run-2.mcap"), starts("report whole.mcap")), (2, 2));
    // Cut in motion they are no runs; cut at rest they may be.
    let (code, _, why) = said(&run_line(at, "replan cut.mcap cut-2.mcap --keep-plan -o next.mcap"));
    assert!(code == 1 && why.contains("`hydrotrace join` makes one of parts"), "{why}");
    assert!(!at.join("next.mcap").exists());
    let rested = json(at, "replan run.mcap run-2.mcap --keep-plan -o next.mcap");
    let remarks = rested["remarks"].to_string();
    assert!(remarks.contains("`hydrotrace join run.mcap run-2.mcap -o whole.mcap`"), "{remarks}");
    let (code, _, why) = said(&run_line(at, "join run.mcap run-2.mcap --from 3 -o cut-3.mcap"));
    assert!(code == 2 && why.contains("--from"), "{why}");
    // A folder is read in the order of its parts.
    fs::create_dir(at.join("parts")).unwrap();
    for name in ["run.mcap", "run-2.mcap"] {
        fs::copy(at.join(name), at.join("parts").join(name)).unwrap();
    }
    let (code, _, why) = said(&run_line(at, "join parts -o parts/whole.mcap"));
    assert!(code == 1 && why.contains("write it elsewhere"), "{why}");
    let found = json(at, "report parts");
    assert_eq!(found["remarks"].as_array().unwrap().len(), 0, "{}", found["remarks"]);
    assert!(found["transitions"][0]["planned_onset_s"].as_f64().unwrap() < 12.0);
}

#[test]
fn a_plan_and_a_measurement_in_two_files_become_one_log_by_the_printed_lines() {
    let folder = scratch();
    let at = folder.path();
    fs::create_dir(at.join("a b")).unwrap();
    fs::write(at.join("a b/plan.csv"), table(0..800, &["boom_set_deg"])).unwrap();
    fs::write(at.join("a b/seen.csv"), table(0..800, &["boom_act_deg"])).unwrap();
    let args = |line: &str| crate::support::pasted(at, line);
    let (_, answer, _) = args("hydrotrace 'a b/plan.csv' 'a b/seen.csv'");
    let lines: Vec<&str> = answer.lines().filter_map(|line| line.strip_prefix("  hydrotrace ")).collect();
    assert!(lines.len() == 2 && lines[0].starts_with("join "), "{answer}");
    for line in lines {
        let (code, _, why) = args(&format!("hydrotrace {line}"));
        assert!(matches!(code, 0 | 3), "{line}: {why}");
    }
    let (code, _, why) = args("hydrotrace fit 'a b/seen.csv' -o alone.toml");
    assert!(code == 1 && why.contains("`hydrotrace join 'a b/seen.csv' OTHER -o whole.mcap`"), "{why}");
}

#[test]
fn a_plan_and_a_measurement_of_two_clocks_are_not_joined_as_they_are() {
    let folder = scratch();
    let at = folder.path();
    for (name, rows, column) in [("plan", 0..800, "boom_set_deg"), ("seen", 0..800, "boom_act_deg")] {
        let text = table(rows, &[column]);
        let text = if name == "seen" { text.replace("\n17720", "\n17721") } else { text };
        fs::write(at.join("part.csv"), text).unwrap();
        run_line(at, &format!("import part.csv -o {name}.mcap"));
    }
    let (code, _, why) = said(&run_line(at, "join plan.mcap seen.mcap -o whole.mcap"));
    assert!(code == 1 && why.contains("--plan PLAN --at SECONDS -o whole.mcap`"), "{code} {why}");
    assert!(!at.join("whole.mcap").exists());
    let (code, _, why) = said(&run_line(at, "join seen.mcap --plan plan.mcap --at 0 -o whole.mcap"));
    assert!(code == 0 || code == 3, "{code} {why}");
    assert_eq!(json(at, "report whole.mcap")["transitions"].as_array().unwrap().len(), 2);
}
