//! One generation of an algorithm that merges parents and children and selects.

use super::{
    Population,
    mating::{Mating, MatingContext, Pair},
    random::Random,
    survival::{Ranking, Survival},
    variables::Space,
    variation::{Operators, cross, mutate},
};

/// Random numbers of a run, one stream a purpose.
pub(super) struct Streams {
    pub(super) variation: Random,
    pub(super) survival: Random,
}

/// An algorithm as the engine drives it.
pub(super) trait Method: Send {
    /// Takes the evaluated first population; may reorder it.
    fn begin(&mut self, population: &mut Population, streams: &mut Streams);

    /// Children per step for a population of `n`.
    fn batch(&self, n: usize) -> usize;

    /// Steps of a generation of a population of `n`.
    fn steps(&self, _: usize) -> usize {
        1
    }

    /// Writes at most `wanted` children, not evaluated, into the empty `children`.
    fn breed(
        &mut self,
        population: &Population,
        progress: Option<f64>,
        wanted: usize,
        children: &mut Population,
        streams: &mut Streams,
    );

    /// Takes evaluated children into the population.
    fn advance(&mut self, population: &mut Population, children: &Population, streams: &mut Streams);
}

/// Rates and values of variables, and how two parents become two children that nobody has been yet.
#[derive(Debug, Clone)]
pub(super) struct Breeding {
    pub(super) operators: Operators,
    pub(super) mutation_rate: f64,
    pub(super) space: Space,
    pair: (Vec<f64>, Vec<f64>),
}

/// How often a child that repeats somebody is mutated again before it is let be.
const ATTEMPTS: usize = 8;

impl Breeding {
    pub(super) fn new(operators: Operators, mutation_rate: f64, space: Space) -> Self {
        let zeros = vec![0.0; space.len()];
        Self { operators, mutation_rate, space, pair: (zeros.clone(), zeros) }
    }

    /// Appends one or two children of two members, at most up to `wanted` children.
    pub(super) fn breed(
        &mut self,
        population: &Population,
        pair: Pair,
        wanted: usize,
        children: &mut Population,
        rng: &mut Random,
    ) {
        let (first, second) = (&mut self.pair.0, &mut self.pair.1);
        let parents = (population.x(pair.first), population.x(pair.second));
        let rate = self.operators.crossover_rate * pair.crossover;
        let mutation_rate = self.mutation_rate * pair.mutation;
        cross(&self.operators, rate, &self.space, parents, (first, second), rng);
        for child in [first, second] {
            if children.len() >= wanted {
                return;
            }
            mutate(self.operators.mutation_eta, mutation_rate, &self.space, child, rng);
            for _ in 0..ATTEMPTS {
                if mutation_rate <= 0.0 || !(population.contains(child) || children.contains(child)) {
                    break;
                }
                mutate(self.operators.mutation_eta, self.mutation_rate, &self.space, child, rng);
            }
            children.push_x(child);
        }
    }
}

/// A genetic algorithm: mating, variation, survival of the best of parents and children.
pub(super) struct Genetic {
    pub(super) mating: Box<dyn Mating>,
    pub(super) survival: Box<dyn Survival>,
    pub(super) breeding: Breeding,
    /// Members that are to survive.
    keep: usize,
    pairs: Vec<Pair>,
    merged: Population,
    chosen: Vec<usize>,
    ranking: Ranking,
}

impl Genetic {
    pub(super) fn new(mating: Box<dyn Mating>, survival: Box<dyn Survival>, breeding: Breeding) -> Self {
        Self {
            mating,
            survival,
            breeding,
            keep: 0,
            pairs: Vec::new(),
            merged: Population::default(),
            chosen: Vec::new(),
            ranking: Ranking::default(),
        }
    }

    fn select(&mut self, population: &mut Population, streams: &mut Streams) {
        let keep = self.keep;
        self.survival.select(&self.merged, keep, &mut streams.survival, &mut self.chosen, &mut self.ranking);
        population.clear();
        for &i in self.chosen.iter().filter(|i| **i < self.merged.len()).take(keep) {
            population.push_from(&self.merged, i);
        }
    }
}

impl Method for Genetic {
    fn begin(&mut self, population: &mut Population, streams: &mut Streams) {
        self.merged = population.clone();
        self.keep = population.len();
        self.select(population, streams);
    }

    fn batch(&self, n: usize) -> usize {
        n.saturating_sub(self.mating.reserved()).max(1)
    }

    fn breed(
        &mut self,
        population: &Population,
        progress: Option<f64>,
        wanted: usize,
        children: &mut Population,
        streams: &mut Streams,
    ) {
        let context = MatingContext { population, ranking: &self.ranking, progress };
        self.pairs.clear();
        self.mating.pair(&context, wanted, &mut streams.variation, &mut self.pairs);
        let exists = |pair: &&Pair| pair.first.max(pair.second) < population.len();
        for &pair in self.pairs.iter().filter(exists) {
            self.breeding.breed(population, pair, wanted, children, &mut streams.variation);
        }
    }

    fn advance(&mut self, population: &mut Population, children: &Population, streams: &mut Streams) {
        self.merged.clear();
        self.merged.append(population);
        self.merged.append(children);
        self.select(population, streams);
    }
}
