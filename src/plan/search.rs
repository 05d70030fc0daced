//! The search for the front: seeds, evolution, and a descent from every plan found.

use std::ops::ControlFlow;

use super::{
    Evaluator, PlanError, Setup, Timing, TimingProblem,
    descend::{FAR_OFF, FINE, descend},
    exact,
    front::{least_broken, population, thinned, timing, timings},
    goal::{Goal, Merit},
    polish::{self, beats},
    seed::{Seeds, seeds},
};
use crate::{
    moea::{self, Algorithm, Archive, Budget, Population},
    task::{Ceilings, Objective, Weights},
};

/// How to search.
#[derive(Debug, Clone, PartialEq)]
pub struct Search {
    /// The evolutionary algorithm; NSGA-III-FO by default.
    pub algorithm: Algorithm,
    /// Whether to start from descents and to end with them, or from random plans as the paper does.
    pub seeded: bool,
    /// Length of the search; evaluations count those of the descents too, generations are of the
    /// evolution alone. 20,000 evaluations by default.
    pub budget: Budget,
    /// Members of the population; by default as the directions ask.
    pub population: Option<usize>,
    /// Seed of every random number drawn.
    pub seed: u64,
    /// Plans on the front at most.
    pub front: usize,
}

impl Default for Search {
    fn default() -> Self {
        Self {
            algorithm: Algorithm::NSGA3_FO,
            seeded: true,
            budget: Budget::Evaluations(20_000),
            population: None,
            seed: 1,
            front: 600,
        }
    }
}

/// Where a search is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Descents to the seeds.
    Start,
    /// The evolutionary algorithm.
    Evolution,
    /// Descents from the plans found.
    Polish,
}

/// State of a search, for its observer.
#[derive(Debug, Clone, Copy)]
pub struct Progress<'a> {
    /// The stage.
    pub phase: Phase,
    /// Evaluations so far.
    pub evaluations: u64,
    /// Generations of the evolution so far.
    pub generation: u64,
    /// The best so far; feasible members dominated by none, and others.
    pub population: &'a Population,
}

/// Result of a search.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// Feasible plans on the Pareto front, fastest first.
    pub front: Vec<Timing>,
    /// The plan that breaks limits least, where no plan keeps them all.
    pub nearest: Option<Timing>,
    /// Evaluations made.
    pub evaluations: u64,
    /// Generations of the evolution, the first population included.
    pub generations: u64,
    /// Whether the descent to the fastest plan ended because nothing was left to gain; `None` without
    /// descents.
    pub fastest_converged: Option<bool>,
}

/// Hundredths of the budget for descents from the plans found.
const POLISH: u64 = 45;
/// Evaluations that seeds and polish are measured by where the budget is not in evaluations.
const NOMINAL: u64 = 20_000;
/// Evaluations of the descent to what is nearest to feasible.
const NEAREST: u64 = 600;
/// Members of a population for three objectives unless another number is asked for.
const DIRECTIONS: usize = 92;

/// Searches the front of a setup.
///
/// The observer sees the start, every generation and the end; by [`ControlFlow::Break`] it ends the evolution, and what was found until
/// then is polished. Equal settings give equal plans on any number of cores.
///
/// # Errors
///
/// [`PlanError::Search`] for settings that no search has.
pub fn search(
    setup: &Setup,
    search: &Search,
    mut observer: impl FnMut(&Progress<'_>) -> ControlFlow<()>,
) -> Result<Found, PlanError> {
    let budget = match search.budget {
        Budget::Evaluations(evaluations) => evaluations,
        Budget::Generations(_) | Budget::Observer => NOMINAL,
    };
    let mut seeds = if search.seeded { seeds(setup, budget) } else { Seeds::default() };
    let used = seeds.evaluations;
    // As many seeds as directions, evenly over the front; without feasible seeds the least broken one.
    let mut initial = thinned(setup, seeds.all(), search.population.unwrap_or(DIRECTIONS));
    if initial.is_empty() {
        initial.extend(least_broken(seeds.all().cloned()));
    }
    let started = observer(&Progress {
        phase: Phase::Start,
        evaluations: used,
        generation: 0,
        population: &population(setup, seeds.all()),
    });
    let polish = if search.seeded { budget / 100 * POLISH } else { 0 };
    let settings = moea::Settings {
        algorithm: search.algorithm,
        population: search.population,
        budget: match search.budget {
            Budget::Evaluations(all) => Budget::Evaluations(all.saturating_sub(used + polish)),
            other => other,
        },
        seed: search.seed,
        archive: search.front.max(Objective::OF_PLAN.len()),
        initial: initial.iter().map(|timing| timing.interval_s.clone()).collect(),
        ..moea::Settings::default()
    };
    let outcome = moea::optimise(&TimingProblem::of(setup), &settings, |progress| {
        if started.is_break() {
            return ControlFlow::Break(());
        }
        observer(&Progress {
            phase: Phase::Evolution,
            evaluations: used + progress.evaluations,
            generation: progress.generation,
            population: progress.archive.map_or(progress.population, Archive::population),
        })
    })?;
    let fastest_converged = search.seeded.then_some(seeds.fastest_converged);
    let mut evaluations = used + outcome.evaluations;
    let evolved = timings(outcome.archive.as_ref().unwrap_or(&outcome.population));
    let mut front = if search.seeded {
        // Only what the seeds do not beat is worth a descent.
        let mut chosen = thinned(setup, seeds.all().chain(&evolved), usize::MAX);
        chosen.retain(|timing| !seeds.exact.contains(timing));
        let polished = polish::polish(setup, &chosen, polish);
        evaluations += polished.evaluations;
        seeds.exact.extend(polished.exact);
        filled(setup, &seeds.exact, [seeds.rough, polished.rough], search.front)
    } else {
        thinned(setup, &evolved, search.front)
    };
    front.sort_by(|a, b| a.objectives[Objective::Duration].total_cmp(&b.objectives[Objective::Duration]));
    let (mut front, more) = exact::kept_front(setup, &front, search.front);
    evaluations += more;
    let nearest = front.is_empty().then(|| {
        let members = (0..outcome.population.len()).map(|i| timing(&outcome.population, i));
        nearest(setup, least_broken(members.chain(initial))?)
    });
    let nearest = nearest.flatten();
    // The descent to it may end where all limits hold.
    let keeps =
        |end: &Timing| end.violation <= 0.0 && setup.keeps(&end.interval_s, &mut Evaluator::new(setup));
    front.extend(nearest.clone().filter(keeps));
    if search.seeded {
        front.splice(0..0, exact::quickest(setup, front.first(), |_| true));
        front.truncate(search.front.max(1));
    }
    let _ = observer(&Progress {
        phase: Phase::Polish,
        evaluations,
        generation: outcome.generations,
        population: &population(setup, &front),
    });
    Ok(Found { front, nearest, evaluations, generations: outcome.generations, fastest_converged })
}

/// The plan that breaks its limits least, near one that breaks them.
fn nearest(setup: &Setup, timing: Timing) -> Option<Timing> {
    // With nothing to lessen but the price of the limit most broken.
    let goal = Goal {
        merit: Merit::Logarithms(Weights::ZERO),
        ceilings: Ceilings::NONE,
        evaluations: NEAREST,
        trust: FAR_OFF,
        enough: FINE,
    };
    let end = descend(setup, &mut Evaluator::new(setup), &timing.interval_s, &goal);
    least_broken(end.timing.into_iter().chain([timing]))
}

/// The front of the plans that descents have ended at. Others fill it up where they look as good, the
/// first before the second, as long as there is room.
fn filled(setup: &Setup, exact: &[Timing], others: [Vec<Timing>; 2], most: usize) -> Vec<Timing> {
    let mut front = thinned(setup, exact, most);
    for rough in others {
        if front.len() < most - most / 10 {
            let beaten = |timing: &Timing| exact.iter().any(|exact| beats(setup, exact, timing));
            front.extend(rough.into_iter().filter(|timing| !beaten(timing)));
            front = thinned(setup, &front, most);
        }
    }
    front
}
