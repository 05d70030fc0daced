//! Limits of a plan.

use serde::{Deserialize, Serialize};

use crate::series::JointKind;

/// A quantity with a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Limit {
    /// Position of a joint, rad; m of one that slides, and so its derivatives.
    Position,
    /// Speed of a joint, rad/s.
    Speed,
    /// Acceleration of a joint, rad/s².
    Acceleration,
    /// Jerk of a joint, rad/s³.
    Jerk,
    /// Torque of a joint, N m; force of one that slides, N.
    Torque,
    /// Speed of the rod of a joint's cylinder, m/s (the paper's linear velocity): by the task, and by
    /// what the whole pump gives that joint alone.
    RodSpeed,
    /// Force of a joint's cylinders at supply pressure, N.
    RodForce,
    /// Flow that all cylinders take from the pump together, m³/s.
    PumpFlow,
    /// Speed of the tool, m/s.
    ToolSpeed,
}

impl Limit {
    /// What people call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Speed => "speed",
            Self::Acceleration => "acceleration",
            Self::Jerk => "jerk",
            Self::Torque => "torque",
            Self::RodSpeed => "rod speed",
            Self::RodForce => "rod force",
            Self::PumpFlow => "pump flow",
            Self::ToolSpeed => "tool speed",
        }
    }

    /// The same of a joint of a kind.
    pub fn name_of(self, kind: JointKind) -> &'static str {
        if self == Self::Torque && kind == JointKind::Slides { "force" } else { self.name() }
    }

    /// Whether it is of what a motion takes, which no command has of itself.
    pub fn is_load(self) -> bool {
        matches!(self, Self::Torque | Self::RodForce)
    }

    /// Those that every joint has, in the order of the rows.
    pub const OF_JOINT: [Self; 7] = [
        Self::Position,
        Self::Speed,
        Self::Acceleration,
        Self::Jerk,
        Self::Torque,
        Self::RodSpeed,
        Self::RodForce,
    ];

    /// Those of the arm as a whole, after the joints' rows.
    pub const OF_ARM: [Self; 2] = [Self::PumpFlow, Self::ToolSpeed];

    /// Whether the spline alone decides it: of the others a plan asks the mechanics.
    pub(super) fn is_of_the_spline(self) -> bool {
        matches!(self, Self::Position | Self::Speed | Self::Acceleration | Self::Jerk)
    }

    /// Number of rows for so many joints.
    pub(super) fn rows(joints: usize) -> usize {
        joints * Self::OF_JOINT.len() + Self::OF_ARM.len()
    }
}

/// Where a limit comes nearest to being broken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Margin {
    /// The quantity.
    pub limit: Limit,
    /// The joint, if it is a joint's.
    pub joint: Option<usize>,
    /// How the joint moves, and so the unit of the value.
    pub kind: JointKind,
    /// The value there, in the limit's unit; signed where the quantity is.
    pub value: f64,
    /// Largest value allowed in that direction.
    pub allowed: f64,
    /// Value divided by the allowed one; of a range, distance from its middle divided by half its width. Above 1 the
    /// limit is broken.
    pub share: f64,
    /// When, s.
    pub t_s: f64,
}

/// A limit is kept up to this share of it: 1 and some rounding.
pub const KEPT_SHARE: f64 = 1.0 + 1e-9;

impl Margin {
    /// How many times as slow a plan comes to the limit as it is now; `None` of what time alone does not mend.
    pub fn slower(&self) -> Option<f64> {
        match self.limit {
            Limit::Speed | Limit::RodSpeed | Limit::PumpFlow | Limit::ToolSpeed => Some(self.share),
            Limit::Acceleration => Some(self.share.sqrt()),
            Limit::Jerk => Some(self.share.cbrt()),
            Limit::Position | Limit::Torque | Limit::RodForce => None,
        }
    }

    /// Whether the limit is broken.
    pub fn broken(&self) -> bool {
        self.share > KEPT_SHARE
    }
}
