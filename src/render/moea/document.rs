//! As one JSON document.

use serde::Serialize;

use crate::{
    document,
    workflow::moea::{BASELINE, Cell, Inputs, Ruler, Study, Tally},
};

#[derive(Serialize)]
struct Document<'a> {
    format: &'static str,
    program: &'static str,
    first_seed: u64,
    seeds: u64,
    crossover_rate: f64,
    crossover_eta: f64,
    mutation_eta: f64,
    baseline: &'static str,
    notes: Vec<String>,
    problems: &'a [Ruler],
    cells: &'a [Cell],
    tallies: &'a [Tally],
}

/// Problems, then cells by problem, budget and algorithm.
pub fn moea_json(inputs: &Inputs, study: &Study) -> String {
    document::pretty(&Document {
        format: "hydrotrace.moea.v1",
        program: document::PROGRAM,
        first_seed: inputs.first_seed,
        seeds: inputs.seeds,
        crossover_rate: inputs.operators.crossover_rate,
        crossover_eta: inputs.operators.crossover_eta,
        mutation_eta: inputs.operators.mutation_eta,
        baseline: BASELINE,
        notes: super::notes(inputs),
        problems: &study.rulers,
        cells: &study.cells,
        tallies: &study.tallies,
    })
}
