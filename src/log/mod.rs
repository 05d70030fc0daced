//! MCAP logs: the only part of the crate that sees the format.
//!
//! Bytes become records (`file`), records become fields (`schema`, `decode`), fields become
//! samples of topics (`source`, `read`), and two topics become planned and measured series.

mod bag;
mod channel;
mod decode;
mod error;
mod file;
mod read;
mod schema;
mod source;

pub use error::LogError;
pub use read::{Attachment, FileInfo};
pub use source::Selector;
