//! Headers in the form that `export` writes: the joint's name before their ending is taken as it is.

use super::{
    Quantity, Role,
    label::Label,
    name::joint_name,
    unit::{Measure, Unit},
    word::words,
};

const ENDINGS: [(&str, Role); 3] =
    [("_planned", Role::Planned), ("_measured", Role::Measured), ("_command", Role::Command)];

/// What a header in this form says; it has a unit.
pub(super) fn own(name: &str, unit: Unit) -> Option<Label> {
    let found = ENDINGS.iter().find_map(|(ending, role)| Some((name.strip_suffix(ending)?, *role)));
    let (joint, role) = found.filter(|(joint, _)| !joint.is_empty())?;
    let speed = [Measure::AngularSpeed, Measure::LinearSpeed].contains(&unit.measure);
    let quantity = if speed { Quantity::Velocity } else { Quantity::Position };
    Some(Label {
        role: Some(role),
        quantity: Some(quantity),
        unit: Some(unit),
        stated: Some(unit),
        words: vec![joint.to_lowercase()],
        key: joint.to_owned(),
        joint: joint.to_owned(),
        by_words: Some(joint_name(&words(name))),
        is_joint: true,
        ..Label::default()
    })
}

/// Of a joint with columns in this form and in another one the name is that of the other: `q1_planned_deg` beside
/// `q1_actual_deg`.
pub(super) fn agree(labels: &mut [Label]) {
    for at in 0..labels.len() {
        let Some(joint) = labels[at].by_words.clone() else { continue };
        let key = joint.to_lowercase();
        if labels.iter().any(|other| other.is_joint && other.by_words.is_none() && other.key == key) {
            (labels[at].key, labels[at].joint) = (key, joint);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::log::csv::label::label;

    fn joints(headers: &[&str]) -> Vec<String> {
        let mut labels: Vec<_> = headers.iter().map(|header| label(header, None)).collect();
        super::agree(&mut labels);
        labels.into_iter().map(|label| label.joint).collect()
    }

    #[test]
    fn a_joint_has_one_name_in_both_forms() {
        for pair in [
            ["q1_planned_deg", "q1_actual_deg"],
            ["Boom 1_planned_deg", "Boom 1 Ist [deg]"],
            ["J2_command_deg", "J2_actual_deg"],
            ["q1_set_deg", "q1_measured_deg"],
        ] {
            let names = joints(&pair);
            assert_eq!(names[0], names[1], "{pair:?}");
        }
        assert_eq!(joints(&["q1_planned_deg", "q1_measured_deg", "q2_actual_deg"]), ["q1", "q1", "joint_2"]);
    }
}
