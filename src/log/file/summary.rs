//! What the end of a closed file says of it: topics, counts and times, without a look at the messages.

use std::collections::BTreeMap;

use super::{
    block::records,
    record::{
        ChannelRecord, ChunkIndexRecord, Opcode, SchemaRecord, Statistics, indexed_attachment,
        summary_start_and_crc,
    },
    scan::MAGIC,
    source::Source,
    span::Span,
    walk::HEAD,
};

/// The summary of a file.
#[derive(Debug, Default)]
pub(in crate::log) struct Summary {
    pub(in crate::log) schemas: Vec<SchemaRecord>,
    pub(in crate::log) channels: Vec<ChannelRecord>,
    pub(in crate::log) chunks: usize,
    /// Names of the files stored in it.
    pub(in crate::log) attachments: Vec<String>,
    /// Messages by channel.
    pub(in crate::log) messages: BTreeMap<u16, u64>,
    /// When the recorder received the first and the last message of all, ns.
    pub(in crate::log) log_ns: [u64; 2],
    /// The same of a channel, where the chunks that hold its first and last message tell.
    pub(in crate::log) log_ns_by_channel: BTreeMap<u16, [u64; 2]>,
}

/// Body of a footer.
const FOOTER: u64 = 20;
/// Longer than the summary of any log, bytes.
const LONGEST: u64 = 1 << 24;
/// Entry of a message index: time and offset; before the first one are channel and length, behind the record's head.
const ENTRY: u64 = 16;
const BEFORE_ENTRIES: u64 = 6;

/// Reads the summary of a file alone; `None` if it was not closed, or its summary is incomplete or not as it was written.
pub(in crate::log) fn summary(source: &Source) -> Option<Summary> {
    let end = source.length().checked_sub(MAGIC.len() as u64)?;
    let footer = end.checked_sub(HEAD + FOOTER)?;
    let tail = bytes(source, Span { start: footer, end: source.length() })?;
    let (head, body) = tail.split_first_chunk::<9>()?;
    let closed = tail.ends_with(MAGIC) && head[0] == Opcode::FOOTER && head[1..] == FOOTER.to_le_bytes();
    let (start, crc) = summary_start_and_crc(body).filter(|(start, _)| closed && *start > 0)?;
    let checked = Span { start, end: end - 4 };
    let data = bytes(source, checked).filter(|_| start < footer && checked.length() < LONGEST)?;
    if crc != 0 && crc32fast::hash(&data) != crc {
        return None;
    }
    let (mut found, mut chunks, mut said) = (Summary::default(), Vec::new(), None);
    for record in records(&data) {
        match record.opcode {
            Opcode::SCHEMA => found.schemas.extend(SchemaRecord::parse(record.body)),
            Opcode::CHANNEL => found.channels.extend(ChannelRecord::parse(record.body)),
            Opcode::CHUNK_INDEX => chunks.extend(ChunkIndexRecord::parse(record.body)),
            Opcode::ATTACHMENT_INDEX => found.attachments.extend(indexed_attachment(record.body)),
            Opcode::STATISTICS => said = Statistics::parse(record.body),
            _ => {}
        }
    }
    let said = said.filter(|said| {
        said.channels as usize == found.channels.len()
            && said.chunks as usize == chunks.len()
            && said.attachments as usize == found.attachments.len()
    })?;
    found.chunks = chunks.len();
    found.log_ns = said.log_ns;
    found.log_ns_by_channel =
        said.messages.keys().filter_map(|&id| Some((id, times(source, &chunks, id)?))).collect();
    found.messages = said.messages;
    Some(found)
}

fn bytes(source: &Source, span: Span) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    source.read(Span { end: span.end.min(span.start.saturating_add(LONGEST)), ..span }, &mut bytes).ok()?;
    Some(bytes)
}

/// When the first and the last message of a channel were received, by the indexes of the first and the last chunk with it.
fn times(source: &Source, chunks: &[ChunkIndexRecord], channel: u16) -> Option<[u64; 2]> {
    let own = || chunks.iter().filter(|chunk| chunk.message_indexes.contains_key(&channel));
    let first = own().min_by_key(|chunk| chunk.log_ns[0])?;
    let last = own().max_by_key(|chunk| chunk.log_ns[1])?;
    let entries = |chunk: &ChunkIndexRecord| {
        let at = *chunk.message_indexes.get(&channel)?;
        let number = |from: u64| {
            let start = at.checked_add(from)?;
            let bytes = bytes(source, Span { start, end: start.checked_add(8)? })?;
            Some(u64::from_le_bytes(*bytes.first_chunk()?))
        };
        let count = number(1)?.checked_sub(BEFORE_ENTRIES)? / ENTRY;
        let first = HEAD + BEFORE_ENTRIES;
        let last = count.checked_sub(1)?.checked_mul(ENTRY)?.checked_add(first)?;
        let [a, b] = [number(first)?, number(last)?];
        Some([a.min(b), a.max(b)])
    };
    Some([entries(first)?[0], entries(last)?[1]])
}
