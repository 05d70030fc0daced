//! `import`

use std::{
    path::{Path, PathBuf},
    slice::from_ref,
};

use super::{
    CliError, Outcome, Run,
    columns::ColumnArgs,
    console::{Console, spare_for_file, spare_for_log},
};
use crate::{
    log::CsvError,
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
  hydrotrace import my-bag -o run.mcap --degrees

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

/// Turn a table (PLC trace, RTDE, CSV) or an unknown bag into a log
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// The table, log or bag
    file: PathBuf,

    /// Write the log to LOG
    #[arg(short, long, value_name = "LOG")]
    output: PathBuf,

    /// Print how the file was read as one JSON document
    #[arg(long)]
    json: bool,

    /// Write how the columns were read to FILE, to be given as --map for the next file of the same form
    #[arg(long, value_name = "FILE", help_heading = "Columns")]
    save_map: Option<PathBuf>,

    #[command(flatten)]
    columns: ColumnArgs,
}

impl Args {
    /// Reads the map file, too.
    fn request(&self) -> Result<Inputs, CsvError> {
        let (file, output, map) = (self.file.clone(), self.output.clone(), self.save_map.clone());
        Ok(Inputs { file, options: self.columns.options()?, output, map })
    }
}

impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        spare_for_log(Some(&self.output), from_ref(&self.file))?;
        if let Some(map) = self.save_map.as_deref().filter(|map| is_same(map, &self.output)) {
            let name = map.display();
            return Err(CliError::Usage(format!(
                "--output and --save-map both name {name}; give each its own"
            )));
        }
        spare_for_file(self.save_map.as_deref(), from_ref(&self.file))?;
        let imported = run(&self.request()?)?;
        let shown = || words::document(&self.output.to_string_lossy(), &imported);
        console.answer(self.json, &imported, shown, &imported.remarks, &[])
    }
}

/// Whether two names are of one file, whether it is there or not.
fn is_same(one: &Path, other: &Path) -> bool {
    let place = |path: &Path| path.canonicalize().or_else(|_| std::path::absolute(path)).ok();
    place(one) == place(other)
}
