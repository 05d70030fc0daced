//! Which channels each chunk holds, by the indexes behind it: a chunk without anything that is wanted need not be read.

use std::collections::BTreeMap;

use super::{block::Block, record::Statistics, span::Span, walk::Walk};

/// Messages of one channel in a chunk.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::log) struct Held {
    pub(in crate::log) channel: u16,
    pub(in crate::log) messages: u64,
    /// When the recorder received the first and the last of them, ns.
    pub(in crate::log) log_ns: [u64; 2],
}

/// The channels of the blocks so far, by the number of the block.
#[derive(Debug, Default)]
pub(super) struct HeldByBlock(BTreeMap<usize, Vec<Held>>);

/// Bytes of an entry of a `MessageIndex`: time and offset; those before the first: channel, length of the list.
const ENTRY: u64 = 16;
const BEFORE: u64 = 6;

impl HeldByBlock {
    /// Takes in a `MessageIndex` behind a block.
    pub(super) fn add(&mut self, block: usize, walk: &mut Walk<'_>, body: Span) {
        let mut number = |at: u64| {
            let span = Span { start: body.start + at, end: (body.start + at + 8).min(body.end) };
            walk.look(span).first_chunk().map(|bytes| u64::from_le_bytes(*bytes))
        };
        let entries = body.length().saturating_sub(BEFORE) / ENTRY;
        let Some((head, last)) = (entries > 0).then(|| (number(0), (entries - 1) * ENTRY + BEFORE)) else {
            return;
        };
        if let (Some(head), Some(first_ns), Some(last_ns)) = (head, number(BEFORE), number(last)) {
            let [low, high, ..] = head.to_le_bytes();
            let log_ns = [first_ns.min(last_ns), first_ns.max(last_ns)];
            let held = Held { channel: u16::from_le_bytes([low, high]), messages: entries, log_ns };
            self.0.entry(block).or_default().push(held);
        }
    }

    /// The channels of every block, if each begins when its messages do, and all of them together are what the
    /// statistics of the file say.
    pub(super) fn agreed(mut self, blocks: &[Block], said: &Statistics) -> Option<Vec<Vec<Held>>> {
        let begins = |held: &Vec<Held>| held.iter().map(|held| held.log_ns[0]).min();
        let whole =
            self.0.iter().all(|(block, held)| begins(held) == blocks.get(*block).map(|b| b.begins_ns));
        let mut sums: BTreeMap<u16, u64> = BTreeMap::new();
        for held in self.0.values().flatten() {
            *sums.entry(held.channel).or_default() += held.messages;
        }
        let said_sums: BTreeMap<u16, u64> =
            said.messages.iter().filter(|(_, count)| **count > 0).map(|(id, count)| (*id, *count)).collect();
        (whole && blocks.len() as u64 == u64::from(said.chunks) && sums == said_sums)
            .then(|| (0..blocks.len()).map(|block| self.0.remove(&block).unwrap_or_default()).collect())
    }
}
