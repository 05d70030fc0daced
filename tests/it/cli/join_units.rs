//! `join` of a recording in degrees and mm: every line reads what it writes in rad and m, with the options of the recorder's log and without.

use std::fs;

use hydrotrace::{math::smooth_step, units::DEGREE_RAD};

use crate::support::{clean, fleet::log, json, run_line, stdout};

const NAMES: [&str; 2] = ["boom", "stick"];
const UNITS: &str = "--planned-degrees --measured-degrees --slides stick=mm";

/// Numbers of both joints, by joint and instant, as the recorder has them: deg and mm.
fn recorded(t_s: &[f64], of: impl Fn(f64) -> [f64; 2]) -> Vec<Vec<f64>> {
    (0..NAMES.len()).map(|joint| t_s.iter().map(|t_s| of(*t_s)[joint]).collect()).collect()
}

fn plan(t_s: f64) -> [f64; 2] {
    let moved = |from_s: f64| smooth_step((t_s - from_s) / 3.0);
    let strokes = |late_s: f64| moved(2.0 + late_s) - moved(9.0 + late_s) + moved(16.0 + late_s);
    [40.0 * strokes(0.0), 300.0 * strokes(0.5)]
}

#[test]
fn a_recording_in_degrees_and_mm_is_read_in_one_unit_once_its_plan_is_in_it() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let t_s: Vec<f64> = (0..1150).map(|k| 0.02 * f64::from(k)).collect();
    let late = |of: &dyn Fn(f64) -> [f64; 2]| [recorded(&t_s, of), recorded(&t_s, |t_s| of(t_s - 0.15))];
    let [planned, measured] = late(&plan);
    fs::write(at.join("run.mcap"), log("M1", 0, &NAMES, &t_s, [&planned, &measured])).unwrap();
    let lines =
        stdout(&run_line(at, &format!("replan run.mcap --keep-plan --gain 0.5 {UNITS} -o next.mcap")));
    let join = lines.lines().find(|line| line.trim_start().starts_with("hydrotrace join")).unwrap();
    let words: Vec<&str> = UNITS.split(" --").collect();
    assert!(words.iter().all(|word| join.contains(word.trim_start_matches('-'))), "{join}");
    clean(at, "export next.mcap --degrees -o next.csv");
    let text = fs::read_to_string(at.join("next.csv")).unwrap();
    let mut rows = text.lines().map(|line| line.split(',').collect::<Vec<&str>>());
    let head = rows.next().unwrap();
    let column = |name: &str| head.iter().position(|one| *one == name).unwrap();
    let columns = ["time_s", "boom_command_deg", "stick_command_mm"].map(column);
    let sent: Vec<[f64; 3]> = rows.map(|row| columns.map(|at| row[at].parse().unwrap())).collect();
    let command = |t_s: f64| {
        let next = sent.partition_point(|row| row[0] <= t_s - 1.0).clamp(1, sent.len() - 1);
        let (a, b) = (sent[next - 1], sent[next]);
        let part = ((t_s - 1.0 - a[0]) / (b[0] - a[0])).clamp(0.0, 1.0);
        [1, 2].map(|k| a[k] + part * (b[k] - a[k]))
    };
    let [commanded, came] = late(&command);
    fs::write(at.join("RUN.mcap"), log("M1", 1, &NAMES, &t_s, [&commanded, &came])).unwrap();
    let line = join.trim_start().trim_start_matches("hydrotrace ");
    assert_eq!(run_line(at, line).status.code(), Some(0), "{line}");
    let peaks = |line: &str| {
        let report = json(at, line);
        let largest = |joint: &str| {
            let own =
                report["transitions"].as_array().unwrap().iter().filter(|start| start["joint"] == joint);
            own.map(|start| start["peak_error"].as_f64().unwrap()).fold(0.0, f64::max)
        };
        NAMES.map(largest)
    };
    let before = peaks(&format!("report run.mcap {UNITS}"));
    let after = peaks("report after.mcap");
    assert_eq!(after, peaks(&format!("report after.mcap {UNITS}")), "with its options, too");
    assert!(before[0] > 2.0 * DEGREE_RAD && before[1] > 0.015, "{before:?}");
    // Half of the correction.
    assert!(after[0] < 0.6 * before[0] && after[1] < 0.6 * before[1], "{after:?} of {before:?}");
}
