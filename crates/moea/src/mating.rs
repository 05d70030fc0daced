//! Who mates with whom.

use std::cmp::Ordering;

use super::{Population, random::Random, survival::Ranking};

/// The state of a run when parents are chosen.
#[derive(Debug, Clone, Copy)]
pub struct MatingContext<'a> {
    /// Members to choose from.
    pub population: &'a Population,
    /// The survival's findings on them.
    pub ranking: &'a Ranking,
    /// Share of the budget used, 0 to 1; `None` without a budget.
    pub progress: Option<f64>,
}

/// Two parents, and factors on the rates of crossover and mutation of their children.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// Index of the first parent.
    pub first: usize,
    /// Index of the second parent.
    pub second: usize,
    /// Factor on the crossover rate.
    pub crossover: f64,
    /// Factor on the mutation rate, but for children that repeat somebody; 0: none of them is mutated.
    pub mutation: f64,
}

impl Pair {
    /// Parents at full rates.
    pub fn of(first: usize, second: usize) -> Self {
        Self { first, second, crossover: 1.0, mutation: 1.0 }
    }
}

/// Chooses parents.
pub trait Mating: Send {
    /// Writes pairs of parents for at least `children` children, two children a pair, into `pairs`, which is empty. A pair of
    /// members that do not exist has none.
    fn pair(&mut self, context: &MatingContext<'_>, children: usize, rng: &mut Random, pairs: &mut Vec<Pair>);

    /// Number of offspring slots that are not filled by new children.
    fn reserved(&self) -> usize {
        0
    }
}

impl<M: Mating + ?Sized> Mating for Box<M> {
    fn pair(
        &mut self,
        context: &MatingContext<'_>,
        children: usize,
        rng: &mut Random,
        pairs: &mut Vec<Pair>,
    ) {
        (**self).pair(context, children, rng, pairs);
    }

    fn reserved(&self) -> usize {
        (**self).reserved()
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
        rng: &mut Random,
        out: &mut Vec<usize>,
    ) {
        let n = population.len();
        out.clear();
        while out.len() < count && n > 0 {
            self.order.clear();
            self.order.extend(0..n);
            rng.shuffle(&mut self.order);
            out.extend(self.order.iter().take(count - out.len()));
        }
        for first in out {
            *first = fitter(population, *first, rng);
        }
    }
}

/// `i`, or a random member that violates less: binary tournament on constraints alone
/// (Jain and Deb 2014). Draws nothing when `i` is feasible.
pub(super) fn fitter(population: &Population, i: usize, rng: &mut Random) -> usize {
    if population.is_feasible(i) {
        return i;
    }
    let other = rng.below(population.len());
    if population.violation(other) < population.violation(i) { other } else { i }
}

/// The winner of two by violation, then front, then crowding distance; `a` if they are level, as they are
/// without findings of a survival.
pub(super) fn winner(context: &MatingContext<'_>, a: usize, b: usize) -> usize {
    let MatingContext { population, ranking, .. } = context;
    let crowding = |i: usize| ranking.crowding.get(i).copied().unwrap_or(0.0);
    let order = population
        .violation(a)
        .total_cmp(&population.violation(b))
        .then(ranking.rank.get(a).cmp(&ranking.rank.get(b)))
        .then(crowding(b).total_cmp(&crowding(a)));
    if order == Ordering::Greater { b } else { a }
}

/// Mating of NSGA-III: members are drawn alike; of two infeasible ones the one that violates less.
#[derive(Debug, Clone, Default)]
pub struct Uniform {
    permutation: Permutation,
    first: Vec<usize>,
}

impl Mating for Uniform {
    fn pair(
        &mut self,
        context: &MatingContext<'_>,
        children: usize,
        rng: &mut Random,
        pairs: &mut Vec<Pair>,
    ) {
        let population = context.population;
        self.permutation.draw(population, 2 * children.div_ceil(2), rng, &mut self.first);
        pairs.clear();
        pairs.extend(self.first.chunks_exact(2).map(|pair| Pair::of(pair[0], pair[1])));
    }
}
