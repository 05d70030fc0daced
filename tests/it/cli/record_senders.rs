//! `record` of what comes in pieces: a joint a line, words before numbers, several senders.

use std::{
    fs,
    io::Write,
    net::{SocketAddr, UdpSocket},
    path::Path,
    process::Child,
    thread::sleep,
    time::Duration,
};

use super::{
    csv::{moves, report, trace},
    record::{recorded, start},
};
use crate::support::said;

/// Two joints, a line each at each instant; `late_s` is how much later the second one's stamp is.
fn joint_a_line(line: impl Fn(&str, f64, [f64; 2]) -> String, late_s: f64) -> String {
    let both = |k: u32| {
        let t_s = f64::from(k) * 0.02;
        let of = |joint, t_s| line(joint, t_s, moves(t_s).map(f64::to_degrees));
        of("boom", t_s) + &of("arm", t_s + late_s)
    };
    (0..500).map(both).collect()
}

fn named(joint: &str, t_s: f64, [planned, measured]: [f64; 2]) -> String {
    format!("{{\"t\": {t_s}, \"joint\": \"{joint}\", \"set_deg\": {planned}, \"act_deg\": {measured}}}\n")
}

fn in_keys(joint: &str, t_s: f64, [planned, measured]: [f64; 2]) -> String {
    format!("{{\"t\": {t_s}, \"{joint}_set_deg\": {planned}, \"{joint}_act_deg\": {measured}}}\n")
}

/// A recorder that listens for six seconds, and where.
fn listening(folder: &Path) -> (SocketAddr, Child) {
    let free = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let recorder = start(folder, &["--udp", &free.to_string(), "--seconds", "6"]);
    sleep(Duration::from_secs(2));
    (free, recorder)
}

#[test]
fn a_line_for_each_joint_loses_no_joint() {
    let folder = tempfile::tempdir().unwrap();
    for (lines, rows) in [
        (joint_a_line(named, 0.0), 500),
        (joint_a_line(in_keys, 0.0), 500),
        (joint_a_line(named, 0.003), 1000),
    ] {
        let (code, out, error) = recorded(folder.path(), &lines, &["--force"]);
        assert!(code == 0 && out.starts_with(&format!("{rows} rows of 1000 lines")), "{code} {out}{error}");
        let whole = report(folder.path(), "run.mcap");
        for joint in 0..2 {
            assert_eq!(whole["joints"][joint]["starts"], 1, "{joint} of {out}");
        }
    }
}

#[test]
fn words_before_the_first_numbers_are_told_and_end_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let objects = joint_a_line(in_keys, 0.0);
    for words in
        ["{\"status\": \"ready\"}\n{\"status\": null, \"who\": \"me\"}\n", "starting up\nready, go\n"]
    {
        let (code, out, error) = recorded(folder.path(), &format!("{words}{objects}"), &["--force"]);
        assert!(code == 3 && out.starts_with("500 rows of 1002 lines"), "{code}: {out}{error}");
        assert!(out.contains("x2") && out.contains("before the first with numbers"), "{out}");
    }
    let (code, _, error) = recorded(folder.path(), "{\"status\": \"ready\"}\n", &["--force"]);
    assert!(code == 1 && error.contains("no line with numbers came"), "{code}: {error}");
}

#[test]
fn a_second_sender_is_told_and_not_mixed_in() {
    let folder = tempfile::tempdir().unwrap();
    let (free, recorder) = listening(folder.path());
    let [one, other, beside] =
        ["127.0.0.1:0", "127.0.0.2:0", "127.0.0.1:0"].map(|from| UdpSocket::bind(from).unwrap());
    let text = trace("t_s,boom_set_mm,boom_act_mm", 1.0, ",", 1000.0);
    for (k, line) in text.lines().enumerate() {
        one.send_to(line.as_bytes(), free).unwrap();
        sleep(Duration::from_micros(300));
        if k > 1 {
            // A host may send from one address alone.
            let _ = other.send_to(b"0.5,7000,7000", free);
            beside.send_to(b"0.5,9000,9000", free).unwrap();
        }
    }
    let (code, out, error) = said(&recorder.wait_with_output().unwrap());
    assert!(code == 3 && out.contains("another sender than 127.0.0.1:"), "{code}: {out}{error}");
    fs::write(folder.path().join("a.csv"), &text).unwrap();
    assert!(out.starts_with("500 rows of 501 lines"), "{out}");
    assert_eq!(report(folder.path(), "run.mcap")["joints"], report(folder.path(), "a.csv")["joints"]);
}

#[test]
fn packets_of_nobody_and_packets_that_end_within_a_row_lose_none() {
    let folder = tempfile::tempdir().unwrap();
    let (free, recorder) = listening(folder.path());
    let [one, other] = ["127.0.0.1:0", "127.0.0.2:0"].map(|from| UdpSocket::bind(from).unwrap());
    let text = trace("t_s,boom_set_mm,boom_act_mm", 1.0, ",", 1000.0);
    for noise in [&b""[..], b"hello\n", b"{\"temp\": 20}"] {
        // A host may send from one address alone.
        let _ = other.send_to(noise, free);
    }
    for packet in text.as_bytes().chunks(150) {
        one.send_to(packet, free).unwrap();
        sleep(Duration::from_micros(300));
    }
    let (_, out, error) = said(&recorder.wait_with_output().unwrap());
    fs::write(folder.path().join("a.csv"), &text).unwrap();
    assert!(out.starts_with("500 rows of 501 lines"), "{out}{error}");
    assert_eq!(report(folder.path(), "run.mcap")["joints"], report(folder.path(), "a.csv")["joints"]);
}

#[test]
fn a_port_for_each_packet_loses_none() {
    let folder = tempfile::tempdir().unwrap();
    let (free, recorder) = listening(folder.path());
    let text = trace("t_s,boom_set_mm,boom_act_mm", 1.0, ",", 1000.0);
    for line in text.lines() {
        let one = UdpSocket::bind("127.0.0.1:0").unwrap();
        one.send_to(line.as_bytes(), free).unwrap();
        sleep(Duration::from_micros(300));
    }
    let (_, out, error) = said(&recorder.wait_with_output().unwrap());
    assert!(out.starts_with("500 rows of 501 lines"), "{out}{error}");
}

#[test]
fn a_header_that_comes_later_is_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let text = trace("t_s,boom_set_mm,boom_act_mm", 1.0, ",", 1000.0);
    let (head, rows) = text.split_once('\n').unwrap();
    let lines: Vec<&str> = rows.lines().collect();
    let later = format!("{}\n{head}\n{}\n", lines[..60].join("\n"), lines[60..].join("\n"));
    // From the middle of a row on, too.
    for (cut, left_out) in [(0, 60), (3, 60)] {
        let (code, out, error) = recorded(folder.path(), &later[cut..], &["--force"]);
        assert!(code == 3 && out.starts_with("440 rows of 501 lines"), "{cut}: {code} {out}{error}");
        assert!(out.contains(&format!("x{left_out}")) && out.contains("before the first header"), "{out}");
    }
    let (code, _, error) = recorded(folder.path(), rows, &["--force"]);
    assert!(code == 1 && error.contains("--time"), "{code}: {error}");
}

#[test]
fn a_plan_that_is_none_is_refused_before_anything_is_recorded() {
    let folder = tempfile::tempdir().unwrap();
    let text = trace("t_s,boom_set_mm,boom_act_mm", 1.0, ",", 1000.0);
    fs::write(folder.path().join("words.mcap"), "no log").unwrap();
    for plan in ["nothing.mcap", "words.mcap"] {
        let (code, _, error) = recorded(folder.path(), &text, &["--plan", plan]);
        assert!(code == 1 && error.contains(plan), "{code}: {error}");
        assert!(!folder.path().join("run.mcap").exists());
    }
}

#[test]
fn parts_of_an_earlier_recording_that_stay_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let text = trace("t_s,boom_set_mm,boom_act_mm", 1.0, ",", 1000.0);
    for number in [2, 3, 5] {
        fs::write(folder.path().join(format!("run-{number}.mcap")), "older").unwrap();
    }
    fs::write(folder.path().join("run.mcap"), "older").unwrap();
    let (code, out, error) = recorded(folder.path(), &text, &["--force"]);
    assert!(code == 3 && out.contains("other-file x2") && out.contains("run-2.mcap"), "{code}: {out}{error}");
    assert_eq!(fs::read(folder.path().join("run-2.mcap")).unwrap(), b"older");
}

#[test]
fn utf_16_on_standard_input_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let text = trace("t_s,boom_set_mm,boom_act_mm", 1.0, ",", 1000.0);
    for to_bytes in [u16::to_le_bytes, u16::to_be_bytes] {
        let bytes: Vec<u8> = std::iter::once(0xfeff).chain(text.encode_utf16()).flat_map(to_bytes).collect();
        let mut recorder = start(folder.path(), &["--force"]);
        recorder.stdin.take().unwrap().write_all(&bytes).unwrap();
        let (code, out, error) = said(&recorder.wait_with_output().unwrap());
        assert!(code == 0 && out.starts_with("500 rows of 501 lines"), "{code}: {out}{error}");
    }
}
