//! Which files a report is of.

use std::{
    io::{self, Read},
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::{
    input_file,
    log::{Input, ReadAt, recording_files, remote},
    remark::Remarks,
};

/// A file of the run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct LogFile {
    /// Its name, without its folder.
    pub name: String,
    /// Its length.
    pub bytes: u64,
    /// SHA-256 of its content, in hexadecimal digits; `None` if it can no longer be read.
    pub sha256: Option<String>,
}

/// The files of a run by name, whatever the order in which they were given.
pub fn log_files(paths: &[PathBuf]) -> Vec<LogFile> {
    let files = recording_files(paths, &mut Remarks::default()).unwrap_or_else(|_| paths.to_vec());
    let mut files: Vec<LogFile> = files.iter().map(|path| log_file(path)).collect();
    files.sort_by(|a, b| a.name.cmp(&b.name));
    files
}

/// The same, of files or not.
pub(super) fn input_files(inputs: &[Input]) -> Vec<LogFile> {
    let mut files: Vec<LogFile> = Vec::new();
    for input in inputs {
        let found = match input {
            Input::Path(path) => {
                files.extend(log_files(std::slice::from_ref(path)));
                continue;
            }
            Input::Bytes { data, .. } => digest(&mut data.as_slice()),
            Input::Reader { reader, .. } => {
                Stream::of(reader.as_ref()).and_then(|mut whole| digest(&mut whole))
            }
        };
        files.push(named(input.name(), found.ok()));
    }
    files.sort_by(|a, b| a.name.cmp(&b.name));
    files
}

/// A reader from its start to its end.
struct Stream<'a> {
    reader: &'a dyn ReadAt,
    at: u64,
    end: u64,
}

impl<'a> Stream<'a> {
    fn of(reader: &'a dyn ReadAt) -> io::Result<Self> {
        Ok(Self { reader, at: 0, end: reader.length()? })
    }
}

impl Read for Stream<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        // Whatever the reader says: no more than there is, and than was asked for.
        let left = usize::try_from(self.end.saturating_sub(self.at)).unwrap_or(usize::MAX);
        let most = into.len().min(left);
        let count = if most > 0 { self.reader.read_at(&mut into[..most], self.at)?.min(most) } else { 0 };
        self.at += count as u64;
        Ok(count)
    }
}

fn log_file(path: &Path) -> LogFile {
    if remote::is_address(path) && !path.exists() {
        let digest = remote::object(&path.to_string_lossy())
            .ok()
            .and_then(|found| digest(&mut Stream::of(found.open().as_ref()).ok()?).ok());
        return named(path, digest);
    }
    // What came through a pipe does not come again.
    let file = path.is_file().then(|| input_file::open(path));
    named(path, file.and_then(|file| digest(&mut file.ok()?).ok()))
}

fn named(path: &Path, digest: Option<(u64, String)>) -> LogFile {
    LogFile {
        name: path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned(),
        bytes: digest.as_ref().map_or(0, |(bytes, _)| *bytes),
        sha256: digest.map(|(_, sha256)| sha256),
    }
}

/// Sixteen hexadecimal digits of the SHA-256 of some texts.
pub(crate) fn hash(texts: impl IntoIterator<Item = impl AsRef<str>>) -> String {
    let mut hash = Sha256::new();
    for text in texts {
        let text = text.as_ref();
        hash.update((text.len() as u64).to_le_bytes());
        hash.update(text);
    }
    let mut digits = format!("{:x}", hash.finalize());
    digits.truncate(16);
    digits
}

fn digest(file: &mut impl Read) -> io::Result<(u64, String)> {
    let (mut hash, mut length, mut buffer) = (Sha256::new(), 0, vec![0; 1 << 16]);
    loop {
        match file.read(&mut buffer) {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
            Ok(0) => return Ok((length, format!("{:x}", hash.finalize()))),
            Ok(count) => {
                hash.update(&buffer[..count]);
                length += count as u64;
            }
        }
    }
}
