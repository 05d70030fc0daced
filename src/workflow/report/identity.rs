//! Which files a report is of.

use std::{
    io::{self, Read},
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::{input_file, log::recording_files, remark::Remarks};

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

fn log_file(path: &Path) -> LogFile {
    let digest = digest(path).ok();
    LogFile {
        name: path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned(),
        bytes: digest.as_ref().map_or(0, |(bytes, _)| *bytes),
        sha256: digest.map(|(_, sha256)| sha256),
    }
}

fn digest(path: &Path) -> io::Result<(u64, String)> {
    let mut file = input_file::open(path)?;
    let (mut hash, mut length, mut buffer) = (Sha256::new(), 0, vec![0; 1 << 16]);
    loop {
        match file.read(&mut buffer)? {
            0 => return Ok((length, format!("{:x}", hash.finalize()))),
            count => {
                hash.update(&buffer[..count]);
                length += count as u64;
            }
        }
    }
}
