//! Where a log ends when the power fails while its last chunk is stored.

use std::io::Read;

/// A place in the middle of the last chunk.
pub(crate) struct Cut {
    /// Bytes that are left.
    pub(crate) at: usize,
    /// Messages of one topic that the rest of the chunk still holds whole.
    pub(crate) recoverable: usize,
}

const MAGIC_BYTES: usize = 8;
const CHANNEL: u8 = 0x04;
const MESSAGE: u8 = 0x05;
const CHUNK: u8 = 0x06;

/// Cuts a finished log in the middle of the compressed data of its last chunk; `None` if there is
/// none.
pub(crate) fn cut_last_chunk(log: &[u8], topic: &str) -> Option<Cut> {
    let body = log.get(MAGIC_BYTES..)?;
    let topic_id = chunks(body).find_map(|(_, data)| channel_id(&unpack(data), topic))?;
    let (end, data) = chunks(body).last()?;
    let half = &data[..data.len() / 2];
    let unpacked = unpack(half);
    let recoverable = records(&unpacked)
        .filter(|(opcode, body, _)| *opcode == MESSAGE && body.starts_with(&topic_id))
        .count();
    Some(Cut { at: MAGIC_BYTES + end - (data.len() - half.len()), recoverable })
}

/// Ends of chunks, with their compressed data.
fn chunks(body: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    records(body).filter(|(opcode, ..)| *opcode == CHUNK).filter_map(|(_, chunk, end)| {
        // Two times, the size and the checksum of what is inside; then the compression and the data.
        let name_bytes = u32::from_le_bytes(chunk.get(28..32)?.try_into().ok()?) as usize;
        Some((end, chunk.get(32 + name_bytes + 8..)?))
    })
}

/// Opcode, body and end of every whole record.
fn records(bytes: &[u8]) -> impl Iterator<Item = (u8, &[u8], usize)> {
    let mut at = 0;
    std::iter::from_fn(move || {
        let length = u64::from_le_bytes(bytes.get(at + 1..at + 9)?.try_into().ok()?);
        let end = usize::try_from(length).ok()?.checked_add(at + 9)?;
        let record = (*bytes.get(at)?, bytes.get(at + 9..end)?, end);
        at = end;
        Some(record)
    })
}

/// What zstd gives back of data that may be cut.
fn unpack(data: &[u8]) -> Vec<u8> {
    let mut unpacked = Vec::new();
    if let Ok(mut decoder) = zstd::Decoder::new(data) {
        // Fails at the cut, after everything before it.
        let _ = decoder.read_to_end(&mut unpacked);
    }
    unpacked
}

/// The id of a topic as its messages begin with it.
fn channel_id(bytes: &[u8], topic: &str) -> Option<[u8; 2]> {
    records(bytes).filter(|(opcode, ..)| *opcode == CHANNEL).find_map(|(_, channel, _)| {
        let (id, rest) = channel.split_first_chunk::<2>()?;
        let name = rest.get(6..6 + topic.len())?;
        (name == topic.as_bytes()).then_some(*id)
    })
}
