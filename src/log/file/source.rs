//! The bytes of a file, read as they are wanted. What the file does meanwhile costs an error or bytes that are missing:
//! memory that is a file would end the process where a file is cut.

use std::{
    fs::File,
    io::{self, Read},
    path::Path,
};

use super::span::Span;
use crate::input_file;

/// A file that is open, of the length that it had then.
#[derive(Debug)]
pub(in crate::log) struct Source {
    inner: Inner,
    length: u64,
}

#[derive(Debug)]
enum Inner {
    File(File),
    Memory(Vec<u8>),
}

impl Source {
    /// Opens a file. What has no length, as a pipe, is read to its end.
    pub(in crate::log) fn open(path: &Path) -> io::Result<Self> {
        Self::of(input_file::open(path)?)
    }

    /// A file that is open.
    pub(in crate::log) fn of(mut file: File) -> io::Result<Self> {
        let found = file.metadata()?;
        if found.is_file() {
            return Ok(Self { inner: Inner::File(file), length: found.len() });
        }
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes)?;
        Ok(bytes.into())
    }

    pub(in crate::log) fn length(&self) -> u64 {
        self.length
    }

    /// Writes all of it.
    #[cfg_attr(not(feature = "sqlite"), expect(dead_code, reason = "for databases that are unpacked"))]
    pub(in crate::log) fn copy(&self, into: &mut impl io::Write) -> io::Result<()> {
        const PIECE: u64 = 1 << 20;
        let mut bytes = Vec::new();
        let mut at = 0;
        while at < self.length {
            self.read(Span { start: at, end: at + PIECE }, &mut bytes)?;
            if bytes.is_empty() {
                break;
            }
            into.write_all(&bytes)?;
            at += bytes.len() as u64;
        }
        Ok(())
    }

    /// All of it.
    pub(in crate::log) fn whole(&self) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.read(Span { start: 0, end: self.length }, &mut bytes)?;
        Ok(bytes)
    }

    /// The bytes of a span, in place of what `into` holds; fewer where the file ends before.
    pub(in crate::log) fn read(&self, span: Span, into: &mut Vec<u8>) -> io::Result<()> {
        let end = span.end.min(self.length);
        let length = usize::try_from(end.saturating_sub(span.start))
            .map_err(|_| io::Error::from(io::ErrorKind::OutOfMemory))?;
        into.clear();
        into.try_reserve(length).map_err(|_| io::Error::from(io::ErrorKind::OutOfMemory))?;
        match &self.inner {
            Inner::Memory(bytes) => {
                let start = usize::try_from(span.start).unwrap_or(usize::MAX);
                into.extend(bytes.iter().skip(start).take(length));
            }
            Inner::File(file) => {
                into.resize(length, 0);
                let mut filled = 0;
                while filled < length {
                    match read_at(file, &mut into[filled..], span.start + filled as u64) {
                        Ok(0) => break,
                        Ok(count) => filled += count,
                        Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                        Err(error) => {
                            into.clear();
                            return Err(error);
                        }
                    }
                }
                into.truncate(filled);
            }
        }
        Ok(())
    }
}

impl From<Vec<u8>> for Source {
    fn from(bytes: Vec<u8>) -> Self {
        Self { length: bytes.len() as u64, inner: Inner::Memory(bytes) }
    }
}

#[cfg(unix)]
fn read_at(file: &File, into: &mut [u8], at: u64) -> io::Result<usize> {
    std::os::unix::fs::FileExt::read_at(file, into, at)
}

#[cfg(windows)]
fn read_at(file: &File, into: &mut [u8], at: u64) -> io::Result<usize> {
    std::os::windows::fs::FileExt::seek_read(file, into, at)
}
