//! Mating of U-NSGA-III: members of one niche compete.
//!
//! # References
//!
//! Seada and Deb 2016, doi 10.1109/TEVC.2015.2459718.

use std::cmp::Ordering;

use super::{
    mating::{Mating, MatingContext, Pair, Permutation},
    random::Random,
};

/// Both parents win a tournament of two by violation; of two feasible ones by front and distance to the
/// direction if they share it, else by lot. With one objective this selects as a plain genetic algorithm.
#[derive(Debug, Clone, Default)]
pub struct NicheTournament {
    permutation: Permutation,
    first: Vec<usize>,
}

impl Mating for NicheTournament {
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
        let mut rivalled = |a: usize| {
            let b = rng.below(population.len());
            match order(context, a, b) {
                Some(Ordering::Greater) => b,
                Some(_) => a,
                None => [a, b][rng.below(2)],
            }
        };
        pairs.extend(self.first.chunks_exact(2).map(|pair| Pair::of(rivalled(pair[0]), rivalled(pair[1]))));
    }
}

/// The better of two is less; none for two feasible members of different niches.
fn order(context: &MatingContext<'_>, a: usize, b: usize) -> Option<Ordering> {
    let MatingContext { population, ranking, .. } = context;
    let by_violation = population.violation(a).total_cmp(&population.violation(b));
    if by_violation.is_ne() || !population.is_feasible(a) {
        return Some(by_violation);
    }
    if ranking.direction.get(a) != ranking.direction.get(b) {
        return None;
    }
    let aside = |i: usize| ranking.aside.get(i).copied().unwrap_or(0.0);
    Some(ranking.rank.get(a).cmp(&ranking.rank.get(b)).then(aside(a).total_cmp(&aside(b))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Population, Ranking};

    #[test]
    fn niche_front_and_distance_decide_among_the_feasible_and_violation_among_the_others() {
        let mut population = Population::with_capacity(1, 2, 5);
        for violation in [0.0, 0.0, 0.0, 0.0, 2.0, 1.0] {
            population.push(&[violation], &[0.0; 2], violation);
        }
        let ranking = Ranking {
            rank: vec![0, 0, 1, 0, u32::MAX, u32::MAX],
            direction: vec![3, 3, 3, 4, usize::MAX, usize::MAX],
            aside: vec![0.1, 0.2, 0.0, 0.0, f64::INFINITY, f64::INFINITY],
            ..Ranking::default()
        };
        let context = MatingContext { population: &population, ranking: &ranking, progress: None };
        let (less, greater) = (Some(Ordering::Less), Some(Ordering::Greater));
        for (a, b, want) in
            [(0, 1, less), (1, 2, less), (2, 0, greater), (0, 3, None), (3, 4, less), (4, 5, greater)]
        {
            assert_eq!(order(&context, a, b), want, "{a} {b}");
            assert_eq!(order(&context, b, a), want.map(Ordering::reverse), "{b} {a}");
        }
    }
}
