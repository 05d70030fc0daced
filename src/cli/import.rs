//! `import`

use std::{path::PathBuf, slice::from_ref};

use super::{
    CliError, Outcome, Run,
    console::{Console, Target, spare_for_log},
};
use crate::{
    document::pretty,
    log::{AngleUnit, Columns, CsvError, CsvOptions, LengthUnit, Quantity, Role, Separator},
    render::import as words,
    workflow::import::{Inputs, run},
};

const EXAMPLES: &str = "\
Examples:
  hydrotrace import trace.csv -o trace.mcap
  hydrotrace report trace.mcap
  hydrotrace import trace.csv -o trace.mcap --degrees --time-unit ms
  hydrotrace import trace.csv -o trace.mcap --rate 50 --planned J1=soll_1 --measured J1=#4
  hydrotrace import trace.csv -o trace.mcap --interface cap_pressure_pa:J1=pA_1,J2=pA_2
  hydrotrace import trace.csv -o trace.mcap --planned BOOM=measured+error --slides BOOM=mm
  hydrotrace import trace.csv -o trace.mcap --save-map arm.toml
  hydrotrace import next.csv -o next.mcap --map arm.toml

A column is given by its header, by its number as #3, or as a sum such as #3+#4, 0.5*raw-12: the factors and
constants are in the unit of the column. A map file holds the same as the options:
  time = \"Zeit\"         # also: separator, decimal_comma, time_unit, rate_hz
  angle_unit = \"deg\"
  slides = { BOOM = \"mm\" }
  [planned]             # also: [measured] [command] [planned_velocity] [measured_velocity]
  J1 = \"q_soll_1\"
  [interface.cap_pressure_pa]
  J1 = \"pA_1\"

Recognised without options: separator, decimal comma, header, a row of units, dates, and columns whose
names contain target/actual, soll/ist, planned/measured, ref/meas or set/act together with q, pos, angle or
a unit such as [deg]. Columns cmd and command are the command, not the plan. The output lists how the file
was read; every guess is a remark.";

/// Turn a CSV file (PLC trace, RTDE, any table) into a log
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
#[expect(clippy::struct_excessive_bools, reason = "each is a flag")]
pub(super) struct Args {
    /// The CSV file
    file: PathBuf,

    /// Write the log to LOG
    #[arg(short, long, value_name = "LOG")]
    output: PathBuf,

    /// Print how the file was read as one JSON document
    #[arg(long)]
    json: bool,

    /// File (TOML) that assigns the columns; options given here override it
    #[arg(long, value_name = "FILE", help_heading = "Columns")]
    map: Option<PathBuf>,

    /// Write how the columns were read to FILE, to be given as --map for the next file of the same form
    #[arg(long, value_name = "FILE", help_heading = "Columns")]
    save_map: Option<PathBuf>,

    /// Column of the time
    #[arg(long, value_name = "COLUMN", help_heading = "Columns", conflicts_with = "rate")]
    time: Option<String>,

    /// Unit of the time: s, ms, us, ns
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

impl Args {
    /// Reads the map file, too.
    fn request(&self) -> Result<Inputs, CsvError> {
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
            time: self.time.clone(),
            time_unit: self.time_unit.clone(),
            rate_hz: self.rate,
            angle_unit: flag(self.degrees, self.radians)
                .map(|degrees| if degrees { AngleUnit::Degrees } else { AngleUnit::Radians }),
            slides: self.slides.iter().cloned().collect(),
            columns: columns.map(|(role, quantity, columns)| ((role, quantity), columns.clone())).collect(),
            interfaces: self.interface.iter().cloned().collect(),
        };
        let (file, output, map) = (self.file.clone(), self.output.clone(), self.save_map.clone());
        Ok(Inputs { file, options: own.or(read_map), output, map })
    }
}

impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        spare_for_log(Some(&self.output), from_ref(&self.file))?;
        let imported = run(&self.request()?)?;
        let target = Target::stdout(self.json);
        let result = if self.json {
            pretty(&imported)
        } else {
            target.text(&words::document(&self.output.to_string_lossy(), &imported))
        };
        console.finish(&target, &result, &imported.remarks, &[])
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
