//! The command line.

use std::path::PathBuf;

use clap::{Parser, Subcommand, ValueEnum, builder::PossibleValuesParser, value_parser};
use hydrotrace_bench::study::{Entrant, Inputs};
use moea::{
    ALGORITHMS, NamedAlgorithm, Operators,
    benchmark::{self, Benchmark},
};

/// Stands for every problem or algorithm.
const ALL: &str = "all";

/// Checkpoints of a curve.
const STEPS: u64 = 60;

/// Studies of hydrotrace.
#[derive(Debug, Parser)]
#[command(name = "hydrotrace-bench", version)]
pub(crate) struct Args {
    #[command(subcommand)]
    pub(crate) study: StudyArgs,
}

#[derive(Debug, Subcommand)]
pub(crate) enum StudyArgs {
    /// Precision and recall of the transition detector on synthetic joints with known motions
    Detector(DetectorArgs),
    /// What is left of the tracking error run after run, on simulated machines of many structures
    #[command(after_help = "Examples:\n  hydrotrace-bench learning --runs 3\n  \
                      hydrotrace-bench learning --machine default --plan 0,3 --seeds 4 --proportional")]
    Learning(LearningArgs),
    /// What the evolutionary algorithms reach on problems with known fronts, beside the paper
    #[command(after_help = "Examples:\n  hydrotrace-bench moea --operators platemo --seeds 31\n  \
                      hydrotrace-bench moea --problem DTLZ1,DTLZ3 --algorithm nsga3-fo,nsga3 --evaluations 5000\n  \
                      hydrotrace-bench moea --problem WFG3 --curves curves --front fronts")]
    Moea(MoeaArgs),
    /// What the algorithms reach on tasks of the arm, and the paper's plans beside ours
    #[command(after_help = "Examples:\n  hydrotrace-bench plan --seeds 31\n  \
                      hydrotrace-bench plan --task task-1 --algorithm nsga3-fo,nsga3 --evaluations 2000 --curves curves\n  \
                      hydrotrace-bench plan --task my-task.toml --json > my-task.json")]
    Plan(PlanArgs),
}

#[derive(Debug, clap::Args)]
pub(crate) struct DetectorArgs {
    /// Seed of the synthetic joints
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,

    /// Runs of one minute for each row
    #[arg(long, default_value_t = 30, value_parser = value_parser!(u64).range(1..=10_000))]
    pub(crate) runs: u64,

    #[command(flatten)]
    pub(crate) format: Format,
}

#[derive(Debug, clap::Args)]
pub(crate) struct LearningArgs {
    /// Machines, by the names of presets of the plant; all of them without
    #[arg(long, value_delimiter = ',', value_name = "NAME")]
    pub(crate) machine: Vec<String>,

    /// Plans by number, 0 to 5
    #[arg(long, value_delimiter = ',', default_value = "0,1,2,3,4", value_name = "N")]
    pub(crate) plan: Vec<usize>,

    /// Number of seeds
    #[arg(long, default_value_t = 2, value_parser = value_parser!(u64).range(1..=1000))]
    pub(crate) seeds: u64,

    /// First seed
    #[arg(long, default_value_t = 1, value_parser = value_parser!(u64).range(1..=1_000_000))]
    pub(crate) seed: u64,

    /// Runs with a command
    #[arg(long, default_value_t = 4, value_parser = value_parser!(u64).range(1..=100))]
    pub(crate) runs: u64,

    /// Proportional iterative learning in place of ours
    #[arg(long)]
    pub(crate) proportional: bool,

    /// One JSON document
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, clap::Args)]
pub(crate) struct MoeaArgs {
    /// Problems: DTLZ1 to DTLZ7, WFG1 to WFG9, MW1 to MW4, or all
    #[arg(
        long,
        value_name = "NAME,...",
        value_delimiter = ',',
        default_value = "DTLZ3,WFG3",
        ignore_case = true,
        hide_possible_values = true,
        value_parser = PossibleValuesParser::new(benchmark::NAMES.into_iter().chain([ALL]))
    )]
    problem: Vec<String>,

    /// Number of objectives; MW1 to MW3 have two
    #[arg(long, value_name = "M", default_value_t = 3, value_parser = value_parser!(u8).range(2..=8))]
    objectives: u8,

    /// Rates and distribution indices of crossover and mutation
    #[arg(long, value_enum, default_value_t = OperatorSet::DebJain)]
    operators: OperatorSet,

    /// Write every run's front to DIR, as problem-algorithm-evaluations-seed.csv
    #[arg(long, value_name = "DIR")]
    pub(crate) front: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) shared: Shared,
}

#[derive(Debug, clap::Args)]
pub(crate) struct PlanArgs {
    /// Tasks: simulation, task-1, task-2 (the paper's), or task files
    #[arg(
        long,
        value_name = "NAME|FILE,...",
        value_delimiter = ',',
        default_value = "simulation,task-1,task-2"
    )]
    task: Vec<String>,

    /// Evaluations of the seeded search whose front the others are measured against
    #[arg(long, value_name = "N", default_value_t = 60_000, value_parser = value_parser!(u64).range(1..=100_000_000))]
    pub(crate) reference: u64,

    #[command(flatten)]
    pub(crate) shared: Shared,
}

/// Algorithms, budgets, seeds and form: the same for every study.
#[derive(Debug, clap::Args)]
pub(crate) struct Shared {
    /// Algorithms, or all; by default nsga3-fo, nsga3, moead, and msops2 (moea) or nsga2 (plan)
    #[arg(
        long,
        value_name = "NAME,...",
        value_delimiter = ',',
        ignore_case = true,
        value_parser = PossibleValuesParser::new(ALGORITHMS.into_iter().map(|named| named.name).chain([ALL]))
    )]
    algorithm: Vec<String>,

    /// Algorithm that the others are compared with
    #[arg(long, value_name = "NAME", default_value = "nsga3", ignore_case = true,
        value_parser = PossibleValuesParser::new(ALGORITHMS.into_iter().map(|named| named.name)))]
    baseline: String,

    /// Budgets, each a run of its own; by default 5000,20000,50000 (moea) or 1000,5000,20000 (plan)
    #[arg(long, value_name = "N,...", value_delimiter = ',', value_parser = value_parser!(u64).range(1..=1_000_000_000))]
    evaluations: Vec<u64>,

    /// Number of seeds
    #[arg(long, value_name = "N", default_value_t = 11, value_parser = value_parser!(u64).range(1..=10_000))]
    seeds: u64,

    /// First seed
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// Write the course of the longest budget's runs to DIR: curves.csv, and an SVG a subject
    #[arg(long, value_name = "DIR")]
    pub(crate) curves: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) format: Format,
}

/// Form of the findings: a table if neither is given.
#[derive(Debug, clap::Args)]
#[group(multiple = false)]
pub(crate) struct Format {
    /// One JSON document
    #[arg(long)]
    pub(crate) json: bool,

    /// As Markdown
    #[arg(long)]
    pub(crate) markdown: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum OperatorSet {
    /// Deb and Jain 2014: eta 30 and 20
    DebJain,
    /// Defaults of PlatEMO: eta 20 and 20
    Platemo,
}

impl MoeaArgs {
    /// Problems; the parser has checked their names.
    pub(crate) fn problems(&self) -> Vec<Benchmark> {
        let names = chosen(&self.problem, &benchmark::NAMES);
        let objectives = usize::from(self.objectives);
        names
            .into_iter()
            .filter_map(|name| Benchmark::named(name, objectives).or_else(|| Benchmark::named(name, 2)))
            .collect()
    }

    pub(crate) fn operators(&self) -> Operators {
        match self.operators {
            OperatorSet::DebJain => Operators::default(),
            OperatorSet::Platemo => Operators::PLATEMO,
        }
    }
}

impl PlanArgs {
    /// Names of the tasks, each once.
    pub(crate) fn tasks(&self) -> Vec<&str> {
        let mut tasks: Vec<&str> = Vec::new();
        for name in &self.task {
            if !tasks.contains(&name.as_str()) {
                tasks.push(name);
            }
        }
        tasks
    }
}

impl Shared {
    /// The study on nothing yet; the last algorithm and the budgets by default are the study's own.
    pub(crate) fn inputs(&self, last: &str, budgets: [u64; 3], fronts: bool) -> Inputs<()> {
        let usual = ["nsga3-fo", "nsga3", "moead", last].map(str::to_owned);
        let given = if self.algorithm.is_empty() { &usual[..] } else { &self.algorithm };
        let names = chosen(given, &ALGORITHMS.map(|named| named.name));
        Inputs {
            subjects: Vec::new(),
            entrants: names.into_iter().filter_map(NamedAlgorithm::find).map(Entrant::from).collect(),
            evaluations: if self.evaluations.is_empty() {
                budgets.to_vec()
            } else {
                self.evaluations.clone()
            },
            baseline: self.baseline.to_ascii_lowercase(),
            first_seed: self.seed,
            seeds: self.seeds,
            steps: if self.curves.is_some() { STEPS } else { 0 },
            fronts,
            settings: std::collections::BTreeMap::new(),
            notes: Vec::new(),
        }
    }
}

/// Names in the order given, each once, in their usual case.
fn chosen<'a>(given: &[String], known: &[&'a str]) -> Vec<&'a str> {
    let mut chosen: Vec<&str> = Vec::new();
    for name in given {
        for known in known {
            let meant = name.eq_ignore_ascii_case(known) || name.eq_ignore_ascii_case(ALL);
            if meant && !chosen.contains(known) {
                chosen.push(known);
            }
        }
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_taken_in_any_case_once_and_in_the_order_given() {
        let given = ["wfg3", "DTLZ3", "WFG3"].map(str::to_owned);
        assert_eq!(chosen(&given, &benchmark::NAMES), ["WFG3", "DTLZ3"]);
        let all = ["WFG9", "All"].map(str::to_owned);
        let every = chosen(&all, &benchmark::NAMES);
        assert_eq!((every.len(), every[0], every[1]), (20, "WFG9", "DTLZ1"));
    }
}
