//! The command line: arguments in, an exit code out. No arithmetic lives here.
//!
//! A verb is a file with its arguments, `Run`, and two lines here: `mod` and a row of `verbs!`.

mod answer;
mod columns;
mod compare;
mod completions;
mod console;
mod demo;
mod error;
mod excite;
mod export;
mod figures;
mod fit;
mod fleet;
mod gates;
mod import;
mod info;
mod interrupt;
mod join;
mod lines;
mod man;
mod number;
mod placed;
mod plan;
mod read;
mod record;
mod recover;
mod replan;
mod report;
mod simulate;
mod terminal;
mod udp;
mod view;
mod views;
mod watch;

use std::{env, io, process::ExitCode};

use anstream::AutoStream;
use clap::{CommandFactory as _, FromArgMatches as _, Parser, Subcommand};

use crate::{atomic_file, input_file, workflow::carried::worth};
use console::Console;
use error::CliError;

/// How a run that did not fail ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Outcome {
    Clean,
    Remarks,
    LimitBroken,
}

trait Run {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError>;
}

/// The verbs: names of their variants, and the modules that hold their `Args`. Help lists them in this order.
macro_rules! verbs {
    ($($name:ident $verb:ident),* $(,)?) => {
        #[derive(Debug, Subcommand)]
        enum Command {
            $($name($verb::Args)),*
        }

        impl Run for Command {
            fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
                match self {
                    $(Self::$name(args) => args.run(console)),*
                }
            }
        }

        $(impl TryFrom<Command> for $verb::Args {
            type Error = CliError;

            fn try_from(command: Command) -> Result<Self, CliError> {
                match command {
                    Command::$name(args) => Ok(args),
                    _ => Err(CliError::failed("these are the arguments of another verb")),
                }
            }
        })*
    };
}

verbs! {
    Demo demo,
    Answer answer,
    Report report,
    Compare compare,
    Plan plan,
    Simulate simulate,
    Fit fit,
    Fleet fleet,
    Watch watch,
    Excite excite,
    Replan replan,
    Join join,
    Import import,
    Record record,
    Export export,
    Info info,
    Recover recover,
    View view,
    Completions completions,
    Man man,
}

/// Tracking error of jointed arms from their logs, above all where a joint starts from rest.
///
/// Reads ROS 2 bags and other MCAP logs with planned and measured joint angles, and finds both
/// topics by itself. Times are seconds from the start of the log.
#[derive(Debug, Parser)]
#[command(
    name = "hydrotrace",
    version,
    max_term_width = 100,
    override_usage = "hydrotrace [OPTIONS] <COMMAND>\n       hydrotrace [OPTIONS] LOG...    (the answer in eight lines)",
    after_help = "Exit codes: 0 finished, 1 failed, 2 bad usage, 3 finished with remarks on the data, \
                  4 finished but a limit (--max-..., --min-...) was not kept."
)]
struct Args {
    #[command(subcommand)]
    command: Command,

    /// Write the output even over a recording or another program's file
    #[arg(long, global = true)]
    force: bool,

    #[command(flatten)]
    terminal: terminal::TerminalArgs,
}

/// Runs the program on the arguments of this process.
///
/// The exit code is 0 if it finished, 1 if it failed, 2 for bad usage, 3 if it finished with remarks on
/// the data, and 4 if it finished but a limit was not kept. A reader of standard output that closes it early
/// is no failure.
pub fn main() -> ExitCode {
    let matches = Args::command()
        .color(terminal::early_choice(env::args_os()))
        .try_get_matches_from(answer::with_verb(env::args_os().collect()))
        .unwrap_or_else(|error| placed::placed(error, &Args::command()).exit());
    let args = Args::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    let choice = terminal::set_up(args.terminal);
    input_file::remember();
    if !args.force {
        atomic_file::keep(worth);
    }
    interrupt::watch();
    // Not locked: the log writes to it during the run.
    let mut err = AutoStream::new(io::stderr(), choice);
    let mut out = io::stdout().lock();
    let result = args.command.run(&mut Console::new(&mut out, &mut err, args.terminal.quiet));
    ExitCode::from(
        match result.and_then(|outcome| Console::new(&mut out, &mut err, false).flushed(outcome)) {
            Ok(Outcome::Clean) => 0,
            Ok(Outcome::Remarks) => 3,
            Ok(Outcome::LimitBroken) => 4,
            Err(error) => error.explained(&mut err),
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn definitions_are_consistent() {
        Args::command().debug_assert();
    }

    #[test]
    fn every_verb_is_one_line_on_a_narrow_terminal() {
        for verb in Args::command().get_subcommands() {
            let about = verb.get_about().unwrap().to_string();
            assert!(about.len() <= 80 - "  completions  ".len(), "{about}");
        }
    }
}
