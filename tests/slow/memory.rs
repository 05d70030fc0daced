//! How much memory a report of a long log takes, of the built program: `HYDROTRACE_MEMORY_MINUTES=10,60,240 cargo test
//! --release --test slow memory -- --ignored --nocapture`. Linux only: it reads the peak from `/proc`.

use std::{
    path::Path,
    process::{Command, Stdio},
    time::Duration,
};

use hydrotrace::log::{LogWriter, Role, WriteOptions};

const JOINTS: usize = 6;
const RATE_HZ: i64 = 100;
/// Bytes for each byte of the numbers, and beside them.
const BY_NUMBER: f64 = 1.5;
const BESIDE: f64 = 64e6;

/// Six joints that move and rest, planned and measured with speeds.
fn write(path: &Path, minutes: i64) {
    let names: Vec<String> = (1..=JOINTS).map(|joint| format!("joint_{joint}")).collect();
    let mut log = LogWriter::create(path, &names, WriteOptions::default()).unwrap();
    let swing = |t_s: f64| {
        let within = t_s.rem_euclid(20.0);
        let share = if within < 10.0 { (within - 3.0) / 4.0 } else { (17.0 - within) / 4.0 };
        let share = share.clamp(0.0, 1.0);
        let sign = if within < 10.0 { 1.0 } else { -1.0 };
        (0.4 * share * share * (3.0 - 2.0 * share), sign * 0.6 * share * (1.0 - share))
    };
    let mut noise = 1_u64;
    for k in 0..minutes * 60 * RATE_HZ {
        let (stamp_ns, t_s) =
            (1_760_000_000_000_000_000 + k * (1_000_000_000 / RATE_HZ), k as f64 / RATE_HZ as f64);
        for (role, late_s) in [(Role::Planned, 0.0), (Role::Measured, 0.2)] {
            let (mut position, mut speed) = ([0.0; JOINTS], [0.0; JOINTS]);
            for joint in 0..JOINTS {
                (position[joint], speed[joint]) = swing(t_s - late_s + 0.7 * joint as f64);
                noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                position[joint] +=
                    if late_s > 0.0 { 1e-4 * ((noise >> 40) as f64 / f64::from(1 << 24) - 0.5) } else { 0.0 };
            }
            log.joint_sample(role, stamp_ns, &position, &speed, &[]).unwrap();
        }
    }
    log.finish().unwrap();
}

/// The largest resident set of a report, bytes.
fn peak(path: &Path) -> f64 {
    let mut child = Command::new(env!("CARGO_BIN_EXE_hydrotrace"))
        .args(["report", "--json"])
        .arg(path)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut most_kb = 0.0_f64;
    while child.try_wait().unwrap().is_none() {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kb = line.and_then(|line| line.trim().trim_end_matches(" kB").parse().ok());
        most_kb = most_kb.max(kb.unwrap_or(0.0));
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(matches!(child.wait().unwrap().code(), Some(0 | 3)));
    most_kb * 1024.0
}

#[test]
#[ignore = "minutes"]
fn memory_of_a_report_is_bounded_by_the_numbers_that_it_reads() {
    let minutes = std::env::var("HYDROTRACE_MEMORY_MINUTES").unwrap_or_else(|_| "10,60".to_owned());
    let folder = tempfile::tempdir().unwrap();
    for minutes in minutes.split(',').map(|minutes| minutes.parse::<i64>().unwrap()) {
        let path = folder.path().join("long.mcap");
        write(&path, minutes);
        // A stamp and a position a joint of plan and measurement, and the speeds of the plan.
        let numbers = (8 * minutes * 60 * RATE_HZ) as f64 * (2 + 3 * JOINTS) as f64;
        let (peak, allowed) = (peak(&path), BY_NUMBER * numbers + BESIDE);
        println!(
            "{minutes} min: {:.1} MB of {:.1} MB allowed, numbers {:.1} MB",
            peak / 1e6,
            allowed / 1e6,
            numbers / 1e6
        );
        assert!(peak <= allowed, "{minutes} min: {peak} bytes, {allowed} are allowed");
        std::fs::remove_file(&path).unwrap();
    }
}
