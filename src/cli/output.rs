//! Where results go: standard output, or a file that appears whole or not at all.

use std::{
    io::{IsTerminal, Write},
    path::Path,
};

use anstream::ColorChoice;
use anstyle::{AnsiColor, Style};
use indicatif::{ProgressBar, ProgressStyle};
use terminal_size::{Width, terminal_size_of};

use super::CliError;
use crate::{
    atomic_file::write_atomically,
    remark::Remarks,
    render::kit::{self, Document, Sentence, TerminalStyle},
};

/// Starts a line on what failed.
pub(super) const FAILED: Style = AnsiColor::Red.on_default().bold();
/// Starts a line on a doubt.
const DOUBT: Style = AnsiColor::Yellow.on_default();

/// A result as `file` or standard output is to have it: colours and folded lines only for a terminal.
pub(super) fn shown(document: &Document, file: Option<&Path>) -> String {
    if file.is_some() {
        return kit::text(document);
    }
    let coloured = matches!(ColorChoice::global(), ColorChoice::Always | ColorChoice::AlwaysAnsi);
    let width = terminal_size_of(std::io::stdout()).map(|(Width(width), _)| usize::from(width));
    kit::shown(document, TerminalStyle { coloured, width })
}

/// Progress on standard error; none where that is no terminal, and none between or instead of words
/// (`--verbose`, `--quiet`).
pub(super) fn progress(steps: Option<u64>, template: &str) -> ProgressBar {
    if log::max_level() != log::LevelFilter::Warn {
        return ProgressBar::hidden();
    }
    let bar = steps.map_or_else(ProgressBar::no_length, ProgressBar::new);
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
}

/// What comes from logs must not steer a terminal.
pub(super) fn harmless(text: &str) -> String {
    text.chars().map(|c| if c.is_control() && c != '\n' { char::REPLACEMENT_CHARACTER } else { c }).collect()
}

/// Writes a result to `file`, or to `out`.
pub(super) fn deliver(text: &str, file: Option<&Path>, out: &mut impl Write) -> Result<(), CliError> {
    match file {
        None => Ok(out.write_all(text.as_bytes())?),
        Some(path) => write_atomically(path, |file| Ok(file.write_all(text.as_bytes())?)),
    }
}

/// The file that a text is to go to; `None` for standard output, whatever it is called.
pub(super) fn text_file(output: Option<&Path>) -> Option<&Path> {
    output.filter(|path| !is_stdout(path))
}

/// Refuses a log on standard output, which says what was done.
pub(super) fn spare_stdout(output: Option<&Path>) -> Result<(), CliError> {
    if output.is_some_and(is_stdout) { Err(CliError::NoText) } else { Ok(()) }
}

fn is_stdout(path: &Path) -> bool {
    ["-", "/dev/stdout", "/dev/fd/1"].iter().any(|name| path == Path::new(name))
}

/// Refuses a page on a terminal: a megabyte of markup tells nobody anything.
pub(super) fn spare_terminal(html: bool, file: Option<&Path>) -> Result<(), CliError> {
    if html && file.is_none() && std::io::stdout().is_terminal() { Err(CliError::Terminal) } else { Ok(()) }
}

/// Says remarks where a person sees them, whatever the format of the result.
pub(super) fn say_remarks(remarks: &Remarks, err: &mut impl Write) {
    for remark in remarks.as_slice() {
        let text = harmless(&remark.message).replace('\n', "\u{fffd}");
        // A closed standard error does not make the result wrong.
        let _ = writeln!(err, "{DOUBT}remark:{DOUBT:#} {} x{}: {text}", remark.code.name(), remark.count);
    }
}

/// Says which limits are not kept; returns whether there are any.
pub(super) fn say_broken(verdicts: &[Sentence], err: &mut impl Write) -> bool {
    let broken = || verdicts.iter().filter(|verdict| verdict.is_broken());
    for verdict in broken() {
        let _ = writeln!(err, "{FAILED}gate:{FAILED:#} {}", harmless(&verdict.to_string()));
    }
    broken().next().is_some()
}

/// Refuses to write over what is read: a log may be the only copy of a run.
pub(super) fn spare_inputs(output: Option<&Path>, inputs: &[std::path::PathBuf]) -> Result<(), CliError> {
    let same = |a: &Path, b: &Path| a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b));
    match output.filter(|output| inputs.iter().any(|input| same(input, output))) {
        Some(output) => Err(CliError::Overwrite(output.to_owned())),
        None => Ok(()),
    }
}
