//! Laws of NSGA-III-FO in its default form, and of a tournament without a ranking.

#![allow(clippy::unwrap_used, clippy::float_cmp)]

use std::ops::ControlFlow;

use moea::{
    Algorithm, Bounds, Budget, Focus, Population, Problem, Random, Ranking, Settings, Survival, Tournament,
    benchmark::Benchmark, optimise, optimise_with, silent,
};

fn settings(focus: Focus, seed: u64) -> Settings {
    let algorithm = Algorithm::Nsga3Fo { focus, adaptive_rates: false };
    Settings { algorithm, seed, budget: Budget::Evaluations(6000), ..Settings::default() }
}

/// Least value of each objective of the feasible members, `[m]`.
fn best(population: &Population) -> Vec<f64> {
    let least = |k: usize| {
        let feasible = (0..population.len()).filter(|&i| population.is_feasible(i));
        feasible.map(|i| population.f(i)[k]).fold(f64::INFINITY, f64::min)
    };
    (0..population.objectives()).map(least).collect()
}

/// Generations in which the best of an objective got worse.
fn lost_ends(focus: Focus, seed: u64) -> usize {
    // The front is a curve, which meets a seventh of the directions.
    let problem = Benchmark::named("DTLZ5", 3).unwrap();
    let (mut before, mut lost) = (vec![f64::INFINITY; 3], 0);
    let observer = |progress: &moea::Progress<'_>| {
        let now = best(progress.population);
        lost += usize::from(now.iter().zip(&before).any(|(now, before)| now > before));
        before = now;
        ControlFlow::Continue(())
    };
    optimise(&problem, &settings(focus, seed), observer).unwrap();
    lost
}

#[test]
fn the_ends_of_a_front_that_is_a_curve_survive() {
    for seed in 1..=5 {
        assert_eq!(lost_ends(Focus::Spread, seed), 0, "seed {seed}");
    }
    assert!((1..=5).map(|seed| lost_ends(Focus::Local, seed)).sum::<usize>() > 0);
}

/// DTLZ5 of which a half is infeasible.
struct Half(Benchmark);

impl Problem for Half {
    type Workspace = Vec<f64>;

    fn bounds(&self) -> Vec<Bounds> {
        self.0.bounds()
    }

    fn objectives(&self) -> usize {
        3
    }

    fn evaluate(&self, x: &[f64], f: &mut [f64], workspace: &mut Vec<f64>) -> f64 {
        self.0.evaluate(x, f, workspace);
        (x[1] - x[2] - 0.3).max(0.0)
    }
}

#[test]
fn what_is_feasible_gives_way_to_feasible_members_only() {
    for focus in [Focus::Spread, Focus::Local, Focus::Signed, Focus::Literal] {
        let problem = Half(Benchmark::named("DTLZ5", 3).unwrap());
        let mut before = 0;
        let run = optimise(&problem, &settings(focus, 4), |progress| {
            let members = progress.population;
            let feasible = (0..members.len()).filter(|&i| members.is_feasible(i)).count();
            assert!(feasible >= before, "{focus:?}: {before}, then {feasible}");
            before = feasible;
            ControlFlow::Continue(())
        });
        assert_eq!(run.unwrap().population.len(), before, "{focus:?}");
    }
}

/// Keeps the youngest and finds nothing on them.
struct Youngest;

impl Survival for Youngest {
    fn select(
        &mut self,
        merged: &Population,
        keep: usize,
        _: &mut Random,
        chosen: &mut Vec<usize>,
        ranking: &mut Ranking,
    ) {
        ranking.clear();
        chosen.clear();
        chosen.extend((0..merged.len()).rev().take(keep));
    }
}

#[test]
fn a_tournament_without_a_ranking_is_drawn() {
    let problem = Benchmark::named("DTLZ5", 3).unwrap();
    let settings = settings(Focus::Spread, 1);
    let run = optimise_with(&problem, &settings, Tournament::default(), Youngest, silent).unwrap();
    assert_eq!(run.evaluations, 6000);
}
