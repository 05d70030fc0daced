//! Odd input: nothing, what is no number, wrong shapes, huge numbers. It gets an error or a value, never a panic.

#![allow(clippy::unwrap_used, clippy::float_cmp)]

use moea::{
    Archive, Crowding, Directions, Geodesic, LeastContribution, Mating, MatingContext, MoeaError, Niching,
    Pair, Population, Problem, Random, Ranking, Settings, Sorting, Survival, Tournament, Unsound,
    benchmark::{Benchmark, NAMES},
    das_dennis, direction_count, dominates,
    indicator::{contributions, hypervolume, igd, igd_plus},
    optimise, optimise_with, silent,
};

const NAN: f64 = f64::NAN;
const INF: f64 = f64::INFINITY;

#[test]
fn more_directions_than_memory_holds_are_refused() {
    for objectives in [2, 3, 7] {
        for divisions in [usize::MAX, usize::MAX - 1, 1 << 40] {
            assert_eq!(direction_count(objectives, divisions), None, "{objectives} {divisions}");
            for directions in [Directions::Divisions(divisions), Directions::Layers(divisions, divisions)] {
                let refused = directions.points(objectives, 92);
                assert!(matches!(refused, Err(MoeaError::TooManyDirections { .. })), "{refused:?}");
            }
        }
    }
    assert_eq!(das_dennis(1, usize::MAX), Ok(vec![1.0]));
}

#[test]
fn more_objectives_than_anyone_can_mean_are_refused() {
    let problem = Wide(1001);
    let refused = MoeaError::TooManyObjectives { objectives: 1001, most: 1000 };
    assert_eq!(optimise(&problem, &Settings::default(), silent).unwrap_err(), refused);
    for directions in [Directions::Usual, Directions::FromPopulation, Directions::Divisions(0)] {
        for objectives in [100_000, usize::MAX] {
            let refused = MoeaError::TooManyObjectives { objectives, most: 1000 };
            assert_eq!(directions.points(objectives, 92), Err(refused));
        }
    }
    assert!(das_dennis(usize::MAX, 0).is_err() && Benchmark::named("DTLZ2", usize::MAX).is_none());
}

/// So many objectives.
struct Wide(usize);

impl Problem for Wide {
    type Workspace = ();

    fn bounds(&self) -> Vec<(f64, f64)> {
        vec![(0.0, 1.0)]
    }

    fn objectives(&self) -> usize {
        self.0
    }

    fn evaluate(&self, x: &[f64], f: &mut [f64], (): &mut ()) -> f64 {
        f.fill(x[0]);
        0.0
    }
}

#[test]
fn directions_are_formed_for_those_alone_that_use_them() {
    for name in ["nsga2", "age-moea-2", "sms-emoa", "msops2"] {
        let algorithm = moea::NamedAlgorithm::find(name).unwrap().algorithm;
        let budget = moea::Budget::Evaluations(8);
        let settings = Settings { algorithm, population: Some(8), budget, ..Settings::default() };
        assert_eq!(optimise(&Wide(1000), &settings, silent).unwrap().population.len(), 8, "{name}");
        let none = Settings { directions: Directions::Own(Vec::new()), ..settings };
        assert!(optimise(&Wide(2), &none, silent).is_err(), "{name}");
    }
    // Of very many objectives there is one direction each, and no more than are allowed.
    let budget = moea::Budget::Evaluations(2);
    let settings = Settings { population: Some(8), budget, ..Settings::default() };
    assert!(optimise(&Wide(1000), &settings, silent).is_ok());
    let settings = Settings { directions: Directions::Divisions(2), ..settings };
    assert!(optimise(&Wide(1000), &settings, silent).is_err());
}

#[test]
fn a_survival_for_directions_refuses_none_and_those_of_another_length() {
    for make in [Niching::new, Niching::filled_by_crowding] {
        assert_eq!(make(&[], 2).unwrap_err(), MoeaError::DirectionCount { given: 0, most: 100_000 });
        assert_eq!(make(&[], 0).unwrap_err(), MoeaError::NoObjectives);
        let short = MoeaError::Direction { index: 1, found: Unsound::Length(1), wanted: 2 };
        assert_eq!(make(&[1.0, 0.0, 1.0], 2).unwrap_err(), short);
        assert!(
            make(&[0.0, 0.0], 2).is_err() && make(&[NAN, 1.0], 2).is_err() && make(&[-1.0, 1.0], 2).is_err()
        );
        assert!(make(&[1.0; 4], usize::MAX).is_err());
        assert!(make(&[1.0, 0.0, 0.5, 0.5], 2).is_ok());
    }
}

fn survivals() -> Vec<Box<dyn Survival>> {
    let directions = das_dennis(3, 4).unwrap();
    vec![
        Box::<Crowding>::default(),
        Box::<Geodesic>::default(),
        Box::<LeastContribution>::default(),
        Box::new(Niching::new(&directions, 3).unwrap()),
        Box::new(Niching::filled_by_crowding(&directions, 3).unwrap()),
    ]
}

#[test]
fn every_survival_keeps_as_many_as_asked_of_populations_of_any_shape() {
    for at in 0..survivals().len() {
        for m in 0..6 {
            for value in [0.0, 1e300, -1e300, 1e-300, NAN, INF, -INF] {
                for keep in [0, 1, 3, 7, 9] {
                    let mut population = Population::with_capacity(1, m, 7);
                    for i in 0..7 {
                        let f: Vec<f64> =
                            (0..m).map(|k| if i == k { value } else { 0.1 * i as f64 }).collect();
                        population.push(&[0.0], &f, if i == 5 { 1.0 } else { 0.0 });
                    }
                    let (mut chosen, mut ranking) = (Vec::new(), Ranking::default());
                    let mut rng = Random::of_survival(1);
                    survivals()[at].select(&population, keep, &mut rng, &mut chosen, &mut ranking);
                    chosen.sort_unstable();
                    chosen.dedup();
                    assert_eq!(chosen.len(), keep.min(7), "survival {at}, {m} objectives, {value}");
                }
            }
        }
    }
}

#[test]
fn populations_archives_and_sorting_take_any_number() {
    let huge = Population::with_capacity(usize::MAX, 3, usize::MAX);
    assert!(huge.is_empty());
    let one = Population::from_objectives(&[1.0, 2.0], 2);
    assert!(one.x(0).is_empty() && one.f(1).is_empty() && one.f(usize::MAX).is_empty());
    assert!(one.violation(1) == INF && !one.is_feasible(usize::MAX));
    let mut sorting = Sorting::default();
    sorting.sort(&one, &[0, 1, usize::MAX]);
    assert_eq!((sorting.count(), sorting.front(0), sorting.front(9)), (1, &[0][..], &[][..]));
    assert!(Population::from_objectives(&[1.0], usize::MAX).is_empty());
    assert_eq!(Population::from_objectives(&[-0.0, 2.0, 0.0, 1.0], 2).front(), [1], "zero has no sign");
    let mut nan = Population::with_capacity(0, 1, 1);
    nan.push(&[], &[-0.0], -NAN);
    assert!(nan.violation(0) == INF && nan.f(0)[0].is_sign_positive());
    let mut archive = Archive::new(usize::MAX, usize::MAX, 0);
    archive.extend(&one);
    assert!(archive.into_population().is_empty());
    assert!(!dominates(&[], &[1.0]) && !dominates(&[NAN], &[1.0]));
}

#[test]
fn indicators_take_any_number() {
    let sets: [&[f64]; 6] =
        [&[], &[1.0], &[NAN; 6], &[INF; 6], &[-INF; 6], &[1.0, NAN, 0.5, 0.5, 2.0, -1e300]];
    for set in sets {
        for reference in [&[][..], &[1.0], &[NAN, 1.0], &[1.0, 1.0], &[1.0; 3], &[1e300; 3], &[1.0; 7]] {
            let volume = hypervolume(set, reference);
            let fits =
                reference.iter().all(|r| r.is_finite()) && set.len().is_multiple_of(reference.len().max(1));
            assert!(volume >= 0.0 || !fits, "{set:?} {reference:?}: {volume}");
            for contribution in contributions(set, reference) {
                let fits = set.len().is_multiple_of(reference.len().max(1));
                assert!(contribution >= 0.0 || !fits, "{set:?} {reference:?}: {contribution}");
            }
            for m in [0, 1, 2, 3, usize::MAX] {
                let _ = (igd(set, reference, m), igd_plus(set, reference, m));
            }
        }
    }
}

/// Chooses parents, or survivors, that do not exist.
struct Astray;

impl Mating for Astray {
    fn pair(&mut self, _: &MatingContext<'_>, children: usize, _: &mut Random, pairs: &mut Vec<Pair>) {
        pairs.clear();
        pairs.resize(children, Pair::of(0, usize::MAX));
    }
}

impl Survival for Astray {
    fn select(
        &mut self,
        merged: &Population,
        _: usize,
        _: &mut Random,
        chosen: &mut Vec<usize>,
        ranking: &mut Ranking,
    ) {
        ranking.clear();
        chosen.clear();
        chosen.extend([0, merged.len(), usize::MAX]);
    }
}

#[test]
fn parents_and_survivors_that_do_not_exist_are_left_out() {
    let problem = Benchmark::named("DTLZ2", 3).unwrap();
    let run = optimise_with(&problem, &Settings::default(), Astray, Crowding::default(), silent).unwrap();
    assert_eq!((run.evaluations, run.population.len()), (92, 92));
    let run = optimise_with(&problem, &Settings::default(), Tournament::default(), Astray, silent).unwrap();
    assert_eq!(run.population.len(), 1);
}

#[test]
fn benchmarks_take_any_shape_and_their_fronts_stay_small() {
    for name in NAMES {
        let problem = Benchmark::named(name, 3).or_else(|| Benchmark::named(name, 2)).unwrap();
        let objectives = problem.objectives();
        let wide = vec![0.5; problem.bounds().len()];
        for x in [&[][..], &[0.5], &wide, &[wide.clone(), vec![0.5]].concat()] {
            for m in [0, 2, 3, 4] {
                let mut f = vec![0.0; m];
                let violation = problem.evaluate(x, &mut f, &mut Vec::new());
                let fits = x.len() == wide.len() && m == objectives;
                assert_eq!(violation < INF, fits, "{name} {} {m}", x.len());
            }
        }
        for value in [NAN, INF, -INF, 1e300, -1.0] {
            problem.evaluate(&vec![value; wide.len()], &mut vec![0.0; objectives], &mut Vec::new());
        }
        assert!(problem.with_variables(2, usize::MAX - 2).is_none());
        assert!(!problem.front(0).is_empty() && !problem.front(1).is_empty());
        let Some(many) = Benchmark::named(name, 40) else { continue };
        let points = many.front(100).len() / 40;
        assert!((1..=20_000).contains(&points), "{name}: {points}");
        assert!(many.nadir().iter().all(|nadir| nadir.is_finite()));
    }
    assert!(Benchmark::named("DTLZ5", 3).unwrap().front(usize::MAX).len() <= 3_000_000);
}

#[test]
fn fronts_of_curves_and_parts_have_nearly_as_many_points_as_asked_for_and_none_is_dominated() {
    for name in ["WFG1", "WFG2", "DTLZ7", "MW1", "MW2", "MW3"] {
        for m in [2, 3, 5, 8] {
            let Some(problem) = Benchmark::named(name, m) else { continue };
            for count in [150, 1000] {
                let front = problem.front(count);
                let points = front.len() / m;
                let least = if name == "DTLZ7" { count / 2 } else { count * 3 / 4 };
                assert!((least..=count).contains(&points), "{name}, {m} objectives: {points} of {count}");
                let all = Population::from_objectives(&front, m);
                assert_eq!(all.front().len(), points, "{name}, {m} objectives, {count}");
            }
        }
    }
    // A point of WFG2 whose last objective is no less than that of a smaller first parameter is none of the front.
    let problem = Benchmark::named("WFG2", 3).unwrap().with_variables(2, 2).unwrap();
    let front = problem.front(1000);
    let mut f = [0.0; 3];
    for i in 0..=1000 {
        for j in 0..=20 {
            let x = [0.002 * f64::from(i), 0.2 * f64::from(j), 6.0 * 0.35, 8.0 * 0.35];
            problem.evaluate(&x, &mut f, &mut Vec::new());
            let beaten = front.chunks_exact(3).find(|z| f.iter().zip(*z).all(|(f, z)| *f < z - 1e-6));
            assert!(beaten.is_none(), "{f:?} beats {beaten:?}");
        }
    }
}

/// Parents that are all alike, whose children are to stay as they are.
struct Unchanged;

impl moea::Mating for Unchanged {
    fn pair(
        &mut self,
        _: &moea::MatingContext<'_>,
        children: usize,
        _: &mut moea::Random,
        pairs: &mut Vec<moea::Pair>,
    ) {
        assert!(pairs.is_empty());
        pairs.resize(children.div_ceil(2), moea::Pair { first: 0, second: 0, crossover: 0.0, mutation: 0.0 });
    }
}

/// A survival that keeps one member.
struct One;

impl moea::Survival for One {
    fn select(
        &mut self,
        _: &moea::Population,
        keep: usize,
        _: &mut moea::Random,
        chosen: &mut Vec<usize>,
        _: &mut moea::Ranking,
    ) {
        assert_eq!(keep, 12);
        *chosen = vec![0];
    }
}

#[test]
fn parts_of_a_caller_s_own_get_what_is_promised() {
    let settings =
        Settings { population: Some(12), budget: moea::Budget::Evaluations(60), ..Settings::default() };
    let found = moea::optimise_with(&Wide(2), &settings, Unchanged, One, silent).unwrap();
    assert_eq!((found.evaluations, found.population.len()), (60, 1));
    let all = &found.population;
    assert!((0..all.len()).all(|i| all.x(i) == all.x(0)));
}
