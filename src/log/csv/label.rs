//! Reads role, quantity, joint and unit from the header of a column.

use std::collections::{BTreeMap, BTreeSet};

use super::{
    Quantity, Role,
    unit::{Measure, UNITLESS, Unit, parse_unit, split_suffix},
    word::{Meaning, Word, words},
};

/// Role, quantity, joint and unit of a column by its header.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Label {
    pub(super) role: Option<Role>,
    pub(super) quantity: Option<Quantity>,
    pub(super) unit: Option<Unit>,
    /// The unit that it ends with, even where that is read as a word.
    pub(super) stated: Option<Unit>,
    /// Its words in lower case.
    pub(super) words: Vec<String>,
    /// The joint as other columns of it would also write it: lower case.
    pub(super) key: String,
    /// The joint as it is written here.
    pub(super) joint: String,
    pub(super) is_time: bool,
    pub(super) is_joint: bool,
    /// Only a role or a length says that this may be a joint: it needs a partner.
    pub(super) is_weak: bool,
    /// Key and name of the joint if the `d` of `q_d_1` means desired.
    pub(super) desired: Option<(String, String)>,
}

/// Endings that `export` writes; the joint's name before them is taken as it is.
const OWN: [(&str, Role); 3] =
    [("_planned", Role::Planned), ("_measured", Role::Measured), ("_command", Role::Command)];

/// Components of the position of a tool.
const PLACE: [&str; 3] = ["x", "y", "z"];
/// Components of its orientation.
const QUATERNION: [&str; 4] = ["qx", "qy", "qz", "qw"];

/// Headers that are a time, whatever their words mean; the second as LabVIEW names it.
const TIMES: [&str; 2] = ["t", "X_Value"];

/// Reads a header; `below` is the cell of a row of units.
pub(super) fn label(header: &str, below: Option<&str>) -> Label {
    let header = header.trim();
    // `rostopic echo -p` puts it before the path of every field.
    let header = header.strip_prefix("field.").unwrap_or(header);
    let (name, stated) = without_unit(header);
    let mut unit = stated.or_else(|| below.and_then(parse_unit));
    if let Some((joint, role)) = own(name).filter(|_| unit.is_some()) {
        let speeds = [Measure::AngularSpeed, Measure::LinearSpeed];
        let speed = unit.is_some_and(|unit| speeds.contains(&unit.measure));
        let quantity = if speed { Quantity::Velocity } else { Quantity::Position };
        return Label {
            role: Some(role),
            quantity: Some(quantity),
            unit,
            stated: unit,
            words: vec![joint.to_lowercase()],
            key: joint.to_owned(),
            joint: joint.to_owned(),
            is_time: false,
            is_joint: true,
            is_weak: false,
            desired: None,
        };
    }
    let mut words = words(name);
    let bare = name.trim_matches(|c: char| !c.is_alphanumeric());
    let named = TIMES.iter().any(|time| bare.eq_ignore_ascii_case(time));
    let timely = |words: &[Word<'_>]| named || words.iter().any(|word| word.meaning == Meaning::Time);
    let is_time_unit = unit.is_some_and(|unit| unit.measure == Measure::Time);
    if is_time_unit && stated.is_some() && !header.ends_with([']', ')']) && !timely(&words) {
        // `Boom Ms` is measured, not in ms.
        (unit, words) = (below.and_then(parse_unit), self::words(header));
    }
    let timely = timely(&words);
    let means = |meaning: Meaning| words.iter().any(|word| word.meaning == meaning);
    // Of a path the last part says most: `fbAxis.SetPos`.
    let role = words.iter().rev().find_map(|word| match word.meaning {
        // What is a command as well was sent: `target_cmd`.
        Meaning::Role(Role::Planned) if means(Meaning::Role(Role::Command)) => Some(Role::Command),
        Meaning::Role(role) => Some(role),
        _ => None,
    });
    let quantity = words.iter().find_map(|word| match word.meaning {
        Meaning::Quantity(quantity) => Some(quantity),
        _ => None,
    });
    let measure = unit.map(|unit| unit.measure);
    let quantity = match measure {
        Some(Measure::Angle | Measure::Length) => Some(Quantity::Position),
        Some(Measure::AngularSpeed | Measure::LinearSpeed) => Some(Quantity::Velocity),
        _ => quantity,
    };
    let is_time =
        timely && matches!(measure, None | Some(Measure::Time)) && (named || !means(Meaning::Foreign));
    let long = matches!(measure, Some(Measure::Length | Measure::LinearSpeed));
    let fits = long || matches!(measure, None | Some(Measure::Angle | Measure::AngularSpeed));
    let strong = quantity.is_some() && !long || means(Meaning::Joint);
    let words = &words[topic(&words)..];
    let joint = joint_name(words);
    // Of a tool, not of a joint; such a position is told like that of a joint that slides.
    let place =
        role.is_some() && measure == Some(Measure::Length) && PLACE.contains(&joint.to_lowercase().as_str());
    let foreign = means(Meaning::Foreign) && !place;
    let is_joint = !timely && fits && !foreign && (strong || role.is_some() || long);
    let desired = role.is_none().then(|| without_d(words)).flatten();
    let desired = desired.map(|words| joint_name(&words)).map(|joint| (joint.to_lowercase(), joint));
    let key = joint.to_lowercase();
    // A quaternion has no unit; that it is meant shows where plan and measurement have it.
    let turns = unit.is_none() && QUATERNION.contains(&key.as_str());
    let unit = if turns { Some(UNITLESS) } else { unit };
    let strong = strong && !turns;
    let stated = stated.or(unit);
    let words = words.iter().map(|word| word.text.to_lowercase()).collect();
    Label { role, quantity, unit, stated, words, key, joint, is_time, is_joint, is_weak: !strong, desired }
}

/// How many words are those of a topic, which names no joint: `/joint_states/boom/position`.
fn topic(words: &[Word<'_>]) -> usize {
    let states =
        |word: &Word<'_>| ["state", "states"].iter().any(|state| word.text.eq_ignore_ascii_case(state));
    let at = words.windows(2).rposition(|two| states(&two[0]) && two[1].slashed);
    at.map_or(0, |at| at + 1)
}

/// The words without a `d` that follows a word for the position, if there is one.
fn without_d<'a>(words: &[Word<'a>]) -> Option<Vec<Word<'a>>> {
    let position = Meaning::Quantity(Quantity::Position);
    let at =
        words.windows(2).position(|w| w[0].meaning == position && w[1].text.eq_ignore_ascii_case("d"))?;
    let kept = words.iter().enumerate().filter(|(index, _)| *index != at + 1);
    Some(kept.map(|(_, word)| word.clone()).collect())
}

/// Settles what only all headers together tell: that `q_d_1` is the plan of `q_1`, and that `J1_planned_rad` and
/// `J1_actual_rad` are of one joint. Names that differ in case alone are of one where no two say the same of it.
pub(super) fn settle(labels: &mut [Label]) {
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
        let desired = labels[at].desired.clone().filter(|(key, _)| other(key));
        let one =
            labels[at].is_joint && (!twice.contains(&lower) || !other(&labels[at].key) && other(&lower));
        if let Some((key, joint)) = desired {
            (labels[at].key, labels[at].joint) = (key, joint);
            labels[at].role = Some(Role::Planned);
        } else if one {
            labels[at].key = lower;
        }
    }
}

fn own(name: &str) -> Option<(&str, Role)> {
    let found = OWN.iter().find_map(|(ending, role)| Some((name.strip_suffix(ending)?, *role)));
    found.filter(|(joint, _)| !joint.is_empty())
}

/// The header before its unit, and the unit.
fn without_unit(header: &str) -> (&str, Option<Unit>) {
    for (open, close) in [('[', ']'), ('(', ')'), ('（', '）')] {
        let Some(inner) = header.strip_suffix(close).and_then(|rest| rest.rsplit_once(open)) else {
            continue;
        };
        if let Some(unit) = parse_unit(inner.1) {
            return (inner.0.trim_end(), Some(unit));
        }
    }
    let known = |at: usize| {
        let rest = header.get(at + 1..)?;
        parse_unit(rest).filter(|unit| unit.measure != Measure::Other).map(|unit| (&header[..at], unit))
    };
    let separated =
        header.match_indices([' ', ',', '/']).filter(|(at, _)| *at > 0).find_map(|(at, _)| known(at));
    if let Some((name, unit)) = separated {
        let name = name.trim_end_matches([' ', ',', '/']);
        return (name.strip_suffix(" in").unwrap_or(name), Some(unit));
    }
    split_suffix(header).map_or((header, None), |(name, unit)| (name, Some(unit)))
}

/// What is left of the words once role and quantity are gone; `joint_3` where that is a number,
/// `joint` where nothing is left.
fn joint_name(words: &[Word<'_>]) -> String {
    let mut name = String::new();
    let mut gap = false;
    for (at, word) in words.iter().enumerate() {
        // The type of a variable of a controller: `fActPos`, `lrSetPosition`.
        let typed = ["f", "r", "lr"].contains(&word.text)
            && words.get(at + 1).is_some_and(|next| !next.apart && matches!(next.meaning, Meaning::Role(_)));
        if typed || matches!(word.meaning, Meaning::Role(_) | Meaning::Quantity(_) | Meaning::Time) {
            gap = true;
            continue;
        }
        if !name.is_empty() && (word.apart || gap) {
            // A name of ROS keeps its namespace.
            name.push(if word.slashed && !gap { '/' } else { '_' });
        }
        name.push_str(word.text);
        gap = false;
    }
    if name.is_empty() {
        return "joint".to_owned();
    }
    if name.chars().all(|c| c.is_ascii_digit()) { format!("joint_{name}") } else { name }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(header: &str) -> (Option<Role>, Option<Quantity>, String, Option<&'static str>) {
        let label = label(header, None);
        assert!(label.is_joint, "{header}");
        (label.role, label.quantity, label.joint, label.unit.map(|unit| unit.name))
    }

    #[test]
    fn plan_and_measurement_are_told_apart_in_many_spellings() {
        let (plan, real) = (Some(Role::Planned), Some(Role::Measured));
        let position = Some(Quantity::Position);
        assert_eq!(said("target_q_0"), (plan, position, "joint_0".into(), None));
        assert_eq!(said("actual_qd_5"), (real, Some(Quantity::Velocity), "joint_5".into(), None));
        assert_eq!(said("Achse1 Soll [°]"), (plan, position, "Achse1".into(), Some("deg")));
        assert_eq!(said("J1_ist (deg)"), (real, position, "J1".into(), Some("deg")));
        assert_eq!(
            said("MAIN.fbAxis[2].NcToPlc.SetPos"),
            (plan, position, "MAIN_Axis_2_NcToPlc".into(), None)
        );
        assert_eq!(said("/joint_states/arm/lift/position").2, "arm/lift");
        assert_eq!(said("/planned_joint_states/lift/position"), (plan, position, "lift".into(), None));
        assert_eq!(
            said("/arm/controller_state/reference/positions[2]"),
            (plan, position, "joint_2".into(), None)
        );
        assert_eq!(said("/joint_states/position[2]").2, "joint_2");
        assert_eq!(said("GVL.fActPos[3]"), (real, position, "GVL_3".into(), None));
        assert_eq!(
            said("shoulder_pan_joint cmd"),
            (Some(Role::Command), None, "shoulder_pan_joint".into(), None)
        );
        assert_eq!(said("target_cmd_q_1").0, Some(Role::Command));
        assert_eq!(said("commandedPos2").0, Some(Role::Command));
        assert_eq!(said("q_ref_2_rad"), (plan, position, "joint_2".into(), Some("rad")));
        assert_eq!(said("J1 Geschwindigkeit Ist in °/s").1, Some(Quantity::Velocity));
        for header in
            ["arm/lift_actual_deg", "arm/lift_measured_deg", "ist arm/lift [deg]", "arm/lift/actual_deg"]
        {
            assert_eq!(said(header).2, "arm/lift", "{header}");
        }
    }

    #[test]
    fn what_is_no_joint_angle_is_not_taken_for_one() {
        for header in [
            "actual_current_0",
            "target_moment_1",
            "actual_TCP_pose_0",
            "target_qdd_0",
            "temperature",
            "pressure_set [bar]",
            "J1_error_rad",
            "counter",
        ] {
            assert!(!label(header, None).is_joint, "{header}");
        }
    }

    #[test]
    fn a_length_is_that_of_a_joint_that_has_a_partner() {
        for (header, unit) in [("boom_set_mm", "mm"), ("boom set [cm]", "cm"), ("boom_set_m", "m")] {
            let label = label(header, None);
            let said = (label.joint.as_str(), label.role, label.unit.map(|unit| unit.name));
            assert_eq!(said, ("boom", Some(Role::Planned), Some(unit)), "{header}");
            assert!(label.is_joint && label.is_weak, "{header}");
        }
        assert!(!label("tool x [mm]", None).is_joint);
    }

    #[test]
    fn a_unit_of_time_behind_a_joint_is_a_word() {
        let label = label("Boom Ms", None);
        assert_eq!((label.joint.as_str(), label.role, label.unit), ("Boom", Some(Role::Measured), None));
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
        let own = ["q_planned_rad", "Q_measured_rad"];
        assert_eq!(settled(own), [(plan, "q".into()), (real, "q".into())]);
        let sent = settled(["J1_planned_rad", "J1_actual_rad", "J1_command_rad"]);
        assert!(sent.iter().all(|(_, key)| key == "j1"), "{sent:?}");
        let sent = settled(["J1_target_rad", "J1_measured_rad", "J1_command_rad"]);
        assert!(sent.iter().all(|(_, key)| key == "j1"), "{sent:?}");
        let two = settled(["q_planned_rad", "Q_planned_rad", "q_measured_rad", "Q_measured_rad"]);
        assert_eq!(two.map(|(_, key)| key), ["q", "Q", "q", "Q"]);
    }

    #[test]
    fn times_are_known_by_name() {
        for header in
            ["t", "time", "Zeit [ms]", "timestamp", "stamp_ns", "time_s", "Datum", "t[s]", "Time (us)"]
        {
            assert!(label(header, None).is_time, "{header}");
        }
        assert_eq!(label("Zeit [ms]", None).unit.map(|unit| unit.factor), Some(1e6));
    }

    #[test]
    fn the_name_of_a_joint_in_an_export_is_taken_as_it_is() {
        let label = label("q_ref 1,a_planned_rad", None);
        assert_eq!((label.joint.as_str(), label.role), ("q_ref 1,a", Some(Role::Planned)));
    }
}
