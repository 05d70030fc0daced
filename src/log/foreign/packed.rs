//! Files that are packed whole: gzip, zstd.

use std::{
    io::{self, Read, Write},
    path::{Path, PathBuf},
};

use crate::{
    atomic_file::Temporary,
    log::file::{Source, Span},
};

/// A packed file gives at most so many times its own bytes, and as many besides: more is no recording.
const MOST_TIMES: u64 = 1000;
const BESIDES: u64 = 64 << 20;

/// Endings of the names of packed files.
const ENDINGS: [&str; 3] = ["gz", "zst", "zstd"];

/// The bytes of a file from the start on.
struct Bytes<'a> {
    source: &'a Source,
    at: u64,
    ahead: Vec<u8>,
}

impl Read for Bytes<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let span = Span { start: self.at, end: self.at.saturating_add(into.len() as u64) };
        self.source.read(span, &mut self.ahead)?;
        into[..self.ahead.len()].copy_from_slice(&self.ahead);
        self.at += self.ahead.len() as u64;
        Ok(self.ahead.len())
    }
}

/// What is packed in a file, in a temporary one; other files as they are. Where the packed bytes break off, what
/// came before counts, as of a recording that was cut.
pub(super) fn unpacked(source: Source) -> io::Result<Source> {
    let mut start = Vec::new();
    source.read(Span { start: 0, end: 4 }, &mut start)?;
    let bytes = Bytes { source: &source, at: 0, ahead: Vec::new() };
    let mut reader: Box<dyn Read + '_> = match start.as_slice() {
        [0x1F, 0x8B, ..] => Box::new(flate2::read::MultiGzDecoder::new(bytes)),
        [0x28, 0xB5, 0x2F, 0xFD] => Box::new(zstd::stream::read::Decoder::new(bytes)?),
        _ => return Ok(source),
    };
    let most = source.length().saturating_mul(MOST_TIMES).saturating_add(BESIDES);
    let (_temporary, mut file) = Temporary::new()?;
    let (mut buffer, mut length) = (vec![0; 1 << 17], 0_u64);
    loop {
        match reader.read(&mut buffer) {
            Ok(0) => break,
            Ok(count) => {
                length += count as u64;
                if length > most {
                    let why =
                        format!("it unpacks to more than {MOST_TIMES} times its {} bytes", source.length());
                    return Err(io::Error::new(io::ErrorKind::InvalidData, why));
                }
                file.write_all(&buffer[..count]).map_err(|error| Temporary::fault(&error))?;
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(_) if length > 0 => break,
            // A block of zstd, up to 128 kB, is unpacked whole or not at all.
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
                let why = "it was cut within the first block that is packed in it, of which nothing can be unpacked; copy it again";
                return Err(io::Error::new(error.kind(), why));
            }
            Err(error) => return Err(error),
        }
    }
    Source::of(file)
}

/// The name without the ending of a packed file.
pub(super) fn name_within(path: &Path) -> PathBuf {
    match path.extension() {
        Some(ending) if ENDINGS.iter().any(|one| ending.eq_ignore_ascii_case(one)) => path.with_extension(""),
        _ => path.to_owned(),
    }
}
