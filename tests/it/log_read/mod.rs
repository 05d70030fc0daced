//! What the reader makes of logs of every kind, sound and broken.

mod alike;
mod behind;
mod by_words;
mod cdr;
mod choice;
mod clocks;
mod conformance;
mod containers;
mod controller;
mod damage;
mod definitions;
mod determinism;
mod doubts;
mod encode;
mod failing;
mod file;
mod forms;
mod index;
mod json;
mod layout;
mod limits;
mod matrix;
mod mutations;
mod poses;
mod protobuf;
mod range;
mod schema;
mod topics;
mod trajectories;
mod transforms;

use std::{ops::Range, path::PathBuf};

use hydrotrace::{
    log::{LogError, ReadOptions, Recording, Selector, Survey},
    remark::{Code, Remarks},
    series::Series,
};

use file::{Channel, Log, store};

/// The joints of most tests.
const NAMES: [&str; 2] = ["a", "b"];
const START_NS: i64 = 1_700_000_000_000_000_000;
const STEP_NS: i64 = 20_000_000;
const SAMPLES: i64 = 50;

fn stamp(k: i64) -> i64 {
    START_NS + k * STEP_NS
}

/// Where the joints should be, rad.
fn plan(k: i64) -> Vec<f64> {
    vec![0.01 * k as f64, 1.0 - 0.02 * k as f64]
}

/// Where they are, rad.
fn measurement(k: i64) -> Vec<f64> {
    plan(k).iter().map(|q| q - 0.005).collect()
}

fn read_bytes(bytes: &[u8], options: &ReadOptions) -> Result<Recording, LogError> {
    let stored = store(&[("run.mcap", bytes)]);
    hydrotrace::log::read_recording(&stored.paths, options)
}

fn survey_bytes(bytes: &[u8]) -> Survey {
    let stored = store(&[("run.mcap", bytes)]);
    hydrotrace::log::survey(&stored.paths, &ReadOptions::default()).unwrap()
}

fn options(planned: &[&str], measured: &[&str], joints: &[&str]) -> ReadOptions {
    let selectors = |list: &[&str]| list.iter().map(|text| Selector::parse(text)).collect();
    ReadOptions {
        planned: selectors(planned),
        measured: selectors(measured),
        joints: joints.iter().map(|&name| name.to_owned()).collect(),
        ..ReadOptions::default()
    }
}

/// The log as the crate `mcap` writes it, read.
fn read(log: &Log) -> Recording {
    read_with(log, &ReadOptions::default())
}

fn read_with(log: &Log, options: &ReadOptions) -> Recording {
    read_bytes(&log.bytes(mcap::WriteOptions::new()), options).unwrap()
}

fn error(log: &Log, options: &ReadOptions) -> String {
    read_bytes(&log.bytes(mcap::WriteOptions::new()), options).unwrap_err().to_string()
}

fn joints(series: &Series) -> Vec<&str> {
    series.tracks.iter().map(hydrotrace::series::Track::name).collect()
}

/// How many cases of a doubt, over all remarks of its kind.
fn count(remarks: &Remarks, code: Code) -> u64 {
    remarks.as_slice().iter().filter(|remark| remark.code == code).map(|remark| remark.count).sum()
}

fn codes(remarks: &Remarks) -> Vec<Code> {
    remarks.as_slice().iter().map(|remark| remark.code).collect()
}

/// Each joint holds `values(k)` at its stamp.
#[track_caller]
fn assert_values(series: &Series, values: impl Fn(i64) -> Vec<f64>) {
    assert_eq!(joints(series), NAMES);
    for (j, track) in series.tracks.iter().enumerate() {
        assert_eq!(track.len() as i64, SAMPLES, "samples of {}", track.name());
        for (k, (&t_s, &q)) in track.t_s().iter().zip(track.position()).enumerate() {
            assert!((t_s - k as f64 * 0.02).abs() < 1e-9, "sample {k} at {t_s} s");
            assert_eq!(q, values(k as i64)[j], "sample {k} of {}", track.name());
        }
    }
}

impl Channel {
    /// A topic of `JointState`.
    fn states(topic: &str) -> Self {
        Self::cdr(topic, "sensor_msgs/msg/JointState")
    }

    fn json(topic: &str, type_name: &str) -> Self {
        Self::cdr(topic, type_name).with_schema("jsonschema", "{}").encoded("json")
    }
}

impl Log {
    /// Of the usual plan; a measurement is to come.
    fn of_plan() -> Self {
        let mut log = Self::default();
        add_joint_state(&mut log, "/planned/joint_states", plan);
        log
    }

    /// Adds a topic that says something at the stamp of each sample.
    fn add(&mut self, channel: Channel, samples: Range<i64>, message: impl Fn(i64) -> Vec<u8>) {
        let channel = self.channel(channel);
        samples.for_each(|k| self.send(channel, stamp(k), message(k)));
    }
}

/// A `JointState` of a sample.
fn states(k: i64, names: &[&str], position: &[f64]) -> Vec<u8> {
    encode::joint_state(cdr::Kind::LittleEndian, stamp(k), names, position, &[])
}

/// The usual plan and measurement.
#[track_caller]
fn assert_usual(recording: &Recording) {
    assert_values(&recording.planned, plan);
    assert_values(&recording.measured, measurement);
}

/// Adds a `JointState` topic of all samples.
fn add_joint_state(log: &mut Log, topic: &str, values: impl Fn(i64) -> Vec<f64>) {
    log.add(Channel::states(topic), 0..SAMPLES, |k| states(k, &NAMES, &values(k)));
}

/// A log of a plan and a measurement, both `JointState`.
fn plain_log() -> Log {
    let mut log = Log::of_plan();
    add_joint_state(&mut log, "/joint_states", measurement);
    log.messages.sort_by_key(|message| message.log_ns);
    log
}

fn path(text: &str) -> PathBuf {
    PathBuf::from(text)
}
