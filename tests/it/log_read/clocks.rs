//! Which clock, and what its faults cost.

use hydrotrace::log::TimeBase;

use super::{encode, file::Channel, *};

/// Measured stamps as given, logged 40 ms after they should have been taken; published after 10.
fn log_of(header_ns: impl Fn(i64) -> i64) -> Log {
    let mut log = Log::default();
    for (topic, values) in
        [("/planned/joint_states", plan as fn(i64) -> Vec<f64>), ("/joint_states", measurement)]
    {
        log.add(Channel::states(topic), 0..SAMPLES, |k| {
            let stamp_ns = if topic == "/joint_states" { header_ns(k) } else { stamp(k) };
            encode::joint_state(cdr::Kind::LittleEndian, stamp_ns, &NAMES, &values(k), &[])
        });
    }
    for message in &mut log.messages {
        message.log_ns += 40_000_000;
        message.publish_ns += 10_000_000;
    }
    log
}

#[test]
fn the_header_is_used_where_it_moves_and_the_delay_is_said() {
    let recording = read(&log_of(stamp));
    assert_eq!(recording.source.time_base, TimeBase::Header);
    assert_eq!(recording.source.epoch_ns, START_NS);
    assert_eq!(recording.source.recorder_delay_s, Some([0.04, 0.04]));
    assert!((recording.source.duration_s - 0.98).abs() < 1e-9);
    assert_values(&recording.measured, measurement);
}

#[test]
fn each_clock_can_be_asked_for() {
    for (base, after_ns) in
        [(TimeBase::Header, 0), (TimeBase::Publish, 10_000_000), (TimeBase::Log, 40_000_000)]
    {
        let recording =
            read_with(&log_of(stamp), &ReadOptions { time_base: Some(base), ..ReadOptions::default() });
        assert_eq!((recording.source.time_base, recording.source.epoch_ns), (base, START_NS + after_ns));
        assert_values(&recording.measured, measurement);
    }
}

#[test]
fn zero_or_constant_stamps_are_replaced_by_the_publish_time_and_said() {
    for header_ns in [0, stamp(3)] {
        let recording = read(&log_of(|_| header_ns));
        assert_eq!(recording.source.time_base, TimeBase::Publish);
        assert_eq!(codes(&recording.remarks), [Code::UnusableStamp]);
        assert_values(&recording.measured, measurement);
        let asked = ReadOptions { time_base: Some(TimeBase::Header), ..ReadOptions::default() };
        assert_eq!(
            error(&log_of(|_| header_ns), &asked),
            "the header time of topic \"/joint_states\" is zero or stands still; try --time log or leave it out"
        );
    }
}

#[test]
fn without_publish_times_the_log_time_is_used() {
    let mut log = log_of(|_| 0);
    log.messages.iter_mut().for_each(|message| message.publish_ns = 0);
    assert_eq!(read(&log).source.time_base, TimeBase::Log);
}

#[test]
fn a_few_messages_without_a_stamp_are_left_out() {
    let recording = read(&log_of(|k| if k == 5 || k == 9 { 0 } else { stamp(k) }));
    assert_eq!(recording.measured.tracks[0].len(), 48);
    assert_eq!(count(&recording.remarks, Code::UnusableStamp), 2);
    assert_eq!(recording.source.epoch_ns, START_NS);
}

#[test]
fn repeated_stamps_are_dropped_and_counted() {
    let recording = read(&log_of(|k| if k % 10 == 3 { stamp(k - 1) } else { stamp(k) }));
    assert_eq!(count(&recording.remarks, Code::DuplicateStamp), 5);
    let track = &recording.measured.tracks[0];
    assert_eq!(
        (track.len(), track.position()[2], track.position()[3]),
        (45, measurement(2)[0], measurement(4)[0])
    );
}

#[test]
fn late_samples_are_put_in_their_place() {
    let recording = read(&log_of(|k| match k {
        10 => stamp(11),
        11 => stamp(10),
        k => stamp(k),
    }));
    assert_eq!(count(&recording.remarks, Code::Reordered), 1);
    assert_eq!(recording.measured.tracks[0].position()[10], measurement(11)[0]);
}

#[test]
fn a_backward_jump_splits_the_run_and_goes_on_by_the_recorders_clock() {
    let recording = read(&log_of(|k| if k < 25 { stamp(k) } else { stamp(k) - 5_000_000_000 }));
    assert_eq!(count(&recording.remarks, Code::ClockJump), 1);
    let track = &recording.measured.tracks[0];
    assert_eq!(track.segments(), [0..25, 25..50]);
    assert!((track.t_s()[49] - 0.98).abs() < 1e-9);
    assert_eq!(count(&recording.remarks, Code::Gap), 0);
}

#[test]
fn a_gap_splits_the_run_and_is_counted_once_a_topic() {
    let mut log = log_of(|k| if k < 25 { stamp(k) } else { stamp(k) + 2_000_000_000 });
    for message in log.messages.iter_mut().filter(|message| message.channel == 1).skip(25) {
        message.log_ns += 2_000_000_000;
    }
    let recording = read(&log);
    let gaps: Vec<_> = recording.remarks.as_slice().iter().filter(|r| r.code == Code::Gap).collect();
    assert_eq!((gaps.len(), gaps[0].count), (1, 1));
    assert!(gaps[0].message.contains("the longest 2.02 s after 0.48 s"), "{gaps:?}");
    assert_eq!(recording.measured.tracks[0].segments(), [0..25, 25..50]);
}

#[test]
fn a_jump_is_no_gap_for_a_joint_that_misses_samples_before_it() {
    let mut log = log_of(|k| if k < 25 { stamp(k) } else { stamp(k) - 5_000_000_000 });
    // Joint b is absent from the first ten messages; the recorder pauses at the jump.
    let (mut k, mut pause_ns) = (0, 0);
    for message in log.messages.iter_mut().filter(|message| message.channel == 1) {
        pause_ns = if k < 25 { 0 } else { 3_000_000_000 };
        message.log_ns += pause_ns;
        let stamp_ns = if k < 25 { stamp(k) } else { stamp(k) - 5_000_000_000 };
        if k < 10 {
            message.data =
                encode::joint_state(cdr::Kind::LittleEndian, stamp_ns, &["a"], &measurement(k)[..1], &[]);
        }
        k += 1;
    }
    assert!(pause_ns > 0);
    let recording = read(&log);
    assert_eq!(count(&recording.remarks, Code::ClockJump), 1);
    assert_eq!(count(&recording.remarks, Code::Gap), 0, "{:?}", recording.remarks);
}

#[test]
fn stamps_from_before_the_clock_was_set_cost_no_other_sample() {
    // Five seconds after boot, then by network time, with two stamps too close for f64 to tell.
    let recording = read(&log_of(|k| match k {
        0 => 5_000_000_000,
        20 => stamp(19) + 1,
        k => stamp(k),
    }));
    let track = recording.measured.track("a").expect("a joint was lost");
    assert!(track.len() >= 49, "{}", track.len());
}

#[test]
fn the_farthest_stamps_are_still_times() {
    let far = |k: i64| {
        if k < 25 { i64::from(i32::MAX) * 1_000_000_000 + k } else { i64::from(i32::MIN) * 1_000_000_000 + k }
    };
    let recording = read(&log_of(far));
    assert_eq!(recording.measured.tracks.len(), 2, "{:?}", recording.remarks);
    let mut log = log_of(stamp);
    for (k, message) in log.messages.iter_mut().enumerate() {
        message.log_ns = if k % 2 == 0 { u64::MAX } else { 0 };
    }
    let _ = read_bytes(
        &log.bytes(mcap::WriteOptions::new()),
        &ReadOptions { time_base: Some(TimeBase::Log), ..ReadOptions::default() },
    );
}
