//! Reading speed beside pure decompression of the same chunks, and beside Python's rosbags.
//!
//! `cargo bench --bench read_log -- [--quick | --mb 1000] [--reps 5]` or `-- --file run.mcap`.
//! See `benches/README.md`.
#![allow(clippy::unwrap_used, reason = "what fails here fails the benchmark")]

mod log;
mod measure;
mod peer;

use std::path::Path;

use hydrotrace::log::{ReadOptions, Selector, read_recording};

use log::Chunk;
use measure::{Best, peak_anonymous_mb};

/// Position and velocity of the plan and position of the measurement for six joints, speed
/// scaling, and the three clocks of every message.
const NUMBERS_READ: usize = 3 * 6 + 1 + 3;
/// The same fields as tracks, which share one axis of time.
const NUMBERS_KEPT: usize = 3 * 6 + 1;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let value = |flag: &str| {
        let at = arguments.iter().position(|argument| argument == flag)?;
        arguments.get(at + 1).cloned()
    };
    let quick = arguments.iter().any(|argument| argument == "--quick");
    let number = |flag: &str, default: usize| value(flag).map_or(default, |text| text.parse().unwrap());
    let reps = number("--reps", if quick { 3 } else { 7 });
    if let Some(path) = value("--peak-read") {
        println!("{}", peak_anonymous_mb(|| read_only(path.as_ref())));
    } else if let Some(path) = value("--peak-recording") {
        println!("{}", peak_anonymous_mb(|| recording(path.as_ref())));
    } else if let Some(path) = value("--file") {
        one_file(path.as_ref(), reps);
    } else {
        synthetic(number("--mb", if quick { 50 } else { 1000 }), reps);
    }
}

/// Reads every sample, and ends before series are made of them: no such topic is measured.
fn read_only(path: &Path) {
    let options = ReadOptions { measured: vec![Selector::parse("/no_such_topic")], ..ReadOptions::default() };
    read_recording(&[path.to_owned()], &options).unwrap_err();
}

/// Reads planned and measured series.
fn recording(path: &Path) {
    let recording = read_recording(&[path.to_owned()], &ReadOptions::default()).unwrap();
    assert!(!recording.planned.tracks.is_empty());
}

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap()
}

fn one_file(path: &Path, reps: usize) {
    let (one, mut read, mut whole) = (pool(1), Best::default(), Best::default());
    for _ in 0..reps {
        read.take(|| one.install(|| read_only(path)));
        whole.take(|| one.install(|| recording(path)));
    }
    println!("{}, one thread, best of {reps}: read {read}, recording {whole}", path.display());
}

fn synthetic(mb: usize, reps: usize) {
    let folder = tempfile::tempdir().unwrap();
    let load = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    let written = log::write(folder.path(), mb * 1_000_000);
    let cores = std::thread::available_parallelism().unwrap();
    println!("{} messages of 6 joints, {reps} interleaved repetitions, the best of each;", written.messages);
    println!("{cores} cores, load before: {}", load.split(' ').next().unwrap_or_default());
    println!(
        "rates in MB/s (1e6 B of uncompressed chunks); per thread by CPU time, two threads by wall time"
    );
    println!(
        "{:<5} {:>6} {:>7} | {:>6} | {:>6} {:>6} {:>5} | {:>6} {:>6} {:>6} {:>5} | {:>6} {:>6}",
        "", "MB", "packed", "pure", "read", "wall", "ratio", "2 thr.", "1/2", "1/2", "1/2", "record", "ratio"
    );
    println!(
        "{:<5} {:>6} {:>7} | {:>6} | {:>6} {:>6} {:>5} | {:>6} {:>6} {:>6} {:>5} | {:>6} {:>6}",
        "", "", "", "cpu", "cpu", "", "", "wall", "wall", "2w/c1", "", "cpu", ""
    );
    let mut zstd_cpu_s = f64::NAN;
    for (name, path) in &written.files {
        let cpu_s = compare(name, path, reps);
        if *name == "zstd" {
            zstd_cpu_s = cpu_s;
        }
    }
    let zstd = &written.files[0].1;
    for (what, flag, numbers) in
        [("read", "--peak-read", NUMBERS_READ), ("recording", "--peak-recording", NUMBERS_KEPT)]
    {
        let numbers_mb = (written.messages * numbers * 8) as f64 / 1e6;
        let peak_mb = measure::child(flag, zstd);
        println!(
            "memory of {what}, zstd, {cores} threads: peak {peak_mb:.0} MB anonymous, {numbers_mb:.0} MB of numbers, {:.0} MB beyond",
            peak_mb - numbers_mb
        );
    }
    let sample = written.messages.min(if mb < 100 { 5_000 } else { 30_000 });
    match peer::rosbags(zstd, sample) {
        Some(per_message_s) => {
            let ours_s = zstd_cpu_s / written.messages as f64;
            println!(
                "rosbags: {:.1} us of CPU a message (of the first {sample}, start-up left out), ours {:.3} us: {:.0}x a core",
                per_message_s * 1e6,
                ours_s * 1e6,
                per_message_s / ours_s
            );
        }
        None => println!("rosbags: not run (needs python3 with rosbags 0.11)"),
    }
}

/// Measures one file; returns the CPU time of reading it in one thread, s.
fn compare(name: &str, path: &Path, reps: usize) -> f64 {
    let chunks: Vec<Chunk> = log::chunks(path);
    let bytes = chunks.iter().map(|chunk| chunk.plain_bytes).sum::<usize>() as f64;
    let packed = chunks.iter().map(|chunk| chunk.packed.len()).sum::<usize>() as f64;
    let (one, two) = (pool(1), pool(2));
    let [mut pure, mut read, mut read_two, mut whole] = [Best::default(); 4];
    for _ in 0..reps {
        pure.take(|| log::decompress(&chunks));
        read.take(|| one.install(|| read_only(path)));
        read_two.take(|| two.install(|| read_only(path)));
        whole.take(|| one.install(|| recording(path)));
    }
    let rate = |seconds: f64| bytes / seconds / 1e6;
    println!(
        "{name:<5} {:>6.0} {:>7.2} | {:>6.0} | {:>6.0} {:>6.0} {:>5.2} | {:>6.0} {:>6.2} {:>6.2} {:>5.2} | {:>6.0} {:>6.2}",
        bytes / 1e6,
        bytes / packed,
        rate(pure.cpu_s),
        rate(read.cpu_s),
        rate(read.wall_s),
        pure.cpu_s / read.cpu_s,
        rate(read_two.wall_s),
        read.wall_s / read_two.wall_s,
        read.cpu_s / read_two.wall_s,
        read.cpu_s / read_two.cpu_s,
        rate(whole.cpu_s),
        pure.cpu_s / whole.cpu_s,
    );
    read.cpu_s
}
