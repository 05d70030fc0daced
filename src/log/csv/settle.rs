//! Settles what only all headers together tell of each.

use std::collections::{BTreeMap, BTreeSet};

use super::{
    Quantity, Role,
    head::Head,
    keys::NAMES,
    label::Label,
    letter::Lettered,
    number::{Looks, looks},
    offered::{ORIENTATION, PLACE},
    unit::{METRE, Measure},
};
use crate::remark::{Code, Remarks};

/// Letters behind a quantity that are gains of a controller where all three come: `position_p`.
const GAINS: [&str; 3] = ["p", "i", "d"];

/// `A`, `B` and `C` beside `X`, `Y` and `Z` are the orientation of a tool, no joints, unless the caller names them.
pub(super) fn leave_out_orientation(labels: &mut [Label], named: &BTreeSet<usize>, remarks: &mut Remarks) {
    let is_angle = |at: &usize| {
        let prefix = ORIENTATION.iter().find_map(|letter| labels[*at].key.strip_suffix(letter));
        let Some(prefix) = prefix.filter(|prefix| prefix.is_empty() || prefix.ends_with(['_', '/'])) else {
            return false;
        };
        let has = |letter: &str| {
            let key = format!("{prefix}{letter}");
            labels.iter().any(|label| label.role == labels[*at].role && label.key == key)
        };
        labels[*at].is_joint && PLACE.iter().chain(&ORIENTATION).all(|letter| has(letter))
    };
    let angles: Vec<usize> = (0..labels.len()).filter(is_angle).collect();
    for at in &angles {
        labels[*at].is_joint = false;
    }
    let message = "columns A, B and C beside X, Y and Z are taken as the orientation of a tool and left out; if they are joints, \
                   name them with --planned JOINT=COLUMN,... and --measured JOINT=COLUMN,...";
    let left = angles.iter().filter(|at| !named.contains(at)).count();
    remarks.add(Code::Guessed, left as u64, message);
}

/// Positions of what the caller says to slide are of a joint, whatever its name: `X_set` and `X_act`.
pub(super) fn take_slides<T>(labels: &mut [Label], slides: &BTreeMap<String, T>) {
    let own: BTreeSet<String> = labels.iter().map(|label| label.joint.clone()).collect();
    // A name as it stands is that of its own case alone.
    let named = |name: &String, label: &Label| {
        if own.contains(name) { *name == label.joint } else { name.to_lowercase() == label.key }
    };
    let called = |label: &Label| slides.keys().any(|name| named(name, label));
    let long = |label: &Label| label.unit.is_none_or(|unit| unit.measure == Measure::Length);
    for label in labels.iter_mut().filter(|label| called(label) && label.role.is_some() && long(label)) {
        let position = label.quantity.is_none_or(|quantity| quantity == Quantity::Position);
        label.is_joint |= position && !label.is_time;
    }
}

/// A column that says of what a row is, as `joint` in a table of one joint, holds no positions where it holds words.
pub(super) fn leave_out_names(labels: &mut [Label], head: &Head) {
    for (column, label) in labels.iter_mut().enumerate() {
        let plain = head.names[column].trim_matches(['_', ' ']).to_lowercase();
        let cells = || head.sample.iter().filter_map(|row| row.get(column));
        let words = cells().next().is_some() && cells().all(|cell| looks(cell) == Looks::Text);
        label.is_joint &= !(words && NAMES.contains(&plain.as_str()));
    }
}

/// Settles what only all headers together tell: that `q_d_1` is the plan of `q_1`, and that `J1_planned_rad` and
/// `J1_actual_rad` are of one joint. Names that differ in case alone are of one where no two say the same of it.
pub(super) fn settle(labels: &mut [Label]) {
    leave_out_gains(labels);
    leave_out_quaternions(labels);
    states_beside_actions(labels);
    name_by_owners(labels);
    let says = |label: &Label| {
        let quantity = label.quantity.unwrap_or(Quantity::Position);
        (label.key.to_lowercase(), label.role.unwrap_or(Role::Measured), quantity)
    };
    let mut said = BTreeMap::<_, usize>::new();
    for label in labels.iter().filter(|label| label.is_joint) {
        *said.entry(says(label)).or_default() += 1;
    }
    let twice: BTreeSet<String> =
        said.into_iter().filter(|(_, count)| *count > 1).map(|((key, ..), _)| key).collect();
    for at in 0..labels.len() {
        let other = |key: &str| {
            labels.iter().enumerate().any(|(index, label)| index != at && label.is_joint && label.key == key)
        };
        let lower = labels[at].key.to_lowercase();
        let lettered = labels[at].lettered.clone().filter(|own| holds(own, labels, at));
        let one =
            labels[at].is_joint && (!twice.contains(&lower) || !other(&labels[at].key) && other(&lower));
        if let Some(Lettered { role, key, joint }) = lettered {
            (labels[at].key, labels[at].joint, labels[at].role) = (key, joint, Some(role));
            if labels[at].unit == Some(METRE) {
                (labels[at].unit, labels[at].stated) = (None, None);
            }
        } else if one {
            labels[at].key = lower;
        }
    }
}

/// `state[0]` beside `actions[0]` was measured, as data sets of `LeRobot` name it that say no `observation`.
fn states_beside_actions(labels: &mut [Label]) {
    let of = |label: &Label, names: &[&str]| match label.words.as_slice() {
        [name, number] if names.contains(&name.as_str()) => Some(format!("joint_{number}")),
        _ => None,
    };
    let sent: BTreeSet<String> =
        labels.iter().filter_map(|label| of(label, &["action", "actions"])).collect();
    for label in labels {
        if let Some(joint) = of(label, &["state", "states"]).filter(|joint| sent.contains(joint)) {
            (label.key, label.joint) = (joint.clone(), joint);
            (label.role, label.is_joint) = (Some(Role::Measured), true);
        }
    }
}

/// Where several columns say the same of a joint without a name, each is of the joint whose controller has its topic.
fn name_by_owners(labels: &mut [Label]) {
    let nameless = |label: &&Label| label.is_joint && !label.owner.is_empty();
    let mut owners: BTreeMap<_, BTreeSet<String>> = BTreeMap::new();
    for label in labels.iter().filter(nameless) {
        owners.entry((label.role, label.quantity)).or_default().insert(label.owner.clone());
    }
    if owners.values().any(|owners| owners.len() > 1) {
        for label in labels.iter_mut().filter(|label| label.is_joint && !label.owner.is_empty()) {
            label.key = label.owner.to_lowercase();
            label.joint.clone_from(&label.owner);
        }
    }
}

/// `position_p`, `position_i` and `position_d` are no joints.
fn leave_out_gains(labels: &mut [Label]) {
    let is = |label: &Label, name: &str| label.role.is_none() && label.key == name;
    if GAINS.iter().all(|name| labels.iter().any(|label| is(label, name))) {
        for label in labels.iter_mut().filter(|label| GAINS.iter().any(|name| is(label, name))) {
            (label.is_joint, label.lettered) = (false, None);
        }
    }
}

/// `q_des_w` beside `q_des_x`, `q_des_y` and `q_des_z` is of the orientation of a tool.
fn leave_out_quaternions(labels: &mut [Label]) {
    let ends = |label: &Label, before: &[String], letter: &str| {
        label.words.split_last().is_some_and(|(last, rest)| last == letter && rest == before)
    };
    let is = |label: &Label| match label.words.split_last() {
        Some((last, before)) if last == "w" => {
            PLACE.iter().all(|letter| labels.iter().any(|other| ends(other, before, letter)))
        }
        _ => false,
    };
    let found: Vec<usize> = (0..labels.len()).filter(|at| is(&labels[*at])).collect();
    for at in found {
        (labels[at].is_joint, labels[at].lettered) = (false, None);
    }
}

/// Whether another column is the same joint's of the other side: one without a letter beside a plan, or one with.
fn holds(own: &Lettered, labels: &[Label], at: usize) -> bool {
    let mut others = labels.iter().enumerate().filter(|(index, _)| *index != at).map(|(_, label)| label);
    others.any(|other| match &other.lettered {
        Some(lettered) => lettered.key == own.key && lettered.role != own.role,
        None => own.role == Role::Planned && other.is_joint && other.key == own.key,
    })
}
#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::csv::label::label;

    fn labels<const N: usize>(headers: [&str; N]) -> [Label; N] {
        let mut labels = headers.map(|header| label(header, None));
        settle(&mut labels);
        labels
    }

    #[test]
    fn a_letter_behind_a_joint_is_no_metre_where_it_says_a_side() {
        let units = |headers: [&str; 2]| labels(headers).map(|label| label.unit.map(|unit| unit.name));
        assert_eq!(units(["q1_d", "q1_m"]), [None, None]);
        assert_eq!(units(["q1_rad", "q3_m"]), [Some("rad"), Some("m")]);
    }

    #[test]
    fn a_state_is_measured_beside_actions_alone() {
        let (sent, real) = (Some(Role::Command), Some(Role::Measured));
        let said = |headers: [&str; 2]| labels(headers).map(|label| (label.role, label.key));
        let both = [(sent, "joint_0".into()), (real, "joint_0".into())];
        assert_eq!(said(["actions[0]", "state[0]"]), both);
        assert_eq!(said(["q_set[0]", "state[0]"])[1], (None, "state_0".into()));
    }

    #[test]
    fn a_named_orientation_is_not_left_out() {
        let labels = ["X", "Y", "Z", "A", "B", "C"].map(|axis| label(&format!("{axis}_RIst"), None));
        let left = |named: &[usize]| {
            let mut remarks = Remarks::default();
            leave_out_orientation(&mut labels.clone(), &named.iter().copied().collect(), &mut remarks);
            remarks.as_slice().iter().map(|remark| remark.count).sum::<u64>()
        };
        assert_eq!((left(&[]), left(&[3]), left(&[3, 4, 5])), (3, 2, 0));
    }

    #[test]
    fn gains_of_a_controller_are_no_joints() {
        let gains =
            ["set_point", "process_value", "process_value_dot", "position_p", "position_i", "position_d"];
        let found = labels(gains).map(|label| (label.is_joint, label.role, label.quantity));
        let (plan, real) = (Some(Role::Planned), Some(Role::Measured));
        assert_eq!(
            found[..3],
            [(true, plan, None), (true, real, None), (true, real, Some(Quantity::Velocity))]
        );
        assert!(found[3..].iter().all(|(is_joint, ..)| !is_joint), "{found:?}");
        assert_eq!(labels(["set_point", "process_value"]).map(|label| label.key), ["joint", "joint"]);
    }

    #[test]
    fn w_beside_x_y_and_z_is_of_an_orientation() {
        let joints = |headers: [&str; 4]| labels(headers).map(|label| label.is_joint);
        assert!(!joints(["q_des_w", "q_des_x", "q_des_y", "q_des_z"])[0]);
        assert!(joints(["q_des_w", "q_act_x", "q_act_y", "q_act_z"])[0]);
    }

    #[test]
    fn headers_together_tell_what_one_does_not() {
        fn settled<const N: usize>(headers: [&str; N]) -> [(Option<Role>, String); N] {
            let mut labels = headers.map(|header| label(header, None));
            settle(&mut labels);
            labels.map(|label| (label.role, label.key))
        }
        let (plan, real) = (Some(Role::Planned), Some(Role::Measured));
        assert_eq!(settled(["q_d_1", "q_1"]), [(plan, "joint_1".into()), (None, "joint_1".into())]);
        assert_eq!(settled(["q_d_1", "q_2"]), [(None, "d_1".into()), (None, "joint_2".into())]);
        assert_eq!(settled(["J1_planned_rad", "J1_actual_rad"]), [(plan, "j1".into()), (real, "j1".into())]);
        assert_eq!(settled(["q1_d", "q1"]), [(plan, "joint_1".into()), (None, "joint_1".into())]);
        assert_eq!(settled(["q1_d", "q1_m"]), [(plan, "joint_1".into()), (real, "joint_1".into())]);
        assert_eq!(settled(["theta_r", "theta_a"]), [(plan, "joint".into()), (real, "joint".into())]);
        let own = ["q_planned_rad", "Q_measured_rad"];
        assert_eq!(settled(own), [(plan, "q".into()), (real, "q".into())]);
        let sent = settled(["J1_planned_rad", "J1_actual_rad", "J1_command_rad"]);
        assert!(sent.iter().all(|(_, key)| key == "j1"), "{sent:?}");
        let sent = settled(["J1_target_rad", "J1_measured_rad", "J1_command_rad"]);
        assert!(sent.iter().all(|(_, key)| key == "j1"), "{sent:?}");
        let two = settled(["q_planned_rad", "Q_planned_rad", "q_measured_rad", "Q_measured_rad"]);
        assert_eq!(two.map(|(_, key)| key), ["q", "Q", "q", "Q"]);
    }
}
