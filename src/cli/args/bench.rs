//! Arguments of `bench`.

use clap::Subcommand;

use super::{ContestArgs, MoeaArgs};

/// Arguments of `bench`.
#[derive(Debug, clap::Args)]
pub struct BenchArgs {
    /// What to measure.
    #[command(subcommand)]
    pub what: Bench,
}

/// What can be measured.
#[derive(Debug, Subcommand)]
pub enum Bench {
    /// Precision and recall of the transition detector on synthetic joints with known motions
    Detector(DetectorArgs),
    /// What the evolutionary algorithms reach on problems with known fronts, beside the paper
    #[command(after_help = "Examples:\n  hydrotrace bench moea --operators platemo --seeds 31\n  \
                            hydrotrace bench moea --problem DTLZ1,DTLZ3 --algorithm nsga3-fo,nsga3 --evaluations 5000\n  \
                            hydrotrace bench moea --problem WFG3 --curves curves --front fronts")]
    Moea(MoeaArgs),
    /// What the algorithms reach on tasks of the arm, and the paper's plans beside ours
    #[command(after_help = "Examples:\n  hydrotrace bench plan --seeds 31\n  \
                            hydrotrace bench plan --task task-1 --algorithm nsga3-fo,nsga3 --evaluations 2000 --curves curves\n  \
                            hydrotrace bench plan --task my-task.toml --json > my-task.json")]
    Plan(ContestArgs),
}

/// Arguments of `bench detector`.
#[derive(Debug, clap::Args)]
pub struct DetectorArgs {
    /// Seed of the synthetic joints
    #[arg(long, default_value_t = 1)]
    pub seed: u64,

    /// Runs of one minute for each row
    #[arg(long, default_value_t = 30, value_parser = clap::value_parser!(u64).range(1..=10_000))]
    pub runs: u64,

    /// One JSON document
    #[arg(long)]
    pub json: bool,
}
