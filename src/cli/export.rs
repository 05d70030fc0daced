//! `export`: reads, writes a table.

use std::io::Write;

use super::{
    CliError, Outcome,
    args::ExportArgs,
    output::{say_remarks, spare_inputs},
};
use crate::{
    atomic::write_atomically,
    log::{AngleUnit, ExportError},
    workflow::export::{Inputs, run as export},
};

pub(super) fn run(
    args: &ExportArgs,
    out: &mut impl Write,
    err: &mut impl Write,
) -> Result<Outcome, CliError> {
    spare_inputs(args.output.as_deref(), &args.logs)?;
    let exported = export(&Inputs {
        logs: args.logs.clone(),
        read: args.read.options(),
        command: args.command.clone(),
        unit: if args.degrees { AngleUnit::Degrees } else { AngleUnit::Radians },
    })?;
    let table = &exported.table;
    match &args.output {
        Some(path) if args.format.parquet => {
            write_atomically::<_, ExportError>(path, |file| table.write_parquet(file))?;
        }
        Some(path) => write_atomically::<_, ExportError>(path, |file| table.write_csv(file))?,
        None => table.write_csv(&mut *out).map_err(|error| match error {
            ExportError::Output(error) => CliError::Output(error),
            other => CliError::Export(other),
        })?,
    }
    say_remarks(&exported.remarks, err);
    if let Some(path) = &args.output {
        let columns = table.column_names().count();
        writeln!(out, "{} rows, {columns} columns written to {}.", table.rows(), path.display())?;
    }
    Ok(if exported.remarks.is_empty() { Outcome::Clean } else { Outcome::Remarks })
}
