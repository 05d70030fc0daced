//! Thousands of broken logs: none ends the reader, exhausts it, or reads differently on more
//! threads. `HYDROTRACE_MUTATIONS=100000 cargo test --release --test it mutations -- --nocapture`
//! tries more than the usual few thousand; `HYDROTRACE_SEED` others.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    time::Instant,
};

use allocation_counter::measure;
use hydrotrace::log::{ReadOptions, survey_bytes};

use super::{
    cdr::{self, Kind},
    encode::{self, Point},
    file::{Channel, Log, MAGIC, chunk, end, message_records, record},
    schema,
};

const START_NS: i64 = 1_700_000_000_000_000_000;
const STEP_NS: i64 = 20_000_000;
const NAMES: [&str; 2] = ["a", "b"];

/// Most bytes that reading may hold at once and ask for in all: files are of some ten thousand.
const MOST_HELD: u64 = 128 << 20;
const MOST_TOTAL: u64 = 1 << 30;

/// `SplitMix64`.
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, bound: usize) -> usize {
        (self.roll() % bound.max(1) as u64) as usize
    }
}

/// A log with every kind of joint topic, few samples of each.
fn everything(kind: Kind, idl: bool) -> Log {
    let mut log = Log::default();
    let state = |points: &[&str]| schema::controller_state(points, true, true);
    let four = ["reference", "feedback", "error", "output"];
    let joint_state = |topic: &str| {
        let channel = Channel::cdr(topic, "sensor_msgs/msg/JointState");
        if idl { channel.with_schema("ros2idl", schema::joint_state_idl()) } else { channel }
    };
    let planned = log.channel(joint_state("/planned/joint_states"));
    let measured = log.channel(joint_state("/joint_states"));
    let controller = Channel::cdr("/arm/controller_state", "control_msgs/msg/JointTrajectoryControllerState");
    let controller = log.channel(controller.with_schema("ros2msg", state(&four)));
    let plan = log.channel(Channel::cdr("/arm/joint_trajectory", "trajectory_msgs/msg/JointTrajectory"));
    let shown = log.channel(Channel::cdr("/display_planned_path", "moveit_msgs/msg/DisplayTrajectory"));
    let dynamic = log.channel(Channel::cdr("/dynamic_joint_states", "control_msgs/msg/DynamicJointState"));
    let array = log.channel(Channel::cdr("/arm/commands", "std_msgs/msg/Float64MultiArray"));
    let json = Channel::cdr("/json", "foxglove.JointStates").with_schema("jsonschema", "{}").encoded("json");
    let json = log.channel(json);
    let stem = "/introspection_data";
    let names =
        log.channel(Channel::cdr(&format!("{stem}/names"), "pal_statistics_msgs/msg/StatisticsNames"));
    let values =
        log.channel(Channel::cdr(&format!("{stem}/values"), "pal_statistics_msgs/msg/StatisticsValues"));
    for k in 0..12_i64 {
        let ns = START_NS + k * STEP_NS;
        let q = [0.01 * k as f64, 1.0 - 0.02 * k as f64];
        log.send(planned, ns, encode::joint_state(kind, ns, &NAMES, &q, &[0.5, -1.0]));
        log.send(measured, ns, encode::joint_state(kind, ns, &NAMES, &q, &[]));
        let points = [q, q, [0.0; 2], [0.0; 2]].map(|q| Point::at(&q));
        log.send(controller, ns, encode::controller_state(kind, ns, &NAMES, &points, true, Some(1.0)));
        log.send(
            dynamic,
            ns,
            encode::dynamic(kind, ns, &[("a", &[("position", q[0])]), ("b", &[("effort", 1.0)])]),
        );
        log.send(array, ns, encode::array(kind, &q));
        let text = format!(
            "{{\"timestamp\":{{\"sec\":{k},\"nsec\":5}},\"joints\":[{{\"name\":\"a\",\"position\":{k}.5}}]}}"
        );
        log.send(json, ns, text.into_bytes());
        log.send(
            values,
            ns,
            cdr::Cdr::message(kind, |cdr| {
                cdr.header(ns);
                cdr.f64s(&q);
                cdr.u32(1);
            }),
        );
        if k % 5 == 0 {
            let point = |since_ns| Point { position: q.to_vec(), since_ns, ..Point::default() };
            let points = vec![point(0), point(100_000_000)];
            log.send(plan, ns, encode::trajectory(kind, ns, &NAMES, &points));
            log.send(shown, ns, encode::display(kind, &[(0, &NAMES, points)]));
            log.send(
                names,
                ns,
                cdr::Cdr::message(kind, |cdr| {
                    cdr.header(ns);
                    cdr.texts(&["command_interface.a/position", "state_interface.a/position"]);
                    cdr.u32(1);
                }),
            );
        }
    }
    log
}

/// A log in Protobuf, described in `protobuf.rs`'s manner but shorter.
fn protobuf() -> Log {
    let nested = |number: u8, bytes: &[u8]| [&[number << 3 | 2, bytes.len() as u8][..], bytes].concat();
    let field = |name: &str, number: u8, label: u8, kind: u8, of: &str| {
        let mut bytes = nested(1, name.as_bytes());
        bytes.extend([3 << 3, number, 4 << 3, label, 5 << 3, kind]);
        if !of.is_empty() {
            bytes.extend(nested(6, of.as_bytes()));
        }
        nested(2, &bytes)
    };
    let joint =
        [nested(1, b"JointState"), field("name", 1, 1, 9, ""), field("position", 2, 1, 1, "")].concat();
    let states = [nested(1, b"JointStates"), field("joints", 2, 3, 11, ".foxglove.JointState")].concat();
    let file = [
        nested(1, b"a.proto"),
        nested(2, b"foxglove"),
        nested(4, &joint),
        nested(4, &states),
        nested(12, b"proto3"),
    ];
    let file = file.concat();
    let schema = [&[0x0A, file.len() as u8 | 0x80, (file.len() >> 7) as u8][..], &file].concat();
    let mut log = Log::default();
    for topic in ["/planned/joints", "/joints"] {
        let channel = Channel::cdr(topic, "foxglove.JointStates")
            .with_schema("protobuf", &schema[..])
            .encoded("protobuf");
        let channel = log.channel(channel);
        for k in 0..20_i64 {
            let joint = [nested(1, b"a"), vec![2 << 3 | 1], (k as f64).to_le_bytes().to_vec()].concat();
            log.send(channel, START_NS + k * STEP_NS, nested(2, &joint));
        }
    }
    log
}

/// A whole file, or records to be put into a chunk with a fitting checksum.
enum Base {
    File(Vec<u8>),
    Records(Vec<u8>, &'static str),
}

fn bases() -> Vec<Base> {
    let little = everything(Kind::LittleEndian, false);
    let options = || mcap::WriteOptions::new().chunk_size(Some(4000));
    let records = |log: &Log| [log.definitions(), message_records(&log.messages)].concat();
    vec![
        Base::File(little.bytes(options())),
        Base::File(little.by_hand("lz4", 20)),
        Base::File(little.bytes(options().compression(None).calculate_chunk_crcs(false))),
        Base::File(little.bytes(options().use_chunks(false))),
        Base::File(everything(Kind::BigEndian, true).by_hand("", 1)),
        Base::File(everything(Kind::Xcdr2, true).bytes(options())),
        Base::File(protobuf().bytes(options().compression(None))),
        Base::Records(records(&little), "zstd"),
        Base::Records(records(&everything(Kind::Delimited, true)), "lz4"),
        Base::Records(records(&everything(Kind::Xcdr2NoSizes, true)), ""),
        Base::Records(records(&protobuf()), "zstd"),
    ]
}

impl Base {
    fn into_bytes(self) -> Vec<u8> {
        match self {
            Self::File(bytes) => bytes,
            Self::Records(records, compression) => in_chunk(&records, compression),
        }
    }
}

fn in_chunk(records: &[u8], compression: &str) -> Vec<u8> {
    [MAGIC.to_vec(), record(1, &[0; 8]), chunk(compression, records), end()].concat()
}

/// Numbers that lengths, counts and stamps do not expect.
const ODD: [u64; 12] =
    [0, 1, 7, 8, 255, 1 << 15, 1 << 31, (1 << 32) - 1, 1 << 40, 1 << 63, u64::MAX - 8, u64::MAX];

fn spoil(bytes: &mut Vec<u8>, dice: &mut Dice) {
    for _ in 0..=dice.below(6) {
        let length = bytes.len();
        let at = dice.below(length);
        let span = at..(at + 1 + dice.below(40)).min(length);
        match dice.below(12) {
            0..=2 => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << dice.below(8);
                }
            }
            3 => bytes[span].fill_with(|| dice.roll() as u8),
            4..=6 => {
                let odd = ODD[dice.below(ODD.len())].to_le_bytes();
                let width = [2, 4, 8][dice.below(3)];
                bytes[at..].iter_mut().zip(&odd[..width]).for_each(|(byte, odd)| *byte = *odd);
            }
            7 => drop(bytes.drain(span)),
            8 => {
                let copy = bytes[span].to_vec();
                let to = dice.below(length);
                bytes.splice(to..to, copy);
            }
            9 => {
                let copy = bytes[span].to_vec();
                let to = dice.below(length - copy.len());
                bytes[to..to + copy.len()].copy_from_slice(&copy);
            }
            10 => {
                let end = (at + dice.below(4096)).min(length);
                bytes[at..end].fill(0);
            }
            _ => bytes.truncate(length - dice.below(length / 4 + 1)),
        }
        if bytes.is_empty() {
            return;
        }
    }
}

fn mutant(bases: &[Base], dice: &mut Dice) -> Vec<u8> {
    match &bases[dice.below(bases.len())] {
        Base::File(bytes) => {
            let mut bytes = bytes.clone();
            spoil(&mut bytes, dice);
            bytes
        }
        Base::Records(records, compression) => {
            let mut records = records.clone();
            spoil(&mut records, dice);
            in_chunk(&records, compression)
        }
    }
}

fn read(bytes: &[u8]) -> String {
    format!("{:?}", survey_bytes(bytes, &ReadOptions::default()))
}

/// Reads mutants `from..to`; returns how many could be surveyed, how many yielded a recording,
/// and the most bytes held and asked for.
fn run(seed: u64, from: u64, to: u64) -> (u64, u64, u64, u64) {
    let bases = bases();
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let (one, three) = (pool(1), pool(3));
    let mut sum = (0, 0, 0, 0);
    for index in from..to {
        let bytes = mutant(&bases, &mut Dice(seed ^ index.wrapping_mul(0xD134_2543_DE82_EF95)));
        let read_one = || {
            one.install(|| {
                let mut found = None;
                let info = measure(|| found = Some(survey_bytes(&bytes, &ReadOptions::default())));
                (found, info)
            })
        };
        let Ok((found, info)) = catch_unwind(AssertUnwindSafe(read_one)) else {
            panic!("mutant {index} of seed {seed} ends the reader");
        };
        assert!(info.bytes_max < MOST_HELD, "mutant {index} of seed {seed} holds {}", info.bytes_max);
        assert!(info.bytes_total < MOST_TOTAL, "mutant {index} of seed {seed} takes {}", info.bytes_total);
        if let Some(Ok(survey)) = &found {
            sum.0 += 1;
            sum.1 += u64::from(survey.recording.is_ok());
        }
        sum.2 = sum.2.max(info.bytes_max);
        sum.3 = sum.3.max(info.bytes_total);
        if index % 16 == 0 {
            assert!(
                one.install(|| read(&bytes)) == three.install(|| read(&bytes)),
                "mutant {index} of seed {seed} reads differently on threads"
            );
        }
    }
    sum
}

#[test]
fn no_mutant_ends_exhausts_or_confuses_the_reader() {
    let number =
        |name: &str, usual: u64| std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(usual);
    let (count, seed) = (number("HYDROTRACE_MUTATIONS", 3000), number("HYDROTRACE_SEED", 1));
    let start = Instant::now();
    let (low, high) = std::thread::scope(|scope| {
        let low = scope.spawn(|| run(seed, 0, count / 2));
        (run(seed, count / 2, count), low.join().unwrap())
    });
    println!(
        "{count} mutants of seed {seed} in {:.1} s: {} surveyed, {} recordings, {} bytes held and {} taken at most",
        start.elapsed().as_secs_f64(),
        low.0 + high.0,
        low.1 + high.1,
        low.2.max(high.2),
        low.3.max(high.3)
    );
}

#[test]
#[ignore = "writes seeds for the fuzzer into HYDROTRACE_CORPUS"]
fn seeds() {
    let folder = std::path::PathBuf::from(std::env::var_os("HYDROTRACE_CORPUS").unwrap());
    std::fs::create_dir_all(&folder).unwrap();
    for (k, base) in bases().into_iter().enumerate() {
        std::fs::write(folder.join(format!("base_{k}.mcap")), base.into_bytes()).unwrap();
    }
}
