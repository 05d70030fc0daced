//! MOEA/D: one scalar problem a direction, neighbours help one another.
//!
//! # References
//!
//! Zhang and Li 2007, doi 10.1109/TEVC.2007.892759: boundary intersection with penalty.
//! Differences: a child may replace any neighbour, as in the paper's basic form, and of two
//! members the one that violates constraints less is better, whatever the objectives.

use super::{
    Population,
    direction::neighbours,
    genetic::{Breeding, Method, Streams},
    mating::Pair,
    normalize::Normalizer,
    sorting::Sorting,
    survival::Feasibility,
};

/// Weight of the distance aside from the direction.
const PENALTY: f64 = 5.0;

/// Least span of an objective, as a share of the range that it was ever seen in.
const LEAST_SPAN: f64 = 1e-3;

/// Neighbours of a direction, itself included: a tenth of the directions, and no fewer than these. Of few directions a
/// tenth is but three, whose parents are too much alike.
const LEAST_NEAR: usize = 10;

/// State of a run; member i belongs to direction i.
pub(super) struct Decomposition {
    m: usize,
    /// At unit length, `[count][m]`.
    directions: Vec<f64>,
    neighbours: Vec<usize>,
    near: usize,
    normalized: bool,
    breeding: Breeding,
    ideal: Vec<f64>,
    normalizer: Normalizer,
    sorting: Sorting,
    feasibility: Feasibility,
    span: Vec<f64>,
    /// Order of visits of this generation, and the place in it.
    visits: Vec<usize>,
    visit: usize,
}

impl Decomposition {
    pub(super) fn new(directions: &[f64], m: usize, normalized: bool, breeding: Breeding) -> Self {
        let count = directions.len() / m;
        let near = count.div_ceil(10).max(LEAST_NEAR).min(count);
        let lengths = directions.chunks_exact(m).flat_map(|z| {
            let length = z.iter().map(|z| z * z).sum::<f64>().sqrt();
            z.iter().map(move |z| z / length)
        });
        Self {
            m,
            directions: lengths.collect(),
            neighbours: neighbours(directions, m, near),
            near,
            normalized,
            breeding,
            ideal: vec![f64::INFINITY; m],
            normalizer: Normalizer::new(m),
            sorting: Sorting::default(),
            feasibility: Feasibility::default(),
            span: vec![1.0; m],
            visits: Vec::new(),
            visit: 0,
        }
    }

    fn learn_ideal(&mut self, members: &Population) {
        for i in (0..members.len()).filter(|&i| members.is_feasible(i)) {
            for (ideal, f) in self.ideal.iter_mut().zip(members.f(i)) {
                *ideal = ideal.min(*f);
            }
        }
    }

    /// Spans to the intercepts, as NSGA-III finds them: the range of the population alone would
    /// shrink with it. None is less than a share of what was ever seen: without niches a population that lost an
    /// objective's extent would never find it again.
    fn learn_span(&mut self, population: &Population) {
        self.feasibility.split(population);
        self.sorting.sort(population, &self.feasibility.feasible);
        self.normalizer.update(population, &self.feasibility.feasible, self.sorting.front(0));
        let known = self.normalizer.span().iter().zip(self.normalizer.seen());
        self.span.clear();
        self.span.extend(known.map(|(span, seen)| span.max(LEAST_SPAN * seen)));
    }

    /// Distance along direction `j` and, penalised, aside from it.
    fn penalised(&self, f: &[f64], j: usize) -> f64 {
        let direction = &self.directions[j * self.m..][..self.m];
        let value = |k: usize| (f[k] - self.ideal[k]) / self.span[k];
        let along: f64 = (0..self.m).map(|k| value(k) * direction[k]).sum();
        let aside: f64 = (0..self.m).map(|k| (value(k) - along * direction[k]).powi(2)).sum();
        along + PENALTY * aside.sqrt()
    }

    fn owner(&self) -> usize {
        self.visits.get(self.visit).copied().unwrap_or(0)
    }

    fn near(&self, owner: usize) -> &[usize] {
        &self.neighbours[owner * self.near..][..self.near]
    }
}

impl Method for Decomposition {
    fn begin(&mut self, population: &mut Population, streams: &mut Streams) {
        self.learn_ideal(population);
        self.visits.extend(0..population.len());
        streams.variation.shuffle(&mut self.visits);
    }

    fn batch(&self, _: usize) -> usize {
        1
    }

    fn steps(&self, n: usize) -> usize {
        n
    }

    fn breed(
        &mut self,
        population: &Population,
        _: Option<f64>,
        wanted: usize,
        children: &mut Population,
        streams: &mut Streams,
    ) {
        if self.visit == 0 && self.normalized {
            self.learn_span(population);
        }
        let (owner, n) = (self.owner(), population.len());
        let near = self.near(owner);
        let pick = |at: usize| near[at].min(n - 1);
        let first = pick(streams.variation.below(near.len()));
        let second = pick(streams.variation.below(near.len()));
        self.breeding.breed(population, Pair::of(first, second), wanted, children, &mut streams.variation);
    }

    fn advance(&mut self, population: &mut Population, children: &Population, streams: &mut Streams) {
        self.learn_ideal(children);
        let owner = self.owner();
        for at in 0..self.near {
            let j = self.near(owner)[at];
            if j >= population.len() {
                continue;
            }
            for child in 0..children.len() {
                let (new, old) = (children.violation(child), population.violation(j));
                let better = if children.is_feasible(child) && population.is_feasible(j) {
                    self.penalised(children.f(child), j) <= self.penalised(population.f(j), j)
                } else {
                    new < old
                };
                if better {
                    population.replace(j, children, child);
                }
            }
        }
        self.visit += 1;
        if self.visit >= self.visits.len() {
            self.visit = 0;
            streams.variation.shuffle(&mut self.visits);
        }
    }
}
