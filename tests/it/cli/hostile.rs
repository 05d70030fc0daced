//! Files that change while they are read, memory that is short, and clocks that are set in mid run.

use std::{
    fs::{self, File, OpenOptions},
    io::Write as _,
    os::unix::process::ExitStatusExt as _,
    path::Path,
    process::{Command, Output, Stdio},
    thread,
    time::Duration,
};

use hydrotrace::log::{LogWriter, Role, WriteOptions};

use crate::support::{command, run_line, said, sample, scratch, stderr};

/// A line of the program in a shell that is limited; seconds of processor time, and kB of addresses.
fn limited(folder: &Path, seconds: u32, kilobytes: u32, line: &str) -> Output {
    let program = env!("CARGO_BIN_EXE_hydrotrace");
    let script = format!("ulimit -t {seconds}; ulimit -v {kilobytes}; exec {program} {line}");
    Command::new("sh").args(["-c", &script]).current_dir(folder).output().unwrap()
}

#[test]
fn a_file_that_shrinks_or_grows_while_it_is_read_ends_no_process() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let whole = fs::read(sample("pressures-run.mcap")).unwrap();
    let mut ended = [0, 0];
    for attempt in 0..40_u64 {
        fs::write(path.join("run.mcap"), &whole).unwrap();
        let verb = ["report run.mcap", "recover run.mcap -o saved.mcap --force", "info run.mcap"];
        let line = verb[usize::try_from(attempt % 3).unwrap()];
        let mut child = command(path);
        let child = child.args(line.split(' ')).stdout(Stdio::null()).stderr(Stdio::null());
        let mut child = child.spawn().unwrap();
        thread::sleep(Duration::from_micros(700 * attempt));
        let file =
            OpenOptions::new().write(true).append(attempt % 2 == 1).open(path.join("run.mcap")).unwrap();
        if attempt % 2 == 0 {
            file.set_len(whole.len() as u64 / 3).unwrap();
        } else {
            (&file).write_all(&whole).unwrap();
        }
        let status = child.wait().unwrap();
        assert_eq!(status.signal(), None, "{line}, attempt {attempt}");
        assert!(matches!(status.code(), Some(0 | 1 | 3)), "{line}: {status}");
        ended[usize::from(status.code() == Some(3))] += 1;
    }
    assert!(ended.iter().all(|count| *count > 0), "the file never changed in time: {ended:?}");
}

#[test]
fn a_file_larger_than_all_memory_is_read() {
    const HOLE: u64 = 3 << 30;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    // An attachment of zeros without a checksum, which takes no room on the disk, then the run.
    let head = [&[0; 16][..], &1_u32.to_le_bytes(), b"x", &0_u32.to_le_bytes(), &HOLE.to_le_bytes()].concat();
    let body = head.len() as u64 + HOLE + 4;
    let mut file = File::create(path.join("large.mcap")).unwrap();
    file.write_all(&[b"\x89MCAP0\r\n\x09", &body.to_le_bytes()[..], &head].concat()).unwrap();
    let end = file.metadata().unwrap().len() + HOLE + 4;
    file.set_len(end).unwrap();
    drop(file);
    let mut file = OpenOptions::new().append(true).open(path.join("large.mcap")).unwrap();
    file.write_all(&fs::read(sample("panel-install.mcap")).unwrap()[8..]).unwrap();
    for line in ["report large.mcap", "info large.mcap", "export large.mcap --csv"] {
        let run = limited(path, 120, 1_500_000, line);
        assert!(matches!(run.status.code(), Some(0 | 3)), "{line}: {:?} {}", run.status, stderr(&run));
    }
}

/// A run of two joints at 50 Hz, whose clock is set by some seconds in the middle; both clocks, the recorder's too.
fn clock_set(path: &Path, by_s: f64) {
    let mut log = LogWriter::create(path, &["a", "b"], WriteOptions::default()).unwrap();
    for k in 0..3000_i32 {
        let t_s = 0.02 * f64::from(k);
        // Between two swings: a command that begins in mid motion would be refused.
        let set_s = if k < 1480 { 0.0 } else { by_s };
        #[expect(clippy::cast_possible_truncation)]
        let stamp_ns = 1_760_000_000_000_000_000 + ((t_s + set_s) * 1e9) as i64;
        let swing = |t: f64| {
            let within = t.rem_euclid(10.0);
            0.05 * if within < 5.0 {
                (within - 2.0).clamp(0.0, 2.0)
            } else {
                2.0 - (within - 7.0).clamp(0.0, 2.0)
            }
        };
        let planned = [swing(t_s), -swing(t_s)];
        let measured = [swing(t_s - 0.2), -swing(t_s - 0.2)];
        log.joint_sample(Role::Planned, stamp_ns, &planned, &[], &[]).unwrap();
        log.joint_sample(Role::Measured, stamp_ns, &measured, &[], &[]).unwrap();
    }
    log.finish().unwrap();
}

#[test]
fn a_clock_that_is_set_in_mid_run_costs_neither_memory_nor_time_nor_the_run() {
    const DAY_S: f64 = 86_400.0;
    let folder = scratch();
    let path = folder.path();
    for (name, by_s) in [
        ("second", 3.0),
        ("months", 116.0 * DAY_S),
        ("years", 12.0 * 365.0 * DAY_S),
        ("long-back", -50.0 * 365.0 * DAY_S),
    ] {
        clock_set(&path.join(format!("{name}.mcap")), by_s);
        for line in [
            format!("report {name}.mcap --json"),
            format!("report {name}.mcap --html -o {name}.html --figures {name}"),
            format!("fit {name}.mcap -o {name}.toml"),
            format!("replan {name}.mcap --keep-plan -o {name}-next.mcap"),
            format!("export {name}.mcap --csv -o {name}.csv"),
            format!("import {name}.csv -o {name}-again.mcap"),
            format!("join {name}-bare.mcap --plan {name}-next.mcap -o {name}-joined.mcap"),
            format!("info {name}.mcap"),
        ] {
            if line.starts_with("join") {
                let bare = format!("{name}-bare.mcap");
                fs::copy(path.join(format!("{name}.mcap")), path.join(bare)).unwrap();
            }
            let run = limited(path, 60, 1_200_000, &line);
            // Where a plan is already, none is joined.
            let done = matches!(run.status.code(), Some(0 | 3)) || line.starts_with("join");
            assert!(done && run.status.signal().is_none(), "{line}: {:?} {}", run.status, stderr(&run));
        }
        let next = path.join(format!("{name}-next.mcap")).metadata().unwrap().len();
        assert!(next < 4 << 20, "the next plan after {name} takes {next} bytes");
    }
    let (code, text, _) = said(&run_line(path, "info months-next.mcap"));
    assert!(code == 0 || code == 3, "{text}");
}

#[test]
fn names_from_a_log_run_nothing_in_a_spreadsheet_a_terminal_or_a_page() {
    const NAMES: [&str; 2] = ["=1+cmd|' /C calc'!A0", "boom\u{202e}gnp\u{2066}"];
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let mut log = LogWriter::create(path.join("run.mcap"), &NAMES, WriteOptions::default()).unwrap();
    for k in 0..1500_i32 {
        let stamp_ns = 1_760_000_000_000_000_000 + i64::from(k) * 10_000_000;
        let ramp = |t_s: f64| 0.1 * (t_s - 3.0).clamp(0.0, 3.0);
        let t_s = 0.01 * f64::from(k);
        log.joint_sample(Role::Planned, stamp_ns, &[ramp(t_s); 2], &[], &[]).unwrap();
        log.joint_sample(Role::Measured, stamp_ns, &[ramp(t_s - 0.2); 2], &[], &[]).unwrap();
    }
    log.finish().unwrap();
    for line in ["report run.mcap", "report run.mcap --markdown", "report run.mcap --html", "info run.mcap"] {
        let (code, text, error) = said(&run_line(path, line));
        assert!(code == 0 || code == 3, "{line}: {error}");
        assert!(text.contains("boom") && !text.contains(['\u{202e}', '\u{2066}']), "{line}");
        assert!(!error.contains(['\u{202e}', '\u{2066}']), "{line}");
    }
    for line in ["report run.mcap --csv", "export run.mcap --csv"] {
        let (code, text, error) = said(&run_line(path, line));
        assert!(code == 0 || code == 3, "{line}: {error}");
        let cells = text.lines().flat_map(|line| line.split(',')).map(|cell| cell.trim_matches('"'));
        let formulas: Vec<&str> = cells.filter(|cell| cell.starts_with('=')).collect();
        assert!(text.contains("'=1+cmd") && formulas.is_empty(), "{line}: {formulas:?}");
        assert!(!text.contains(['\u{202e}', '\u{2066}']), "{line}");
    }
}

#[test]
fn no_number_in_an_error_has_hundreds_of_digits() {
    let folder = scratch();
    let task = fs::read_to_string(folder.path().join("task-1.toml")).unwrap();
    let endless = format!("payload_kg = -1{}.0\n", "0".repeat(300));
    let task: String =
        task.lines().filter(|line| !line.starts_with("payload_kg")).map(|line| format!("{line}\n")).collect();
    fs::write(folder.path().join("endless.toml"), endless + &task).unwrap();
    let (code, _, error) = said(&run_line(folder.path(), "plan endless.toml"));
    assert_eq!(code, 1);
    assert!(error.contains("(301 digits)") && error.len() < 600, "{error}");
}

#[test]
fn a_table_that_was_cut_in_a_whole_number_is_read_without_it_and_a_shorter_number_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let table = |numbers: &dyn Fn(i32) -> i32| -> String {
        let row = |k: i32| format!("{:.3},{},{}\n", 0.01 * f64::from(k), numbers(k), numbers(k));
        (0..300).map(row).collect()
    };
    let rows = |text: &str| {
        fs::write(folder.path().join("t.csv"), format!("time_s,a_planned_mrad,a_measured_mrad\n{text}"))
            .unwrap();
        let run = run_line(folder.path(), "import t.csv -o t.mcap --force --json");
        let document: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap_or_default();
        document["understood"]["rows"].clone()
    };
    let counts = table(&|k| 1200 + k % 9);
    assert_eq!(rows(&counts), 300);
    assert_eq!(rows(counts.trim_end()), 300);
    for cut in 1..=3 {
        assert_eq!(rows(&counts[..counts.len() - 1 - cut]), 299, "cut by {cut}");
    }
    // The last number is shorter than those before it because it is smaller.
    assert_eq!(rows(table(&|k| 99 + 299 - k).trim_end()), 300);
}

#[test]
fn a_table_that_was_cut_in_its_last_number_is_read_without_it() {
    let folder = tempfile::tempdir().unwrap();
    let rows: String = (0..300)
        .map(|k| format!("{:.3},{:.4},{:.4}\n", 0.01 * f64::from(k), 0.5, 0.5 - 0.001 * f64::from(k % 7)))
        .collect();
    let table = format!("time_s,a_planned_rad,a_measured_rad\n{rows}");
    for cut in [1, 2, 3, 4, 5] {
        let kept = &table[..table.len() - 1 - cut];
        fs::write(folder.path().join("cut.csv"), kept).unwrap();
        let run = run_line(folder.path(), "import cut.csv -o cut.mcap --force --json");
        assert_eq!(run.status.code(), Some(3), "{}", stderr(&run));
        let document: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
        assert_eq!(document["understood"]["rows"], 299, "cut by {cut}");
        assert!(
            document["remarks"].to_string().contains("not-closed"),
            "cut by {cut}: {}",
            document["remarks"]
        );
    }
    for end in ["", "\n"] {
        fs::write(folder.path().join("whole.csv"), table.trim_end().to_owned() + end).unwrap();
        let run = run_line(folder.path(), "import whole.csv -o whole.mcap --force --json");
        let document: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
        assert_eq!(document["understood"]["rows"], 300);
    }
}

/// A file of the system that opens, has a length, and fails when it is read.
#[cfg(target_os = "linux")]
const FAILS: &str = "/sys/class/net/lo/speed";

#[cfg(target_os = "linux")]
#[test]
fn a_disk_that_fails_when_it_is_read_is_an_error_that_names_the_file() {
    if fs::metadata(FAILS).map_or(0, |file| file.len()) == 0 || fs::read(FAILS).is_ok() {
        println!("no file here that fails: left out");
        return;
    }
    let folder = scratch();
    let bag = folder.path().join("bag");
    fs::create_dir(&bag).unwrap();
    fs::copy(sample("task-1-run.mcap"), bag.join("bag_0.mcap")).unwrap();
    fs::copy(sample("task-1-run.mcap"), folder.path().join("run.mcap")).unwrap();
    std::os::unix::fs::symlink(FAILS, bag.join("bag_1.mcap")).unwrap();
    for line in [
        format!("report {FAILS}"),
        format!("info {FAILS}"),
        format!("recover {FAILS} -o out.mcap"),
        format!("import {FAILS} -o out.mcap"),
        format!("plan {FAILS}"),
        format!("replan run.mcap --limits {FAILS} -o out.mcap"),
        "report bag".to_owned(),
        "fit bag -o out.toml".to_owned(),
    ] {
        let (code, _, error) = said(&run_line(folder.path(), &line));
        assert!(code == 1 && error.contains("cannot") && error.contains("because"), "{line}: {code} {error}");
        assert!(error.contains(FAILS) || error.contains("bag_1.mcap"), "{line}: {error}");
    }
    assert!(!folder.path().join("out.mcap").exists() && !folder.path().join("out.toml").exists());
}
