//! `import`: reads, writes, says how it was read.

use std::io::Write;

use super::{
    CliError, Outcome,
    args::ImportArgs,
    output::{deliver, say_remarks, shown, spare_inputs, spare_stdout},
};
use crate::{
    document::pretty,
    render::import as words,
    workflow::import::{ImportDocument, run as import},
};

pub(super) fn run(
    args: &ImportArgs,
    out: &mut impl Write,
    err: &mut impl Write,
) -> Result<Outcome, CliError> {
    spare_inputs(Some(&args.output), std::slice::from_ref(&args.file))?;
    spare_stdout(Some(&args.output))?;
    let imported = import(&args.inputs()?)?;
    if args.json {
        deliver(&pretty(&ImportDocument::of(&imported)), None, out)?;
        say_remarks(&imported.remarks, err);
    } else {
        deliver(&shown(&words::document(&args.output.to_string_lossy(), &imported), None), None, out)?;
    }
    Ok(if imported.remarks.is_empty() { Outcome::Clean } else { Outcome::Remarks })
}
