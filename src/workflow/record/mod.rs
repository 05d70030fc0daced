//! `record`: lines that a controller sends become a log as they come.

mod document;
mod output;
mod parts;
mod senders;

use std::{
    path::PathBuf,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
};

use thiserror::Error;

pub use document::Recorded;
pub use senders::Senders;

use crate::{
    log::{CsvError, CsvOptions, JsonLines, LogWriter, TableStream, WriteError, other_header},
    remark::{Code, Remarks},
};
use output::Synced;
use parts::{part_name, part_pattern};

/// Lines after which the columns are settled, and after which it is given up to settle them.
const FIRST_LINES: usize = 10;
const MOST_LINES: usize = 200;

/// So many objects are waited for while none has a key of the other side.
const ONE_SIDED: usize = 300;

/// Where the log goes, and what the caller says of the lines.
#[derive(Debug, Clone, Default)]
pub struct Inputs {
    /// The log; the next parts are named NAME-2, NAME-3 and on.
    pub output: PathBuf,
    /// What the caller says of the columns.
    pub options: CsvOptions,
    /// Where a part ends; `None`: nowhere.
    pub part: Option<Part>,
    /// Whether a file that is there is replaced.
    pub replace: bool,
}

/// Where a part ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Part {
    /// After so many bytes.
    Bytes(u64),
    /// After so much time by the rows' stamps, s.
    Seconds(f64),
}

/// How far a recording is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Rows that became samples.
    pub rows: u64,
    /// Lines that came.
    pub lines: u64,
    /// Bytes of the part that were handed to the system.
    pub bytes: u64,
    /// Joints; 0 until the columns are settled.
    pub joints: usize,
}

/// Why a recording ended, or never began.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the message says what each field is")]
pub enum RecordError {
    /// The lines are not understood.
    #[error(transparent)]
    Csv(#[from] CsvError),
    /// The log cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// There is a file already.
    #[error("{} is there already; a recording replaces it with --force only", path.display())]
    Exists { path: PathBuf },
    /// The file cannot be made.
    #[error("cannot create {}", path.display())]
    Create { path: PathBuf, source: std::io::Error },
    /// Nothing came.
    #[error("no line came: send a header and rows (CSV), or an object a line (JSON)")]
    Nothing,
    /// Only words came.
    #[error("no line with numbers came, only {lines} of words: send the time and a position of each joint")]
    NoNumbers { lines: u64 },
}

/// Writes the lines that come, each without its end; `None` is a moment without one. Ends with them.
///
/// # Errors
///
/// [`RecordError`]; what was written before stays readable.
pub fn run(
    inputs: &Inputs,
    lines: impl Iterator<Item = Option<Vec<u8>>>,
    mut told: impl FnMut(&Progress),
) -> Result<Recorded, RecordError> {
    let mut recording = Recording::new(inputs);
    for line in lines {
        match line {
            Some(line) => recording.line(&line)?,
            None => recording.pause()?,
        }
        told(&recording.progress);
    }
    recording.end()
}

struct Recording<'a> {
    inputs: &'a Inputs,
    objects: Option<JsonLines>,
    /// Lines until the columns are settled.
    first: Vec<u8>,
    first_lines: usize,
    open: Option<(TableStream, LogWriter<Synced>)>,
    /// What came before the last header with other columns.
    closed: Vec<TableStream>,
    parts: Vec<PathBuf>,
    /// Bytes of the part that is being written.
    counter: Arc<AtomicU64>,
    part_from: Progress,
    unread: u64,
    /// Lines of words before the first object with numbers.
    words: u64,
    /// Lines before another header, whose own columns cannot be told.
    untold: u64,
    progress: Progress,
}

impl<'a> Recording<'a> {
    fn new(inputs: &'a Inputs) -> Self {
        let progress = Progress { rows: 0, lines: 0, bytes: 0, joints: 0 };
        Self {
            inputs,
            objects: None,
            first: Vec::new(),
            first_lines: 0,
            open: None,
            closed: Vec::new(),
            parts: Vec::new(),
            counter: Arc::default(),
            part_from: progress,
            unread: 0,
            words: 0,
            untold: 0,
            progress,
        }
    }

    fn line(&mut self, line: &[u8]) -> Result<(), RecordError> {
        self.progress.lines += 1;
        self.take(line)
    }

    fn take(&mut self, line: &[u8]) -> Result<(), RecordError> {
        let settled = self.open.is_some() || !self.closed.is_empty();
        if self.objects.is_none() && !settled && JsonLines::is_object(line) && is_words(&self.first) {
            self.words += std::mem::take(&mut self.first_lines) as u64;
            self.first.clear();
            let options = &self.inputs.options;
            let named = options.columns.values().flatten().map(|(_, column)| column.clone());
            let named = named.filter(|column| is_key(column));
            self.objects = Some(JsonLines::expecting(named, options.time.clone()));
        }
        if self.objects.is_some() && !settled && self.first_lines == 0 && !JsonLines::has_number(line) {
            self.words += 1;
            return Ok(());
        }
        let text = match &mut self.objects {
            Some(objects) if self.open.is_none() => {
                if !objects.gather(line) {
                    self.unread += 1;
                    return Ok(());
                }
                self.first_lines += 1;
                let due = self.first_lines.is_multiple_of(FIRST_LINES);
                return if due { self.settle(false) } else { Ok(()) };
            }
            Some(objects) => {
                let Some(text) = objects.row(line) else {
                    self.unread += 1;
                    return Ok(());
                };
                text.into_bytes()
            }
            None => [line, b"\n"].concat(),
        };
        if self.open.is_none() {
            self.first.extend(text);
            self.first_lines += 1;
            return if self.first_lines >= FIRST_LINES { self.settle(false) } else { Ok(()) };
        }
        self.write(&text)
    }

    /// A moment without a line: what is kept back for the next one is written.
    fn pause(&mut self) -> Result<(), RecordError> {
        self.settle(false)?;
        let rest = self.objects.as_mut().filter(|_| self.open.is_some()).map(JsonLines::rest);
        self.write(&rest.unwrap_or_default().into_bytes())
    }

    /// Tells the columns by the lines so far, at the latest at the end; until then more of them may help.
    fn settle(&mut self, last: bool) -> Result<(), RecordError> {
        if self.open.is_some() || self.first_lines < 3 && !last {
            return Ok(());
        }
        let name = self.inputs.output.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if let Some(objects) = &mut self.objects {
            if objects.is_growing() && !last && self.first_lines < ONE_SIDED {
                return Ok(());
            }
            self.first = objects.table().into_bytes();
        } else if let Some(at) = other_header(&self.first) {
            return self.settle_each(at);
        }
        let one_sided = |stream: &TableStream| {
            stream.remarks().as_slice().iter().any(|remark| remark.code == Code::OneSide)
        };
        match TableStream::begin(&name, &self.first, &self.inputs.options) {
            // The other side's sensor may not send yet; rows that wait are lost if the power is.
            Ok(stream)
                if self.objects.is_some() && !last && self.first_lines < ONE_SIDED && one_sided(&stream) =>
            {
                Ok(())
            }
            Ok(stream) => {
                if let Some(objects) = &mut self.objects {
                    objects.settle();
                }
                self.progress.joints = stream.understood().joints.len();
                let log = stream.log(self.next_part()?)?;
                self.open = Some((stream, log));
                let first = std::mem::take(&mut self.first);
                self.write(&first)
            }
            Err(CsvError::NoJoints { .. } | CsvError::NoPair { .. })
                if self.objects.is_some() && !last && self.first_lines < ONE_SIDED =>
            {
                Ok(())
            }
            // Rows that are yet to come may settle it; an option that is missing will be missing then.
            Err(CsvError::NoTable { .. } | CsvError::NoTime { .. } | CsvError::TimeUnit { .. })
                if !last && self.first_lines < MOST_LINES =>
            {
                Ok(())
            }
            Err(error) => Err(error.into()),
        }
    }

    /// Another header came before the columns of the first one were settled: each has the rows below it.
    fn settle_each(&mut self, at: usize) -> Result<(), RecordError> {
        let later = self.first.split_off(at);
        let rows = self.first_lines.saturating_sub(later.split_inclusive(|byte| *byte == b'\n').count());
        match self.settle(true) {
            Err(RecordError::Csv(_)) => {
                self.untold += rows as u64;
                self.first.clear();
            }
            settled => settled?,
        }
        self.first_lines = 0;
        later
            .split(|byte| *byte == b'\n')
            .filter(|line| !line.is_empty())
            .try_for_each(|line| self.take(line))
    }

    fn write(&mut self, text: &[u8]) -> Result<(), RecordError> {
        let Some((stream, log)) = self.open.as_mut().filter(|_| !text.is_empty()) else { return Ok(()) };
        stream.write(text, log)?;
        self.progress.rows = stream.rows() + self.closed.iter().map(TableStream::rows).sum::<u64>();
        self.progress.bytes = self.counter.load(Ordering::Relaxed);
        let begun = self.part_from;
        let ends = match self.inputs.part {
            None => false,
            Some(Part::Bytes(most)) => self.progress.bytes >= most,
            Some(Part::Seconds(most_s)) => {
                let rate_hz = stream.understood().time.rate_hz.max(f64::MIN_POSITIVE);
                (self.progress.rows - begun.rows) as f64 >= most_s * rate_hz
            }
        };
        let is_over = stream.is_over();
        if (ends || is_over)
            && let Some((stream, log)) = self.open.take()
        {
            log.finish()?;
            self.part_from = self.progress;
            if is_over {
                // The header is the first line of those that settle the columns anew.
                (self.first, self.first_lines) = (text.to_vec(), 1);
                self.closed.push(stream);
                return Ok(());
            }
            let log = stream.log(self.next_part()?)?;
            self.open = Some((stream, log));
        }
        Ok(())
    }

    fn next_part(&mut self) -> Result<Synced, RecordError> {
        let path = part_name(&self.inputs.output, self.parts.len() + 1);
        let file = Synced::create(&path, self.inputs.replace).map_err(|source| match source.kind() {
            std::io::ErrorKind::AlreadyExists => RecordError::Exists { path: path.clone() },
            _ => RecordError::Create { path: path.clone(), source },
        })?;
        self.parts.push(path);
        self.counter = file.counter();
        Ok(file)
    }

    fn end(mut self) -> Result<Recorded, RecordError> {
        if self.progress.lines == 0 {
            return Err(RecordError::Nothing);
        }
        if self.objects.is_some() && self.first_lines == 0 {
            return Err(RecordError::NoNumbers { lines: self.words });
        }
        // A last header without rows is no part.
        while self.open.is_none() && (self.closed.is_empty() || self.first_lines > 1) {
            self.settle(true)?;
        }
        self.pause()?;
        if let Some((stream, log)) = self.open.take() {
            log.finish()?;
            self.closed.push(stream);
            // A last part that nothing came for is none.
            let empty = self.parts.len() > 1 && self.progress.rows == self.part_from.rows;
            if let Some(path) = self.parts.pop_if(|_| empty) {
                std::fs::remove_file(&path).map_err(|source| RecordError::Create { path, source })?;
            }
        }
        let Some(last) = self.closed.last() else { return Err(RecordError::Nothing) };
        let mut remarks = Remarks::default();
        self.closed.iter().for_each(|stream| remarks.extend(stream.remarks()));
        let message = "lines of words before the first with numbers; left out";
        remarks.add(Code::UndecodableMessage, self.words, message);
        let message = "lines before a header with other columns, whose own columns cannot be told; left out";
        remarks.add(Code::UndecodableMessage, self.untold, message);
        remarks.add(Code::UndecodableMessage, self.unread, "lines that are no JSON object; left out");
        if let Some((keys, lines)) = self.objects.as_ref().and_then(JsonLines::late) {
            let message = format!(
                "lines with keys that came after the columns were settled, and were left out: {keys}; name them before, as \
                 --measured JOINT=KEY, or begin when they are sent"
            );
            remarks.add(Code::NotSupported, lines, message);
        }
        let old = (self.parts.len() + 1..).map(|number| part_name(&self.inputs.output, number));
        let old: Vec<PathBuf> = old.take_while(|path| self.inputs.replace && path.exists()).collect();
        if let Some(first) = old.first() {
            let message = format!(
                "parts of an earlier recording that are still beside this one, from {} on; remove them, or a pattern such as \
                 {} reads both as one run",
                first.display(),
                part_pattern(&self.inputs.output)
            );
            remarks.add(Code::OtherFile, old.len() as u64, message);
        }
        Ok(Recorded::new(&self.parts, &self.progress, last.understood(), remarks))
    }
}

/// Whether no cell of the lines is a number, whatever separates them.
fn is_words(lines: &[u8]) -> bool {
    let text = String::from_utf8_lossy(lines);
    text.split([',', ';', '\t', ' ', '\n']).all(|cell| cell.trim().parse::<f64>().is_err())
}

/// Whether a column as a caller names it is a key, and no number of a column or sum of several.
fn is_key(column: &str) -> bool {
    !column.starts_with('#') && column.chars().all(|c| c.is_alphanumeric() || "_. ".contains(c))
}
