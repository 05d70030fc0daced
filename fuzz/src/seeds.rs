//! Sound inputs to begin with, from the project's own files.

use std::{
    fs,
    path::{Path, PathBuf},
};

use hydrotrace::log::{LogWriter, Role, WriteOptions};

use crate::log;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn files(folder: &str, ending: &str) -> Vec<Vec<u8>> {
    let list = fs::read_dir(root().join(folder)).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = list.map(|entry| entry.path()).collect();
    paths.retain(|path| path.extension().is_some_and(|found| found == ending));
    paths.sort();
    paths.iter().filter_map(|path| fs::read(path).ok()).collect()
}

/// Few samples of few joints.
fn small_log(compressed: bool) -> Vec<u8> {
    let options =
        WriteOptions { chunk_bytes: if compressed { 1 << 20 } else { 600 }, ..WriteOptions::default() };
    let write = || {
        let mut log = LogWriter::new(Vec::new(), &["a", "b"], options)?;
        for k in 0..12_i32 {
            let (stamp_ns, q) = (1_700_000_000_000_000_000 + i64::from(k) * 20_000_000, 0.01 * f64::from(k));
            log.joint_sample(Role::Planned, stamp_ns, &[q, -q], &[0.5, -0.5], &[])?;
            log.joint_sample(Role::Measured, stamp_ns, &[q - 0.01, -q], &[], &[])?;
        }
        log.finish()
    };
    write().unwrap_or_default()
}

/// Messages of the known types, in CDR, each with the number of its type before it.
fn messages() -> Vec<Vec<u8>> {
    let text = |text: &str| {
        let bytes = [text.as_bytes(), &[0]].concat();
        let mut block = (bytes.len() as u32).to_le_bytes().to_vec();
        block.extend(bytes);
        block.resize(block.len().next_multiple_of(4), 0);
        block
    };
    let header = [vec![0, 1, 0, 0], vec![1, 0, 0, 0, 5, 0, 0, 0], text("base")].concat();
    let names = [2_u32.to_le_bytes().to_vec(), text("a"), text("b")].concat();
    let numbers = |count: u32| {
        let values: Vec<u8> = (0..count).flat_map(|k| (0.1 * f64::from(k)).to_le_bytes()).collect();
        [count.to_le_bytes().to_vec(), vec![0; 4], values].concat()
    };
    (0..log::types().len() as u8)
        .map(|kind| [vec![kind], header.clone(), names.clone(), numbers(2), numbers(2), numbers(0)].concat())
        .collect()
}

/// The seeds of a target by its name.
pub fn of(target: &str) -> Vec<Vec<u8>> {
    match target {
        "read_log" => {
            let mut logs = vec![small_log(true), small_log(false)];
            logs.extend(files("sample-logs", "mcap").into_iter().filter(|log| log.len() < 1 << 16));
            logs
        }
        "schema" => {
            let text = |(k, (_, text)): (u8, &(String, String))| [&[k * 2 + 1][..], text.as_bytes(), &[0, 0, 1, 0, 0]].concat();
            let mut all: Vec<Vec<u8>> = (0..).zip(log::types()).map(text).collect();
            all.push([&[2][..], &log::descriptor()].concat());
            let idl = "module sensor_msgs { module msg { struct JointState { sequence<string> name; sequence<double> position; }; }; };";
            all.push([&[0][..], idl.as_bytes(), &[0, 0, 1, 0, 0]].concat());
            all
        }
        "forms" => {
            let mut all = vec![small_log(true)];
            for ending in ["db3", "gz", "zstd", "parquet", "csv"] {
                all.extend(files("fuzz/seeds/forms", ending));
            }
            all
        }
        "cdr" => messages(),
        "json" => vec![
            br#"{"timestamp":{"sec":1,"nsec":5},"joints":[{"name":"a","position":0.5},{"name":"b","position":-1e-3,"velocity":2}]}"#
                .to_vec(),
        ],
        "protobuf" => vec![log::protobuf_message()],
        "csv" => {
            let row = |k: u32| format!("{:.2};{},5;{},25;on\n", 0.01 * f64::from(k), k, k);
            let german: String = (0..12).map(row).collect();
            let mut all = vec![format!("Zeit [s];Boom_soll [°];Boom_ist [°];ok\n{german}").into_bytes()];
            let row = |k: u32| format!("2024-01-02T03:04:05.{k:03},{},{}\n", 0.1 * f64::from(k), 0.1 * f64::from(k));
            let dated: String = (100..112).map(row).collect();
            all.push(format!("# a comment\ntimestamp,J1_planned_rad,J1_actual_rad\n{dated}").into_bytes());
            all.extend(files("sample-logs", "csv").into_iter().map(|mut table| {
                table.truncate(4096);
                table
            }));
            all
        }
        "task" => files("sample-logs/tasks", "toml"),
        "urdf" => [files("sample-logs/arm", "urdf"), files("tests/reference", "urdf")].concat(),
        "hydraulics" => files("sample-logs/arm", "toml"),
        "limits" => files("fuzz/seeds", "toml"),
        "plant" => files("sample-logs/plant", "toml"),
        _ => Vec::new(),
    }
}
