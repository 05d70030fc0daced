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

use measure::{Time, child, peak_anonymous_mb, timed};

/// Position and velocity of the plan and position of the measurement for six joints, speed
/// scaling, and the three clocks of every message.
const NUMBERS_READ: usize = 3 * 6 + 1 + 3;
/// The same as series, which share one axis of time.
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
    if let (Some(name), Some(path)) = (value("--task"), arguments.last()) {
        task(&name, number("--threads", 1), path.as_ref());
    } else if let Some(path) = value("--file") {
        println!("{HEAD}");
        compare("", path.as_ref(), reps);
    } else {
        synthetic(number("--mb", if quick { 50 } else { 1000 }), reps);
    }
}

/// What a child process does: one run, measured from within.
fn task(name: &str, threads: usize, path: &Path) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let run = |what: fn(&Path)| pool.install(|| what(path));
    match name {
        "decompress" => {
            let chunks = log::chunks(path);
            println!("{}", Time::of(|| log::decompress(&chunks)));
        }
        "read" => println!("{}", Time::of(|| run(read_only))),
        "recording" => println!("{}", Time::of(|| run(recording))),
        "read-memory" => println!("{}", peak_anonymous_mb(|| run(read_only))),
        "recording-memory" => println!("{}", peak_anonymous_mb(|| run(recording))),
        other => panic!("unknown task {other}"),
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
    assert!(recording.remarks.is_empty(), "the log of the benchmark is not sound: {:?}", recording.remarks);
    assert!(!recording.planned.tracks.is_empty());
}

const HEAD: &str =
    "           MB packed |  pure |  read  wall  user | ratio  user | 2 threads 1/2 CPU | recording ratio";

fn synthetic(mb: usize, reps: usize) {
    let folder = tempfile::tempdir().unwrap();
    let load = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    let load = load.split(' ').next().unwrap_or_default();
    let written = log::write(folder.path(), mb * 1_000_000);
    let cores = std::thread::available_parallelism().unwrap();
    println!("{} messages of 6 joints; {cores} cores, load before {load}", written.messages);
    println!("each figure the best of {reps} runs, interleaved, each in a process of its own");
    println!("MB/s of uncompressed chunks by CPU time, or by wall time where it says wall or threads");
    println!("{HEAD}");
    let mut zstd_cpu_s = f64::NAN;
    for (name, path) in &written.files {
        let cpu_s = compare(name, path, reps);
        if *name == "zstd" {
            zstd_cpu_s = cpu_s;
        }
    }
    let zstd = &written.files[0].1;
    let numbers_mb = |each: usize| (written.messages * each * 8) as f64 / 1e6;
    let (read_mb, kept_mb) = (numbers_mb(NUMBERS_READ), numbers_mb(NUMBERS_KEPT));
    println!(
        "memory, zstd, two threads: {read_mb:.0} MB of numbers extracted, {kept_mb:.0} MB kept as series"
    );
    for what in ["read", "recording"] {
        let peak_mb = child(&format!("{what}-memory"), 2, zstd)[0];
        println!(
            "      {what}: {peak_mb:.0} MB of anonymous memory at the most, {:.0} beyond those extracted, {:.0} beyond those kept",
            peak_mb - read_mb,
            peak_mb - kept_mb
        );
    }
    let sample = written.messages.min(if mb < 100 { 5_000 } else { 30_000 });
    match peer::rosbags(zstd, sample) {
        Some(theirs_s) => {
            let ours_s = zstd_cpu_s / written.messages as f64;
            println!(
                "rosbags: {:.1} us of CPU a message (from the first {sample}, start-up left out), ours {:.3} us: {:.0}x a core",
                theirs_s * 1e6,
                ours_s * 1e6,
                theirs_s / ours_s
            );
        }
        None => println!("rosbags: not run (needs python3 with rosbags 0.11)"),
    }
}

/// Measures one file; returns the CPU time of reading it in one thread, s.
fn compare(name: &str, path: &Path, reps: usize) -> f64 {
    let chunks = log::chunks(path);
    let bytes = chunks.iter().map(|chunk| chunk.plain_bytes).sum::<usize>() as f64;
    let packed = chunks.iter().map(|chunk| chunk.packed.len()).sum::<usize>() as f64;
    drop(chunks);
    let tasks = [("decompress", 1), ("read", 1), ("read", 2), ("recording", 1)];
    let runs: Vec<[Time; 4]> =
        (0..reps).map(|_| tasks.map(|(task, threads)| timed(task, threads, path))).collect();
    let [pures, reads, twos, wholes] =
        [0, 1, 2, 3].map(|task| runs.iter().map(|run| run[task]).collect::<Vec<_>>());
    let [pure, read, two, whole] = [&pures, &reads, &twos, &wholes].map(|runs| Time::least_cpu(runs));
    let [pure_user_s, read_user_s] = [&pures, &reads].map(|runs| Time::median_user_s(runs));
    let [read_wall_s, two_wall_s] = [&reads, &twos].map(|runs| Time::least_wall_s(runs));
    let rate = |seconds: f64| bytes / seconds / 1e6;
    println!(
        "{name:<5} {:>7.1} {:>6.2} | {:>5.0} | {:>5.0} {:>5.0} {:>5.0} | {:>5.2} {:>5.2} | {:>5.0} {:>5.2} {:>5.2} | {:>9.0} {:>5.2}",
        bytes / 1e6,
        bytes / packed,
        rate(pure.cpu_s),
        rate(read.cpu_s),
        rate(read_wall_s),
        rate(read_user_s),
        pure.cpu_s / read.cpu_s,
        pure_user_s / read_user_s,
        rate(two_wall_s),
        read_wall_s / two_wall_s,
        read.cpu_s / two.cpu_s,
        rate(whole.cpu_s),
        pure.cpu_s / whole.cpu_s,
    );
    println!(
        "      CPU ms: decompression {:.1}, read {:.1} ({:.0} in the kernel in that run), recording {:.1}",
        pure.cpu_s * 1e3,
        read.cpu_s * 1e3,
        read.kernel_s * 1e3,
        whole.cpu_s * 1e3
    );
    read.cpu_s
}
