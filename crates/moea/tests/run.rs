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
            let mut run = Run::new(problem.bounds(), 3, &settings).unwrap();
            for _ in 0..3 {
                tell(&problem, &mut run);
            }
            let written = serde_json::to_string(run.record()).unwrap();
            let made = run.progress().evaluations;
            let read: Record = serde_json::from_str(&written).unwrap();
            let mut run = Run::resume(problem.bounds(), 3, &settings, &read).unwrap();
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
    let mut run = Run::new(problem.bounds(), 3, &settings).unwrap();
    let asked: Vec<Vec<f64>> = run.ask().iter().map(|x| x.to_vec()).collect();
    let refused = MoeaError::Told { objectives: 3, violations: 92, members: 92, wanted: 276 };
    assert_eq!(run.tell(&[0.0; 3], &[0.0; 92]), Err(refused));
    assert_eq!(run.ask(), asked);
    assert!(run.progress().population.is_empty());
    tell(&problem, &mut run);
    tell(&problem, &mut run);
    let resumed = |settings: &Settings| Run::resume(problem.bounds(), 3, settings, run.record()).map(|_| ());
    assert_eq!(resumed(&settings), Ok(()));
    assert_eq!(resumed(&Settings { seed: 2, ..settings.clone() }), Err(MoeaError::Record { evaluation: 0 }));
    let shorter = Settings { budget: Budget::Generations(1), ..settings.clone() };
    assert_eq!(resumed(&shorter), Err(MoeaError::Record { evaluation: 92 }));
    // Other mating, other children.
    let mut other =
        Run::with(problem.bounds(), 3, &settings, Tournament::default(), moea::Crowding::default()).unwrap();
    assert_eq!(other.replay(run.record()), Err(MoeaError::Record { evaluation: 92 }));
}

#[test]
fn values_are_told_once_and_of_members_that_were_asked_for() {
    // NSGA-III breeds as many as there are members: the same values fit again.
    let settings = Settings { algorithm: moea::Algorithm::Nsga3, ..Settings::default() };
    let mut run = Run::new(problem().bounds(), 3, &settings).unwrap();
    let (objectives, violations) = ([1.0; 276], [0.0; 92]);
    assert_eq!(run.tell(&objectives, &violations), Err(MoeaError::NotAsked { evaluations: 0 }));
    assert_eq!(run.ask().len(), 92);
    assert_eq!(run.tell(&objectives, &violations), Ok(()));
    assert_eq!(run.tell(&objectives, &violations), Err(MoeaError::NotAsked { evaluations: 92 }));
    assert_eq!((run.progress().evaluations, run.ask().len()), (92, 92));
    assert_eq!(run.tell(&objectives, &violations), Ok(()));
}

#[test]
fn a_record_is_of_a_new_run_with_the_same_settings_to_its_last_value() {
    let problem = problem();
    let settings = Settings { budget: Budget::Generations(4), ..Settings::default() };
    let mut run = Run::new(problem.bounds(), 3, &settings).unwrap();
    tell(&problem, &mut run);
    // The first members are the same by any algorithm, those that they breed are not.
    let other = Settings { algorithm: moea::Algorithm::Nsga2, ..settings.clone() };
    let refused = Err(MoeaError::Record { evaluation: 92 });
    assert_eq!(Run::resume(problem.bounds(), 3, &other, run.record()).map(|_| ()), refused);
    // Nor is a run that was told already told again.
    let record = run.record().clone();
    assert_eq!(run.replay(&record), refused);
    assert_eq!(run.replay(&Record::default()), refused);
    assert_eq!(run.record(), &record);
}

/// Distances in a square, each constraint in a unit of its own; some violations are no numbers.
struct Sliver;

impl Problem for Sliver {
    type Workspace = ();

    fn bounds(&self) -> Vec<Bounds> {
        vec![(0.0, 1.0); 4]
    }

    fn objectives(&self) -> usize {
        2
    }

    fn evaluate(&self, x: &[f64], f: &mut [f64], (): &mut ()) -> f64 {
        (f[0], f[1]) = (x[0], (1.0 - x[0]).powi(2) + x[2] * x[2] + x[3] * x[3]);
        0.0
    }

    fn constraints(&self) -> usize {
        2
    }

    fn violations(&self, x: &[f64], _: &[f64], violations: &mut [f64], (): &mut ()) {
        violations[0] = (x.iter().sum::<f64>() - 1.6) * 1e6;
        violations[1] = if x[0] < 0.02 { f64::NAN } else { (0.7 - x[1]) * 1e-3 };
    }
}

/// Tells objectives, and violations of single constraints.
fn tell_each(run: &mut Run) {
    let (mut objectives, mut violations) = (Vec::new(), Vec::new());
    for x in run.ask() {
        let (mut f, mut each) = ([0.0; 2], [0.0; 2]);
        Sliver.evaluate(x, &mut f, &mut ());
        Sliver.violations(x, &f, &mut each, &mut ());
        objectives.extend(f);
        violations.extend(each);
    }
    run.tell_each(&objectives, &violations).unwrap();
}

#[test]
fn constraints_told_one_by_one_are_those_of_optimise_and_are_taken_up_from_a_record() {
    for named in ALGORITHMS {
        let budget = Budget::Evaluations(1500);
        let settings = Settings { algorithm: named.algorithm, budget, ..Settings::default() };
        let want = optimise(&Sliver, &settings, silent).unwrap();
        let mut run = Run::new(Sliver.bounds(), 2, &settings).unwrap();
        for _ in 0..2 {
            tell_each(&mut run);
        }
        let written = serde_json::to_string(run.record()).unwrap();
        let read: Record = serde_json::from_str(&written).unwrap();
        let mut run = Run::resume(Sliver.bounds(), 2, &settings, &read).unwrap();
        while !run.is_over() {
            tell_each(&mut run);
        }
        assert_eq!(run.into_outcome(), want, "{}", named.name);
    }
}

#[test]
fn the_number_of_constraints_does_not_change_in_a_run() {
    let mut run = Run::new(Sliver.bounds(), 2, &Settings::default()).unwrap();
    assert_eq!(run.ask().len(), 100);
    let part = MoeaError::ToldEach { violations: 150, members: 100, constraints: None };
    assert_eq!(run.tell_each(&[0.5; 200], &[0.0; 150]), Err(part));
    assert_eq!(run.tell_each(&[0.5; 200], &[0.0; 300]), Ok(()));
    let members = run.ask().len();
    let f = vec![0.5; 2 * members];
    let other = MoeaError::ToldEach { violations: 0, members, constraints: Some(3) };
    assert_eq!(run.tell(&f, &vec![0.0; members]), Err(other));
    assert_eq!(run.tell_each(&f, &vec![0.0; 3 * members]), Ok(()));
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

#[test]
fn a_record_with_damaged_values_is_refused_and_one_without_checksums_is_read() {
    let settings = Settings {
        algorithm: moea::Algorithm::Nsga2,
        population: Some(8),
        budget: Budget::Evaluations(24),
        ..Settings::default()
    };
    let problem = problem();
    let mut run = Run::new(problem.bounds(), 3, &settings).unwrap();
    while !run.is_over() {
        tell(&problem, &mut run);
    }
    let sound = serde_json::to_value(run.record()).unwrap();
    let resumed = |value: &serde_json::Value| {
        let record: Record = serde_json::from_value(value.clone()).unwrap();
        Run::resume(problem.bounds(), 3, &settings, &record).map(Run::into_outcome)
    };
    for bit in [0, 20, 50, 63] {
        for at in 0..32 {
            let mut damaged = sound.clone();
            let value = &mut damaged["batches"][2]["values"][at];
            *value = (value.as_u64().unwrap() ^ (1 << bit)).into();
            assert_eq!(resumed(&damaged), Err(MoeaError::Damaged { evaluation: 16 }), "{bit} {at}");
        }
    }
    let mut old = sound.clone();
    for batch in old["batches"].as_array_mut().unwrap() {
        assert!(batch.as_object_mut().unwrap().remove("checksum").is_some());
    }
    assert_eq!(resumed(&old).unwrap(), resumed(&sound).unwrap());
}
