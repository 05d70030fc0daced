//! Which fields of a log are drawn, and as what.

use super::{INTERFACES, LineRole, own};
use crate::log::{
    LogError,
    options::{ReadOptions, Selector, Sides, SignalRole},
    read::{
        candidates::Candidate,
        content::{Content, Extracted},
        select_topics::{Choice, choose},
    },
    source::{Form, is_field},
};

/// What the fields of a log are.
pub(super) struct Roles {
    choice: Choice,
    /// Whether the plan is what was sent.
    commanded: bool,
    /// The command as the caller names it.
    command: Option<Selector>,
    joints: Vec<String>,
}

impl Roles {
    pub(super) fn of(extracted: &Extracted, options: &ReadOptions) -> Result<Self, LogError> {
        let choice = choose(extracted, &ReadOptions { sides: Sides::Any, ..options.clone() })?;
        let command = options.signals.iter().find(|wanted| wanted.role == SignalRole::Command);
        let mut joints: Vec<String> = Vec::new();
        for name in choice.planned.iter().chain(&choice.measured).flat_map(|candidate| &candidate.joints) {
            let asked = options.joints.is_empty() || options.joints.contains(name);
            if asked && !joints.contains(name) {
                joints.push(name.clone());
            }
        }
        if !options.joints.is_empty() {
            joints.sort_by_key(|name| options.joints.iter().position(|one| one == name));
        }
        let commanded = choice.commanded().next().is_some();
        Ok(Self { commanded, command: command.and_then(|wanted| wanted.topic.clone()), choice, joints })
    }

    /// Whether a joint is of plan or measurement.
    pub(super) fn wants(&self, joint: &str) -> bool {
        self.joints.iter().any(|one| one == joint)
    }

    /// The place of a joint in the order of the plan.
    pub(super) fn place(&self, joint: &str) -> usize {
        self.joints.iter().position(|one| one == joint).unwrap_or(usize::MAX)
    }

    /// Topics whose messages are whole plans.
    pub(super) fn trajectories(&self, extracted: &Extracted) -> Vec<String> {
        let whole = self.choice.planned.iter().filter(|candidate| candidate.field.is_none());
        whole.map(|candidate| extracted.topic_of(candidate.source).topic.clone()).collect()
    }

    /// What a field of a table shows, if it is drawn.
    pub(super) fn of_field(&self, extracted: &Extracted, source: usize, field: usize) -> Option<LineRole> {
        let Content::Table(table) = &extracted.sources.get(source)?.content else { return None };
        let topic = extracted.topic_of(source).topic.as_str();
        let path = table.fields.get(field)?.path.as_str();
        let of_table = |index: Option<usize>| index.and_then(|index| table.fields.get(index));
        let chosen = |side: &[_], speed: bool| {
            side.iter().any(|one: &Candidate| {
                let position = one.source == source && one.field == Some(field);
                let its_speed = || of_table(one.field).and_then(|one| one.velocity) == Some(field);
                if speed { one.source == source && its_speed() } else { position }
            })
        };
        if let Some(command) = &self.command {
            let asked = command.field.as_deref();
            let position = of_table(Some(field)).is_some_and(|field| !field.is_velocity);
            if command.topic == topic && asked.map_or(position, |asked| is_field(path, asked)) {
                return Some(LineRole::Command);
            }
        }
        let (planned, measured) = (&self.choice.planned[..], &self.choice.measured[..]);
        if chosen(planned, false) {
            return Some(if self.commanded { LineRole::Command } else { LineRole::Planned });
        }
        if chosen(measured, false) {
            return Some(LineRole::Measured);
        }
        if chosen(planned, true) {
            return Some(LineRole::PlannedSpeed);
        }
        if chosen(measured, true) {
            return Some(LineRole::MeasuredSpeed);
        }
        let is_position = path == "position" && table.form == Form::Table;
        let of_own = [LineRole::Command, LineRole::Error].into_iter();
        if let Some(role) = of_own.filter(|_| is_position).find(|role| own(*role).as_deref() == Some(topic)) {
            return (role != LineRole::Command || self.command.is_none()).then_some(role);
        }
        let of_measured = || measured.iter().any(|one| one.source == source);
        match table.form {
            Form::Interfaces => {
                let known = INTERFACES.iter().find(|(_, name)| *name == path);
                known.map(|(role, _)| *role)
            }
            _ if path == "error.positions" => Some(LineRole::Error),
            _ if ["effort", "joints.effort"].contains(&path) && of_measured() => Some(LineRole::Effort),
            _ => None,
        }
    }

    /// Why nothing is drawn.
    pub(super) fn nothing(&self, extracted: &Extracted) -> LogError {
        let topics = self.choice.planned.iter().chain(&self.choice.measured);
        let mut topics: Vec<&str> =
            topics.map(|candidate| extracted.topic_of(candidate.source).topic.as_str()).collect();
        topics.dedup();
        LogError::NothingToDraw { topics: topics.join(", ") }
    }
}
