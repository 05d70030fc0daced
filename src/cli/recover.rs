//! `recover`: saves, says what was lost.

use std::io::Write;

use super::{
    CliError, Outcome,
    args::RecoverArgs,
    output::{deliver, say_remarks, shown, spare_inputs, spare_stdout},
};
use crate::{
    document::pretty,
    render::recover as words,
    workflow::recover::{Inputs, RecoverDocument, run as recover},
};

pub(super) fn run(
    args: &RecoverArgs,
    out: &mut impl Write,
    err: &mut impl Write,
) -> Result<Outcome, CliError> {
    spare_inputs(Some(&args.output), std::slice::from_ref(&args.log))?;
    spare_stdout(Some(&args.output))?;
    let recovered = recover(&Inputs { log: args.log.clone(), output: args.output.clone() })?;
    if args.json {
        deliver(&pretty(&RecoverDocument::of(&recovered)), None, out)?;
        say_remarks(&recovered.remarks, err);
    } else {
        let output = args.output.to_string_lossy();
        deliver(&shown(&words::document(&output, &recovered), None), None, out)?;
    }
    Ok(if recovered.remarks.is_empty() { Outcome::Clean } else { Outcome::Remarks })
}
