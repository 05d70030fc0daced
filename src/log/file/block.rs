//! A run of messages: a chunk, or messages that stand outside chunks.

use super::{
    compression::{Decompressor, Yield},
    record::{ChunkRecord, Record},
    source::Source,
    span::Span,
};

/// A run of messages in a file.
#[derive(Debug, Clone, Copy)]
pub(in crate::log) struct Block {
    pub(super) kind: Kind,
    /// The chunk's body, or the records.
    pub(in crate::log) span: Span,
    /// When the recorder received its first message, ns.
    pub(in crate::log) begins_ns: u64,
}

/// What a run of messages is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// A chunk; `cut` if the file ends within it.
    Chunk { cut: bool },
    /// Records that stand outside chunks.
    Loose,
}

/// Bytes that a block lost.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::log) enum Loss {
    Nothing,
    /// The file ends within the block; records before the cut are there.
    Cut,
    /// The block is not as it was written, and how it shows. Its records are there, as far as they go, for those
    /// that take doubtful ones.
    Doubtful(String),
    /// The block is unusable, and why.
    Dropped(String),
}

/// Opens blocks one after another, reusing buffers; one for each thread.
pub(in crate::log) struct Blocks {
    decompressor: Decompressor,
    body: Vec<u8>,
}

impl Blocks {
    pub(in crate::log) fn new() -> Self {
        Self { decompressor: Decompressor::new(), body: Vec::new() }
    }

    /// The bytes of the block's records, decompressed and checked; none of a block that is not as it was written.
    pub(in crate::log) fn open(&mut self, block: Block, source: &Source) -> (&[u8], Loss) {
        match self.open_doubtful(block, source) {
            (_, Loss::Doubtful(reason)) => (&[], Loss::Dropped(reason)),
            opened => opened,
        }
    }

    /// As [`open`](Self::open), with what there is of blocks that are not as they were written.
    pub(in crate::log) fn open_doubtful(&mut self, block: Block, source: &Source) -> (&[u8], Loss) {
        if let Err(error) = source.read(block.span, &mut self.body) {
            return (&[], Loss::Dropped(format!("it cannot be read: {error}")));
        }
        // The file may have become shorter since it was walked.
        let short = (self.body.len() as u64) < block.span.length();
        let cut = match block.kind {
            Kind::Loose if short => return (&self.body, Loss::Cut),
            Kind::Loose => return (&self.body, Loss::Nothing),
            Kind::Chunk { cut } => cut || short,
        };
        let Some(chunk) = ChunkRecord::parse(&self.body) else {
            return (&[], Loss::Dropped("its header is broken".into()));
        };
        match self.decompressor.run(
            chunk.compression,
            chunk.records,
            chunk.uncompressed_size,
            (cut, chunk.crc != 0),
        ) {
            Err(reason) => (&[], Loss::Dropped(reason)),
            Ok((bytes, _)) if cut => (bytes, Loss::Cut),
            Ok((bytes, Yield::Part)) => (bytes, Loss::Doubtful("its compressed data are broken".into())),
            Ok((bytes, Yield::Whole)) => {
                if chunk.crc == 0 || chunk.crc == crc32fast::hash(bytes) {
                    (bytes, Loss::Nothing)
                } else {
                    (bytes, Loss::Doubtful("its checksum does not hold".into()))
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
