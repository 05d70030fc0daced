//! Logs of many machines over many days, made in memory within a millisecond.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

use hydrotrace::log::{
    LogWriter, Role, WriteOptions,
    dataset::{Column, read_table},
};

/// The first day, ns since 1970: 2026-03-01 at eight.
const FIRST_NS: i64 = 1_772_352_000_000_000_000;
const DAY_NS: i64 = 86_400_000_000_000;

/// Even numbers between 0 and 1 that depend on nothing but `seed`.
pub(crate) fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0xD1B5_4A32_D192_ED03;
    move || {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// A log as bytes: names, planned and measured angles by joint and sample at some instants.
pub(crate) fn log(machine: &str, day: i64, names: &[&str], t_s: &[f64], sides: [&[Vec<f64>]; 2]) -> Vec<u8> {
    let mut log = LogWriter::new(Vec::new(), names, WriteOptions::default()).unwrap();
    log.metadata("run", &BTreeMap::from([("machine".to_owned(), machine.to_owned())])).unwrap();
    for (k, t_s) in t_s.iter().enumerate() {
        let stamp_ns = FIRST_NS + day * DAY_NS + (t_s * 1e9).round() as i64;
        for (role, side) in [Role::Planned, Role::Measured].into_iter().zip(sides) {
            let angles: Vec<f64> = side.iter().map(|joint| joint[k]).collect();
            log.joint_sample(role, stamp_ns, &angles, &[], &[]).unwrap();
        }
    }
    log.finish().unwrap()
}

/// Travel of a motion of one second, share of the whole.
pub(crate) fn smooth(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * t * (10.0 + t * (6.0 * t - 15.0))
}

/// Ten seconds of two joints with two starts each, which follow after `delay_s`, each start a little later or earlier.
pub(crate) fn small_log(machine: &str, day: i64, seed: u64, delay_s: [f64; 2]) -> Vec<u8> {
    let mut random = random(seed);
    let phase_s = 0.02 * random();
    let t_s: Vec<f64> = (0..500).map(|k| 0.02 * f64::from(k) + phase_s).collect();
    let starts_s = [[2.0, 6.0], [3.0, 7.0]];
    let mut sides = [Vec::new(), Vec::new()];
    for (starts_s, delay_s) in starts_s.iter().zip(delay_s) {
        let late_s = [0.0, 0.0].map(|_: f64| delay_s + 0.01 * (random() - 0.5));
        let at = |t: f64, late_s: [f64; 2]| {
            0.2 * smooth((t - starts_s[0] - late_s[0]) / 2.0)
                - 0.2 * smooth((t - starts_s[1] - late_s[1]) / 2.0)
        };
        sides[0].push(t_s.iter().map(|t| at(*t, [0.0; 2])).collect());
        let mut noisy = |t: f64| at(t, late_s) + 2e-5 * (random() - 0.5);
        sides[1].push(t_s.iter().map(|t| noisy(*t)).collect());
    }
    log(machine, day, &["boom", "stick"], &t_s, [&sides[0], &sides[1]])
}

/// Writes small logs of `machines` machines over `days` days into `MACHINE/DAY.mcap`; the boom of the machine `M00`
/// grows slower by 20 ms a day.
pub(crate) fn small_fleet(folder: &Path, machines: u64, days: i64) {
    for machine in 0..machines {
        let name = format!("M{machine:02}");
        fs::create_dir_all(folder.join(&name)).unwrap();
        for day in 0..days {
            let drift_s = if machine == 0 { 0.02 * day as f64 } else { 0.0 };
            let bytes = small_log(&name, day, machine * 1000 + day as u64, [0.15 + drift_s, 0.2]);
            fs::write(folder.join(format!("{name}/{day:02}.mcap")), bytes).unwrap();
        }
    }
}

/// Files of a dataset with their bytes.
pub(crate) fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut open = vec![folder.to_owned()];
    while let Some(at) = open.pop() {
        for entry in fs::read_dir(at).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|ending| ending == "parquet") {
                found.insert(path.strip_prefix(folder).unwrap().to_owned(), fs::read(&path).unwrap());
            }
        }
    }
    found
}

/// Cells of a column over all parts of a table.
pub(crate) fn cells(folder: &Path, table: &str, column: &'static str) -> Vec<String> {
    let parts = files(folder).into_keys().filter(|path| path.starts_with(table));
    let text = |path: PathBuf| read_table(&folder.join(path), &[Column::text(column)]).unwrap().rows;
    parts.flat_map(text).map(|row| row[0].as_text().unwrap_or_default().to_owned()).collect()
}

/// That the dataset holds each log once, with as many rows of joints and starts as a run of [`small_log`] has.
pub(crate) fn is_whole(folder: &Path, logs: usize) {
    let uris = cells(folder, "runs", "log_uri");
    let distinct: BTreeSet<&String> = uris.iter().collect();
    assert_eq!((uris.len(), distinct.len()), (logs, logs));
    let runs: BTreeSet<String> = cells(folder, "runs", "run_id").into_iter().collect();
    for (table, each) in [("joints", 2), ("transitions", 4)] {
        let mut counts: BTreeMap<String, usize> = BTreeMap::new();
        for run in cells(folder, table, "run_id") {
            *counts.entry(run).or_default() += 1;
        }
        assert!(counts.values().all(|count| *count == each), "{table}: {counts:?}");
        assert_eq!(counts.into_keys().collect::<BTreeSet<_>>(), runs, "{table}");
    }
}
