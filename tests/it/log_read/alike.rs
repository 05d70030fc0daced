//! Messages laid out as one before them are read without a walk: what is read must be what a walk finds, as where each
//! message stands in a chunk of its own.

use proptest::{collection::vec, prelude::*};

use super::{
    cdr::{Cdr, Kind},
    encode::{Point, controller_state},
    file::Channel,
    *,
};

/// Messages in a row that are laid out alike.
#[derive(Debug, Clone)]
struct Run {
    messages: usize,
    channel: usize,
    kind: Kind,
    names: usize,
    frame: usize,
    positions: usize,
    velocities: usize,
    /// Every so many messages a value is no number.
    not_finite: usize,
    damage: Damage,
}

/// What becomes of the last message of a run.
#[derive(Debug, Clone, Copy)]
enum Damage {
    None,
    Cut(usize),
    Padded(usize),
    Flipped(usize),
}

const LISTS: [&[&str]; 6] = [&["a", "b"], &["b", "a"], &["a", "c"], &["a", "b", "c"], &["a", "a"], &[]];
const BAD: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

fn run() -> impl Strategy<Value = Run> {
    let kind = prop_oneof![
        6 => Just(Kind::LittleEndian),
        1 => Just(Kind::BigEndian),
        1 => Just(Kind::Xcdr2NoSizes),
    ];
    let damage = prop_oneof![
        4 => Just(Damage::None),
        1 => (1..40_usize).prop_map(Damage::Cut),
        1 => (1..12_usize).prop_map(Damage::Padded),
        2 => (0..120_usize).prop_map(Damage::Flipped),
    ];
    let messages = prop_oneof![1..5_usize, 60..200_usize];
    let lengths = (0..LISTS.len(), 0..9_usize, 0..4_usize, 0..4_usize);
    (messages, 0..3_usize, kind, lengths, 1..90_usize, damage).prop_map(
        |(messages, channel, kind, (names, frame, positions, velocities), not_finite, damage)| Run {
            messages,
            channel,
            kind,
            names,
            frame,
            positions,
            velocities,
            not_finite,
            damage,
        },
    )
}

impl Run {
    fn values(&self, k: i64, spare: usize) -> Vec<f64> {
        // Mostly as many as there are names.
        let count = if spare == 0 { 3 } else { LISTS[self.names].len() };
        let value = |j: usize| match k as usize % self.not_finite {
            0 if self.not_finite > 20 && j == 0 => BAD[k as usize % 3],
            _ => (k as f64 * 0.01).sin() + j as f64,
        };
        (0..count).map(value).collect()
    }

    fn message(&self, k: i64) -> Vec<u8> {
        let (names, velocities) = (LISTS[self.names], self.velocities);
        let (position, velocity) = (self.values(k, self.positions), self.values(k, velocities));
        let velocity = if velocities == 1 { &[][..] } else { &velocity };
        if self.channel == 2 {
            let point = Point { position, velocity: velocity.to_vec(), ..Point::default() };
            let points = [point.clone(), point.clone(), Point::default(), Point::default()];
            let scaling = if k % 40 == 3 { f64::NAN } else { 1.0 };
            return controller_state(self.kind, stamp(k), names, &points, false, Some(scaling));
        }
        Cdr::message(self.kind, |cdr| {
            cdr.time(stamp(k));
            cdr.text(&"frame_id"[..self.frame]);
            cdr.texts(names);
            cdr.f64s(&position);
            cdr.f64s(velocity);
            cdr.f64s(&[]);
        })
    }
}

fn log(runs: &[Run]) -> Log {
    let mut log = plain_log();
    log.channel(Channel::cdr("/arm/joint_states", "sensor_msgs/msg/JointState"));
    log.channel(Channel::cdr("/arm/joint_states", "sensor_msgs/msg/JointState"));
    let schema = schema::controller_state(&["reference", "feedback", "error", "output"], false, true);
    let state = Channel::cdr("/arm/state", "control_msgs/msg/JointTrajectoryControllerState");
    log.channel(state.with_schema("ros2msg", schema));
    let mut k = 0;
    for run in runs {
        for n in 0..run.messages {
            let mut data = run.message(k);
            match run.damage {
                Damage::Cut(bytes) if n + 1 == run.messages => {
                    data.truncate(data.len().saturating_sub(bytes));
                }
                Damage::Padded(bytes) if n + 1 == run.messages => data.extend(vec![0; bytes]),
                Damage::Flipped(at) if n + 1 == run.messages => {
                    if let Some(byte) = data.get_mut(at) {
                        *byte ^= 0x11;
                    }
                }
                _ => {}
            }
            log.send(2 + run.channel, stamp(k), data);
            k += 1;
        }
    }
    log
}

/// Everything of each topic: as the plan and as the measurement.
fn found(bytes: &[u8]) -> Vec<Result<Recording, String>> {
    let topics = ["/arm/joint_states", "/arm/state:reference.positions", "/arm/state:feedback.positions"];
    let both = topics.map(|topic| [options(&[topic], &[], &[]), options(&[], &[topic], &[])]);
    let all = both.into_iter().flatten().chain([ReadOptions::default()]);
    all.map(|options| read_bytes(bytes, &options).map_err(|error| error.to_string())).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn what_is_read_without_a_walk_is_what_a_walk_finds(runs in vec(run(), 1..12)) {
        let log = log(&runs);
        prop_assert_eq!(found(&log.by_hand("", usize::MAX)), found(&log.by_hand("", 1)));
    }
}
