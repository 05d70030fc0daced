//! NSGA-II: survival by front and crowding, mating by tournament.
//!
//! # References
//!
//! Deb, Pratap, Agarwal and Meyarivan 2002, doi 10.1109/4235.996017.

use super::{
    Population,
    crowding::CrowdingDistance,
    mating::{Mating, MatingContext, Pair, Permutation, winner},
    random::Random,
    sorting::Sorting,
    survival::{Feasibility, Ranking, Survival},
};

/// Fronts first, then the least crowded of the front that overflows.
#[derive(Debug, Clone, Default)]
pub struct Crowding {
    sorting: Sorting,
    feasibility: Feasibility,
    distance: CrowdingDistance,
    order: Vec<usize>,
}

impl Survival for Crowding {
    fn select(
        &mut self,
        merged: &Population,
        keep: usize,
        _: &mut Random,
        chosen: &mut Vec<usize>,
        ranking: &mut Ranking,
    ) {
        chosen.clear();
        ranking.clear();
        self.feasibility.split(merged);
        self.sorting.sort(merged, &self.feasibility.feasible);
        self.distance.reset(merged.len());
        let mut rank = 0;
        while chosen.len() < keep && rank < self.sorting.count() {
            self.distance.measure(merged, self.sorting.front(rank));
            self.order.clear();
            self.order.extend_from_slice(self.sorting.front(rank));
            self.distance.sort(&mut self.order, |i| i);
            chosen.extend(self.order.iter().take(keep - chosen.len()));
            ranking.rank.resize(chosen.len(), u32::try_from(rank).unwrap_or(u32::MAX));
            rank += 1;
        }
        chosen.extend(self.feasibility.infeasible.iter().take(keep - chosen.len()));
        ranking.rank.resize(chosen.len(), u32::MAX);
        ranking.crowding.extend(chosen.iter().map(|&i| self.distance.of(i)));
    }
}

/// Both parents win a tournament of two: by violation, then front, then crowding distance.
///
/// Differences to the published selection: the first of two is the next of a random order of all members, an
/// infeasible one already replaced by the winner by violation against a random member; the second is any member,
/// also the first itself, where the authors' program takes the next of a second order; and of two that are level the
/// first wins, not one by lot.
#[derive(Debug, Clone, Default)]
pub struct Tournament {
    permutation: Permutation,
    first: Vec<usize>,
}

impl Mating for Tournament {
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
        let mut rivalled = |a: usize| winner(context, a, rng.below(population.len()));
        pairs.extend(self.first.chunks_exact(2).map(|pair| Pair::of(rivalled(pair[0]), rivalled(pair[1]))));
    }
}
