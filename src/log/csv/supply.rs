//! The pressure before the valves, by its header: a report of it needs no option.

use super::{Role, label::Label, unit::Measure};

/// Where our logs keep it.
pub(super) const SUPPLY: &str = "supply_pressure_pa";

/// What it is called, and what else a pressure of such a name may be.
const CALLED: [&str; 12] = [
    "supply", "pump", "system", "sys", "pumpe", "versorgung", "systemdruck", "pumpendruck",
    "versorgungsdruck", "alimentation", "pompe", "bomba",
];
const OTHER: [&str; 15] = [
    "max", "min", "limit", "alarm", "warn", "pilot", "tank", "return", "filter", "delta", "diff", "control",
    "rücklauf", "steuerdruck", "leckage",
];

/// The only free column of a pressure that is called so.
pub(super) fn of_supply(labels: &[Label], free: impl Fn(usize) -> bool) -> Option<usize> {
    let has = |label: &Label, words: &[&str]| label.words.iter().any(|word| words.contains(&word.as_str()));
    let is = |label: &Label| {
        let pressure = label.unit.or(label.stated).is_some_and(|unit| unit.measure == Measure::Pressure);
        let wanted = matches!(label.role, Some(Role::Planned | Role::Command));
        pressure && !wanted && has(label, &CALLED) && !has(label, &OTHER)
    };
    let mut found = (0..labels.len()).filter(|column| free(*column) && is(&labels[*column]));
    found.next().filter(|_| found.next().is_none())
}
