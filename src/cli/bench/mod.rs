//! `bench`: one file for each thing that can be measured.

mod detector;
mod moea;
mod plan;

use std::{fs, io::Write, path::Path};

use indicatif::ProgressBar;

use super::{
    CliError, Outcome,
    args::{Bench, BenchArgs},
    output,
};
use crate::atomic_file::AtomicError;

pub(super) fn run(args: &BenchArgs, out: &mut impl Write) -> Result<Outcome, CliError> {
    match &args.what {
        Bench::Detector(args) => detector::run(args, out),
        Bench::Moea(args) => moea::run(args, out),
        Bench::Plan(args) => plan::run(args, out),
    }
}

/// Makes a folder to write to.
fn make(folder: &Path) -> Result<(), AtomicError> {
    let failed = |source| AtomicError::Io { action: "create the folder", path: folder.to_owned(), source };
    fs::create_dir_all(folder).map_err(failed)
}

/// Drawn on standard error, and not at all where that is no terminal.
fn progress(steps: u64, noun: &str) -> ProgressBar {
    output::progress(Some(steps), &format!("{{bar:30}} {{pos}}/{{len}} {noun}, {{eta}} left"))
}
