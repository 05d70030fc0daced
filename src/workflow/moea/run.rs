//! Makes the runs.

use std::ops::ControlFlow;

use rayon::prelude::*;

use super::{
    Inputs, Study,
    study::{Batch, assemble},
};
use crate::{
    moea::{
        Budget, Contender, MoeaError, Population, Settings,
        compare::{Quality, Yardstick},
        optimise,
    },
    workflow::sample::Watch,
};

/// Points of the true front that are asked for; a problem gives about as many.
const FRONT_POINTS: usize = 1000;

/// What one seed gave.
#[derive(Debug)]
pub(super) struct Run {
    pub(super) seed: u64,
    pub(super) quality: Quality,
    pub(super) members: usize,
    /// Evaluations and the quality after them.
    pub(super) course: Vec<(u64, Quality)>,
    /// Objectives of the front, if it is kept.
    pub(super) front: Vec<f64>,
}

/// Runs every algorithm on every problem with every budget and seed; `done` is called after
/// each run. Runs share the cores; the findings do not depend on how many there are.
///
/// # Errors
///
/// [`MoeaError`] when the operators or the number of objectives are beyond what can be run.
pub fn run(inputs: &Inputs, done: impl Fn() + Sync) -> Result<Study, MoeaError> {
    let mut budgets = inputs.evaluations.clone();
    budgets.sort_unstable();
    budgets.dedup();
    let yardsticks: Vec<Yardstick> =
        inputs.problems.par_iter().map(|problem| Yardstick::of(problem, FRONT_POINTS)).collect();
    let mut batches: Vec<Batch<'_>> = Vec::new();
    for (problem, yardstick) in inputs.problems.iter().zip(&yardsticks) {
        for &evaluations in &budgets {
            let watched = Some(&evaluations) == budgets.last();
            batches.extend(inputs.contenders.iter().map(|&contender| Batch {
                problem,
                yardstick,
                contender,
                evaluations,
                watched,
                runs: Vec::new(),
            }));
        }
    }
    let seeds: Vec<u64> = (0..inputs.seeds).map(|k| inputs.first_seed.wrapping_add(k)).collect();
    let jobs: Vec<(&Batch<'_>, u64)> =
        batches.iter().flat_map(|batch| seeds.iter().map(move |&seed| (batch, seed))).collect();
    let runs: Vec<Run> = jobs
        .par_iter()
        .map(|&(batch, seed)| {
            let run = one(batch, seed, inputs);
            done();
            run
        })
        .collect::<Result<_, _>>()?;
    let mut runs = runs.into_iter();
    for batch in &mut batches {
        batch.runs = runs.by_ref().take(seeds.len()).collect();
    }
    Ok(assemble(inputs, &yardsticks, &batches))
}

fn one(batch: &Batch<'_>, seed: u64, inputs: &Inputs) -> Result<Run, MoeaError> {
    let Contender { algorithm, .. } = batch.contender;
    let budget = Budget::Evaluations(batch.evaluations);
    let settings = Settings { algorithm, seed, budget, operators: inputs.operators, ..Settings::default() };
    let steps = if batch.watched { inputs.steps } else { 0 };
    let (mut course, mut watch) = (Vec::new(), Watch::new(batch.evaluations, steps));
    let outcome = optimise(batch.problem, &settings, |progress| {
        if watch.is_due(progress.evaluations) {
            course.push((progress.evaluations, batch.yardstick.measure(progress.population)));
        }
        ControlFlow::Continue(())
    })?;
    let population = &outcome.population;
    Ok(Run {
        seed,
        quality: batch.yardstick.measure(population),
        members: population.len(),
        course,
        front: if inputs.fronts { front(population) } else { Vec::new() },
    })
}

fn front(population: &Population) -> Vec<f64> {
    population.front().into_iter().flat_map(|i| population.f(i).iter().copied()).collect()
}
