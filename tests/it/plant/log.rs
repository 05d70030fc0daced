//! A run as a log: what goes in comes out, and the report tells plan from command.

use hydrotrace::{
    log::{ReadOptions, WriteOptions, read_recording},
    plant::{Plant, Truth},
    workflow::{
        carried::Carried,
        simulate::{Content, Inputs, Outputs, run},
    },
};

use crate::support::machine::{POSE_DEG, command};

fn outputs() -> Outputs {
    let swing = |lead: f64| {
        command(4.0, |j, t| {
            let since = (t - 1.0 + lead).max(0.0);
            (POSE_DEG[j] + 3.0 * since.sin().powi(2), 3.0 * (2.0 * since).sin())
        })
    };
    let plant = Plant::preset("default").unwrap();
    run(&Inputs { plant, plan: swing(0.0), command: swing(0.2), payload: Vec::new(), seed: 1 }).unwrap()
}

fn log(outputs: &Outputs) -> Vec<u8> {
    outputs.log(&Carried::default(), None, Content::Everything, WriteOptions::default()).unwrap()
}

#[test]
fn plan_and_measurement_read_back_and_the_command_is_neither() {
    let outputs = outputs();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    std::fs::write(&path, log(&outputs)).unwrap();
    let recording = read_recording(&[path], &ReadOptions::default()).unwrap();
    for (j, joint) in outputs.record.joints.iter().enumerate() {
        let measured = recording.measured.track(&joint.name).unwrap();
        assert_eq!(measured.position(), joint.measured_rad);
        let planned = recording.planned.track(&joint.name).unwrap();
        assert!(planned.position().iter().zip(&outputs.planned[j]).all(|(a, b)| *a == b.0));
    }
    assert!(outputs.planned != outputs.command);
    assert!(recording.remarks.is_empty(), "{:?}", recording.remarks);
}

#[test]
fn equal_runs_give_equal_logs_that_hold_the_truth() {
    let outputs = outputs();
    let bytes = log(&outputs);
    assert!(bytes == log(&outputs));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    std::fs::write(&path, bytes).unwrap();
    let recording = read_recording(&[path], &ReadOptions::default()).unwrap();
    assert_eq!(
        serde_json::from_str::<Truth>(&recording.metadata["hydrotrace.plant"]["json"]).unwrap(),
        outputs.truth
    );
}
