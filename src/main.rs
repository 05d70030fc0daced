//! Parses, runs, and turns the result into an exit code; everything else is in the library.

use std::{env, io, process::ExitCode};

use anstream::AutoStream;
use clap::{CommandFactory as _, FromArgMatches as _};
use hydrotrace::cli::{self, Args, terminal};

fn main() -> ExitCode {
    let matches = Args::command().color(terminal::early_choice(env::args_os())).get_matches();
    let args = Args::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    let choice = terminal::set_up(&args.terminal);
    // Not locked: events of the run are said in between.
    let mut err = AutoStream::new(io::stderr(), choice);
    ExitCode::from(cli::run(&args, &mut io::stdout().lock(), &mut err))
}
