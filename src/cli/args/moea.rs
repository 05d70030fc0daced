//! Arguments of `bench moea`.

use std::path::PathBuf;

use clap::{ValueEnum, builder::PossibleValuesParser};

use crate::{
    moea::{CONTENDERS, Contender, Operators, benchmark},
    workflow::moea::Inputs,
};

/// Stands for every problem or algorithm.
const ALL: &str = "all";

/// Checkpoints of a convergence curve.
const STEPS: u64 = 60;

/// Arguments of `bench moea`.
#[derive(Debug, clap::Args)]
pub struct MoeaArgs {
    /// Problems: DTLZ1 to DTLZ7, WFG1 to WFG9, or all
    #[arg(
        long,
        value_name = "NAME,...",
        value_delimiter = ',',
        default_value = "DTLZ3,WFG3",
        ignore_case = true,
        hide_possible_values = true,
        value_parser = PossibleValuesParser::new(benchmark::NAMES.into_iter().chain([ALL]))
    )]
    pub problem: Vec<String>,

    /// Algorithms, or all
    #[arg(
        long,
        value_name = "NAME,...",
        value_delimiter = ',',
        default_value = "nsga3-fo,nsga3,moead,msops2",
        ignore_case = true,
        value_parser = PossibleValuesParser::new(CONTENDERS.into_iter().map(|c| c.name).chain([ALL]))
    )]
    pub algorithm: Vec<String>,

    /// Budgets; every one is a run of its own
    #[arg(
        long,
        value_name = "N,...",
        value_delimiter = ',',
        default_value = "5000,20000,50000",
        value_parser = clap::value_parser!(u64).range(1..=1_000_000_000)
    )]
    pub evaluations: Vec<u64>,

    /// Number of seeds
    #[arg(long, value_name = "N", default_value_t = 11, value_parser = clap::value_parser!(u64).range(1..=10_000))]
    pub seeds: u64,

    /// First seed
    #[arg(long, default_value_t = 1)]
    pub seed: u64,

    /// Number of objectives
    #[arg(long, value_name = "M", default_value_t = 3, value_parser = clap::value_parser!(u8).range(2..=8))]
    pub objectives: u8,

    /// Rates and distribution indices of crossover and mutation
    #[arg(long, value_enum, default_value_t = OperatorSet::DebJain)]
    pub operators: OperatorSet,

    /// Write every run's front to DIR, as problem-algorithm-evaluations-seed.csv
    #[arg(long, value_name = "DIR")]
    pub front: Option<PathBuf>,

    /// Write the course of the longest budget's runs to DIR: curves.csv, and an SVG a problem
    #[arg(long, value_name = "DIR")]
    pub curves: Option<PathBuf>,

    /// Form of the findings
    #[command(flatten)]
    pub format: MoeaFormat,
}

/// At most one of these.
#[derive(Debug, clap::Args)]
#[group(multiple = false)]
pub struct MoeaFormat {
    /// One JSON document
    #[arg(long)]
    pub json: bool,

    /// As Markdown
    #[arg(long)]
    pub markdown: bool,
}

/// Operators that a comparison is known with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum OperatorSet {
    /// Deb and Jain 2014: eta 30 and 20
    DebJain,
    /// Defaults of PlatEMO: eta 20 and 20
    Platemo,
}

impl MoeaArgs {
    /// The same for the library; the parsers have checked all names.
    pub fn inputs(&self) -> Inputs {
        let objectives = usize::from(self.objectives);
        let problems = chosen(&self.problem, &benchmark::NAMES);
        let names = CONTENDERS.map(|contender| contender.name);
        Inputs {
            problems: problems
                .into_iter()
                .filter_map(|name| benchmark::Benchmark::named(name, objectives))
                .collect(),
            contenders: chosen(&self.algorithm, &names).into_iter().filter_map(Contender::named).collect(),
            evaluations: self.evaluations.clone(),
            first_seed: self.seed,
            seeds: self.seeds,
            operators: match self.operators {
                OperatorSet::DebJain => Operators::default(),
                OperatorSet::Platemo => Operators::PLATEMO,
            },
            steps: if self.curves.is_some() { STEPS } else { 0 },
            fronts: self.front.is_some(),
        }
    }
}

/// Names in the order given, each once, in their usual case.
pub(super) fn chosen<'a>(given: &[String], known: &[&'a str]) -> Vec<&'a str> {
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
        assert_eq!((every.len(), every[0], every[1]), (16, "WFG9", "DTLZ1"));
    }
}
