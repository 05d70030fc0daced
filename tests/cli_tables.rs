//! CSV files in and out as a field engineer meets them: what was sent is no plan.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::{
    fmt::Write as _,
    fs,
    path::Path,
    process::{Command, Output},
};

fn hydrotrace(folder: &Path, words: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hydrotrace"))
        .current_dir(folder)
        .args(words.split_whitespace())
        .output()
        .unwrap()
}

/// Exit code, standard output and standard error.
fn said(run: &Output) -> (i32, String, String) {
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    (run.status.code().unwrap(), text(&run.stdout), text(&run.stderr))
}

/// Angles, deg, of a joint that is asked to move at 2 s and follows 0.1 s later.
fn moves(t_s: f64) -> [f64; 2] {
    let at = |t_s: f64| 15.0 * (1.0 - ((t_s - 2.0).clamp(0.0, 3.0) / 3.0 * std::f64::consts::PI).cos());
    [at(t_s), at(t_s - 0.1)]
}

/// Rows at 50 Hz: time, then what was asked and what came of it for each of two joints.
fn trace(header: &str) -> String {
    let mut text = format!("{header}\n");
    for k in 0..500 {
        let t_s = f64::from(k) * 0.02;
        let [asked, came] = moves(t_s);
        writeln!(text, "{t_s:.2},{asked},{came},{},{}", -asked, -came).unwrap();
    }
    text
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
fn beside_a_plan_the_command_is_no_reason_for_a_remark() {
    let folder = folder("t,J1_ref,J1_act,J1_cmd,J2_act");
    let (code, text, _) =
        said(&hydrotrace(folder.path(), "import a.csv -o a.mcap --degrees --measured J1=J1_act"));
    assert_eq!(code, 0, "{text}");
    assert!(text.contains("planned position") && text.contains("command position"), "{text}");
    let (code, text, _) = said(&hydrotrace(folder.path(), "report a.mcap"));
    assert_eq!((code, text.contains("plan-is-command")), (0, false), "{text}");
    assert!(text.contains("planned   /planned/joint_states"), "{text}");
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
