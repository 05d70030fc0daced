//! `fit`

use std::path::{Path, PathBuf};

use super::{
    CliError, Outcome, Run,
    console::{Console, Form, Target, ends, named_as, spare_for_file, spare_for_page, write_file},
    read::SentArgs,
};
use crate::{
    fit::JointFit,
    render::{fit as words, next},
    workflow::fit::{FitDocument, Fitted, Inputs, LimitsFile, run},
};

const EXAMPLES: &str = "\
Examples:
  hydrotrace fit run.mcap -o limits.toml
  hydrotrace fit run-1.mcap run-2.mcap identification.mcap -o limits.toml
  hydrotrace fit run.mcap --html fit.html
  hydrotrace fit run.mcap --command /arm/command:position --json";

/// Lag, dead band and limits of the machine, from logs of runs
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// Logs of runs of one machine, each a file or a bag directory; they are fitted together
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,

    /// Write the limits to FILE, TOML, for `replan --limits`; if FILE ends in .json, the document
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// One JSON document (schemas/fit.v1.schema.json in the repository)
    #[arg(long)]
    json: bool,

    /// Also write a page: measured beside predicted where the model was not fitted to it, and every number
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,

    #[command(flatten)]
    sent: SentArgs,
}

impl Args {
    /// Where the document goes, if not to standard output.
    fn document(&self) -> Option<&Path> {
        self.output.as_deref().filter(|path| ends(Some(path), "json"))
    }

    pub(super) fn fitted(&self) -> Result<Fitted, CliError> {
        spare_for_file(self.output.as_deref(), &self.logs)?;
        named_as(self.output.as_deref(), "limits in TOML", &["toml", "json", "txt"])?;
        spare_for_page(self.html.as_deref(), self.output.as_deref(), &self.logs)?;
        let fitted = run(&Inputs { logs: self.logs.clone(), read: self.sent.options() })?;
        if let Some(path) = self.output.as_deref().filter(|_| self.document().is_none()) {
            let limits = LimitsFile::of(&fitted).toml();
            let limits =
                limits.map_err(|error| CliError::step("the limits cannot be written")(error.into()))?;
            write_file(path, limits.as_bytes())?;
        }
        Ok(fitted)
    }
}

impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        let fitted = self.fitted()?;
        let target = Target::new(Form::of(&[(self.json, Form::Json)], self.document()), self.document())?;
        let next = self.output.as_deref().filter(|_| self.document().is_none());
        let why_none = fitted.not_again.as_deref();
        let trusted = fitted.fit.joints.iter().any(JointFit::trusted);
        let again: Vec<&PathBuf> = if trusted {
            fitted.again.iter().filter_map(|place| self.logs.get(*place)).collect()
        } else {
            self.logs.last().into_iter().collect()
        };
        let next = next.map(|path| {
            next::limits_written(path, &again, why_none, [trusted, fitted.corrected])
                .reading(&self.sent.words())
        });
        if let Some(file) = &self.html {
            write_file(file, words::page(&fitted, next.as_ref()).as_bytes())?;
        }
        let result = match next {
            _ if target.form == Form::Json => FitDocument::of(&fitted).json(),
            Some(next) => target.text(&words::document(&fitted).with_above_remarks(next)),
            None => target.text(&words::document(&fitted)),
        };
        console.finish(&target, &result, &fitted.remarks, &[])
    }
}
