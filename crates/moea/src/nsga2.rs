//! NSGA-II: survival by front and crowding, mating by tournament.
//!
//! # References
//!
//! Deb, Pratap, Agarwal and Meyarivan 2002, doi 10.1109/4235.996017.

use std::cmp::Ordering;

use super::{
    Population,
    mating::{Mating, MatingContext, Pair, Permutation},
    random::Random,
    sorting::Sorting,
    survival::{Feasibility, Ranking, Survival},
};

/// Fronts first, then the least crowded of the front that overflows.
#[derive(Debug, Clone, Default)]
pub struct Crowding {
    sorting: Sorting,
    feasibility: Feasibility,
    /// By member of the merged population.
    distance: Vec<f64>,
    order: Vec<usize>,
}

impl Crowding {
    /// Crowding distances within one front.
    fn spread(&mut self, merged: &Population, rank: usize) {
        let front = self.sorting.front(rank);
        for &i in front {
            self.distance[i] = 0.0;
        }
        for k in 0..merged.objectives() {
            self.order.clear();
            self.order.extend_from_slice(front);
            let value = |i: usize| merged.f(i)[k];
            self.order.sort_unstable_by(|&a, &b| value(a).total_cmp(&value(b)).then(a.cmp(&b)));
            let (Some(&first), Some(&last)) = (self.order.first(), self.order.last()) else { return };
            let range = value(last) - value(first);
            self.distance[first] = f64::INFINITY;
            self.distance[last] = f64::INFINITY;
            if range > 0.0 {
                for three in self.order.windows(3) {
                    self.distance[three[1]] += (value(three[2]) - value(three[0])) / range;
                }
            }
        }
    }
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
        self.distance.clear();
        self.distance.resize(merged.len(), 0.0);
        let mut rank = 0;
        while chosen.len() < keep && rank < self.sorting.count() {
            self.spread(merged, rank);
            self.order.clear();
            self.order.extend_from_slice(self.sorting.front(rank));
            let distance = &self.distance;
            self.order.sort_unstable_by(|&a, &b| distance[b].total_cmp(&distance[a]).then(a.cmp(&b)));
            chosen.extend(self.order.iter().take(keep - chosen.len()));
            ranking.rank.resize(chosen.len(), u32::try_from(rank).unwrap_or(u32::MAX));
            rank += 1;
        }
        chosen.extend(self.feasibility.infeasible.iter().take(keep - chosen.len()));
        ranking.rank.resize(chosen.len(), u32::MAX);
        ranking.crowding.extend(chosen.iter().map(|&i| self.distance[i]));
    }
}

/// Both parents win a tournament of two.
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
        let (population, ranking) = (context.population, context.ranking);
        self.permutation.draw(population, 2 * children.div_ceil(2), rng, &mut self.first);
        pairs.clear();
        let mut winner = |a: usize| {
            let b = rng.below(population.len());
            let order = population
                .violation(a)
                .total_cmp(&population.violation(b))
                .then(ranking.rank[a].cmp(&ranking.rank[b]))
                .then(ranking.crowding[b].total_cmp(&ranking.crowding[a]));
            if order == Ordering::Greater { b } else { a }
        };
        for pair in self.first.chunks_exact(2) {
            let (first, second) = (winner(pair[0]), winner(pair[1]));
            pairs.push(Pair::of(first, second));
        }
    }
}
