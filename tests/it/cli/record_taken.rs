//! `record` where names are taken, senders are odd, and disks lose files.

use std::{fs, io::Write as _, path::Path, thread::sleep, time::Duration};

use super::record::{recorded, start};
use crate::support::{command, json, said};

const HEAD: &str = "t_s,boom_target_deg,boom_actual_deg\n";

fn rows(range: std::ops::Range<u32>, from_s: f64) -> String {
    range
        .map(|k| {
            let t_s = 0.02 * f64::from(k);
            format!("{:.2},{:.4},{:.4}\n", from_s + t_s, 20.0 * t_s.sin(), 20.0 * (t_s - 0.1).sin())
        })
        .collect()
}

fn messages(folder: &Path, log: &str) -> u64 {
    let found = json(folder, &format!("info {log}"));
    crate::support::hold_to_schema(&found, "info.v1");
    found["topics"].as_array().unwrap().iter().filter_map(|topic| topic["messages"].as_u64()).max().unwrap()
}

#[test]
fn a_part_whose_name_is_taken_has_the_next_one_and_what_was_read_stays() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("run-2.mcap"), "of yesterday").unwrap();
    let text = HEAD.to_owned() + &rows(0..40_000, 0.0);
    let (code, out, error) = recorded(folder.path(), &text, &["--part-mb", "1"]);
    assert!(code == 3 && out.contains("40000 rows") && out.contains("run-3.mcap"), "{code} {out} {error}");
    assert_eq!(fs::read(at("run-2.mcap")).unwrap(), b"of yesterday");
    // A map, by another name.
    fs::write(at("map.toml"), "time = \"t_s\"\n").unwrap();
    fs::remove_file(at("run-2.mcap")).unwrap();
    fs::hard_link(at("map.toml"), at("run-2.mcap")).unwrap();
    let (code, out, _) = recorded(folder.path(), &text, &["--part-mb", "1", "--map", "map.toml", "--force"]);
    assert!(code == 3 && out.contains("stepped over"), "{code} {out}");
    assert_eq!(fs::read_to_string(at("map.toml")).unwrap(), "time = \"t_s\"\n");
}

#[cfg(unix)]
#[test]
fn standard_input_is_read_too_and_is_not_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("run.mcap");
    fs::write(&input, HEAD.to_owned() + &rows(0..300, 0.0)).unwrap();
    let mut recorder = command(folder.path());
    recorder.args(["record", "-o", "run.mcap", "--force"]).stdin(fs::File::open(&input).unwrap());
    let (code, _, error) = said(&recorder.output().unwrap());
    assert!(code == 1 && error.contains("is an input"), "{code} {error}");
    assert!(fs::read_to_string(&input).unwrap().starts_with(HEAD));
}

#[cfg(unix)]
#[test]
fn a_log_that_is_removed_meanwhile_is_no_success() {
    let folder = tempfile::tempdir().unwrap();
    let mut recorder = start(folder.path(), &[]);
    let mut input = recorder.stdin.take().unwrap();
    input.write_all((HEAD.to_owned() + &rows(0..100, 0.0)).as_bytes()).unwrap();
    let log = folder.path().join("run.mcap");
    while !log.exists() {
        sleep(Duration::from_millis(20));
    }
    fs::remove_file(&log).unwrap();
    // It may have ended before all came.
    let _ = input.write_all(rows(100..400, 0.0).as_bytes());
    drop(input);
    let (code, _, error) = said(&recorder.wait_with_output().unwrap());
    assert!(code == 1 && error.contains("removed or replaced"), "{code} {error}");
}

#[test]
fn a_clock_that_is_set_and_a_bad_stamp_end_no_recording() {
    for (text, rows_of) in [
        (HEAD.to_owned() + &rows(0..100, 0.0) + &rows(100..500, 1.75e9), 500),
        (HEAD.to_owned() + &rows(0..100, 0.0) + "4000000000,1,1\n" + &rows(100..500, 0.0), 500),
        (
            HEAD.to_owned()
                + &rows(0..100, 0.0)
                + "pressure_bar,flow_l_min\n1,2\n3,4\n"
                + HEAD
                + &rows(100..300, 0.0),
            300,
        ),
        (HEAD.to_owned() + &rows(0..100, 0.0) + "time,stick,swing\n2.00,30,40\n2.02,31,41\n", 100),
        (HEAD.to_owned() + &rows(0..2, 0.0) + "x,y,z\n" + &rows(2..100, 0.0), 100),
        (HEAD.to_owned() + &rows(0..200, 0.0) + "4.00,18.1859,1", 200),
        (rows(0..3, 0.0) + HEAD + &rows(3..103, 0.0), 100),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let (code, out, error) = recorded(folder.path(), &text, &[]);
        assert!(code == 3 && out.starts_with(&format!("{rows_of} rows")), "{code} {out} {error}");
    }
}

#[test]
fn rows_are_on_the_disk_whatever_their_clock_says() {
    let folder = tempfile::tempdir().unwrap();
    let mut recorder = start(folder.path(), &[]);
    let mut input = recorder.stdin.take().unwrap();
    // Then nobody sends any more, and the last row is not a second after the first.
    input.write_all((HEAD.to_owned() + &rows(0..40, 0.0)).as_bytes()).unwrap();
    sleep(Duration::from_secs(3));
    recorder.kill().unwrap();
    recorder.wait().unwrap();
    assert_eq!(messages(folder.path(), "run.mcap"), 40);
}

#[test]
fn a_mark_before_the_first_object_and_an_endless_time_are_taken() {
    let folder = tempfile::tempdir().unwrap();
    let object = |k: u32| {
        format!("{{\"t_s\": {:.2}, \"boom_set_deg\": {k}, \"boom_act_deg\": {k}}}\n", 0.02 * f64::from(k))
    };
    let text = "\u{feff}".to_owned() + &(0..50).map(object).collect::<String>();
    let (code, out, error) = recorded(folder.path(), &text, &["--seconds", "1e300"]);
    assert!(code == 0 && out.starts_with("50 rows"), "{code} {out} {error}");
}
