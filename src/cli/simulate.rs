//! `simulate`

use std::{
    path::{Path, PathBuf},
    slice::from_ref,
};

use super::{
    CliError, Outcome, Run,
    console::{Console, spare_for_log, write_file},
};
use crate::{
    plant::{Parameters, PlantError},
    render::simulate as words,
    workflow::simulate::log::{Run as Simulated, SimulateFailure, simulate},
};

const EXAMPLES: &str = "\
Examples:
  hydrotrace simulate plan.mcap -o run.mcap
  hydrotrace simulate plan.mcap -o run.mcap --plant lag-limited --seed 7";

/// Run a plan on a simulated hydraulic arm
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// Log with a plan, and with the command if it differs from the plan; its task names the arm
    #[arg(value_name = "LOG")]
    log: PathBuf,

    /// Write the run to FILE, an MCAP log
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    /// The machine: one of those of the guide, such as lag-limited or soft, or a TOML file
    #[arg(long, value_name = "PLANT", default_value = "default")]
    plant: String,

    /// Seed of noise, jitter and lost messages
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

impl Args {
    pub(super) fn simulated(&self) -> Result<Simulated, CliError> {
        spare_for_log(Some(&self.output), from_ref(&self.log))?;
        let run = simulate(&self.log, parameters(&self.plant).map_err(SimulateFailure::from)?, self.seed)?;
        write_file(&self.output, &run.log()?)?;
        Ok(run)
    }
}

impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        let run = self.simulated()?;
        console.show(&words::document(&run, &self.plant, self.seed, &self.output))?;
        console.say_remarks(&run.prepared.remarks);
        Ok(if run.prepared.remarks.is_empty() { Outcome::Clean } else { Outcome::Remarks })
    }
}

/// A preset by its name, else a file.
fn parameters(plant: &str) -> Result<Parameters, PlantError> {
    let named = Parameters::preset_names().any(|name| name == plant);
    // A word that is neither a preset nor a file is more likely a misspelt preset.
    if named || !Path::new(plant).exists() {
        Parameters::preset(plant)
    } else {
        Parameters::read(Path::new(plant))
    }
}
