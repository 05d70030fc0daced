//! The command line: arguments in, an exit code out. No arithmetic lives here.

pub mod args;
mod compare;
mod completions;
mod demo;
mod excite;
mod export;
mod figures;
mod fit;
mod import;
mod info;
mod join;
mod man;
mod output;
mod plan;
mod recover;
mod replan;
mod report;
mod simulate;
pub mod terminal;
mod view;

use std::io::Write;

use thiserror::Error;

pub use args::{Args, Command};

use output::{FAILED, harmless};

use crate::{
    atomic_file::AtomicError,
    log::{CsvError, ExportError, LogError, WriteError},
    workflow::{
        compare::CompareFailure, excite::ExciteFailure, fit::FitFailure, import::ImportError,
        join::JoinFailure, plan::PlanFailure, replan::ReplanFailure, simulate::log::SimulateFailure,
    },
};

/// How a run that did not fail ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Outcome {
    /// Nothing to remark.
    Clean,
    /// Finished, but with doubts about the data.
    Remarks,
    /// Finished, and a limit that the caller set was not kept.
    GateFailed,
}

/// Why a command did not finish.
#[derive(Debug, Error)]
enum CliError {
    #[error(transparent)]
    Log(#[from] LogError),
    #[error(transparent)]
    Csv(#[from] CsvError),
    #[error(transparent)]
    Import(#[from] ImportError),
    #[error(transparent)]
    Export(#[from] ExportError),
    #[error(transparent)]
    Atomic(#[from] AtomicError),
    #[error(transparent)]
    Plan(#[from] PlanFailure),
    #[error(transparent)]
    Simulate(#[from] SimulateFailure),
    #[error("{failure}; what comes nearest:\n  {}", lines.join("\n  "))]
    NoPlan { failure: String, lines: Vec<String> },
    #[error(transparent)]
    Compare(#[from] CompareFailure),
    #[error(transparent)]
    Fit(#[from] FitFailure),
    #[error(transparent)]
    Replan(#[from] ReplanFailure),
    #[error(transparent)]
    Excite(#[from] ExciteFailure),
    #[error(transparent)]
    Join(#[from] JoinFailure),
    #[error("cannot make the folder {}", path.display())]
    Folder { path: std::path::PathBuf, source: std::io::Error },
    #[error("the words of a step are no command: {0}")]
    Words(String),
    #[cfg(not(feature = "viewer"))]
    #[error(
        "this build has no viewer; add it from the project's folder (350 more crates, some minutes):\n  \
         cargo install --path . --features viewer\n\
         or from anywhere, with the address of the repository for URL:\n  \
         cargo install --git URL --features viewer\n\
         the viewer itself, and plain logs without this command (those of plan, simulate and replan show the arm):\n  \
         pip install rerun-sdk==0.36.3\n  \
         rerun run.mcap"
    )]
    NoViewer,
    #[cfg(feature = "viewer")]
    #[error(transparent)]
    View(#[from] crate::viewer::ViewError),
    #[cfg(feature = "viewer")]
    #[error(transparent)]
    Scenes(#[from] crate::workflow::view::ViewFailure),
    #[error("the limits cannot be written")]
    Limits(#[from] toml::ser::Error),
    #[error("the plan cannot be logged")]
    Write(#[from] WriteError),
    #[error("{} is what is read; give another name to --output", .0.display())]
    Overwrite(std::path::PathBuf),
    #[error("standard output is for text: it says what was done; give --output the name of a file")]
    NoText,
    #[error("{} does not say the form of the table by its ending, .csv or .parquet; say --csv or --parquet", .0.display())]
    NoForm(std::path::PathBuf),
    #[error("a page is for a browser, not for a terminal; give --output FILE or redirect it")]
    Terminal,
    #[cfg(not(feature = "png"))]
    #[error(
        "this build writes no PNG; add it from the project's folder (40 more crates, about a minute):\n  \
         cargo install --path . --features png\n\
         or leave --figures-png out: --figures alone writes SVG"
    )]
    NoPng,
    #[error("cannot draw the figures")]
    Figures(#[source] Box<dyn std::error::Error + Send + Sync>),
    #[error("cannot write the output")]
    Output(#[from] std::io::Error),
}

/// Runs one command: results to `out`, errors and remarks, with escape codes, to `err`; returns the
/// exit code.
///
/// 0 finished, 1 failed, 3 finished with remarks on the data, 4 finished but a limit was not
/// kept; 2 is bad usage, which clap reports. A reader of `out` that goes away is success.
pub fn run(args: &Args, out: &mut impl Write, err: &mut impl Write) -> u8 {
    let mut silence = std::io::sink();
    let said: &mut dyn Write = if args.terminal.quiet { &mut silence } else { &mut *err };
    let result = command(&args.command, out, &mut { said });
    ended(result, out, err)
}

fn command(command: &Command, out: &mut impl Write, err: &mut impl Write) -> Result<Outcome, CliError> {
    match command {
        Command::Report(report) => report::run(report, out, err),
        Command::Compare(compare) => compare::run(compare, out, err),
        Command::Plan(plan) => plan::run(plan, out, err),
        Command::Simulate(simulate) => simulate::run(simulate, out),
        Command::Fit(fit) => fit::run(fit, out, err),
        Command::Excite(excite) => excite::run(excite, out),
        Command::Replan(replan) => replan::run(replan, out, err),
        Command::Join(join) => join::run(join, out, err),
        Command::Demo(demo) => demo::run(demo, out),
        Command::Info(info) => info::run(info, out, err),
        Command::Recover(recover) => recover::run(recover, out, err),
        Command::Import(import) => import::run(import, out, err),
        Command::Export(export) => export::run(export, out, err),
        Command::View(view) => view::run(view, out, err),
        Command::Completions(completions) => completions::run(completions, out),
        Command::Man(man) => man::run(man, out),
    }
}

/// The exit code; says why a command failed.
fn ended(result: Result<Outcome, CliError>, out: &mut impl Write, err: &mut impl Write) -> u8 {
    match result.and_then(|outcome| Ok(out.flush().map(|()| outcome)?)) {
        Ok(Outcome::Clean) => 0,
        Ok(Outcome::Remarks) => 3,
        Ok(Outcome::GateFailed) => 4,
        Err(CliError::Output(error)) if error.kind() == std::io::ErrorKind::BrokenPipe => 0,
        Err(error) => {
            // Nothing is left to tell it to if standard error is gone.
            let _ = writeln!(err, "{FAILED}error:{FAILED:#} {}", harmless(&error.to_string()));
            let mut cause = std::error::Error::source(&error);
            while let Some(inner) = cause {
                let _ = writeln!(err, "  because: {}", harmless(&inner.to_string()));
                cause = inner.source();
            }
            let usage = matches!(
                error,
                CliError::Overwrite(_) | CliError::Terminal | CliError::NoText | CliError::NoForm(_)
            );
            if usage { 2 } else { 1 }
        }
    }
}
