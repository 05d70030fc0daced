//! Reads one message of samples.

use super::Table;
use crate::log::{
    decode::{Numbers, Sink, Slot, Texts},
    source::slot,
};

/// The message being read; its values count once it is complete.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Message {
    pub(super) second: f64,
    pub(super) nanosecond: f64,
    pub(super) speed_scaling: f64,
    /// `[field][place]`.
    pub(super) values: Vec<Vec<f64>>,
    /// Values that are NaN because the message does not have them, by field.
    pub(super) absent: Vec<u64>,
    pub(super) names: Names,
    pub(super) raw: Vec<u8>,
    pub(super) group_names: Vec<String>,
    pub(super) groups: usize,
    /// Place of each field among the values of the current group.
    pub(super) interface_places: Vec<Option<usize>>,
}

/// The joints that a message names.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) enum Names {
    #[default]
    None,
    /// Those of the message before.
    Same,
    Listed(Vec<String>),
}

impl Message {
    /// The length of the longest list of values.
    pub(super) fn places(&self) -> usize {
        self.values.iter().map(Vec::len).max().unwrap_or(0)
    }

    /// Fills up missing names and numbers of the last groups: they are optional there.
    pub(super) fn close_groups(&mut self) {
        if self.groups == 0 {
            return;
        }
        for (values, absent) in self.values.iter_mut().zip(&mut self.absent) {
            if !values.is_empty() {
                fill_up(values, self.groups, absent);
            }
        }
        if !self.group_names.is_empty() {
            self.group_names.resize(self.groups, String::new());
            self.names = Names::Listed(std::mem::take(&mut self.group_names));
        }
    }
}

/// Lengthens to `places` with values that are absent.
fn fill_up(values: &mut Vec<f64>, places: usize, absent: &mut u64) {
    *absent += places.saturating_sub(values.len()) as u64;
    values.resize(places, f64::NAN);
}

impl Sink for Table {
    #[inline]
    fn number(&mut self, slot: Slot, value: f64) {
        match slot {
            slot::SECOND => self.message.second = value,
            slot::NANOSECOND => self.message.nanosecond = value,
            slot::SPEED_SCALING => self.message.speed_scaling = value,
            _ if slot >= slot::FIELD => {
                self.numbers(slot, Numbers::Parsed(&[value]));
            }
            _ => {}
        }
    }

    fn text(&mut self, slot: Slot, text: &[u8]) {
        let message = &mut self.message;
        if slot == slot::NAMES && message.groups > 0 {
            message.group_names.resize(message.groups - 1, String::new());
            message.group_names.push(String::from_utf8_lossy(text).into_owned());
        }
    }

    #[inline]
    fn numbers(&mut self, slot: Slot, values: Numbers<'_>) {
        let message = &mut self.message;
        if slot == slot::VALUES {
            // One joint's values: its place in each field is the number of the group.
            let values = values.to_vec();
            let fields = message.values.iter_mut().zip(&mut message.absent).zip(&message.interface_places);
            for ((into, absent), place) in fields {
                fill_up(into, message.groups.saturating_sub(1), absent);
                match place.and_then(|place| values.get(place)) {
                    Some(&value) => into.push(value),
                    None => fill_up(into, message.groups.max(1), absent),
                }
            }
        } else if let Some(field) = slot.checked_sub(slot::FIELD).map(usize::from)
            && let Some(into) = message.values.get_mut(field)
        {
            if message.groups > 0 {
                fill_up(into, message.groups - 1, &mut message.absent[field]);
                match values.to_vec().first() {
                    Some(&value) => into.push(value),
                    None => fill_up(into, message.groups, &mut message.absent[field]),
                }
            } else {
                into.clear();
                values.for_each(|value| into.push(value));
            }
        }
    }

    fn texts(&mut self, slot: Slot, values: Texts<'_>) {
        match slot {
            slot::NAMES => {
                self.message.raw.clear();
                if let Texts::Wire { raw, .. } = values {
                    self.message.raw.extend_from_slice(raw);
                }
                self.message.names = Names::Listed(values.to_vec());
            }
            slot::INTERFACES => {
                let names = values.to_vec();
                self.message.interface_places = self
                    .fields
                    .iter()
                    .map(|field| names.iter().position(|name| *name == field.path))
                    .collect();
                self.interfaces.see(self.message.groups.saturating_sub(1), &self.message.interface_places);
            }
            _ => {}
        }
    }

    fn element(&mut self, slot: Slot) {
        let message = &mut self.message;
        match slot {
            Slot::MAX => {
                message.second = 0.0;
                message.nanosecond = 0.0;
                message.speed_scaling = f64::NAN;
                message.groups = 0;
                message.names = Names::None;
                message.group_names.clear();
                message.values.iter_mut().for_each(Vec::clear);
                message.absent.fill(0);
            }
            slot::GROUP => {
                message.groups += 1;
                message.interface_places.clear();
                message.interface_places.resize(message.values.len(), None);
            }
            _ => {}
        }
    }

    fn expected_texts(&self, slot: Slot) -> Option<&[u8]> {
        (slot == slot::NAMES && !self.layout.raw.is_empty()).then_some(&self.layout.raw)
    }

    fn same_texts(&mut self, slot: Slot) {
        if slot == slot::NAMES {
            self.message.names = Names::Same;
        }
    }
}
