//! What a caller says of the columns of a table, shared by the verbs that read one.

use std::path::PathBuf;

use crate::log::{AngleUnit, Columns, CsvError, CsvOptions, LengthUnit, Quantity, Role, Separator};

/// Columns, units and form of a table.
#[derive(Debug, clap::Args)]
#[expect(clippy::struct_excessive_bools, reason = "each is a flag")]
pub(super) struct ColumnArgs {
    /// File (TOML) that assigns the columns; options given here override it
    #[arg(long, value_name = "FILE", help_heading = "Columns")]
    map: Option<PathBuf>,

    /// Read only the rows with VALUE in COLUMN, such as those of one machine of several; VALUE * reads all rows as of one machine
    #[arg(long, value_name = "COLUMN=VALUE", value_parser = pair, help_heading = "Columns")]
    only: Option<(String, String)>,

    /// Column of the time
    #[arg(long, value_name = "COLUMN", help_heading = "Columns", conflicts_with = "rate")]
    time: Option<String>,

    /// Unit of the time: s, ms, us, ns, min, h, filetime, dotnet, excel, datenum; of dates, what comes first: dmy, mdy
    #[arg(long, value_name = "UNIT", help_heading = "Columns", conflicts_with = "rate")]
    time_unit: Option<String>,

    /// Rate of the rows, if the file has no time column
    #[arg(long, value_name = "HZ", help_heading = "Columns")]
    rate: Option<f64>,

    /// Columns of the planned angles
    #[arg(long, value_name = "JOINT=COLUMN,...", value_delimiter = ',', value_parser = pair, help_heading = "Columns")]
    planned: Vec<(String, String)>,

    /// Columns of the measured angles
    #[arg(long, value_name = "JOINT=COLUMN,...", value_delimiter = ',', value_parser = pair, help_heading = "Columns")]
    measured: Vec<(String, String)>,

    /// Columns of the commanded angles, if they differ from the plan
    #[arg(long, value_name = "JOINT=COLUMN,...", value_delimiter = ',', value_parser = pair, help_heading = "Columns")]
    command: Vec<(String, String)>,

    /// Columns of the planned speeds
    #[arg(long, value_name = "JOINT=COLUMN,...", value_delimiter = ',', value_parser = pair, help_heading = "Columns")]
    planned_velocity: Vec<(String, String)>,

    /// Columns of the measured speeds
    #[arg(long, value_name = "JOINT=COLUMN,...", value_delimiter = ',', value_parser = pair, help_heading = "Columns")]
    measured_velocity: Vec<(String, String)>,

    /// Columns of another quantity of the joints; values become Pa if NAME ends in _pa
    #[arg(long, value_name = "NAME:JOINT=COLUMN,...", value_parser = interface, help_heading = "Columns")]
    interface: Vec<(String, Columns)>,

    /// Angles in columns without a unit are in degrees
    #[arg(long, help_heading = "Form of the file", conflicts_with = "radians")]
    degrees: bool,

    /// Angles in columns without a unit are in radians
    #[arg(long, help_heading = "Form of the file")]
    radians: bool,

    /// Joints that slide, and the unit of their columns: m, cm or mm; columns of other joints are angles
    #[arg(long, value_name = "JOINT=UNIT,...", value_delimiter = ',', value_parser = slides, help_heading = "Form of the file")]
    slides: Vec<(String, LengthUnit)>,

    /// Separator of the cells: a character, or comma, semicolon, tab, space
    #[arg(long, value_name = "CHAR", value_parser = separator, help_heading = "Form of the file")]
    separator: Option<Separator>,

    /// Numbers have a decimal comma: 1,5
    #[arg(long, help_heading = "Form of the file", conflicts_with = "decimal_point")]
    decimal_comma: bool,

    /// Numbers have a decimal point: 1.5
    #[arg(long, help_heading = "Form of the file")]
    decimal_point: bool,
}

impl ColumnArgs {
    /// Reads the map file, too.
    pub(super) fn options(&self) -> Result<CsvOptions, CsvError> {
        let read_map = self.map.as_deref().map(CsvOptions::from_map).transpose()?.unwrap_or_default();
        let flag = |yes: bool, no: bool| if yes { Some(true) } else { no.then_some(false) };
        let columns = [
            (Role::Planned, Quantity::Position, &self.planned),
            (Role::Measured, Quantity::Position, &self.measured),
            (Role::Command, Quantity::Position, &self.command),
            (Role::Planned, Quantity::Velocity, &self.planned_velocity),
            (Role::Measured, Quantity::Velocity, &self.measured_velocity),
        ];
        let columns = columns.into_iter().filter(|(_, _, columns)| !columns.is_empty());
        let own = CsvOptions {
            separator: self.separator,
            decimal_comma: flag(self.decimal_comma, self.decimal_point),
            only: self.only.clone(),
            time: self.time.clone(),
            time_unit: self.time_unit.clone(),
            rate_hz: self.rate,
            angle_unit: flag(self.degrees, self.radians)
                .map(|degrees| if degrees { AngleUnit::Degrees } else { AngleUnit::Radians }),
            slides: self.slides.iter().cloned().collect(),
            columns: columns.map(|(role, quantity, columns)| ((role, quantity), columns.clone())).collect(),
            interfaces: self.interface.iter().cloned().collect(),
            ..CsvOptions::default()
        };
        Ok(own.or(read_map))
    }
}

/// `JOINT=COLUMN`.
fn pair(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((joint, column)) if !joint.trim().is_empty() && !column.trim().is_empty() => {
            Ok((joint.trim().to_owned(), column.trim().to_owned()))
        }
        _ => Err(format!(
            "{text:?} is not JOINT=COLUMN, such as J1=q_soll_1; a column with a comma goes as #3"
        )),
    }
}

/// `JOINT=UNIT`.
fn slides(text: &str) -> Result<(String, LengthUnit), String> {
    let found = text.split_once('=').map(|(joint, unit)| (joint.trim(), LengthUnit::parse(unit.trim())));
    match found {
        Some((joint, Some(unit))) if !joint.is_empty() => Ok((joint.to_owned(), unit)),
        _ => Err(format!("{text:?} is not JOINT=UNIT with m, cm or mm, such as BOOM=mm")),
    }
}

/// `NAME:JOINT=COLUMN,...`.
fn interface(text: &str) -> Result<(String, Columns), String> {
    let Some((name, list)) = text.split_once(':').filter(|(name, _)| !name.trim().is_empty()) else {
        return Err(format!("{text:?} is not NAME:JOINT=COLUMN,..., such as cap_pressure_pa:J1=pA_1"));
    };
    Ok((name.trim().to_owned(), list.split(',').map(pair).collect::<Result<_, _>>()?))
}

fn separator(text: &str) -> Result<Separator, String> {
    Separator::parse(text)
        .ok_or_else(|| format!("{text:?} is not one character, or comma, semicolon, tab, space"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_joint_is_split_from_its_column_at_the_first_equals_sign() {
        assert_eq!(pair("J1=a=b"), Ok(("J1".to_owned(), "a=b".to_owned())));
        assert!(pair("J1").is_err() && pair("=a").is_err());
        let (name, columns) = interface("cap_pressure_pa:J1=p 1,J2=#4").unwrap();
        assert_eq!((name.as_str(), columns.len(), columns[1].1.as_str()), ("cap_pressure_pa", 2, "#4"));
    }
}
