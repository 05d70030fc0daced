//! `join` as an operator meets it: the machine ran the command of `replan`, and its recorder knows no plan.

use std::{
    fs::File,
    io::BufWriter,
    path::{Path, PathBuf},
    sync::LazyLock,
};

use hydrotrace::{
    log::{
        ControllerState, LogWriter, Point, ReadOptions, Recording, Role, Selector, Topics, WriteOptions,
        read_plan, read_recording, survey,
    },
    series::{Series, Track},
};
use serde_json::Value;

use crate::support::{clean as done, hold_to_schema, run_line as hydrotrace, sample, stderr};

fn json(folder: &Path, line: &str) -> Value {
    serde_json::from_str(&done(folder, &format!("{line} --json"))).unwrap()
}

/// The plan and command for a next run, `next.mcap`, and that run with everything in its log, `whole.mcap`.
static RUNS: LazyLock<tempfile::TempDir> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::copy(sample("tasks/task-1.toml"), at.join("task-1.toml")).unwrap();
    done(at, "plan task-1.toml --times 0,4.49,8.09,12.39,18.79,21.85 -o plan.mcap");
    done(at, "simulate plan.mcap -o run.mcap");
    done(at, "replan run.mcap --evaluations 1000 -o next.mcap");
    done(at, "simulate next.mcap --seed 2 -o whole.mcap");
    folder
});

/// When the recorder of the field logs started, ns, and how much later than that the run did, s.
const START_NS: i64 = 1_790_000_000_000_000_000;
const LATER_S: f64 = 47.3;

#[expect(clippy::cast_possible_truncation, reason = "within a century")]
fn ns(t_s: f64) -> i64 {
    (t_s * 1e9).round() as i64
}

fn whole() -> (Recording, Series) {
    let paths = [RUNS.path().join("whole.mcap")];
    let run = read_recording(&paths, &ReadOptions::default()).unwrap();
    let topic = Selector::parse("/command/joint_states");
    let sent = read_plan(&paths, &ReadOptions { planned: vec![topic], ..ReadOptions::default() }).unwrap();
    (run, sent.planned)
}

fn angles(series: &Series, t_s: f64) -> Vec<f64> {
    series.tracks.iter().map(|track| track.held_at(t_s).position).collect()
}

/// A point of a controller's state.
fn point(position_rad: &[f64]) -> Point<'_> {
    let none: &[f64] = &[];
    Point {
        position_rad,
        velocity_rad_s: none,
        acceleration_rad_s2: none,
        effort_n_m: none,
        time_from_start_ns: 0,
    }
}

fn state<'a>(reference: &'a [f64], feedback: &'a [f64]) -> ControllerState<'a> {
    ControllerState {
        reference: point(reference),
        feedback: point(feedback),
        output: point(&[]),
        speed_scaling_factor: 1.0,
    }
}

/// What a recorder of the controller's state has of the run: what was sent, as its reference, times a gain
/// about the rest, and what was measured, each time in `later_s` the run.
fn field(folder: &Path, name: &str, later_s: &[f64], gain: f64) -> PathBuf {
    let (run, sent) = whole();
    let names: Vec<&str> = sent.tracks.iter().map(Track::name).collect();
    let path = folder.join(name);
    let output = BufWriter::new(File::create(&path).unwrap());
    let options = WriteOptions { log_delay_ns: ns(0.004), ..WriteOptions::default() };
    let mut log = LogWriter::new(output, &names, options).unwrap();
    let stamps = run.measured.tracks[0].t_s();
    let mut from_s = 0.0;
    for &later_s in later_s {
        let mut t_s = from_s;
        // Not once more at that very instant, by rounding.
        while t_s < later_s - 1e-6 {
            let still = angles(&sent, 0.0);
            log.controller_state(START_NS + ns(t_s), &state(&still, &still)).unwrap();
            t_s += 0.02;
        }
        for &t_s in stamps {
            let rest = angles(&sent, 0.0);
            let reference: Vec<f64> =
                angles(&sent, t_s).iter().zip(&rest).map(|(q, rest)| rest + gain * (q - rest)).collect();
            let feedback = angles(&run.measured, t_s);
            log.controller_state(START_NS + ns(later_s + t_s), &state(&reference, &feedback)).unwrap();
        }
        from_s = later_s + stamps.last().unwrap() + 0.02;
    }
    log.finish().unwrap();
    path
}

fn peaks_deg(report: &Value) -> Vec<(String, f64)> {
    let transitions = report["transitions"].as_array().unwrap().iter();
    let mut peaks: Vec<(String, f64)> = transitions
        .map(|t| {
            let peak = t["peak_error"].as_f64().unwrap().to_degrees();
            (t["joint"].as_str().unwrap().to_owned(), peak)
        })
        .collect();
    peaks.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    peaks
}

#[test]
fn a_joined_log_reports_fits_and_compares_as_one_that_always_had_its_plan() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    field(at, "field.mcap", &[LATER_S], 1.0);
    let next = RUNS.path().join("next.mcap");
    let said = json(at, &format!("join field.mcap --plan {} -o run-2.mcap", next.display()));
    hold_to_schema(&said, "join.v1");
    assert_eq!(said["sent_is_command"], true);
    // The plan's log starts where the machine has stood for two seconds.
    assert!((said["at_s"].as_f64().unwrap() - (LATER_S + 2.0)).abs() < 2e-3, "{said}");
    let whole = json(RUNS.path(), "report whole.mcap");
    let joined = json(at, "report run-2.mcap");
    assert_eq!(joined["source"]["planned_topic"], "/planned/joint_states");
    let (expected, found) = (peaks_deg(&whole), peaks_deg(&joined));
    assert_eq!(expected.len(), found.len());
    for (expected, found) in expected.iter().zip(&found) {
        assert!(expected.0 == found.0 && (expected.1 - found.1).abs() < 0.01, "{expected:?} {found:?}");
    }
    // Without its plan the log says how the command was followed, which is another question.
    let alone = json(at, "report field.mcap");
    let mean = |peaks: &[(String, f64)]| peaks.iter().map(|p| p.1).sum::<f64>() / peaks.len() as f64;
    assert!(mean(&peaks_deg(&alone)) > 2.0 * mean(&found));
    // Task and timing came along: runs of other timings are compared, the next run is planned.
    let before = RUNS.path().join("run.mcap");
    let compared = |folder: &Path, after: &str| -> Value {
        let run = hydrotrace(folder, &format!("compare {} {after} --json", before.display()));
        let compared: Value = serde_json::from_slice(&run.stdout).unwrap();
        // A start that the other timing does not have is left out, and said to be.
        let remarks = compared["remarks"].as_array().unwrap();
        assert!(remarks.iter().all(|remark| remark["code"] == "unmatched"), "{remarks:?}");
        compared
    };
    let (joined, always) = (compared(at, "run-2.mcap"), compared(RUNS.path(), "whole.mcap"));
    for part in ["same_plan", "verdict"] {
        assert_eq!(joined[part], always[part], "{part}");
    }
    let pairs = |document: &Value| document["pairs"].as_array().unwrap().len();
    assert_eq!(pairs(&joined), pairs(&always));
    assert!(pairs(&joined) >= found.len() - 2);
    done(at, "replan run-2.mcap --evaluations 1000 -o next-2.mcap");
    // Smooth starts leave the lag open: what the one log gives lies within the interval of the other.
    let lags = |path: &Path, key: &str| -> Vec<Value> {
        let fit = json(at, &format!("fit {}", path.display()));
        fit["joints"].as_array().unwrap().iter().map(|joint| joint["lag_s"][key].clone()).collect()
    };
    let intervals = lags(&RUNS.path().join("whole.mcap"), "interval");
    let found = lags(&at.join("run-2.mcap"), "value");
    assert_eq!((intervals.len(), found.len()), (6, 6));
    for (interval, found) in intervals.iter().zip(&found).filter(|(interval, _)| !interval.is_null()) {
        let [low, high] = [0, 1].map(|k| interval[k].as_f64().unwrap());
        assert!((low..=high).contains(&found.as_f64().unwrap()), "{interval} {found}");
    }
}

/// A recorder's log in which what was sent has a topic as a plan would.
fn referenced(path: &Path, topic: &str, sent: &Series, run: &Recording) {
    let names: Vec<&str> = sent.tracks.iter().map(Track::name).collect();
    let topics = Topics { planned: topic.to_owned(), ..Topics::default() };
    let options = WriteOptions { topics, ..WriteOptions::default() };
    let mut log = LogWriter::new(BufWriter::new(File::create(path).unwrap()), &names, options).unwrap();
    for &t_s in run.measured.tracks[0].t_s() {
        let stamp_ns = START_NS + ns(t_s);
        // Twice as often as the plan will stand there.
        for t_s in [t_s, t_s + 0.005] {
            log.joint_sample(Role::Planned, START_NS + ns(t_s), &angles(sent, t_s), &[], &[]).unwrap();
        }
        log.joint_sample(Role::Measured, stamp_ns, &angles(&run.measured, t_s), &[], &[]).unwrap();
    }
    log.finish().unwrap();
}

#[test]
fn what_was_sent_is_no_plan_once_the_plan_stands_beside_it_and_one_line_reads_both_logs() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    // The first run is sent its plan, the second its command, on one topic.
    let first = read_recording(&[RUNS.path().join("run.mcap")], &ReadOptions::default()).unwrap();
    referenced(&at.join("first.mcap"), "/ref/joint_states", &first.planned, &first);
    let (run, sent) = whole();
    referenced(&at.join("second.mcap"), "/ref/joint_states", &sent, &run);
    let next = RUNS.path().join("next.mcap");
    let said = json(at, &format!("join second.mcap --plan {} -o after.mcap", next.display()));
    assert_eq!(
        (&said["sent"], &said["sent_is_command"]),
        (&"/ref/joint_states:position".into(), &true.into())
    );
    let expected = peaks_deg(&json(RUNS.path(), "report whole.mcap"));
    for named in ["", "--planned /ref/joint_states", "--planned /ref/joint_states:position"] {
        let report = json(at, &format!("report after.mcap {named}"));
        assert_eq!(report["source"]["planned_topic"], "/planned/joint_states", "{named}");
        for (expected, found) in expected.iter().zip(&peaks_deg(&report)) {
            assert!(expected.0 == found.0 && (expected.1 - found.1).abs() < 0.01, "{expected:?} {found:?}");
        }
        let why = report["source"]["why"].as_str().unwrap().to_owned();
        assert_eq!(why.contains("joined for what was sent on /ref/joint_states"), !named.is_empty(), "{why}");
    }
    // The lines that `replan` prints name the topic for both logs.
    let line = "first.mcap after.mcap --planned /ref/joint_states --json";
    let compared: Value = serde_json::from_slice(&hydrotrace(at, &format!("compare {line}")).stdout).unwrap();
    let topics = ["before", "after"].map(|side| compared[side][0]["source"]["planned_topic"].clone());
    assert_eq!(topics, ["/ref/joint_states", "/planned/joint_states"]);
}

#[test]
fn the_controller_of_the_first_log_takes_the_trajectory_of_every_later_one() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let run = read_recording(&[RUNS.path().join("run.mcap")], &ReadOptions::default()).unwrap();
    referenced(&at.join("first.mcap"), "/desired/joint_trajectory", &run.planned, &run);
    let mut last = "first.mcap".to_owned();
    for round in 1..=3 {
        let (next, after) = (format!("next-{round}.mcap"), format!("after-{round}.mcap"));
        done(at, &format!("replan {last} --evaluations 1000 -o {next}"));
        let topics = survey(&[at.join(&next)], &ReadOptions::default()).unwrap().topics;
        assert!(topics.iter().any(|topic| topic.topic == "/desired/joint_trajectory"), "{round}: {topics:?}");
        let joined = hydrotrace(at, &format!("join first.mcap --plan {next} -o {after}"));
        assert!(matches!(joined.status.code(), Some(0 | 3)), "{round}: {}", stderr(&joined));
        last = after;
    }
}

/// What a join that must fail says; it writes nothing.
fn refused(folder: &Path, line: &str) -> String {
    let run = hydrotrace(folder, &format!("{line} -o joined.mcap"));
    assert_eq!(run.status.code(), Some(1), "{line}");
    assert!(!folder.join("joined.mcap").exists(), "{line}");
    stderr(&run)
}

#[test]
fn what_was_not_sent_is_refused_with_how_far_it_is_off() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    field(at, "other.mcap", &[LATER_S], 0.5);
    let next = format!("--plan {}", RUNS.path().join("next.mcap").display());
    let said = refused(at, &format!("join other.mcap {next}"));
    assert!(said.contains("% of the motion") && said.contains("--planned"), "{said}");
    let own = format!("--plan {}", RUNS.path().join("plan.mcap").display());
    let said = refused(at, &format!("join {} {own}", RUNS.path().join("run.mcap").display()));
    assert!(said.contains("/planned/joint_states already"), "{said}");
    let said = refused(at, &format!("join other.mcap {next} --at 500"));
    assert!(said.contains("outside the measurement"), "{said}");
    let names: Vec<String> = whole().1.tracks.iter().map(|track| track.name().to_owned()).collect();
    let output = BufWriter::new(File::create(at.join("endless.mcap")).unwrap());
    let mut log = LogWriter::new(output, &names, WriteOptions::default()).unwrap();
    for t_s in [0.0, 1e6] {
        let angles = vec![t_s / 1e6; names.len()];
        log.joint_sample(Role::Planned, START_NS + ns(t_s), &angles, &[], &[]).unwrap();
    }
    log.finish().unwrap();
    let said = refused(at, "join other.mcap --plan endless.mcap --at 1");
    assert!(said.contains("lasts 1000000 s"), "{said}");
    std::fs::copy(RUNS.path().join("next.mcap"), at.join("next.mcap")).unwrap();
    let over = hydrotrace(at, "join other.mcap --plan next.mcap -o next.mcap");
    assert_eq!(over.status.code(), Some(1));
}

#[test]
fn of_two_runs_in_one_log_the_first_is_taken_with_a_remark_and_a_time_names_the_other() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    field(at, "twice.mcap", &[LATER_S, 120.0], 1.0);
    let next = format!("--plan {}", RUNS.path().join("next.mcap").display());
    let run = hydrotrace(at, &format!("join twice.mcap {next} -o first.mcap --json"));
    assert_eq!(run.status.code(), Some(3));
    let said: Value = serde_json::from_slice(&run.stdout).unwrap();
    assert_eq!(said["other_places"], 1);
    assert!(said["remarks"].to_string().contains("\"ambiguous\""), "{}", said["remarks"]);
    assert!((said["at_s"].as_f64().unwrap() - LATER_S - 2.0).abs() < 2e-3);
    // That the first run ends elsewhere than the second begins is a jump of what was sent, and a remark.
    let run = hydrotrace(at, &format!("join twice.mcap {next} --at 122 -o second.mcap --json"));
    assert!(matches!(run.status.code(), Some(0 | 3)), "{}", stderr(&run));
    let said: Value = serde_json::from_slice(&run.stdout).unwrap();
    assert_eq!(said["at_s"], 122.0);
    // Most of the log has no plan, which is a remark.
    let peaks = |log: &str| {
        let run = hydrotrace(at, &format!("report {log} --json"));
        assert_eq!((run.status.code(), stderr(&run).lines().count()), (Some(3), 1), "{}", stderr(&run));
        peaks_deg(&serde_json::from_slice(&run.stdout).unwrap())
    };
    for (first, second) in peaks("first.mcap").iter().zip(&peaks("second.mcap")) {
        assert!(first.0 == second.0 && (first.1 - second.1).abs() < 0.02, "{first:?} {second:?}");
    }
}

#[test]
fn a_log_of_the_measurement_alone_asks_for_the_time_and_does_with_it() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let (run, sent) = whole();
    let names: Vec<&str> = sent.tracks.iter().map(Track::name).collect();
    let output = BufWriter::new(File::create(at.join("bare.mcap")).unwrap());
    let mut log = LogWriter::new(output, &names, WriteOptions::default()).unwrap();
    for &t_s in run.measured.tracks[0].t_s() {
        log.joint_sample(Role::Measured, START_NS + ns(t_s), &angles(&run.measured, t_s), &[], &[]).unwrap();
    }
    log.finish().unwrap();
    let next = format!("--plan {}", RUNS.path().join("next.mcap").display());
    let said = refused(at, &format!("join bare.mcap {next}"));
    assert!(said.contains("--at SECONDS") && said.contains("/joint_states"), "{said}");
    let said = json(at, &format!("join bare.mcap {next} --at 2 -o joined.mcap"));
    assert_eq!((&said["sent"], &said["sent_is_command"]), (&Value::Null, &Value::Bool(true)));
    let (expected, found) = (json(RUNS.path(), "report whole.mcap"), json(at, "report joined.mcap"));
    for (expected, found) in peaks_deg(&expected).iter().zip(&peaks_deg(&found)) {
        assert!(expected.0 == found.0 && (expected.1 - found.1).abs() < 0.01, "{expected:?} {found:?}");
    }
}

#[test]
fn a_recorder_whose_clock_runs_apart_is_told_by_what_was_sent() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for name in ["whole.mcap", "next.mcap"] {
        std::fs::copy(RUNS.path().join(name), at.join(name)).unwrap();
    }
    done(at, "export whole.mcap --csv --planned /command/joint_states -o whole.csv");
    let text = std::fs::read_to_string(at.join("whole.csv")).unwrap();
    for (name, pace, says) in [
        ("right", 1.0, None),
        ("fast", 1.005, Some("lasts 0.50 % longer than in next.mcap")),
        ("slow", 0.98, Some("multiply the times of the recording by 1.0204")),
    ] {
        let (head, rows) = text.split_once('\n').unwrap();
        let paced = |row: &str| {
            let (t_s, rest) = row.split_once(',').unwrap();
            format!("{:.6},{rest}\n", pace * t_s.parse::<f64>().unwrap())
        };
        let table = head.replace("planned", "command") + "\n" + &rows.lines().map(paced).collect::<String>();
        std::fs::write(at.join(format!("{name}.csv")), table).unwrap();
        hydrotrace(at, &format!("import {name}.csv -o {name}.mcap"));
        let joined = hydrotrace(at, &format!("join {name}.mcap --plan next.mcap -o {name}-run.mcap"));
        let text = String::from_utf8_lossy(&joined.stdout).into_owned();
        assert!(text.contains("the command of next.mcap"), "{text}");
        assert_eq!(joined.status.code(), Some(if says.is_some() { 3 } else { 0 }), "{text}");
        assert!(says.is_none_or(|says| text.contains(says)), "{text}");
    }
}

/// A PLC's table of set value and angle holds the plan, and not what was sent for it.
#[test]
fn a_log_that_holds_its_plan_gets_the_command_that_was_sent_and_its_promise() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for name in ["next.mcap", "whole.mcap", "run.mcap"] {
        std::fs::copy(RUNS.path().join(name), folder.join(name)).unwrap();
    }
    let table = done(folder, "export whole.mcap --csv");
    let header: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let kept = |at: &usize| !header[*at].contains("command");
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        (0..header.len()).filter(kept).map(|at| cells[at]).collect::<Vec<_>>().join(",") + "\n"
    };
    std::fs::write(folder.join("plc.csv"), table.lines().map(row).collect::<String>()).unwrap();
    let said = done(folder, "join plc.csv --plan next.mcap -o after.mcap");
    assert!(said.contains("which holds its plan, and the command of next.mcap written"), "{said}");
    let report = json(folder, "report after.mcap");
    let whole = json(folder, "report whole.mcap");
    for ((name, own), (_, peak_deg)) in peaks_deg(&report).into_iter().zip(peaks_deg(&whole)) {
        assert!((own - peak_deg).abs() < 0.02, "{name}: {own} and {peak_deg} deg");
    }
    assert!(report["promised"].is_object(), "{}", report["promised"]);
    let signals = done(folder, "info after.mcap");
    assert!(signals.contains("/command/joint_states"), "{signals}");
}
