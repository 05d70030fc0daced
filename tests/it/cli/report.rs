//! The built binary as an operator meets it: exit codes, streams, files.

use std::{fs, path::Path, process::Stdio};

use crate::support::{command, hold_to_schema, root, run_at_root as hydrotrace, run_line, stderr, stdout};

const CLEAN: &str = "sample-logs/panel-install.mcap";
const DOUBTFUL: &str = "sample-logs/gaps.mcap";
const CUT: &str = "sample-logs/power-loss.mcap";

#[test]
fn exit_code_0_and_a_quiet_standard_error_for_a_sound_log() {
    let run = hydrotrace(&["report", CLEAN]);
    assert_eq!((run.status.code(), stderr(&run).as_str()), (Some(0), ""));
    assert!(stdout(&run).contains("TRANSITIONS, WORST FIRST"));
}

#[test]
fn a_known_delay_of_the_measurement_is_taken_off_and_said() {
    let median_delay_s = |options: &[&str]| {
        let run = hydrotrace(&[&["report", CLEAN, "--json"], options].concat());
        let document: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
        let source = document["source"]["measured_delay_s"].as_f64();
        let starts = document["transitions"].as_array().unwrap().iter();
        let mut delays_s: Vec<f64> = starts.filter_map(|start| start["onset_delay_s"].as_f64()).collect();
        delays_s.sort_by(f64::total_cmp);
        (delays_s[delays_s.len() / 2], source)
    };
    let ((as_stamped_s, none), (as_taken_s, given)) =
        (median_delay_s(&[]), median_delay_s(&["--measured-delay-ms", "80"]));
    assert!((as_stamped_s - as_taken_s - 0.08).abs() < 0.005, "{as_stamped_s} {as_taken_s}");
    assert_eq!((none, given), (None, Some(0.08)));
    let said = stdout(&hydrotrace(&["report", CLEAN, "--measured-delay-ms", "-20"]));
    assert!(said.contains("-20 ms taken off those of the measurement, as given"), "{said}");
    assert_eq!(hydrotrace(&["report", CLEAN, "--measured-delay-ms", "1e9"]).status.code(), Some(2));
}

#[test]
fn exit_code_1_when_the_log_is_missing_and_stdout_stays_empty() {
    let run = hydrotrace(&["report", "no-such.mcap"]);
    assert_eq!(run.status.code(), Some(1));
    assert!(run.stdout.is_empty());
    let said = stderr(&run);
    assert!(said.starts_with("error: cannot open no-such.mcap\n  because: "), "{said}");
    let page = stderr(&hydrotrace(&["report", CLEAN, "--html", "my page.html"]));
    assert!(
        page.starts_with("error: cannot open my page.html; to write it, say -o 'my page.html'\n"),
        "{page}"
    );
}

#[test]
fn exit_code_1_names_what_a_file_is_when_it_is_no_log() {
    let run = hydrotrace(&["report", "Cargo.toml"]);
    assert_eq!(run.status.code(), Some(1));
    let said = stderr(&run);
    assert!(said.contains("not an MCAP file") && said.contains("expected the bytes 89 4D"), "{said}");
}

#[test]
fn exit_code_1_suggests_the_topic_that_was_meant() {
    let run = hydrotrace(&["report", CLEAN, "--measured", "/joint_state"]);
    assert_eq!(run.status.code(), Some(1));
    assert!(stderr(&run).contains("did you mean \"/joint_states\"?"), "{}", stderr(&run));
}

#[test]
fn exit_code_2_when_an_angle_is_not_a_number() {
    let run = hydrotrace(&["report", CLEAN, "--max-rms-deg", "lots"]);
    assert_eq!(run.status.code(), Some(2));
    assert_eq!(hydrotrace(&["report"]).status.code(), Some(2));
    assert_eq!(hydrotrace(&["report", CLEAN, "--json", "--csv"]).status.code(), Some(2));
}

#[test]
fn exit_code_3_shows_the_remarks_in_every_format() {
    for format in [&[][..], &["--json"], &["--csv"], &["--markdown"]] {
        let run = hydrotrace(&[&["report", DOUBTFUL], format].concat());
        assert_eq!(run.status.code(), Some(3), "{format:?}");
        let text = stdout(&run).replace('\\', "");
        for code in ["not-finite", "duplicate-stamp", "gap"] {
            assert!(text.contains(code), "{format:?} lacks {code}");
        }
    }
}

#[test]
fn exit_code_4_names_joint_time_and_amount() {
    let run = hydrotrace(&["report", CLEAN, "--max-transition-peak-deg", "0.9"]);
    assert_eq!(run.status.code(), Some(4));
    let said = stderr(&run);
    assert!(said.starts_with("gate: ") && said.contains("joint_3 at 4."), "{said}");
    assert!(said.contains("0.900 deg allowed"), "{said}");
    let kept = hydrotrace(&["report", CLEAN, "--max-transition-peak-deg", "1.2"]);
    assert_eq!(kept.status.code(), Some(0));
}

#[test]
fn equal_calls_give_equal_bytes() {
    for args in [&["report", DOUBTFUL, "--json"][..], &["info", CUT, "--json"]] {
        assert_eq!(hydrotrace(args).stdout, hydrotrace(args).stdout);
    }
}

#[test]
fn a_file_given_with_o_holds_what_standard_output_would() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("report.json");
    let run = hydrotrace(&["report", CLEAN, "--json", "-o", file.to_str().unwrap()]);
    assert_eq!((run.status.code(), run.stdout.len()), (Some(0), 0));
    assert_eq!(fs::read(&file).unwrap(), hydrotrace(&["report", CLEAN, "--json"]).stdout);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn an_output_that_cannot_be_written_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("missing").join("report.json");
    let run = hydrotrace(&["report", CLEAN, "--json", "-o", file.to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(1));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_reader_that_goes_away_is_success() {
    let mut run = command(root())
        .args(["report", CLEAN, "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(run.stdout.take());
    let status = run.wait_with_output().unwrap();
    assert_eq!((status.status.code(), stderr(&status).as_str()), (Some(0), ""));
}

#[test]
fn a_cut_log_is_recovered_with_what_the_cut_chunk_still_holds() {
    let folder = tempfile::tempdir().unwrap();
    let saved = folder.path().join("saved.mcap");
    let saved = saved.to_str().unwrap();
    let run = hydrotrace(&["recover", CUT, "-o", saved]);
    assert_eq!(run.status.code(), Some(3), "{}", stderr(&run));
    assert!(stdout(&run).contains("partial-chunk"));
    let joints = |log: &str| -> serde_json::Value {
        let report: serde_json::Value =
            serde_json::from_slice(&hydrotrace(&["report", log, "--json"]).stdout).unwrap();
        report["joints"].clone()
    };
    assert_eq!(joints(saved), joints(CUT));
    let whole = hydrotrace(&["report", saved]);
    // Nothing is doubtful but where the plan ends.
    let remarks: Vec<String> =
        stdout(&whole).lines().filter(|line| line.starts_with("unmatched")).map(str::to_owned).collect();
    assert_eq!(whole.status.code(), Some(3), "{}", stdout(&whole));
    assert!(remarks.len() == 1 && remarks[0].contains("cut off in motion"), "{remarks:?}");
    let again = hydrotrace(&["recover", saved, "-o", folder.path().join("again.mcap").to_str().unwrap()]);
    assert_eq!(again.status.code(), Some(0));
}

#[test]
fn parts_and_bags_are_recovered_into_one_log_and_nothing_is_no_log() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    std::fs::create_dir(at("bag")).unwrap();
    std::fs::copy(CUT, at("bag/run_0.mcap")).unwrap();
    // The next part had no byte on the disk yet.
    std::fs::write(at("bag/run_1.mcap"), "").unwrap();
    for logs in [vec![at("bag")], vec![at("bag/run_1.mcap"), at("bag/run_0.mcap")]] {
        let logs: Vec<&str> = logs.iter().map(String::as_str).collect();
        let run = hydrotrace(&[&["recover", "-o", &at("saved.mcap")], &logs[..]].concat());
        let out = stdout(&run);
        assert_eq!(run.status.code(), Some(3), "{}", stderr(&run));
        assert!(out.starts_with("6948 messages") && out.contains("run_1.mcap is empty"), "{out}");
        std::fs::remove_file(at("saved.mcap")).unwrap();
    }
    let whole = std::fs::read(CUT).unwrap();
    std::fs::write(at("stub.mcap"), &whole[..300]).unwrap();
    let run = hydrotrace(&["recover", &at("stub.mcap"), "-o", &at("saved.mcap")]);
    assert_eq!(run.status.code(), Some(1), "{}", stdout(&run));
    assert!(stderr(&run).contains("nothing is left to save"), "{}", stderr(&run));
    assert!(!std::path::Path::new(&at("saved.mcap")).exists());
}

#[test]
fn info_says_what_a_report_would_use_even_where_none_can_be_made() {
    let run = hydrotrace(&["info", CLEAN]);
    assert_eq!(run.status.code(), Some(0));
    assert!(stdout(&run).contains("/planned/joint_states:position"));
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("measured-only.mcap");
    write_measured_only(&log);
    let run = hydrotrace(&["info", log.to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(0));
    assert!(stdout(&run).contains("nothing: found no planned joint angles"), "{}", stdout(&run));
    let run = hydrotrace(&["report", log.to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(1));
    assert!(stderr(&run).contains("--planned TOPIC[:FIELD]"));
}

fn write_measured_only(path: &Path) {
    use hydrotrace::log::{LogWriter, Role, WriteOptions};
    let mut log = LogWriter::create(path, &["a"], WriteOptions::default()).unwrap();
    for k in 0..100_i64 {
        log.joint_sample(Role::Measured, 1_000_000_000 + k * 10_000_000, &[0.1], &[], &[]).unwrap();
    }
    log.finish().unwrap();
}

#[test]
fn reports_are_as_their_schema_says() {
    for log in [CLEAN, DOUBTFUL, CUT] {
        let run =
            hydrotrace(&["report", log, "--json", "--max-rms-deg", "90", "--max-start-delay-ms", "900"]);
        let report: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
        hold_to_schema(&report, "report.v2");
        assert_eq!(report["format"], "hydrotrace.report.v2");
    }
}

#[test]
fn a_report_never_replaces_the_log_it_reads() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("run.mcap");
    fs::copy(root().join(CLEAN), &log).unwrap();
    let before = fs::read(&log).unwrap();
    let name = log.to_str().unwrap();
    for args in [&["report", name, "-o", name][..], &["recover", name, "-o", name]] {
        let run = hydrotrace(args);
        assert_eq!(run.status.code(), Some(1), "{}", stderr(&run));
        assert!(stderr(&run).contains("is an input"));
    }
    assert_eq!(fs::read(&log).unwrap(), before);
}

#[test]
fn a_field_is_not_compared_with_itself() {
    let same = ["report", CLEAN, "--planned", "/joint_states", "--measured", "/joint_states"];
    let run = hydrotrace(&same);
    assert_eq!(run.status.code(), Some(1));
    assert!(stderr(&run).contains("given as plan and as measurement"), "{}", stderr(&run));
}

#[test]
fn a_joint_without_a_lag_in_range_does_not_keep_a_limit_on_lag() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("dead.mcap");
    write_joint_states(&log, |t_s| (0.3 * (t_s - 2.0).clamp(0.0, 2.0), 0.0), 0);
    let run = hydrotrace(&["report", log.to_str().unwrap(), "--max-lag-ms", "100"]);
    assert_eq!(run.status.code(), Some(4), "{}{}", stdout(&run), stderr(&run));
    let report = hydrotrace(&["report", log.to_str().unwrap(), "--json"]);
    let report: serde_json::Value = serde_json::from_slice(&report.stdout).unwrap();
    assert_eq!(report["joints"][0]["lag_s"], serde_json::Value::Null);
    assert_eq!(report["joints"][0]["moves"], false);
}

#[test]
fn a_plan_of_another_time_is_an_error_that_names_both() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("apart.mcap");
    write_joint_states(&log, |t_s| (t_s.sin(), t_s.sin()), 3_600_000_000_000);
    let run = hydrotrace(&["report", log.to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(1));
    assert!(stderr(&run).contains("they have no time in common"), "{}", stderr(&run));
}

/// Ten seconds of one joint at 100 Hz; the plan is stamped `later_ns` later than the measurement.
fn write_joint_states(path: &Path, angles_at: impl Fn(f64) -> (f64, f64), later_ns: i64) {
    use hydrotrace::log::{LogWriter, Role, WriteOptions};
    let mut log = LogWriter::create(path, &["a"], WriteOptions::default()).unwrap();
    for (role, shift_ns) in [(Role::Measured, 0), (Role::Planned, later_ns)] {
        for k in 0..1000_i64 {
            let (planned, measured) = angles_at(k as f64 * 0.01);
            let angle = if role == Role::Planned { planned } else { measured };
            log.joint_sample(role, 1_000_000_000 + k * 10_000_000 + shift_ns, &[angle], &[], &[]).unwrap();
        }
    }
    log.finish().unwrap();
}

#[test]
fn a_page_goes_to_a_file_or_a_pipe_and_tells_limits_apart() {
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("run.html");
    let run = hydrotrace(&["report", CLEAN, "--html", "-o", page.to_str().unwrap()]);
    assert_eq!((run.status.code(), stdout(&run).as_str()), (Some(0), ""));
    let text = fs::read_to_string(page).unwrap();
    assert!(text.starts_with("<!DOCTYPE html>") && !text.contains(">Verdict<"), "{}", &text[..200]);
    for told in ["class=\"lanes\"", "The worst start: ", "Why: ", "<pre><code>hydrotrace replan "] {
        assert!(text.contains(told), "{told}");
    }
    assert_eq!(text, stdout(&hydrotrace(&["report", CLEAN, "--html"])));
    let broken = hydrotrace(&["report", CLEAN, "--html", "--max-rms-deg", "0.2", "--max-peak-deg", "2"]);
    assert_eq!(broken.status.code(), Some(4));
    assert!(stdout(&broken).contains("1 of 2 limits NOT kept"));
    let doubtful = hydrotrace(&["report", DOUBTFUL, "--html"]);
    assert_eq!(doubtful.status.code(), Some(3));
    assert!(stdout(&doubtful).contains("id=\"remarks\"") && stderr(&doubtful).contains("remark: "));
}

#[test]
fn figures_are_written_beside_a_report_of_any_form() {
    let folder = tempfile::tempdir().unwrap();
    let figures = folder.path().join("new/figures");
    let run = hydrotrace(&["report", CLEAN, "--json", "--figures", figures.to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(0));
    assert!(stdout(&run).starts_with('{'));
    let mut names: Vec<String> =
        fs::read_dir(figures).unwrap().map(|f| f.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(names.len(), 9);
    assert_eq!((names[0].as_str(), names[8].as_str()), ("joint-01-joint_1.svg", "transitions-02.svg"));
}

#[test]
fn a_limit_with_nothing_to_judge_is_not_kept_unless_that_is_allowed() {
    let folder = tempfile::tempdir().unwrap();
    let still: String = (0..500).map(|k| format!("{},0.5,0.5\n", 0.01 * f64::from(k))).collect();
    for (name, rows) in [("still", still.as_str()), ("one", "0.0,0.5,0.5\n0.01,0.5,0.5\n")] {
        let table = format!("time_s,a_planned_rad,a_measured_rad\n{rows}");
        std::fs::write(folder.path().join(format!("{name}.csv")), table).unwrap();
        run_line(folder.path(), &format!("import {name}.csv -o {name}.mcap"));
        assert!(folder.path().join(format!("{name}.mcap")).exists());
        for limit in ["--max-transition-peak-deg 10", "--max-start-delay-ms 9000", "--max-rms-mm 10"] {
            let judged = |more: &str| run_line(folder.path(), &format!("report {name}.mcap {limit}{more}"));
            let run = judged("");
            assert_eq!(run.status.code(), Some(4), "{name} {limit}: {}", stdout(&run));
            assert!(stdout(&run).contains("NOT KEPT: nothing to judge"), "{name}: {}", stdout(&run));
            let run = judged(" --allow-empty");
            assert!(matches!(run.status.code(), Some(0 | 3)), "{name} {limit}: {}", stdout(&run));
            assert!(stdout(&run).contains("kept: nothing to judge"), "{name}: {}", stdout(&run));
        }
    }
}
