//! The bytes of a file, read as they are wanted. What the file does meanwhile costs an error or bytes that are missing:
//! memory that is a file would end the process where a file is cut.

use std::{
    fmt::Debug,
    fs::File,
    io::{self, Read},
    path::Path,
};

use super::span::Span;
use crate::input_file;

/// Bytes that can be read at any place: an object of a store, a device, a file that a program holds.
pub trait ReadAt: Debug + Send + Sync {
    /// Bytes that there are. Asked once, when the log is opened.
    ///
    /// # Errors
    ///
    /// What keeps it from being known.
    fn length(&self) -> io::Result<u64>;

    /// Reads bytes from the place `at` on; how many came. None is the end.
    ///
    /// # Errors
    ///
    /// What keeps them from being read; [`io::ErrorKind::Interrupted`] is tried again.
    fn read_at(&self, into: &mut [u8], at: u64) -> io::Result<usize>;
}

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
    Reader(Box<dyn ReadAt>),
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
        if is_device(&found) {
            return Err(io::Error::new(
                io::ErrorKind::InvalidInput,
                "it is a device, such as a terminal, and may never end; give a file, or pipe one: `cat FILE | hydrotrace \
                 report -`",
            ));
        }
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes)?;
        Ok(bytes.into())
    }

    /// Bytes elsewhere.
    pub(in crate::log) fn of_reader(reader: Box<dyn ReadAt>) -> io::Result<Self> {
        Ok(Self { length: reader.length()?, inner: Inner::Reader(reader) })
    }

    /// Whether its bytes are those of the file of this name: not unpacked, nor given by a program.
    #[cfg_attr(not(feature = "sqlite"), expect(dead_code, reason = "for databases that are opened by name"))]
    pub(in crate::log) fn lies_at(&self, path: &Path) -> bool {
        matches!(&self.inner, Inner::File(file) if input_file::is_at(file, path))
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
        let more = length.saturating_sub(into.len());
        into.try_reserve(more).map_err(|_| io::Error::from(io::ErrorKind::OutOfMemory))?;
        match &self.inner {
            Inner::Memory(bytes) => {
                let start = usize::try_from(span.start).unwrap_or(usize::MAX);
                into.clear();
                into.extend_from_slice(bytes.get(start..).unwrap_or(&[]).get(..length).unwrap_or(&[]));
            }
            Inner::File(file) => fill(into, length, span.start, |into, at| read_at(file, into, at))?,
            Inner::Reader(reader) => fill(into, length, span.start, |into, at| reader.read_at(into, at))?,
        }
        Ok(())
    }
}

#[cfg(unix)]
fn is_device(found: &std::fs::Metadata) -> bool {
    std::os::unix::fs::FileTypeExt::is_char_device(&found.file_type())
}

#[cfg(not(unix))]
const fn is_device(_: &std::fs::Metadata) -> bool {
    false
}

/// Fills `into` with `length` bytes from `start` on, or with what there is; nothing where reading fails.
fn fill(
    into: &mut Vec<u8>,
    length: usize,
    start: u64,
    read: impl Fn(&mut [u8], u64) -> io::Result<usize>,
) -> io::Result<()> {
    // What is there from before is written over: filling it first would cost as much as reading.
    into.resize(length, 0);
    let mut filled = 0;
    while filled < length {
        match read(&mut into[filled..], start + filled as u64) {
            Ok(0) => break,
            // What says that it read more than it was given room for is not believed.
            Ok(count) => filled = (filled + count).min(length),
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => {
                into.clear();
                return Err(error);
            }
        }
    }
    into.truncate(filled);
    Ok(())
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
