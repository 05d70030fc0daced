//! MCAP bytes: where the records are, and how to get at them whatever has happened to the file.
//!
//! No length, count or checksum is trusted here; joints are not known here.

mod block;
mod compression;
mod held;
mod layout;
mod lz4;
mod record;
mod scan;
mod source;
mod span;
mod summary;
mod walk;

pub(super) use block::{Block, Blocks, Loss, records};
pub(super) use held::Held;
pub(super) use layout::Layout;
pub(super) use record::{ChannelRecord, MessageRecord, Opcode, SchemaRecord};
#[cfg(feature = "parquet")]
pub(super) use scan::MAGIC;
pub(super) use scan::scan;
pub use source::ReadAt;
pub(super) use source::Source;
pub(super) use span::Span;
pub(super) use summary::{Summary, summary};
