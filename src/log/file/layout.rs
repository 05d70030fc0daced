//! Where everything is in a recording.

use super::{
    block::Block,
    held::Held,
    record::{AttachmentRecord, ChannelRecord, MetadataRecord, SchemaRecord},
};

/// Where everything is in one file.
#[derive(Debug, Default)]
pub(in crate::log) struct Layout {
    /// Runs of messages in file order.
    pub(in crate::log) blocks: Vec<Block>,
    /// The channels of each block, where its index and the statistics of a sound file agree on them.
    pub(in crate::log) held: Option<Vec<Vec<Held>>>,
    /// Schemas outside chunks, those of the summary included; ids may repeat.
    pub(in crate::log) schemas: Vec<SchemaRecord>,
    /// Channels outside chunks, those of the summary included; ids may repeat.
    pub(in crate::log) channels: Vec<ChannelRecord>,
    /// Whether the channels outside chunks are known to be complete.
    pub(in crate::log) channels_complete: bool,
    pub(in crate::log) attachments: Vec<AttachmentRecord>,
    pub(in crate::log) metadata: Vec<MetadataRecord>,
    pub(in crate::log) damage: Damage,
    /// Of the header; empty if it is damaged.
    pub(in crate::log) profile: String,
    /// Why the file system did not give all of the file.
    pub(in crate::log) fault: Option<String>,
    /// Where the recording begins in the file.
    pub(in crate::log) starts_at: u64,
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
