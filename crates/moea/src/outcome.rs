//! What a run shows on its way and gives in the end.

use super::{Archive, Population};

/// What an observer sees after the first population and after every generation.
#[derive(Debug, Clone, Copy)]
pub struct Progress<'a> {
    /// Generations so far, the first population counted as one.
    pub generation: u64,
    /// Evaluations so far.
    pub evaluations: u64,
    /// The present population.
    pub population: &'a Population,
    /// The archive, if one is kept.
    pub archive: Option<&'a Archive>,
}

/// What a run found.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The last population. If nothing feasible was found it holds what violates least.
    pub population: Population,
    /// Feasible solutions of the whole run, none of which dominates another, if an archive was asked for; one that found room late may be
    /// dominated by what the run has dropped.
    pub archive: Option<Population>,
    /// Number of evaluations made.
    pub evaluations: u64,
    /// Number of generations, the first population included.
    pub generations: u64,
    /// The seed of the run.
    pub seed: u64,
}
