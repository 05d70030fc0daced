//! `join`: puts a plan into a log, says where.

use std::io::Write;

use super::{
    CliError, Outcome,
    args::JoinArgs,
    output::{deliver, say_remarks, shown, spare_inputs, spare_stdout},
};
use crate::{
    document::pretty,
    render::join as words,
    workflow::join::{JoinDocument, run as join},
};

pub(super) fn run(args: &JoinArgs, out: &mut impl Write, err: &mut impl Write) -> Result<Outcome, CliError> {
    let read = [args.logs.as_slice(), std::slice::from_ref(&args.plan)].concat();
    spare_inputs(Some(&args.output), &read)?;
    spare_stdout(Some(&args.output))?;
    let joined = join(&args.inputs())?;
    if args.json {
        deliver(&pretty(&JoinDocument::of(&joined)), None, out)?;
        say_remarks(&joined.remarks, err);
    } else {
        deliver(&shown(&words::document(&joined, &args.plan, &args.output), None), None, out)?;
    }
    Ok(if joined.remarks.is_empty() { Outcome::Clean } else { Outcome::Remarks })
}
