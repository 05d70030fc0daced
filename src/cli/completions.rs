//! `completions`: what a shell is to complete.

use std::io::Write;

use clap::CommandFactory;

use super::{Args, CliError, Outcome, args::CompletionsArgs};

pub(super) fn run(args: &CompletionsArgs, out: &mut impl Write) -> Result<Outcome, CliError> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Args::command(), "hydrotrace", &mut script);
    out.write_all(&script)?;
    Ok(Outcome::Clean)
}
