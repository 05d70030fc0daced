//! MCAP records, parsed with every length checked (<https://mcap.dev/spec>).

use std::collections::BTreeMap;

use super::span::Span;

/// Record types by their byte in the file.
pub(in crate::log) struct Opcode;

impl Opcode {
    pub(in crate::log) const HEADER: u8 = 0x01;
    pub(in crate::log) const FOOTER: u8 = 0x02;
    pub(in crate::log) const SCHEMA: u8 = 0x03;
    pub(in crate::log) const CHANNEL: u8 = 0x04;
    pub(in crate::log) const MESSAGE: u8 = 0x05;
    pub(in crate::log) const CHUNK: u8 = 0x06;
    pub(super) const MESSAGE_INDEX: u8 = 0x07;
    pub(super) const CHUNK_INDEX: u8 = 0x08;
    pub(in crate::log) const ATTACHMENT: u8 = 0x09;
    pub(super) const ATTACHMENT_INDEX: u8 = 0x0A;
    pub(in crate::log) const STATISTICS: u8 = 0x0B;
    pub(in crate::log) const METADATA: u8 = 0x0C;
    pub(in crate::log) const DATA_END: u8 = 0x0F;
}

/// One record: its type, its body, and where the next one starts.
#[derive(Debug, Clone, Copy)]
pub(in crate::log) struct Record<'a> {
    pub(in crate::log) opcode: u8,
    pub(in crate::log) body: &'a [u8],
    pub(in crate::log) end: usize,
}

/// Opcode and length.
const HEAD: usize = 9;

impl<'a> Record<'a> {
    /// The record at `at`, if all of it is there.
    #[inline]
    pub(in crate::log) fn at(bytes: &'a [u8], at: usize) -> Option<Self> {
        let head = bytes.get(at..)?.first_chunk::<HEAD>()?;
        let [opcode, length @ ..] = head;
        let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
        let start = at + HEAD;
        let end = start.checked_add(length)?;
        Some(Self { opcode: *opcode, body: bytes.get(start..end)?, end })
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(in crate::log) struct SchemaRecord {
    pub(in crate::log) id: u16,
    pub(in crate::log) name: String,
    pub(in crate::log) encoding: String,
    pub(in crate::log) data: Vec<u8>,
}

#[derive(Debug, Clone, PartialEq)]
pub(in crate::log) struct ChannelRecord {
    pub(in crate::log) id: u16,
    pub(in crate::log) schema_id: u16,
    pub(in crate::log) topic: String,
    pub(in crate::log) encoding: String,
    pub(in crate::log) metadata: BTreeMap<String, String>,
}

#[derive(Debug, Clone, Copy)]
pub(in crate::log) struct MessageRecord<'a> {
    pub(in crate::log) channel_id: u16,
    pub(in crate::log) sequence: u32,
    pub(in crate::log) log_time_ns: u64,
    pub(in crate::log) publish_time_ns: u64,
    pub(in crate::log) data: &'a [u8],
}

#[derive(Debug, Clone)]
pub(in crate::log) struct ChunkRecord<'a> {
    pub(in crate::log) uncompressed_size: u64,
    pub(in crate::log) crc: u32,
    pub(in crate::log) compression: &'a [u8],
    /// As many compressed bytes as are there.
    pub(in crate::log) records: &'a [u8],
    /// As many as the chunk says there are.
    pub(in crate::log) compressed_size: u64,
}

#[derive(Debug, Clone, PartialEq)]
pub(in crate::log) struct AttachmentRecord {
    pub(in crate::log) log_time_ns: u64,
    pub(in crate::log) create_time_ns: u64,
    pub(in crate::log) name: String,
    pub(in crate::log) media_type: String,
    /// Where its bytes are.
    pub(in crate::log) data: Span,
}

#[derive(Debug, Clone, PartialEq)]
pub(in crate::log) struct MetadataRecord {
    pub(in crate::log) name: String,
    pub(in crate::log) entries: BTreeMap<String, String>,
}

/// Reads little-endian fields off the front; `None` once bytes run out.
struct Fields<'a>(&'a [u8]);

impl<'a> Fields<'a> {
    fn bytes(&mut self, count: usize) -> Option<&'a [u8]> {
        let (head, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(head)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.bytes(N)?.try_into().ok()
    }

    fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    /// A u32 length and that many bytes.
    fn block(&mut self) -> Option<&'a [u8]> {
        let length = self.u32()? as usize;
        self.bytes(length)
    }

    fn text(&mut self) -> Option<String> {
        self.block().map(|text| String::from_utf8_lossy(text).into_owned())
    }

    fn map(&mut self) -> Option<BTreeMap<String, String>> {
        let mut entries = Self(self.block()?);
        let mut map = BTreeMap::new();
        while !entries.0.is_empty() {
            map.insert(entries.text()?, entries.text()?);
        }
        Some(map)
    }
}

impl SchemaRecord {
    pub(in crate::log) fn parse(body: &[u8]) -> Option<Self> {
        let mut f = Fields(body);
        Some(Self { id: f.u16()?, name: f.text()?, encoding: f.text()?, data: f.block()?.to_vec() })
    }
}

impl ChannelRecord {
    pub(in crate::log) fn parse(body: &[u8]) -> Option<Self> {
        let mut f = Fields(body);
        Some(Self {
            id: f.u16()?,
            schema_id: f.u16()?,
            topic: f.text()?,
            encoding: f.text()?,
            metadata: f.map()?,
        })
    }
}

impl<'a> MessageRecord<'a> {
    #[inline]
    pub(in crate::log) fn parse(body: &'a [u8]) -> Option<Self> {
        let (head, data) = body.split_first_chunk::<22>()?;
        let mut f = Fields(head);
        Some(Self {
            channel_id: f.u16()?,
            sequence: f.u32()?,
            log_time_ns: f.u64()?,
            publish_time_ns: f.u64()?,
            data,
        })
    }
}

impl<'a> ChunkRecord<'a> {
    /// Parses a chunk's head; `records` may be cut short by the end of the file.
    pub(in crate::log) fn parse(body: &'a [u8]) -> Option<Self> {
        let mut f = Fields(body);
        f.bytes(16)?; // first and last log time: recomputed from the messages
        let (uncompressed_size, crc, compression, compressed_size) =
            (f.u64()?, f.u32()?, f.block()?, f.u64()?);
        let there = usize::try_from(compressed_size).map_or(f.0.len(), |size| size.min(f.0.len()));
        Some(Self { uncompressed_size, crc, compression, records: &f.0[..there], compressed_size })
    }
}

impl AttachmentRecord {
    /// From the start of its body. Its checksum, of all before it, follows its data.
    pub(super) fn parse(head: &[u8], body: Span) -> Option<Self> {
        let mut f = Fields(head);
        let (log_time_ns, create_time_ns, name, media_type) = (f.u64()?, f.u64()?, f.text()?, f.text()?);
        let length = f.u64()?;
        let start = body.start + (head.len() - f.0.len()) as u64;
        let end = start.checked_add(length).filter(|end| end.saturating_add(4) <= body.end)?;
        Some(Self { log_time_ns, create_time_ns, name, media_type, data: Span { start, end } })
    }
}

impl MetadataRecord {
    pub(in crate::log) fn parse(body: &[u8]) -> Option<Self> {
        let mut f = Fields(body);
        Some(Self { name: f.text()?, entries: f.map()? })
    }
}

/// Profile of a header record.
pub(super) fn profile(body: &[u8]) -> Option<String> {
    Fields(body).text()
}

/// Where the summary starts (0: there is none) and its checksum, from a footer.
pub(super) fn summary_start_and_crc(body: &[u8]) -> Option<(u64, u32)> {
    let mut f = Fields(body);
    let start = f.u64()?;
    f.u64()?; // start of the summary offsets
    Some((start, f.u32()?))
}

/// Checksum of everything before a `DataEnd` record; 0: none.
pub(super) fn data_crc(body: &[u8]) -> Option<u32> {
    Fields(body).u32()
}

/// What a statistics record says of a file.
#[derive(Debug, Default)]
pub(super) struct Statistics {
    pub(super) channels: u32,
    pub(super) attachments: u32,
    pub(super) chunks: u32,
    /// When the first and the last message were received, ns.
    pub(super) log_ns: [u64; 2],
    /// By channel.
    pub(super) messages: BTreeMap<u16, u64>,
}

impl Statistics {
    pub(super) fn parse(body: &[u8]) -> Option<Self> {
        let mut f = Fields(body);
        f.bytes(10)?; // message count, schema count
        let channels = f.u32()?;
        let attachments = f.u32()?;
        f.bytes(4)?; // count of metadata
        let chunks = f.u32()?;
        let log_ns = [f.u64()?, f.u64()?];
        f.bytes(4)?; // length of the list
        let messages = std::iter::from_fn(|| Some((f.u16()?, f.u64()?))).collect();
        Some(Self { channels, attachments, chunks, log_ns, messages })
    }
}

/// Where a chunk is, by the summary of a file.
#[derive(Debug)]
pub(super) struct ChunkIndexRecord {
    /// When its first and its last message were received, ns.
    pub(super) log_ns: [u64; 2],
    /// Where the index of a channel's messages in it starts.
    pub(super) message_indexes: BTreeMap<u16, u64>,
}

impl ChunkIndexRecord {
    pub(super) fn parse(body: &[u8]) -> Option<Self> {
        let mut f = Fields(body);
        let log_ns = [f.u64()?, f.u64()?];
        f.bytes(16)?; // place and length of the chunk
        let mut list = Fields(f.block()?);
        let message_indexes = std::iter::from_fn(|| Some((list.u16()?, list.u64()?))).collect();
        Some(Self { log_ns, message_indexes })
    }
}

/// The name in the index of an attachment.
pub(super) fn indexed_attachment(body: &[u8]) -> Option<String> {
    let mut f = Fields(body);
    f.bytes(40)?; // place, length, times, length of the data
    f.text()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_longer_than_its_block_is_none() {
        let mut bytes = vec![Opcode::CHUNK];
        bytes.extend(u64::MAX.to_le_bytes());
        bytes.extend([1, 2, 3]);
        assert!(Record::at(&bytes, 0).is_none());
        assert!(Record::at(&bytes, 4).is_none());
    }

    #[test]
    fn a_text_longer_than_its_record_is_refused() {
        let mut body = 7_u16.to_le_bytes().to_vec();
        body.extend(u32::MAX.to_le_bytes());
        assert_eq!(SchemaRecord::parse(&body), None);
    }
}
