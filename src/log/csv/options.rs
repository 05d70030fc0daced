//! Options of reading a CSV file, for facts that the file does not state.

use std::{collections::BTreeMap, path::Path};

use serde::Deserialize;

use super::{CsvError, Quantity, Role, unit::Measure, unit::parse_unit};
use crate::input_file;

/// Joint to the column that holds it: a header, or `#3` for the third column.
pub type Columns = Vec<(String, String)>;

/// Facts about a CSV file that the caller states; none by default.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CsvOptions {
    /// Between the cells; `None`: found.
    pub separator: Option<Separator>,
    /// Whether numbers are written 1,5; `None`: found.
    pub decimal_comma: Option<bool>,
    /// Column of the time; `None`: found by name.
    pub time: Option<String>,
    /// Unit of the time column: s, ms, us or ns.
    pub time_unit: Option<String>,
    /// Rows come at this rate, Hz; the file's own times are not used.
    pub rate_hz: Option<f64>,
    /// Unit of angles whose column states none.
    pub angle_unit: Option<AngleUnit>,
    /// Columns given for a role and quantity; these are then not looked for.
    pub columns: BTreeMap<(Role, Quantity), Columns>,
    /// Other quantities by joint, kept as interfaces of `control_msgs/DynamicJointState`.
    pub interfaces: BTreeMap<String, Columns>,
}

/// The separator of cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Separator {
    /// One byte.
    Byte(u8),
    /// Any run of spaces and tabs.
    Space,
}

/// Unit of an angle; a speed is in the same unit a second.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AngleUnit {
    /// deg
    #[serde(alias = "deg")]
    Degrees,
    /// rad
    #[serde(alias = "rad")]
    Radians,
}

impl Separator {
    /// Reads a separator as a person types it: the character, or its name.
    pub fn parse(text: &str) -> Option<Self> {
        match (text, text.as_bytes()) {
            ("comma", _) => Some(Self::Byte(b',')),
            ("semicolon", _) => Some(Self::Byte(b';')),
            ("tab" | "\\t", _) => Some(Self::Byte(b'\t')),
            ("space" | " ", _) => Some(Self::Space),
            (_, &[one]) if one.is_ascii() && !one.is_ascii_alphanumeric() && !b"\"#\r\n\0".contains(&one) => {
                Some(Self::Byte(one))
            }
            _ => None,
        }
    }

    /// Its name.
    pub fn name(self) -> String {
        match self {
            Self::Byte(b',') => "comma".to_owned(),
            Self::Byte(b';') => "semicolon".to_owned(),
            Self::Byte(b'\t') => "tab".to_owned(),
            Self::Byte(other) => char::from(other).to_string(),
            Self::Space => "space".to_owned(),
        }
    }
}

/// The document of a map file.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct MapFile {
    separator: Option<String>,
    decimal_comma: Option<bool>,
    time: Option<String>,
    time_unit: Option<String>,
    rate_hz: Option<f64>,
    angle_unit: Option<AngleUnit>,
    planned: BTreeMap<String, String>,
    measured: BTreeMap<String, String>,
    command: BTreeMap<String, String>,
    planned_velocity: BTreeMap<String, String>,
    measured_velocity: BTreeMap<String, String>,
    command_velocity: BTreeMap<String, String>,
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
            time: file.time,
            time_unit: file.time_unit,
            rate_hz: file.rate_hz,
            angle_unit: file.angle_unit,
            columns: columns.map(|(role, quantity, map)| ((role, quantity), list(map))).collect(),
            interfaces: file.interface.into_iter().map(|(name, map)| (name, list(map))).collect(),
        })
    }

    /// These options, completed by those of `other`.
    #[must_use]
    pub fn or(mut self, other: Self) -> Self {
        self.separator = self.separator.or(other.separator);
        self.decimal_comma = self.decimal_comma.or(other.decimal_comma);
        self.time = self.time.or(other.time);
        self.time_unit = self.time_unit.or(other.time_unit);
        self.rate_hz = self.rate_hz.or(other.rate_hz);
        self.angle_unit = self.angle_unit.or(other.angle_unit);
        for (key, columns) in other.columns {
            self.columns.entry(key).or_insert(columns);
        }
        for (name, columns) in other.interfaces {
            self.interfaces.entry(name).or_insert(columns);
        }
        self
    }

    /// Checks all that does not depend on the file.
    pub(super) fn check(&self) -> Result<(), CsvError> {
        let bad = |option, found: String, expected| CsvError::Option { option, found, expected };
        if let Some(rate_hz) = self.rate_hz.filter(|hz| !(hz.is_finite() && *hz > 0.0 && *hz <= 1e6)) {
            return Err(bad("--rate", rate_hz.to_string(), "samples a second, above 0 and up to 1e6"));
        }
        if let Some(text) = &self.time_unit
            && parse_unit(text).is_none_or(|unit| unit.measure != Measure::Time)
        {
            return Err(bad("--time-unit", text.clone(), "s, ms, us or ns"));
        }
        Ok(())
    }
}
