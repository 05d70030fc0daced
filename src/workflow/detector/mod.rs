//! `bench detector`: how well starts are found, on synthetic joints with known motions.

use rayon::prelude::*;

use crate::replay::{Rules, Score, conditions, detector_score};

/// How much to try.
#[derive(Debug, Clone)]
pub struct Inputs {
    /// Seed of the synthetic joints.
    pub seed: u64,
    /// Runs of one minute for each condition.
    pub runs: u64,
}

/// Scores the detector under every condition, in order; `done` is called after each.
pub fn run(inputs: &Inputs, done: impl Fn() + Sync) -> Vec<Score> {
    let rules = Rules::default();
    conditions()
        .par_iter()
        .map(|sensing| {
            let score = detector_score(inputs.seed, inputs.runs, sensing, &rules);
            done();
            score
        })
        .collect()
}
