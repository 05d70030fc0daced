//! Sets of plans of which none is better than another in everything.

use std::cmp::Ordering;

use super::{Objectives, Setup, Timing};
use crate::moea::{Archive, Population};

pub(super) fn population<'a>(setup: &Setup, timings: impl IntoIterator<Item = &'a Timing>) -> Population {
    let mut population = Population::with_capacity(setup.interval_count(), 3, 0);
    for timing in timings {
        population.push(&timing.interval_s, &timing.objectives.as_array(), timing.violation);
    }
    population
}

pub(super) fn timing(population: &Population, i: usize) -> Timing {
    let f = population.f(i);
    Timing {
        interval_s: population.x(i).to_vec(),
        objectives: Objectives::from_array([f[0], f[1], f[2]]),
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
    let mut archive = Archive::new(setup.interval_count(), 3, usize::MAX);
    archive.extend(&population(setup, all));
    let clear = timings(archive.population());
    let mut archive = Archive::new(setup.interval_count(), 3, most.max(3));
    archive.extend(&population(setup, &clear));
    timings(&archive.into_population())
}

pub(super) fn least_broken(timings: impl IntoIterator<Item = Timing>) -> Option<Timing> {
    timings.into_iter().min_by(|a, b| a.violation.total_cmp(&b.violation))
}

/// Index of the plan that is best in one objective; of equal ones the best in the next.
pub(super) fn best_of(front: &[Timing], objective: usize) -> Option<usize> {
    let key = |timing: &Timing| {
        let f = timing.objectives.as_array();
        [f[objective], f[(objective + 1) % 3], f[(objective + 2) % 3]]
    };
    let compare = |a: &usize, b: &usize| {
        let (a, b) = (key(&front[*a]), key(&front[*b]));
        a.iter().zip(b).map(|(a, b)| a.total_cmp(&b)).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
    };
    (0..front.len()).min_by(compare)
}
