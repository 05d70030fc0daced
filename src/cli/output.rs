//! Where results go: standard output, or a file that appears whole or not at all.

use std::{
    io::{IsTerminal, Write},
    path::Path,
};

use super::CliError;
use crate::{atomic::write_atomically, remark::Remarks};

/// Writes a result to `file`, or to `out`.
pub(super) fn deliver(text: &str, file: Option<&Path>, out: &mut impl Write) -> Result<(), CliError> {
    match file {
        None => Ok(out.write_all(text.as_bytes())?),
        Some(path) => write_atomically(path, |file| Ok(file.write_all(text.as_bytes())?)),
    }
}

/// Refuses a page on a terminal: a megabyte of markup tells nobody anything.
pub(super) fn spare_terminal(html: bool, file: Option<&Path>) -> Result<(), CliError> {
    if html && file.is_none() && std::io::stdout().is_terminal() { Err(CliError::Terminal) } else { Ok(()) }
}

/// Says remarks where a person sees them, whatever the format of the result.
pub(super) fn say_remarks(remarks: &Remarks, err: &mut impl Write) {
    for remark in remarks.as_slice() {
        let text: String =
            remark.message.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
        // A closed standard error does not make the result wrong.
        let _ = writeln!(err, "remark: {} x{}: {text}", remark.code.name(), remark.count);
    }
}

/// Refuses to write over what is read: a log may be the only copy of a run.
pub(super) fn spare_inputs(output: Option<&Path>, inputs: &[std::path::PathBuf]) -> Result<(), CliError> {
    let same = |a: &Path, b: &Path| a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b));
    match output.filter(|output| inputs.iter().any(|input| same(input, output))) {
        Some(output) => Err(CliError::Overwrite(output.to_owned())),
        None => Ok(()),
    }
}
