//! The engine: draws the first population, and lets an algorithm work until the end.

use std::ops::ControlFlow;

use super::{
    Algorithm, Budget, MoeaError, Population, Problem, Settings,
    archive::Archive,
    evaluate::Evaluation,
    focus::Focused,
    genetic::{Breeding, Genetic, Method, Streams},
    mating::{Mating, Uniform},
    moead::Decomposition,
    msops2::{NearMate, Targets},
    nsga2::{Crowding, Tournament},
    nsga3::Niching,
    settings::{Checked, check},
    survival::Survival,
};
use crate::random::{Random, Stream};

/// What an observer sees after the first population and after every generation.
#[derive(Debug, Clone, Copy)]
pub struct Progress<'a> {
    /// Generations so far, the first population counted as one.
    pub generation: u64,
    /// Evaluations so far.
    pub evaluations: u64,
    /// The present population.
    pub population: &'a Population,
    /// The archive, if one is kept.
    pub archive: Option<&'a Archive>,
}

/// What a run found.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The last population. If nothing feasible was found it holds what violates least.
    pub population: Population,
    /// Non-dominated feasible solutions of the whole run, if an archive was asked for.
    pub archive: Option<Population>,
    /// Number of evaluations made.
    pub evaluations: u64,
    /// Number of generations, the first population included.
    pub generations: u64,
    /// The seed of the run.
    pub seed: u64,
}

/// Observes nothing.
pub fn silent(_: &Progress<'_>) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Minimises all objectives of a problem at once.
///
/// Equal settings give an equal outcome, bit for bit, on any number of cores. The observer may
/// end the run by [`ControlFlow::Break`].
///
/// # Errors
///
/// [`MoeaError`] when the settings do not fit the problem.
pub fn optimise<P: Problem>(
    problem: &P,
    settings: &Settings,
    observer: impl FnMut(&Progress<'_>) -> ControlFlow<()>,
) -> Result<Outcome, MoeaError> {
    let checked = check(problem, settings)?;
    let method = method(&checked, settings);
    Ok(run(problem, settings, &checked, method, observer))
}

/// Minimises as [`optimise`] does, with a mating and a survival of the caller's in place of the
/// algorithm of the settings.
///
/// # Errors
///
/// [`MoeaError`] when the settings do not fit the problem.
pub fn optimise_with<P: Problem>(
    problem: &P,
    settings: &Settings,
    mating: impl Mating + 'static,
    survival: impl Survival + 'static,
    observer: impl FnMut(&Progress<'_>) -> ControlFlow<()>,
) -> Result<Outcome, MoeaError> {
    let settings = Settings { algorithm: Algorithm::Nsga3, ..settings.clone() };
    let checked = check(problem, &settings)?;
    let breeding = Breeding::new(settings.operators, checked.mutation_rate, checked.bounds.clone());
    let method = Box::new(Genetic::new(Box::new(mating), Box::new(survival), breeding));
    Ok(run(problem, &settings, &checked, method, observer))
}

fn run<P: Problem>(
    problem: &P,
    settings: &Settings,
    checked: &Checked,
    mut method: Box<dyn Method>,
    mut observer: impl FnMut(&Progress<'_>) -> ControlFlow<()>,
) -> Outcome {
    let (d, m, n) = (checked.bounds.len(), checked.objectives, checked.members);
    let mut streams = Streams {
        variation: Random::new(settings.seed, Stream::Variation),
        survival: Random::new(settings.seed, Stream::Survival),
    };
    let most = match settings.budget {
        Budget::Evaluations(most) => most,
        Budget::Generations(_) | Budget::Observer => u64::MAX,
    };
    let mut evaluation = Evaluation::new(problem);
    let mut population = start(checked, settings, most);
    evaluation.evaluate(problem, &mut population);
    let mut archive = (settings.archive > 0).then(|| Archive::new(d, m, settings.archive));
    if let Some(archive) = &mut archive {
        archive.extend(&population);
    }
    let mut run =
        Counted { evaluations: population.len() as u64, generation: 1, most, budget: settings.budget };
    method.begin(&mut population, &mut streams);
    let mut children = Population::with_capacity(d, m, n);
    let mut flow = observer(&Progress {
        generation: 1,
        evaluations: run.evaluations,
        population: &population,
        archive: archive.as_ref(),
    });
    while flow.is_continue() && !run.is_over() {
        // A generation may take several steps, each with its own evaluation of children.
        let batch = method.batch(n);
        for _ in 0..n / batch {
            let room = usize::try_from(run.most - run.evaluations).unwrap_or(usize::MAX);
            if room == 0 {
                break;
            }
            children.clear();
            method.breed(&population, run.share(n), batch.min(room), &mut children, &mut streams);
            if children.is_empty() {
                break;
            }
            evaluation.evaluate(problem, &mut children);
            run.evaluations += children.len() as u64;
            if let Some(archive) = &mut archive {
                archive.extend(&children);
            }
            method.advance(&mut population, &children, &mut streams);
        }
        run.generation += 1;
        flow = observer(&Progress {
            generation: run.generation,
            evaluations: run.evaluations,
            population: &population,
            archive: archive.as_ref(),
        });
    }
    Outcome {
        population,
        archive: archive.map(Archive::into_population),
        evaluations: run.evaluations,
        generations: run.generation,
        seed: settings.seed,
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
    let mut population = Population::with_capacity(checked.bounds.len(), checked.objectives, size);
    let mut rng = Random::new(settings.seed, Stream::Start);
    let mut x = vec![0.0; checked.bounds.len()];
    for given in settings.initial.iter().take(size) {
        for ((x, &given), &(lower, upper)) in x.iter_mut().zip(given).zip(&checked.bounds) {
            *x = given.clamp(lower, upper);
        }
        population.push_x(&x);
    }
    while population.len() < size {
        draw(&checked.bounds, &mut x, &mut rng);
        population.push_x(&x);
    }
    population
}

fn draw(bounds: &[(f64, f64)], x: &mut [f64], rng: &mut Random) {
    for (x, &(lower, upper)) in x.iter_mut().zip(bounds) {
        *x = (lower + rng.unit() * (upper - lower)).clamp(lower, upper);
    }
}

fn method(checked: &Checked, settings: &Settings) -> Box<dyn Method> {
    let (m, directions) = (checked.objectives, &checked.directions);
    let breeding = Breeding::new(settings.operators, checked.mutation_rate, checked.bounds.clone());
    let niching = || Box::new(Niching::new(directions, m));
    match settings.algorithm {
        Algorithm::Nsga3 => Box::new(Genetic::new(Box::<Uniform>::default(), niching(), breeding)),
        Algorithm::Nsga3Fo { focus, adaptive_rates } => {
            let mating = Focused::new(focus, adaptive_rates, directions, m);
            let survival = if focus.fills_by_crowding() {
                Box::new(Niching::filled_by_crowding(directions, m))
            } else {
                niching()
            };
            Box::new(Genetic::new(Box::new(mating), survival, breeding))
        }
        Algorithm::Nsga2 => {
            Box::new(Genetic::new(Box::<Tournament>::default(), Box::<Crowding>::default(), breeding))
        }
        Algorithm::Moead { normalized } => Box::new(Decomposition::new(directions, m, normalized, breeding)),
        Algorithm::Msops2 => {
            Box::new(Genetic::new(Box::<NearMate>::default(), Box::<Targets>::default(), breeding))
        }
    }
}
