//! `fleet` and what it does.

mod answers;
mod note;
mod scan;

use clap::Subcommand;

use super::{CliError, Outcome, Run, console, number, read};
use console::Console;
pub(crate) use scan::SourceArgs;

const EXAMPLES: &str = "\
Examples:
  hydrotrace fleet scan /data/logs --into fleet --machine-from path:2
  hydrotrace fleet worst fleet --by peak
  hydrotrace fleet drift fleet --html -o fleet.html
  hydrotrace fleet note fleet --machine M07 --at 2026-03-06 'valve replaced'
  hydrotrace fleet effect fleet --machine M07
  hydrotrace fleet gate fleet --max-drift-delay-ms 5";

/// Many logs of many machines: what drifts, since when, what helped
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    Scan(scan::Args),
    Worst(answers::WorstArgs),
    Drift(answers::DriftArgs),
    Note(note::Args),
    Effect(answers::EffectArgs),
    Gate(answers::GateArgs),
    Compact(scan::CompactArgs),
}

impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        match &self.what {
            What::Scan(args) => args.run(console),
            What::Worst(args) => args.run(console),
            What::Drift(args) => args.run(console),
            What::Note(args) => args.run(console),
            What::Effect(args) => args.run(console),
            What::Gate(args) => args.run(console),
            What::Compact(args) => args.run(console),
        }
    }
}
