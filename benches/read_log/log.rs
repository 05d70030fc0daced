//! The log that is read: six joints at 1 kHz that move, rest and move again.

use std::{
    f64::consts::TAU,
    fs::File,
    io::{BufWriter, Read},
    path::{Path, PathBuf},
};

use hydrotrace::{
    log::{ControllerState, LogWriter, Point, WriteOptions},
    rng::{Stream, stream},
};
use mcap::{Compression, MessageStream, WriteOptions as McapOptions, read::LinearReader, records::Record};
use rand_distr::{Distribution, Normal};

const JOINTS: [&str; 6] = ["swing", "boom", "stick", "bucket", "tilt", "rotator"];
const START_NS: i64 = 1_700_000_000_000_000_000;
/// A message of the log, about, with its share of the chunk.
const MESSAGE_BYTES: usize = 790;
/// An encoder of 18 bits.
const ENCODER_RAD: f64 = TAU / 262_144.0;

pub(crate) struct Written {
    pub(crate) messages: usize,
    pub(crate) files: Vec<(&'static str, PathBuf)>,
}

/// Writes about so many bytes of messages, as zstd, lz4 and uncompressed.
pub(crate) fn write(folder: &Path, bytes: usize) -> Written {
    let messages = bytes / MESSAGE_BYTES;
    let zstd = folder.join("zstd.mcap");
    write_zstd(&zstd, messages);
    let plain = std::fs::read(&zstd).unwrap();
    let lz4 = folder.join("lz4.mcap");
    recompress(&plain, &lz4, Some(Compression::Lz4));
    let none = folder.join("none.mcap");
    recompress(&plain, &none, None);
    Written { messages, files: vec![("zstd", zstd), ("lz4", lz4), ("none", none)] }
}

/// Angle, velocity and acceleration of a motion there and back: each way 4 s, then a rest.
fn plan(t_s: f64, joint: usize) -> [f64; 3] {
    let period_s = 4.5 + 0.17 * joint as f64;
    // From the way itself: a remainder that rounds to the other side of a period's end would jump.
    let way = (t_s / period_s).floor();
    let since_s = (t_s - way * period_s).max(0.0);
    let u = (since_s / 4.0).min(1.0);
    let (sign, from) = if way % 2.0 == 0.0 { (1.0, 0.0) } else { (-1.0, 1.0) };
    let range_rad = 0.9 - 0.1 * joint as f64;
    let s = u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
    let ds = 30.0 * u * u * (1.0 - u) * (1.0 - u) / 4.0;
    let dds = 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / 16.0;
    [range_rad * (from + sign * s), range_rad * sign * ds, range_rad * sign * dds]
}

fn write_zstd(path: &Path, messages: usize) {
    let mut log = LogWriter::create(path, &JOINTS, WriteOptions::default()).unwrap();
    let mut rng = stream(1, Stream::SensorNoise);
    let noise = Normal::new(0.0, 1.0).unwrap();
    let encoder = |angle_rad: f64| (angle_rad / ENCODER_RAD).round() * ENCODER_RAD;
    let mut speed = [0.0; 6];
    for k in 0..messages {
        let t_s = k as f64 * 1e-3;
        let planned: [[f64; 3]; 6] = std::array::from_fn(|joint| plan(t_s, joint));
        let late: [[f64; 3]; 6] = std::array::from_fn(|joint| plan((t_s - 0.12).max(0.0), joint));
        let position = planned.map(|p| p[0]);
        let measured = late.map(|p| encoder(p[0] + 2e-5 * noise.sample(&mut rng)));
        let effort = late.map(|p| 800.0 + 900.0 * p[2] + 3.0 * noise.sample(&mut rng));
        // As a velocity filter and a controller make them: every bit counts.
        for (joint, speed) in speed.iter_mut().enumerate() {
            *speed += 0.05 * (late[joint][1] + 1e-3 * noise.sample(&mut rng) - *speed);
        }
        let command: [f64; 6] = std::array::from_fn(|joint| 4e3 * (position[joint] - measured[joint]));
        let (velocity, acceleration) = (planned.map(|p| p[1]), planned.map(|p| p[2]));
        let state = ControllerState {
            reference: Point {
                position_rad: &position,
                velocity_rad_s: &velocity,
                acceleration_rad_s2: &acceleration,
                ..Point::default()
            },
            feedback: Point {
                position_rad: &measured,
                velocity_rad_s: &speed,
                effort_n_m: &effort,
                ..Point::default()
            },
            output: Point { effort_n_m: &command, ..Point::default() },
            speed_scaling_factor: 1.0,
        };
        log.controller_state(START_NS + i64::try_from(k).unwrap() * 1_000_000, &state).unwrap();
    }
    log.finish().unwrap();
}

/// The same messages as the crate `mcap` writes them with another compression.
fn recompress(from: &[u8], to: &Path, compression: Option<Compression>) {
    let options = McapOptions::new().profile("ros2").compression(compression).chunk_size(Some(1 << 20));
    let mut writer = options.create(BufWriter::new(File::create_new(to).unwrap())).unwrap();
    for message in MessageStream::new(from).unwrap() {
        writer.write(&message.unwrap()).unwrap();
    }
    writer.finish().unwrap();
}

/// One chunk as it lies in the file.
pub(crate) struct Chunk {
    compression: String,
    pub(crate) packed: Vec<u8>,
    pub(crate) plain_bytes: usize,
}

pub(crate) fn chunks(path: &Path) -> Vec<Chunk> {
    let bytes = std::fs::read(path).unwrap();
    let records = LinearReader::new(&bytes).unwrap().map(Result::unwrap);
    let chunks = records.filter_map(|record| match record {
        Record::Chunk { header, data } => Some(Chunk {
            compression: header.compression,
            packed: data.into_owned(),
            plain_bytes: usize::try_from(header.uncompressed_size).unwrap(),
        }),
        _ => None,
    });
    chunks.collect()
}

/// What no reader can be faster than: every chunk decompressed into one buffer by the libraries
/// that the reader uses. Uncompressed chunks are copied.
pub(crate) fn decompress(chunks: &[Chunk]) {
    let mut zstd = zstd::bulk::Decompressor::new().unwrap();
    let mut out: Vec<u8> = Vec::with_capacity(2 << 20);
    for chunk in chunks {
        out.clear();
        match chunk.compression.as_str() {
            "zstd" => {
                out.reserve(chunk.plain_bytes);
                zstd.decompress_to_buffer(&chunk.packed, &mut out).unwrap();
            }
            "lz4" => {
                lz4_flex::frame::FrameDecoder::new(chunk.packed.as_slice()).read_to_end(&mut out).unwrap();
            }
            _ => out.extend_from_slice(&chunk.packed),
        }
        assert_eq!(std::hint::black_box(&out).len(), chunk.plain_bytes);
    }
}
