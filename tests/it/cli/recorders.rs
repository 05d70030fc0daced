//! What recorders do to a run: they go on or stop early, and what they wrote is damaged; none of it is a change of the
//! machine.

use std::{fmt::Write as _, fs, path::Path};

use serde_json::Value;

use crate::support::{fleet::smooth, hold_to_schema, run_line, said, scratch, timed};

/// A stroke of 8 deg in 2 s, as a share of the way.
fn stroke(t: f64) -> f64 {
    smooth(0.5 * t)
}

/// Six strokes there and back, 6 s apart from 2 s on, deg.
fn plan(t: f64) -> f64 {
    (0..6).map(|k| 8.0 * if k % 2 == 0 { 1.0 } else { -1.0 } * stroke(t - 2.0 - 6.0 * f64::from(k))).sum()
}

/// A table at 100 Hz over some seconds.
fn table([from_s, to_s]: [f64; 2], measured: impl Fn(f64) -> f64) -> String {
    let mut text = "t_s,boom planned [deg],boom measured [deg]\n".to_owned();
    let mut t = from_s;
    while t < to_s {
        writeln!(text, "{t:.2},{:.5},{:.5}", plan(t), measured(t)).unwrap();
        t += 0.01;
    }
    text
}

/// Late by so much, with a little noise.
fn late(by_s: f64) -> impl Fn(f64) -> f64 {
    move |t| plan(t - by_s) + 0.003 * (1000.0 * t).sin()
}

fn compared(folder: &Path, line: &str) -> (i32, Value) {
    let (code, text, error) = said(&run_line(folder, line));
    (code, serde_json::from_str(&text).unwrap_or_else(|_| panic!("{error}")))
}

fn ratio(document: &Value) -> f64 {
    document["whole_run"][0]["rms"]["ratio"].as_f64().unwrap()
}

#[test]
fn a_recorder_that_runs_on_or_begins_later_is_no_change() {
    let folder = scratch();
    let write = |name: &str, text: String| fs::write(folder.path().join(name), text).unwrap();
    write("a.csv", table([0.0, 40.0], late(0.35)));
    write("long.csv", table([0.0, 100.0], late(0.35)));
    write("early.csv", table([-9.0, 40.0], late(0.35)));
    for after in ["long.csv", "early.csv"] {
        for line in [format!("compare a.csv {after}"), format!("compare {after} a.csv")] {
            let (code, document) = compared(folder.path(), &format!("{line} --json --max-rms-ratio 0.9"));
            hold_to_schema(&document, "compare.v2");
            assert!(code == 4 && (ratio(&document) - 1.0).abs() < 0.01, "{line}: {}", ratio(&document));
        }
    }
    let (_, text, _) = said(&run_line(folder.path(), "compare a.csv long.csv"));
    assert!(text.contains("long.csv: 99.99 s (0.00 to 40.04 s compared)"), "{text}");
}

#[test]
fn a_start_that_one_log_cuts_off_is_no_improvement() {
    let folder = scratch();
    fs::write(folder.path().join("a.csv"), table([0.0, 40.0], late(0.35))).unwrap();
    for end_s in [14.3, 14.6, 16.0] {
        fs::write(folder.path().join("b.csv"), table([0.0, end_s], late(0.35))).unwrap();
        for line in ["compare a.csv b.csv", "compare b.csv a.csv"] {
            let (code, document) = compared(folder.path(), &format!("{line} --json"));
            let pairs = document["pairs"].as_array().unwrap();
            let least = |pair: &Value| pair["peak_error"]["difference"].as_f64().unwrap().abs() < 0.02;
            assert!(code == 3 && pairs.len() == 3 && pairs.iter().all(least), "{line} to {end_s}: {pairs:?}");
            assert_eq!(document["unpaired"].as_array().unwrap().len(), 3, "{line} to {end_s}");
        }
    }
}

#[test]
fn a_log_that_ends_before_the_first_start_is_no_run_without_error() {
    let folder = scratch();
    let begins = |t: f64| late(0.35)(t - 3.0);
    let shifted = |to_s: f64| {
        let mut text = "t_s,boom planned [deg],boom measured [deg]\n".to_owned();
        for t in (0..).map(|k| 0.01 * f64::from(k)).take_while(|t| *t < to_s) {
            writeln!(text, "{t:.2},{:.5},{:.5}", plan(t - 3.0), begins(t)).unwrap();
        }
        text
    };
    fs::write(folder.path().join("a.csv"), shifted(44.0)).unwrap();
    fs::write(folder.path().join("b.csv"), shifted(4.5)).unwrap();
    for line in ["compare a.csv b.csv", "compare b.csv a.csv"] {
        let (code, document) = compared(folder.path(), &format!("{line} --json --max-rms-ratio 0.5"));
        assert!(code == 4 && (0.8..1.25).contains(&ratio(&document)), "{line}: {}", ratio(&document));
        assert_eq!(document["unpaired"].as_array().unwrap().len(), 6, "{line}");
    }
}

#[test]
fn a_sensor_that_fails_before_the_others_costs_no_start_of_theirs() {
    let folder = scratch();
    let write = |name: &str, by_s: f64, fails_s: f64| {
        let head = "t_s,boom planned [deg],boom measured [deg],arm planned [deg],arm measured [deg]";
        let text = timed(head, (4000, 0.01), |t| {
            let (boom, arm) = (late(by_s)(t), late(by_s)(t - 0.7));
            let arm = if t < fails_s { format!("{arm:.5}") } else { String::new() };
            format!("{t:.2},{:.5},{boom:.5},{:.5},{arm}", plan(t), plan(t - 0.7))
        });
        fs::write(folder.path().join(name), text).unwrap();
    };
    write("a.csv", 0.35, 99.0);
    write("b.csv", 0.35, 15.0);
    for line in ["compare a.csv b.csv --json", "compare b.csv a.csv --json"] {
        let (_, document) = compared(folder.path(), line);
        let pairs = document["pairs"].as_array().unwrap();
        let of = |joint: &str| pairs.iter().filter(|pair| pair["joint"] == joint).count();
        assert_eq!((of("boom"), of("arm")), (6, 3), "{line}: {pairs:?}");
        let alike = |pair: &Value| pair["peak_error"]["difference"].as_f64().unwrap().abs() < 0.02;
        assert!(pairs.iter().all(alike) && (ratio(&document) - 1.0).abs() < 0.01, "{line}: {document}");
    }
}

#[test]
fn starts_that_a_joint_no_longer_follows_are_counted() {
    let folder = scratch();
    fs::write(folder.path().join("a.csv"), table([0.0, 40.0], late(0.35))).unwrap();
    // With the noise of its sensor, which is alive.
    let stops = |t: f64| late(0.25)(t.min(19.0)) + 0.004 * (700.0 * t).sin();
    fs::write(folder.path().join("b.csv"), table([0.0, 40.0], stops)).unwrap();
    let (code, text, _) = said(&run_line(folder.path(), "compare a.csv b.csv"));
    assert!(code == 3 && text.contains("3 starts: the joint followed before, and no longer does"), "{text}");
}

#[test]
fn a_joint_that_moves_before_its_plan_does_not_start_seconds_late() {
    let folder = scratch();
    // The plan smoothed over time, and a small swing after each stroke.
    let measured = |t: f64| {
        let weights = (-40..=40).map(|k| (f64::from(k) * 0.02, 41.0 - f64::from(k).abs()));
        let (sum, all) = weights.fold((0.0, 0.0), |(sum, all), (off, w)| (sum + w * plan(t + off), all + w));
        let after = |k: i32| {
            let since = t - 2.0 - 6.0 * f64::from(k) - 2.7;
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            if (0.0..2.4).contains(&since) { -0.1 * sign * (1.0 - (2.618 * since).cos()) } else { 0.0 }
        };
        sum / all + (0..6).map(after).sum::<f64>() + 0.003 * (1000.0 * t).sin()
    };
    fs::write(folder.path().join("a.csv"), table([0.0, 44.0], measured)).unwrap();
    let (code, text, error) = said(&run_line(folder.path(), "report a.csv --json"));
    assert_eq!(code, 0, "{error}");
    let report: Value = serde_json::from_str(&text).unwrap();
    let starts = report["transitions"].as_array().unwrap();
    let late = |start: &Value| start["onset_delay_s"].as_f64().is_some_and(|s| s > 0.5);
    assert!(starts.len() == 6 && !starts.iter().any(late), "{starts:?}");
}

#[test]
fn what_was_doubtful_when_a_log_was_recovered_stays_so() {
    let folder = scratch();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("a.csv"), table([0.0, 40.0], late(0.35))).unwrap();
    let clean = |line: &str| {
        let (code, _, error) = said(&run_line(folder.path(), line));
        assert!(code == 0 || code == 3, "{line}: {error}");
    };
    clean("import a.csv -o a.mcap");
    let sound = fs::read(path("a.mcap")).unwrap();
    // Within the compressed data of the first chunk, where a byte is a byte of the text or breaks it.
    let damaged = |at: usize| {
        let mut bytes = sound.clone();
        bytes[at] ^= 0x10;
        fs::write(path("b.mcap"), bytes).unwrap();
        let (_, text, _) = said(&run_line(folder.path(), "recover b.mcap -o c.mcap --json --force"));
        serde_json::from_str::<Value>(&text).ok()
    };
    let (mut kept, mut lost) = (0, 0);
    for at in (2000..sound.len() / 2).step_by(1499) {
        let Some(document) = damaged(at) else { continue };
        hold_to_schema(&document, "recover.v1");
        let [messages, doubtful, dropped] =
            ["messages", "doubtful_messages", "dropped_blocks"].map(|key| document[key].as_u64().unwrap());
        assert!(messages > 0 || dropped > 0, "byte {at}: {document}");
        lost += dropped;
        if doubtful > 0 {
            kept += 1;
            let (code, text, error) = said(&run_line(folder.path(), "report c.mcap"));
            assert!(code == 1 || code == 3 && text.contains("damaged-chunk"), "byte {at}: {text}{error}");
        }
    }
    assert!(kept + lost > 0);
}

/// A PC stamps rows when they arrive, up to 3 ms late by chance: a command made from them is as smooth as their plan.
#[test]
fn rows_that_were_stamped_late_by_chance_shake_no_command() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let largest = |name: &str, late: &dyn Fn(u32) -> f64| {
        let row = |k: u32| {
            let t_s = 0.01 * f64::from(k);
            format!("{:.5},{:.4},{:.4}\n", t_s + late(k), plan(t_s), plan(t_s - 0.15))
        };
        let rows: String = (0..3000).map(row).collect();
        fs::write(folder.join(name), format!("t_s,boom_set_deg,boom_act_deg\n{rows}")).unwrap();
        let (code, out, error) =
            said(&run_line(folder, &format!("replan {name} --keep-plan -o next.mcap --force")));
        assert!(code == 0 || code == 3, "{out}{error}");
        let table = said(&run_line(folder, "export next.mcap --csv --degrees")).1;
        let header: Vec<&str> = table.lines().next().unwrap().split(',').collect();
        let column =
            header.iter().position(|name| name.contains("command") && name.ends_with("_deg")).unwrap();
        let sent: Vec<f64> =
            table.lines().skip(1).map(|line| line.split(',').nth(column).unwrap().parse().unwrap()).collect();
        let jerks = sent.windows(3).map(|q| (q[2] - 2.0 * q[1] + q[0]).abs());
        (jerks.fold(0.0, f64::max) / 1e-4, out)
    };
    let (even, _) = largest("even.csv", &|_| 0.0);
    let late = |k: u32| 0.003 * f64::from(k.wrapping_mul(2_654_435_761) >> 16 & 0xff) / 255.0;
    let (by_chance, out) = largest("late.csv", &late);
    assert!(by_chance < 1.5 * even + 10.0, "{by_chance} and {even} deg/s2");
    assert!(out.contains("taken at even steps"), "{out}");
}

/// The operator plays a command from the zero of another clock, 0.6 s early.
#[test]
fn a_command_that_was_sent_early_teaches_nothing_and_none_is_to_be_sent_before_that_is_mended() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let table = |name: &str, sent: &dyn Fn(f64) -> f64, came: &dyn Fn(f64) -> f64| {
        let row = |k: u32| {
            let t = 0.01 * f64::from(k);
            format!("{t:.2},{:.4},{:.4},{:.4}\n", plan(t), sent(t), came(t))
        };
        let rows: String = (0..4000).map(row).collect();
        let header = "t_s,boom_planned_deg,boom_command_deg,boom_measured_deg";
        fs::write(folder.join(name), format!("{header}\n{rows}")).unwrap();
    };
    table("first.csv", &plan, &late(0.15));
    table("early.csv", &|t| plan(t + 0.75), &late(-0.6));
    let (code, out, error) =
        said(&run_line(folder, "replan first.csv early.csv --keep-plan --gain 0.5 -o next.mcap"));
    assert!(code == 3, "{code}: {error}");
    assert!(
        out.contains("early.csv: its joints led their plan by 0.") && out.contains("Do not send it"),
        "{out}"
    );
    assert!(out.contains("Nothing is learnt from early.csv"), "{out}");
}
