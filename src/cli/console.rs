//! Where results go: standard output, or a file that appears whole or not at all; and what is said beside them.

use std::{
    fmt::Display,
    io::{ErrorKind, IsTerminal, Write},
    path::{Path, PathBuf},
};

use anstream::ColorChoice;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;
use terminal_size::{Width, terminal_size_of};

use super::{
    CliError, Outcome,
    terminal::{DOUBT, FAILED, harmless},
};
use crate::{
    atomic_file::{may_write, write_atomically},
    document::pretty,
    input_file::will_read,
    log::WRITTEN,
    remark::Remarks,
    render::kit::{self, Document, Sentence, TerminalStyle},
};

/// Standard output for the result, standard error for words beside it.
pub(super) struct Console<'a> {
    out: &'a mut dyn Write,
    err: &'a mut dyn Write,
    quiet: bool,
}

impl<'a> Console<'a> {
    pub(super) fn new(out: &'a mut dyn Write, err: &'a mut dyn Write, quiet: bool) -> Self {
        Self { out, err, quiet }
    }

    pub(super) fn print(&mut self, text: &str) -> Result<(), CliError> {
        read_or_left(self.out.write_all(text.as_bytes())).map_err(CliError::Output)
    }

    /// The same at once, before the verb ends.
    pub(super) fn announce(&mut self, text: &str) -> std::io::Result<()> {
        self.out.write_all(text.as_bytes())?;
        self.out.flush()
    }

    /// Writes a document to standard output, with colours and folded lines on a terminal.
    pub(super) fn show(&mut self, document: &Document) -> Result<(), CliError> {
        self.print(&shown(document))
    }

    /// Says a line on standard error, unless `--quiet`. A closed standard error does not make a result wrong.
    pub(super) fn say(&mut self, line: impl Display) {
        if !self.quiet {
            let _ = writeln!(self.err, "{line}");
        }
    }

    /// Says remarks, whatever the form of the result.
    pub(super) fn say_remarks(&mut self, remarks: &Remarks) {
        for remark in remarks.as_slice() {
            let text = harmless(&remark.message).replace('\n', "\u{fffd}");
            let (code, count) = (remark.code.name(), remark.count);
            self.say(format_args!("{DOUBT}remark:{DOUBT:#} {code} x{count}: {text}"));
        }
    }

    /// The end of every verb: writes the result, says what it does not show, and tells how the run ended.
    pub(super) fn finish(
        &mut self,
        target: &Target<'_>,
        result: &str,
        remarks: &Remarks,
        verdicts: &[Sentence],
    ) -> Result<Outcome, CliError> {
        match target.file {
            Some(file) => write_file(file, result.as_bytes())?,
            None => self.print(result)?,
        }
        if !target.is_read_at_once() {
            self.say_remarks(remarks);
        }
        let broken: Vec<&Sentence> = verdicts.iter().filter(|verdict| verdict.is_broken()).collect();
        // Why a verb ends with code 4 is said somewhere.
        let says_none = matches!(target.form, Form::Csv | Form::Html);
        for verdict in broken.iter().filter(|_| !self.quiet || says_none) {
            let _ = writeln!(self.err, "{FAILED}gate:{FAILED:#} {}", harmless(&verdict.to_string()));
        }
        Ok(match (broken.is_empty(), remarks.is_empty()) {
            (false, _) => Outcome::LimitBroken,
            (true, false) => Outcome::Remarks,
            (true, true) => Outcome::Clean,
        })
    }

    /// The same of a verb whose result is words, or one JSON document.
    pub(super) fn answer<T: Serialize>(
        &mut self,
        json: bool,
        found: &T,
        words: impl FnOnce() -> Document,
        remarks: &Remarks,
        verdicts: &[Sentence],
    ) -> Result<Outcome, CliError> {
        let target = Target::stdout(json);
        let result = if json { pretty(found) } else { target.text(&words()) };
        self.finish(&target, &result, remarks, verdicts)
    }

    /// Where a table goes row by row.
    pub(super) fn out(&mut self) -> &mut dyn Write {
        self.out
    }

    /// The outcome, if standard output took everything.
    pub(super) fn flushed(&mut self, outcome: Outcome) -> Result<Outcome, CliError> {
        read_or_left(self.out.flush()).map(|()| outcome).map_err(CliError::Output)
    }
}

/// A reader that has left makes a result no better: limits are judged, and doubts told, as if it were there.
fn read_or_left(written: std::io::Result<()>) -> std::io::Result<()> {
    written.or_else(|error| if error.kind() == ErrorKind::BrokenPipe { Ok(()) } else { Err(error) })
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    Text,
    Markdown,
    Json,
    Csv,
    Html,
}

/// Endings of files that are no text, and that no verb writes.
const OTHER_FORMS: [&str; 10] = ["pdf", "xlsx", "xls", "docx", "doc", "odt", "ods", "pptx", "png", "jpg"];

/// Endings that say what a file is.
const ENDINGS: [&str; 14] = [
    "bag", "csv", "db3", "htm", "html", "json", "mcap", "md", "parquet", "toml", "tsv", "txt", "yaml", "yml",
];

impl Form {
    /// What it is called, and the endings of its files.
    const fn named(self) -> (&'static str, &'static [&'static str]) {
        match self {
            Self::Text => ("text", &["txt"]),
            Self::Markdown => ("Markdown", &["md"]),
            Self::Json => ("JSON", &["json"]),
            Self::Csv => ("CSV", &["csv"]),
            Self::Html => ("a page", &["html", "htm"]),
        }
    }

    /// Of the forms that a verb has: the one asked for, else that of the file's ending, else text.
    pub(super) fn of(forms: &[(bool, Self)], file: Option<&Path>) -> Self {
        let asked = forms.iter().find(|(asked, _)| *asked);
        let by_file = || forms.iter().find(|(_, form)| form.named().1.iter().any(|with| ends(file, with)));
        asked.or_else(by_file).map_or(Self::Text, |(_, form)| *form)
    }
}

/// The form of a result, and its file; `None` for standard output.
#[derive(Debug, Clone, Copy)]
pub(super) struct Target<'a> {
    pub(super) form: Form,
    pub(super) file: Option<&'a Path>,
}

impl<'a> Target<'a> {
    /// A megabyte of markup on a terminal helps nobody: refused.
    pub(super) fn new(form: Form, file: Option<&'a Path>) -> Result<Self, CliError> {
        let file = file.filter(|path| !is_stdout(path));
        let other = OTHER_FORMS.iter().find(|ending| form == Form::Text && ends(file, ending));
        if let Some(ending) = other {
            return Err(CliError::Usage(format!(
                "no .{ending} is written; a page for a browser ends in .html, and prints as PDF"
            )));
        }
        // An option that says the form outdoes an ending.
        if form == Form::Text {
            let (what, own) = form.named();
            named_as(file, what, own)?;
        }
        if form == Form::Html && file.is_none() && std::io::stdout().is_terminal() {
            let why = "a page is for a browser, not for a terminal; give --output FILE or redirect it";
            return Err(CliError::Usage(why.to_owned()));
        }
        Ok(Self { form, file })
    }

    /// Text on standard output, or JSON.
    pub(super) fn stdout(json: bool) -> Self {
        Self { form: if json { Form::Json } else { Form::Text }, file: None }
    }

    pub(super) fn text(&self, document: &Document) -> String {
        match (self.form, self.file) {
            (Form::Markdown, None) => kit::markdown(document),
            (Form::Markdown, Some(_)) => format!("{}\n<!-- {WRITTEN} -->\n", kit::markdown(document)),
            (_, Some(_)) => format!("{}\n{WRITTEN}\n", kit::text(document)),
            // What is printed is pasted here and now.
            (_, None) => shown(&document.clone().sparing(&|file| Path::new(file).exists())),
        }
    }

    /// Whether remarks are seen in the result itself.
    fn is_read_at_once(&self) -> bool {
        self.file.is_none() && matches!(self.form, Form::Text | Form::Markdown)
    }
}

/// A document for standard output: colours and folded lines only on a terminal.
fn shown(document: &Document) -> String {
    let coloured = matches!(ColorChoice::global(), ColorChoice::Always | ColorChoice::AlwaysAnsi);
    let width = terminal_size_of(std::io::stdout()).map(|(Width(width), _)| usize::from(width));
    kit::shown(document, TerminalStyle { coloured, width })
}

/// Writes a file, whole or not at all.
pub(super) fn write_file(path: &Path, bytes: &[u8]) -> Result<(), CliError> {
    write_atomically(path, |file| file.write_all(bytes).map_err(CliError::Output))
}

pub(super) fn make_folder(path: &Path) -> Result<(), CliError> {
    let failed = CliError::step(format!("cannot make the folder {}", path.display()));
    std::fs::create_dir_all(path).map_err(|error| failed(error.into()))
}

/// A progress bar on standard error; hidden if that is no terminal, with `--verbose` and with `--quiet`.
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

pub(super) fn ends(file: Option<&Path>, with: &str) -> bool {
    file.and_then(Path::extension).is_some_and(|ending| ending.eq_ignore_ascii_case(with))
}

fn is_stdout(path: &Path) -> bool {
    ["-", "/dev/stdout", "/dev/fd/1"].iter().any(|name| path == Path::new(name))
}

/// Refuses an output before any work is done for it: one of the inputs, or what is to be kept.
pub(super) fn spare_inputs(output: Option<&Path>, inputs: &[PathBuf]) -> Result<(), CliError> {
    for input in inputs {
        will_read(input);
    }
    Ok(output.map_or(Ok(()), may_write)?)
}

/// The same of a file that is not text and so does not go to standard output.
pub(super) fn spare_for_file(output: Option<&Path>, inputs: &[PathBuf]) -> Result<(), CliError> {
    spare_inputs(output, inputs)?;
    if output.is_some_and(is_stdout) {
        let why = "standard output is for text; give --output the name of a file";
        return Err(CliError::Usage(why.to_owned()));
    }
    Ok(())
}

/// The same of a log, whose name is not to say that it is something else.
pub(super) fn spare_for_log(output: Option<&Path>, inputs: &[PathBuf]) -> Result<(), CliError> {
    spare_for_file(output, inputs)?;
    named_as(output, "an MCAP log", &["mcap"])
}

/// The same of a page beside an output.
pub(super) fn spare_for_page(
    page: Option<&Path>,
    output: Option<&Path>,
    inputs: &[PathBuf],
) -> Result<(), CliError> {
    spare_for_file(page, inputs)?;
    if page.is_some() && page == output {
        let why = "--output and --html name the same file; give each its own";
        return Err(CliError::Usage(why.to_owned()));
    }
    let (what, own) = Form::Html.named();
    named_as(page, what, own)
}

/// Refuses a file whose ending says that it is something else than what is written to it.
pub(super) fn named_as(file: Option<&Path>, what: &str, own: &[&str]) -> Result<(), CliError> {
    let is = |ending: &&str| ends(file, ending);
    let other = ENDINGS.iter().find(|ending| is(ending) && !own.contains(ending));
    let Some(path) = file.filter(|_| other.is_some()) else { return Ok(()) };
    let named = path.with_extension(own.first().copied().unwrap_or_default());
    let (path, named) = (path.display(), named.display());
    Err(CliError::Usage(format!("what is written to {path} is {what}; name it {named}")))
}
