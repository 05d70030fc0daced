//! Arguments of `plan`.

use std::{
    path::{Path, PathBuf},
    time::Duration,
};

use clap::{
    ArgAction,
    builder::{PossibleValue, PossibleValuesParser, TypedValueParser},
};

use crate::{
    cli::{
        console::{Form, ends},
        figures::FigureArgs,
        number::{any_seconds, rate_hz, within},
    },
    moea::{ALGORITHMS, Budget, NamedAlgorithm},
    plan::{MOST_PIECES, Rule, Search},
    task::{Objective, Weights},
    workflow::plan::{Options, Shaping},
};

const EXAMPLES: &str = "\
Examples:
  hydrotrace plan task.toml -o plan.mcap
  hydrotrace plan task.toml --choose fastest
  hydrotrace plan task.toml --times 0,2.01,3.77,5.79,6.53,8.85,10.48
  hydrotrace plan task.toml --json --evaluations 100000 > plan.json";

/// The best timings of a task's key points, the chosen one as a log
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Args {
    /// The task: a TOML file (schemas/task.schema.json in the repository)
    #[arg(value_name = "TASK")]
    pub(super) task: PathBuf,

    /// Write the chosen plan to FILE, an MCAP log that also holds the task and the Pareto front; if FILE ends in
    /// .html or .json, write the page or the document instead
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,

    /// Evaluate one plan instead of searching: arrival times at the key points, s, dwells included
    #[arg(
        long,
        value_name = "S,...",
        value_delimiter = ',',
        value_parser = any_seconds,
        allow_negative_numbers = true,
        conflicts_with_all = ["shape", "pieces", "choose", "weights", "near", "degrees"]
    )]
    pub(super) times: Option<Vec<f64>>,

    /// One JSON document with the front (schemas/plan.v1.schema.json in the repository)
    #[arg(long)]
    pub(super) json: bool,

    /// One page for a browser: front, search and every limit; needs no network
    #[arg(long, conflicts_with = "json")]
    pub(super) html: bool,

    #[command(flatten)]
    pub(super) figures: FigureArgs,

    /// Sampling rate of the log
    #[arg(long, value_name = "HZ", default_value_t = 100.0, value_parser = rate_hz, allow_negative_numbers = true)]
    pub(super) rate: f64,

    #[command(flatten)]
    pub(super) search: SearchArgs,

    #[command(flatten)]
    pub(super) choice: ChoiceArgs,

    #[command(flatten)]
    pub(super) shape: ShapeArgs,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Shape")]
pub(super) struct ShapeArgs {
    /// What the chosen plan is free in beside the times at the key points
    #[arg(long, value_name = "WHAT", default_value = "timing")]
    pub(super) shape: Free,

    /// Pieces that an interval between key points is split into, with --shape free [default: 20 of one interval,
    /// 10 of two, 8 of three, else as many as make 25 altogether, 2 to 5]; 30 give a percent or two more in six times the time
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=i64::from(MOST_PIECES)))]
    pub(super) pieces: Option<u32>,
}

/// What a plan is free in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(in crate::cli) enum Free {
    /// Times at the key points alone, as in the paper
    Timing,
    /// Times and the curve between the key points, by the rule that chooses: faster, smoother or thriftier
    Free,
}

impl Free {
    /// With so many pieces an interval, if it is free.
    pub(in crate::cli) fn shaping(self, pieces: Option<u32>) -> Shaping {
        match self {
            Self::Timing => Shaping::Timing,
            Self::Free => Shaping::Free(pieces.map(|n| n as usize)),
        }
    }
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Searching")]
pub(super) struct SearchArgs {
    /// Budget in evaluations [default: 20000]
    #[arg(long, value_name = "N", group = "budget", value_parser = clap::value_parser!(u64).range(500..=1_000_000_000))]
    pub(super) evaluations: Option<u64>,

    /// Budget in generations
    #[arg(long, value_name = "N", group = "budget", value_parser = clap::value_parser!(u64).range(1..=10_000_000))]
    pub(super) generations: Option<u64>,

    /// Budget in seconds; the result then depends on the speed of the computer
    #[arg(long, value_name = "S", group = "budget", value_parser = time_budget, allow_negative_numbers = true)]
    pub(super) time_budget: Option<Duration>,

    /// Evolutionary algorithm
    #[arg(
        long,
        value_name = "NAME",
        default_value = "nsga3-fo",
        ignore_case = true,
        value_parser = PossibleValuesParser::new(ALGORITHMS.map(|c| c.name))
    )]
    pub(super) algorithm: String,

    /// Start and end with gradient descents (the default)
    #[arg(long, overrides_with = "no_seeded")]
    pub(super) seeded: bool,

    /// Start from random plans, as in the paper
    #[arg(long, action = ArgAction::SetTrue)]
    pub(super) no_seeded: bool,

    /// Size of the population [default: 92, one per reference direction]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(4..=100_000))]
    pub(super) population: Option<u32>,

    /// Seed of all random numbers
    #[arg(long, default_value_t = 1)]
    pub(super) seed: u64,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Choosing")]
pub(super) struct ChoiceArgs {
    /// Rule that chooses the plan [default: the task's weights, else ideal]
    #[arg(long, value_name = "RULE", value_parser = rules())]
    pub(super) choose: Option<Rule>,

    #[arg(long, value_name = "W,...", help = weights_help(), value_parser = weights, conflicts_with = "choose")]
    /// Weights in place of the task's.
    pub(super) weights: Option<Weights>,

    /// Also the smoothest plans within round times around S, each exact: the front between those of the search
    #[arg(long, value_name = "S", value_parser = near_s, allow_negative_numbers = true)]
    pub(super) near: Option<f64>,

    /// Also by splines of the other degrees, 5, 6 and 7, searched and chosen alike; names one that is better
    #[arg(long)]
    pub(super) degrees: bool,
}

fn near_s(text: &str) -> Result<f64, String> {
    within(text, [0.01, 1e6], "a time of 0.01 to 1,000,000 s")
}

/// Every rule by its name, with what it does.
fn rules() -> impl TypedValueParser<Value = Rule> {
    let said = |rule: Rule| match rule {
        Rule::Weights => "Least weighted sum, equal weights if there are none".to_owned(),
        Rule::Ideal => "Nearest to the best of every objective".to_owned(),
        Rule::Knee => "Where the front bulges most: least sum, whatever the weights".to_owned(),
        Rule::Best(objective) => format!("Least {}", objective.row().name),
    };
    PossibleValuesParser::new(Rule::all().map(|rule| PossibleValue::new(rule.name()).help(said(rule))))
        .try_map(|name| Rule::named(&name).ok_or("no rule"))
}

fn weights_help() -> String {
    let names: Vec<&str> = Objective::OF_PLAN.iter().map(|objective| objective.row().short).collect();
    format!("Weights in place of the task's, in this order: {}", names.join(", "))
}

impl Args {
    /// The form, by option or ending.
    pub(super) fn form(&self) -> Form {
        let forms = [(self.json, Form::Json), (self.html, Form::Html)];
        Form::of(&forms, self.output.as_deref())
    }

    pub(super) fn log(&self) -> Option<&Path> {
        self.output.as_deref().filter(|_| self.page().is_none())
    }

    /// Where page or document go: to a file of that ending, else to standard output, which `-` names too.
    pub(super) fn page(&self) -> Option<&Path> {
        let form = self.form();
        let fits = |path: &&Path| match form {
            Form::Html => ends(Some(path), "html"),
            Form::Json => ends(Some(path), "json"),
            _ => false,
        };
        let here = |path: &&Path| *path == Path::new("-") && form != Form::Text;
        self.output.as_deref().filter(|path| fits(path) || here(path))
    }

    pub(super) fn options(&self) -> Options {
        let SearchArgs { evaluations, generations, time_budget, .. } = &self.search;
        let default = Search::default();
        let budget = match (evaluations, generations, time_budget) {
            (Some(evaluations), _, _) => Budget::Evaluations(*evaluations),
            (_, Some(generations), _) => Budget::Generations(*generations),
            (_, _, Some(_)) => Budget::Observer,
            _ => default.budget,
        };
        let rule = self.choice.weights.map(|_| Rule::Weights).or(self.choice.choose);
        Options {
            near_s: self.choice.near,
            degrees: self.choice.degrees,
            search: Search {
                algorithm: NamedAlgorithm::find(&self.search.algorithm)
                    .map_or(default.algorithm, |c| c.algorithm),
                seeded: !self.search.no_seeded,
                budget,
                population: self.search.population.map(|n| n as usize),
                seed: self.search.seed,
                ..default
            },
            rule,
            weights: self.choice.weights,
            shape: self.shape.shape.shaping(self.shape.pieces),
        }
    }
}

fn time_budget(text: &str) -> Result<Duration, String> {
    within(text, [0.0, 1e6], "a time from 0 to 1e6 s").map(Duration::from_secs_f64)
}

fn weights(text: &str) -> Result<Weights, String> {
    let values = text
        .split(',')
        .map(|part| within(part, [0.0, f64::MAX], "a weight of zero or more"))
        .collect::<Result<Vec<_>, _>>()?;
    let weights = Weights::from_slice(&values);
    let count = Objective::OF_PLAN.len();
    if values.len() == count && weights.are_weights() {
        return Ok(weights);
    }
    Err(format!(
        "{text:?} is not {count} weights of zero or more, not all zero, such as {}",
        vec!["1"; count].join(",")
    ))
}
