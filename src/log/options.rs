//! Options of reading a log.

use std::{collections::BTreeMap, path::PathBuf};

use serde::{Deserialize, Serialize};

use super::{
    csv::{CsvError, CsvOptions, LengthUnit},
    range::TimeRange,
    write::{SUPPLY, Topics, VALVE},
};
use crate::series::{JointKind, Quantity};

/// Topics, joints, clock and units, where the log alone does not determine them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// Which of plan and measurement the log must hold.
    pub sides: Sides,
    /// Topics of the plan; empty: found by type and name.
    pub planned: Vec<Selector>,
    /// Topics of the measurement; empty: found by type and name.
    pub measured: Vec<Selector>,
    /// Signals to read beside them, in the same pass.
    pub signals: Vec<WantedSignal>,
    /// Joints to read, and names for topics that carry none; empty: all.
    pub joints: Vec<String>,
    /// Which clock to use; `None`: the header's where it is usable.
    pub time_base: Option<TimeBase>,
    /// Plan and command are in degrees.
    pub planned_in_degrees: bool,
    /// The measurement is in degrees.
    pub measured_in_degrees: bool,
    /// How much later than its instants the measurement is stamped, ns: taken off. 0 says that plan and measurement are of one clock, so
    /// that joints which move before their plan do so; `None`: that is not known.
    pub measured_delay_ns: Option<i64>,
    /// Whether to read the speeds that come with measured positions, too.
    pub measured_velocities: bool,
    /// Joints that slide, and the unit of their positions; those that the log's URDF calls prismatic do anyway, in m.
    pub slides: BTreeMap<String, LengthUnit>,
    /// Joints without end stops, whose angle may wrap by a full turn; those that the log's URDF calls continuous may anyway.
    pub continuous: Vec<String>,
    /// What becomes of joints that cylinders turn.
    pub cylinders: Option<Cylinders>,
    /// The stretch of the run to read.
    pub range: TimeRange,
    /// How tables are read (TOML), as `import --save-map` wrote it.
    pub map: Option<PathBuf>,
    /// Text of the robot's URDF, in place of what the log holds of it.
    pub description: Option<String>,
}

/// Cylinders of the arm, by which lengths of cylinders and angles of joints follow from one another.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cylinders {
    /// The file that describes them.
    pub file: PathBuf,
    /// What joints with a cylinder are read as: angles, or lengths of the cylinder as the log has them.
    pub into: JointKind,
}

/// Which of plan and measurement are read; the others are empty.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Sides {
    /// Both, of joints that they share.
    #[default]
    Both,
    /// The plan.
    Plan,
    /// The plan, and the measurement if there is one.
    PlanAtLeast,
    /// The measurement, and the plan if there is one.
    MeasurementAtLeast,
    /// At least one of them.
    Any,
}

/// A signal to read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WantedSignal {
    /// Which.
    pub role: SignalRole,
    /// Where it is; then it must be there. `None`: where our own logs have it, if it is there.
    pub topic: Option<Selector>,
}

/// Role of a signal beside plan and measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SignalRole {
    /// The positions that were sent to the controller.
    Command,
    /// The signals that were sent to the valves.
    Valve,
    /// Pressures on the sides of the cylinders without a rod.
    CapPressure,
    /// Pressures on the sides of the rods.
    RodPressure,
    /// Pressures before the valves.
    SupplyPressure,
    /// Measured torques of joints that turn, forces of joints that slide.
    Effort,
}

impl SignalRole {
    /// What was sent to the machine, and what its valves did.
    pub(crate) const OF_DRIVES: [Self; 5] =
        [Self::Command, Self::Valve, Self::CapPressure, Self::RodPressure, Self::SupplyPressure];

    /// The quantity of its values.
    pub const fn quantity(self, kind: JointKind) -> Quantity {
        match (self, kind) {
            (Self::Command, _) => kind.quantity(),
            (Self::Valve, _) => Quantity::Share,
            (Self::CapPressure | Self::RodPressure | Self::SupplyPressure, _) => Quantity::Pressure,
            (Self::Effort, JointKind::Turns) => Quantity::Torque,
            (Self::Effort, JointKind::Slides) => Quantity::Force,
        }
    }

    /// Where our own logs have it.
    pub(super) fn usual(self) -> Selector {
        let Topics { command, interfaces, measured, .. } = Topics::default();
        let (topic, field) = match self {
            Self::Command => (command, None),
            Self::Valve => (interfaces, Some(VALVE)),
            Self::CapPressure => (interfaces, Some("cap_pressure_pa")),
            Self::RodPressure => (interfaces, Some("rod_pressure_pa")),
            Self::SupplyPressure => (interfaces, Some(SUPPLY)),
            Self::Effort => (measured, Some("effort")),
        };
        Selector { topic, field: field.map(str::to_owned) }
    }
}

impl ReadOptions {
    /// How tables are read; where the plan alone is wanted, what says neither side is the plan.
    ///
    /// # Errors
    ///
    /// [`CsvError::MapFile`].
    pub(super) fn columns(&self) -> Result<CsvOptions, CsvError> {
        let of_map = self.map.as_deref().map(CsvOptions::from_map).transpose()?.unwrap_or_default();
        let slides_if_unsaid = self.slides.clone();
        Ok(CsvOptions { as_plan: self.sides == Sides::Plan, slides_if_unsaid, ..of_map })
    }

    /// With signals that are read if they are where our own logs have them; one that the caller named stays.
    pub fn wanting(mut self, roles: &[SignalRole]) -> Self {
        for &role in roles {
            if self.signals.iter().all(|wanted| wanted.role != role) {
                self.signals.push(WantedSignal::usual(role));
            }
        }
        self
    }
}

impl WantedSignal {
    /// A signal that is read if it is where our own logs have it.
    pub const fn usual(role: SignalRole) -> Self {
        Self { role, topic: None }
    }

    /// Where to look for it.
    pub(super) fn selector(&self) -> Selector {
        self.topic.clone().unwrap_or_else(|| self.role.usual())
    }
}

/// Which clock the times of a run come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum TimeBase {
    /// The stamp in the message: when the sample was taken.
    Header,
    /// When the message was published.
    Publish,
    /// When the recorder received it.
    Log,
}

impl TimeBase {
    /// The word for it on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Header => "header",
            Self::Publish => "publish",
            Self::Log => "log",
        }
    }
}

/// A topic as a caller names it: `TOPIC` or `TOPIC:FIELD`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Selector {
    /// Topic name.
    pub topic: String,
    /// Path of the field within the message, where the topic has several.
    pub field: Option<String>,
}

/// As [`Selector::parse`] reads it.
impl std::fmt::Display for Selector {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match &self.field {
            Some(field) => write!(f, "{}:{field}", self.topic),
            None => write!(f, "{}", self.topic),
        }
    }
}

impl Selector {
    /// Splits at the last colon; topic names have none.
    pub fn parse(text: &str) -> Self {
        match text.rsplit_once(':') {
            Some((topic, field)) if !field.is_empty() => {
                Self { topic: topic.into(), field: Some(field.into()) }
            }
            _ => Self { topic: text.trim_end_matches(':').into(), field: None },
        }
    }
}
