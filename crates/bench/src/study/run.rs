//! Makes the runs and summarises them.

use hydrotrace::document::PROGRAM;
use rayon::prelude::*;

use super::{
    Cell, Curve, Entrant, FEW_SEEDS, FORMAT, Front, Inputs, Run, Sample, Study, Subject, Tally, Watch,
    sample::{quartiles, tallied},
};

/// The runs of one cell, a seed each.
struct Batch<'a, S> {
    subject: &'a S,
    entrant: Entrant,
    evaluations: u64,
    /// Steps of the curve; 0 for no curve.
    steps: u64,
    runs: Vec<Run>,
}

/// Runs every algorithm on every subject with every budget and seed; calls `done` after each run.
///
/// Runs share the cores; the findings do not depend on how many there are.
///
/// # Errors
///
/// The first failure of a run.
pub fn run<S: Subject>(inputs: &Inputs<S>, done: impl Fn() + Sync) -> Result<Study, S::Failure> {
    let mut budgets = inputs.evaluations.clone();
    budgets.sort_unstable();
    budgets.dedup();
    let mut batches: Vec<Batch<'_, S>> = Vec::new();
    for subject in &inputs.subjects {
        for &evaluations in &budgets {
            let steps = if Some(&evaluations) == budgets.last() { inputs.steps } else { 0 };
            batches.extend(inputs.entrants.iter().map(|&entrant| Batch {
                subject,
                entrant,
                evaluations,
                steps,
                runs: Vec::new(),
            }));
        }
    }
    let seeds = inputs.seeds();
    let jobs: Vec<(&Batch<'_, S>, u64)> =
        batches.iter().flat_map(|batch| seeds.iter().map(move |&seed| (batch, seed))).collect();
    let runs: Vec<Run> = jobs
        .par_iter()
        .map(|&(batch, seed)| {
            let watch = Watch::new(batch.evaluations, batch.steps);
            let run = batch.subject.run(&batch.entrant, batch.evaluations, seed, watch);
            done();
            run
        })
        .collect::<Result<_, _>>()?;
    let mut runs = runs.into_iter();
    for batch in &mut batches {
        batch.runs = runs.by_ref().take(seeds.len()).collect();
    }
    Ok(summary(inputs, &batches))
}

fn summary<S: Subject>(inputs: &Inputs<S>, batches: &[Batch<'_, S>]) -> Study {
    let cells: Vec<Cell> = batches
        .iter()
        .map(|batch| {
            let rival = batches.iter().find(|other| {
                other.entrant.name == inputs.baseline
                    && std::ptr::eq(other.subject, batch.subject)
                    && other.evaluations == batch.evaluations
            });
            cell(batch, rival.filter(|_| batch.entrant.name != inputs.baseline))
        })
        .collect();
    Study {
        format: FORMAT.to_owned(),
        program: PROGRAM.to_owned(),
        study: S::FORM.name.to_owned(),
        first_seed: inputs.first_seed,
        seeds: inputs.seeds,
        baseline: inputs.baseline.clone(),
        settings: inputs.settings.clone(),
        notes: notes(inputs),
        references: inputs.subjects.iter().map(|subject| subject.reference().clone()).collect(),
        tallies: inputs.entrants.iter().filter_map(|entrant| tally::<S>(entrant.name, &cells)).collect(),
        cells,
        table_3: Vec::new(),
        curves: batches.iter().filter(|batch| batch.steps > 0).map(curve).collect(),
        fronts: batches.iter().filter(|_| inputs.fronts).flat_map(|batch| fronts(batch, inputs)).collect(),
    }
}

fn notes<S>(inputs: &Inputs<S>) -> Vec<String> {
    let Inputs { first_seed: first, seeds, baseline, .. } = inputs;
    let which = match seeds {
        1 => format!("One seed, {first}; a run of its own for each budget."),
        n => format!(
            "Medians and quartiles of {n} seeds, {first} to {}; a run of its own for each budget.",
            first.wrapping_add(n - 1)
        ),
    };
    let mut notes = vec![which];
    notes.extend(inputs.notes.iter().cloned());
    notes.push(format!(
        "Against {baseline}: win or loss if the two-sided rank-sum test gives p < 0.05, not corrected for the number \
         of comparisons; A is the probability that a run is better than one of {baseline} (Vargha and Delaney), 0.5 \
         for no difference."
    ));
    if *seeds < FEW_SEEDS {
        notes.push(format!("Fewer than {FEW_SEEDS} seeds: quartiles and p say little; --seeds gives more."));
    }
    notes
}

fn cell<S: Subject>(batch: &Batch<'_, S>, rival: Option<&Batch<'_, S>>) -> Cell {
    let sample = |k: usize| {
        let values = |batch: &Batch<'_, S>| batch.runs.iter().map(|run| run.values[k]).collect::<Vec<_>>();
        Sample::of(&values(batch), rival.map(values).as_deref(), S::FORM.measures[k].less)
    };
    let measures = S::FORM.measures.iter().enumerate();
    Cell {
        subject: batch.subject.reference().subject.clone(),
        evaluations: batch.evaluations,
        algorithm: batch.entrant.name.to_owned(),
        made: batch.runs.iter().map(|run| run.made).max().unwrap_or(0),
        members: batch.runs.iter().map(|run| run.members).max().unwrap_or(0),
        seeds: batch.runs.len() as u64,
        feasible: batch.runs.iter().filter(|run| run.members > 0).count() as u64,
        samples: measures.map(|(k, measure)| (measure.key.to_owned(), sample(k))).collect(),
        published: batch.subject.published(batch.entrant.name, batch.evaluations),
    }
}

fn tally<S: Subject>(algorithm: &str, cells: &[Cell]) -> Option<Tally> {
    let own = || cells.iter().filter(|cell| cell.algorithm == algorithm);
    let measures = S::FORM.measures.iter().filter(|measure| !measure.tally.is_empty());
    let counts = measures.map(|measure| {
        let samples = own().filter_map(|cell| cell.samples.get(measure.key));
        (measure.key.to_owned(), tallied(samples))
    });
    let compared = own().any(|cell| cell.samples.values().any(|sample| sample.against.is_some()));
    compared.then(|| Tally { algorithm: algorithm.to_owned(), counts: counts.collect() })
}

fn curve<S: Subject>(batch: &Batch<'_, S>) -> Curve {
    let steps = batch.runs.iter().map(|run| run.course.len()).min().unwrap_or(0);
    let point = |step: usize| {
        let at = || batch.runs.iter().filter_map(move |run| run.course.get(step));
        let of = |k: usize| quartiles(&at().map(|(_, values)| values[k]).collect::<Vec<_>>());
        let evaluations = at().map(|(evaluations, _)| *evaluations).max().unwrap_or(0);
        (evaluations, (0..S::FORM.measures.len()).map(of).collect())
    };
    let reference = batch.subject.reference();
    Curve {
        subject: reference.subject.clone(),
        objectives: reference.objectives,
        entrant: batch.entrant,
        seeds: batch.runs.len() as u64,
        points: (0..steps).map(point).collect(),
    }
}

fn fronts<'a, S: Subject>(batch: &'a Batch<'_, S>, inputs: &Inputs<S>) -> impl Iterator<Item = Front> + 'a {
    let reference = batch.subject.reference();
    batch.runs.iter().zip(inputs.seeds()).map(move |(run, seed)| Front {
        name: format!(
            "{}-{}-{}-{seed}",
            reference.subject.to_lowercase(),
            batch.entrant.name,
            batch.evaluations
        ),
        objectives: reference.objectives,
        points: run.front.clone(),
    })
}
