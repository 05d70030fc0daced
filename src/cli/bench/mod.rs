//! `bench`: one file for each thing that can be measured.

mod detector;
mod moea;

use std::io::Write;

use indicatif::{ProgressBar, ProgressStyle};

use super::{
    CliError, Outcome,
    args::{Bench, BenchArgs},
};

pub(super) fn run(args: &BenchArgs, out: &mut impl Write) -> Result<Outcome, CliError> {
    match &args.what {
        Bench::Detector(args) => detector::run(args, out),
        Bench::Moea(args) => moea::run(args, out),
    }
}

/// Drawn on standard error, and not at all where that is no terminal.
fn progress(steps: u64, noun: &str) -> ProgressBar {
    let bar = ProgressBar::new(steps);
    let template = format!("{{bar:30}} {{pos}}/{{len}} {noun}, {{eta}} left");
    if let Ok(style) = ProgressStyle::with_template(&template) {
        bar.set_style(style);
    }
    bar
}
