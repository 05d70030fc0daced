//! MCAP logs: the only part of the crate that sees the format.
//!
//! Reading: bytes become records (`file`), records become fields (`schema`, `decode`), fields
//! become samples of topics (`source`, `read`), and two topics become planned and measured
//! series. Writing: samples become messages of ROS 2 types (`write`). Other formats: `csv` reads
//! tables of a controller, `export` writes tables.

mod assemble;
mod bag;
mod channel;
mod copy;
mod csv;
mod decode;
mod description;
mod error;
mod export;
mod file;
mod join;
mod overlap;
mod parallel;
mod quality;
mod read;
mod recording;
mod recover;
mod schema;
mod select_topics;
mod source;
mod track;
mod write;

pub use bag::recording_files;
pub use csv::{
    AngleUnit, ColumnRead, Columns, CsvError, CsvOptions, CsvRun, Quantity, Separator, TimeRead, Understood,
    read_csv, read_csv_bytes,
};
pub use description::read_description;
pub use error::LogError;
pub use export::{ExportError, RunTable};
pub use join::{Addition, PlanSample, join};
pub use read::{Attachment, FileInfo};
pub use recording::{
    ReadOptions, Recording, SourceInfo, Survey, TimeBase, TopicInfo, read_measured, read_plan,
    read_recording, survey, survey_bytes,
};
pub use recover::{Recovered, recover};
pub use source::Selector;
pub use write::{
    ControllerState, LogWriter, Options as WriteOptions, Point, Role, Topics, Transform, WriteError,
};
