//! The files of one run: opened and scanned once, however often they are read and copied.

use std::{
    cell::Cell,
    path::{Path, PathBuf},
};

use super::{
    bag,
    error::LogError,
    file::{Layout, Source, Span, scan},
};
use crate::remark::{Code, Remarks};

/// The files of one run, open.
#[derive(Debug)]
pub struct LogFiles {
    files: Vec<(PathBuf, Source)>,
    /// Whether their order is known, as in a bag; single files are ordered by the recorder's clock.
    ordered: bool,
    remarks: Remarks,
}

/// The files of one run and where everything is in them.
#[derive(Debug)]
pub struct ScannedLog<'a> {
    pub(super) files: Vec<ScannedFile<'a>>,
    pub(super) ordered: bool,
    pub(super) remarks: Remarks,
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
}

thread_local! {
    static PASSES: Cell<Passes> = const { Cell::new(Passes { opened: 0, scanned: 0, decoded: 0 }) };
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
        let mut remarks = Remarks::default();
        let ordered = paths.iter().any(|path| path.is_dir());
        let open = |path: PathBuf| {
            count(|passes| passes.opened += 1);
            let source = Source::open(&path).map_err(LogError::file("open", &path))?;
            Ok((path, source))
        };
        let files =
            bag::recording_files(paths, &mut remarks)?.into_iter().map(open).collect::<Result<_, _>>()?;
        Ok(Self { files, ordered, remarks })
    }

    /// Finds the records of all files.
    ///
    /// # Errors
    ///
    /// [`LogError::NotMcap`] or [`LogError::IsTable`].
    pub fn scan(&self) -> Result<ScannedLog<'_>, LogError> {
        let files = self.files.iter().map(|(path, source)| ScannedFile::of(path, source));
        let files = files.collect::<Result<_, _>>()?;
        Ok(ScannedLog { files, ordered: self.ordered, remarks: self.remarks.clone() })
    }
}

impl<'a> ScannedFile<'a> {
    pub(super) fn of(path: &'a Path, source: &'a Source) -> Result<Self, LogError> {
        count(|passes| passes.scanned += 1);
        let Some(layout) = scan(source) else {
            let mut start = Vec::new();
            source.read(LOOKED_AT, &mut start).map_err(LogError::file("read", path))?;
            return Err(not_mcap(path, &start));
        };
        Ok(Self { path, source, layout })
    }

    /// Its name without the path.
    pub(super) fn name(&self) -> String {
        self.path.file_name().unwrap_or_default().to_string_lossy().into_owned()
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

fn not_mcap(path: &Path, bytes: &[u8]) -> LogError {
    if is_table(path, bytes) {
        return LogError::IsTable { path: path.to_owned() };
    }
    let start: Vec<String> = bytes.iter().take(8).map(|byte| format!("{byte:02X}")).collect();
    let fix = match bytes {
        [] => "the file is empty",
        [b'#', b'R', b'O', b'S', ..] => "convert the ROS 1 bag first, for example with rosbags-convert",
        [b'S', b'Q', b'L', b'i', ..] => {
            "convert the SQLite bag first, with `ros2 bag convert` to MCAP storage"
        }
        [0x28, 0xB5, 0x2F, 0xFD, ..] => "decompress it first, with `zstd -d`",
        _ => "give an .mcap recording or a ROS 2 bag directory",
    };
    let found = if start.is_empty() { "nothing".to_owned() } else { start.join(" ") };
    LogError::NotMcap { path: path.to_owned(), found, fix }
}

/// As much of a file as tells what it is if it is no log.
pub(super) const LOOKED_AT: Span = Span { start: 0, end: 4096 };

/// Whether the first bytes of a file are text whose first lines are split alike, or text of a file named as a table.
pub(super) fn is_table(path: &Path, bytes: &[u8]) -> bool {
    const LINES: usize = 3;
    let text = String::from_utf8_lossy(bytes);
    if text.trim().is_empty() || text.chars().any(|c| c.is_control() && !c.is_whitespace()) {
        return false;
    }
    let named = path
        .extension()
        .is_some_and(|ending| ["csv", "tsv"].iter().any(|one| ending.eq_ignore_ascii_case(one)));
    let alike = |separator: char| {
        let lines = text.lines().filter(|line| !line.trim().is_empty() && !line.starts_with('#')).take(LINES);
        let counts: Vec<usize> = lines.map(|line| line.matches(separator).count()).collect();
        counts.len() == LINES && counts[0] > 0 && counts.iter().all(|count| *count == counts[0])
    };
    named || [';', ',', '\t'].into_iter().any(alike)
}
