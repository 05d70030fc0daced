//! Constraints that are told one by one: units, feasibility, what is no number.

#![allow(clippy::unwrap_used, clippy::float_cmp)]

use moea::{
    Bounds, Budget, NamedAlgorithm, Outcome, Problem, Random, Settings, benchmark::Benchmark,
    compare::Reference, optimise, silent,
};

/// Two distances in a square of which a sliver is feasible; each constraint in a unit of its own.
struct Sliver {
    units: [f64; 2],
    cheap: bool,
    /// Below this, `x[0]` violates the second constraint by NaN.
    hole: f64,
}

impl Problem for Sliver {
    type Workspace = f64;

    fn bounds(&self) -> Vec<Bounds> {
        vec![(0.0, 1.0); 4]
    }

    fn objectives(&self) -> usize {
        2
    }

    fn evaluate(&self, x: &[f64], f: &mut [f64], sum: &mut f64) -> f64 {
        *sum = x.iter().sum();
        (f[0], f[1]) = (x[0], (1.0 - x[0]).powi(2) + x[2..].iter().map(|x| x * x).sum::<f64>());
        0.0
    }

    fn constraints(&self) -> usize {
        2
    }

    fn violations(&self, x: &[f64], _: &[f64], violations: &mut [f64], sum: &mut f64) {
        violations[0] = (*sum - 1.6) * self.units[0];
        violations[1] = if x[0] < self.hole { f64::NAN } else { (0.7 - x[1]) * self.units[1] };
    }

    fn is_cheap(&self) -> bool {
        self.cheap
    }
}

const SLIVER: Sliver = Sliver { units: [1.0; 2], cheap: true, hole: 0.0 };

fn run(problem: &Sliver, name: &str) -> Outcome {
    let algorithm = NamedAlgorithm::find(name).unwrap().algorithm;
    let settings = Settings { algorithm, budget: Budget::Evaluations(3000), ..Settings::default() };
    optimise(problem, &settings, silent).unwrap()
}

#[test]
fn the_unit_of_a_constraint_and_the_number_of_threads_do_not_matter() {
    for name in ["nsga3-fo", "nsga3", "nsga2", "moead", "msops2"] {
        let plain = run(&SLIVER, name);
        // Powers of two change no digit of a quotient.
        assert_eq!(plain, run(&Sliver { units: [1_048_576.0, 1.0 / 1024.0], ..SLIVER }, name), "{name}");
        assert_eq!(plain, run(&Sliver { cheap: false, ..SLIVER }, name), "{name}");
    }
}

#[test]
fn survivors_keep_every_constraint_and_a_violation_that_is_no_number_is_the_worst() {
    let found = run(&Sliver { hole: 0.3, ..SLIVER }, "nsga3-fo").population;
    assert!(found.len() > 90);
    for i in 0..found.len() {
        let x = found.x(i);
        assert!(found.is_feasible(i) && x.iter().sum::<f64>() <= 1.6 && x[1] >= 0.7 && x[0] >= 0.3, "{x:?}");
    }
}

fn each(x: &[f64]) -> [f64; 2] {
    [x.iter().sum::<f64>() - 1.6, 0.7 - x[1]].map(|v| v.max(0.0))
}

#[test]
fn a_total_is_the_sum_of_shares_of_the_upper_quartiles() {
    let settings = Settings { budget: Budget::Generations(1), ..Settings::default() };
    let first = optimise(&SLIVER, &settings, silent).unwrap().population;
    let quartile = [0, 1].map(|j| {
        let mut above: Vec<f64> =
            (0..first.len()).map(|i| each(first.x(i))[j]).filter(|v| *v > 0.0).collect();
        above.sort_by(f64::total_cmp);
        above[above.len() * 3 / 4]
    });
    for i in 0..first.len() {
        let want: f64 = each(first.x(i)).iter().zip(quartile).map(|(v, quartile)| v / quartile).sum();
        assert!((first.violation(i) - want).abs() < 1e-12, "{i}: {} {want}", first.violation(i));
    }
}

#[test]
fn totals_of_all_members_are_in_the_same_scales() {
    // Nearly all violate the sum, so that its scale changes as they come nearer.
    let far = Sliver { units: [1.0, 1e-3], ..SLIVER };
    for name in ["nsga3-fo", "nsga2", "moead"] {
        let algorithm = NamedAlgorithm::find(name).unwrap().algorithm;
        let settings = Settings { algorithm, budget: Budget::Generations(3), ..Settings::default() };
        let mut seen = 0;
        optimise(&far, &settings, |progress| {
            let population = progress.population;
            let broken = |i: usize, j: usize| each(population.x(i))[j] > 0.0;
            // Members that break the first constraint alone: all totals are in the one scale.
            let alone = (0..population.len()).filter(|&i| broken(i, 0) && !broken(i, 1));
            let scales: Vec<f64> =
                alone.map(|i| each(population.x(i))[0] / population.violation(i)).collect();
            seen += scales.len();
            assert!(scales.iter().all(|scale| (scale / scales[0] - 1.0).abs() < 1e-9), "{name}: {scales:?}");
            std::ops::ControlFlow::Continue(())
        })
        .unwrap();
        assert!(seen > 20, "{name}: {seen}");
    }
}

/// Distances of `x[2]`, `x[3]`, where `x[0]` is to be large and `x[0] + x[1]` 1; the first constraint or the second one
/// with a long tail.
struct Thin {
    tail: bool,
}

impl Problem for Thin {
    type Workspace = ();

    fn bounds(&self) -> Vec<Bounds> {
        vec![(0.0, 1.0); 4]
    }

    fn objectives(&self) -> usize {
        2
    }

    fn evaluate(&self, x: &[f64], f: &mut [f64], (): &mut ()) -> f64 {
        (f[0], f[1]) = (x[2] + x[3], 1.0 - x[2] + x[3]);
        0.0
    }

    fn constraints(&self) -> usize {
        2
    }

    fn violations(&self, x: &[f64], _: &[f64], violations: &mut [f64], (): &mut ()) {
        violations[0] = if self.tail { (40.0 * x[1]).exp() - 4_f64.exp() } else { 0.8 - x[0] };
        violations[1] = (x[0] + x[1] - 1.0).abs() - 1e-3;
    }

    fn is_cheap(&self) -> bool {
        true
    }
}

#[test]
fn first_members_that_nearly_keep_a_constraint_and_long_tails_do_not_keep_a_run_from_the_feasible() {
    for (tail, off) in [(true, 0.0), (false, 1e-2), (false, 1e-6), (false, 1e-12)] {
        for name in ["nsga3-fo", "nsga3", "nsga2"] {
            for seed in 1..=5 {
                let mut rng = Random::of_survival(seed);
                let mut near = || {
                    let a = 0.3 * rng.unit();
                    vec![a, 1.0 - a + 1e-3 + off * rng.unit(), rng.unit(), rng.unit()]
                };
                let initial = if tail { Vec::new() } else { (0..100).map(|_| near()).collect() };
                let algorithm = NamedAlgorithm::find(name).unwrap().algorithm;
                let settings =
                    Settings { algorithm, population: Some(100), initial, seed, ..Settings::default() };
                let found = optimise(&Thin { tail }, &settings, silent).unwrap().population;
                assert!(found.is_feasible(0), "{name}, {off:e}, seed {seed}");
            }
        }
    }
}

/// Where a few members first meet one part of the feasible region, the focus must not take all from there.
#[test]
fn the_focus_misses_no_parts_of_the_feasible_region_that_are_found_without_it() {
    for (name, objectives) in [("MW1", 2), ("MW4", 3)] {
        let problem = Benchmark::named(name, objectives).unwrap();
        let reference = Reference::of(&problem, 300);
        let found = |algorithm: &str| {
            let algorithm = NamedAlgorithm::find(algorithm).unwrap().algorithm;
            let mut distances: Vec<f64> = (7001..7018)
                .map(|seed| {
                    let settings = Settings { algorithm, seed, ..Settings::default() };
                    reference.measure(&optimise(&problem, &settings, silent).unwrap().population).igd_plus
                })
                .collect();
            distances.sort_by(f64::total_cmp);
            (distances[8], distances.iter().filter(|distance| distance.is_infinite()).count())
        };
        let ((focus, none), (plain, none_plain)) = (found("nsga3-fo"), found("nsga3"));
        assert!(
            none <= none_plain + 1,
            "{name}: {none} of 17 runs find nothing feasible, {none_plain} without"
        );
        assert!(focus <= 1.25 * plain, "{name}: median IGD+ {focus}, without the focus {plain}");
    }
}
