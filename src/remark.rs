//! Doubts about data: what was dropped, repaired or looks wrong, counted and never silent.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// What kind of doubt a [`Remark`] states. The serialised name is stable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Code {
    /// The recording has no end marker: power loss or a kill while recording.
    NotClosed,
    /// Bytes that are no record, skipped.
    DamagedBytes,
    /// A chunk whose checksum or compression is broken, dropped.
    DamagedChunk,
    /// A cut or broken chunk, of which the whole messages before the break were kept.
    PartialChunk,
    /// Messages of a channel that the file does not define.
    UnknownChannel,
    /// A channel whose schema is missing or cannot be understood, skipped.
    UnreadableSchema,
    /// Messages that do not fit their schema, skipped.
    UndecodableMessage,
    /// A file of a split recording that is named but absent, or a source of many logs that leads to none.
    MissingFile,
    /// A file beside a log that differs from the one that the log carries, which counts; or one in it that differs from
    /// what was written there.
    OtherFile,
    /// Arrays whose length differs from the list of joint names.
    LengthMismatch,
    /// Samples that are NaN or infinite, dropped.
    NotFinite,
    /// Angles that look like degrees.
    LooksLikeDegrees,
    /// A joint that was recorded in another frame than its plan: sign, zero, unit or name.
    UnlikePlan,
    /// Joints that follow their plan at another time: clocks differ, or the machine ran at another speed.
    OtherTime,
    /// Joints that move before their plan: plan and measurement are swapped, or clocks differ.
    BeforePlan,
    /// Runs to compare whose measurements differ in noise or rate, or that were analysed otherwise.
    MeasuredOtherwise,
    /// A machine that stood while its plan went on.
    Stopped,
    /// Header stamps that are zero or stand still, so another clock was used.
    UnusableStamp,
    /// Samples with the stamp of their predecessor, dropped.
    DuplicateStamp,
    /// Samples logged, or runs given, out of order, sorted.
    Reordered,
    /// The clock jumped backwards; the run was split there.
    ClockJump,
    /// Longer silence than the sampling explains; the run was split there.
    Gap,
    /// A sensor that repeats one value while the plan moves.
    FrozenSensor,
    /// A joint whose angle wraps by a full turn.
    Wrapped,
    /// The controller was paused or slowed (speed scaling below one).
    Paused,
    /// The order or set of joints changes within a topic.
    JointsChange,
    /// Planned joints that were never measured, or the other way round.
    UnpairedJoint,
    /// A table that holds a plan without a measurement, or the other way round.
    OneSide,
    /// Samples outside the time in which both planned and measured exist.
    Unmatched,
    /// A start time known only from the receipt of a message.
    StartOnReceipt,
    /// A trajectory that was cut short by the next one or by a cancel.
    TrajectoryReplaced,
    /// What was sent stands in for a plan that is not there; the error is against the command.
    PlanIsCommand,
    /// Another topic would have served as well.
    Ambiguous,
    /// Values that no joint can have, dropped.
    Implausible,
    /// A plan that steps farther within a sample than any joint moves.
    PlanJumps,
    /// A limit of what this program understands.
    NotSupported,
    /// Something that the data do not say, taken from how they look.
    Guessed,
    /// Dates in which the day or the month may come first.
    DateOrder,
    /// Links without a mass, whose joints so need no torque.
    NoMass,
    /// Two key points in a row that are one, where the arm stops.
    EqualKeyPoints,
    /// A key point at the end of a joint's range, where the arm stops.
    RangeEnd,
    /// Key points that are passed later than a plan would be that stops at each.
    StopsAreFaster,
    /// A ceiling so high that it binds nothing.
    InactiveBound,
    /// Limits that are judged between runs of different plans.
    OtherPlan,
    /// Runs of so few days that what differs from day to day is not known.
    FewDays,
    /// Files that look like a run each, read as one.
    SeveralRuns,
    /// Both sides of a comparison, or plan and measurement, are one.
    SameRun,
    /// What was sent to the machine is not what was made to be sent.
    SentOtherwise,
    /// A model that predicts too badly to make commands from.
    PoorFit,
    /// A machine that no longer answers the same command with the same error: older runs say little of it.
    MachineChanged,
    /// Logs among many that cannot be analysed.
    UnreadableLog,
    /// Runs among many that name no machine, or machines whose names are spelt in two ways.
    UnknownMachine,
    /// Runs among many that do not say when they were.
    Undated,
    /// Something that a command does beyond what the plan does.
    BeyondLimit,
}

impl Code {
    /// Doubts with which a run is none of its plan: no command is made from it, and it says nothing of the machine.
    pub const SPOILS_RUNS: [Self; 2] = [Self::OtherTime, Self::Stopped];

    /// Whether this is one of [`Self::SPOILS_RUNS`].
    pub fn spoils_runs(self) -> bool {
        Self::SPOILS_RUNS.contains(&self)
    }

    /// How little it says of the run, 0 to 3.
    fn lightness(self) -> u8 {
        match self {
            Self::OtherTime | Self::SeveralRuns | Self::Stopped => 0,
            Self::BeforePlan
            | Self::FrozenSensor
            | Self::Implausible
            | Self::LooksLikeDegrees
            | Self::PlanJumps
            | Self::UnlikePlan
            | Self::UnusableStamp => 1,
            Self::DuplicateStamp | Self::StartOnReceipt => 3,
            _ => 2,
        }
    }

    /// The stable name, as in JSON.
    pub fn name(self) -> String {
        serde_json::to_value(self).ok().and_then(|v| v.as_str().map(str::to_owned)).unwrap_or_default()
    }
}

/// Schemas do not list the codes, so that a new one changes none of them.
#[cfg(test)]
impl schemars::JsonSchema for Code {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Code".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({
            "description": "What kind of doubt a remark states. A name keeps its meaning; new ones come.",
            "type": "string",
            "pattern": "^[a-z]+(-[a-z]+)*$"
        })
    }
}

/// One doubt, with how often it arose.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Remark {
    /// Kind.
    pub code: Code,
    /// What was found and what was done about it, for a person.
    pub message: String,
    /// How many samples, messages, bytes or joints it concerns; the message says which.
    pub count: u64,
}

/// Remarks in the order of their first appearance, equal ones summed.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(from = "Vec<Remark>", into = "Vec<Remark>")]
pub struct Remarks {
    list: Vec<Remark>,
    index: BTreeMap<(Code, String), usize>,
}

impl Remarks {
    /// Adds `count` cases of a doubt; none if `count` is zero.
    pub fn add(&mut self, code: Code, count: u64, message: impl Into<String>) {
        if count == 0 {
            return;
        }
        let message = message.into();
        if let Some(&at) = self.index.get(&(code, message.clone())) {
            self.list[at].count = self.list[at].count.saturating_add(count);
            return;
        }
        self.index.insert((code, message.clone()), self.list.len());
        self.list.push(Remark { code, message, count });
    }

    /// Adds all of another list.
    pub fn extend(&mut self, other: Remarks) {
        for remark in other.list {
            self.add(remark.code, remark.count, remark.message);
        }
    }

    /// All but those of one kind.
    pub fn without(mut self, code: Code) -> Self {
        self.retain(|remark| remark.code != code);
        self
    }

    /// Keeps those that still hold.
    pub fn retain(&mut self, holds: impl FnMut(&Remark) -> bool) {
        let mut list = Vec::from(std::mem::take(self));
        list.retain(holds);
        *self = list.into();
    }

    /// The remarks, in order of first appearance.
    pub fn as_slice(&self) -> &[Remark] {
        &self.list
    }

    /// The remark that says most of the run; the first of several.
    pub fn gravest(&self) -> Option<&Remark> {
        self.list.iter().min_by_key(|remark| remark.code.lightness())
    }

    /// Whether there is nothing to remark.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }
}

impl From<Vec<Remark>> for Remarks {
    fn from(list: Vec<Remark>) -> Self {
        let mut remarks = Self::default();
        remarks.extend(Self { list, ..Self::default() });
        remarks
    }
}

impl From<Remarks> for Vec<Remark> {
    fn from(remarks: Remarks) -> Self {
        remarks.list
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_remarks_are_summed_and_zero_is_none() {
        let mut remarks = Remarks::default();
        remarks.add(Code::Gap, 1, "a gap");
        remarks.add(Code::NotFinite, 0, "nothing");
        remarks.add(Code::Gap, 2, "a gap");
        assert_eq!(remarks.as_slice(), [Remark { code: Code::Gap, message: "a gap".into(), count: 3 }]);
    }
}
