//! Options of reading a CSV file, for facts that the file does not state.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{CsvError, Quantity, Role, order::is_order, unit::Measure, unit::parse_unit};

/// Joint to the column that holds it: a header, or `#3` for the third column.
pub type Columns = Vec<(String, String)>;

/// Facts about a CSV file that the caller states; none by default.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CsvOptions {
    /// Between the cells; `None`: found.
    pub separator: Option<Separator>,
    /// Whether numbers are written 1,5; `None`: found.
    pub decimal_comma: Option<bool>,
    /// A column and its value in the rows to read; `None`: all rows.
    pub only: Option<(String, String)>,
    /// Column of the time; `None`: found by name.
    pub time: Option<String>,
    /// Unit of the time column: s, ms, us, ns, min, h, filetime (100 ns since 1601), excel (days since 1899-12-30)
    /// or datenum (days since year 0).
    pub time_unit: Option<String>,
    /// Rows come at this rate, Hz; the file's own times are not used.
    pub rate_hz: Option<f64>,
    /// Unit of angles whose column states none.
    pub angle_unit: Option<AngleUnit>,
    /// Joints that slide, and the unit of their columns, which then holds whatever a header says.
    pub slides: BTreeMap<String, LengthUnit>,
    /// The same of those that the table has and says no unit of.
    pub slides_if_unsaid: BTreeMap<String, LengthUnit>,
    /// Columns given for a role and quantity; these are then not looked for.
    pub columns: BTreeMap<(Role, Quantity), Columns>,
    /// Whether columns that say neither plan nor measurement are the plan, where no column says either.
    pub as_plan: bool,
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AngleUnit {
    /// deg
    #[serde(alias = "deg")]
    Degrees,
    /// rad
    #[serde(alias = "rad")]
    Radians,
}

/// Unit of a length; a speed is in the same unit a second.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum LengthUnit {
    /// mm
    #[serde(rename = "mm")]
    Millimetres,
    /// cm
    #[serde(rename = "cm")]
    Centimetres,
    /// m
    #[serde(rename = "m")]
    Metres,
}

impl LengthUnit {
    const ALL: [Self; 3] = [Self::Millimetres, Self::Centimetres, Self::Metres];

    /// Reads a unit as a person types it.
    pub fn parse(text: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|unit| unit.name() == text)
    }

    /// Reads `JOINT=UNIT`, or `JOINT` alone for m; `None` for another unit.
    pub fn of_joint(text: &str) -> Option<(String, Self)> {
        let (joint, unit) = text.split_once('=').unwrap_or((text, "m"));
        Some((joint.trim().to_owned(), Self::parse(unit.trim())?))
    }

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Millimetres => "mm",
            Self::Centimetres => "cm",
            Self::Metres => "m",
        }
    }

    /// How many metres it is.
    pub(in crate::log) const fn metres(self) -> f64 {
        match self {
            Self::Millimetres => 1e-3,
            Self::Centimetres => 1e-2,
            Self::Metres => 1.0,
        }
    }
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

impl CsvOptions {
    /// Whether every column is named by its number, the time too if there is one.
    pub(super) fn by_number(&self) -> bool {
        let columns = || self.columns.values().flatten().map(|(_, column)| column);
        let timed = self.time.is_some() || self.rate_hz.is_some();
        timed
            && columns().next().is_some()
            && columns().chain(&self.time).all(|column| column.starts_with('#'))
    }

    /// These options, completed by those of `other`.
    pub fn or(mut self, other: Self) -> Self {
        self.separator = self.separator.or(other.separator);
        self.decimal_comma = self.decimal_comma.or(other.decimal_comma);
        self.only = self.only.or(other.only);
        self.time = self.time.or(other.time);
        self.time_unit = self.time_unit.or(other.time_unit);
        self.rate_hz = self.rate_hz.or(other.rate_hz);
        self.angle_unit = self.angle_unit.or(other.angle_unit);
        self.as_plan |= other.as_plan;
        for (joint, unit) in other.slides {
            self.slides.entry(joint).or_insert(unit);
        }
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
            && !is_order(text)
        {
            return Err(bad(
                "--time-unit",
                text.clone(),
                "s, ms, us, ns, min, h, filetime, excel or datenum, or dmy or mdy of dates",
            ));
        }
        Ok(())
    }
}

/// The option that names columns of a role and quantity.
pub(super) fn option(role: Role, quantity: Quantity) -> &'static str {
    match (role, quantity) {
        (Role::Planned, Quantity::Position) => "--planned",
        (Role::Measured, Quantity::Position) => "--measured",
        (Role::Command, Quantity::Position) => "--command",
        (Role::Planned, Quantity::Velocity) => "--planned-velocity",
        (Role::Measured, Quantity::Velocity) => "--measured-velocity",
        (Role::Command, Quantity::Velocity) => "--command-velocity",
    }
}

/// Such as "planned position".
pub(super) fn describe(role: Role, quantity: Quantity) -> String {
    let role = match role {
        Role::Planned => "planned",
        Role::Measured => "measured",
        Role::Command => "command",
    };
    let quantity = match quantity {
        Quantity::Position => "position",
        Quantity::Velocity => "velocity",
    };
    format!("{role} {quantity}")
}
