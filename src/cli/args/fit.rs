//! Arguments of `fit`, and what all verbs that fit have.

use std::path::{Path, PathBuf};

use super::{ReadArgs, ends, selector};
use crate::log::{ReadOptions, Selector, SignalRole, WantedSignal};

/// Arguments of `fit`.
#[derive(Debug, clap::Args)]
pub struct FitArgs {
    /// Logs of runs of one machine, each a file or a bag directory; they are fitted together
    #[arg(required = true, value_name = "LOG")]
    pub logs: Vec<PathBuf>,

    /// Write the limits to FILE, TOML, for `replan --limits`; a FILE that ends in .json gets the document instead
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,

    /// One JSON document, as schemas/fit.v1.schema.json in the repository describes it
    #[arg(long)]
    pub json: bool,

    /// What to read.
    #[command(flatten)]
    pub sent: SentArgs,
}

impl FitArgs {
    /// Where the document goes, if not to standard output.
    pub fn document(&self) -> Option<&Path> {
        self.output.as_deref().filter(|path| ends(Some(path), "json"))
    }
}

/// What to read of a run that is to be fitted.
#[derive(Debug, clap::Args)]
pub struct SentArgs {
    /// Where the log says what was sent, if that is not the plan
    #[arg(long, value_name = "TOPIC[:FIELD]", value_parser = selector, help_heading = "What to read")]
    pub command: Option<Selector>,

    /// Where the log has the signals to the valves, shares of the full one
    #[arg(long, value_name = "TOPIC[:FIELD]", value_parser = selector, help_heading = "What to read")]
    pub valve: Option<Selector>,

    /// What to read.
    #[command(flatten)]
    pub read: ReadArgs,
}

impl SentArgs {
    /// The same for the workflow.
    pub fn options(&self) -> ReadOptions {
        let signals = [(SignalRole::Command, &self.command), (SignalRole::Valve, &self.valve)]
            .map(|(role, topic)| WantedSignal { role, topic: topic.clone() });
        ReadOptions { signals: signals.into(), ..self.read.options() }
    }
}
