//! Numbers of columns become SI, by the unit that each column states or is given.

use std::{collections::BTreeSet, f64::consts::TAU};

use super::{
    AngleUnit, CsvError, CsvOptions, Quantity,
    head::Head,
    label::Label,
    layout::{Layout, Use},
    read::Cells,
    unit::{DEGREE, FARTHEST_DEG, FARTHEST_RAD, Measure, RADIAN, UNITLESS, Unit, parse_unit},
};
use crate::{
    log::write::VALVE,
    remark::{Code, Remarks},
    series::JointKind,
    suggest::nearest,
    text::shell_word,
};

/// The unit of a column and who says so.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Settled {
    pub(super) column: usize,
    pub(super) unit: Option<Unit>,
    pub(super) from: &'static str,
}

/// Converts the columns in use; also how each joint moves, `[joints]`.
pub(super) fn to_si(
    head: &Head,
    labels: &[Label],
    layout: &Layout,
    options: &CsvOptions,
    cells: &mut Cells,
    remarks: &mut Remarks,
) -> Result<(Vec<Settled>, Vec<JointKind>), CsvError> {
    let stated = |column: usize| labels.get(column).and_then(|label| label.unit);
    let lengths = lengths(layout, options, &stated)?;
    let turns = |one: &&Use| {
        let is_angle = lengths[one.joint].is_none() && stated(one.column) != Some(UNITLESS);
        one.quantity == Quantity::Position && is_angle
    };
    let fallback = fallback(head, options, layout.uses.iter().filter(turns).map(|one| stated(one.column)));
    let mut settled = Vec::new();
    let mut guessed: Vec<usize> = Vec::new();
    for one in &layout.uses {
        let (unit, from) = match lengths[one.joint] {
            Some(length) => length.of(one.quantity, stated(one.column)),
            None => angle(one, labels.get(one.column), fallback, head, cells, options)?,
        };
        let is_guess = from == "guess" && lengths[one.joint].is_none();
        let other = if is_guess { by_partner(one, unit, layout, &stated, cells) } else { None };
        if let Some(other) = other {
            let message = format!(
                "column {:?} says no unit, and is taken as {}: its range is that of the other side of {} so",
                head.names[one.column], other.name, layout.joints[one.joint]
            );
            remarks.add(Code::Guessed, 1, message);
        } else if is_guess {
            guessed.push(one.column);
        }
        let unit = other.unwrap_or(unit);
        settled.push(Settled { column: one.column, unit: Some(unit), from });
    }
    for Settled { column, unit, .. } in &settled {
        scale(cells, *column, unit.map_or(1.0, |unit| unit.factor));
    }
    let unit = fallback.map_or(RADIAN, |(unit, _)| unit);
    remark_guessed(&guessed, labels, head, unit, remarks);
    let may_slide = |column: &usize| {
        unit == DEGREE && cells.columns.get(column).is_some_and(|column| column.reach() > TAU)
    };
    remark_lengths(guessed.iter().filter(|column| may_slide(column)), labels, remarks);
    remark_grad(layout, labels, head, remarks);
    for one in &layout.interfaces {
        if one.name == VALVE {
            settled.push(share_of_travel(one.column, head, cells, remarks));
            continue;
        }
        let unit = stated(one.column).filter(|_| one.name.ends_with("_pa"));
        match unit {
            Some(unit) if unit.measure == Measure::Pressure => {
                scale(cells, one.column, unit.factor);
                settled.push(Settled { column: one.column, unit: Some(unit), from: "file" });
            }
            Some(unit) => {
                let (column, unit) = (head.names[one.column].clone(), unit.name.to_owned());
                return Err(CsvError::WrongUnit { column, unit, expected: "pressure" });
            }
            None => {
                let doubt = one.name.ends_with("_pa");
                let message = format!("columns of {} that say no unit, taken as Pa", one.name);
                remarks.add(Code::Guessed, u64::from(doubt), message);
                settled.push(Settled { column: one.column, unit: None, from: "as given" });
            }
        }
    }
    let kind = |length: &Option<Length>| length.map_or(JointKind::Turns, |_| JointKind::Slides);
    Ok((settled, lengths.iter().map(kind).collect()))
}

/// Signals to valves are shares of their full travel: percent are a hundred of them, and what reaches farther is in a unit that nobody
/// says.
fn share_of_travel(column: usize, head: &Head, cells: &mut Cells, remarks: &mut Remarks) -> Settled {
    const PERCENT: [&str; 3] = ["%", "pct", "percent"];
    const FULL: f64 = 1.5;
    let name = head.names[column].to_lowercase();
    let name = name.trim_end_matches([')', ']', ' ']);
    if PERCENT.iter().any(|unit| name.ends_with(unit)) {
        scale(cells, column, 0.01);
        return Settled { column, unit: None, from: "percent, by its header" };
    }
    let of = cells.columns.get(&column).map_or(&[][..], |column| &column.values);
    let reach =
        of.iter().filter(|value| value.is_finite()).fold(0.0_f64, |reach, value| reach.max(value.abs()));
    let message = format!(
        "signals to valves that reach farther than their full travel, such as {:?} ({reach:.3}): dead bands of valves are told in the \
         unit of their column; --interface {VALVE}:JOINT=FACTOR*COLUMN,... makes shares of them, such as 0.1*COLUMN of 10 V",
        head.names[column]
    );
    remarks.add(Code::Guessed, u64::from(reach > FULL), message);
    Settled { column, unit: None, from: "as given" }
}

/// The unit of the positions of a joint that slides, and whether the caller says so.
#[derive(Debug, Clone, Copy)]
struct Length {
    unit: Unit,
    /// Who says so, if it is the caller.
    given: Option<&'static str>,
}

impl Length {
    /// The unit of one of its columns, and who says so.
    fn of(self, quantity: Quantity, stated: Option<Unit>) -> (Unit, &'static str) {
        let (unit, measure) = match quantity {
            Quantity::Position => (self.unit, Measure::Length),
            Quantity::Velocity => (self.unit.per_second(), Measure::LinearSpeed),
        };
        match stated.filter(|stated| stated.measure == measure) {
            _ if self.given.is_some() => (unit, self.given.unwrap_or_default()),
            Some(stated) => (stated, "file"),
            None => (unit, "guess"),
        }
    }
}

/// The joints that slide, `[joints]`: those that the caller calls so, and those whose columns are in units of length.
fn lengths(
    layout: &Layout,
    options: &CsvOptions,
    stated: &impl Fn(usize) -> Option<Unit>,
) -> Result<Vec<Option<Length>>, CsvError> {
    let same = |name: &str, joint: &str| name.to_lowercase() == joint.to_lowercase();
    let of = |(index, joint): (usize, &String)| {
        let given = options.slides.iter().find(|(name, _)| same(name, joint));
        if let Some(unit) = given.and_then(|(_, unit)| parse_unit(unit.name())) {
            return Ok(Some(Length { unit, given: Some("option") }));
        }
        let uses = layout.uses.iter().filter(|one| one.joint == index);
        let units: Vec<Unit> = uses.filter_map(|one| stated(one.column)).collect();
        let first = |all: [Measure; 2]| units.iter().find(|unit| all.contains(&unit.measure));
        let slides = first([Measure::Length, Measure::LinearSpeed]);
        match (slides, first([Measure::Angle, Measure::AngularSpeed])) {
            (Some(long), Some(angle)) => {
                let units = [long, angle].map(|unit| unit.name.to_owned());
                Err(CsvError::MixedKinds { joint: joint.clone(), units })
            }
            (Some(long), None) => Ok(Some(Length { unit: *long, given: None })),
            (None, Some(_)) => Ok(None),
            (None, None) => {
                let read = options.slides_if_unsaid.iter().find(|(name, _)| same(name, joint));
                let unit = read.and_then(|(_, unit)| parse_unit(unit.name()));
                Ok(unit.map(|unit| Length { unit, given: Some("as read") }))
            }
        }
    };
    if let Some(name) =
        options.slides.keys().find(|name| layout.joints.iter().all(|joint| !same(joint, name)))
    {
        return Err(CsvError::NoJoint {
            what: "--slides".to_owned(),
            joint: name.clone(),
            nearest: nearest(name, layout.joints.iter().map(String::as_str)),
            present: layout.joints.join(", "),
        });
    }
    layout.joints.iter().enumerate().map(of).collect()
}

/// The unit of a column of a joint that turns, and who says so.
fn angle(
    one: &Use,
    label: Option<&Label>,
    fallback: Option<(Unit, &'static str)>,
    head: &Head,
    cells: &Cells,
    options: &CsvOptions,
) -> Result<(Unit, &'static str), CsvError> {
    let (wanted, expected) = match one.quantity {
        Quantity::Position => (Measure::Angle, "angle"),
        Quantity::Velocity => (Measure::AngularSpeed, "speed of a joint"),
    };
    let named = options.columns.contains_key(&(one.role, one.quantity));
    let reach = cells.columns.get(&one.column).map_or(0.0, super::read::Column::reach);
    let too_far = one.quantity == Quantity::Position && reach > FARTHEST_RAD;
    let (angle, from) = match (label.and_then(|label| label.unit), fallback) {
        (Some(unit), _) if unit.measure == wanted => return Ok((unit, "file")),
        // The caller names the column and the unit: that holds against a header.
        (_, Some((unit, "option"))) if named => (unit, "option"),
        (Some(unit), _) => {
            let column = head.names[one.column].clone();
            return Err(CsvError::WrongUnit { column, unit: unit.name.to_owned(), expected });
        }
        // What a kind of file is known to use may have been converted since.
        (None, Some((unit, from))) if from != KNOWN || !too_far => (unit, from),
        (None, _) => {
            if too_far {
                let column = head.names[one.column].clone();
                let counts = reach > FARTHEST_DEG;
                let says = says_no_unit(label);
                return Err(if counts {
                    CsvError::Counts { column, says, reach }
                } else {
                    CsvError::AngleUnit { column, says, reach }
                });
            }
            (RADIAN, "guess")
        }
    };
    let speed = one.quantity == Quantity::Velocity;
    let speed = speed.then(|| parse_unit(if angle == DEGREE { "deg/s" } else { "rad/s" })).flatten();
    Ok((speed.unwrap_or(angle), from))
}

/// Remarks on columns whose unit was guessed: those that say none, and those that say one that is not known.
fn remark_guessed(columns: &[usize], labels: &[Label], head: &Head, unit: Unit, remarks: &mut Remarks) {
    let unknown = |column: &&usize| labels.get(**column).and_then(|label| label.unknown.as_ref());
    let (known, plain): (Vec<&usize>, _) = columns.iter().partition(|column| unknown(column).is_some());
    for (columns, scale) in [
        (plain, ""),
        (
            known,
            ", or say what one is with --planned JOINT=FACTOR*COLUMN,... --measured JOINT=FACTOR*COLUMN,...",
        ),
    ] {
        let Some(first) = columns.first() else { continue };
        let message = format!(
            "columns that say no unit{}, such as {:?}, taken as {}; else import with --degrees or --radians{scale}",
            unknown(first)
                .map_or_else(String::new, |unknown| format!(" that is known ({unknown:?} is none)")),
            head.names[**first],
            unit.name
        );
        remarks.add(Code::Guessed, columns.len() as u64, message);
    }
}

/// Offers to take columns for lengths that reach farther than joints turn.
fn remark_lengths<'a>(columns: impl Iterator<Item = &'a usize>, labels: &[Label], remarks: &mut Remarks) {
    let joints: BTreeSet<&str> =
        columns.filter_map(|column| labels.get(*column)).map(|label| label.joint.as_str()).collect();
    let slides: Vec<String> = joints.iter().map(|joint| format!("{joint}=mm")).collect();
    let message = format!(
        "joints without a unit that reach farther than a turn: lengths? then import with --slides {}",
        shell_word(&slides.join(","))
    );
    remarks.add(Code::Guessed, joints.len() as u64, message);
}

/// `grad` are degrees in German and other languages, and a hundredth of a right angle elsewhere.
fn remark_grad(layout: &Layout, labels: &[Label], head: &Head, remarks: &mut Remarks) {
    const ENGLISH: [&str; 9] = [
        "target", "actual", "planned", "measured", "desired", "commanded", "setpoint", "reference",
        "feedback",
    ];
    let is_doubtful = |column: &usize| {
        let [name, below] =
            [Some(&head.names), head.units.as_ref()].map(|row| row.and_then(|row| row.get(*column)));
        let says = |text: Option<&String>| {
            text.is_some_and(|text| text.split(|c: char| !c.is_alphabetic()).next_back() == Some("grad"))
                || text.is_some_and(|text| text.ends_with("grad]") || text.ends_with("grad)"))
        };
        let is_english = |label: &Label| label.words.iter().any(|word| ENGLISH.contains(&word.as_str()));
        (says(name) || says(below)) && labels.get(*column).is_some_and(is_english)
    };
    let found: Vec<usize> = layout.uses.iter().map(|one| one.column).filter(is_doubtful).collect();
    let Some(first) = found.first() else { return };
    let message = format!(
        "columns in `grad` under English names, such as {:?}, taken as degrees, 360 to a turn; if they are gons, 400 to a turn, \
         import with --planned JOINT=0.9*COLUMN,... --measured JOINT=0.9*COLUMN,... --degrees",
        head.names[*first]
    );
    remarks.add(Code::Guessed, found.len() as u64, message);
}

/// That a header says no unit, or none that is known.
fn says_no_unit(label: Option<&Label>) -> String {
    label.and_then(|label| label.unknown.as_ref()).map_or_else(
        || "says no unit".to_owned(),
        |unknown| format!("says no unit that is known ({unknown:?} is none)"),
    )
}

/// Degrees by radians, as ranges of plan and measurement show it.
const DEGREES_A_RADIAN: [f64; 2] = [40.0, 80.0];

/// The other unit of angles for positions that are guessed to be in one, if their range is then that of the other side,
/// whose unit is stated.
fn by_partner(
    one: &Use,
    guess: Unit,
    layout: &Layout,
    stated: &impl Fn(usize) -> Option<Unit>,
    cells: &Cells,
) -> Option<Unit> {
    let partner = layout.uses.iter().find(|other| {
        let beside = other.joint == one.joint && other.role != one.role && other.quantity == one.quantity;
        beside && one.quantity == Quantity::Position && stated(other.column).is_some()
    })?;
    let unit = stated(partner.column).filter(|unit| unit.measure == Measure::Angle)?;
    let span = |column: usize| {
        let values = cells.columns.get(&column).map_or(&[][..], |column| &column.values);
        let [least, most] = crate::math::range(values.iter().copied().filter(|value| value.is_finite()));
        most - least
    };
    let ratio = span(one.column) * guess.factor / (span(partner.column) * unit.factor);
    let within = |ratio: f64| (DEGREES_A_RADIAN[0]..DEGREES_A_RADIAN[1]).contains(&ratio);
    match guess {
        DEGREE if within(ratio.recip()) => Some(RADIAN),
        RADIAN if within(ratio) => Some(DEGREE),
        _ => None,
    }
}

/// A kind of file whose unit is known.
const KNOWN: &str = "RTDE";

/// What columns are in that say nothing: what the caller says, what the kind of file is known to
/// use, or what all other columns say.
fn fallback(
    head: &Head,
    options: &CsvOptions,
    stated: impl Iterator<Item = Option<Unit>>,
) -> Option<(Unit, &'static str)> {
    match options.angle_unit {
        Some(AngleUnit::Degrees) => return Some((DEGREE, "option")),
        Some(AngleUnit::Radians) => return Some((RADIAN, "option")),
        None => {}
    }
    let has = |name: &str| head.names.iter().any(|other| other == name);
    if has("target_q_0") && has("actual_q_0") {
        return Some((RADIAN, KNOWN));
    }
    let mut stated = stated.flatten();
    let first = stated.next()?;
    stated.all(|unit| unit == first).then_some((first, "guess"))
}

pub(super) fn scale(cells: &mut Cells, column: usize, factor: f64) {
    if let Some(column) = cells.columns.get_mut(&column).filter(|_| factor.to_bits() != 1.0_f64.to_bits()) {
        column.values.iter_mut().for_each(|value| *value *= factor);
    }
}
