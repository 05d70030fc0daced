//! `bench detector`, with progress on a terminal.

use std::io::Write;

use super::progress;
use crate::{
    cli::{
        CliError, Outcome,
        args::DetectorArgs,
        output::{deliver, shown},
    },
    render::score as words,
    replay::conditions,
    workflow::detector::{Inputs, run as score},
};

pub(super) fn run(args: &DetectorArgs, out: &mut impl Write) -> Result<Outcome, CliError> {
    let bar = progress(conditions().len() as u64, "conditions");
    let scores = score(&Inputs { seed: args.seed, runs: args.runs }, || bar.inc(1));
    bar.finish_and_clear();
    let rendered = if args.json {
        words::json(args.seed, &scores)
    } else {
        shown(&words::document(args.seed, &scores), None)
    };
    deliver(&rendered, None, out)?;
    Ok(Outcome::Clean)
}
