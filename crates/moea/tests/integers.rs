//! Integers among the variables: fronts that are known, and what is evaluated, in every algorithm.

#![allow(clippy::unwrap_used, clippy::float_cmp)]

use std::{collections::BTreeSet, ops::ControlFlow};

use moea::{
    ALGORITHMS, Bounds, Budget, Crowding, Kind, MoeaError, NamedAlgorithm, Outcome, Population, Problem,
    Random, Record, Run, Settings, Tournament, Variables, optimise, optimise_with, silent,
};

fn settings(algorithm: NamedAlgorithm, evaluations: u64) -> Settings {
    let budget = Budget::Evaluations(evaluations);
    Settings { algorithm: algorithm.algorithm, budget, ..Settings::default() }
}

/// Weighted squares of the distances of four integers from two points; 923 521 solutions.
struct Lattice;

impl Problem for Lattice {
    type Workspace = ();

    fn bounds(&self) -> Vec<Bounds> {
        vec![(-10.0, 20.0); 4]
    }

    fn kinds(&self) -> Vec<Kind> {
        vec![Kind::Integer; 4]
    }

    fn objectives(&self) -> usize {
        2
    }

    fn evaluate(&self, x: &[f64], f: &mut [f64], (): &mut ()) -> f64 {
        let from = |to: f64| x.iter().zip(1..).map(|(x, weight)| f64::from(weight) * (x - to).powi(2)).sum();
        (f[0], f[1]) = (from(0.0), from(3.0));
        0.0
    }

    fn is_cheap(&self) -> bool {
        true
    }
}

/// Objectives of the front, each once.
fn front(population: &Population) -> BTreeSet<Vec<u64>> {
    let bits = |i: usize| population.f(i).iter().map(|f| f.to_bits()).collect();
    population.front().into_iter().map(bits).collect()
}

#[test]
fn the_front_of_an_integer_problem_is_found_to_the_last_point() {
    // What lies not between the two points is dominated by what does.
    let mut all = Population::with_capacity(4, 2, 256);
    for i in 0..256_u32 {
        let x = [0, 2, 4, 6].map(|digit| f64::from((i >> digit) & 3));
        let mut f = [0.0; 2];
        Lattice.evaluate(&x, &mut f, &mut ());
        all.push(&x, &f, 0.0);
    }
    let want = front(&all);
    assert!(want.len() > 20, "{}", want.len());
    for algorithm in ALGORITHMS {
        for seed in 1..=3 {
            let settings = Settings { archive: 200, seed, ..settings(algorithm, 8000) };
            let found = front(&optimise(&Lattice, &settings, silent).unwrap().archive.unwrap());
            // The normalised MOEA/D keeps no ends, and may miss one.
            let missed = usize::from(algorithm.name == "moead-normalized");
            assert!(found.is_subset(&want), "{}, seed {seed}", algorithm.name);
            assert!(found.len() + missed >= want.len(), "{}, seed {seed}: {}", algorithm.name, found.len());
        }
    }
    let usual = Settings::default();
    assert_eq!(front(&optimise(&Lattice, &usual, silent).unwrap().population), want);
}

/// Steps that are far apart in value where they are near in number: a neighbour is worse than a far one.
struct Rugged;

impl Problem for Rugged {
    type Workspace = ();

    fn bounds(&self) -> Vec<Bounds> {
        vec![(0.0, 40.0); 3]
    }

    fn kinds(&self) -> Vec<Kind> {
        vec![Kind::Integer; 3]
    }

    fn objectives(&self) -> usize {
        1
    }

    fn evaluate(&self, x: &[f64], f: &mut [f64], (): &mut ()) -> f64 {
        f[0] = x.iter().map(|x| (17.0 * x) % 41.0).sum();
        0.0
    }
}

#[test]
fn no_local_optimum_holds_a_search_of_integers() {
    for algorithm in ALGORITHMS {
        let settings = Settings { archive: 1, ..settings(algorithm, 8000) };
        let found = optimise(&Rugged, &settings, silent).unwrap().archive.unwrap();
        assert_eq!((found.x(0), found.f(0)), (&[0.0; 3][..], &[0.0][..]), "{}", algorithm.name);
    }
}

/// A real variable within a stage that an integer chooses: stages 2, 3 and 4 make the front.
struct Stages;

impl Problem for Stages {
    type Workspace = ();

    fn bounds(&self) -> Vec<Bounds> {
        vec![(-1.0, 2.0), (0.0, 6.9)]
    }

    fn kinds(&self) -> Vec<Kind> {
        vec![Kind::Real, Kind::Integer]
    }

    fn objectives(&self) -> usize {
        2
    }

    fn evaluate(&self, x: &[f64], f: &mut [f64], (): &mut ()) -> f64 {
        (f[0], f[1]) = (x[0].powi(2) + (x[1] - 2.0).powi(2), (x[0] - 1.0).powi(2) + (x[1] - 4.0).powi(2));
        0.0
    }
}

#[test]
fn the_front_of_a_mixed_problem_is_found_in_all_its_stages() {
    let curve = (2..=4).flat_map(|stage| (0..=200).map(move |i| (f64::from(stage), f64::from(i) / 200.0)));
    let mut all = Population::with_capacity(2, 2, 603);
    for (stage, at) in curve {
        let mut f = [0.0; 2];
        Stages.evaluate(&[at, stage], &mut f, &mut ());
        all.push(&[at, stage], &f, 0.0);
    }
    let front: Vec<f64> = all.front().into_iter().flat_map(|i| all.f(i).to_vec()).collect();
    let stages = |p: &Population| p.front().iter().map(|&i| p.x(i)[1].to_bits()).collect::<BTreeSet<u64>>();
    for algorithm in ALGORITHMS {
        let settings = Settings { archive: 200, ..settings(algorithm, 10_000) };
        let found = optimise(&Stages, &settings, silent).unwrap().archive.unwrap();
        let distance = moea::indicator::igd_plus(found.all_f(), &front, 2);
        assert!(distance < 0.02, "{}: {distance}", algorithm.name);
        assert_eq!(stages(&found), stages(&all), "{}", algorithm.name);
    }
}

/// Any variables; an evaluation of an `x` that they do not allow panics.
struct Strict {
    bounds: Vec<Bounds>,
    kinds: Vec<Kind>,
    cheap: bool,
}

impl Problem for Strict {
    type Workspace = ();

    fn bounds(&self) -> Vec<Bounds> {
        self.bounds.clone()
    }

    fn kinds(&self) -> Vec<Kind> {
        self.kinds.clone()
    }

    fn objectives(&self) -> usize {
        3
    }

    fn evaluate(&self, x: &[f64], f: &mut [f64], (): &mut ()) -> f64 {
        for ((&x, &(lower, upper)), kind) in x.iter().zip(&self.bounds).zip(&self.kinds) {
            assert!((lower..=upper).contains(&x), "{x} in {lower} to {upper}");
            let whole = x.fract() == 0.0 && (x != 0.0 || x.is_sign_positive());
            assert!(*kind == Kind::Real || whole, "{x} in {lower} to {upper}");
        }
        let size = |x: f64, bounds: Bounds| (x - bounds.0) / (bounds.1 - bounds.0).max(1e-9);
        let sum: f64 = x.iter().zip(&self.bounds).skip(2).map(|(x, bounds)| size(*x, *bounds)).sum();
        (f[0], f[1], f[2]) =
            (size(x[0], self.bounds[0]), size(x[1], self.bounds[1]), 2.0 - x[0].signum() + sum);
        sum - 2.5
    }

    fn is_cheap(&self) -> bool {
        self.cheap
    }
}

/// Five variables of random kinds and bounds, narrow, wide or fixed, and members that fit none of them.
fn strict(seed: u64) -> (Strict, Vec<Vec<f64>>) {
    let mut rng = Random::of_survival(seed);
    let scales = [1.0, 4.0, 30.0, 1e4, 1.9e15];
    let (mut bounds, mut kinds) = (Vec::new(), Vec::new());
    for _ in 0..5 {
        let scale = scales[rng.below(scales.len())];
        let mut any = |width: f64| (rng.unit() - 0.5) * width;
        let (a, b) = (any(scale), any(scale));
        let (lower, upper) = (a.min(b), a.max(b));
        let real = any(1.0) < -0.2 || lower.ceil() > upper.floor();
        kinds.push(if real { Kind::Real } else { Kind::Integer });
        bounds.push(if any(1.0) > 0.4 && !real { (upper.floor(), upper.floor()) } else { (lower, upper) });
    }
    let initial = (0..3).map(|_| (0..5).map(|_| rng.unit() * 50.0 - 25.0).collect()).collect();
    (Strict { bounds, kinds, cheap: true }, initial)
}

#[test]
fn whatever_is_evaluated_holds_integers_within_their_bounds() {
    for seed in 0..12 {
        let (problem, initial) = strict(seed);
        for algorithm in ALGORITHMS {
            let settings = Settings { seed, initial: initial.clone(), ..settings(algorithm, 600) };
            assert_eq!(optimise(&problem, &settings, silent).unwrap().evaluations, 600);
        }
        let settings = Settings { initial, budget: Budget::Evaluations(600), ..Settings::default() };
        let (mating, survival) = (Tournament::default(), Crowding::default());
        // A reference to a problem has its kinds, too.
        optimise_with(&&problem, &settings, mating, survival, silent).unwrap();
    }
}

#[test]
fn integers_are_alike_at_the_start_those_at_the_bounds_too() {
    let problem = Strict {
        bounds: vec![(-1.0, 1.0), (0.3, 4.7), (0.0, 1.0), (-3.5, -0.5), (7.0, 7.0)],
        kinds: vec![Kind::Integer; 5],
        cheap: true,
    };
    let budget = Budget::Generations(1);
    let settings = Settings { population: Some(6000), budget, ..Settings::default() };
    let mut start = Vec::new();
    optimise(&problem, &settings, |progress| {
        start.extend((0..progress.population.len()).map(|i| progress.population.x(i).to_vec()));
        ControlFlow::Continue(())
    })
    .unwrap();
    for (k, values) in
        [vec![-1.0, 0.0, 1.0], vec![1.0, 2.0, 3.0, 4.0], vec![0.0, 1.0], vec![-3.0, -2.0, -1.0]]
            .into_iter()
            .enumerate()
    {
        for value in &values {
            let share = start.iter().filter(|x| x[k] == *value).count() as f64 / start.len() as f64;
            // Four standard deviations.
            assert!((share - 1.0 / values.len() as f64).abs() < 0.026, "{k}: {value} {share}");
        }
    }
    assert!(start.iter().all(|x| x[4] == 7.0));
}

fn tell(problem: &Strict, run: &mut Run) {
    let (mut objectives, mut violations) = (Vec::new(), Vec::new());
    for x in run.ask() {
        let mut f = [0.0; 3];
        violations.push(problem.evaluate(x, &mut f, &mut ()));
        objectives.extend(f);
    }
    run.tell(&objectives, &violations).unwrap();
}

#[test]
fn a_run_that_asks_and_threads_and_a_record_give_the_same_bytes() {
    let (problem, initial) = strict(4);
    assert!(problem.kinds.contains(&Kind::Real) && problem.kinds.contains(&Kind::Integer));
    for algorithm in ALGORITHMS {
        let settings = Settings { initial: initial.clone(), ..settings(algorithm, 500) };
        let want: Outcome = optimise(&problem, &settings, silent).unwrap();
        let (many, _) = strict(4);
        assert_eq!(optimise(&Strict { cheap: false, ..many }, &settings, silent).unwrap(), want);
        let mut run = Run::new(Variables::of(&problem), 3, &settings).unwrap();
        tell(&problem, &mut run);
        tell(&problem, &mut run);
        let record: Record = serde_json::from_str(&serde_json::to_string(run.record()).unwrap()).unwrap();
        let mut run = Run::resume(Variables::of(&problem), 3, &settings, &record).unwrap();
        while !run.is_over() {
            tell(&problem, &mut run);
        }
        assert_eq!(run.into_outcome(), want, "{}", algorithm.name);
        // Of real variables the record is not.
        let real = Run::resume(&problem.bounds, 3, &settings, &record).map(|_| ());
        assert_eq!(real, Err(MoeaError::Record { evaluation: 0 }));
    }
}

#[test]
fn spaces_of_fewer_members_than_the_population_end_and_are_searched_through() {
    struct Switches;
    impl Problem for Switches {
        type Workspace = ();
        fn bounds(&self) -> Vec<Bounds> {
            vec![(0.0, 1.0); 3]
        }
        fn kinds(&self) -> Vec<Kind> {
            vec![Kind::Integer; 3]
        }
        fn objectives(&self) -> usize {
            2
        }
        fn evaluate(&self, x: &[f64], f: &mut [f64], (): &mut ()) -> f64 {
            (f[0], f[1]) = (x[0] + x[1] - x[2], x[2] - x[0]);
            0.0
        }
    }
    for algorithm in ALGORITHMS {
        let found = optimise(&Switches, &settings(algorithm, 1000), silent).unwrap();
        assert_eq!(found.evaluations, 1000);
        assert!(
            found.population.front().iter().all(|&i| found.population.x(i)[1] == 0.0),
            "{}",
            algorithm.name
        );
    }
}

#[test]
fn integers_that_cannot_be_are_refused_with_their_numbers() {
    let error = |bounds: &[Bounds], kinds: &[Kind]| {
        Run::new(Variables::new(bounds.to_vec(), kinds.to_vec()), 2, &Settings::default()).map(|_| ())
    };
    let (real, integer) = (Kind::Real, Kind::Integer);
    for (lower, upper) in [(0.2, 0.8), (0.0, 2e15), (-1e300, 3.0)] {
        let want = Err(MoeaError::Integer { index: 1, lower, upper });
        assert_eq!(error(&[(0.0, 1.0), (lower, upper)], &[real, integer]), want);
    }
    assert_eq!(error(&[(0.0, 1.0)], &[real, integer]), Err(MoeaError::Kinds { given: 2, wanted: 1 }));
    assert_eq!(error(&[(0.2, 0.8)], &[real]), Ok(()));
    assert_eq!(error(&[(0.2, 0.8)], &[]), Ok(()));
    let swapped = error(&[(3.0, 2.0)], &[integer]);
    assert_eq!(swapped, Err(MoeaError::Bounds { index: 0, lower: 3.0, upper: 2.0 }));
}
