//! What every sample log reports, kept as snapshots; `INSTA_UPDATE=always` blesses new ones.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::float_cmp)]

use std::{collections::BTreeSet, path::Path, process::Command};

fn hydrotrace(args: &[&str]) -> String {
    let run = Command::new(env!("CARGO_BIN_EXE_hydrotrace"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(args)
        .output()
        .unwrap();
    String::from_utf8(run.stdout).unwrap()
}

fn samples() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("sample-logs");
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "mcap"))
        .map(|path| path.file_stem().unwrap().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

#[test]
fn every_sample_log_reports_as_before() {
    for name in samples() {
        let log = format!("sample-logs/{name}.mcap");
        insta::assert_snapshot!(format!("{name}.report"), hydrotrace(&["report", &log, "--all"]));
        insta::assert_snapshot!(format!("{name}.info"), hydrotrace(&["info", &log]));
    }
}

#[test]
fn one_sample_reports_as_before_in_the_other_formats() {
    let log = "sample-logs/gaps.mcap";
    insta::assert_snapshot!("gaps.markdown", hydrotrace(&["report", log, "--markdown"]));
    insta::assert_snapshot!("gaps.csv", hydrotrace(&["report", log, "--csv"]));
}

#[test]
fn help_reads_as_before() {
    for verb in ["report", "info", "recover", "import", "export"] {
        insta::assert_snapshot!(format!("help.{verb}"), hydrotrace(&[verb, "--help"]));
    }
    insta::assert_snapshot!("help", hydrotrace(&["--help"]));
}

#[test]
fn no_snapshot_without_its_sample() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/snapshots");
    let known: BTreeSet<String> = samples().into_iter().chain(["help".to_owned()]).collect();
    for entry in std::fs::read_dir(folder).unwrap() {
        let name = entry.unwrap().file_name().to_string_lossy().into_owned();
        let Some(rest) = name.strip_prefix("golden__") else { continue };
        let stem = rest.split('.').next().unwrap_or_default();
        assert!(known.contains(stem), "{name} belongs to no sample log");
    }
}
