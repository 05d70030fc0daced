//! Who mates with whom.

use rand_chacha::ChaCha8Rng;

use super::{
    Population,
    survival::Standing,
    variation::{below, shuffle},
};

/// What is known when parents are chosen.
pub(super) struct Courtship<'a> {
    pub(super) population: &'a Population,
    pub(super) standing: &'a Standing,
    /// Share of the budget used, 0 to 1, if there is a budget.
    pub(super) progress: Option<f64>,
}

/// Two parents, and factors on the rates of crossover and mutation of their children.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pair {
    pub(super) first: usize,
    pub(super) second: usize,
    pub(super) crossover: f64,
    pub(super) mutation: f64,
}

impl Pair {
    /// Parents at full rates.
    pub(super) fn of(first: usize, second: usize) -> Self {
        Self { first, second, crossover: 1.0, mutation: 1.0 }
    }
}

/// Chooses parents.
pub(super) trait Mating {
    /// Writes pairs of parents for at least `children` children, two children a pair.
    fn pair(
        &mut self,
        courtship: &Courtship<'_>,
        children: usize,
        rng: &mut ChaCha8Rng,
        pairs: &mut Vec<Pair>,
    );

    /// Number of offspring slots that are not filled by new children.
    fn reserved(&self) -> usize {
        0
    }
}

/// Every member in random order is a first parent; its mate is any member.
#[derive(Debug, Clone, Default)]
pub(super) struct Permutation {
    order: Vec<usize>,
}

impl Permutation {
    /// The next `count` members of endless random permutations, less feasible ones replaced
    /// by the winner against another.
    pub(super) fn draw(
        &mut self,
        population: &Population,
        count: usize,
        rng: &mut ChaCha8Rng,
        out: &mut Vec<usize>,
    ) {
        let n = population.len();
        out.clear();
        while out.len() < count && n > 0 {
            self.order.clear();
            self.order.extend(0..n);
            shuffle(&mut self.order, rng);
            out.extend(self.order.iter().take(count - out.len()));
        }
        for first in out {
            *first = fitter(population, *first, rng);
        }
    }
}

/// `i`, or a random member that violates less: binary tournament on constraints alone
/// (Jain and Deb 2014). Draws nothing when `i` is feasible.
pub(super) fn fitter(population: &Population, i: usize, rng: &mut ChaCha8Rng) -> usize {
    if population.is_feasible(i) {
        return i;
    }
    let other = below(population.len(), rng);
    if population.violation(other) < population.violation(i) { other } else { i }
}

/// Mating of NSGA-III: nobody is preferred but for feasibility.
#[derive(Debug, Clone, Default)]
pub(super) struct Uniform {
    permutation: Permutation,
    first: Vec<usize>,
}

impl Mating for Uniform {
    fn pair(
        &mut self,
        courtship: &Courtship<'_>,
        children: usize,
        rng: &mut ChaCha8Rng,
        pairs: &mut Vec<Pair>,
    ) {
        let population = courtship.population;
        self.permutation.draw(population, 2 * children.div_ceil(2), rng, &mut self.first);
        pairs.clear();
        pairs.extend(self.first.chunks_exact(2).map(|pair| Pair::of(pair[0], pair[1])));
    }
}
