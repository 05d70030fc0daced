//! `answer`, and a log without a verb

use std::{
    ffi::{OsStr, OsString},
    path::{Path, PathBuf},
};

use clap::CommandFactory as _;

use super::{CliError, Outcome, Run, console::Console, read::ReadArgs};
use crate::{
    render::report as words,
    workflow::report::{DelayModel, Document, Inputs, run},
};

const EXAMPLES: &str = "\
Examples:
  hydrotrace run.mcap                 (the verb may be left out before a file)
  hydrotrace run.mcap --explain
  hydrotrace answer run.mcap --json   (the document of `report`)";

/// A run in eight lines: where it was off, how late, what to do next
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// Logs of one run: MCAP files (parts of a split bag count as one), ROS 2 bags or tables (CSV, Parquet)
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,

    /// Say too how the numbers are made
    #[arg(long)]
    explain: bool,

    /// One JSON document, that of `report` (schemas/report.v2.schema.json in the repository)
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    read: ReadArgs,
}

impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        let (logs, read) = (self.logs.clone(), self.read.options());
        let inputs = Inputs { logs, read, delay_model: DelayModel::OfThisRunIfShort, ..Inputs::default() };
        let report = run(&inputs)?;
        let (document, verdicts) = (Document::of(&report), words::verdicts(&report));
        let shown = || words::answer(&report, self.explain).reading(&self.read.words());
        console.answer(self.json, &document, shown, &report.remarks, &verdicts)
    }
}

/// The arguments with the verb that is left out before a file: `hydrotrace run.mcap`. What is neither a verb nor looks
/// like a file stays as it is, so that a misspelt verb is called that.
pub(super) fn with_verb(mut args: Vec<OsString>) -> Vec<OsString> {
    let mut command = super::Args::command();
    command.build();
    let takes_value = |arg: &OsStr| {
        let long = arg.to_str().and_then(|arg| arg.strip_prefix("--"));
        command
            .get_arguments()
            .any(|known| long == known.get_long() && long.is_some() && known.get_action().takes_values())
    };
    let mut place = 1;
    while let Some(arg) = args.get(place).filter(|arg| is_option(arg)) {
        place += 1 + usize::from(takes_value(arg));
    }
    // After `--` all are files.
    let first = args.get(place).map(|arg| if arg == "--" { args.get(place + 1) } else { Some(arg) });
    let Some(first) = first.flatten() else { return args };
    let is_verb = first.to_str().is_some_and(|name| command.find_subcommand(name).is_some());
    if !is_verb && is_file(first) {
        args.insert(place, "answer".into());
    }
    args
}

fn is_option(arg: &OsStr) -> bool {
    arg.as_encoded_bytes().starts_with(b"-") && arg != "-" && arg != "--"
}

/// Whether it is there, is standard input, or is written as files are.
fn is_file(arg: &OsStr) -> bool {
    arg == "-" || Path::new(arg).exists() || arg.as_encoded_bytes().iter().any(|byte| b"./\\".contains(byte))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(line: &str) -> String {
        let args = with_verb(line.split(' ').map(OsString::from).collect());
        args.iter().map(|arg| arg.to_string_lossy()).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn a_file_needs_no_verb_and_a_verb_no_file() {
        for (line, becomes) in [
            ("hydrotrace run.mcap", "hydrotrace answer run.mcap"),
            (
                "hydrotrace --color never -q ./run --explain",
                "hydrotrace --color never -q answer ./run --explain",
            ),
            ("hydrotrace -q -- -p.csv", "hydrotrace -q answer -- -p.csv"),
            ("hydrotrace --color=never a.csv b.csv", "hydrotrace --color=never answer a.csv b.csv"),
        ] {
            assert_eq!(with(line), becomes);
        }
        for line in [
            "hydrotrace", "hydrotrace --help", "hydrotrace report run.mcap", "hydrotrace reports run.mcap",
            "hydrotrace help report", "hydrotrace --color never demo",
        ] {
            assert_eq!(with(line), line);
        }
    }
}
