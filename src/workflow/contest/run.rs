//! Makes the searches.

use std::ops::ControlFlow;

use rayon::prelude::*;

use super::{
    ContestFailure, Entrant, Inputs, MEASURED_PLANS, REFERENCE_PLANS, Ruler, SEEDED, Study, Subject,
    published::table_3, study::assemble,
};
use crate::{
    moea::{Algorithm, Archive, Budget, MoeaError, Population, Settings, optimise, silent},
    plan::{Found, Phase, Reference, Search, Setup, Timing, TimingProblem, search},
    workflow::sample::{Watch, quartiles},
};

/// The runs of one cell.
#[derive(Debug)]
pub(super) struct Batch<'a> {
    pub(super) subject: &'a Subject,
    pub(super) ruler: &'a Ruler,
    pub(super) entrant: Entrant,
    pub(super) evaluations: u64,
    /// Whether the runs give a curve.
    pub(super) watched: bool,
    pub(super) runs: Vec<Run>,
    reference: &'a Reference,
}

/// What one seed gave.
#[derive(Debug)]
pub(super) struct Run {
    /// Of the last population and of all found.
    pub(super) hypervolume: [f64; 2],
    pub(super) members: usize,
    pub(super) made: u64,
    /// Best of each objective; infinite without a feasible plan.
    pub(super) best: [f64; 3],
    /// Evaluations and the hypervolumes after them.
    pub(super) course: Vec<(u64, [f64; 2])>,
}

/// Runs every algorithm on every task with every budget and seed; `done` is called after each search.
/// Searches share the cores; the findings do not depend on how many there are.
///
/// # Errors
///
/// [`ContestFailure`] for settings that cannot be run, or a task of which no plan keeps all limits.
pub fn run(inputs: &Inputs, done: impl Fn() + Sync) -> Result<Study, ContestFailure> {
    let mut budgets = inputs.evaluations.clone();
    budgets.sort_unstable();
    budgets.dedup();
    let seeds: Vec<u64> = (0..inputs.seeds).map(|k| inputs.first_seed.wrapping_add(k)).collect();
    let references: Vec<(Ruler, Reference, Vec<Timing>)> = inputs
        .subjects
        .par_iter()
        .map(|subject| {
            let reference = reference(subject, inputs.reference_evaluations, &seeds);
            done();
            reference
        })
        .collect::<Result<_, _>>()?;
    let entrants: Vec<Entrant> =
        inputs.contenders.iter().copied().map(Entrant::from).chain([SEEDED]).collect();
    let mut batches: Vec<Batch<'_>> = Vec::new();
    for (subject, (ruler, reference, _)) in inputs.subjects.iter().zip(&references) {
        for &evaluations in &budgets {
            let watched = inputs.steps > 0 && Some(&evaluations) == budgets.last();
            batches.extend(entrants.iter().map(|&entrant| Batch {
                subject,
                ruler,
                entrant,
                evaluations,
                watched,
                runs: Vec::new(),
                reference,
            }));
        }
    }
    let jobs: Vec<(&Batch<'_>, u64)> =
        batches.iter().flat_map(|batch| seeds.iter().map(move |&seed| (batch, seed))).collect();
    let runs: Vec<Run> = jobs
        .par_iter()
        .map(|&(batch, seed)| {
            let run = one(batch, seed, inputs.steps);
            done();
            run
        })
        .collect::<Result<_, _>>()?;
    let mut runs = runs.into_iter();
    for batch in &mut batches {
        batch.runs = runs.by_ref().take(seeds.len()).collect();
    }
    let printed = inputs.subjects.iter().zip(&references).find(|(subject, _)| subject.in_table_3);
    let table_3 =
        printed.map(|(subject, (_, _, front))| table_3(&subject.request.setup, front)).transpose()?;
    let rulers = references.iter().map(|(ruler, ..)| ruler.clone()).collect();
    Ok(assemble(rulers, &entrants, &batches, table_3))
}

/// The front that a task is measured against. Its seed is fixed, so that it is the same for any seeds.
fn reference(
    subject: &Subject,
    evaluations: u64,
    seeds: &[u64],
) -> Result<(Ruler, Reference, Vec<Timing>), ContestFailure> {
    let setup = &subject.request.setup;
    let budget = Budget::Evaluations(evaluations);
    let long = Search { budget, front: REFERENCE_PLANS, ..Search::default() };
    let Found { front, evaluations, .. } = search(setup, &long, |_| ControlFlow::Continue(()))?;
    if front.is_empty() {
        return Err(ContestFailure::NoPlan { task: subject.name.clone() });
    }
    let objectives = || front.iter().map(|timing| timing.objectives.plan());
    let reference = Reference::of(objectives());
    let at_first = seeds.iter().map(|&seed| at_first(setup, seed)).collect::<Result<Vec<f64>, _>>()?;
    let ruler = Ruler {
        task: subject.name.clone(),
        intervals: setup.interval_count(),
        evaluations,
        plans: front.len(),
        ideal: three(&reference.ideal()),
        reference_point: three(&reference.reference_point()),
        hypervolume: reference.measure(objectives()),
        feasible_at_first: quartiles(&at_first),
    };
    Ok((ruler, reference, front))
}

/// Share of feasible plans in the first population of a seed, which all algorithms have alike.
fn at_first(setup: &Setup, seed: u64) -> Result<f64, MoeaError> {
    let budget = Budget::Generations(1);
    let settings = Settings { algorithm: Algorithm::Nsga3, seed, budget, ..Settings::default() };
    let first = optimise(&TimingProblem::of(setup), &settings, silent)?.population;
    let feasible = (0..first.len()).filter(|&i| first.is_feasible(i)).count();
    Ok(feasible as f64 / first.len().max(1) as f64)
}

fn one(batch: &Batch<'_>, seed: u64, steps: u64) -> Result<Run, ContestFailure> {
    let setup = &batch.subject.request.setup;
    let budget = Budget::Evaluations(batch.evaluations);
    let Entrant { algorithm, seeded, .. } = batch.entrant;
    let mut watch = Watch::new(batch.evaluations, if batch.watched { steps } else { 0 });
    let mut course = Vec::new();
    let mut see = |evaluations, population: &Population, all: &Population| {
        if watch.is_due(evaluations) {
            course.push((evaluations, batch.measure(population, all)));
        }
        ControlFlow::Continue(())
    };
    let settings = Search { algorithm, budget, seed, ..Search::default() };
    let (population, all, made) = if seeded {
        // The evolution shows its own archive alone, which begins with a part of the seeds.
        let mut seeds = Population::with_capacity(setup.interval_count(), 3, 0);
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
        let mut front = Population::with_capacity(setup.interval_count(), 3, found.front.len());
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
    let hypervolume = batch.measure(&population, &all);
    let members = plans(&population).len();
    let mut best = [f64::INFINITY; 3];
    for f in plans(&all) {
        for (best, f) in best.iter_mut().zip(f) {
            *best = best.min(f);
        }
    }
    Ok(Run { hypervolume, members, made, best, course })
}

impl Batch<'_> {
    /// Hypervolumes of at most [`MEASURED_PLANS`] of a population, spread evenly, and of all found.
    fn measure(&self, population: &Population, all: &Population) -> [f64; 2] {
        let mut archive = Archive::new(self.ruler.intervals, 3, MEASURED_PLANS);
        archive.extend(population);
        let thinned = archive.into_population();
        [&thinned, all].map(|set| self.reference.measure(plans(set).iter().map(<[f64; 3]>::as_slice)))
    }
}

/// Objectives of the feasible plans.
fn plans(population: &Population) -> Vec<[f64; 3]> {
    let feasible = (0..population.len()).filter(|&i| population.is_feasible(i));
    feasible.filter_map(|i| <[f64; 3]>::try_from(population.f(i)).ok()).collect()
}

fn three(values: &crate::task::ByObjective) -> [f64; 3] {
    std::array::from_fn(|k| values.plan()[k])
}
