//! The bytes of an object, fetched in blocks of which the last few are kept.

use std::{
    collections::VecDeque,
    io,
    ops::Range,
    sync::{Arc, Mutex, PoisonError},
};

use bytes::Bytes;
use object_store::{GetOptions, ObjectStore, path::Path};

use super::{
    Opener,
    request::{reason, wait},
};
use crate::log::file::ReadAt;

/// Objects up to this size are fetched at once: asking takes as long as some megabytes do.
const WHOLE_BYTES: u64 = 32 << 20;
/// Blocks of larger ones.
const BLOCK_BYTES: u64 = 8 << 20;
/// Blocks that are kept.
const KEPT: usize = 4;

/// An object as it was listed.
#[derive(Debug, Clone)]
pub(super) struct Held {
    pub(super) store: Arc<dyn ObjectStore>,
    pub(super) path: Path,
    pub(super) bytes: u64,
    /// Its tag, where the store gives one that can be compared.
    pub(super) tag: Option<String>,
}

impl Opener for Held {
    fn open(&self) -> Box<dyn ReadAt> {
        Box::new(Reader { held: self.clone(), blocks: Mutex::default() })
    }
}

#[derive(Debug)]
struct Reader {
    held: Held,
    /// Blocks by their starts, the one that was fetched last at the end.
    blocks: Mutex<VecDeque<(u64, Bytes)>>,
}

impl ReadAt for Reader {
    fn length(&self) -> io::Result<u64> {
        Ok(self.held.bytes)
    }

    fn read_at(&self, into: &mut [u8], at: u64) -> io::Result<usize> {
        if at >= self.held.bytes || into.is_empty() {
            return Ok(0);
        }
        let size = if self.held.bytes <= WHOLE_BYTES { WHOLE_BYTES } else { BLOCK_BYTES };
        let start = at / size * size;
        let mut blocks = self.blocks.lock().unwrap_or_else(PoisonError::into_inner);
        let found = blocks.iter().find(|(own, _)| *own == start).map(|(_, bytes)| bytes.clone());
        let block = if let Some(block) = found {
            block
        } else {
            let block = self.held.fetch(start..(start + size).min(self.held.bytes))?;
            if blocks.len() == KEPT {
                blocks.pop_front();
            }
            blocks.push_back((start, block.clone()));
            block
        };
        drop(blocks);
        // Below the size of a block, and `fetch` gave all of it.
        let skip = usize::try_from(at - start).unwrap_or(usize::MAX);
        let rest = block.get(skip..).unwrap_or_default();
        let count = rest.len().min(into.len());
        into[..count].copy_from_slice(&rest[..count]);
        Ok(count)
    }
}

impl Held {
    /// The bytes of a range, all of them.
    fn fetch(&self, range: Range<u64>) -> io::Result<Bytes> {
        let expected = range.end - range.start;
        // A web server that knows no ranges gives whole objects.
        let range = (expected < self.bytes).then(|| range.into());
        let options = GetOptions { range, if_match: self.tag.clone(), ..GetOptions::default() };
        let fetched = wait(async { self.store.get_opts(&self.path, options).await?.bytes().await })?;
        let fetched = fetched.map_err(|error| io::Error::other(reason(&error)))?;
        if fetched.len() as u64 == expected {
            Ok(fetched)
        } else {
            let found = fetched.len();
            Err(io::Error::other(format!("{found} bytes came, expected {expected}: was the object changed?")))
        }
    }
}
