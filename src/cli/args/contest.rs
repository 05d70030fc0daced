//! Arguments of `bench plan`.

use std::path::PathBuf;

use clap::builder::PossibleValuesParser;

use super::{MoeaFormat, moea::chosen};
use crate::{
    moea::{CONTENDERS, Contender},
    workflow::contest::{ContestFailure, Inputs, Subject},
};

/// Checkpoints of a convergence curve.
const STEPS: u64 = 60;

/// Arguments of `bench plan`.
#[derive(Debug, clap::Args)]
pub struct ContestArgs {
    /// Tasks: simulation, task-1, task-2 (the paper's), or task files
    #[arg(
        long,
        value_name = "NAME|FILE,...",
        value_delimiter = ',',
        default_value = "simulation,task-1,task-2"
    )]
    pub task: Vec<String>,

    /// Algorithms that start from random plans, or all; the seeded search is always there
    #[arg(
        long,
        value_name = "NAME,...",
        value_delimiter = ',',
        default_value = "nsga3-fo,nsga3,moead,nsga2",
        ignore_case = true,
        value_parser = PossibleValuesParser::new(CONTENDERS.into_iter().map(|c| c.name).chain(["all"]))
    )]
    pub algorithm: Vec<String>,

    /// Budgets; every one is a run of its own
    #[arg(
        long,
        value_name = "N,...",
        value_delimiter = ',',
        default_value = "1000,5000,20000",
        value_parser = clap::value_parser!(u64).range(1..=100_000_000)
    )]
    pub evaluations: Vec<u64>,

    /// Number of seeds
    #[arg(long, value_name = "N", default_value_t = 11, value_parser = clap::value_parser!(u64).range(1..=10_000))]
    pub seeds: u64,

    /// First seed
    #[arg(long, default_value_t = 1)]
    pub seed: u64,

    /// Evaluations of the seeded search whose front the others are measured against
    #[arg(
        long,
        value_name = "N",
        default_value_t = 60_000,
        value_parser = clap::value_parser!(u64).range(1..=100_000_000)
    )]
    pub reference: u64,

    /// Write the course of the longest budget's runs to DIR: curves.csv, and an SVG a task
    #[arg(long, value_name = "DIR")]
    pub curves: Option<PathBuf>,

    /// Form of the findings
    #[command(flatten)]
    pub format: MoeaFormat,
}

impl ContestArgs {
    /// The same for the library; reads the tasks.
    ///
    /// # Errors
    ///
    /// [`ContestFailure`] for a task that is none.
    pub fn inputs(&self) -> Result<Inputs, ContestFailure> {
        let mut subjects: Vec<Subject> = Vec::new();
        for (index, name) in self.task.iter().enumerate() {
            if !self.task[..index].contains(name) {
                subjects.push(Subject::find(name)?);
            }
        }
        let names = CONTENDERS.map(|contender| contender.name);
        Ok(Inputs {
            subjects,
            contenders: chosen(&self.algorithm, &names).into_iter().filter_map(Contender::named).collect(),
            evaluations: self.evaluations.clone(),
            first_seed: self.seed,
            seeds: self.seeds,
            reference_evaluations: self.reference,
            steps: if self.curves.is_some() { STEPS } else { 0 },
        })
    }
}
