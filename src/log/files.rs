//! The files of one run: opened and scanned once, however often they are read and copied.

use std::{
    cell::Cell,
    path::{Path, PathBuf},
};

use super::{
    bag,
    csv::CsvOptions,
    error::LogError,
    file::{Layout, Source, scan},
    input::Input,
    looks::LOOKED_AT,
    options::ReadOptions,
    remote,
    unread::unread,
};
use crate::{
    remark::{Code, Remarks},
    text::shell_argument,
};

/// The files of one run, open.
#[derive(Debug)]
pub struct LogFiles {
    files: Vec<(PathBuf, Source)>,
    /// Whether their order is known, as in a bag; single files are ordered by the recorder's clock.
    ordered: bool,
    /// Whether a recorder says that they belong together, as in a bag with its description.
    described: bool,
    remarks: Remarks,
}

/// The files of one run and where everything is in them.
#[derive(Debug)]
pub struct ScannedLog<'a> {
    pub(super) files: Vec<ScannedFile<'a>>,
    pub(super) ordered: bool,
    pub(super) described: bool,
    pub(super) remarks: Remarks,
}

impl<'a> ScannedLog<'a> {
    /// The files in the order of the run.
    pub(super) fn in_order(&self) -> Vec<&ScannedFile<'a>> {
        let mut files: Vec<&ScannedFile<'a>> = self.files.iter().collect();
        if !self.ordered {
            files.sort_by_cached_key(|file| (begins_ns(&file.layout), file.path));
        }
        files
    }
}

/// When the recorder received the first message of a file, ns; `u64::MAX` if it has no message.
fn begins_ns(layout: &Layout) -> u64 {
    layout.blocks.iter().map(|block| block.begins_ns).find(|ns| *ns > 0).unwrap_or(u64::MAX)
}

/// One file.
#[derive(Debug)]
pub(super) struct ScannedFile<'a> {
    pub(super) path: &'a Path,
    pub(super) source: &'a Source,
    pub(super) layout: Layout,
}

/// How often files of logs were opened, scanned and decoded by the current thread.
#[doc(hidden)]
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Passes {
    pub opened: u64,
    pub scanned: u64,
    pub decoded: u64,
    /// Chunks that were read for their messages.
    pub blocks: u64,
}

thread_local! {
    static PASSES: Cell<Passes> = const { Cell::new(Passes { opened: 0, scanned: 0, decoded: 0, blocks: 0 }) };
}

/// The counts so far, for tests.
#[doc(hidden)]
pub fn passes() -> Passes {
    PASSES.get()
}

/// Counts a pass.
pub(super) fn count(add: impl Fn(&mut Passes)) {
    let mut passes = PASSES.get();
    add(&mut passes);
    PASSES.set(passes);
}

impl LogFiles {
    /// Opens the files of one run; a bag directory stands for its files.
    ///
    /// # Errors
    ///
    /// [`LogError`] if a file cannot be opened, or a directory is no bag.
    pub fn open(paths: &[PathBuf]) -> Result<Self, LogError> {
        Self::of(paths.iter().cloned().map(Input::Path).collect())
    }

    /// Opens what one run lies in, files or not.
    ///
    /// # Errors
    ///
    /// As [`LogFiles::open`].
    pub fn of(inputs: Vec<Input>) -> Result<Self, LogError> {
        Self::opened(inputs, &CsvOptions::default())
    }

    /// The same, to be read with options: tables by their map.
    ///
    /// # Errors
    ///
    /// As [`LogFiles::open`]; [`LogError::Map`].
    pub fn with(
        inputs: impl IntoIterator<Item = impl Into<Input>>,
        options: &ReadOptions,
    ) -> Result<Self, LogError> {
        let columns = options.columns().map_err(|error| LogError::Map(Box::new(error)))?;
        let inputs = inputs.into_iter().map(Into::into).collect();
        Self::opened(inputs, &columns).map_err(|error| error.given(options))
    }

    fn opened(inputs: Vec<Input>, columns: &CsvOptions) -> Result<Self, LogError> {
        let (mut remarks, mut doubts) = (Remarks::default(), Remarks::default());
        let (mut files, mut ordered, mut described) = (Vec::new(), false, false);
        for input in inputs {
            let parts = match resolved(input)? {
                Input::Path(path) => {
                    ordered |= path.is_dir();
                    described |= path.join(bag::DESCRIPTION).is_file();
                    let parts = bag::recording_files(&[path], &mut remarks)?;
                    parts.into_iter().map(Input::Path).collect()
                }
                other => vec![other],
            };
            for part in parts {
                count(|passes| passes.opened += 1);
                files.push(part.open(columns, &mut doubts)?);
            }
        }
        remarks.extend(doubts);
        Ok(Self { files, ordered, described, remarks })
    }

    pub(super) fn sources(&self) -> impl Iterator<Item = (&Path, &Source)> {
        self.files.iter().map(|(path, source)| (path.as_path(), source))
    }

    /// Doubts that came up when they were opened.
    pub(super) fn remarks(&self) -> &Remarks {
        &self.remarks
    }

    /// Finds the records of all files.
    ///
    /// # Errors
    ///
    /// [`LogError::NotMcap`].
    pub fn scan(&self) -> Result<ScannedLog<'_>, LogError> {
        let (log, others) = self.scan_logs();
        others.into_iter().next().map_or(Ok(log), Err)
    }

    /// Finds the records of the files that are logs, and says of the others why they are none.
    pub(super) fn scan_logs(&self) -> (ScannedLog<'_>, Vec<LogError>) {
        let Self { ordered, described, .. } = *self;
        let mut log = ScannedLog { files: Vec::new(), ordered, described, remarks: self.remarks.clone() };
        let mut others = Vec::new();
        for (path, source) in &self.files {
            match ScannedFile::all(path, source) {
                Ok(files) => log.files.extend(one_behind_another(files, &mut log.remarks)),
                Err(error) => others.push(error),
            }
        }
        (log, others)
    }
}

impl<'a> ScannedFile<'a> {
    /// The recordings of a file, one behind another; at least one.
    pub(super) fn all(path: &'a Path, source: &'a Source) -> Result<Vec<Self>, LogError> {
        count(|passes| passes.scanned += 1);
        let layouts = scan(source);
        if layouts.is_empty() {
            let mut start = Vec::new();
            source.read(LOOKED_AT, &mut start).map_err(LogError::file("read", path))?;
            return Err(not_mcap(path, &start));
        }
        Ok(layouts.into_iter().map(|layout| Self { path, source, layout }).collect())
    }

    /// Its name without the path.
    pub(super) fn name(&self) -> String {
        file_name(self.path)
    }

    /// Remarks on the outer structure of a file.
    pub(super) fn remark_damage(&self, remarks: &mut Remarks) {
        let (name, damage) = (self.name(), self.layout.damage);
        if let Some(fault) = &self.layout.fault {
            let message = format!("{name} could not be read to its end: {fault}; read as far as that");
            remarks.add(Code::DamagedBytes, 1, message);
        }
        remarks.add(
            Code::NotClosed,
            u64::from(damage.not_closed),
            format!(
                "{name} was not closed (power loss, or a kill while recording); read up to its last whole message"
            ),
        );
        remarks.add(
            Code::DamagedBytes,
            damage.skipped_bytes,
            format!("bytes of {name} that are no record, skipped"),
        );
        remarks.add(
            Code::DamagedBytes,
            damage.broken_attachments,
            format!("attachments of {name} with a wrong checksum, dropped"),
        );
        remarks.add(
            Code::DamagedBytes,
            u64::from(damage.broken_summary),
            format!("summary of {name} with a wrong checksum, not used"),
        );
        remarks.add(
            Code::DamagedBytes,
            u64::from(damage.broken_data),
            format!("data of {name} with a wrong checksum and no chunks to tell where; numbers may be wrong"),
        );
    }
}

/// The recordings of a file that go on where the ones before them ended, as of a recorder that was started again.
fn one_behind_another<'a>(files: Vec<ScannedFile<'a>>, remarks: &mut Remarks) -> Vec<ScannedFile<'a>> {
    let mut kept: Vec<ScannedFile<'_>> = Vec::new();
    for file in files {
        match kept.last().map(|last| begins_ns(&last.layout)) {
            Some(before_ns) if begins_ns(&file.layout) <= before_ns => {
                let (name, at) = (file.name(), file.layout.starts_at);
                let word = shell_argument(file.path);
                let message = format!(
                    "another recording stands at byte {at} of {name} that begins no later than the one before it; it is left out: `tail -c \
                     +{} {word} > other.mcap` makes it a file of its own",
                    at + 1
                );
                remarks.add(Code::DamagedBytes, 1, message);
            }
            Some(_) => {
                let message = format!(
                    "recordings stand one behind another in {}; they are read as files of one run",
                    file.name()
                );
                remarks.add(Code::DamagedBytes, 1, message);
                kept.push(file);
            }
            None => kept.push(file),
        }
    }
    kept
}

/// What a path names: a file, or the bytes of an address.
fn resolved(input: Input) -> Result<Input, LogError> {
    match input {
        Input::Path(path) if remote::is_address(&path) && !path.exists() => {
            let name = path.to_string_lossy().into_owned();
            let reader = remote::object(&name)?.open();
            Ok(Input::Reader { name, reader })
        }
        other => Ok(other),
    }
}

/// The name of a file without its path.
pub(super) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn not_mcap(path: &Path, bytes: &[u8]) -> LogError {
    if bytes.is_empty() {
        return LogError::Empty { path: path.to_owned() };
    }
    let start: Vec<String> = bytes.iter().take(8).map(|byte| format!("{byte:02X}")).collect();
    let (what, fix) = match unread(bytes) {
        Some((what, fix)) => (Some(what), fix),
        None => (None, "give an .mcap recording or a ROS 2 bag directory"),
    };
    let found = start.join(" ");
    LogError::NotMcap { path: path.to_owned(), found, what, fix }
}
