//! `record`: lines that a controller sends become a log as they come.

mod document;
mod doubts;
mod host;
mod later;
mod output;
mod packets;
mod parts;
mod senders;
mod settle;
mod told;
mod unsaved;

use std::{
    io::ErrorKind,
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
    atomic_file::may_write,
    log::{CsvError, CsvOptions, JsonLines, LogWriter, TableStream, WriteError},
    units::seconds_since,
};
use doubts::LeftOut;
use later::Later;
use output::Synced;
use parts::part_name;
use told::FIRST_LINES;
use unsaved::Unsaved;

/// What some programs begin a text in UTF-8 with.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Where the log goes, and what the caller says of the lines.
#[derive(Debug, Clone, Default)]
pub struct Inputs {
    /// The log; the next parts are named NAME-2, NAME-3 and on.
    pub output: PathBuf,
    /// What the caller says of the columns.
    pub options: CsvOptions,
    /// Where a part ends; `None`: nowhere.
    pub part: Option<Part>,
    /// Whether files that are there are replaced; those that were read never are.
    pub replace: bool,
}

/// What comes, or does not.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Came {
    /// A line, without its end.
    Line(Vec<u8>),
    /// What came last, without an end of the line.
    Rest(Vec<u8>),
    /// A moment without a line.
    Pause,
    /// A line that is longer than any row, and was left out.
    TooLong,
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
    #[error(transparent)]
    Csv(#[from] CsvError),
    /// They are of a whole table.
    #[error("{0}; `hydrotrace import` of a file with these lines reads them")]
    ImportReads(CsvError),
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The log cannot be written any more.
    #[error("cannot go on writing {}, after {rows} rows", path.display())]
    Stopped { path: PathBuf, rows: u64, source: WriteError },
    #[error("{} is there already; a recording replaces it with --force only", path.display())]
    Exists { path: PathBuf },
    #[error("cannot create {}", path.display())]
    Create { path: PathBuf, source: std::io::Error },
    #[error("no line came: send a header and rows (CSV), or an object a line (JSON)")]
    Nothing,
    #[error("no line with numbers came, only {lines} of words: send the time and a position of each joint")]
    NoNumbers { lines: u64 },
}

/// Writes the lines that come. Ends with them.
///
/// # Errors
///
/// [`RecordError`]; what was written before stays readable.
pub fn run(
    inputs: &Inputs,
    lines: impl Iterator<Item = Came>,
    mut told: impl FnMut(&Progress),
) -> Result<Recorded, RecordError> {
    let mut recording = Recording::new(inputs);
    for came in lines {
        recording.came(came).map_err(|error| recording.stopped(error))?;
        told(&recording.progress);
    }
    recording.end()
}

struct Recording<'a> {
    inputs: &'a Inputs,
    objects: Option<JsonLines>,
    later: Option<Later>,
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
    /// Stamp of the last row before it, where that is of the same table.
    part_from_ns: Option<i64>,
    /// Whether the columns of the last header cannot be told: rows are left out until the next one.
    lost: bool,
    left_out: LeftOut,
    /// Parts of other recordings among the names, which were stepped over.
    taken: Vec<PathBuf>,
    /// The number of the last part.
    number: usize,
    unsaved: Unsaved,
    progress: Progress,
}

impl<'a> Recording<'a> {
    fn new(inputs: &'a Inputs) -> Self {
        let progress = Progress { rows: 0, lines: 0, bytes: 0, joints: 0 };
        Self {
            inputs,
            objects: None,
            later: None,
            first: Vec::new(),
            first_lines: 0,
            open: None,
            closed: Vec::new(),
            parts: Vec::new(),
            counter: Arc::default(),
            part_from: progress,
            part_from_ns: None,
            lost: false,
            left_out: LeftOut::default(),
            taken: Vec::new(),
            number: 0,
            unsaved: Unsaved::new(),
            progress,
        }
    }

    fn came(&mut self, came: Came) -> Result<(), RecordError> {
        match came {
            Came::Line(line) => self.line(&line, false)?,
            Came::Rest(line) => self.line(&line, true)?,
            Came::Pause => self.pause()?,
            Came::TooLong => {
                self.progress.lines += 1;
                self.left_out.too_long += 1;
            }
        }
        // What came is put on the disk, however the clock of its rows goes.
        let due = self.unsaved.is_due(self.progress);
        if let Some((_, log)) = self.open.as_mut().filter(|_| due) {
            log.flush()?;
        }
        Ok(())
    }

    fn line(&mut self, line: &[u8], rest: bool) -> Result<(), RecordError> {
        self.progress.lines += 1;
        let mark = if self.progress.lines == 1 { line.strip_prefix(BYTE_ORDER_MARK) } else { None };
        let line = mark.unwrap_or(line);
        if rest && self.objects.is_none() && self.first_lines > 0 {
            // What is wrong with so few lines is said at the end.
            let _ = self.settle(true);
        }
        if rest && self.objects.is_none() && self.open.is_some() {
            self.write(line, true)
        } else {
            self.take(line)
        }
    }

    /// Where the disk was the reason, which log it was.
    fn stopped(&self, error: RecordError) -> RecordError {
        match (error, self.parts.last()) {
            (RecordError::Write(source), Some(path)) => {
                RecordError::Stopped { path: path.clone(), rows: self.progress.rows, source }
            }
            (error, _) => error,
        }
    }

    fn take(&mut self, line: &[u8]) -> Result<(), RecordError> {
        let settled = self.open.is_some() || !self.closed.is_empty();
        if self.objects.is_none() && !settled && JsonLines::is_object(line) && is_words(&self.first) {
            self.left_out.words += std::mem::take(&mut self.first_lines) as u64;
            self.first.clear();
            self.objects = Some(told::objects(&self.inputs.options));
        }
        if self.objects.is_some() && !settled && self.first_lines == 0 && !JsonLines::has_number(line) {
            self.left_out.words += 1;
            return Ok(());
        }
        if self.keeps_back(line) {
            return self.keep_back(line);
        }
        let text = match &mut self.objects {
            Some(objects) if self.open.is_none() => {
                if !objects.gather(line) {
                    self.left_out.unread += 1;
                    return Ok(());
                }
                self.first_lines += 1;
                let due = self.first_lines.is_multiple_of(FIRST_LINES);
                return if due { self.settle(false) } else { Ok(()) };
            }
            Some(objects) => {
                let Some(text) = objects.row(line) else {
                    self.left_out.unread += 1;
                    return Ok(());
                };
                text.into_bytes()
            }
            None => [line, b"\n"].concat(),
        };
        if self.open.is_none() {
            if self.objects.is_none() && self.steps_over(&text) {
                return Ok(());
            }
            self.first.extend(text);
            self.first_lines += 1;
            return if self.first_lines >= FIRST_LINES { self.settle(false) } else { Ok(()) };
        }
        self.write(&text, false)
    }

    /// A moment without a line: what is kept back for the next one is written.
    fn pause(&mut self) -> Result<(), RecordError> {
        self.settle(false)?;
        self.settle_later(false)?;
        let rest = self.objects.as_mut().filter(|_| self.open.is_some()).map(JsonLines::rest);
        self.write(&rest.unwrap_or_default().into_bytes(), false)
    }

    /// Writes lines, or what came last without an end.
    fn write(&mut self, text: &[u8], rest: bool) -> Result<(), RecordError> {
        let Some((stream, log)) = self.open.as_mut().filter(|_| !text.is_empty()) else { return Ok(()) };
        if rest {
            stream.write_rest(text, log)?;
        } else {
            stream.write(text, log)?;
        }
        self.progress.rows = stream.rows() + self.closed.iter().map(TableStream::rows).sum::<u64>();
        self.progress.bytes = self.counter.load(Ordering::Relaxed);
        let ends = match self.inputs.part {
            None => false,
            Some(Part::Bytes(most)) => self.progress.bytes >= most,
            Some(Part::Seconds(most_s)) => stream.span_ns().is_some_and(|[first_ns, last_ns]| {
                seconds_since(self.part_from_ns.unwrap_or(first_ns), last_ns) >= most_s
            }),
        };
        let is_over = stream.is_over();
        if (ends || is_over)
            && let Some((stream, log)) = self.open.take()
        {
            log.finish()?;
            self.part_from = self.progress;
            self.part_from_ns = stream.span_ns().filter(|_| !is_over).map(|[_, last_ns]| last_ns);
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

    /// The next name that is free, or may be replaced: a recording that runs does not end for one that is taken.
    fn next_part(&mut self) -> Result<Synced, RecordError> {
        loop {
            self.number += 1;
            let path = part_name(&self.inputs.output, self.number);
            let is_first = self.number == 1;
            let replaces = self.inputs.replace && path.is_file() && may_write(&path).is_ok();
            let file = if is_first || replaces || !path.exists() {
                Synced::create(&path, self.inputs.replace)
            } else {
                Err(ErrorKind::AlreadyExists.into())
            };
            let file = match file.map_err(|error| (error.kind(), error)) {
                Ok(file) => file,
                Err((ErrorKind::AlreadyExists, _)) if is_first => return Err(RecordError::Exists { path }),
                Err((ErrorKind::AlreadyExists, _)) => {
                    self.taken.push(path);
                    continue;
                }
                Err((_, source)) => return Err(RecordError::Create { path, source }),
            };
            self.parts.push(path);
            self.counter = file.counter();
            return Ok(file);
        }
    }

    fn end(mut self) -> Result<Recorded, RecordError> {
        if self.progress.lines == 0 {
            return Err(RecordError::Nothing);
        }
        if self.objects.is_some() && self.first_lines == 0 {
            return Err(RecordError::NoNumbers { lines: self.left_out.words });
        }
        // A last header without rows is no part.
        while self.open.is_none() && !self.lost && (self.closed.is_empty() || self.first_lines > 1) {
            self.settle(true)?;
        }
        self.settle_later(true).and_then(|()| self.pause()).map_err(|error| self.stopped(error))?;
        if let Some((stream, log)) = self.open.take() {
            log.finish().map_err(|error| self.stopped(error.into()))?;
            self.closed.push(stream);
            // A last part that nothing came for is none.
            let empty = self.parts.len() > 1 && self.progress.rows == self.part_from.rows;
            if let Some(path) = self.parts.pop_if(|_| empty) {
                std::fs::remove_file(&path).map_err(|source| RecordError::Create { path, source })?;
            }
        }
        let Some(last) = self.closed.last() else { return Err(RecordError::Nothing) };
        Ok(Recorded::new(&self.parts, &self.progress, last.understood(), self.remarks()))
    }
}

/// Whether no cell of the lines is a number, whatever separates them.
fn is_words(lines: &[u8]) -> bool {
    let text = String::from_utf8_lossy(lines);
    text.split([',', ';', '\t', ' ', '\n']).all(|cell| cell.trim().parse::<f64>().is_err())
}
