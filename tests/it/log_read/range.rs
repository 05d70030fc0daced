//! A stretch of a run: only its chunks are read, and it is judged as a log that holds nothing else.

use hydrotrace::{
    log::{TimeRange, passes},
    workflow::report::{Inputs, Report, run},
};
use mcap::WriteOptions;

use super::{
    cdr::Kind,
    encode::{Point, joint_state, trajectory},
    file::store,
    *,
};

const RATE_NS: i64 = 10_000_000;
const RUN_S: i64 = 60;

fn at_s(k: i64) -> f64 {
    k as f64 / 100.0
}

/// Moves for 4 s of every 6, from rest to rest, and comes 0.2 s late.
fn moved(t_s: f64) -> f64 {
    let cycle = (t_s / 6.0).floor();
    let part = ((t_s - 6.0 * cycle - 1.0) / 4.0).clamp(0.0, 1.0);
    0.4 * (cycle + part * part * part * (10.0 - 15.0 * part + 6.0 * part * part))
}

/// A run of a minute, or what is received of it within a stretch. The recorder is 0.1 s late.
fn log(stretch: std::ops::RangeInclusive<i64>) -> Log {
    let mut log = Log::default();
    let topics = [("/planned/joint_states", 0.0), ("/joint_states", 0.2)];
    let channels = topics.map(|(topic, _)| log.channel(Channel::cdr(topic, "sensor_msgs/msg/JointState")));
    for k in stretch {
        for (channel, (_, late_s)) in channels.into_iter().zip(topics) {
            let stamp_ns = START_NS + k * RATE_NS;
            let data = joint_state(Kind::LittleEndian, stamp_ns, &["boom"], &[moved(at_s(k) - late_s)], &[]);
            log.send(channel, stamp_ns + 100_000_000, data);
        }
    }
    log
}

fn reported(bytes: &[u8], range: TimeRange) -> (Report, u64) {
    let stored = store(&[("run.mcap", bytes)]);
    let before = passes().blocks;
    let read = ReadOptions { range, ..ReadOptions::default() };
    let report = run(&Inputs { logs: stored.paths.clone(), read, ..Inputs::default() }).unwrap();
    (report, passes().blocks - before)
}

fn chunked() -> WriteOptions {
    // A bit more than a second each.
    WriteOptions::new().compression(None).chunk_size(Some(24_000))
}

#[test]
fn a_stretch_of_a_closed_log_takes_its_own_chunks_and_the_first() {
    let bytes = log(0..=100 * RUN_S).bytes(chunked());
    let (_, all) = reported(&bytes, TimeRange::default());
    let (part, some) = reported(&bytes, TimeRange::of_seconds(Some(30.0), Some(34.0)));
    let one_s = all as f64 / RUN_S as f64;
    // Four seconds, two around them on either side, the chunks at both ends and the first.
    assert!(all > 40 && (some as f64) < 8.0 * one_s + 3.0, "{some} of {all} chunks");
    let track = &part.pairs[0];
    assert_eq!((track.t_s[0], track.t_s[track.t_s.len() - 1]), (30.0, 34.0));
    assert_eq!((part.source.messages, part.source.duration_s), (401, 4.0));
}

#[test]
fn a_stretch_is_reported_as_a_log_that_holds_nothing_else() {
    let whole = log(0..=100 * RUN_S);
    // From rest to rest, out of a motion and into one.
    for [from_s, to_s] in [[12.0, 24.0], [14.0, 28.5], [0.0, 17.0], [50.0, 60.0]] {
        let own = log((100.0 * from_s) as i64..=(100.0 * to_s) as i64).bytes(chunked());
        let (own, _) = reported(&own, TimeRange::default());
        let range = TimeRange::of_seconds(Some(from_s), Some(to_s));
        for (form, bytes) in
            [("indexed", whole.bytes(chunked())), ("not indexed", whole.by_hand("zstd", 100))]
        {
            let (part, _) = reported(&bytes, range);
            let what = format!("{form}, {from_s} to {to_s} s");
            assert_eq!(codes(&part.remarks), codes(&own.remarks), "{what}");
            assert_eq!(
                (part.source.messages, part.pairs[0].matched),
                (own.source.messages, own.pairs[0].matched)
            );
            let starts = |report: &Report, origin_s: f64| -> Vec<[f64; 3]> {
                let all = report.replay.transitions.iter();
                all.map(|t| [t.planned_onset_s - origin_s, t.peak_error, t.rms_error]).collect()
            };
            let (part, own) = (starts(&part, from_s), starts(&own, 0.0));
            assert!(!own.is_empty() && own.len() == part.len(), "{what}: {part:?} {own:?}");
            for (a, b) in part.iter().flatten().zip(own.iter().flatten()) {
                assert!((a - b).abs() < 1e-6, "{what}: {a} and {b}");
            }
            // A motion that the cut begins in is no start.
            assert!(part.iter().all(|start| start[0] > 0.5), "{what}: {part:?}");
        }
    }
}

#[test]
fn a_stretch_without_samples_is_an_error_that_says_what_there_is() {
    let bytes = log(0..=100 * RUN_S).bytes(chunked());
    for (from_s, to_s, said) in [
        (Some(70.0), Some(80.0), "from 70.00 to 80.00 s"),
        (Some(61.0), None, "from 61.00 s on"),
        (Some(9.0), Some(3.0), "from 9.00 to 3.00 s"),
    ] {
        let range = TimeRange::of_seconds(from_s, to_s);
        let error = read_bytes(&bytes, &ReadOptions { range, ..ReadOptions::default() }).unwrap_err();
        let error = error.to_string();
        assert!(error.contains(said) && error.contains("spans 60.00 s"), "{error}");
    }
}

#[test]
fn a_trajectory_that_was_sent_before_the_stretch_is_its_plan() {
    let mut log = log(0..=100 * RUN_S);
    log.messages.retain(|message| message.channel == 1);
    let plan = log.channel(Channel::cdr("/arm/joint_trajectory", "trajectory_msgs/msg/JointTrajectory"));
    let point = |k: i64| Point { since_ns: k * 100_000_000, ..Point::at(&[moved(k as f64 / 10.0)]) };
    let points: Vec<Point> = (0..=600).map(point).collect();
    log.send(plan, START_NS, trajectory(Kind::LittleEndian, START_NS, &["boom"], &points));
    log.messages.sort_by_key(|message| message.log_ns);
    let (part, chunks) = reported(&log.bytes(chunked()), TimeRange::of_seconds(Some(36.0), Some(46.0)));
    assert!(chunks < 40, "{chunks} chunks");
    assert_eq!(part.pairs[0].matched, 1001);
    assert_eq!(part.replay.transitions.len(), 2);
}
