//! Pareto fronts of plans.

use std::cmp::Ordering;

use super::{Setup, Timing};
use crate::{
    moea::{Archive, Population},
    task::{Objective, Objectives},
};

pub(super) fn population<'a>(setup: &Setup, timings: impl IntoIterator<Item = &'a Timing>) -> Population {
    let mut population = Population::with_capacity(setup.interval_count(), Objective::OF_PLAN.len(), 0);
    for timing in timings {
        population.push(&timing.interval_s, timing.objectives.plan(), timing.violation);
    }
    population
}

pub(super) fn timing(population: &Population, i: usize) -> Timing {
    Timing {
        interval_s: population.x(i).to_vec(),
        objectives: Objectives::from_slice(population.f(i)),
        violation: population.violation(i),
    }
}

pub(super) fn timings(population: &Population) -> Vec<Timing> {
    population.front().into_iter().map(|i| timing(population, i)).collect()
}

/// The front of plans, of at most so many.
pub(super) fn thinned<'a>(
    setup: &Setup,
    all: impl IntoIterator<Item = &'a Timing>,
    most: usize,
) -> Vec<Timing> {
    let mut archive = Archive::new(setup.interval_count(), Objective::OF_PLAN.len(), usize::MAX);
    archive.extend(&population(setup, all));
    let clear = timings(archive.population());
    let mut archive =
        Archive::new(setup.interval_count(), Objective::OF_PLAN.len(), most.max(Objective::OF_PLAN.len()));
    archive.extend(&population(setup, &clear));
    timings(&archive.into_population())
}

pub(super) fn least_broken(timings: impl IntoIterator<Item = Timing>) -> Option<Timing> {
    timings.into_iter().min_by(|a, b| a.violation.total_cmp(&b.violation))
}

/// Index of the plan that is best in one objective; of equal ones the best in the next.
pub(super) fn best_of(front: &[Timing], objective: Objective) -> Option<usize> {
    let from = objective as usize;
    let key = |i: &usize| {
        let f = front[*i].objectives.plan();
        f[from..].iter().chain(&f[..from])
    };
    let compare = |a: &usize, b: &usize| {
        key(a).zip(key(b)).map(|(a, b)| a.total_cmp(b)).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
    };
    (0..front.len()).min_by(compare)
}
