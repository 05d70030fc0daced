//! stub

mod write;

pub use write::{ControllerState, LogWriter, Options, Point, Role, Topics, WriteError};
