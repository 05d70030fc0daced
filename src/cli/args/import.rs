//! Arguments of `import`.

use std::path::PathBuf;

use crate::{
    log::{AngleUnit, Columns, CsvError, CsvOptions, Quantity, Role, Separator},
    workflow::import::Inputs,
};

pub(super) const EXAMPLES: &str = "\
Examples:
  hydrotrace import trace.csv -o trace.mcap
  hydrotrace report trace.mcap
  hydrotrace import trace.csv -o trace.mcap --degrees --time-unit ms
  hydrotrace import trace.csv -o trace.mcap --rate 50 --planned J1=soll_1 --measured J1=#4
  hydrotrace import trace.csv -o trace.mcap --interface cap_pressure_pa:J1=pA_1,J2=pA_2
  hydrotrace import trace.csv -o trace.mcap --map arm.toml

A column is named by its header, or by its number as #3. A map file says the same as the options:
  time = \"Zeit\"         # also: separator, decimal_comma, time_unit, rate_hz
  angle_unit = \"deg\"
  [planned]             # also: [measured] [command] [planned_velocity] [measured_velocity]
  J1 = \"q_soll_1\"
  [interface.cap_pressure_pa]
  J1 = \"pA_1\"

Found without help: separator, decimal comma, header, a row of units, dates, and columns whose
names hold target/actual, soll/ist, planned/measured, ref/meas or set/act, with q, pos, angle or a
unit such as [deg]; cmd and command are what was sent, which is not the plan. What was understood is
printed; what was guessed is a remark.";

/// Arguments of `import`.
#[derive(Debug, clap::Args)]
#[expect(clippy::struct_excessive_bools, reason = "each is a flag")]
pub struct ImportArgs {
    /// The CSV file
    pub file: PathBuf,

    /// The log to write
    #[arg(short, long, value_name = "LOG")]
    pub output: PathBuf,

    /// Say what was understood as one JSON document
    #[arg(long)]
    pub json: bool,

    /// Columns by a file (TOML); other options prevail over it
    #[arg(long, value_name = "FILE", help_heading = "Columns")]
    pub map: Option<PathBuf>,

    /// Column of the time
    #[arg(long, value_name = "COLUMN", help_heading = "Columns", conflicts_with = "rate")]
    pub time: Option<String>,

    /// Unit of the time: s, ms, us, ns
    #[arg(long, value_name = "UNIT", help_heading = "Columns", conflicts_with = "rate")]
    pub time_unit: Option<String>,

    /// Rows come at this rate; no column tells the time
    #[arg(long, value_name = "HZ", help_heading = "Columns")]
    pub rate: Option<f64>,

    /// Columns of the planned angles
    #[arg(long, value_name = "JOINT=COLUMN,...", value_delimiter = ',', value_parser = pair, help_heading = "Columns")]
    pub planned: Vec<(String, String)>,

    /// Columns of the measured angles
    #[arg(long, value_name = "JOINT=COLUMN,...", value_delimiter = ',', value_parser = pair, help_heading = "Columns")]
    pub measured: Vec<(String, String)>,

    /// Columns of the angles that were sent, where they differ from the plan
    #[arg(long, value_name = "JOINT=COLUMN,...", value_delimiter = ',', value_parser = pair, help_heading = "Columns")]
    pub command: Vec<(String, String)>,

    /// Columns of the planned speeds
    #[arg(long, value_name = "JOINT=COLUMN,...", value_delimiter = ',', value_parser = pair, help_heading = "Columns")]
    pub planned_velocity: Vec<(String, String)>,

    /// Columns of the measured speeds
    #[arg(long, value_name = "JOINT=COLUMN,...", value_delimiter = ',', value_parser = pair, help_heading = "Columns")]
    pub measured_velocity: Vec<(String, String)>,

    /// Columns kept as another quantity of the joints; pressures become Pa if NAME ends in _pa
    #[arg(long, value_name = "NAME:JOINT=COLUMN,...", value_parser = interface, help_heading = "Columns")]
    pub interface: Vec<(String, Columns)>,

    /// Angles whose column states no unit are in degrees
    #[arg(long, help_heading = "Form of the file", conflicts_with = "radians")]
    pub degrees: bool,

    /// Angles whose column states no unit are in radians
    #[arg(long, help_heading = "Form of the file")]
    pub radians: bool,

    /// Between the cells: a character, or comma, semicolon, tab, space
    #[arg(long, value_name = "CHAR", value_parser = separator, help_heading = "Form of the file")]
    pub separator: Option<Separator>,

    /// Numbers are written 1,5
    #[arg(long, help_heading = "Form of the file", conflicts_with = "decimal_point")]
    pub decimal_comma: bool,

    /// Numbers are written 1.5
    #[arg(long, help_heading = "Form of the file")]
    pub decimal_point: bool,
}

impl ImportArgs {
    /// The same for the library, with the map file read.
    ///
    /// # Errors
    ///
    /// [`CsvError::MapFile`]
    pub fn inputs(&self) -> Result<Inputs, CsvError> {
        let map = self.map.as_deref().map(CsvOptions::from_map).transpose()?.unwrap_or_default();
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
            time: self.time.clone(),
            time_unit: self.time_unit.clone(),
            rate_hz: self.rate,
            angle_unit: flag(self.degrees, self.radians)
                .map(|degrees| if degrees { AngleUnit::Degrees } else { AngleUnit::Radians }),
            columns: columns.map(|(role, quantity, columns)| ((role, quantity), columns.clone())).collect(),
            interfaces: self.interface.iter().cloned().collect(),
        };
        Ok(Inputs { file: self.file.clone(), options: own.or(map), output: self.output.clone() })
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
