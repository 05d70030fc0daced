//! `export`

use std::path::PathBuf;

use super::{
    CliError, Outcome, Run,
    console::{Console, Form, Target, ends, spare_for_file, spare_inputs},
    read::{ReadArgs, selector},
    views::ViewArgs,
};
use crate::{
    atomic_file::write_atomically,
    log::{AngleUnit, ExportError, Selector},
    workflow::export::{Inputs, run},
};

const EXAMPLES: &str = "\
Examples:
  hydrotrace export run.mcap -o run.csv
  hydrotrace export run.mcap -o run.parquet
  hydrotrace export run.mcap --csv --degrees --joints joint_3
  hydrotrace export next.mcap --csv --degrees -o next.csv
  hydrotrace export run.mcap --foxglove-layout run.json
  hydrotrace export run.mcap --rerun-blueprint run.rbl

One row per instant at which anything was sampled: stamp_ns (since 1970), time_s (since the start), and per
joint J_planned_rad, J_planned_rad_s, J_measured_rad, J_command_rad and J_error_rad, if the log has them.
Logs of plan and replan give plan and command. A cell without a sample is empty. The error is planned minus
measured, with the plan interpolated. `hydrotrace import` turns the table into a log again, whose report
has the same numbers.";

/// Turn plan, command and measurement of a log into CSV or Parquet
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// Logs of one run: MCAP files, ROS 2 bags or tables (CSV, Parquet)
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,

    #[command(flatten)]
    format: FormatArgs,

    /// Write to FILE; .csv and .parquet set the form. CSV without FILE goes to standard output
    #[arg(short, long, value_name = "FILE", required_if_eq("parquet", "true"))]
    output: Option<PathBuf>,

    /// Angles in degrees, lengths of joints that slide in mm; the names of the columns change with the unit
    #[arg(long)]
    degrees: bool,

    /// Topic of the command that was sent, and its field if the topic has several
    #[arg(long, value_name = "TOPIC[:FIELD]", value_parser = selector)]
    command: Option<Selector>,

    #[command(flatten)]
    views: ViewArgs,

    #[command(flatten)]
    read: ReadArgs,
}

#[derive(Debug, clap::Args)]
#[group(multiple = false)]
struct FormatArgs {
    /// Comma-separated values
    #[arg(long)]
    csv: bool,

    /// Apache Parquet, compressed with zstd
    #[arg(long)]
    parquet: bool,
}

impl Args {
    /// Whether to write Parquet, by option or ending.
    fn is_parquet(&self) -> Result<bool, CliError> {
        match &self.output {
            _ if self.format.csv => Ok(false),
            _ if self.format.parquet => Ok(true),
            output if ends(output.as_deref(), "parquet") => Ok(true),
            Some(path) if !ends(Some(path), "csv") => Err(CliError::Usage(format!(
                "{} has neither the ending .csv nor .parquet; say --csv or --parquet",
                path.display()
            ))),
            _ => Ok(false),
        }
    }
}

impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        let file = self.output.as_deref();
        let inputs = Inputs {
            logs: self.logs.clone(),
            read: self.read.options(),
            command: self.command.clone(),
            unit: if self.degrees { AngleUnit::Degrees } else { AngleUnit::Radians },
        };
        if self.views.are_asked() {
            return self.views.write(&inputs, console);
        }
        spare_inputs(file, &self.logs)?;
        let parquet = self.is_parquet()?;
        if parquet {
            spare_for_file(file, &self.logs)?;
        }
        let exported = run(&inputs)?;
        let table = &exported.table;
        let target = if parquet { Target { form: Form::Csv, file } } else { Target::new(Form::Csv, file)? };
        let said = if let Some(path) = target.file {
            write_atomically::<_, ExportError>(path, |file| {
                if parquet { table.write_parquet(file) } else { table.write_csv(file) }
            })?;
            let columns = table.column_names().count();
            format!("{} rows, {columns} columns written to {}.\n", table.rows(), path.display())
        } else {
            table.write_csv(console.out()).map_err(|error| match error {
                ExportError::Output(error) => CliError::Output(error),
                other => other.into(),
            })?;
            String::new()
        };
        console.finish(&Target { file: None, ..target }, &said, &exported.remarks, &[])
    }
}
