//! `simulate`: runs a plan on a simulated machine and writes the log of the run.

use std::{io::Write, path::Path};

use super::{
    CliError, Outcome,
    args::SimulateArgs,
    output::{deliver, shown, spare_inputs, spare_stdout},
};
use crate::{
    atomic_file::write_atomically,
    plant::{Parameters, PlantError},
    render::simulate::document,
    workflow::simulate::log::{Run, SimulateFailure, simulate},
};

pub(super) fn run(args: &SimulateArgs, out: &mut impl Write) -> Result<Outcome, CliError> {
    let run = simulated(args)?;
    deliver(&shown(&document(&run, &args.plant, args.seed, &args.output), None), None, out)?;
    Ok(Outcome::Clean)
}

/// Runs the plan and writes the run.
pub(super) fn simulated(args: &SimulateArgs) -> Result<Run, CliError> {
    spare_inputs(Some(&args.output), std::slice::from_ref(&args.log))?;
    spare_stdout(Some(&args.output))?;
    let run = simulate(&args.log, parameters(&args.plant).map_err(SimulateFailure::from)?, args.seed)?;
    let bytes = run.log()?;
    write_atomically(&args.output, |file| Ok::<(), CliError>(file.write_all(&bytes)?))?;
    Ok(run)
}

/// A preset by its name, else a file.
fn parameters(plant: &str) -> Result<Parameters, PlantError> {
    let named = Parameters::preset_names().any(|name| name == plant);
    // What is neither a preset nor a file is more likely a misspelt preset.
    if named || !Path::new(plant).exists() {
        Parameters::preset(plant)
    } else {
        Parameters::read(Path::new(plant))
    }
}
