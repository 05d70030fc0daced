//! MCAP bytes: where the records are, and how to get at them whatever has happened to the file.
//!
//! No length, count or checksum is trusted here; joints are not known here.

mod block;
mod compression;
mod map;
mod record;
mod scan;

pub(super) use block::{Block, Blocks, Loss, records};
pub(super) use map::MappedFile;
pub(super) use record::{ChannelRecord, MessageRecord, Opcode, SchemaRecord};
pub(super) use scan::{Layout, scan};
