//! Seasons of a machine of no simulator of ours: a loop without feed-forward behind a dead band and a delay, and runs in which something
//! else came.

use std::{fmt::Write as _, fs, path::Path};

use serde_json::Value;

use crate::support::{run_line as hydrotrace, said};

const JOINTS: [&str; 3] = ["boom", "stick", "slew"];
const ROWS: u32 = 2400;

/// Where a joint is to be, deg: there, back and there again, from 2 s on.
fn plan(joint: usize, t: f64) -> f64 {
    let moved = |from_s: f64| {
        let share = ((t - from_s) / 4.0).clamp(0.0, 1.0);
        share - (std::f64::consts::TAU * share).sin() / std::f64::consts::TAU
    };
    (8.0 + 3.0 * joint as f64) * (moved(2.0) - moved(8.0) + moved(14.0))
}

/// What a joint does of what it is sent, a row each 10 ms, deg; `stuck`: from a row to another it stands.
fn moved(sent: &[f64], stuck: Option<[usize; 2]>) -> Vec<f64> {
    let (mut q, mut speed) = (sent[0], 0.0_f64);
    let row = |k: usize| {
        let asked = 3.0 * (sent[k.saturating_sub(10)] - q);
        let through = asked.signum() * (asked.abs() - 0.6).max(0.0);
        speed += 0.01 / 0.08 * (through.clamp(-20.0, 20.0) - speed);
        if stuck.is_some_and(|[from, to]| (from..to).contains(&k)) {
            speed = 0.0;
        }
        q += 0.01 * speed;
        // Noise of an encoder, the same each time.
        q + 0.004 * ((k * 7919 % 101) as f64 / 50.0 - 1.0)
    };
    (0..sent.len()).map(row).collect()
}

/// Writes a run: `sent` by joint; the plan beside it, or what was sent in its place.
fn write(folder: &Path, name: &str, sent: &[Vec<f64>; 3], stuck: Option<[usize; 2]>, as_plan: bool) {
    let came = [0, 1, 2].map(|joint| moved(&sent[joint], stuck.filter(|_| joint == 0)));
    let mut text = String::from("t_s");
    for joint in JOINTS {
        let command = if as_plan { String::new() } else { format!(",command_{joint}_deg") };
        write!(text, ",planned_{joint}_deg{command},measured_{joint}_deg").unwrap();
    }
    for k in 0..sent[0].len() {
        let t = 0.01 * k as f64;
        write!(text, "\n{t:.2}").unwrap();
        for joint in 0..3 {
            if as_plan {
                write!(text, ",{:.5}", sent[joint][k]).unwrap();
            } else {
                write!(text, ",{:.5},{:.5}", plan(joint, t), sent[joint][k]).unwrap();
            }
            write!(text, ",{:.5}", came[joint][k]).unwrap();
        }
    }
    fs::write(folder.join(name), text + "\n").unwrap();
}

fn plain() -> [Vec<f64>; 3] {
    [0, 1, 2].map(|joint| (0..ROWS).map(|k| plan(joint, 0.01 * f64::from(k))).collect())
}

/// What a log of `replan` has as its command, on the clock of the plan.
fn commanded(folder: &Path, log: &str) -> [Vec<f64>; 3] {
    let (code, text, error) = said(&hydrotrace(folder, &format!("export {log} --csv --degrees")));
    assert!(code == 0 || code == 3, "{error}");
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()).collect();
    let column =
        |name: &str| header.iter().position(|own| *own == name).unwrap_or_else(|| panic!("{header:?}"));
    // It begins when it does.
    let planned = column("boom_planned_deg");
    let moves = |values: &[f64]| values.iter().position(|deg| deg.abs() > 0.5).unwrap();
    let own: Vec<f64> = rows.iter().map(|row| row[planned]).collect();
    let ahead = moves(&plain()[0]) - moves(&own);
    JOINTS.map(|joint| {
        let own = column(&format!("{joint}_command_deg"));
        let at = |k: usize| rows[k.saturating_sub(ahead).min(rows.len() - 1)][own];
        (0..ROWS as usize).map(at).collect()
    })
}

fn replanned(folder: &Path, line: &str) -> Value {
    let (code, text, error) = said(&hydrotrace(folder, &format!("{line} --json")));
    assert!(code == 0 || code == 3, "{line}: {error}");
    serde_json::from_str(&text).unwrap()
}

#[test]
fn a_run_in_which_one_joint_stuck_through_a_motion_teaches_nothing_and_ends_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "run-1.csv", &plain(), None, false);
    let first = replanned(folder, "replan run-1.csv --keep-plan -o next-2.mcap");
    let sent = commanded(folder, "next-2.mcap");
    write(folder, "run-2.csv", &sent, Some([780, 1300]), false);
    let stuck = replanned(folder, "replan run-1.csv run-2.csv --keep-plan -o next-3.mcap");
    let remarks = stuck["remarks"].to_string();
    assert!(remarks.contains("boom hardly moves through its motion from 8."), "{remarks}");
    assert_eq!(stuck["runs"].as_array().map(Vec::len), Some(1), "{:#}", stuck["runs"]);
    let mean = |of: &Value| of["after"]["mean_peak_rad"].as_f64().unwrap();
    assert!((mean(&stuck) / mean(&first) - 1.0).abs() < 0.1, "{} {}", mean(&stuck), mean(&first));
    write(folder, "run-3.csv", &commanded(folder, "next-3.mcap"), None, false);
    let next = replanned(folder, "replan run-1.csv run-2.csv run-3.csv --keep-plan -o next-4.mcap");
    let [plain, helped] = [0, 1].map(|run| next["runs"][run]["mean_peak_rad"].as_f64().unwrap());
    assert!(helped < 0.3 * plain, "{plain} {helped}");
}

#[test]
fn what_was_sent_in_place_of_a_plan_is_no_new_plan() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "run-1.csv", &plain(), None, true);
    replanned(folder, "replan run-1.csv --keep-plan -o next-2.mcap");
    write(folder, "run-2.csv", &commanded(folder, "next-2.mcap"), None, true);
    let (code, _, error) = said(&hydrotrace(folder, "replan run-1.csv run-2.csv --keep-plan -o next-3.mcap"));
    assert!(
        code == 1 && error.contains("is that of run-1.csv and a correction of what that run was off by"),
        "{error}"
    );
    assert!(!folder.join("next-3.mcap").exists());
    // Alone it may be a plan of its own.
    replanned(folder, "replan run-2.csv --keep-plan -o alone.mcap");
}
