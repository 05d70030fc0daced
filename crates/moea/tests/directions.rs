//! Reference directions of the caller's.

#![allow(clippy::unwrap_used)]

use moea::{
    ALGORITHMS, Budget, Crowding, Directions, Mating, MatingContext, Pair, Random, Settings, Survival,
    Tournament, benchmark::Benchmark, optimise, optimise_with, silent,
};

#[test]
fn members_gather_where_own_directions_point() {
    // A corner of DTLZ2's sphere.
    let corner: Vec<Vec<f64>> = (0..5)
        .flat_map(|i| (0..5).map(move |j| vec![1.0, 0.05 * f64::from(i), 0.05 * f64::from(j)]))
        .collect();
    let problem = Benchmark::named("DTLZ2", 3).unwrap();
    let share = |directions: Directions| {
        let budget = Budget::Evaluations(8000);
        let settings = Settings { directions, budget, population: Some(28), ..Settings::default() };
        let found = optimise(&problem, &settings, silent).unwrap().population;
        let near = (0..found.len()).filter(|&i| found.f(i)[0] > 0.9).count();
        near as f64 / found.len() as f64
    };
    let (own, usual) = (share(Directions::Own(corner)), share(Directions::Usual));
    assert!(own > 0.8 && usual < 0.3, "{own} {usual}");
}

/// Leaves half of the slots of a population of twenty.
struct Half;
impl Mating for Half {
    fn pair(
        &mut self,
        context: &MatingContext<'_>,
        children: usize,
        rng: &mut Random,
        pairs: &mut Vec<Pair>,
    ) {
        Tournament::default().pair(context, children, rng, pairs);
    }
    fn reserved(&self) -> usize {
        10
    }
}

#[test]
fn a_wanted_population_is_kept_where_no_directions_need_members() {
    let problem = Benchmark::named("DTLZ2", 3).unwrap();
    let members = |settings: Settings| optimise(&problem, &settings, silent).unwrap().population.len();
    for named in ALGORITHMS {
        for (wanted, kept, with_directions) in [(1, 4, 92), (20, 20, 92), (93, 96, 96), (200, 200, 200)] {
            let (budget, population) = (Budget::Generations(2), Some(wanted));
            let settings = Settings { algorithm: named.algorithm, budget, population, ..Settings::default() };
            let want = match named.name {
                "nsga2" | "msops2" | "age-moea-2" | "sms-emoa" => kept,
                "moead" | "moead-normalized" => 91,
                _ => with_directions,
            };
            assert_eq!(members(settings), want, "{} {wanted}", named.name);
        }
    }
    // A mating and a survival of the caller's, chosen as it runs.
    let settings = Settings { budget: Budget::Generations(2), population: Some(20), ..Settings::default() };
    let run = optimise_with(
        &problem,
        &settings,
        Box::new(Tournament::default()) as Box<dyn Mating>,
        Box::new(Crowding::default()) as Box<dyn Survival>,
        silent,
    );
    assert_eq!(run.unwrap().population.len(), 20);
    // Slots that a mating reserves are not filled.
    let run = optimise_with(&problem, &settings, Half, Crowding::default(), silent).unwrap();
    assert_eq!(run.evaluations, 30);
}

#[test]
fn every_algorithm_runs_with_a_single_direction_given_twice() {
    let problem = Benchmark::named("WFG4", 3).unwrap();
    for named in ALGORITHMS {
        let directions = Directions::Own(vec![vec![1.0, 0.0, 2.0]; 2]);
        let settings = Settings {
            algorithm: named.algorithm,
            directions,
            budget: Budget::Evaluations(300),
            ..Settings::default()
        };
        assert_eq!(optimise(&problem, &settings, silent).unwrap().evaluations, 300, "{}", named.name);
    }
}
