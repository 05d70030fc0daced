//! Numbers of columns become SI, by the unit that each column states or is given.

use super::{
    AngleUnit, CsvError, CsvOptions, Quantity,
    head::Head,
    label::Label,
    layout::Layout,
    read::Cells,
    unit::{DEGREE, Measure, RADIAN, Unit, parse_unit},
};
use crate::remark::{Code, Remarks};

/// The unit of a column and who says so.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Settled {
    pub(super) column: usize,
    pub(super) unit: Option<Unit>,
    pub(super) from: &'static str,
}

/// Joints with end stops stay within one and a half turns to either side, rad.
const FARTHEST_RAD: f64 = 3.0 * std::f64::consts::PI;

/// Converts the columns in use.
pub(super) fn to_si(
    head: &Head,
    labels: &[Label],
    layout: &Layout,
    options: &CsvOptions,
    cells: &mut Cells,
    remarks: &mut Remarks,
) -> Result<Vec<Settled>, CsvError> {
    let stated = |column: usize| labels.get(column).and_then(|label| label.unit);
    let positions = || layout.uses.iter().filter(|one| one.quantity == Quantity::Position);
    let fallback = fallback(head, options, positions().map(|one| stated(one.column)));
    let mut settled = Vec::new();
    let mut guessed: Vec<&str> = Vec::new();
    for one in &layout.uses {
        let (wanted, expected) = match one.quantity {
            Quantity::Position => (Measure::Angle, "angle"),
            Quantity::Velocity => (Measure::AngularSpeed, "speed of a joint"),
        };
        let (angle, from) = match (stated(one.column), fallback) {
            (Some(unit), _) if unit.measure == wanted => (unit, "file"),
            (Some(unit), _) => {
                let column = head.names[one.column].clone();
                return Err(CsvError::WrongUnit { column, unit: unit.name.to_owned(), expected });
            }
            (None, Some((unit, from))) => (unit, from),
            (None, None) => {
                let reach = cells.columns.get(&one.column).map_or(0.0, super::read::Column::reach);
                if one.quantity == Quantity::Position && reach > FARTHEST_RAD {
                    return Err(CsvError::AngleUnit { column: head.names[one.column].clone(), reach });
                }
                (RADIAN, "guess")
            }
        };
        let unit = if one.quantity == Quantity::Velocity && from != "file" {
            parse_unit(if angle == DEGREE { "deg/s" } else { "rad/s" }).unwrap_or(angle)
        } else {
            angle
        };
        if from == "guess" {
            guessed.push(&head.names[one.column]);
        }
        scale(cells, one.column, unit.factor);
        settled.push(Settled { column: one.column, unit: Some(unit), from });
    }
    if let Some(first) = guessed.first() {
        let unit = fallback.map_or(RADIAN, |(unit, _)| unit).name;
        let message = format!(
            "columns that say no unit, such as {first:?}, taken as {unit}; else say --degrees or --radians"
        );
        remarks.add(Code::Guessed, guessed.len() as u64, message);
    }
    for one in &layout.interfaces {
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
    Ok(settled)
}

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
        return Some((RADIAN, "RTDE"));
    }
    let mut stated = stated.flatten();
    let first = stated.next()?;
    stated.all(|unit| unit == first).then_some((first, "guess"))
}

fn scale(cells: &mut Cells, column: usize, factor: f64) {
    if let Some(column) = cells.columns.get_mut(&column).filter(|_| factor.to_bits() != 1.0_f64.to_bits()) {
        column.values.iter_mut().for_each(|value| *value *= factor);
    }
}
