//! Map files (TOML): how columns are read, to use again for the next run.

use std::{collections::BTreeMap, path::Path};

use serde::{Deserialize, Serialize};

use super::{
    AngleUnit, Columns, CsvError, CsvOptions, LengthUnit, Quantity, Role, Separator, Understood,
    options::describe, order::order_of,
};
use crate::input_file;

/// The first line of a map.
pub(in crate::log) const MAP_BEGINS: &str =
    "# How a table is read, as `hydrotrace import --save-map` found it.\n";

/// The document of a map file.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct MapFile {
    separator: Option<String>,
    decimal_comma: Option<bool>,
    /// Column, then value.
    only: Option<[String; 2]>,
    time: Option<String>,
    time_unit: Option<String>,
    rate_hz: Option<f64>,
    angle_unit: Option<AngleUnit>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    slides: BTreeMap<String, LengthUnit>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    planned: BTreeMap<String, String>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    measured: BTreeMap<String, String>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    command: BTreeMap<String, String>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    planned_velocity: BTreeMap<String, String>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    measured_velocity: BTreeMap<String, String>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    command_velocity: BTreeMap<String, String>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    interface: BTreeMap<String, BTreeMap<String, String>>,
}

impl CsvOptions {
    /// Reads a map file (TOML).
    ///
    /// # Errors
    ///
    /// [`CsvError::MapFile`] if it cannot be read or has unknown keys.
    pub fn from_map(path: &Path) -> Result<Self, CsvError> {
        let fault = |reason: String| CsvError::MapFile { path: path.to_owned(), reason };
        let text = input_file::read_to_string(path).map_err(|error| fault(error.to_string()))?;
        let file: MapFile =
            toml::from_str(&text).map_err(|error| fault(error.to_string().trim().to_owned()))?;
        let separator = match &file.separator {
            None => None,
            Some(text) => Some(Separator::parse(text).ok_or_else(|| {
                fault(format!(
                    "separator = {text:?}: one character or comma, semicolon, tab, space is expected"
                ))
            })?),
        };
        let list = |map: BTreeMap<String, String>| map.into_iter().collect::<Columns>();
        let columns = [
            (Role::Planned, Quantity::Position, file.planned),
            (Role::Measured, Quantity::Position, file.measured),
            (Role::Command, Quantity::Position, file.command),
            (Role::Planned, Quantity::Velocity, file.planned_velocity),
            (Role::Measured, Quantity::Velocity, file.measured_velocity),
            (Role::Command, Quantity::Velocity, file.command_velocity),
        ];
        let columns = columns.into_iter().filter(|(_, _, map)| !map.is_empty());
        Ok(Self {
            separator,
            decimal_comma: file.decimal_comma,
            only: file.only.map(|[column, value]| (column, value)),
            time: file.time,
            time_unit: file.time_unit,
            rate_hz: file.rate_hz,
            angle_unit: file.angle_unit,
            slides: file.slides,
            slides_if_unsaid: BTreeMap::new(),
            as_plan: false,
            columns: columns.map(|(role, quantity, map)| ((role, quantity), list(map))).collect(),
            interfaces: file.interface.into_iter().map(|(name, map)| (name, list(map))).collect(),
        })
    }

    /// The text of a map file that reads the next file of the same form as one was read with these options.
    pub fn to_map(&self, read: &Understood) -> String {
        let named = |header: &str, number: usize| {
            let all = read.columns.iter().map(|c| &c.header).chain(&read.unused).chain(&read.time.columns);
            if all.filter(|other| *other == header).count() == 1 {
                header.to_owned()
            } else {
                format!("#{number}")
            }
        };
        let list = |role, quantity| {
            let becomes = describe(role, quantity);
            let columns = read.columns.iter().filter(|column| column.becomes == becomes);
            columns.map(|column| (column.joint.clone(), named(&column.header, column.number))).collect()
        };
        let position = |role| list(role, Quantity::Position);
        let velocity = |role| list(role, Quantity::Velocity);
        let unit = |column: &super::ColumnRead| column.unit.clone().filter(|_| column.unit_from != "file");
        let angle = read.columns.iter().filter_map(unit).find_map(|unit| match unit.as_str() {
            "deg" => Some(AngleUnit::Degrees),
            "rad" => Some(AngleUnit::Radians),
            _ => None,
        });
        let lengths = read
            .columns
            .iter()
            .filter_map(|column| Some((column.joint.clone(), LengthUnit::parse(column.unit.as_deref()?)?)));
        let time = match read.time.columns.as_slice() {
            [column] => Some(column.clone()),
            _ => None,
        };
        let known: Vec<String> = self.interfaces.keys().cloned().collect();
        let interface = known.into_iter().map(|name| {
            let columns = read.columns.iter().filter(|column| column.becomes == name);
            let columns = columns.map(|column| (column.joint.clone(), named(&column.header, column.number)));
            (name.clone(), columns.collect())
        });
        let file = MapFile {
            separator: Some(read.separator.clone()),
            decimal_comma: Some(read.decimal == "comma"),
            only: self.only.clone().map(|(column, value)| [column, value]),
            time_unit: time.as_ref().and(time_unit(&read.time.form)),
            time,
            rate_hz: self.rate_hz,
            angle_unit: self.angle_unit.or(angle),
            slides: lengths.collect(),
            planned: position(Role::Planned),
            measured: position(Role::Measured),
            command: position(Role::Command),
            planned_velocity: velocity(Role::Planned),
            measured_velocity: velocity(Role::Measured),
            command_velocity: velocity(Role::Command),
            interface: interface.collect(),
        };
        // A map of texts always has a form in TOML.
        MAP_BEGINS.to_owned() + &toml::to_string(&file).unwrap_or_default()
    }
}

/// What `--time-unit` says of a form of times.
fn time_unit(form: &str) -> Option<String> {
    let counted = form.strip_prefix("counts ").and_then(|unit| unit.split(',').next());
    counted.or_else(|| order_of(form)).map(str::to_owned)
}
