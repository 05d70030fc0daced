//! `bench`: one file for each thing that can be measured.

mod detector;

use std::io::Write;

use super::{
    CliError, Outcome,
    args::{Bench, BenchArgs},
};

pub(super) fn run(args: &BenchArgs, out: &mut impl Write) -> Result<Outcome, CliError> {
    match &args.what {
        Bench::Detector(args) => detector::run(args, out),
    }
}
