//! Every verb opens, scans and decodes each log once, whatever it wants of it; and a joint that slides
//! is never read as an angle.

use std::path::{Path, PathBuf};

use hydrotrace::{
    log::{
        AngleUnit, LogWriter, Passes, ReadOptions, Role, Selector, SignalRole, WantedSignal, WriteOptions,
        passes, read_recording,
    },
    replay::Rules,
    series::{JointKind, Quantity},
    workflow::{export, fit, join, replan, report, view},
};

/// Stamp of the first sample.
const START_NS: i64 = 1_790_000_000_000_000_000;

fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("sample-logs").join(name)
}

/// What a verb did to the files of logs.
fn counted<T>(verb: impl FnOnce() -> T) -> (Passes, T) {
    let before = passes();
    let made = verb();
    let after = passes();
    let passes = Passes {
        opened: after.opened - before.opened,
        scanned: after.scanned - before.scanned,
        decoded: after.decoded - before.decoded,
        blocks: 0,
    };
    (passes, made)
}

fn each(times: u64) -> Passes {
    Passes { opened: times, scanned: times, decoded: times, blocks: 0 }
}

#[test]
fn each_verb_reads_each_log_once() {
    let logs = vec![sample("task-1-run.mcap")];
    let read = ReadOptions::default;
    let report = || report::run(&report::Inputs { logs: logs.clone(), ..Default::default() });
    assert_eq!(counted(|| report().unwrap()).0, each(1));
    let table = || {
        let (logs, unit) = (logs.clone(), AngleUnit::Radians);
        export::run(&export::Inputs { logs, read: read(), command: None, unit }).unwrap()
    };
    assert_eq!(counted(table).0, each(1));
    let scenes =
        || view::run(&view::Inputs { logs: logs.clone(), rules: Rules::default(), ..Default::default() });
    assert_eq!(counted(|| scenes().unwrap()).0, each(1));
    let pressures = sample("pressures-run.mcap");
    let fitted = || fit::run(&fit::Inputs { logs: vec![pressures.clone()], read: read() }).unwrap();
    let (passes, fitted) = counted(fitted);
    assert_eq!(passes, each(1));
    assert!(fitted.runs[0].valves && !fitted.torques.is_empty());
    let inputs = replan::Inputs { logs: vec![pressures.clone()], keep_plan: true, ..Default::default() };
    let again = || replan::run(&inputs, |_| std::ops::ControlFlow::Continue(())).map(|_| ());
    // Whatever comes of it.
    assert_eq!(counted(again).0, each(1));
}

#[test]
fn a_join_reads_the_run_and_the_plan_once_each() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let write = |name: &str, roles: &[Role]| {
        let mut log = LogWriter::new(Vec::new(), &["a"], WriteOptions::default()).unwrap();
        for k in 0..600 {
            let position = (0.01 * f64::from(k) - 2.0).clamp(0.0, 2.0).sin();
            for role in roles {
                log.joint_sample(
                    *role,
                    1_790_000_000_000_000_000 + i64::from(k) * 10_000_000,
                    &[position],
                    &[],
                    &[],
                )
                .unwrap();
            }
        }
        std::fs::write(path(name), log.finish().unwrap()).unwrap();
    };
    write("plan.mcap", &[Role::Planned]);
    write("run.mcap", &[Role::Command, Role::Measured]);
    let inputs = join::Inputs {
        logs: vec![path("run.mcap")],
        plan: path("plan.mcap"),
        output: path("joined.mcap"),
        ..Default::default()
    };
    let (passes, joined) = counted(|| join::run(&inputs).unwrap());
    assert_eq!((passes, joined.messages), (each(2), 1200));
}

#[test]
fn signals_have_the_quantity_of_their_role() {
    let signals = [
        SignalRole::Command,
        SignalRole::Valve,
        SignalRole::CapPressure,
        SignalRole::SupplyPressure,
        SignalRole::Effort,
    ];
    let signals = signals.map(WantedSignal::usual).to_vec();
    let options = ReadOptions { signals, ..ReadOptions::default() };
    let run = read_recording(&[sample("pressures-run.mcap")], &options).unwrap();
    let joint = run.measured.tracks[0].name();
    let cap = run.signal(SignalRole::CapPressure, joint).unwrap();
    assert_eq!((cap.quantity(), cap.quantity().unit()), (Quantity::Pressure, "Pa"));
    assert!(cap.values().iter().any(|pa| *pa > 1e5));
    let valve = run.signal(SignalRole::Valve, joint).unwrap();
    assert_eq!(valve.quantity(), Quantity::Share);
    assert!(valve.values().iter().all(|share| share.abs() <= 1.0));
    assert_eq!(run.command.as_ref().unwrap().topic, "/command/joint_states");
    // Ours have no efforts; a signal that is named must be there.
    assert!(!run.has(SignalRole::Effort));
    let topic = Some(Selector::parse("/joint_states:effort"));
    let signals = vec![WantedSignal { role: SignalRole::Effort, topic }];
    let named = ReadOptions { signals, ..ReadOptions::default() };
    assert!(read_recording(&[sample("pressures-run.mcap")], &named).is_err());
}

/// A log of one joint that turns and one that slides, as its URDF says.
fn lift(folder: &Path, attached: bool) -> PathBuf {
    let urdf = r#"<robot name="r"><link name="base"/><link name="torso"/><link name="arm"/>
        <joint name="lift" type="prismatic"><parent link="base"/><child link="torso"/></joint>
        <joint name="turn" type="revolute"><parent link="torso"/><child link="arm"/></joint></robot>"#;
    let mut log = LogWriter::new(Vec::new(), &["lift", "turn"], WriteOptions::default()).unwrap();
    if attached {
        log.attach("lift.urdf", "application/xml", urdf.as_bytes(), START_NS).unwrap();
    } else {
        log.description(Role::Measured, START_NS, urdf).unwrap();
    }
    for k in 0..2000 {
        let stamp_ns = START_NS + k * 10_000_000;
        let t_s = k as f64 * 0.01;
        // 20 m of way: as an angle that would be many turns.
        let at = |t_s: f64| [10.0 - 10.0 * (0.3 * t_s).cos(), 0.4 * (t_s * 0.5).sin()];
        log.joint_sample(Role::Planned, stamp_ns, &at(t_s), &[], &[]).unwrap();
        log.joint_sample(Role::Measured, stamp_ns, &at(t_s - 0.2), &[], &[30.0, 40.0]).unwrap();
    }
    let path = folder.join(if attached { "attached.mcap" } else { "message.mcap" });
    std::fs::write(&path, log.finish().unwrap()).unwrap();
    path
}

#[test]
fn a_joint_that_slides_is_a_track_in_metres() {
    let folder = tempfile::tempdir().unwrap();
    for attached in [false, true] {
        let path = lift(folder.path(), attached);
        let effort = vec![WantedSignal::usual(SignalRole::Effort)];
        // Degrees are a unit of joints that turn.
        let options = ReadOptions {
            planned_in_degrees: true,
            measured_in_degrees: true,
            signals: effort,
            ..ReadOptions::default()
        };
        let run = read_recording(std::slice::from_ref(&path), &options).unwrap();
        let lift = run.measured.track("lift").unwrap();
        assert_eq!((lift.kind(), lift.kind().unit()), (JointKind::Slides, "m"));
        assert!(lift.position().iter().any(|m| *m > 19.0));
        let turn = run.measured.track("turn").unwrap();
        assert!(turn.kind() == JointKind::Turns && turn.position().iter().all(|rad| rad.abs() < 0.01));
        let effort = |joint: &str| run.signal(SignalRole::Effort, joint).unwrap().quantity();
        assert_eq!([effort("lift"), effort("turn")], [Quantity::Force, Quantity::Torque]);
        // As an angle it would look like degrees.
        assert!(run.remarks.is_empty(), "{:?}", run.remarks);
        let (logs, read, unit) = (vec![path.clone()], ReadOptions::default(), AngleUnit::Degrees);
        let table = export::run(&export::Inputs { logs, read, command: None, unit }).unwrap().table;
        let columns: Vec<&str> = table.column_names().collect();
        assert!(columns.contains(&"lift_planned_mm") && columns.contains(&"turn_planned_deg"), "{columns:?}");
    }
}
