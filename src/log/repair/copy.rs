//! Messages of one log into another, bytes, times and sequence numbers kept.

use std::{
    collections::{BTreeMap, btree_map::Entry},
    io::{Seek, Write},
    path::Path,
};

use crate::{
    atomic_file::AtomicError,
    log::{
        channel::Definitions, error::LogError, file::MessageRecord, files::ScannedFile, write::WriteError,
    },
};

/// Whatever went wrong while writing.
pub(super) struct CopyError(Box<dyn std::error::Error + Send + Sync>);

impl CopyError {
    /// The same of a file.
    pub(super) fn of(self, output: &Path) -> LogError {
        LogError::Copy { path: output.to_owned(), source: self.0 }
    }
}

macro_rules! from {
    ($($error:ty),*) => {$(
        impl From<$error> for CopyError {
            fn from(error: $error) -> Self {
                Self(Box::new(error))
            }
        }
    )*};
}

from!(AtomicError, WriteError, mcap::McapError, std::io::Error);

/// The writer of a log that is a copy of others.
pub(super) fn writer<W: Write + Seek>(output: W, profile: &str) -> Result<mcap::Writer<W>, mcap::McapError> {
    mcap::WriteOptions::new()
        .profile(profile)
        .library(concat!("hydrotrace ", env!("CARGO_PKG_VERSION")))
        .compression(Some(mcap::Compression::Zstd))
        .compression_threads(0)
        .create(output)
}

/// Channels of an old log as the new one numbers them.
pub(super) struct Copier {
    definitions: Definitions,
    channels: BTreeMap<u16, u16>,
    /// Messages so far of channels that the old log does not define, left out.
    pub(super) unknown: u64,
    left_out: Vec<u16>,
}

impl Copier {
    pub(super) fn of(file: &ScannedFile<'_>) -> Self {
        Self {
            definitions: Definitions::gather(&file.layout, file.source, true),
            channels: BTreeMap::new(),
            unknown: 0,
            left_out: Vec::new(),
        }
    }

    /// Whether the old log has a topic.
    pub(super) fn has(&self, topic: &str) -> bool {
        self.definitions.channels.values().any(|channel| channel.topic == topic)
    }

    /// Leaves out the messages of a topic; they count as copied no more.
    pub(super) fn leave_out(&mut self, topic: &str) {
        let own = self.definitions.channels.iter().filter(|(_, channel)| channel.topic == topic);
        self.left_out = own.map(|(id, _)| *id).collect();
    }

    /// Whether the message could be copied.
    pub(super) fn message<W: Write + Seek>(
        &mut self,
        writer: &mut mcap::Writer<W>,
        message: &MessageRecord<'_>,
    ) -> Result<bool, CopyError> {
        if self.left_out.contains(&message.channel_id) {
            return Ok(false);
        }
        let channel_id = match self.channels.entry(message.channel_id) {
            Entry::Occupied(known) => *known.get(),
            Entry::Vacant(new) => {
                let Some(id) = add_channel(writer, &self.definitions, message.channel_id)? else {
                    self.unknown += 1;
                    return Ok(false);
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
        Ok(true)
    }
}

/// Copies attachments and metadata, but for those whose names are `replaced`.
pub(super) fn copy_files<W: Write + Seek>(
    writer: &mut mcap::Writer<W>,
    file: &ScannedFile<'_>,
    replaced: &[&str],
) -> Result<usize, CopyError> {
    let kept = |name: &str| !replaced.contains(&name);
    let (layout, mut data, mut attached) = (&file.layout, Vec::new(), 0);
    for attachment in layout.attachments.iter().filter(|file| kept(&file.name)) {
        attached += 1;
        file.source.read(attachment.data, &mut data)?;
        writer.attach(&mcap::Attachment {
            log_time: attachment.log_time_ns,
            create_time: attachment.create_time_ns,
            name: attachment.name.clone(),
            media_type: attachment.media_type.clone(),
            data: data.as_slice().into(),
        })?;
    }
    for one in layout.metadata.iter().filter(|one| kept(&one.name)) {
        writer.write_metadata(&mcap::records::Metadata {
            name: one.name.clone(),
            metadata: one.entries.clone(),
        })?;
    }
    Ok(attached)
}

/// Defines a channel of the old log in the new one; `None` if the old log does not define it.
fn add_channel<W: Write + Seek>(
    writer: &mut mcap::Writer<W>,
    definitions: &Definitions,
    id: u16,
) -> Result<Option<u16>, CopyError> {
    let Some(channel) = definitions.channels.get(&id) else { return Ok(None) };
    let schema = match definitions.schemas.get(&channel.schema_id) {
        Some(schema) => writer.add_schema(&schema.name, &schema.encoding, &schema.data)?,
        None => 0,
    };
    Ok(Some(writer.add_channel(schema, &channel.topic, &channel.encoding, &channel.metadata)?))
}
