//! Runs that end by tolerance: not before they are good, and not without a feasible member.

#![allow(clippy::unwrap_used)]

use moea::{
    Bounds, Budget, NamedAlgorithm, Problem, Run, Settings, Tolerance, benchmark::Benchmark,
    compare::Reference, optimise, silent,
};

#[test]
fn a_run_ends_early_with_nearly_the_quality_of_a_long_one() {
    for name in ["DTLZ2", "WFG4"] {
        let problem = Benchmark::named(name, 3).unwrap();
        let reference = Reference::of(&problem, 500);
        let settings = Settings { budget: Budget::Evaluations(60_000), ..Settings::default() };
        let mut tolerance = Tolerance::new(2e-4, 40);
        let ended = optimise(&problem, &settings, |progress| tolerance.watch(progress)).unwrap();
        let long = optimise(&problem, &settings, silent).unwrap();
        let [short, long] = [&ended, &long].map(|run| reference.measure(&run.population).hypervolume);
        assert!(ended.evaluations < 50_000, "{name}: {}", ended.evaluations);
        assert!(short > 0.97 * long, "{name}: {short} {long}");
    }
}

#[test]
fn a_tolerance_compares_each_generation_once_and_starts_anew_with_a_new_run() {
    let problem = Benchmark::named("DTLZ2", 3).unwrap();
    for algorithm in ["moead", "nsga3-fo"] {
        let algorithm = NamedAlgorithm::find(algorithm).unwrap().algorithm;
        let settings = Settings { algorithm, ..Settings::default() };
        let mut tolerance = Tolerance::new(1e-3, 20);
        let ends = |tolerance: &mut Tolerance| {
            optimise(&problem, &settings, |progress| tolerance.watch(progress)).unwrap().evaluations
        };
        let once = ends(&mut tolerance);
        assert_eq!(ends(&mut tolerance), once, "used again");
        let mut run = Run::new(problem.bounds(), 3, &settings).unwrap();
        let mut f = [0.0; 3];
        while tolerance.watch(&run.progress()).is_continue() {
            let told: Vec<f64> = run
                .ask()
                .into_iter()
                .flat_map(|x| {
                    problem.evaluate(x, &mut f, &mut Vec::default());
                    f
                })
                .collect();
            run.tell(&told, &vec![0.0; told.len() / 3]).unwrap();
        }
        assert_eq!(run.into_outcome().evaluations, once, "by a run");
    }
}

/// A bowl whose one objective, and the second of two, is `least` at the bottom, in a unit.
struct Bowl {
    objectives: usize,
    least: f64,
    unit: f64,
}

impl Problem for Bowl {
    type Workspace = ();

    fn bounds(&self) -> Vec<Bounds> {
        vec![(-1.0, 2.0); 4]
    }

    fn objectives(&self) -> usize {
        self.objectives
    }

    fn evaluate(&self, x: &[f64], f: &mut [f64], (): &mut ()) -> f64 {
        f.fill(self.unit * (x.iter().map(|x| x * x).sum::<f64>() + self.least));
        0.0
    }

    fn is_cheap(&self) -> bool {
        true
    }
}

#[test]
fn a_run_whose_front_is_a_point_ends_at_the_same_time_whatever_the_origin_and_the_unit() {
    let settings = Settings { budget: Budget::Generations(400), ..Settings::default() };
    for objectives in [1, 2] {
        let ends = |least: f64, unit: f64| {
            let mut tolerance = Tolerance::new(1e-3, 10);
            let problem = Bowl { objectives, least, unit };
            optimise(&problem, &settings, |progress| tolerance.watch(progress)).unwrap().generations
        };
        let generations = ends(0.0, 1.0);
        assert!((20..200).contains(&generations), "{objectives}: {generations}");
        for (least, unit) in [(-64.0, 1.0), (1024.0, 1.0), (0.0, 1_048_576.0), (0.0, 1.0 / 1_048_576.0)] {
            let moved = ends(least, unit);
            assert!(
                moved.abs_diff(generations) <= 10,
                "{objectives}, {least} {unit}: {moved}, not {generations}"
            );
        }
    }
}

/// Nothing is feasible.
struct Never;

impl Problem for Never {
    type Workspace = ();

    fn bounds(&self) -> Vec<Bounds> {
        vec![(0.0, 1.0)]
    }

    fn objectives(&self) -> usize {
        2
    }

    fn evaluate(&self, _: &[f64], f: &mut [f64], (): &mut ()) -> f64 {
        f.fill(1.0);
        1.0
    }
}

#[test]
fn without_a_feasible_member_nothing_ends_and_a_flat_front_ends_at_once() {
    struct Flat;
    impl Problem for Flat {
        type Workspace = ();

        fn bounds(&self) -> Vec<Bounds> {
            vec![(0.0, 1.0)]
        }

        fn objectives(&self) -> usize {
            2
        }

        fn evaluate(&self, _: &[f64], f: &mut [f64], (): &mut ()) -> f64 {
            f.fill(0.0);
            0.0
        }
    }
    let settings = Settings { budget: Budget::Generations(30), ..Settings::default() };
    let mut tolerance = Tolerance::new(1e-3, 0);
    let run = optimise(&Never, &settings, |progress| tolerance.watch(progress)).unwrap();
    assert_eq!(run.generations, 30);
    let mut tolerance = Tolerance::new(1e-3, 5);
    let run = optimise(&Flat, &settings, |progress| tolerance.watch(progress)).unwrap();
    assert_eq!(run.generations, 10);
}

#[test]
fn a_least_gain_that_is_none_counts_as_nothing() {
    let settings = Settings { budget: Budget::Generations(2000), ..Settings::default() };
    let ends = |least: f64| {
        let mut tolerance = Tolerance::new(least, 5);
        let problem = Bowl { objectives: 1, least: 0.0, unit: 1.0 };
        optimise(&problem, &settings, |progress| tolerance.watch(progress)).unwrap().generations
    };
    let nothing = ends(0.0);
    assert!(nothing < 2000, "{nothing}");
    for least in [f64::NAN, -1.0, f64::NEG_INFINITY] {
        assert_eq!(ends(least), nothing, "{least}");
    }
}

#[test]
fn a_run_that_is_taken_up_again_ends_by_its_tolerance_where_it_would_have_in_one_go() {
    let bounds = [(0.0, 1.0); 3];
    for algorithm in ["nsga3-fo", "moead"] {
        let algorithm = NamedAlgorithm::find(algorithm).unwrap().algorithm;
        let settings = Settings { algorithm, budget: Budget::Observer, ..Settings::default() };
        let go_on = |run: &mut Run, tolerance: &mut Tolerance, stop: u64| {
            while run.progress().generation < stop {
                let f: Vec<f64> =
                    run.ask().into_iter().flat_map(|x| [x[0], 1.0 - x[0] + x[1] + x[2]]).collect();
                run.tell(&f, &vec![0.0; f.len() / 2]).unwrap();
                if tolerance.watch(&run.progress()).is_break() {
                    return;
                }
            }
        };
        let fresh = || (Run::new(bounds, 2, &settings).unwrap(), Tolerance::new(1e-3, 20));
        let (mut once, mut tolerance) = fresh();
        go_on(&mut once, &mut tolerance, 400);
        let end = once.progress().generation;
        assert!((40..400).contains(&end));
        for stop in [1, 25, end - 15, end - 1] {
            let (mut first, mut tolerance) = fresh();
            go_on(&mut first, &mut tolerance, stop);
            let (mut again, mut tolerance) = fresh();
            again
                .replay_watched(first.record(), |progress| assert!(tolerance.watch(progress).is_continue()))
                .unwrap();
            go_on(&mut again, &mut tolerance, 400);
            assert_eq!(again.progress().generation, end, "{stop}");
        }
    }
}
