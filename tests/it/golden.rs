//! What every sample log reports, kept as snapshots; `INSTA_UPDATE=always` blesses new ones.

use std::collections::BTreeSet;

use crate::support::{root, run_at_root, stdout};

fn hydrotrace(args: &[&str]) -> String {
    stdout(&run_at_root(args))
}

/// Holds a text to its snapshot, whose file is named after the text and not after this module.
fn keep(name: &str, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("../snapshots");
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name, text));
}

fn samples() -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(root().join("sample-logs"))
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
        keep(&format!("{name}.report"), &hydrotrace(&["report", &log, "--all"]));
        keep(&format!("{name}.info"), &hydrotrace(&["info", &log]));
    }
}

#[test]
fn one_sample_reports_as_before_in_the_other_formats() {
    let log = "sample-logs/gaps.mcap";
    keep("gaps.markdown", &hydrotrace(&["report", log, "--markdown"]));
    keep("gaps.csv", &hydrotrace(&["report", log, "--csv"]));
}

#[test]
fn help_reads_as_before() {
    for verb in ["report", "info", "recover", "import", "export"] {
        keep(&format!("help.{verb}"), &hydrotrace(&[verb, "--help"]));
    }
    keep("help", &hydrotrace(&["--help"]));
}

#[test]
fn no_snapshot_without_its_sample() {
    let folder = root().join("tests/snapshots");
    let known: BTreeSet<String> = samples().into_iter().chain(["help".to_owned()]).collect();
    for entry in std::fs::read_dir(folder).unwrap() {
        let name = entry.unwrap().file_name().to_string_lossy().into_owned();
        let stem = name.split('.').next().unwrap_or_default();
        assert!(known.contains(stem), "{name} belongs to no sample log");
    }
}
