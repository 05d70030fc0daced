//! Parses, runs, and turns the result into an exit code; everything else is in the library.

use std::{io, process::ExitCode};

use clap::Parser as _;
use hydrotrace::cli::{self, Args};

fn main() -> ExitCode {
    let args = Args::parse();
    ExitCode::from(cli::run(&args, &mut io::stdout().lock(), &mut io::stderr().lock()))
}
