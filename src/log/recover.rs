//! Copies everything of a damaged log that is whole into a sound one.

use std::{
    collections::{BTreeMap, btree_map::Entry},
    io::{BufWriter, Seek, Write},
    path::Path,
};

use super::{
    LogError,
    channel::Definitions,
    file::{Blocks, Layout, Loss, MappedFile, MessageRecord, Opcode, records, scan},
    read::{describe_damage, not_mcap},
};
use crate::{
    atomic::{AtomicError, write_atomically},
    remark::{Code, Remarks},
};

/// What a recovery saved.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Recovered {
    /// Messages in the new log.
    pub messages: u64,
    /// Chunks, or runs of messages outside chunks, that were read.
    pub blocks: usize,
    /// Of these, dropped whole.
    pub dropped_blocks: u64,
    /// Attachments in the new log.
    pub attachments: usize,
    /// What was lost or doubtful; empty if nothing was.
    pub remarks: Remarks,
}

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Writes what is whole in `log`, the partial last chunk included, to `output`.
///
/// Messages keep their bytes, times and sequence numbers; attachments and metadata are copied.
///
/// # Errors
///
/// [`LogError`] if `log` is no log at all, or `output` cannot be written.
pub fn recover(log: &Path, output: &Path) -> Result<Recovered, LogError> {
    let map = MappedFile::open(log).map_err(LogError::file("open", log))?;
    let layout = scan(&map).ok_or_else(|| not_mcap(log, &map))?;
    let mut remarks = Remarks::default();
    let name = log.file_name().unwrap_or_default().to_string_lossy().into_owned();
    describe_damage(&name, &layout, &mut remarks);
    let mut saved = Recovered {
        messages: 0,
        blocks: layout.blocks.len(),
        dropped_blocks: 0,
        attachments: layout.attachments.len(),
        remarks,
    };
    let written = write_atomically(output, |file| {
        copy(&layout, file, &mut saved).map_err(|source| CopyError { source })
    });
    written.map_err(|error| LogError::Recover { path: output.to_owned(), source: error.source })?;
    Ok(saved)
}

/// Wraps whatever went wrong while writing.
struct CopyError {
    source: Failure,
}

impl From<AtomicError> for CopyError {
    fn from(error: AtomicError) -> Self {
        Self { source: Box::new(error) }
    }
}

fn copy<W: Write + Seek>(
    layout: &Layout<'_>,
    file: &mut BufWriter<W>,
    saved: &mut Recovered,
) -> Result<(), Failure> {
    let definitions = Definitions::gather(layout, true);
    let mut writer = mcap::WriteOptions::new()
        .profile(layout.profile.as_str())
        .library(concat!("hydrotrace ", env!("CARGO_PKG_VERSION")))
        .compression(Some(mcap::Compression::Zstd))
        .compression_threads(0)
        .create(file)?;
    for attachment in &layout.attachments {
        writer.attach(&mcap::Attachment {
            log_time: attachment.log_time_ns,
            create_time: attachment.create_time_ns,
            name: attachment.name.clone(),
            media_type: attachment.media_type.clone(),
            data: attachment.data.into(),
        })?;
    }
    for one in &layout.metadata {
        writer.write_metadata(&mcap::records::Metadata {
            name: one.name.clone(),
            metadata: one.entries.clone(),
        })?;
    }
    let mut channels: BTreeMap<u16, u16> = BTreeMap::new();
    let mut unknown = 0;
    let mut blocks = Blocks::new();
    for block in &layout.blocks {
        let (bytes, loss) = blocks.open(*block);
        let before = saved.messages;
        let mut end = 0;
        for record in records(bytes) {
            end = record.end;
            if record.opcode != Opcode::MESSAGE {
                continue;
            }
            let Some(message) = MessageRecord::parse(record.body) else { continue };
            let channel_id = match channels.entry(message.channel_id) {
                Entry::Occupied(known) => *known.get(),
                Entry::Vacant(new) => {
                    let Some(id) = add_channel(&mut writer, &definitions, message.channel_id)? else {
                        unknown += 1;
                        continue;
                    };
                    *new.insert(id)
                }
            };
            writer.write_to_known_channel(
                &mcap::records::MessageHeader {
                    channel_id,
                    sequence: message.sequence,
                    log_time: message.log_time_ns,
                    publish_time: message.publish_time_ns,
                },
                message.data,
            )?;
            saved.messages += 1;
        }
        match loss {
            Loss::Nothing if end < bytes.len() => {
                let left = bytes.len() - end;
                let message = "bytes at the ends of chunks that are no record";
                saved.remarks.add(Code::DamagedChunk, left as u64, message);
            }
            Loss::Nothing => {}
            Loss::Cut => {
                let kept = saved.messages - before;
                let message =
                    format!("the file ends within a chunk; {kept} whole messages before the cut were kept");
                saved.remarks.add(Code::PartialChunk, 1, message);
            }
            Loss::Dropped(reason) => {
                saved.dropped_blocks += 1;
                saved.remarks.add(Code::DamagedChunk, 1, format!("a chunk was dropped: {reason}"));
            }
        }
    }
    saved.remarks.add(Code::UnknownChannel, unknown, "messages of channels that the file does not define");
    writer.finish()?;
    Ok(())
}

/// Defines a channel of the old log in the new one; `None` if the old log does not define it.
fn add_channel<W: Write + Seek>(
    writer: &mut mcap::Writer<W>,
    definitions: &Definitions,
    id: u16,
) -> Result<Option<u16>, Failure> {
    let Some(channel) = definitions.channels.get(&id) else { return Ok(None) };
    let schema = match definitions.schemas.get(&channel.schema_id) {
        Some(schema) => writer.add_schema(&schema.name, &schema.encoding, &schema.data)?,
        None => 0,
    };
    Ok(Some(writer.add_channel(schema, &channel.topic, &channel.encoding, &channel.metadata)?))
}
