//! One study: every algorithm on every subject with every budget and seed.

mod picture;
mod rows;
mod run;
mod sample;
mod tables;
mod watch;

use std::collections::BTreeMap;

use hydrotrace::{document::pretty, render::kit::Section};
use moea::{Algorithm, NamedAlgorithm};
use serde::{Deserialize, Serialize};

pub use picture::curve_svg;
pub use rows::{curves_csv, front_csv};
pub use run::run;
pub(crate) use sample::finite;
pub use sample::{Against, Sample, Verdict, quartiles};
pub use tables::{decimals, document};
pub use watch::Watch;

/// Fewer seeds than this say little.
pub const FEW_SEEDS: u64 = 10;

/// What the algorithms are run on.
pub trait Subject: Sync {
    /// The study that it belongs to.
    const FORM: Form;

    /// Why a run fails.
    type Failure: Send;

    /// What the runs are measured against.
    fn reference(&self) -> &ReferenceFacts;

    /// Makes one run. `watch` says when to measure for the curve.
    ///
    /// # Errors
    ///
    /// Settings that the algorithm refuses.
    fn run(&self, entrant: &Entrant, evaluations: u64, seed: u64, watch: Watch)
    -> Result<Run, Self::Failure>;

    /// What the paper prints of this cell.
    fn published(&self, algorithm: &str, evaluations: u64) -> Vec<Published> {
        let _ = (algorithm, evaluations);
        Vec::new()
    }
}

/// The cells of a reference in a table.
pub type ReferenceRow = fn(&ReferenceFacts) -> Vec<String>;

/// What is the same for all subjects of a study.
#[derive(Debug, Clone, Copy)]
pub struct Form {
    /// Its name on the command line.
    pub name: &'static str,
    /// Title of the tables.
    pub title: &'static str,
    /// What a subject is called.
    pub subject: &'static str,
    /// One row a measure of a run.
    pub measures: &'static [Measure],
    /// Heading of the table of measures.
    pub heading: &'static str,
    /// Columns of the table of references that are words, those that are numbers, and a row.
    pub reference: (&'static [&'static str], &'static [&'static str], ReferenceRow),
    /// The paper's figures beside ours.
    pub paper: fn(&Study) -> Vec<Section>,
    /// Charts of the curves.
    pub panels: [Panel; 2],
}

/// A number that a run is judged by.
#[derive(Debug, Clone, Copy)]
pub struct Measure {
    /// In documents and CSV.
    pub key: &'static str,
    /// In tables.
    pub heading: &'static str,
    /// Whether less is better.
    pub less: bool,
    /// The value with so many digits, in the unit of the heading.
    pub show: fn(f64, u8) -> String,
    /// What the table of cells shows.
    pub column: Column,
    /// Heading in the table of wins, ties and losses; empty to leave it out.
    pub tally: &'static str,
}

/// What the table of cells shows of a measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Column {
    /// Median, quartiles and the comparison with the baseline.
    Compared,
    /// The median.
    Median,
}

/// One chart of the curves.
#[derive(Debug, Clone, Copy)]
pub struct Panel {
    /// Above it.
    pub heading: &'static str,
    /// Whether its axis is logarithmic.
    pub logarithmic: bool,
    /// Place among the measures.
    pub measure: usize,
    /// What is drawn of the value.
    pub drawn: fn(f64) -> f64,
}

/// An algorithm as it is run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Entrant {
    /// As written to files.
    pub name: &'static str,
    /// As in pictures.
    pub title: &'static str,
    /// The evolutionary algorithm.
    pub algorithm: Algorithm,
    /// Whether it starts from descents and ends with them.
    pub seeded: bool,
}

impl From<NamedAlgorithm> for Entrant {
    fn from(NamedAlgorithm { name, title, algorithm }: NamedAlgorithm) -> Self {
        Self { name, title, algorithm, seeded: false }
    }
}

/// What one seed gave.
#[derive(Debug, Clone, Default)]
pub struct Run {
    /// By measure.
    pub values: Vec<f64>,
    /// Members that the values are of; 0 if none is feasible.
    pub members: usize,
    /// Evaluations made.
    pub made: u64,
    /// Evaluations, and the values after them.
    pub course: Vec<(u64, Vec<f64>)>,
    /// Objectives of the front, `[n][objectives]`.
    pub front: Vec<f64>,
}

/// What to run.
#[derive(Debug, Clone)]
pub struct Inputs<S> {
    /// In the order of the findings.
    pub subjects: Vec<S>,
    /// In the order of the findings.
    pub entrants: Vec<Entrant>,
    /// Budgets. Each is a run of its own, because the focus of NSGA-III-FO fades over the budget.
    pub evaluations: Vec<u64>,
    /// Name of the algorithm that the others are compared with.
    pub baseline: String,
    /// First seed.
    pub first_seed: u64,
    /// Number of seeds, which follow one another.
    pub seeds: u64,
    /// Steps of the curves, which the runs of the largest budget give; 0 for no curves.
    pub steps: u64,
    /// Whether to keep every run's front.
    pub fronts: bool,
    /// Further settings by name, for the document.
    pub settings: BTreeMap<String, f64>,
    /// What a reader must know, beside what holds for every study.
    pub notes: Vec<String>,
}

impl Inputs<()> {
    /// The same on subjects, with their settings and notes.
    pub fn of<S>(self, subjects: Vec<S>, settings: BTreeMap<String, f64>, notes: Vec<String>) -> Inputs<S> {
        let Inputs { entrants, evaluations, baseline, first_seed, seeds, steps, fronts, .. } = self;
        Inputs {
            subjects,
            entrants,
            evaluations,
            baseline,
            first_seed,
            seeds,
            steps,
            fronts,
            settings,
            notes,
        }
    }
}

impl<S> Inputs<S> {
    /// Number of runs to make.
    pub fn runs(&self) -> u64 {
        let cells = self.subjects.len() * self.entrants.len() * self.evaluations.len();
        self.seeds.saturating_mul(cells as u64)
    }

    /// The seeds.
    pub fn seeds(&self) -> Vec<u64> {
        (0..self.seeds).map(|k| self.first_seed.wrapping_add(k)).collect()
    }
}

/// What was found, and the document of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Study {
    /// Always [`FORMAT`].
    pub format: String,
    /// Name and version of the program that wrote it.
    pub program: String,
    /// `moea` or `plan`.
    pub study: String,
    /// First seed.
    pub first_seed: u64,
    /// Number of seeds.
    pub seeds: u64,
    /// Name of the algorithm that the others are compared with.
    pub baseline: String,
    /// Further settings by name.
    pub settings: BTreeMap<String, f64>,
    /// What a reader must know.
    pub notes: Vec<String>,
    /// Subjects and what their runs are measured against.
    pub references: Vec<ReferenceFacts>,
    /// By subject, budget and algorithm.
    pub cells: Vec<Cell>,
    /// Cells won, tied and lost by each algorithm but the baseline.
    pub tallies: Vec<Tally>,
    /// The paper's Table 3 beside ours, if its task was a subject.
    pub table_3: Vec<PaperPlan>,
    /// By subject and algorithm.
    #[serde(skip)]
    pub curves: Vec<Curve>,
    /// By subject, budget, algorithm and seed.
    #[serde(skip)]
    pub fronts: Vec<Front>,
}

/// Format of the document.
pub const FORMAT: &str = "hydrotrace.study.v1";

impl Study {
    /// As JSON. Times are seconds, jerk rad/s³, power W; a value that is not finite is null.
    pub fn json(&self) -> String {
        pretty(self)
    }
}

/// A subject, and what its runs are measured against.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ReferenceFacts {
    /// Name of the subject.
    pub subject: String,
    /// Number of objectives.
    pub objectives: usize,
    /// Number of variables.
    pub variables: usize,
    /// Members of the reference front.
    pub members: usize,
    /// Where the box begins: the best of each objective, `[objectives]`.
    pub ideal: Vec<f64>,
    /// Where the box ends: the hypervolume's reference point, `[objectives]`.
    pub reference_point: Vec<f64>,
    /// Of a reference front that was searched for.
    pub searched: Option<Searched>,
}

/// How a reference front was found.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Searched {
    /// Evaluations that it took.
    pub evaluations: u64,
    /// Its hypervolume as a share of the box.
    pub hypervolume: f64,
    /// Share of feasible members in the first, random population: quartiles over the seeds.
    pub feasible_at_first: [f64; 3],
}

/// One algorithm on one subject with one budget.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Cell {
    /// Name of the subject.
    pub subject: String,
    /// Budget.
    pub evaluations: u64,
    /// Name of the algorithm.
    pub algorithm: String,
    /// Most evaluations that a run made.
    pub made: u64,
    /// Most members that a run's values are of.
    pub members: usize,
    /// Number of runs.
    pub seeds: u64,
    /// Runs that found something feasible.
    pub feasible: u64,
    /// By key of the measure.
    pub samples: BTreeMap<String, Sample>,
    /// What the paper prints here.
    pub published: Vec<Published>,
}

/// Cells won, tied and lost.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Tally {
    /// Name of the algorithm.
    pub algorithm: String,
    /// Wins, ties and losses by key of the measure.
    pub counts: BTreeMap<String, [usize; 3]>,
}

/// What the paper prints of a cell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Published {
    /// IGD of ten runs.
    Table1 {
        /// Mean.
        mean: f64,
        /// The number after the plus-minus sign.
        spread: f64,
    },
    /// A point of the hypervolume's curves.
    Figure3 {
        /// The paper's words, in short.
        said: String,
        /// Hypervolume of another implementation at PlatEMO's defaults (12 variables, 91 members), if
        /// it was run there.
        platemo_defaults: Option<f64>,
    },
}

/// A plan of the paper's Table 3, or ours beside it. A row without a plan has none of the values measured.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PaperPlan {
    /// Whose it is.
    pub plan: String,
    /// The paper's f2, which it prints in N.
    pub printed_f2: Option<f64>,
    /// The paper's f3, which it prints in J.
    pub printed_f3: Option<f64>,
    /// Arrival at each key point, s.
    pub times_s: Vec<f64>,
    /// Duration, s.
    pub duration_s: Option<f64>,
    /// RMS jerk, rad/s³.
    pub rms_jerk_rad_s3: Option<f64>,
    /// RMS power, W.
    pub rms_power_w: Option<f64>,
    /// Number of limits that it breaks.
    pub limits_broken: Option<usize>,
    /// The limit that it comes nearest to, in words.
    pub worst_limit: Option<String>,
}

/// The course of one algorithm on one subject.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Name of the subject.
    pub subject: String,
    /// Number of objectives.
    pub objectives: usize,
    /// The algorithm.
    pub entrant: Entrant,
    /// Number of runs.
    pub seeds: u64,
    /// Evaluations, and the quartiles of each measure after them.
    pub points: Vec<(u64, Vec<[f64; 3]>)>,
}

/// The front of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Front {
    /// As the file is called, without its ending.
    pub name: String,
    /// Number of objectives.
    pub objectives: usize,
    /// `[n][objectives]` in one vector.
    pub points: Vec<f64>,
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_committed_schema_is_that_of_the_document() {
        crate::schema::is_committed::<super::Study>("study.v1.schema.json", "Study");
    }
}
