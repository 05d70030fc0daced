//! CSV files in and out as a field engineer meets them: what was sent is no plan.

use std::{fs, path::Path};

use crate::support::{run_line as hydrotrace, said, timed};

/// Angles, deg, of a joint that is asked to move at 2 s and follows 0.1 s later.
fn moves(t_s: f64) -> [f64; 2] {
    let at = |t_s: f64| 15.0 * (1.0 - ((t_s - 2.0).clamp(0.0, 3.0) / 3.0 * std::f64::consts::PI).cos());
    [at(t_s), at(t_s - 0.1)]
}

/// Rows at 50 Hz: time, then what was asked and what came of it for each of two joints.
fn trace(header: &str) -> String {
    timed(header, (500, 0.02), |t_s| {
        let [asked, came] = moves(t_s);
        format!("{t_s:.2},{asked},{came},{},{}", -asked, -came)
    })
}

/// A folder with that table as `a.csv`.
fn folder(header: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.csv"), trace(header)).unwrap();
    folder
}

#[test]
fn what_was_sent_stays_what_was_sent_and_the_missing_plan_is_a_remark() {
    let option = " --degrees --command ax1=ax1_cmd,ax2=ax2_cmd";
    for (header, option) in [
        ("t,ax1_cmd,ax1_act,ax2_cmd,ax2_act", option),
        ("t,ax1_cmd,ax1_act,ax2_cmd,ax2_act", " --degrees"),
        ("t,ax1_target_cmd,ax1_act,ax2_target_cmd,ax2_act", " --degrees"),
        ("t,J1_command_deg,J1_measured_deg,J2_command_deg,J2_measured_deg", ""),
        ("t,a,ax1_act,b,ax2_act", " --degrees --command ax1=a,ax2=b"),
    ] {
        let folder = folder(header);
        let (code, text, _) = said(&hydrotrace(folder.path(), &format!("import a.csv -o a.mcap{option}")));
        assert_eq!(code, 3, "{header}: {text}");
        assert!(text.contains("command position") && !text.contains("planned position"), "{header}: {text}");
        assert!(text.contains("plan-is-command") && text.contains("join LOG --plan"), "{header}: {text}");
        let (code, text, _) = said(&hydrotrace(folder.path(), "report a.mcap"));
        assert_eq!(code, 3, "{header}: {text}");
        assert!(text.contains("plan-is-command") && text.contains("join LOG --plan"), "{header}: {text}");
        let (code, text, _) =
            said(&hydrotrace(folder.path(), "report a.mcap --planned /command/joint_states"));
        assert_eq!(code, 0, "{header}: {text}");
    }
}

#[test]
fn what_a_table_lacks_is_told_in_its_columns_and_by_the_line_that_names_them() {
    let folder = folder("t,boom_act_deg,p1,arm_act_deg,p2");
    let folder = folder.path();
    hydrotrace(folder, "import a.csv -o a.mcap");
    let asks = "boom_act_deg of a.csv, whose columns p1, p2 were not used; name them with \
                hydrotrace import a.csv --planned arm=COLUMN,boom=COLUMN -o a";
    for line in ["report a.csv", "report a.mcap", "fit a.csv", "replan a.mcap -o next.mcap"] {
        let (code, _, text) = said(&hydrotrace(folder, line));
        assert!(code == 1 && text.contains(asks) && !text.contains("joint_states"), "{line}: {text}");
    }
    let columns = "--planned arm=p2,boom=p1";
    let (code, _, text) = said(&hydrotrace(folder, &format!("report a.csv {columns}")));
    let paste = format!("import a.csv {columns} -o a-2.mcap");
    assert!(code == 1 && text.contains(&paste), "{text}");
    hydrotrace(folder, &paste);
    assert!(said(&hydrotrace(folder, "report a-2.mcap")).1.contains("p1, p2 of a.csv"));
    // What was told once need not be told again.
    let told = "--time t --time-unit ms --separator comma --measured boom=boom_act_deg";
    hydrotrace(folder, &format!("import a.csv {told} -o told.mcap"));
    let (_, _, text) = said(&hydrotrace(folder, "report told.mcap"));
    assert!(text.contains(&format!("import a.csv {told} --planned boom=COLUMN -o a-3.mcap")), "{text}");
    // From another folder, too.
    fs::create_dir(folder.join("sub")).unwrap();
    fs::rename(folder.join("a.csv"), folder.join("sub/a.csv")).unwrap();
    let (_, _, text) = said(&hydrotrace(folder, &format!("report sub/a.csv {columns}")));
    assert!(text.contains(&format!("hydrotrace import sub/a.csv {columns} -o a-3.mcap")), "{text}");
}

#[test]
fn a_table_of_a_command_alone_is_doubted_once_and_in_its_own_words() {
    let folder = folder("t,J1_command_deg,J1_measured_deg,J2_command_deg,J2_measured_deg");
    hydrotrace(folder.path(), "import a.csv -o a.mcap");
    for log in ["a.csv", "a.mcap"] {
        let (_, text, _) = said(&hydrotrace(folder.path(), &format!("report {log}")));
        assert_eq!(text.matches("plan-is-command").count(), 1, "{log}: {text}");
        let (_, doubts) = text.split_once("REMARKS").unwrap();
        assert!(doubts.contains("JOINT=COLUMN") && !doubts.contains("joint_states"), "{log}: {doubts}");
    }
}

#[test]
fn a_table_at_two_hertz_is_told_to_be_recorded_faster_and_no_line_leads_to_a_fit() {
    let folder = folder("t,J1_ref_deg,J1_act_deg,J2_ref_deg,J2_act_deg");
    let folder = folder.path();
    let text = fs::read_to_string(folder.join("a.csv")).unwrap();
    let mut lines = text.lines();
    let head = lines.next().unwrap().replacen('t', "time_s", 1);
    let slow: Vec<&str> = lines.step_by(25).collect();
    fs::write(folder.join("a.csv"), format!("{head}\n{}\n", slow.join("\n"))).unwrap();
    let (code, _, text) = said(&hydrotrace(folder, "fit a.csv"));
    let asks = "samples are 0.50 s apart";
    assert!(code == 1 && text.contains(asks) && text.contains("record at 5 Hz or more"), "{text}");
    assert!(!said(&hydrotrace(folder, "a.csv")).1.contains("hydrotrace fit"));
}

#[test]
fn joining_a_plan_to_a_table_without_one_leaves_no_doubt_of_that() {
    let folder = folder("t,J1_ref_deg,J1_act_deg,J2_ref_deg,J2_act_deg");
    let folder = folder.path();
    hydrotrace(folder, "import a.csv -o plan.mcap");
    let text = fs::read_to_string(folder.join("a.csv")).unwrap();
    let measured = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        [cells[0], cells[2], cells[4]].join(",")
    };
    let lines: Vec<String> = text.lines().map(measured).collect();
    fs::write(folder.join("b.csv"), lines.join("\n")).unwrap();
    let (code, text, error) = said(&hydrotrace(folder, "join b.csv --plan plan.mcap --at 0 -o after.mcap"));
    assert_eq!(code, 0, "{text}{error}");
}

#[test]
fn beside_a_plan_the_command_is_no_reason_for_a_remark() {
    let folder = folder("t,J1_ref,J1_act,J1_cmd,J2_act");
    let (code, text, _) =
        said(&hydrotrace(folder.path(), "import a.csv -o a.mcap --degrees --measured J1=J1_act"));
    assert_eq!(code, 0, "{text}");
    assert!(text.contains("planned position") && text.contains("command position"), "{text}");
    let (code, text, _) = said(&hydrotrace(folder.path(), "report a.mcap"));
    assert_eq!((code, text.contains("plan-is-command")), (0, false), "{text}");
    assert!(text.contains("planned   J1_ref of a.csv"), "{text}");
}

#[test]
fn an_explicit_option_prevails_over_what_a_header_says() {
    let folder = folder("t,ax1_cmd,ax1_act,ax2_cmd,ax2_act");
    let words = "import a.csv -o a.mcap --degrees --planned ax1=ax1_cmd,ax2=ax2_cmd";
    let (code, text, _) = said(&hydrotrace(folder.path(), words));
    assert_eq!(code, 0, "{text}");
    assert!(text.contains("planned position") && !text.contains("command position"), "{text}");
}

#[test]
fn a_table_that_goes_in_comes_out_with_the_command_as_command() {
    let folder = folder("t,J1_command_deg,J1_measured_deg,J2_command_deg,J2_measured_deg");
    let mut tables = Vec::new();
    for (from, log, to) in [("a.csv", "a.mcap", "b.csv"), ("b.csv", "b.mcap", "c.csv")] {
        hydrotrace(folder.path(), &format!("import {from} -o {log}"));
        let (code, _, error) =
            said(&hydrotrace(folder.path(), &format!("export {log} --csv --degrees -o {to}")));
        assert_eq!(code, 0, "{error}");
        tables.push(fs::read_to_string(folder.path().join(to)).unwrap());
    }
    assert!(
        tables[0].starts_with("stamp_ns,time_s,J1_measured_deg,J1_command_deg,"),
        "{}",
        &tables[0][..200]
    );
    assert!(!tables[0].contains("planned") && !tables[0].contains("error"));
    let numbers = |text: &str| -> Vec<f64> {
        text.lines()
            .skip(1)
            .flat_map(|row| row.split(',').skip(1).map(|cell| cell.parse().unwrap()))
            .collect()
    };
    let (first, second) = (numbers(&tables[0]), numbers(&tables[1]));
    assert_eq!(first.len(), 500 * 5);
    assert!(first.iter().zip(&second).all(|(a, b)| (a - b).abs() < 1e-9));
}

#[test]
fn a_log_of_plan_and_command_alone_is_a_table_too() {
    let folder = folder("t,J1_ref_deg,J1_cmd_deg,J2_ref_deg,J2_cmd_deg");
    hydrotrace(folder.path(), "import a.csv -o next.mcap");
    let (code, _, error) = said(&hydrotrace(folder.path(), "export next.mcap --csv --degrees -o next.csv"));
    assert_eq!(code, 0, "{error}");
    let text = fs::read_to_string(folder.path().join("next.csv")).unwrap();
    let head: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    assert_eq!(
        head[2..],
        ["J1_planned_deg", "J1_command_deg", "J2_planned_deg", "J2_command_deg"].map(String::from)
    );
    assert_eq!(text.lines().count(), 501);
}

#[test]
fn a_plan_in_a_file_of_its_own_fits_whatever_the_order_of_the_files() {
    let folder = folder("t,J1_ref_deg,x,J2_ref_deg,y");
    hydrotrace(folder.path(), "import a.csv -o plan.mcap");
    fs::write(folder.path().join("b.csv"), trace("t,x,J1_act_deg,y,J2_act_deg")).unwrap();
    let (code, text, _) = said(&hydrotrace(folder.path(), "import b.csv -o measured.mcap"));
    assert!(
        code == 3 && text.contains("report THIS.mcap OTHER.mcap") && text.contains("2025-10-09"),
        "{text}"
    );
    let runs = ["report measured.mcap plan.mcap --json", "report plan.mcap measured.mcap --json"]
        .map(|words| said(&hydrotrace(folder.path(), words)));
    assert_eq!(runs[0].0, 0, "{}", runs[0].2);
    assert_eq!(runs[0], runs[1]);
    let text = said(&hydrotrace(folder.path(), "report plan.mcap measured.mcap")).1;
    for line in ["planned   J1_ref_deg, J2_ref_deg of a.csv\n", "measured  J1_act_deg, J2_act_deg of b.csv\n"]
    {
        assert!(text.contains(line), "{text}");
    }
    let tables = said(&hydrotrace(folder.path(), "report a.csv b.csv"));
    assert!(tables.0 == 0 && !tables.1.contains("one-side"), "{}", tables.1);
    let (code, _, text) = said(&hydrotrace(folder.path(), "report b.csv"));
    assert!(code == 1 && text.contains("makes one log of both"), "{text}");
}

#[test]
fn files_that_tell_the_same_time_twice_are_refused_in_either_order() {
    let folder = folder("t,J1_ref_deg,J1_act_deg,J2_ref_deg,J2_act_deg");
    hydrotrace(folder.path(), "import a.csv -o run.mcap");
    fs::write(folder.path().join("b.csv"), trace("t,J1_ref_deg,x,J2_ref_deg,y")).unwrap();
    hydrotrace(folder.path(), "import b.csv -o plan.mcap");
    for words in ["report run.mcap plan.mcap", "report plan.mcap run.mcap", "report run.mcap run.mcap"] {
        let (code, text, error) = said(&hydrotrace(folder.path(), words));
        assert_eq!((code, text.as_str()), (1, ""), "{words}");
        assert!(
            error.contains("no parts of one run") && error.contains("hydrotrace join"),
            "{words}: {error}"
        );
    }
}

/// Codes of the remarks of a report that has some, and the planned onsets of its starts, s.
fn told(folder: &Path, log: &str) -> (Vec<String>, Vec<f64>) {
    let (code, text, error) = said(&hydrotrace(folder, &format!("report {log} --json")));
    assert_eq!(code, 3, "{log}: {error}");
    let report: serde_json::Value = serde_json::from_str(&text).unwrap();
    let all = |key: &str| report[key].as_array().unwrap().clone();
    let codes = all("remarks").iter().map(|one| one["code"].as_str().unwrap().to_owned()).collect();
    (codes, all("transitions").iter().map(|one| one["planned_onset_s"].as_f64().unwrap()).collect())
}

#[test]
fn a_clock_that_goes_back_splits_the_run_and_costs_no_row() {
    for back_s in [0.3, 0.7, 5.0] {
        let folder = tempfile::tempdir().unwrap();
        let text = timed("t [s],J1_ref_deg,J1_act_deg", (500, 0.02), |t_s| {
            let [asked, came] = moves(t_s % 5.0);
            let shown_s = if t_s < 5.0 { t_s + 1.0 } else { t_s + 1.0 - back_s };
            format!("{shown_s:.2},{asked},{came}")
        });
        fs::write(folder.path().join("a.csv"), text).unwrap();
        let (code, text, _) = said(&hydrotrace(folder.path(), "import a.csv -o a.mcap"));
        assert!(code == 3 && text.contains("clock-jump x1") && !text.contains("reordered"), "{text}");
        let (codes, starts) = told(folder.path(), "a.mcap");
        assert_eq!(codes, ["clock-jump", "clock-jump"], "{back_s}");
        assert_eq!(starts.len(), 2, "{back_s}");
        assert!((starts[1] - starts[0] - 5.0).abs() < 0.03, "{back_s}: {starts:?}");
    }
}

#[test]
fn a_clock_that_goes_back_splits_tables_of_other_forms_too() {
    let row = |k: u32| {
        let t_s = f64::from(k % 500) * 0.02;
        (t_s, moves(t_s).map(|q| if k < 500 { q } else { 0.8 * q }))
    };
    let table = |header: &str, line: &dyn Fn(f64, [f64; 2]) -> String| -> String {
        header.to_owned() + "\n" + &(0..1000).map(row).map(|(t_s, q)| line(t_s, q)).collect::<String>()
    };
    let long = table("t,signal,value", &|t, [asked, came]| {
        format!("{t:.2},J1_set_deg,{asked}\n{t:.2},J1_act_deg,{came}\n")
    });
    let clocks = table("t_set_s,J1_set_deg,t_act_s,J1_act_deg", &|t, [asked, came]| {
        format!("{t:.2},{asked},{:.3},{came}\n", t + 0.003)
    });
    let lines = table("", &|t, [asked, came]| {
        format!("{{\"t\": {t:.2}, \"J1_set_deg\": {asked}, \"J1_act_deg\": {came}}}\n")
    });
    for (name, text) in
        [("long.csv", &long[..]), ("clocks.csv", &clocks), ("lines.jsonl", lines.trim_start())]
    {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(name), text).unwrap();
        let (codes, starts) = told(folder.path(), name);
        assert!(codes.iter().all(|code| code == "clock-jump"), "{name}: {codes:?}");
        assert!(starts.len() == 2 && (starts[1] - starts[0] - 10.0).abs() < 0.05, "{name}: {starts:?}");
    }
}

#[cfg(unix)]
#[test]
fn what_stands_below_another_header_is_told_by_lines_that_make_a_file_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let below = trace("t,ax1_set_deg,ax1_act_deg,ax3_set_deg,ax3_act_deg");
    let both = trace("t,ax1_set_deg,ax1_act_deg,ax2_set_deg,ax2_act_deg") + &below;
    fs::write(folder.path().join("a.csv"), both).unwrap();
    let (code, _, error) = said(&hydrotrace(folder.path(), "report a.csv"));
    assert!(code == 1 && error.contains("line 502 is a header"), "{error}");
    let lines: Vec<&str> = error.split('`').skip(1).step_by(2).collect();
    let [first, second] = lines[lines.len() - 2..] else { panic!("{error}") };
    for (line, joint) in [(first, "ax2"), (second, "ax3")] {
        let file = line.rsplit("> ").next().unwrap();
        let (code, text, error) =
            crate::support::pasted(folder.path(), &format!("{line} && hydrotrace report {file}"));
        assert!(code == 0 && text.contains(joint), "{line}: {text}{error}");
    }
}

#[test]
fn a_table_that_leaves_something_open_is_told_what_to_become() {
    let folder = folder("t,J1_ref_deg,J1_act_deg,J2_ref_deg,J2_act_deg");
    assert_eq!(said(&hydrotrace(folder.path(), "report a.csv")).0, 0);
    let text = fs::read_to_string(folder.path().join("a.csv")).unwrap().replace("_deg", "");
    fs::write(folder.path().join("a.csv"), &text).unwrap();
    fs::write(folder.path().join("trace.log"), &text).unwrap();
    for words in ["report a.csv", "info a.csv", "report trace.log", "compare a.csv a.csv"] {
        let (code, _, error) = said(&hydrotrace(folder.path(), words));
        assert_eq!(code, 1, "{words}");
        assert!(
            error.contains("leaves something open") && error.contains("`hydrotrace import "),
            "{words}: {error}"
        );
        assert!(!error.contains("4D 43"), "{words}: {error}");
    }
}

#[test]
fn plan_and_measurement_in_a_table_each_are_told_the_line_that_makes_one_the_plan() {
    let folder = tempfile::tempdir().unwrap();
    for (file, side) in [("came.csv", 1), ("asked.csv", 0)] {
        let row = |k: i32| format!("{:.2},{}\n", f64::from(k) * 0.02, moves(f64::from(k) * 0.02)[side]);
        fs::write(
            folder.path().join(file),
            format!("t,position_deg\n{}", (0..500).map(row).collect::<String>()),
        )
        .unwrap();
    }
    let (code, _, error) = said(&hydrotrace(folder.path(), "report came.csv asked.csv"));
    let line = error.split('`').find(|line| line.contains("import asked.csv")).unwrap_or_default();
    assert!(code == 1 && line.ends_with("--planned joint=COLUMN -o asked.mcap"), "{error}");
    hydrotrace(folder.path(), &line["hydrotrace ".len()..].replace("COLUMN", "position_deg"));
    let (code, text, error) = said(&hydrotrace(folder.path(), "report came.csv asked.mcap"));
    assert!(code == 0 && text.contains("position_deg of asked.csv"), "{text}{error}");
}

#[test]
fn a_unit_that_an_option_spoils_is_told_by_that_option() {
    let folder = folder("t,J1_ref_deg,J1_act_deg,J2_ref_deg,J2_act_deg");
    hydrotrace(folder.path(), "import a.csv -o a.mcap");
    for (option, hint) in [
        ("--planned-degrees", "--planned-degrees does that to a plan in radians: drop it"),
        ("--measured-degrees", "--measured-degrees does that to a measurement in radians: drop it"),
    ] {
        let (code, _, error) = said(&hydrotrace(folder.path(), &format!("report a.mcap {option}")));
        assert!(code == 1 && error.contains("a second time: it was read in deg"), "{option}: {error}");
        let recorded = crate::support::sample("panel-install.mcap").display().to_string();
        let (code, text, _) = said(&hydrotrace(folder.path(), &format!("report {recorded} {option}")));
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(code == 3 && text.contains(hint), "{option}: {text}");
    }
}

#[test]
fn one_run_on_both_sides_of_a_comparison_is_a_remark() {
    let folder = folder("t,J1_ref_deg,J1_act_deg,J2_ref_deg,J2_act_deg");
    hydrotrace(folder.path(), "import a.csv -o a.mcap");
    fs::copy(folder.path().join("a.mcap"), folder.path().join("b.mcap")).unwrap();
    for words in ["compare a.mcap a.mcap", "compare a.mcap ./a.mcap", "compare a.mcap b.mcap"] {
        let (code, text, _) = said(&hydrotrace(folder.path(), words));
        assert!(code == 3 && text.contains("same-run"), "{words}: {text}");
    }
}

#[test]
fn a_negative_limit_is_refused_in_its_own_words() {
    for (words, expected) in [
        ("report a.mcap --max-rms-deg -1", "is not a non-negative"),
        ("compare a.mcap b.mcap --max-p -1", "is not a probability from 0 to 1"),
    ] {
        let (code, _, error) = said(&hydrotrace(Path::new("."), words));
        assert!(code == 2 && error.contains(expected), "{words}: {error}");
    }
}
