//! Reads role, quantity, joint and unit from the header of a column.

use std::borrow::Cow;

use crate::arm::names_a_slide;

use super::{
    Quantity, Role,
    letter::{Lettered, lettered},
    name::{NAMELESS, joint_name},
    object_number::without_object_number,
    own::own,
    scale::{in_header, is_unclear, unit_alone, unit_named},
    typed::without_type,
    unit::{ANOTHER, METRE, Measure, UNITLESS, Unit, split_suffix},
    within::take_unit,
    word::{Meaning, Word, role, words},
};

/// Role, quantity, joint and unit of a column by its header.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Label {
    pub(super) role: Option<Role>,
    pub(super) quantity: Option<Quantity>,
    pub(super) unit: Option<Unit>,
    /// The unit that it ends with, even where that is read as a word.
    pub(super) stated: Option<Unit>,
    /// What it has in square brackets at its end where that is no known unit and no other known word: `U` of `boom [U]`.
    pub(super) unknown: Option<String>,
    /// Its words in lower case.
    pub(super) words: Vec<String>,
    /// The joint as other columns of it would also write it: lower case.
    pub(super) key: String,
    /// The joint as it is written here.
    pub(super) joint: String,
    /// The joint by the words of a header in the form of an export, which is taken as it is.
    pub(super) by_words: Option<String>,
    pub(super) is_time: bool,
    pub(super) is_joint: bool,
    /// Only a role or a length says that this may be a joint: it needs a partner.
    pub(super) is_weak: bool,
    /// The joint whose controller has its topic, where it names none itself; else empty.
    pub(super) owner: String,
    /// What it is if a letter says so.
    pub(super) lettered: Option<Lettered>,
}

/// Components of the position of a tool.
pub(super) const PLACE: [&str; 3] = ["x", "y", "z"];
/// Components of its orientation.
pub(super) const QUATERNION: [&str; 4] = ["qx", "qy", "qz", "qw"];

/// Headers that are a time, whatever their words mean; the second as `LabVIEW` names it.
const TIMES: &str = "t X_Value ts s sec secs seconds ms millis milliseconds micros duration datenum";

/// Reads a header; `below` is the cell of a row of units.
pub(super) fn label(header: &str, below: Option<&str>) -> Label {
    let header = &*without_object_number(header.trim());
    // `rostopic echo -p` puts it before the path of every field.
    let header = without_type(header.strip_prefix("field.").unwrap_or(header));
    let indexed = unit_before_index(header);
    let header = indexed.as_deref().unwrap_or(header);
    let (name, stated) = parted(header);
    let name = &*name;
    let mut unit = stated.or_else(|| below.and_then(unit_alone));
    if let Some(label) = unit.and_then(|unit| of_export(name, unit)) {
        return label;
    }
    let mut words = words(name);
    let bare = name.trim_matches(|c: char| !c.is_alphanumeric());
    let named = TIMES.split(' ').any(|time| bare.eq_ignore_ascii_case(time));
    if named {
        unit = unit.or_else(|| unit_named(bare));
    }
    let is_time_unit = unit.is_some_and(|unit| unit.measure == Measure::Time);
    // Of `t_set_s` the letter is the time, too.
    let t = |words: &[Word<'_>]| {
        is_time_unit && words.first().is_some_and(|word| word.text.eq_ignore_ascii_case("t"))
    };
    let timely =
        |words: &[Word<'_>]| named || t(words) || words.iter().any(|word| word.meaning == Meaning::Time);
    if is_time_unit && stated.is_some() && !header.ends_with([']', ')']) && !timely(&words) {
        // `Boom Ms` is measured, not in ms.
        (unit, words) = (below.and_then(unit_alone), self::words(header));
    }
    let timely = timely(&words);
    // `Zeit_hh_mm_ss` is in no millimetres.
    if unit.is_none() && !timely {
        unit = take_unit(&mut words);
    }
    let measure = unit.map(|unit| unit.measure);
    current_is_measured(&mut words, matches!(measure, Some(Measure::Angle | Measure::Length)));
    let means = |meaning: Meaning| words.iter().any(|word| word.meaning == meaning);
    let role = role(&words);
    // `theta_dot` is a speed.
    let dots = words.iter().filter(|word| word.text.eq_ignore_ascii_case("dot")).count();
    // So is what names an angle and a speed: `elbow_angle_vel`.
    let quantity = words.iter().fold(None, |before, word| match word.meaning {
        Meaning::Quantity(_) if dots > 0 => Some(Quantity::Velocity),
        Meaning::Quantity(Quantity::Velocity) => Some(Quantity::Velocity),
        Meaning::Quantity(quantity) => before.or(Some(quantity)),
        _ => before,
    });
    let quantity = match measure {
        Some(Measure::Angle | Measure::Length) => Some(Quantity::Position),
        Some(Measure::AngularSpeed | Measure::LinearSpeed) => Some(Quantity::Velocity),
        _ => quantity,
    };
    // Of `boom set [deg] Time` the unit is that of the signal.
    let ends = |text: &str| header.trim_end().ends_with(text);
    let of_signal = words.last().is_some_and(|word| word.meaning == Meaning::Time && ends(word.text));
    let timed = of_signal || matches!(measure, None | Some(Measure::Time));
    let is_time = timely && timed && (named || !means(Meaning::Foreign));
    let unit = unit.filter(|unit| !is_time || unit.measure == Measure::Time);
    let long = matches!(measure, Some(Measure::Length | Measure::LinearSpeed));
    let fits = long || matches!(measure, None | Some(Measure::Angle | Measure::AngularSpeed));
    let (of_topic, words) = words.split_at(topic(&words));
    let joint = joint_name(words);
    let slides = long && !is_place(&joint) && names_a_slide(&joint);
    let strong = quantity.is_some() && !long || means(Meaning::Joint) || slides;
    let owner = if joint == NAMELESS { owner(of_topic) } else { String::new() };
    let place = role.is_some()
        && names_place(words)
        && (measure == Some(Measure::Length) || !is_place(&joint) && (long || means(Meaning::Joint)));
    // `q_dot_dot` is an acceleration.
    // Of an angle that is set or measured they are a name: `L-force Achse 1`, `Power arm`.
    let called = role.is_some() && measure == Some(Measure::Angle) && only_foreign(words, &FORCES);
    let foreign = (means(Meaning::Foreign) || dots > 1) && !place && !called;
    let is_joint = !timely && fits && !foreign && (strong || role.is_some() || long);
    // Of `q1_m` beside `q1_d` the letter is no metre.
    let whole = self::words(header);
    let letters = if stated == Some(METRE) { whole.get(topic(&whole)..).unwrap_or_default() } else { words };
    let lettered = role.is_none().then(|| lettered(letters)).flatten();
    let key = joint.to_lowercase();
    // A quaternion has no unit.
    let turns = unit.is_none() && QUATERNION.contains(&key.as_str());
    let unit = if turns { Some(UNITLESS) } else { unit };
    let stated = stated.or(unit);
    let unknown = if unit.is_none() { unknown_unit(header) } else { None };
    let words = words.iter().map(|word| word.text.to_lowercase()).collect();
    Label {
        role,
        quantity,
        unit,
        stated,
        unknown,
        words,
        key,
        joint,
        by_words: None,
        is_time,
        is_joint,
        is_weak: !strong || turns,
        owner,
        lettered,
    }
}

/// What a header with a unit says in the form of an export.
fn of_export(name: &str, unit: Unit) -> Option<Label> {
    let (joint, role, by_words) = own(name)?;
    let speed = [Measure::AngularSpeed, Measure::LinearSpeed].contains(&unit.measure);
    Some(Label {
        role: Some(role),
        quantity: Some(if speed { Quantity::Velocity } else { Quantity::Position }),
        unit: Some(unit),
        stated: Some(unit),
        words: vec![joint.to_lowercase()],
        key: joint.to_owned(),
        joint: joint.to_owned(),
        by_words: Some(by_words),
        is_joint: true,
        ..Label::default()
    })
}

pub(super) fn is_place(text: &str) -> bool {
    PLACE.iter().any(|place| text.eq_ignore_ascii_case(place))
}

/// Whether letters of space are all that is foreign to a joint. Alone they are of a tool, whose position is told like that of a joint
/// that slides; `Portal X` and `Achse X` are joints.
fn names_place(words: &[Word<'_>]) -> bool {
    only_foreign(words, &PLACE)
}

/// Words of forces, of which none is an angle.
const FORCES: [&str; 6] = ["force", "kraft", "power", "leistung", "torque", "drehmoment"];

fn only_foreign(words: &[Word<'_>], known: &[&str]) -> bool {
    let is_known = |word: &Word<'_>| known.iter().any(|one| word.text.eq_ignore_ascii_case(one));
    words.iter().all(|word| word.meaning != Meaning::Foreign || is_known(word))
}

/// `current_position` is measured now, and so is a current in degrees: it is no electric one.
fn current_is_measured(words: &mut [Word<'_>], is_position: bool) {
    for at in 0..words.len() {
        let of = words.get(at + 1).map(|next| next.meaning);
        let position = is_position || of == Some(Meaning::Quantity(Quantity::Position));
        if position && words[at].text.eq_ignore_ascii_case("current") {
            words[at].meaning = Meaning::Role(Role::Measured);
        }
    }
}

/// `q_deg[0]` as `q[0] [deg]`.
fn unit_before_index(header: &str) -> Option<String> {
    let (base, index) = header.strip_suffix(']')?.rsplit_once('[')?;
    let (name, unit) = split_suffix(base)?;
    let of_joint = [Measure::Angle, Measure::AngularSpeed, Measure::Length, Measure::LinearSpeed]
        .contains(&unit.measure);
    let counts = !index.is_empty() && index.bytes().all(|byte| byte.is_ascii_digit());
    (of_joint && counts).then(|| format!("{name}[{index}] [{}]", unit.name))
}

/// What has states of all joints.
const OF_ALL: [&str; 9] =
    ["joint", "joints", "controller", "robot", "motor", "motors", "axis", "axes", "actuator"];

/// How many words are those of a topic, which names no joint: `/joint_states/boom/position`.
fn topic(words: &[Word<'_>]) -> usize {
    let states =
        |word: &Word<'_>| ["state", "states"].iter().any(|state| word.text.eq_ignore_ascii_case(state));
    // What is the state of one joint names that joint: `/axes/boom/state/values/actual`.
    let of_all = |at: usize| at == 0 || OF_ALL.iter().any(|one| words[at - 1].text.eq_ignore_ascii_case(one));
    let at = (0..words.len().saturating_sub(1))
        .rev()
        .find(|&at| states(&words[at]) && words[at + 1].slashed && of_all(at));
    at.map_or(0, |at| at + 1)
}

/// The joint whose controller has a topic: `/boom_controller/state/set_point`.
fn owner(topic: &[Word<'_>]) -> String {
    let says = |word: &Word<'_>| {
        let known = OF_ALL.iter().chain(&["state", "states"]);
        known.into_iter().all(|of_all| !word.text.eq_ignore_ascii_case(of_all))
    };
    joint_name(&topic[..topic.iter().rposition(says).map_or(0, |at| at + 1)])
}

/// What stands in square brackets at the end of a header, if it may be a unit.
fn unknown_unit(header: &str) -> Option<String> {
    let (before, inner) = header.strip_suffix(']')?.rsplit_once('[')?;
    let names = words(inner).iter().all(|word| word.meaning == Meaning::Name);
    (!before.is_empty() && names && inner.contains(char::is_alphabetic)).then(|| inner.trim().to_owned())
}

/// The header without its unit, and the unit.
fn parted(header: &str) -> (Cow<'_, str>, Option<Unit>) {
    if let Some((name, unit)) = in_header(header) {
        return (Cow::Owned(name), Some(unit));
    }
    let (name, unit) = without_unit(header);
    (Cow::Borrowed(name), unit)
}

/// The header before its unit, and the unit.
fn without_unit(header: &str) -> (&str, Option<Unit>) {
    if let Some(name) = header.strip_suffix('%').filter(|name| !name.is_empty()) {
        return (name.trim_end_matches(['_', ' ']), unit_alone("%"));
    }
    for (open, close) in [('[', ']'), ('(', ')'), ('（', '）')] {
        let Some(inner) = header.strip_suffix(close).and_then(|rest| rest.rsplit_once(open)) else {
            continue;
        };
        if let Some(unit) = unit_alone(inner.1) {
            return (inner.0.trim_end(), Some(unit));
        }
        if is_unclear(inner.1) {
            return (inner.0.trim_end(), Some(ANOTHER));
        }
    }
    let known = |at: usize| {
        let rest = header.get(at + 1..)?;
        unit_named(rest).filter(|unit| unit.measure != Measure::Other).map(|unit| (&header[..at], unit))
    };
    let separated =
        header.match_indices([' ', ',', '/']).filter(|(at, _)| *at > 0).find_map(|(at, _)| known(at));
    if let Some((name, unit)) = separated {
        let name = name.trim_end_matches([' ', ',', '/']);
        return (name.strip_suffix(" in").unwrap_or(name), Some(unit));
    }
    split_suffix(header).map_or((header, None), |(name, unit)| (name, Some(unit)))
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
        let owned = |header: &str| (said(header).2, label(header, None).owner);
        assert_eq!(owned("/arm/boom_controller/state/set_point"), ("joint".into(), "arm/boom".into()));
        assert_eq!(owned("/joint_controller/state/set_point"), ("joint".into(), "joint".into()));
        assert_eq!(said("joint_target_deg[0]"), (plan, position, "joint_0".into(), Some("deg")));
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
            "actual_current_0", "target_moment_1", "actual_TCP_pose_0", "target_qdd_0", "temperature",
            "pressure_set [bar]", "J1_error_rad", "counter",
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
        for not in
            ["tool x [mm]", "TCP X Soll [mm]", "x_soll [mm/s]", "Kraft X Ist", "Beschleunigung X ist [mm/s]"]
        {
            assert!(!label(not, None).is_joint, "{not}");
        }
        for (header, joint) in [
            ("Fahrwerk X Soll [mm]", "Fahrwerk_X"),
            ("Achse X ist", "Achse_X"),
            ("X-Achse Ist [mm/s]", "X_Achse"),
        ] {
            assert_eq!(said(header).2, joint);
        }
    }

    #[test]
    fn a_unit_of_time_behind_a_joint_is_a_word() {
        let label = label("Boom Ms", None);
        assert_eq!((label.joint.as_str(), label.role, label.unit), ("Boom", Some(Role::Measured), None));
    }

    #[test]
    fn a_unit_that_is_not_known_is_kept_as_such() {
        let unknown = |header: &str| label(header, None).unknown;
        assert_eq!(unknown("boom_set [E]").as_deref(), Some("E"));
        for header in ["boom_set [deg]", "q[0]", "boom [ist]", "boom_set", "[E]"] {
            assert_eq!(unknown(header), None, "{header}");
        }
    }

    #[test]
    fn times_are_known_by_name() {
        for header in [
            "t", "time", "Zeit [ms]", "timestamp", "stamp_ns", "time_s", "Datum", "t[s]", "Time (us)",
            "t_set_s",
        ] {
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
