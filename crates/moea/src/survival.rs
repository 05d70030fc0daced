//! What selection knows of the members it kept, and the contract of selecting.

use rand_chacha::ChaCha8Rng;

use super::Population;

/// What a survival found out about each survivor, `[n]` each where it applies.
#[derive(Debug, Clone, Default)]
pub(super) struct Standing {
    /// Front of the member, 0 is best.
    pub(super) rank: Vec<u32>,
    /// Crowding distance within the front.
    pub(super) crowding: Vec<f64>,
    /// Reference direction the member is associated with.
    pub(super) direction: Vec<usize>,
    /// Signed distance to the reference plane in normalised objectives.
    pub(super) plane: Vec<f64>,
}

impl Standing {
    pub(super) fn clear(&mut self) {
        self.rank.clear();
        self.crowding.clear();
        self.direction.clear();
        self.plane.clear();
    }
}

/// Chooses who lives on.
pub(super) trait Survival {
    /// Writes the indices of `keep` members (all, if fewer) of `merged` into `chosen`, and what
    /// is known of them into `standing`.
    fn select(
        &mut self,
        merged: &Population,
        keep: usize,
        rng: &mut ChaCha8Rng,
        chosen: &mut Vec<usize>,
        standing: &mut Standing,
    );
}

/// Feasible members of a population, and the others by growing violation.
#[derive(Debug, Clone, Default)]
pub(super) struct Feasibility {
    pub(super) feasible: Vec<usize>,
    pub(super) infeasible: Vec<usize>,
}

impl Feasibility {
    pub(super) fn split(&mut self, population: &Population) {
        self.feasible.clear();
        self.infeasible.clear();
        for i in 0..population.len() {
            if population.is_feasible(i) {
                self.feasible.push(i);
            } else {
                self.infeasible.push(i);
            }
        }
        self.infeasible.sort_unstable_by(|&a, &b| {
            population.violation(a).total_cmp(&population.violation(b)).then(a.cmp(&b))
        });
    }
}
