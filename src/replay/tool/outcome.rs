//! What was found at the tool. Field names are those of the report's document.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::{replay::PathError, series::JointKind};

/// The tool against its plan, over the instants at which every joint of the arm is known. Distances are between the
/// planned and the measured origin of the tool's frame at the same instant.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ToolReplay {
    /// The link whose frame is the tool's.
    pub tool: String,
    /// Number of instants.
    pub samples: usize,
    /// Mean time between them, s.
    pub sample_interval_s: f64,
    /// The first and the last, s.
    pub window_s: [f64; 2],
    /// Root mean square distance, m.
    pub rms_m: f64,
    /// Mean distance, m.
    pub mean_m: f64,
    /// Distance to the planned path, whatever the time, m.
    pub path_error: Option<PathError>,
    /// Root mean square angle between planned and measured orientation, rad; `None` where the log holds only positions.
    pub rms_orientation_rad: Option<f64>,
    /// Mean of that angle, rad.
    pub mean_orientation_rad: Option<f64>,
    /// Largest such angle, rad.
    pub worst_orientation_rad: Option<f64>,
    /// When that was, s.
    pub worst_orientation_s: Option<f64>,
    /// The largest distance.
    pub worst: ToolWorst,
    /// The distance along and across the planned path; `None` if the plan never moves the tool.
    pub split: Option<ToolSplit>,
    /// Rests of the plan that follow a motion, in order of time.
    pub rests: Vec<ToolRest>,
}

/// The instant at which the tool is farthest from its plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ToolWorst {
    /// When, s.
    pub time_s: f64,
    /// Part along the planned direction, m, positive if the tool is behind; `None` where the plan does not move it.
    pub along_m: Option<f64>,
    /// Part across that direction, m.
    pub across_m: Option<f64>,
    /// How far, and why.
    #[serde(flatten)]
    pub deviation: ToolDeviation,
}

/// The distance while the plan moves the tool, split at its direction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ToolSplit {
    /// Root mean square of the part along the planned direction, m.
    pub rms_along_m: f64,
    /// Root mean square of the part across it, m.
    pub rms_across_m: f64,
    /// Largest part along it, m.
    pub worst_along_m: f64,
    /// Largest part across it, m.
    pub worst_across_m: f64,
    /// Number of instants.
    pub samples: usize,
}

/// A rest of the plan after a motion: of all joints of the arm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ToolRest {
    /// When the plan comes to rest, s.
    pub from_s: f64,
    /// When it moves on, or the run ends, s.
    pub to_s: f64,
    /// Whether the run ends in it.
    pub at_end: bool,
    /// Distance when the plan comes to rest, m.
    pub arrival_m: f64,
    /// Instants that the rest of the numbers is the mean of: the last of the rest.
    pub samples: usize,
    /// Where the tool came to rest, and why.
    #[serde(flatten)]
    pub deviation: ToolDeviation,
}

/// Where the tool is against its plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ToolDeviation {
    /// Distance, m.
    pub error_m: f64,
    /// Angle between planned and measured orientation, rad; `None` where the log holds only positions.
    pub orientation_rad: Option<f64>,
    /// What each joint's error makes of the distance, from base to tool; empty without a distance.
    pub causes: Vec<ToolCause>,
    /// Share of the distance that the shares of the joints leave: what is not linear in their errors.
    pub nonlinear_share: f64,
}

/// What the error of one joint makes of the tool's: through the Jacobian, along the direction of the tool's error.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ToolCause {
    /// The joint.
    pub joint: String,
    /// The unit of its position: "rad" or "m".
    #[serde(rename = "unit", with = "crate::replay::unit")]
    #[cfg_attr(test, schemars(with = "String"))]
    pub kind: JointKind,
    /// Its error, planned minus measured, in its unit.
    pub joint_error: f64,
    /// What that makes at the tool, m; negative if it lessens the distance.
    pub error_m: f64,
    /// The same as a share of the distance.
    pub share: f64,
}

/// The way of the tool, for plots; all arrays are `[samples]`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ToolPath {
    /// Instants, s.
    pub t_s: Vec<f64>,
    /// Planned position in the base's frame, m.
    pub planned_m: Vec<[f64; 3]>,
    /// Measured position, m.
    pub measured_m: Vec<[f64; 3]>,
    /// Distance between them, m.
    pub error_m: Vec<f64>,
    /// Part of it along the planned direction, m, positive if the tool is behind; not-a-number at rest.
    pub along_m: Vec<f64>,
    /// Angle between the orientations, rad; empty where it is not known.
    pub orientation_rad: Vec<f64>,
    /// Continuous stretches.
    pub segments: Vec<Range<usize>>,
}

impl ToolReplay {
    /// The rest that the run ends in.
    pub fn end(&self) -> Option<&ToolRest> {
        self.rests.iter().find(|rest| rest.at_end)
    }

    /// The rest between motions at which the tool stands farthest off.
    pub fn worst_dwell(&self) -> Option<&ToolRest> {
        let dwells = self.rests.iter().filter(|rest| !rest.at_end);
        dwells.max_by(|a, b| a.deviation.error_m.total_cmp(&b.deviation.error_m))
    }
}

impl ToolDeviation {
    /// The joint that makes most of the distance.
    pub fn main_cause(&self) -> Option<&ToolCause> {
        self.causes.iter().max_by(|a, b| a.share.total_cmp(&b.share)).filter(|cause| cause.share > 0.0)
    }
}
