//! `info`: looks, renders.

use std::io::Write;

use super::{
    CliError, Outcome,
    args::InfoArgs,
    output::{deliver, say_remarks, shown},
};
use crate::{
    document::pretty,
    render::info as words,
    workflow::info::{InfoDocument, Inputs, run as look},
};

pub(super) fn run(args: &InfoArgs, out: &mut impl Write, err: &mut impl Write) -> Result<Outcome, CliError> {
    let survey = look(&Inputs { logs: args.logs.clone(), read: args.read.options() })?;
    if args.json {
        deliver(&pretty(&InfoDocument::of(&survey)), None, out)?;
        say_remarks(&survey.remarks, err);
    } else {
        deliver(&shown(&words::document(&survey), None), None, out)?;
    }
    Ok(if survey.remarks.is_empty() { Outcome::Clean } else { Outcome::Remarks })
}
