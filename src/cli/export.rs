//! `export`: reads, writes a table.

use std::io::Write;

use super::{
    CliError, Outcome,
    args::ExportArgs,
    output::{say_remarks, spare_inputs, spare_stdout, text_file},
};
use crate::{
    atomic_file::write_atomically,
    log::{AngleUnit, ExportError},
    workflow::export::{Inputs, run as export},
};

pub(super) fn run(
    args: &ExportArgs,
    out: &mut impl Write,
    err: &mut impl Write,
) -> Result<Outcome, CliError> {
    spare_inputs(args.output.as_deref(), &args.logs)?;
    let output = text_file(args.output.as_deref());
    let parquet = match (args.wants_parquet(), &args.output) {
        (Some(parquet), _) => parquet,
        (None, Some(path)) => return Err(CliError::NoForm(path.clone())),
        (None, None) => false,
    };
    if parquet {
        spare_stdout(args.output.as_deref())?;
    }
    let exported = export(&Inputs {
        logs: args.logs.clone(),
        read: args.read.options(),
        command: args.command.clone(),
        unit: if args.degrees { AngleUnit::Degrees } else { AngleUnit::Radians },
    })?;
    let table = &exported.table;
    match output {
        Some(path) if parquet => {
            write_atomically::<_, ExportError>(path, |file| table.write_parquet(file))?;
        }
        Some(path) => write_atomically::<_, ExportError>(path, |file| table.write_csv(file))?,
        None => table.write_csv(&mut *out).map_err(|error| match error {
            ExportError::Output(error) => CliError::Output(error),
            other => CliError::Export(other),
        })?,
    }
    say_remarks(&exported.remarks, err);
    if let Some(path) = output {
        let columns = table.column_names().count();
        writeln!(out, "{} rows, {columns} columns written to {}.", table.rows(), path.display())?;
    }
    Ok(if exported.remarks.is_empty() { Outcome::Clean } else { Outcome::Remarks })
}
