//! Arguments of `plan`.

use std::{
    path::{Path, PathBuf},
    time::Duration,
};

use clap::{
    ArgAction,
    builder::{PossibleValue, PossibleValuesParser, TypedValueParser},
};

use super::{FigureArgs, ends};
use crate::{
    moea::{Budget, CONTENDERS, Contender},
    plan::{Rule, Search},
    task::{Objective, Weights},
    workflow::plan::Options,
};

/// Arguments of `plan`.
#[derive(Debug, clap::Args)]
pub struct PlanArgs {
    /// The task: a TOML file as schemas/task.schema.json in the repository describes it
    #[arg(value_name = "TASK")]
    pub task: PathBuf,

    /// Write the chosen plan to FILE, an MCAP log with the task and the whole front within; a FILE that ends in
    /// .html or .json gets the page or the document instead
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,

    /// Do not search: judge the plan with these arrivals at the key points, s, dwells counted
    #[arg(long, value_name = "S,...", value_delimiter = ',', value_parser = time, allow_negative_numbers = true)]
    pub times: Option<Vec<f64>>,

    /// One JSON document with the front, as schemas/plan.v1.schema.json in the repository describes it
    #[arg(long)]
    pub json: bool,

    /// One page for a browser with the front, the search and every limit; needs no network
    #[arg(long, conflicts_with = "json")]
    pub html: bool,

    /// Its plots as files.
    #[command(flatten)]
    pub figures: FigureArgs,

    /// Samples a second in the log
    #[arg(long, value_name = "HZ", default_value_t = 100.0, value_parser = rate, allow_negative_numbers = true)]
    pub rate: f64,

    /// How to search.
    #[command(flatten)]
    pub search: SearchArgs,

    /// How to choose.
    #[command(flatten)]
    pub choice: ChoiceArgs,
}

/// How to search.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Searching")]
pub struct SearchArgs {
    /// Evaluations altogether [default: 20000]
    #[arg(long, value_name = "N", group = "budget", value_parser = clap::value_parser!(u64).range(500..=1_000_000_000))]
    pub evaluations: Option<u64>,

    /// Generations of the evolution
    #[arg(long, value_name = "N", group = "budget", value_parser = clap::value_parser!(u64).range(1..=10_000_000))]
    pub generations: Option<u64>,

    /// Seconds for the evolution; what it finds then depends on the machine
    #[arg(long, value_name = "S", group = "budget", value_parser = seconds, allow_negative_numbers = true)]
    pub time_budget: Option<Duration>,

    /// Evolutionary algorithm
    #[arg(
        long,
        value_name = "NAME",
        default_value = "nsga3-fo",
        ignore_case = true,
        value_parser = PossibleValuesParser::new(CONTENDERS.map(|c| c.name))
    )]
    pub algorithm: String,

    /// Start from descents and end with them (the default)
    #[arg(long, overrides_with = "no_seeded")]
    pub seeded: bool,

    /// Start from random plans, as the paper does
    #[arg(long, action = ArgAction::SetTrue)]
    pub no_seeded: bool,

    /// Members of the population; by default as the directions ask (92)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(4..=100_000))]
    pub population: Option<u32>,

    /// Seed of all random numbers
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

/// How to choose.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Choosing")]
pub struct ChoiceArgs {
    /// Rule; by default the task's weights, or the ideal
    #[arg(long, value_name = "RULE", value_parser = rules())]
    pub choose: Option<Rule>,

    #[arg(long, value_name = "W,...", help = weights_help(), value_parser = weights, conflicts_with = "choose")]
    /// Weights in place of the task's.
    pub weights: Option<Weights>,
}

/// Every rule by its name, with what it does.
fn rules() -> impl TypedValueParser<Value = Rule> {
    let said = |rule: Rule| match rule {
        Rule::Weights => "Least weighted sum, equal weights if there are none".to_owned(),
        Rule::Ideal => "Nearest to the best of every objective".to_owned(),
        Rule::Knee => "Where giving up a little costs most".to_owned(),
        Rule::Best(objective) => format!("Least {}", objective.row().name),
    };
    PossibleValuesParser::new(Rule::all().map(|rule| PossibleValue::new(rule.name()).help(said(rule))))
        .try_map(|name| Rule::named(&name).ok_or("no rule"))
}

fn weights_help() -> String {
    let names: Vec<&str> = Objective::OF_PLAN.iter().map(|objective| objective.row().short).collect();
    format!("Weights in place of the task's, in this order: {}", names.join(", "))
}

impl PlanArgs {
    /// Whether a page is wanted, by option or by the ending of the output.
    pub fn wants_html(&self) -> bool {
        self.html || !self.json && ends(self.output.as_deref(), "html")
    }

    /// The same of the document.
    pub fn wants_json(&self) -> bool {
        self.json || !self.html && ends(self.output.as_deref(), "json")
    }

    /// Where the log goes.
    pub fn log(&self) -> Option<&Path> {
        self.output.as_deref().filter(|_| self.page().is_none())
    }

    /// Where page or document go: a file of that ending, `-` for standard output, which is also meant without.
    pub fn page(&self) -> Option<&Path> {
        let fits = |path: &&Path| {
            self.wants_html() && ends(Some(path), "html") || self.wants_json() && ends(Some(path), "json")
        };
        let here = |path: &&Path| *path == Path::new("-") && (self.html || self.json);
        self.output.as_deref().filter(|path| fits(path) || here(path))
    }

    /// The same for the library.
    pub fn options(&self) -> Options {
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
            search: Search {
                algorithm: Contender::named(&self.search.algorithm)
                    .map_or(default.algorithm, |c| c.algorithm),
                seeded: !self.search.no_seeded,
                budget,
                population: self.search.population.map(|n| n as usize),
                seed: self.search.seed,
                ..default
            },
            rule,
            weights: self.choice.weights,
        }
    }
}

fn number(text: &str, what: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("{text:?} is not {what}")),
    }
}

fn time(text: &str) -> Result<f64, String> {
    number(text, "a time in seconds")
}

fn rate(text: &str) -> Result<f64, String> {
    number(text, "a rate in hertz").and_then(|hz| {
        if (1.0..=10_000.0).contains(&hz) { Ok(hz) } else { Err(format!("{hz} Hz is not within 1 to 10000")) }
    })
}

fn seconds(text: &str) -> Result<Duration, String> {
    let s = number(text, "a time in seconds")?;
    if (0.0..=1e6).contains(&s) {
        Ok(Duration::from_secs_f64(s))
    } else {
        Err(format!("{s} s is not within 0 to 1e6"))
    }
}

fn weights(text: &str) -> Result<Weights, String> {
    let values = text.split(',').map(|part| number(part, "a weight")).collect::<Result<Vec<_>, _>>()?;
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
