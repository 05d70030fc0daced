//! MCAP bytes: where the records are, and how to get at them whatever has happened to the file.
//!
//! Nothing here trusts a length, a count or a checksum; nothing knows what a joint is.

mod block;
mod compression;
mod map;
mod record;
mod scan;

pub(super) use block::{Block, Blocks, Loss, records};
pub(super) use map::MappedFile;
pub(super) use record::{ChannelRecord, MessageRecord, Opcode, SchemaRecord};
pub(super) use scan::{Layout, scan};
