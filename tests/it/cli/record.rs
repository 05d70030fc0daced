//! `record`: lines as they come, at the built binary.

use std::{
    fs,
    io::Write,
    net::UdpSocket,
    path::Path,
    process::{Child, Command, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};

use serde_json::Value;

use super::csv::{moves, report, trace};
use crate::support::{command, run_args as hydrotrace, said, timed};

pub(super) fn start(folder: &Path, args: &[&str]) -> Child {
    let mut recorder = command(folder);
    recorder.args([&["record", "-o", "run.mcap"], args].concat());
    recorder.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Feeds a text and ends its input.
pub(super) fn recorded(folder: &Path, text: &str, args: &[&str]) -> (i32, String, String) {
    let mut recorder = start(folder, args);
    // A recorder that refuses its first lines hears no more.
    let _ = recorder.stdin.take().unwrap().write_all(text.as_bytes());
    said(&recorder.wait_with_output().unwrap())
}

/// Until a condition holds, 20 s at most.
fn until(what: &str, holds: impl Fn() -> bool) {
    let from = Instant::now();
    while !holds() {
        assert!(from.elapsed() < Duration::from_secs(20), "no {what} after 20 s");
        sleep(Duration::from_millis(20));
    }
}

#[test]
fn what_is_recorded_reports_as_the_same_table_imported() {
    let text = trace("t_s,boom_set_mm,boom_act_mm", 1.0, ",", 1000.0);
    let objects: String = text.lines().skip(1).fold(String::new(), |all, row| {
        let cells: Vec<&str> = row.split(',').collect();
        all + &format!(
            "{{\"t_s\": {}, \"boom\": {{\"set_mm\": {}, \"act_mm\": {}}}}}\n",
            cells[0], cells[1], cells[2]
        )
    });
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.csv"), &text).unwrap();
    let imported = report(folder.path(), "a.csv");
    for (form, lines) in [("CSV", &text), ("JSON", &objects)] {
        let (code, out, error) = recorded(folder.path(), lines, &["--force"]);
        assert_eq!((code, error.as_str()), (0, ""), "{form}: {out}");
        assert!(out.starts_with("500 rows of 50"), "{form}: {out}");
        let live = report(folder.path(), "run.mcap");
        for part in ["joints", "transitions", "stops", "whole_run", "alignment"] {
            assert_eq!(live[part], imported[part], "{part} of {form}");
        }
    }
    let (code, out, _) = recorded(folder.path(), &text, &["--force", "--report"]);
    assert!(code == 0 && out.contains("TRANSITIONS, WORST FIRST"), "{code}: {out}");
}

#[test]
fn a_sensor_that_sends_later_than_the_plan_is_recorded() {
    let lines = |from: u32| -> String {
        let line = |k: u32| {
            let t_s = f64::from(k) * 0.02;
            let [planned, measured] = moves(t_s).map(f64::to_degrees);
            let came = if k < from { String::new() } else { format!(", \"boom_act_deg\": {measured}") };
            format!("{{\"t_s\": {t_s}, \"boom_set_deg\": {planned}{came}}}\n")
        };
        (0..500).map(line).collect()
    };
    let folder = tempfile::tempdir().unwrap();
    let (code, out, error) = recorded(folder.path(), &lines(60), &[]);
    assert!(code == 0 && out.contains("boom_act_deg: measured position"), "{out}{error}");
    assert_eq!(report(folder.path(), "run.mcap")["joints"][0]["starts"], 1);
    // Later than is waited for: in a part of its own, or in the same if it is named.
    let (code, out, _) = recorded(folder.path(), &lines(400), &["--force"]);
    assert!(
        code == 3 && out.contains("run.mcap, run-2.mcap") && out.contains("keys of a joint that came"),
        "{out}"
    );
    assert!(out.starts_with("500 rows of 500 lines") && !out.contains("one-side"), "{out}");
    let late = report(folder.path(), "run-2.mcap");
    assert_eq!(late["alignment"][0]["matched"], 100, "{late}");
    // A key that is of no joint goes on without it.
    let events = lines(0).replace("\"t_s\": 8", "\"count\": 7, \"t_s\": 8");
    let (_, out, _) = recorded(folder.path(), &events, &["--force"]);
    assert!(
        out.starts_with("500 rows of 500 lines written to run.mcap:") && out.contains("keys that came"),
        "{out}"
    );
    let named = ["--force", "--planned", "boom=boom_set_deg", "--measured", "boom=boom_act_deg"];
    let (_, out, _) = recorded(folder.path(), &lines(400), &named);
    assert!(out.contains("boom_act_deg: measured position") && !out.contains("keys that came"), "{out}");
}

#[test]
fn a_recording_is_not_written_over_and_a_unit_not_guessed() {
    let text = trace("t_s,boom_set_mm,boom_act_mm", 1.0, ",", 1000.0);
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(recorded(folder.path(), &text, &[]).0, 0);
    let before = fs::read(folder.path().join("run.mcap")).unwrap();
    let (code, _, error) = recorded(folder.path(), &text, &[]);
    assert!(code == 1 && error.contains("--force"), "{code}: {error}");
    assert!(fs::read(folder.path().join("run.mcap")).unwrap() == before);
    let folder = tempfile::tempdir().unwrap();
    let (code, _, error) = recorded(folder.path(), &trace("t_s,J1_set,J1_act", 1.0, ",", 1.0), &[]);
    assert!(code == 1 && error.contains("--degrees"), "{code}: {error}");
    assert!(!folder.path().join("run.mcap").exists());
    let (code, _, error) = recorded(folder.path(), "", &[]);
    assert!(code == 1 && error.contains("no line came"), "{code}: {error}");
}

#[test]
fn a_recording_comes_in_parts() {
    let folder = tempfile::tempdir().unwrap();
    let text = timed("t_s,boom_set_mm,boom_act_mm", (4500, 0.02), |t_s| {
        let [planned, measured] = moves(t_s % 30.0).map(|q| q * 1000.0);
        format!("{t_s},{planned},{measured}")
    });
    let (code, out, _) = recorded(folder.path(), &text, &["--part-minutes", "1", "--json"]);
    let written: Value = serde_json::from_str(&out).unwrap();
    crate::support::hold_to_schema(&written, "record.v1");
    assert_eq!((code, &written["logs"]), (0, &serde_json::json!(["run.mcap", "run-2.mcap"])));
    // A part that is just full is the last one.
    let whole: String = text.lines().take(3001).flat_map(|line| [line, "\n"]).collect();
    let full = tempfile::tempdir().unwrap();
    let (_, out, error) = recorded(full.path(), &whole, &["--part-minutes", "1", "--json"]);
    let written: Value = serde_json::from_str(&out).expect(&error);
    assert_eq!(written["logs"], serde_json::json!(["run.mcap"]), "{written}");
    assert!(!full.path().join("run-2.mcap").exists());
    let both = said(&hydrotrace(folder.path(), &["report", "run.mcap", "run-2.mcap", "--json"])).1;
    let both: Value = serde_json::from_str(&both).unwrap();
    assert!((both["source"]["duration_s"].as_f64().unwrap() - 4499.0 * 0.02).abs() < 1e-6);
}

#[test]
#[cfg(unix)]
fn packets_are_recorded_until_an_interrupt_ends_the_log() {
    packets_are_recorded_until("-INT");
}

/// As where a session on another machine breaks off.
#[test]
#[cfg(target_os = "linux")]
fn a_terminal_that_is_closed_ends_the_log() {
    // Under `nohup` it ends nothing, and is not to.
    let status = fs::read_to_string("/proc/self/status").unwrap();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:")).unwrap().trim();
    if u64::from_str_radix(ignored, 16).unwrap() & 1 == 0 {
        packets_are_recorded_until("-HUP");
    }
}

#[cfg(unix)]
fn packets_are_recorded_until(signal: &str) {
    let folder = tempfile::tempdir().unwrap();
    let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let address = format!("127.0.0.1:{port}");
    let recorder = start(folder.path(), &["--udp", &address]);
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    socket.connect(&address).unwrap();
    let text = trace("t_s,boom_set_mm,boom_act_mm", 1.0, ",", 1000.0);
    let log = folder.path().join("run.mcap");
    // The header is sent until it is heard; a second one is a line without a time.
    let lines: Vec<&str> = text.lines().collect();
    until("recorder", || {
        let sent = socket.send(lines[0].as_bytes()).is_ok();
        sleep(Duration::from_millis(100));
        sent && socket.send(b"").is_ok()
    });
    for rows in lines[1..].chunks(5) {
        socket.send(rows.join("\n").as_bytes()).unwrap();
        sleep(Duration::from_millis(1));
    }
    until("log", || fs::metadata(&log).is_ok_and(|found| found.len() > 2000));
    let kill = Command::new("kill").args([signal, &recorder.id().to_string()]).status().unwrap();
    assert!(kill.success());
    let (code, out, error) = said(&recorder.wait_with_output().unwrap());
    assert!(code == 0 || code == 3, "{code} {out} {error}");
    let found = report(folder.path(), "run.mcap");
    assert_eq!(found["remarks"], Value::Array(Vec::new()), "closed properly");
    assert!(found["source"]["messages"].as_u64().unwrap() >= 490, "{}", found["source"]);
}

#[test]
fn a_kill_takes_a_second_at_most() {
    let folder = tempfile::tempdir().unwrap();
    let mut recorder = start(folder.path(), &[]);
    let text = trace("t_s,boom_set_mm,boom_act_mm", 1.0, ",", 1000.0);
    let mut input = recorder.stdin.take().unwrap();
    input.write_all(text.as_bytes()).unwrap();
    input.flush().unwrap();
    let log = folder.path().join("run.mcap");
    // Ten seconds of rows: nine of them are on the disk before its input ends.
    until("log", || {
        let read = || said(&hydrotrace(folder.path(), &["report", "run.mcap", "--json"])).1;
        let found: Option<Value> = log.exists().then(|| serde_json::from_str(&read()).ok()).flatten();
        found.is_some_and(|found| found["source"]["duration_s"].as_f64().unwrap() >= 8.9)
    });
    recorder.kill().unwrap();
    recorder.wait().unwrap();
    drop(input);
    let found = report(folder.path(), "run.mcap");
    assert!(found["source"]["duration_s"].as_f64().unwrap() >= 8.9);
}

#[test]
fn a_header_with_other_columns_begins_a_part_and_the_same_one_does_not() {
    let folder = tempfile::tempdir().unwrap();
    // Time, boom 1 and 2, arm 3 and 4, in deg.
    let head = "t_s,boom_set_deg,boom_act_deg,arm_set_deg,arm_act_deg";
    let rows = |from: u32, row: [f64; 4], more: &str| -> String {
        let [a, b, c, d] = row;
        (from..from + 300).map(|k| format!("{},{a},{b},{c},{d}{more}\n", f64::from(k) * 0.01)).collect()
    };
    let same = [1.0, 2.0, 3.0, 4.0];
    for (again, row, more, parts) in [
        (head, same, "", 1),
        ("t_s,arm_set_deg,arm_act_deg,boom_set_deg,boom_act_deg", [3.0, 4.0, 1.0, 2.0], "", 2),
        ("t_s,boom_set_rad,boom_act_rad,arm_set_rad,arm_act_rad", same.map(f64::to_radians), "", 2),
        ("t_s,boom_set_deg,boom_act_deg,arm_set_deg,arm_act_deg,note", same, ",on", 2),
    ] {
        let text = format!("{head}\n{}{again}\n{}", rows(0, same, ""), rows(300, row, more));
        let (code, out, error) = recorded(folder.path(), &text, &["--force"]);
        assert!(code == 3 && out.starts_with("600 rows of 602 lines"), "{again}: {code} {out}{error}");
        let logs: &[&str] = if parts == 1 { &["run.mcap"] } else { &["run.mcap", "run-2.mcap"] };
        assert!(out.contains(&format!("hydrotrace report {}\n", logs.join(" "))), "{out}");
        let out = said(&hydrotrace(folder.path(), &[&["report", "--json"], logs].concat())).1;
        let whole: Value = serde_json::from_str(&out).unwrap();
        for joint in 0..2 {
            let rms = whole["joints"][joint]["tracking_error"]["rms"].as_f64().unwrap().to_degrees();
            assert!((rms - 1.0).abs() < 1e-6, "{again}: {rms}");
        }
        fs::write(folder.path().join("a.csv"), &text).unwrap();
        let (code, _, error) =
            said(&hydrotrace(folder.path(), &["import", "a.csv", "-o", "a.mcap", "--force"]));
        let refused = error.contains("line 302 is a header");
        assert_eq!((code, refused), if parts == 1 { (3, false) } else { (1, true) }, "{again}: {error}");
    }
}

#[test]
fn a_header_that_changes_before_the_columns_are_settled_loses_no_row() {
    let folder = tempfile::tempdir().unwrap();
    let [one, two] =
        ["t_s,boom_set_deg,boom_act_deg", "t_s,boom_set_deg,boom_act_deg,arm_set_deg,arm_act_deg"];
    let rows = |range: std::ops::Range<u32>, more: &str| -> String {
        range.map(|k| format!("{},1,2{more}\n", f64::from(k) * 0.01)).collect()
    };
    for before in [1, 4, 8] {
        let text = format!("{one}\n{}{two}\n{}", rows(0..before, ""), rows(before..before + 200, ",3,4"));
        let (code, out, error) = recorded(folder.path(), &text, &["--force"]);
        let said = format!("{} rows of {} lines", before + 200, before + 202);
        assert!(code == 3 && out.starts_with(&said), "{before}: {code} {out}{error}");
        assert!(out.contains("report run.mcap run-2.mcap"), "{out}");
    }
    let text = format!("a,b_set_deg,b\n{}{one}\n{}", "x,1\n0,1,2\n", rows(0..200, ""));
    let text = text.replace("a,b_set_deg,b", "note,boom_set_deg,x");
    let (code, out, error) = recorded(folder.path(), &text, &["--force"]);
    assert!(code == 3 && out.contains("cannot be told"), "{code} {out}{error}");
    // A header alone, and a third one at once.
    let text = format!("{one}\n{}{two}\n{one},note\n{}", rows(0..4, ""), rows(4..9, ",x"));
    let (code, out, error) = recorded(folder.path(), &text, &["--force"]);
    assert!(code == 3 && out.starts_with("9 rows of 12 lines"), "{code} {out}{error}");
}

#[test]
fn a_header_after_midnight_is_of_the_day_that_came_and_rows_are_counted_once() {
    let folder = tempfile::tempdir().unwrap();
    let text = "time,boom_set_deg,boom_act_deg\n23:59:59.0,0,0\n23:59:59.5,1,0.5\n23:59:59.5,1,0.5\n00:00:00.0,2,1.5\n\
                time,boom_set_deg,boom_act_deg,arm_set_deg,arm_act_deg\n00:00:00.5,3,2.5,1,1\n00:00:01.0,4,3.5,1,1\n\
                00:00:01.5,5,4.5,1,1\n";
    let later = (4..12).map(|k| format!("00:00:{k:02}.0,5,5,1,1\n")).collect::<String>();
    let (code, out, error) = recorded(folder.path(), &format!("{text}{later}00:00:11.0,5,5,1,1\n"), &[]);
    assert!(code == 3 && out.matches("duplicate-stamp x2").count() == 1, "{out}{error}");
    let logs = ["report", "--json", "run.mcap", "run-2.mcap"];
    let found: Value = serde_json::from_str(&said(&hydrotrace(folder.path(), &logs)).1).unwrap();
    assert!((found["source"]["duration_s"].as_f64().unwrap() - 12.0).abs() < 1e-6, "{found:#}");
}

#[test]
fn a_guess_is_a_remark_of_a_recording_too_and_a_number_that_is_none_loses_no_line() {
    let folder = tempfile::tempdir().unwrap();
    let text = trace("t,boom_set_mm,boom_act_mm", 1000.0, ",", 1000.0);
    let (code, out, _) = recorded(folder.path(), &text, &[]);
    assert!(code == 3 && out.contains("says no unit") && out.contains("--time-unit"), "{code}: {out}");
    let line =
        |k: u32| format!("{{\"t_s\": {k}, \"set_deg\": 1, \"act_deg\": NaN, \"said\": \"a \\\" NaN\"}}\n");
    let lines: String =
        (0..50).map(|k| if k < 20 { line(k).replace(": NaN", ": 1") } else { line(k) }).collect();
    let (_, out, _) = recorded(folder.path(), &lines, &["--force"]);
    assert!(out.starts_with("50 rows of 50 lines"), "{out}");
    let (code, _, error) = recorded(folder.path(), &text, &["--force", "--part-mb", "0"]);
    assert!(code == 2 && error.contains("--part-mb"), "{error}");
}

/// `import` sees all rows, and a recording the first ones: what these cannot tell is not guessed.
#[test]
fn what_only_a_whole_table_tells_is_not_recorded() {
    let folder = tempfile::tempdir().unwrap();
    let rows = |row: &dyn Fn(f64) -> String| (0..9).map(|k| row(f64::from(k))).collect::<String>();
    for (had, text) in [
        (
            "a row for each joint",
            format!(
                "t_s,axis,target_deg,actual_deg\n{}",
                rows(&|k| format!("{0},boom,{k},{k}\n{0},stick,{k},{k}\n", 0.1 * k))
            ),
        ),
        (
            "times of their own",
            format!(
                "time_ms,boom_set_deg,time_ms,boom_act_deg\n{}",
                rows(&|k| format!("{},{k},{},{k}\n", 10.0 * k, 10.0 * k + 500.0))
            ),
        ),
        (
            "units or marks of thousands",
            format!("t_s;boom_set;boom_act\n{}", rows(&|k| format!("{};{k} deg;{k} deg\n", 0.1 * k))),
        ),
    ] {
        let (code, _, error) = recorded(folder.path(), &text, &[]);
        assert!(code == 1 && error.contains(had) && error.contains("hydrotrace import"), "{code}: {error}");
        assert!(!folder.path().join("run.mcap").exists(), "{had}");
    }
}

#[test]
fn rows_that_are_called_bad_are_not_recorded() {
    let folder = tempfile::tempdir().unwrap();
    let row = |k: u32| {
        let (value, said) = if k % 40 == 30 { (999.0, "Bad") } else { (0.01 * f64::from(k), "Good") };
        format!("{},{value},{value},{said}\n", 0.02 * f64::from(k))
    };
    let rows: String = (0..200).map(row).collect();
    let text = format!("t_s,boom_set_deg,boom_act_deg,quality\n{rows}");
    let (code, out, error) = recorded(folder.path(), &text, &[]);
    assert!(code == 3 && out.starts_with("195 rows of 201"), "{code}: {out}{error}");
    assert!(out.contains("x5") && out.contains("calls bad"), "{out}");
}
