//! Runs that ask and are told: equal to `optimise`, taken up again, refused.

#![allow(clippy::unwrap_used, clippy::float_cmp)]

use moea::{
    ALGORITHMS, Bounds, Budget, MoeaError, Problem, Record, Run, Settings, Tournament, Uniform,
    benchmark::Benchmark, optimise, silent,
};

/// WFG1, a third of it infeasible, with holes that are infinite.
struct Holes(Benchmark);

impl Problem for Holes {
    type Workspace = Vec<f64>;

    fn bounds(&self) -> Vec<Bounds> {
        self.0.bounds()
    }

    fn objectives(&self) -> usize {
        3
    }

    fn evaluate(&self, x: &[f64], f: &mut [f64], workspace: &mut Vec<f64>) -> f64 {
        self.0.evaluate(x, f, workspace);
        if x[0] < 0.05 {
            f[1] = f64::INFINITY;
        }
        x[2] - 4.0
    }
}

fn problem() -> Holes {
    Holes(Benchmark::named("WFG1", 3).unwrap())
}

/// Evaluates what is asked for.
fn tell(problem: &Holes, run: &mut Run) {
    let (mut objectives, mut violations) = (Vec::new(), Vec::new());
    for x in run.ask() {
        let mut f = [0.0; 3];
        violations.push(problem.evaluate(x, &mut f, &mut Vec::new()));
        objectives.extend(f);
    }
    run.tell(&objectives, &violations).unwrap();
}

#[test]
fn a_run_that_asks_finds_what_optimise_finds_and_is_taken_up_from_its_record() {
    let problem = problem();
    for named in ALGORITHMS {
        for budget in [Budget::Evaluations(1001), Budget::Generations(7), Budget::Evaluations(30)] {
            let settings =
                Settings { algorithm: named.algorithm, budget, archive: 40, ..Settings::default() };
            let want = optimise(&problem, &settings, silent).unwrap();
            let mut run = Run::new(&problem.bounds(), 3, &settings).unwrap();
            for _ in 0..3 {
                tell(&problem, &mut run);
            }
            let written = serde_json::to_string(run.record()).unwrap();
            let made = run.progress().evaluations;
            let read: Record = serde_json::from_str(&written).unwrap();
            let mut run = Run::resume(&problem.bounds(), 3, &settings, &read).unwrap();
            assert_eq!(run.progress().evaluations, made);
            while !run.is_over() {
                tell(&problem, &mut run);
            }
            assert!(run.ask().is_empty());
            assert_eq!(run.into_outcome(), want, "{} {budget:?}", named.name);
        }
    }
}

#[test]
fn values_and_records_that_do_not_fit_are_refused_and_change_nothing() {
    let problem = problem();
    let settings = Settings { budget: Budget::Generations(3), ..Settings::default() };
    let mut run = Run::new(&problem.bounds(), 3, &settings).unwrap();
    let asked: Vec<Vec<f64>> = run.ask().iter().map(|x| x.to_vec()).collect();
    let refused = MoeaError::Told { objectives: 3, violations: 92, members: 92, wanted: 276 };
    assert_eq!(run.tell(&[0.0; 3], &[0.0; 92]), Err(refused));
    assert_eq!(run.ask(), asked);
    assert!(run.progress().population.is_empty());
    tell(&problem, &mut run);
    tell(&problem, &mut run);
    let resumed = |settings: &Settings| Run::resume(&problem.bounds(), 3, settings, run.record()).map(|_| ());
    assert_eq!(resumed(&settings), Ok(()));
    assert_eq!(resumed(&Settings { seed: 2, ..settings.clone() }), Err(MoeaError::Record { evaluation: 0 }));
    let shorter = Settings { budget: Budget::Generations(1), ..settings.clone() };
    assert_eq!(resumed(&shorter), Err(MoeaError::Record { evaluation: 92 }));
    // Other mating, other children.
    let mut other =
        Run::with(&problem.bounds(), 3, &settings, Tournament::default(), moea::Crowding::default()).unwrap();
    assert_eq!(other.replay(run.record()), Err(MoeaError::Record { evaluation: 92 }));
}

#[test]
fn a_mating_without_pairs_ends_the_run() {
    struct Nobody;
    impl moea::Mating for Nobody {
        fn pair(
            &mut self,
            _: &moea::MatingContext<'_>,
            _: usize,
            _: &mut moea::Random,
            pairs: &mut Vec<moea::Pair>,
        ) {
            pairs.clear();
        }
    }
    let settings = Settings::default();
    let run = |mating| {
        let survival = moea::Crowding::default();
        moea::optimise_with(&problem(), &settings, mating, survival, silent).unwrap().evaluations
    };
    assert_eq!(run(Nobody), 92);
    let uniform = Uniform::default();
    let all = moea::optimise_with(&problem(), &settings, uniform, moea::Crowding::default(), silent);
    assert_eq!(all.unwrap().evaluations, 20_000);
}
