//! Units of the objectives.

#![allow(clippy::unwrap_used)]

use moea::{
    ALGORITHMS, Bounds, Budget, NamedAlgorithm, Outcome, Problem, Settings, benchmark::Benchmark, optimise,
    silent,
};

/// A problem whose objectives have units of powers of two, which change no digit.
struct Scaled(Benchmark, [f64; 3]);

impl Problem for Scaled {
    type Workspace = Vec<f64>;

    fn bounds(&self) -> Vec<Bounds> {
        self.0.bounds()
    }

    fn objectives(&self) -> usize {
        3
    }

    fn evaluate(&self, x: &[f64], f: &mut [f64], workspace: &mut Vec<f64>) -> f64 {
        let violation = self.0.evaluate(x, f, workspace);
        f.iter_mut().zip(self.1).for_each(|(f, unit)| *f *= unit);
        violation
    }

    fn is_cheap(&self) -> bool {
        true
    }
}

#[test]
fn units_of_the_objectives_matter_to_two_algorithms_only() {
    for named in ALGORITHMS {
        for name in ["DTLZ2", "WFG3"] {
            let run = |units| -> Outcome {
                let NamedAlgorithm { algorithm, .. } = named;
                let settings =
                    Settings { algorithm, budget: Budget::Evaluations(3000), ..Settings::default() };
                optimise(&Scaled(Benchmark::named(name, 3).unwrap(), units), &settings, silent).unwrap()
            };
            let (plain, scaled) = (run([1.0; 3]).population, run([1.0 / 1024.0, 1.0, 1024.0]).population);
            let equal = (0..plain.len()).all(|i| plain.x(i) == scaled.x(i));
            assert_eq!(equal, !["moead", "msops2"].contains(&named.name), "{} on {name}", named.name);
        }
    }
}
