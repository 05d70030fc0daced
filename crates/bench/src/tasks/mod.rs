//! `plan`: what the algorithms reach on tasks of the arm (the paper's Figure 5), and the paper's plans
//! beside ours (Table 3).

mod table_3;
mod task;

use std::{collections::BTreeMap, ops::ControlFlow};

use hydrotrace::{
    plan::{BEYOND, Found, Phase, Reference, Search, Setup, Timing, TimingProblem, search},
    render::kit::significant,
    task::Objective,
    units::degrees_from_radians,
    workflow::plan::PlanRequest,
};
use moea::{Algorithm, Archive, Budget, MoeaError, Population, Settings, optimise, silent};
use rayon::prelude::*;

use crate::study::{
    self, Column, Entrant, Form, Inputs, Measure, Panel, ReferenceFacts, Run, Searched, Study, Subject,
    Watch, decimals, quartiles,
};
pub use task::{TaskFailure, find};

/// The search that `hydrotrace plan` makes unless told otherwise.
pub const SEEDED: Entrant = Entrant {
    name: "seeded",
    title: "NSGA-III-FO with descents",
    algorithm: Algorithm::NSGA3_FO,
    seeded: true,
};

/// Objectives of a plan.
const OBJECTIVES: usize = Objective::OF_PLAN.len();

/// Plans of the reference front at most.
pub const REFERENCE_PLANS: usize = 1500;

/// Plans that a hypervolume is measured of at most: the members of the populations compared.
const MEASURED_PLANS: usize = 92;

/// The curve of all plans found ends here: what is missing to the reference front, as a share.
const LEAST: f64 = 1e-4;

const HYPERVOLUME: Measure = Measure {
    key: "hypervolume",
    heading: "HV, population",
    less: false,
    show: decimals,
    column: Column::Compared,
    tally: "HV, population",
};

/// The study.
pub const FORM: Form = Form {
    name: "plan",
    title: "Evolutionary algorithms on tasks of the arm",
    subject: "task",
    measures: &[
        HYPERVOLUME,
        Measure { key: "of_all", heading: "HV, all found", tally: "HV, all found", ..HYPERVOLUME },
        Measure {
            key: "share",
            heading: "of reference",
            show: |share, _| format!("{:.2} %", 100.0 * share),
            column: Column::Median,
            tally: "",
            ..HYPERVOLUME
        },
        Measure {
            key: "fastest_s",
            heading: "fastest s",
            less: true,
            show: significant,
            column: Column::Median,
            tally: "fastest",
        },
        Measure {
            key: "smoothest_rad_s3",
            heading: "smoothest deg/s3",
            less: true,
            show: |rad_s3, digits| significant(degrees_from_radians(rad_s3), digits),
            column: Column::Median,
            tally: "smoothest",
        },
    ],
    heading: "Hypervolume: medians (quartiles), and against the baseline",
    reference: (
        &["task"],
        &[
            "variables", "reference plans", "its HV", "fastest s", "smoothest deg/s3", "least power W",
            "feasible at first",
        ],
        reference_row,
    ),
    paper: table_3::sections,
    panels: [
        Panel {
            heading: "population: hypervolume (more is better)",
            logarithmic: false,
            measure: 0,
            drawn: |value| value,
        },
        Panel {
            heading: "all plans found: missing to the reference's hypervolume, logarithmic scale",
            logarithmic: true,
            measure: 2,
            drawn: |share| (1.0 - share).max(LEAST),
        },
    ],
};

fn reference_row(facts: &ReferenceFacts) -> Vec<String> {
    let ideal = |k: usize| facts.ideal.get(k).copied().unwrap_or(f64::NAN);
    let [q1, median, q3] = facts
        .searched
        .map_or([f64::NAN; 3], |searched| searched.feasible_at_first.map(|share| 100.0 * share));
    vec![
        facts.subject.clone(),
        facts.variables.to_string(),
        facts.members.to_string(),
        format!("{:.4}", facts.searched.map_or(f64::NAN, |searched| searched.hypervolume)),
        format!("{:.3}", ideal(0)),
        significant(degrees_from_radians(ideal(1)), 4),
        format!("{:.2}", ideal(2)),
        format!("{median:.1} % ({q1:.1}, {q3:.1})"),
    ]
}

/// A task, and the front of one long seeded search.
#[derive(Debug, Clone)]
pub struct ArmTask {
    setup: Setup,
    front: Vec<Timing>,
    reference: Reference,
    facts: ReferenceFacts,
    /// Whether the paper's Table 3 is of this task.
    in_table_3: bool,
}

impl ArmTask {
    /// Searches for the reference front. The seed of that search is fixed, so that the front is the same
    /// for any `seeds`.
    ///
    /// # Errors
    ///
    /// [`TaskFailure`] if no plan keeps all limits.
    pub fn new(
        name: String,
        request: PlanRequest,
        evaluations: u64,
        seeds: &[u64],
    ) -> Result<Self, TaskFailure> {
        let PlanRequest { setup, files, .. } = request;
        let budget = Budget::Evaluations(evaluations);
        let long = Search { budget, front: REFERENCE_PLANS, ..Search::default() };
        let Found { front, evaluations, .. } = search(&setup, &long, |_| ControlFlow::Continue(()))?;
        if front.is_empty() {
            return Err(TaskFailure::NoPlan { task: name });
        }
        let objectives = || front.iter().map(|timing| timing.objectives.plan());
        let reference = Reference::of(objectives());
        let at_first = seeds.iter().map(|&seed| at_first(&setup, seed)).collect::<Result<Vec<f64>, _>>()?;
        let facts = ReferenceFacts {
            subject: name,
            objectives: OBJECTIVES,
            variables: setup.interval_count(),
            members: front.len(),
            ideal: reference.ideal().plan().to_vec(),
            reference_point: reference.reference_point().plan().to_vec(),
            searched: Some(Searched {
                evaluations,
                hypervolume: reference.measure(objectives()),
                feasible_at_first: quartiles(&at_first),
            }),
        };
        Ok(Self { setup, front, reference, facts, in_table_3: files.task == task::SIMULATION })
    }

    /// Hypervolumes of at most [`MEASURED_PLANS`] of a population, spread evenly, and of all found; the
    /// latter as a share of the reference front's; the best of f1 and f2, infinite without a plan.
    fn values(&self, population: &Population, all: &Population) -> Vec<f64> {
        let mut archive = Archive::new(self.facts.variables, OBJECTIVES, MEASURED_PLANS);
        archive.extend(population);
        let thinned = archive.into_population();
        let [of_population, of_all] =
            [&thinned, all].map(|set| self.reference.measure(plans(set).into_iter()));
        let best = |k: usize| plans(all).iter().fold(f64::INFINITY, |best, f| best.min(f[k]));
        let whole = self.facts.searched.map_or(f64::NAN, |searched| searched.hypervolume);
        vec![of_population, of_all, of_all / whole, best(0), best(1)]
    }
}

/// Share of feasible plans in the first population of a seed, which is the same for all algorithms.
fn at_first(setup: &Setup, seed: u64) -> Result<f64, MoeaError> {
    let budget = Budget::Generations(1);
    let settings = Settings { algorithm: Algorithm::Nsga3, seed, budget, ..Settings::default() };
    let first = optimise(&TimingProblem::of(setup), &settings, silent)?.population;
    let feasible = (0..first.len()).filter(|&i| first.is_feasible(i)).count();
    Ok(feasible as f64 / first.len().max(1) as f64)
}

/// Objectives of the feasible plans.
fn plans(population: &Population) -> Vec<&[f64]> {
    let feasible = (0..population.len()).filter(|&i| population.is_feasible(i));
    feasible.map(|i| population.f(i)).collect()
}

/// Searches for the reference fronts, calling `done` after each; settings and notes of the study follow,
/// budgets, seeds and algorithms are the caller's, with [`SEEDED`] after them.
///
/// # Errors
///
/// [`TaskFailure`] if no plan of a task keeps all limits.
pub fn inputs(
    tasks: Vec<(String, PlanRequest)>,
    reference: u64,
    mut study: Inputs<()>,
    done: impl Fn() + Sync,
) -> Result<Inputs<ArmTask>, TaskFailure> {
    let seeds = study.seeds();
    let subjects = tasks
        .into_par_iter()
        .map(|(name, request)| {
            let task = ArmTask::new(name, request, reference, &seeds);
            done();
            task
        })
        .collect::<Result<Vec<_>, _>>()?;
    study.entrants.push(SEEDED);
    let notes = vec![
        "All but `seeded` start from random plans and get no descent, as the paper's; `seeded` is what `hydrotrace \
         plan` does: descents, then NSGA-III-FO, then descents, all counted as evaluations; in parentheses the \
         evaluations made if they are not those asked for."
            .to_owned(),
        format!(
            "HV is a share of the box from the reference front's best to {BEYOND} times its range; more is better. \
             First that of the last population, of `seeded` {MEASURED_PLANS} plans spread evenly over its front; then \
             that of all plans that a run found, at most {} as in `plan`, also as a share of the reference front's. \
             Fastest and smoothest (f1, f2) are medians of the ends found; less is better.",
            Search::default().front
        ),
        format!("The reference front is one seeded search of {reference} evaluations: no true front is known."),
        "Feasible at first: share of the first, random population that keeps all limits (quartiles).".to_owned(),
    ];
    Ok(study.of(subjects, BTreeMap::from([("reference_evaluations".to_owned(), reference as f64)]), notes))
}

/// Makes the study; the paper's Table 3 is of the task `simulation`.
///
/// # Errors
///
/// [`TaskFailure`] for settings that cannot be run.
pub fn run(inputs: &Inputs<ArmTask>, done: impl Fn() + Sync) -> Result<Study, TaskFailure> {
    let found = study::run(inputs, done)?;
    let simulation = inputs.subjects.iter().find(|task| task.in_table_3);
    let table_3 = simulation.map(|task| table_3::table_3(&task.setup, &task.front)).transpose()?;
    Ok(Study { table_3: table_3.unwrap_or_default(), ..found })
}

impl Subject for ArmTask {
    type Failure = TaskFailure;

    const FORM: Form = FORM;

    fn reference(&self) -> &ReferenceFacts {
        &self.facts
    }

    fn run(
        &self,
        entrant: &Entrant,
        evaluations: u64,
        seed: u64,
        mut watch: Watch,
    ) -> Result<Run, TaskFailure> {
        let Self { setup, .. } = self;
        let budget = Budget::Evaluations(evaluations);
        let algorithm = entrant.algorithm;
        let mut course = Vec::new();
        let mut see = |evaluations, population: &Population, all: &Population| {
            if watch.is_due(evaluations) {
                course.push((evaluations, self.values(population, all)));
            }
            ControlFlow::Continue(())
        };
        let settings = Search { algorithm, budget, seed, ..Search::default() };
        let (population, all, made) = if entrant.seeded {
            // The evolution shows its own archive alone, which begins with a part of the seeds.
            let mut seeds = Population::with_capacity(setup.interval_count(), OBJECTIVES, 0);
            let found = search(setup, &settings, |progress| {
                let mut all = progress.population.clone();
                match progress.phase {
                    Phase::Start => seeds = all.clone(),
                    Phase::Evolution => {
                        (0..seeds.len()).for_each(|i| all.push(seeds.x(i), seeds.f(i), seeds.violation(i)));
                    }
                    Phase::Polish => {}
                }
                see(progress.evaluations, &all, &all)
            })?;
            let mut front = Population::with_capacity(setup.interval_count(), OBJECTIVES, found.front.len());
            for timing in &found.front {
                front.push(&timing.interval_s, timing.objectives.plan(), timing.violation);
            }
            (front.clone(), front, found.evaluations)
        } else {
            let archive = settings.front;
            let settings = Settings { algorithm, budget, seed, archive, ..Settings::default() };
            let outcome = optimise(&TimingProblem::of(setup), &settings, |progress| {
                let all = progress.archive.map_or(progress.population, Archive::population);
                see(progress.evaluations, progress.population, all)
            })?;
            let all = outcome.archive.unwrap_or_else(|| outcome.population.clone());
            (outcome.population, all, outcome.evaluations)
        };
        let values = self.values(&population, &all);
        Ok(Run { values, members: plans(&population).len(), made, course, front: Vec::new() })
    }
}
