//! Constraints that are told one by one: units, feasibility, what is no number.

#![allow(clippy::unwrap_used, clippy::float_cmp)]

use moea::{Bounds, Budget, NamedAlgorithm, Outcome, Problem, Settings, optimise, silent};

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

#[test]
fn a_total_is_the_sum_of_shares_of_the_largest_violations() {
    let settings = Settings { budget: Budget::Generations(1), ..Settings::default() };
    let first = optimise(&SLIVER, &settings, silent).unwrap().population;
    let each = |i: usize| {
        let x = first.x(i);
        [x.iter().sum::<f64>() - 1.6, 0.7 - x[1]].map(|v| v.max(0.0))
    };
    let largest = [0, 1].map(|j| (0..first.len()).map(|i| each(i)[j]).fold(0.0, f64::max));
    for i in 0..first.len() {
        let want: f64 = each(i).iter().zip(largest).map(|(v, largest)| v / largest).sum();
        assert!((first.violation(i) - want).abs() < 1e-12, "{i}: {} {want}", first.violation(i));
    }
}
