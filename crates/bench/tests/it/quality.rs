//! What the algorithms reach: against pymoo, against each other, at any scale.
//!
//! `tests/reference/moea-pymoo-nsga3.json` is written by `pymoo_nsga3.py` beside it.

use hydrotrace::math::median;
use hydrotrace_bench::{
    problems,
    study::{Against, Inputs, Verdict, quartiles, run},
};
use moea::{
    Algorithm, Bounds, Budget, Operators, Problem, Settings, benchmark::Benchmark, compare::Reference,
    indicator::igd, optimise, silent,
};
use rayon::prelude::*;
use serde_json::Value;

use super::shared;

fn reference(name: &str) -> Value {
    let path = format!("{}/tests/reference/{name}", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

fn settings(algorithm: Algorithm, seed: u64, evaluations: u64) -> Settings {
    Settings { algorithm, seed, budget: Budget::Evaluations(evaluations), ..Settings::default() }
}

/// Deb and Jain's settings: 92 members, generations by problem. The gate on the median.
const CONFORMANCE: [(&str, u64, f64); 4] =
    [("DTLZ1", 400, 2.0e-3), ("DTLZ2", 250, 1.8e-3), ("DTLZ3", 1000, 6e-3), ("DTLZ4", 600, 8e-4)];

fn conforms(seeds: std::ops::RangeInclusive<u64>) {
    let pymoo = reference("moea-pymoo-nsga3.json");
    for (name, generations, gate) in CONFORMANCE {
        let problem = Benchmark::named(name, 3).unwrap();
        let reference = Reference::of(&problem, 91);
        let seeds: Vec<u64> = seeds.clone().collect();
        let reached = |&seed: &u64| {
            let settings = settings(Algorithm::Nsga3, seed, 92 * generations);
            reference.measure(&optimise(&problem, &settings, silent).unwrap().population).igd
        };
        let igd: Vec<f64> = seeds.par_iter().map(reached).collect();
        let theirs = numbers(&pymoo["problems"][name.to_lowercase()]["igd"]);
        let against = Against::of(&igd, &theirs, true);
        let best = igd.iter().copied().fold(f64::INFINITY, f64::min);
        let worst = igd.iter().copied().fold(0.0, f64::max);
        let collapses = igd.iter().filter(|&&v| v > 5e-2).count();
        println!(
            "{name} {generations}: best {best:.3e} median {:.3e} worst {worst:.3e}, {collapses} collapsed; \
             pymoo median {:.3e}, p {:.3}, A {:.2}",
            median(igd.clone()),
            median(theirs.clone()),
            against.p,
            against.a12
        );
        assert!(median(igd.clone()) <= gate, "{name}: median {:e}", median(igd));
        assert!(collapses * 20 <= 3 * seeds.len(), "{name}: {collapses} of {} collapsed", seeds.len());
        assert_ne!(against.verdict, Verdict::Loss, "{name} is worse than pymoo: p = {}", against.p);
    }
}

#[test]
fn nsga3_reaches_the_published_quality_on_seven_seeds() {
    conforms(1..=7);
}

#[test]
#[ignore = "slow: 20 seeds of four problems"]
fn nsga3_reaches_the_published_quality_on_twenty_seeds() {
    conforms(1..=20);
}

/// DTLZ2 with its objectives scaled and shifted.
struct Stretched(Benchmark);

const SCALE: [f64; 3] = [1e-3, 1.0, 1e3];
const SHIFT: [f64; 3] = [10.0, -3.0, 100.0];

impl Problem for Stretched {
    type Workspace = Vec<f64>;

    fn bounds(&self) -> Vec<Bounds> {
        self.0.bounds()
    }

    fn objectives(&self) -> usize {
        3
    }

    fn evaluate(&self, x: &[f64], f: &mut [f64], workspace: &mut Vec<f64>) -> f64 {
        let violation = self.0.evaluate(x, f, workspace);
        f.iter_mut().zip(SCALE.iter().zip(SHIFT)).for_each(|(f, (scale, shift))| *f = *f * scale + shift);
        violation
    }

    fn is_cheap(&self) -> bool {
        true
    }
}

#[test]
fn scale_and_origin_of_objectives_do_not_matter() {
    for algorithm in [Algorithm::Nsga3, Algorithm::NSGA3_FO] {
        // So many that each search has come to its end, where the median of eleven seeds says something.
        for (name, evaluations) in [("DTLZ2", 20_000), ("DTLZ1", 50_000)] {
            let problem = Benchmark::named(name, 3).unwrap();
            let front = problem.front(91);
            let (mut plain, mut stretched) = (Vec::new(), Vec::new());
            for seed in 1..=11 {
                let settings = settings(algorithm, seed, evaluations);
                let run = optimise(&problem, &settings, silent).unwrap();
                plain.push(igd(run.population.all_f(), &front, 3));
                let run = optimise(&Stretched(problem), &settings, silent).unwrap();
                let back: Vec<f64> = run
                    .population
                    .all_f()
                    .iter()
                    .enumerate()
                    .map(|(i, f)| (f - SHIFT[i % 3]) / SCALE[i % 3])
                    .collect();
                stretched.push(igd(&back, &front, 3));
            }
            let against = Against::of(&stretched, &plain, true);
            let [was, is] = [&plain, &stretched].map(|sample| quartiles(sample)[1]);
            println!("{algorithm:?} {name}: {was:.3e}, stretched {is:.3e}");
            assert!(against.verdict != Verdict::Loss && is < 1.3 * was, "{against:?}");
        }
    }
}

/// The comparison of docs/moea.md.
#[test]
#[ignore = "slow: 31 seeds of 27 cells"]
fn the_focus_wins_at_least_twelve_cells_and_loses_at_most_two() {
    let problems = ["DTLZ1", "DTLZ2", "DTLZ3", "DTLZ4", "DTLZ7", "WFG1", "WFG2", "WFG3", "WFG9"];
    let problems = problems.map(|name| Benchmark::named(name, 3).unwrap());
    let shared = shared(&["nsga3-fo", "nsga3"], &[5_000, 20_000, 50_000]);
    let shared = Inputs { first_seed: 1, seeds: 31, steps: 0, fronts: false, ..shared };
    let inputs = problems::inputs(&problems, Operators::default(), shared);
    let study = run(&inputs, || ()).unwrap();
    for cell in study.cells.iter().filter(|cell| cell.algorithm == "nsga3-fo") {
        let name = cell.subject.as_str();
        let early = ["DTLZ3", "WFG3", "WFG1"].contains(&name);
        let late = ["DTLZ3", "WFG3"].contains(&name);
        if (cell.evaluations == 5_000 && early) || (cell.evaluations == 20_000 && late) {
            assert_eq!(cell.samples["igd"].against.unwrap().verdict, Verdict::Win, "{cell:?}");
        }
    }
    let counts = &study.tallies[0].counts;
    for key in ["igd", "hypervolume"] {
        let [wins, _, losses] = counts[key];
        assert!(wins >= 12 && losses <= 2, "{counts:?}");
    }
}
