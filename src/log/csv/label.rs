//! Reads role, quantity, joint and unit from the header of a column.

use super::{
    Quantity, Role,
    unit::{Measure, Unit, parse_unit, split_suffix},
    word::{Meaning, Word, words},
};

/// Role, quantity, joint and unit of a column by its header.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Label {
    pub(super) role: Option<Role>,
    pub(super) quantity: Option<Quantity>,
    pub(super) unit: Option<Unit>,
    /// The joint as other columns of it would also write it: lower case.
    pub(super) key: String,
    /// The joint as it is written here.
    pub(super) joint: String,
    pub(super) is_time: bool,
    pub(super) is_joint: bool,
    /// Only a role says that this may be a joint: it needs a partner.
    pub(super) is_weak: bool,
}

/// Endings that `export` writes; the joint's name before them is taken as it is.
const OWN: [(&str, Role); 3] =
    [("_planned", Role::Planned), ("_measured", Role::Measured), ("_command", Role::Command)];

/// Reads a header; `below` is the cell of a row of units.
pub(super) fn label(header: &str, below: Option<&str>) -> Label {
    let (name, stated) = without_unit(header.trim());
    let unit = stated.or_else(|| below.and_then(parse_unit));
    if let Some((joint, role)) = own(name).filter(|_| unit.is_some()) {
        let speed = unit.is_some_and(|unit| unit.measure == Measure::AngularSpeed);
        let quantity = if speed { Quantity::Velocity } else { Quantity::Position };
        return Label {
            role: Some(role),
            quantity: Some(quantity),
            unit,
            key: joint.to_owned(),
            joint: joint.to_owned(),
            is_time: false,
            is_joint: true,
            is_weak: false,
        };
    }
    let words = words(name);
    let means = |meaning: Meaning| words.iter().any(|word| word.meaning == meaning);
    let role = words.iter().find_map(|word| match word.meaning {
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
        Some(Measure::Angle) => Some(Quantity::Position),
        Some(Measure::AngularSpeed) => Some(Quantity::Velocity),
        _ => quantity,
    };
    let lone_t = matches!(words.as_slice(), [word] if word.text.eq_ignore_ascii_case("t"));
    let timely = means(Meaning::Time) || lone_t;
    let is_time = timely && matches!(measure, None | Some(Measure::Time)) && !means(Meaning::Foreign);
    let angular = matches!(measure, None | Some(Measure::Angle | Measure::AngularSpeed));
    let strong = quantity.is_some() || means(Meaning::Joint);
    let is_joint = !timely && angular && !means(Meaning::Foreign) && (strong || role.is_some());
    let joint = joint_name(&words);
    Label { role, quantity, unit, key: joint.to_lowercase(), joint, is_time, is_joint, is_weak: !strong }
}

fn own(name: &str) -> Option<(&str, Role)> {
    let found = OWN.iter().find_map(|(ending, role)| Some((name.strip_suffix(ending)?, *role)));
    found.filter(|(joint, _)| !joint.is_empty())
}

/// The header before its unit, and the unit.
fn without_unit(header: &str) -> (&str, Option<Unit>) {
    for (open, close) in [('[', ']'), ('(', ')')] {
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
    for word in words {
        if matches!(word.meaning, Meaning::Role(_) | Meaning::Quantity(_) | Meaning::Time) {
            gap = true;
            continue;
        }
        if !name.is_empty() && (word.apart || gap) {
            name.push('_');
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
        assert_eq!(said("GVL.fActPos[3]"), (real, position, "GVL_f_3".into(), None));
        assert_eq!(
            said("shoulder_pan_joint cmd"),
            (Some(Role::Command), None, "shoulder_pan_joint".into(), None)
        );
        assert_eq!(said("target_cmd_q_1").0, Some(Role::Command));
        assert_eq!(said("commandedPos2").0, Some(Role::Command));
        assert_eq!(said("q_ref_2_rad"), (plan, position, "joint_2".into(), Some("rad")));
        assert_eq!(said("J1 Geschwindigkeit Ist in °/s").1, Some(Quantity::Velocity));
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
            "cylinder pos [mm]",
            "counter",
        ] {
            assert!(!label(header, None).is_joint, "{header}");
        }
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
