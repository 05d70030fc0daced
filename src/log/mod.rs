//! MCAP logs: the only part of the crate that sees the format.
//!
//! Reading: bytes become records (`file`), records become fields (`schema`, `decode`), fields
//! become samples of topics (`source`), and samples become plan, measurement and other signals
//! (`read`), all in one pass. Writing: samples become messages of ROS 2 types (`write`). Logs from
//! logs: `repair`. Other formats: `csv` reads tables of a controller, `export` writes tables.

mod bag;
mod channel;
mod contents;
mod csv;
#[cfg(feature = "parquet")]
pub mod dataset;
mod decode;
#[cfg(feature = "parquet")]
mod ending;
mod error;
mod export;
mod file;
mod files;
mod flat;
mod foreign;
mod import_line;
mod input;
mod joined;
mod joint_kind;
mod last_part;
mod looks;
mod options;
mod range;
mod read;
mod recovered;
pub mod remote;
mod repair;
mod schema;
mod source;
mod unread;
mod write;

pub use bag::recording_files;
pub use contents::{Contents, WRITTEN, contents};
pub use csv::{
    AngleUnit, ColumnRead, Columns, CsvError, CsvOptions, CsvRun, JsonLines, LengthUnit, Quantity, Separator,
    TableStream, TimeRead, UNDATED_NS, Understood, is_aside, is_dated, is_header, other_header,
    read_csv_bytes,
};
#[cfg(feature = "parquet")]
pub(crate) use ending::{Ending, ending};
pub use error::LogError;
pub use export::{ExportError, RunTable};
pub use file::ReadAt;
pub use files::{LogFiles, ScannedLog};
#[doc(hidden)]
pub use files::{Passes, passes};
pub use flat::read_messages;
pub use foreign::read_csv;
pub use input::Input;
pub use joined::RecordedIn;
pub(crate) use joint_kind::{METADATA as JOINT_KINDS, entries as joint_kinds};
pub use options::{Cylinders, ReadOptions, Selector, Sides, SignalRole, TimeBase, WantedSignal};
pub use range::TimeRange;
pub use read::{
    lines::{DrawnTopic, Line, LineRole, Lines, Step},
    origin::Origin,
    read_plan, read_recording,
    recording::{Attachment, Command, FileInfo, Recording, SourceInfo, Survey, ToolPoses, TopicInfo},
    survey, survey_bytes,
};
pub use repair::{Addition, PlanSample, Recovered, recover};
pub use write::{
    ControllerState, LogWriter, Options as WriteOptions, Point, Role, Topics, Transform, WriteError,
};
