//! A run of messages: a chunk, or messages that stand outside chunks.

use super::{
    compression::{Decompressor, Yield},
    record::{ChunkRecord, Record},
};

/// A run of messages in a file.
#[derive(Debug, Clone, Copy)]
pub(in crate::log) enum Block<'a> {
    /// A chunk's body; `cut` if the file ends within it.
    Chunk { body: &'a [u8], cut: bool },
    /// Records that stand outside chunks.
    Loose(&'a [u8]),
}

/// Bytes that a block lost.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::log) enum Loss {
    Nothing,
    /// The file ends within the block; records before the cut are there.
    Cut,
    /// The block is unusable, and why.
    Dropped(String),
}

/// Opens blocks one after another, reusing buffers; one for each thread.
pub(in crate::log) struct Blocks(Decompressor);

impl Blocks {
    pub(in crate::log) fn new() -> Self {
        Self(Decompressor::new())
    }

    /// The bytes of the block's records, decompressed and checked.
    pub(in crate::log) fn open<'a>(&'a mut self, block: Block<'a>) -> (&'a [u8], Loss) {
        let (body, cut) = match block {
            Block::Loose(bytes) => return (bytes, Loss::Nothing),
            Block::Chunk { body, cut } => (body, cut),
        };
        let Some(chunk) = ChunkRecord::parse(body) else {
            return (&[], Loss::Dropped("its header is broken".into()));
        };
        match self.0.run(chunk.compression, chunk.records, chunk.uncompressed_size, cut) {
            Err(reason) => (&[], Loss::Dropped(reason)),
            Ok((bytes, _)) if cut => (bytes, Loss::Cut),
            Ok((_, Yield::Part)) => (&[], Loss::Dropped("its compressed data are broken".into())),
            Ok((bytes, Yield::Whole)) => {
                if chunk.crc == 0 || chunk.crc == crc32fast::hash(bytes) {
                    (bytes, Loss::Nothing)
                } else {
                    (&[], Loss::Dropped("its checksum does not hold".into()))
                }
            }
        }
    }
}

/// The records of an opened block, in order; stops where no whole record follows (none has the
/// opcode 0, as pages lost at a power failure hold).
pub(in crate::log) fn records(bytes: &[u8]) -> impl Iterator<Item = Record<'_>> {
    let mut at = 0;
    std::iter::from_fn(move || {
        let record = Record::at(bytes, at).filter(|record| record.opcode != 0)?;
        at = record.end;
        Some(record)
    })
}
