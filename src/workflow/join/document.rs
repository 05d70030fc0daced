//! What `join` found: its JSON document.

use serde::{Deserialize, Serialize};

use crate::{
    remark::Remarks,
    series::{JointKind, Located},
};

/// What the format is called.
pub(super) const FORMAT: &str = "hydrotrace.join.v1";

/// Where the plan was sent, and what the new log holds. Times are seconds since the start of the
/// run's log.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Joined {
    /// Always "hydrotrace.join.v1".
    pub format: String,
    /// Name and version of the program that wrote it.
    pub program: String,
    /// Topic and field of what was sent; null if the caller gave the time.
    pub sent: Option<String>,
    /// Whether the command was sent, and not the plan itself.
    pub sent_is_command: bool,
    /// Whether the log had this plan, so that what was sent is the command of the plan's file.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub keeps_plan: bool,
    /// When the first sample of the plan was sent, s.
    pub at_s: f64,
    /// Root mean square difference between what was sent and what was made, rad, of joints that slide m; null if the caller
    /// gave the time.
    pub rms_difference_rad: Option<f64>,
    /// Other places that fit as well; null if the caller gave the time.
    pub other_places: Option<usize>,
    /// From the first to the last sample of the plan, s.
    pub duration_s: f64,
    /// Rest added before the plan, s.
    pub rest_before_s: f64,
    /// Rest added after the plan, s.
    pub rest_after_s: f64,
    /// Number of joints of the plan.
    pub joints: usize,
    /// Messages of the run that were copied.
    pub messages: u64,
    /// Names of the files that came with the plan.
    pub files: Vec<String>,
    /// Doubts about the data.
    pub remarks: Remarks,
    /// Where the plan was found; not written.
    #[serde(skip)]
    pub located: Option<Located>,
    /// How the plan's joints move; not written.
    #[serde(skip)]
    pub kinds: Vec<JointKind>,
}
