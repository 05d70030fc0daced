//! `fleet note`

use std::path::PathBuf;

use super::{CliError, Outcome, Run, answers::date, console::Console};
use crate::{
    remark::Remarks,
    render::fleet as words,
    workflow::fleet::{Note, Notes, note, notes, take_back},
};

/// What was done to a machine, and when; without WHAT, all that is noted
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The folder of the dataset, as `fleet scan` wrote it
    #[arg(value_name = "DIR")]
    dataset: PathBuf,

    /// What was done
    #[arg(value_name = "WHAT", requires_all = ["machine", "at"])]
    what: Option<String>,

    /// The machine
    #[arg(long, value_name = "MACHINE")]
    machine: Option<String>,

    /// When; runs that begin then are after it
    #[arg(long, value_name = "DATE", value_parser = date, requires = "what")]
    at: Option<i64>,

    /// The joint, where it was one
    #[arg(long, value_name = "JOINT", requires = "what")]
    joint: Option<String>,

    /// Take back what was noted in these words
    #[arg(long, requires = "what")]
    remove: bool,

    /// Print what is noted as one JSON document
    #[arg(long)]
    json: bool,
}

impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        let mut made = None;
        if let (Some(what), Some(machine), Some(at_us)) = (&self.what, &self.machine, self.at) {
            let what = what.split_whitespace().collect::<Vec<_>>().join(" ");
            if what.is_empty() {
                let why = "nothing is said of what was done: 'valve replaced', say";
                return Err(CliError::Usage(why.to_owned()));
            }
            let one = Note { at_us, machine: machine.clone(), joint: self.joint.clone(), what };
            if self.remove {
                take_back(&self.dataset, &one)?;
            } else {
                made = Some(note(&self.dataset, &one)?);
            }
        }
        let found = Notes::of(&notes(&self.dataset, self.machine.as_deref())?);
        let shown = || words::notes(&found, made.as_ref(), &self.dataset);
        console.answer(self.json, &found, shown, &Remarks::default(), &[])
    }
}
