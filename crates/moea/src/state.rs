//! The state of a run between two evaluations: draws the first members, counts, ends.

use super::{
    Budget, Outcome, Population, Progress, Settings,
    archive::Archive,
    genetic::{Method, Streams},
    random::{Random, Stream},
    settings::Checked,
};

/// A run between two evaluations.
pub(super) struct State {
    method: Box<dyn Method>,
    streams: Streams,
    /// Size of the population.
    n: usize,
    pub(super) population: Population,
    /// To be evaluated.
    pub(super) pending: Population,
    archive: Option<Archive>,
    counted: Counted,
    seed: u64,
    /// Steps of this generation so far, of several if each evaluates children of its own.
    step: usize,
    pub(super) is_over: bool,
}

impl State {
    pub(super) fn new(checked: &Checked, settings: &Settings, method: Box<dyn Method>) -> Self {
        let (d, m, n) = (checked.space.len(), checked.objectives, checked.members);
        let most = match settings.budget {
            Budget::Evaluations(most) => most,
            Budget::Generations(_) | Budget::Observer => u64::MAX,
        };
        Self {
            method,
            streams: Streams {
                variation: Random::new(settings.seed, Stream::Variation),
                survival: Random::new(settings.seed, Stream::Survival),
            },
            n,
            population: Population::with_capacity(d, m, n),
            pending: start(checked, settings, most),
            archive: (settings.archive > 0).then(|| Archive::new(d, m, settings.archive)),
            counted: Counted { evaluations: 0, generation: 0, most, budget: settings.budget },
            seed: settings.seed,
            step: 0,
            is_over: false,
        }
    }

    /// Takes the evaluated members in, and breeds the next. Returns whether a generation has ended.
    pub(super) fn advance(&mut self) -> bool {
        let Self { method, streams, population, pending, .. } = self;
        self.counted.evaluations += pending.len() as u64;
        if let Some(archive) = &mut self.archive {
            archive.extend(pending);
        }
        if self.counted.generation == 0 {
            population.append(pending);
            method.begin(population, streams);
        } else {
            method.advance(population, pending, streams);
            self.step += 1;
            if self.breed() {
                return false;
            }
        }
        self.counted.generation += 1;
        self.step = 0;
        self.pending.clear();
        // A method that breeds nobody at the start of a generation never will.
        self.is_over = self.counted.is_over() || !self.breed();
        true
    }

    /// Breeds the children of the next step of this generation, if it has one.
    fn breed(&mut self) -> bool {
        let Self { method, streams, population, pending, .. } = self;
        pending.clear();
        let batch = method.batch(self.n);
        let room = usize::try_from(self.counted.most - self.counted.evaluations).unwrap_or(usize::MAX);
        if self.step < method.steps(self.n) && room > 0 {
            method.breed(population, self.counted.share(self.n), batch.min(room), pending, streams);
        }
        !pending.is_empty()
    }

    pub(super) fn progress(&self) -> Progress<'_> {
        Progress {
            generation: self.counted.generation,
            evaluations: self.counted.evaluations,
            population: &self.population,
            archive: self.archive.as_ref(),
        }
    }

    pub(super) fn into_outcome(self) -> Outcome {
        Outcome {
            population: self.population,
            archive: self.archive.map(Archive::into_population),
            evaluations: self.counted.evaluations,
            generations: self.counted.generation,
            seed: self.seed,
        }
    }
}

/// Evaluations and generations against the budget.
struct Counted {
    evaluations: u64,
    generation: u64,
    most: u64,
    budget: Budget,
}

impl Counted {
    fn is_over(&self) -> bool {
        match self.budget {
            Budget::Evaluations(most) => self.evaluations >= most,
            Budget::Generations(most) => self.generation >= most,
            Budget::Observer => false,
        }
    }

    /// Share of the budget used, if there is one.
    fn share(&self, n: usize) -> Option<f64> {
        match self.budget {
            Budget::Evaluations(most) => Some(self.evaluations as f64 / most.max(1) as f64),
            Budget::Generations(most) => {
                Some(self.evaluations as f64 / (most.max(1) as f64 * n.max(1) as f64))
                    .map(|share| share.min(1.0))
            }
            Budget::Observer => None,
        }
    }
}

/// The first population: given members first, then uniform draws. Never more than the budget.
fn start(checked: &Checked, settings: &Settings, most: u64) -> Population {
    let size = checked.members.min(usize::try_from(most).unwrap_or(usize::MAX)).max(1);
    let mut population = Population::with_capacity(checked.space.len(), checked.objectives, size);
    let mut rng = Random::new(settings.seed, Stream::Start);
    let mut x = vec![0.0; checked.space.len()];
    for given in settings.initial.iter().take(size) {
        x.copy_from_slice(given);
        checked.space.settle(&mut x);
        population.push_x(&x);
    }
    while population.len() < size {
        checked.space.draw(&mut x, &mut rng);
        population.push_x(&x);
    }
    population
}
