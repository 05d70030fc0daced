//! The pressure before the valves, by its header: a report of it needs no option.

use super::{Role, label::Label, unit::Measure};

/// What it is called; where nothing is, that of a pump is meant. And what else a pressure of such a name may be.
const CALLED: [&str; 6] = ["supply", "system", "sys", "versorgung", "systemdruck", "versorgungsdruck"];
const OF_PUMP: [&str; 6] = ["pump", "pumpe", "pumpendruck", "pompe", "bomba", "alimentation"];
const OTHER: [&str; 30] = [
    "max", "min", "limit", "alarm", "warn", "pilot", "tank", "return", "filter", "delta", "diff", "control",
    "rücklauf", "steuerdruck", "leckage", "charge", "boost", "water", "cooling", "air", "brake", "suction",
    "inlet", "case", "drain", "error", "difference", "speise", "speisedruck", "saug",
];

/// The only free column of a pressure that is called so.
pub(super) fn of_supply(labels: &[Label], free: impl Fn(usize) -> bool) -> Option<usize> {
    let has = |label: &Label, words: &[&str]| label.words.iter().any(|word| words.contains(&word.as_str()));
    let is = |label: &Label| {
        let pressure = label.unit.or(label.stated).is_some_and(|unit| unit.measure == Measure::Pressure);
        let wanted = matches!(label.role, Some(Role::Planned | Role::Command));
        pressure && !wanted && !has(label, &OTHER)
    };
    let own: Vec<usize> = (0..labels.len()).filter(|column| free(*column) && is(&labels[*column])).collect();
    let called = |words: &[&str]| -> Vec<usize> {
        own.iter().copied().filter(|column| has(&labels[*column], words)).collect()
    };
    let found = Some(called(&CALLED)).filter(|found| !found.is_empty()).unwrap_or_else(|| called(&OF_PUMP));
    if let [column] = found[..] { Some(column) } else { None }
}
