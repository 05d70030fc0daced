//! Finds the records of a file by walking their headers; no summary or index is needed.

use super::{
    block::{Block, Kind},
    held::HeldByBlock,
    layout::{Damage, Layout},
    record::{
        AttachmentRecord, ChannelRecord, ChunkRecord, MessageRecord, MetadataRecord, Opcode, SchemaRecord,
        Statistics, data_crc, profile, summary_start_and_crc,
    },
    source::Source,
    span::Span,
    walk::{Found, HEAD, Walk},
};

pub(in crate::log) const MAGIC: &[u8; 8] = b"\x89MCAP0\r\n";

/// Messages outside chunks are grouped into blocks of about this size, bytes.
const LOOSE_BLOCK: u64 = 1 << 20;

/// More than the times and names of an attachment take, bytes.
const ATTACHMENT_HEAD: u64 = 1 << 16;

/// Walks a file: the recordings in it, one behind another (one, but for files that were appended to each other or
/// written into the remains of others); none if nothing in it looks like MCAP.
pub(in crate::log) fn scan(source: &Source) -> Vec<Layout> {
    let (mut layouts, mut from) = (Vec::new(), Some(0));
    while let Some(start) = from {
        let mut scan = Scan::at(source, start);
        let is_log = scan.run();
        from = scan.next;
        let fault = scan.walk.into_fault().map(|fault| fault.to_string());
        layouts.extend(is_log.then_some(Layout { fault, starts_at: start, ..scan.layout }));
    }
    layouts
}

struct Scan<'a> {
    walk: Walk<'a>,
    /// Where the recording begins.
    start: u64,
    /// Where another one begins behind it.
    next: Option<u64>,
    /// Where the first other one begins, once that was looked for; `u64::MAX` if none does.
    ahead: Option<u64>,
    layout: Layout,
    /// Where a run of messages outside chunks began, and its first time.
    loose: Option<(u64, u64)>,
    held: HeldByBlock,
}

impl<'a> Scan<'a> {
    fn at(source: &'a Source, start: u64) -> Self {
        let (layout, held) = (Layout::default(), HeldByBlock::default());
        Self { walk: Walk::of(source), start, next: None, ahead: None, layout, loose: None, held }
    }

    /// Whether anything looks like MCAP.
    fn run(&mut self) -> bool {
        let has_magic = self.walk.starts_with(self.start, MAGIC);
        let magic = MAGIC.len() as u64;
        let length = self.walk.length();
        let mut at = if has_magic { self.start + magic } else { self.start };
        // The last record begins here: it may say more bytes than were written of it.
        let mut last = at;
        let mut statistics: Option<Statistics> = None;
        let mut footer = false;
        let mut before_summary = None;
        self.layout.damage.not_closed = true;
        while at < length {
            if footer && self.walk.starts_with(at, MAGIC) {
                self.layout.damage.not_closed = false;
                self.next = self.next_log(at + magic);
                self.layout.damage.skipped_bytes += self.next.unwrap_or(length) - at - magic;
                break;
            }
            if let Some(body) = self.cut_chunk(at) {
                self.close_loose(at);
                self.chunk(body, true);
                self.next = self.next_log(body.start);
                self.cut_at_next();
                break;
            }
            let Some(record) = self.plausible_at(at).or_else(|| self.chunk_by_inner_length(at)) else {
                let next = self.next_log(last);
                let found = self.resync(at + 1, next.unwrap_or(length));
                if let Some(next) = next.filter(|_| found.is_none()) {
                    self.next = Some(next);
                    self.layout.damage.skipped_bytes += next.saturating_sub(at);
                    self.close_loose(at.min(next));
                    self.cut_at_next();
                    break;
                }
                self.close_loose(at);
                if let Some(next) = found {
                    self.layout.damage.skipped_bytes += next - at;
                    at = next;
                    continue;
                }
                match self.walk.cut_record(at) {
                    Some((Found { opcode: Opcode::CHUNK, body }, _)) if self.is_known_chunk(body) => {
                        self.chunk(body, true);
                    }
                    _ => self.layout.damage.skipped_bytes += length - at,
                }
                break;
            };
            let in_loose = matches!(record.opcode, Opcode::MESSAGE | Opcode::SCHEMA | Opcode::CHANNEL);
            if !in_loose || self.loose.is_some_and(|(start, _)| at - start >= LOOSE_BLOCK) {
                self.close_loose(at);
            }
            if record.opcode == Opcode::MESSAGE && self.loose.is_none() {
                let message = MessageRecord::parse(self.walk.look(record.body));
                self.loose = Some((at, message.map_or(0, |message| message.log_time_ns)));
            }
            match record.opcode {
                Opcode::CHUNK => self.chunk(record.body, false),
                Opcode::STATISTICS => statistics = Statistics::parse(&self.walk.body(record.body)),
                Opcode::MESSAGE_INDEX => {
                    if let Some(block) = self.layout.blocks.len().checked_sub(1) {
                        self.held.add(block, &mut self.walk, record.body);
                    }
                }
                Opcode::DATA_END => {
                    before_summary = Some((self.layout.schemas.len(), self.layout.channels.len()));
                    let loose = self.layout.blocks.iter().any(|block| block.kind == Kind::Loose);
                    self.layout.damage.broken_data |= loose && !self.data_holds(at, record.body);
                }
                Opcode::FOOTER => {
                    footer = true;
                    if let Some((schemas, channels)) =
                        before_summary.filter(|_| !self.summary_holds(at, record.body))
                    {
                        self.layout.damage.broken_summary = true;
                        self.layout.schemas.truncate(schemas);
                        self.layout.channels.truncate(channels);
                        statistics = None;
                    }
                }
                _ => self.small(record),
            }
            last = record.body.start;
            at = record.body.end;
        }
        self.close_loose(at.min(length));
        let layout = &mut self.layout;
        let mut ids: Vec<u16> = layout.channels.iter().map(|c| c.id).collect();
        ids.sort_unstable();
        ids.dedup();
        layout.channels_complete =
            statistics.as_ref().is_some_and(|said| said.channels as usize == ids.len());
        if let Some(said) = statistics.filter(|_| layout.damage == Damage::default()) {
            layout.held = std::mem::take(&mut self.held).agreed(&layout.blocks, &said);
        }
        has_magic || !layout.blocks.is_empty() || !layout.channels.is_empty()
    }

    /// Takes in a record that is read now.
    fn small(&mut self, record: Found) {
        let (walk, layout) = (&mut self.walk, &mut self.layout);
        match record.opcode {
            Opcode::HEADER => layout.profile = profile(&walk.body(record.body)).unwrap_or_default(),
            Opcode::SCHEMA => layout.schemas.extend(SchemaRecord::parse(&walk.body(record.body))),
            Opcode::CHANNEL => layout.channels.extend(ChannelRecord::parse(&walk.body(record.body))),
            Opcode::METADATA => layout.metadata.extend(MetadataRecord::parse(&walk.body(record.body))),
            Opcode::ATTACHMENT => {
                let head = walk.body(record.body.first(ATTACHMENT_HEAD));
                let attachment = AttachmentRecord::parse(&head, record.body);
                let mut holds = |file: &AttachmentRecord| {
                    let end = file.data.end;
                    let crc = data_crc(&walk.body(Span { start: end, end: end + 4 }));
                    crc.is_some_and(|crc| crc == 0 || walk.crc(Span { end, ..record.body }) == Some(crc))
                };
                match attachment.filter(&mut holds) {
                    Some(attachment) => layout.attachments.push(attachment),
                    None => layout.damage.broken_attachments += 1,
                }
            }
            _ => {}
        }
    }

    fn chunk(&mut self, body: Span, cut: bool) {
        // A chunk starts with the time of its first message.
        let begins_ns = self.walk.look(body).first_chunk().map_or(0, |bytes| u64::from_le_bytes(*bytes));
        self.layout.blocks.push(Block { kind: Kind::Chunk { cut }, span: body, begins_ns });
    }

    /// Where another recording begins: its marker, and the header that follows.
    fn next_log(&mut self, from: u64) -> Option<u64> {
        const NONE: u64 = u64::MAX;
        if let Some(known) = self.ahead.filter(|known| *known >= from) {
            return Some(known).filter(|at| *at < NONE);
        }
        let mut from = from.max(self.start + 1);
        let found = loop {
            let Some(at) = self.walk.next_byte(from, |byte| byte == MAGIC[0]) else { break NONE };
            let header = at + MAGIC.len() as u64;
            if self.walk.starts_with(at, MAGIC)
                && self.plausible_at(header).is_some_and(|record| record.opcode == Opcode::HEADER)
            {
                break at;
            }
            from = at + 1;
        };
        self.ahead = Some(found);
        Some(found).filter(|at| *at < NONE)
    }

    /// The last chunk ends where another recording begins.
    fn cut_at_next(&mut self) {
        if let (Some(next), Some(block)) = (self.next, self.layout.blocks.last_mut())
            && block.span.end > next
        {
            block.span.end = next;
            if block.kind != Kind::Loose {
                block.kind = Kind::Chunk { cut: true };
            }
        }
    }

    fn close_loose(&mut self, end: u64) {
        if let Some((start, begins_ns)) = self.loose.take() {
            self.layout.blocks.push(Block { kind: Kind::Loose, span: Span { start, end }, begins_ns });
        }
    }

    /// Whether the data before a `DataEnd` at `end` are as they were written, or have no checksum. Some
    /// writers leave the magic out.
    fn data_holds(&mut self, end: u64, data_end: Span) -> bool {
        let Some(crc) = data_crc(self.walk.look(data_end)).filter(|crc| *crc != 0) else { return true };
        let starts = [self.start, self.start + MAGIC.len() as u64];
        starts.iter().any(|&start| self.walk.crc(Span { start, end }) == Some(crc))
    }

    /// Whether the summary before the footer at `at` is as it was written, or has no checksum.
    fn summary_holds(&mut self, at: u64, footer: Span) -> bool {
        // The checksum ends before itself: a record's head and two offsets into the footer.
        const CHECKED: u64 = HEAD + 16;
        let Some((start, crc)) = summary_start_and_crc(self.walk.look(footer)) else { return false };
        let summary = Span { start: self.start.saturating_add(start), end: at + CHECKED };
        start == 0 || crc == 0 || (summary.start <= summary.end && self.walk.crc(summary) == Some(crc))
    }

    /// A chunk that goes on beyond the end of the file, as both its lengths say.
    fn cut_chunk(&mut self, at: u64) -> Option<Span> {
        let (Found { opcode, body }, length) = self.walk.cut_record(at)?;
        if opcode != Opcode::CHUNK {
            return None;
        }
        let chunk = ChunkRecord::parse(self.walk.look(body))?;
        let inner = chunk.compressed_size.checked_add(40 + chunk.compression.len() as u64)?;
        (known(chunk.compression) && inner == length).then_some(body)
    }

    fn is_known_chunk(&mut self, body: Span) -> bool {
        ChunkRecord::parse(self.walk.look(body)).is_some_and(|chunk| known(chunk.compression))
    }

    /// The record at `at` if cheap checks do not tell it for noise: constant time, whatever its length.
    fn plausible_at(&mut self, at: u64) -> Option<Found> {
        let record = self.walk.record(at)?;
        let length = record.body.length();
        let plausible = match record.opcode {
            Opcode::FOOTER => length == 20,
            Opcode::SCHEMA | Opcode::CHANNEL => length >= 12,
            Opcode::MESSAGE => length >= 22,
            Opcode::CHUNK => ChunkRecord::parse(self.walk.look(record.body)).is_some_and(|chunk| {
                chunk.compressed_size.checked_add(40 + chunk.compression.len() as u64) == Some(length)
            }),
            Opcode::DATA_END => length == 4,
            // An index of no message has six bytes.
            Opcode::MESSAGE_INDEX => length >= 6,
            Opcode::HEADER | 0x08..=0x0E => length >= 8,
            0x80.. => true,
            _ => false,
        };
        plausible.then_some(record)
    }

    /// A chunk whose outer length is broken but whose inner one leads to another record.
    fn chunk_by_inner_length(&mut self, at: u64) -> Option<Found> {
        if !self.walk.starts_with(at, &[Opcode::CHUNK]) {
            return None;
        }
        let start = at.checked_add(HEAD)?;
        let rest = Span { start, end: self.walk.length() };
        let chunk = ChunkRecord::parse(self.walk.look(rest)).filter(|chunk| known(chunk.compression))?;
        let length = chunk.compressed_size.checked_add(40 + chunk.compression.len() as u64)?;
        let body = Span { start, end: start.checked_add(length).filter(|end| *end <= rest.end)? };
        self.plausible_at(body.end)?;
        Some(Found { opcode: Opcode::CHUNK, body })
    }

    /// The next place before `to` that is surely a record: a chunk whose lengths agree, or three plausible
    /// records in a row (fewer at the end of the file).
    fn resync(&mut self, mut from: u64, to: u64) -> Option<u64> {
        loop {
            let at = self.walk.next_candidate(from).filter(|at| *at < to)?;
            if self.is_surely_record(at) {
                return Some(at);
            }
            from = at + 1;
        }
    }

    fn is_surely_record(&mut self, at: u64) -> bool {
        let Some(first) = self.plausible_at(at) else { return false };
        if first.opcode == Opcode::CHUNK {
            return self.is_known_chunk(first.body);
        }
        let mut next = first.body.end;
        for _ in 0..2 {
            if next == self.walk.length() || self.walk.starts_with(next, MAGIC) {
                return true;
            }
            match self.plausible_at(next) {
                Some(record) if record.opcode != Opcode::HEADER => next = record.body.end,
                _ => return false,
            }
        }
        true
    }
}

fn known(compression: &[u8]) -> bool {
    matches!(compression, b"" | b"zstd" | b"lz4")
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

    fn scanned(bytes: &[u8]) -> Option<Layout> {
        scan(&bytes.to_vec().into()).into_iter().next()
    }

    fn file(parts: &[Vec<u8>]) -> Vec<u8> {
        [&MAGIC[..], &parts.concat()].concat()
    }

    #[test]
    fn a_broken_outer_length_costs_nothing_where_the_inner_one_leads_on() {
        let mut bad = chunk(b"bbbb");
        bad[1] = 200;
        let bytes = file(&[chunk(b"aaaa"), bad, chunk(b"cccc")]);
        let layout = scanned(&bytes).unwrap();
        assert_eq!(layout.blocks.len(), 3);
        assert_eq!(layout.damage, Damage { not_closed: true, ..Damage::default() });
    }

    #[test]
    fn noise_between_chunks_is_skipped_and_counted() {
        let bytes = file(&[chunk(b"aaaa"), vec![0; 4096], chunk(b"cccc")]);
        let layout = scanned(&bytes).unwrap();
        assert_eq!((layout.blocks.len(), layout.damage.skipped_bytes), (2, 4096));
    }

    #[test]
    fn a_cut_chunk_is_found_as_such() {
        let whole = file(&[chunk(b"aaaa"), chunk(&[7; 100])]);
        let layout = scanned(&whole[..whole.len() - 50]).unwrap();
        assert!(matches!(
            layout.blocks[..],
            [Block { kind: Kind::Chunk { cut: false }, .. }, Block { kind: Kind::Chunk { cut: true }, .. }]
        ));
    }

    #[test]
    fn what_is_not_mcap_is_none() {
        assert!(scanned(b"").is_none());
        assert!(scanned(b"time;joint1;joint2\n0;1;2\n").is_none());
    }
}
