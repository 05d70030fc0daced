//! Finds the records of a file by walking their headers; no summary or index is needed.

use super::{
    block::Block,
    record::{
        AttachmentRecord, ChannelRecord, ChunkRecord, MetadataRecord, Opcode, Record, SchemaRecord,
        channel_count, data_crc, profile, summary_start_and_crc,
    },
};

const MAGIC: &[u8; 8] = b"\x89MCAP0\r\n";

/// Messages outside chunks are grouped into blocks of about this size, bytes.
const LOOSE_BLOCK: usize = 1 << 20;

/// Where everything is in one file.
#[derive(Debug, Default)]
pub(in crate::log) struct Layout<'a> {
    /// Runs of messages in file order.
    pub(in crate::log) blocks: Vec<Block<'a>>,
    /// Schemas outside chunks, those of the summary included; ids may repeat.
    pub(in crate::log) schemas: Vec<SchemaRecord<'a>>,
    /// Channels outside chunks, those of the summary included; ids may repeat.
    pub(in crate::log) channels: Vec<ChannelRecord>,
    /// Whether the channels outside chunks are known to be complete.
    pub(in crate::log) channels_complete: bool,
    pub(in crate::log) attachments: Vec<AttachmentRecord<'a>>,
    pub(in crate::log) metadata: Vec<MetadataRecord>,
    pub(in crate::log) damage: Damage,
    /// Of the header; empty if it is damaged.
    pub(in crate::log) profile: String,
}

/// Faults in the outer structure of a file.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(in crate::log) struct Damage {
    /// The end marker is missing: power loss or a kill.
    pub(in crate::log) not_closed: bool,
    /// Bytes between records that belong to no record.
    pub(in crate::log) skipped_bytes: u64,
    /// Attachments whose checksum does not hold.
    pub(in crate::log) broken_attachments: u64,
    /// The checksum of the summary does not hold; the summary is not used.
    pub(in crate::log) broken_summary: bool,
    /// The checksum of the data does not hold, and no chunk has a checksum that locates the fault.
    pub(in crate::log) broken_data: bool,
}

/// Walks a file; `None` if nothing in it looks like MCAP.
pub(in crate::log) fn scan(bytes: &[u8]) -> Option<Layout<'_>> {
    let mut layout = Layout::default();
    let has_magic = bytes.starts_with(MAGIC);
    let mut at = if has_magic { MAGIC.len() } else { 0 };
    let mut loose: Option<usize> = None;
    let mut channels_promised = None;
    let mut footer = false;
    let mut before_summary = None;
    layout.damage.not_closed = true;
    while at < bytes.len() {
        if footer && bytes[at..].starts_with(MAGIC) {
            layout.damage.not_closed = false;
            layout.damage.skipped_bytes += (bytes.len() - at - MAGIC.len()) as u64;
            break;
        }
        if let Some(body) = cut_chunk(bytes, at) {
            close_loose(&mut layout, bytes, &mut loose, at);
            layout.blocks.push(Block::Chunk { body, cut: true });
            break;
        }
        let found = Record::at(bytes, at).filter(plausible).or_else(|| chunk_by_inner_length(bytes, at));
        let Some(record) = found else {
            close_loose(&mut layout, bytes, &mut loose, at);
            if let Some(next) = resync(bytes, at + 1) {
                layout.damage.skipped_bytes += (next - at) as u64;
                at = next;
                continue;
            }
            match Record::cut_at(bytes, at) {
                Some((Opcode::CHUNK, body))
                    if ChunkRecord::parse(body).is_some_and(|c| known(c.compression)) =>
                {
                    layout.blocks.push(Block::Chunk { body, cut: true });
                }
                _ => layout.damage.skipped_bytes += (bytes.len() - at) as u64,
            }
            break;
        };
        let in_loose = matches!(record.opcode, Opcode::MESSAGE | Opcode::SCHEMA | Opcode::CHANNEL);
        if !in_loose || loose.is_some_and(|start| at - start >= LOOSE_BLOCK) {
            close_loose(&mut layout, bytes, &mut loose, at);
        }
        if record.opcode == Opcode::MESSAGE && loose.is_none() {
            loose = Some(at);
        }
        match record.opcode {
            Opcode::HEADER => layout.profile = profile(record.body).unwrap_or_default(),
            Opcode::SCHEMA => layout.schemas.extend(SchemaRecord::parse(record.body)),
            Opcode::CHANNEL => layout.channels.extend(ChannelRecord::parse(record.body)),
            Opcode::CHUNK => layout.blocks.push(Block::Chunk { body: record.body, cut: false }),
            Opcode::METADATA => layout.metadata.extend(MetadataRecord::parse(record.body)),
            Opcode::STATISTICS => channels_promised = channel_count(record.body),
            Opcode::DATA_END => {
                before_summary = Some((layout.schemas.len(), layout.channels.len()));
                let loose = layout.blocks.iter().any(|block| matches!(block, Block::Loose(_)));
                layout.damage.broken_data |= loose && !data_holds(&bytes[..at], record.body);
            }
            Opcode::FOOTER => {
                footer = true;
                if let Some((schemas, channels)) =
                    before_summary.filter(|_| !summary_holds(bytes, at, record.body))
                {
                    layout.damage.broken_summary = true;
                    layout.schemas.truncate(schemas);
                    layout.channels.truncate(channels);
                    channels_promised = None;
                }
            }
            Opcode::ATTACHMENT => match AttachmentRecord::parse(record.body) {
                Some(attachment) if attachment.crc_holds => layout.attachments.push(attachment),
                _ => layout.damage.broken_attachments += 1,
            },
            _ => {}
        }
        at = record.end;
    }
    close_loose(&mut layout, bytes, &mut loose, at.min(bytes.len()));
    let mut ids: Vec<u16> = layout.channels.iter().map(|c| c.id).collect();
    ids.sort_unstable();
    ids.dedup();
    layout.channels_complete = channels_promised.is_some_and(|count| count as usize == ids.len());
    let empty = layout.blocks.is_empty() && layout.channels.is_empty();
    (has_magic || !empty).then_some(layout)
}

fn close_loose<'a>(layout: &mut Layout<'a>, bytes: &'a [u8], loose: &mut Option<usize>, end: usize) {
    if let Some(start) = loose.take() {
        layout.blocks.push(Block::Loose(&bytes[start..end]));
    }
}

/// Whether the data before a `DataEnd` are as they were written, or have no checksum. Some
/// writers leave the magic out.
fn data_holds(data: &[u8], data_end: &[u8]) -> bool {
    let holds = |crc| {
        [0, MAGIC.len()].iter().any(|&from| crc == crc32fast::hash(data.get(from..).unwrap_or_default()))
    };
    data_crc(data_end).is_none_or(|crc| crc == 0 || holds(crc))
}

/// Whether the summary before the footer at `at` is as it was written, or has no checksum.
fn summary_holds(bytes: &[u8], at: usize, footer: &[u8]) -> bool {
    // The checksum ends before itself: a record's head and two offsets into the footer.
    const CHECKED: usize = 9 + 16;
    let Some((start, crc)) = summary_start_and_crc(footer) else { return false };
    let summary = usize::try_from(start).ok().and_then(|start| bytes.get(start..at + CHECKED));
    start == 0 || crc == 0 || summary.is_some_and(|summary| crc == crc32fast::hash(summary))
}

/// A chunk that goes on beyond the end of the file, as both its lengths say.
fn cut_chunk(bytes: &[u8], at: usize) -> Option<&[u8]> {
    let (opcode, body) = Record::cut_at(bytes, at)?;
    let length = u64::from_le_bytes(*bytes.get(at + 1..)?.first_chunk()?);
    let chunk = (opcode == Opcode::CHUNK).then(|| ChunkRecord::parse(body)).flatten()?;
    let inner = chunk.compressed_size.checked_add(40 + chunk.compression.len() as u64)?;
    (known(chunk.compression) && inner == length).then_some(body)
}

fn known(compression: &[u8]) -> bool {
    matches!(compression, b"" | b"zstd" | b"lz4")
}

/// Cheap checks that distinguish a record from noise: constant time, whatever the length.
fn plausible(record: &Record<'_>) -> bool {
    let length = record.body.len();
    match record.opcode {
        Opcode::FOOTER => length == 20,
        Opcode::SCHEMA | Opcode::CHANNEL => length >= 12,
        Opcode::MESSAGE => length >= 22,
        Opcode::CHUNK => ChunkRecord::parse(record.body).is_some_and(|chunk| {
            let head = 40 + chunk.compression.len();
            chunk.compressed_size.checked_add(head as u64) == Some(length as u64)
        }),
        Opcode::DATA_END => length == 4,
        Opcode::HEADER | 0x07..=0x0E => length >= 8,
        0x80.. => true,
        _ => false,
    }
}

/// A chunk whose outer length is broken but whose inner one leads to another record.
fn chunk_by_inner_length(bytes: &[u8], at: usize) -> Option<Record<'_>> {
    const HEAD: usize = 9;
    if *bytes.get(at)? != Opcode::CHUNK {
        return None;
    }
    let rest = bytes.get(at + HEAD..)?;
    let chunk = ChunkRecord::parse(rest).filter(|chunk| known(chunk.compression))?;
    let length = usize::try_from(chunk.compressed_size).ok()?.checked_add(40 + chunk.compression.len())?;
    let body = rest.get(..length)?;
    let end = at + HEAD + length;
    Record::at(bytes, end).filter(plausible)?;
    Some(Record { opcode: Opcode::CHUNK, body, end })
}

/// The next place that is surely a record: a chunk whose lengths agree, or three plausible
/// records in a row (fewer at the end of the file).
fn resync(bytes: &[u8], from: usize) -> Option<usize> {
    (from..bytes.len()).find(|&at| {
        if !matches!(bytes[at], 0x02..=0x0F) {
            return false;
        }
        let Some(first) = Record::at(bytes, at).filter(plausible) else { return false };
        if first.opcode == Opcode::CHUNK {
            return ChunkRecord::parse(first.body).is_some_and(|chunk| known(chunk.compression));
        }
        let mut next = first.end;
        for _ in 0..2 {
            if next == bytes.len() || bytes[next..].starts_with(MAGIC) {
                return true;
            }
            match Record::at(bytes, next).filter(plausible) {
                Some(record) if record.opcode != Opcode::HEADER => next = record.end,
                _ => return false,
            }
        }
        true
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
        [&[opcode][..], &(body.len() as u64).to_le_bytes(), body].concat()
    }

    fn chunk(payload: &[u8]) -> Vec<u8> {
        let size = (payload.len() as u64).to_le_bytes();
        record(Opcode::CHUNK, &[&[0; 16][..], &size, &[0; 8], &size, payload].concat())
    }

    fn file(parts: &[Vec<u8>]) -> Vec<u8> {
        [&MAGIC[..], &parts.concat()].concat()
    }

    #[test]
    fn a_broken_outer_length_costs_nothing_where_the_inner_one_leads_on() {
        let mut bad = chunk(b"bbbb");
        bad[1] = 200;
        let bytes = file(&[chunk(b"aaaa"), bad, chunk(b"cccc")]);
        let layout = scan(&bytes).unwrap();
        assert_eq!(layout.blocks.len(), 3);
        assert_eq!(layout.damage, Damage { not_closed: true, ..Damage::default() });
    }

    #[test]
    fn noise_between_chunks_is_skipped_and_counted() {
        let bytes = file(&[chunk(b"aaaa"), vec![0; 4096], chunk(b"cccc")]);
        let layout = scan(&bytes).unwrap();
        assert_eq!((layout.blocks.len(), layout.damage.skipped_bytes), (2, 4096));
    }

    #[test]
    fn a_cut_chunk_is_found_as_such() {
        let whole = file(&[chunk(b"aaaa"), chunk(&[7; 100])]);
        let layout = scan(&whole[..whole.len() - 50]).unwrap();
        assert!(matches!(
            layout.blocks[..],
            [Block::Chunk { cut: false, .. }, Block::Chunk { cut: true, .. }]
        ));
    }

    #[test]
    fn what_is_not_mcap_is_none() {
        assert!(scan(b"").is_none());
        assert!(scan(b"time;joint1;joint2\n0;1;2\n").is_none());
    }
}
