//! MSOPS-II: many single-objective searches along target vectors that follow the population.
//!
//! # References
//!
//! Hughes 2007, doi 10.1109/CEC.2007.4424985. Differences: the mate of each member comes from
//! the non-dominated members of the population in place of an archive without bounds.

use super::{
    Population,
    mating::{Mating, MatingContext, Pair, fitter},
    random::Random,
    sorting::Sorting,
    survival::{Feasibility, Ranking, Survival},
};

/// Exponent of the angle in vector angle distance scaling.
const SHARPNESS: i32 = 100;

/// Ranks members by how well they do on the target they do best on, relative to the runner-up.
#[derive(Debug, Clone, Default)]
pub(super) struct Targets {
    feasibility: Feasibility,
    /// Objective vectors the targets go through, `[count][m]`.
    through: Vec<f64>,
    low: Vec<f64>,
    high: Vec<f64>,
    scores: Vec<f64>,
    fitness: Vec<f64>,
}

impl Targets {
    /// Adds feasible members to the targets and drops those that point where others do.
    fn follow(&mut self, merged: &Population, keep: usize) {
        let m = merged.objectives();
        for &i in &self.feasibility.feasible {
            self.through.extend_from_slice(merged.f(i));
        }
        let n = self.through.len() / m;
        let ideal: Vec<f64> = (0..m)
            .map(|k| self.through.iter().skip(k).step_by(m).fold(f64::INFINITY, |low, f| low.min(*f)))
            .collect();
        let mut unit: Vec<f64> = Vec::with_capacity(n * m);
        for f in self.through.chunks_exact(m) {
            let length = f.iter().zip(&ideal).map(|(f, z)| (f - z).powi(2)).sum::<f64>().sqrt();
            unit.extend(f.iter().zip(&ideal).map(|(f, z)| if length > 0.0 { (f - z) / length } else { 0.0 }));
        }
        let cosine = |a: usize, b: usize| -> f64 {
            unit[a * m..][..m].iter().zip(&unit[b * m..][..m]).map(|(a, b)| a * b).sum()
        };
        let mut alive = vec![true; n];
        let nearest = |i: usize, alive: &[bool]| {
            let others = (0..n).filter(|&j| j != i && alive[j]).map(|j| (cosine(i, j), j));
            // Of equals the first, who goes last: few then have to look for another.
            others.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1))).unwrap_or((-1.0, i))
        };
        let mut near: Vec<(f64, usize)> = (0..n).map(|i| nearest(i, &alive)).collect();
        for _ in keep..n {
            let closest = (0..n).filter(|&i| alive[i]).max_by(|&a, &b| near[a].0.total_cmp(&near[b].0));
            let Some(gone) = closest else { break };
            alive[gone] = false;
            for i in 0..n {
                if alive[i] && near[i].1 == gone {
                    near[i] = nearest(i, &alive);
                }
            }
        }
        let kept: Vec<f64> = self
            .through
            .chunks_exact(m)
            .zip(&alive)
            .filter(|(_, alive)| **alive)
            .flat_map(|(f, _)| f.iter().copied())
            .collect();
        self.through = kept;
    }

    /// Fitness of each feasible member, smaller is better, from both scores on all targets.
    fn rate(&mut self, merged: &Population) {
        let (m, feasible) = (merged.objectives(), &self.feasibility.feasible);
        let range = |k: usize, start: f64, pick: fn(f64, f64) -> f64| {
            feasible.iter().map(|&i| merged.f(i)[k]).fold(start, pick)
        };
        self.low = (0..m).map(|k| range(k, f64::INFINITY, f64::min)).collect();
        self.high = (0..m).map(|k| range(k, f64::NEG_INFINITY, f64::max)).collect();
        let span = |k: usize| if self.high[k] > self.low[k] { self.high[k] - self.low[k] } else { 1.0 };
        let scaled = |f: &[f64]| -> Vec<f64> { (0..m).map(|k| (f[k] - self.low[k]) / span(k)).collect() };
        let members: Vec<Vec<f64>> = feasible.iter().map(|&i| scaled(merged.f(i))).collect();
        self.fitness.clear();
        self.fitness.resize(members.len(), f64::INFINITY);
        for target in self.through.chunks_exact(m) {
            let target: Vec<f64> = scaled(target).into_iter().map(|t| t.max(1e-6)).collect();
            let length = target.iter().map(|t| t * t).sum::<f64>().sqrt();
            let min_max = |f: &[f64]| f.iter().zip(&target).map(|(f, t)| f * length / t).fold(0.0, f64::max);
            let angle_scaled = |f: &[f64]| {
                let norm = f.iter().map(|f| f * f).sum::<f64>().sqrt();
                let dot: f64 = f.iter().zip(&target).map(|(f, t)| f * t).sum();
                if norm > 0.0 { norm / (dot / (norm * length)).max(1e-3).powi(SHARPNESS) } else { 0.0 }
            };
            for score in [&min_max as &dyn Fn(&[f64]) -> f64, &angle_scaled] {
                self.scores.clear();
                self.scores.extend(members.iter().map(|f| score(f) + 1e-12));
                share(&self.scores, &mut self.fitness);
            }
        }
    }
}

/// Lowers each fitness to the score relative to the best, the best one's relative to the second.
fn share(scores: &[f64], fitness: &mut [f64]) {
    let (mut best, mut second, mut at) = (f64::INFINITY, f64::INFINITY, 0);
    for (i, &score) in scores.iter().enumerate() {
        if score < best {
            (second, best, at) = (best, score, i);
        } else if score < second {
            second = score;
        }
    }
    for (i, (fitness, &score)) in fitness.iter_mut().zip(scores).enumerate() {
        *fitness = fitness.min(if i == at { score / second } else { score / best });
    }
}

impl Survival for Targets {
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
        self.follow(merged, keep);
        self.rate(merged);
        let feasible = &self.feasibility.feasible;
        // The best of each objective come first.
        for k in 0..merged.objectives() {
            let best = (0..feasible.len())
                .min_by(|&a, &b| merged.f(feasible[a])[k].total_cmp(&merged.f(feasible[b])[k]));
            if let Some(best) = best {
                self.fitness[best] = f64::NEG_INFINITY;
            }
        }
        let mut order: Vec<usize> = (0..feasible.len()).collect();
        order.sort_by(|&a, &b| self.fitness[a].total_cmp(&self.fitness[b]));
        chosen.extend(order.iter().take(keep).map(|&at| feasible[at]));
        chosen.extend(self.feasibility.infeasible.iter().take(keep - chosen.len()));
    }
}

/// Each member mates with the nearer of two non-dominated ones, near in objectives or in
/// variables with equal chance.
#[derive(Debug, Clone, Default)]
pub(super) struct NearMate {
    sorting: Sorting,
}

impl Mating for NearMate {
    fn pair(
        &mut self,
        context: &MatingContext<'_>,
        children: usize,
        rng: &mut Random,
        pairs: &mut Vec<Pair>,
    ) {
        let population = context.population;
        let feasible: Vec<usize> = (0..population.len()).filter(|&i| population.is_feasible(i)).collect();
        self.sorting.sort(population, &feasible);
        let front = self.sorting.front(0);
        pairs.clear();
        for _ in 0..children.div_ceil(2) {
            let first = fitter(population, rng.below(population.len()), rng);
            let second = if front.is_empty() {
                fitter(population, rng.below(population.len()), rng)
            } else {
                let (a, b) = (front[rng.below(front.len())], front[rng.below(front.len())]);
                let by_objectives = rng.unit() < 0.5;
                let apart = |other: usize| -> f64 {
                    let (own, other) = if by_objectives {
                        (population.f(first), population.f(other))
                    } else {
                        (population.x(first), population.x(other))
                    };
                    own.iter().zip(other).map(|(a, b)| (a - b).powi(2)).sum()
                };
                if apart(b) < apart(a) { b } else { a }
            };
            pairs.push(Pair::of(first, second));
        }
    }
}
