//! One name for a joint whose columns are named in several forms.

use super::label::Label;

/// Of a joint with columns in the form of an export and in another one the name is that of the other: `q1_planned_deg` beside
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
    use super::super::label::label;

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
