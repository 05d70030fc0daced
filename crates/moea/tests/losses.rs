//! Where the default form of NSGA-III-FO falls behind: many objectives with local fronts, and feasible regions in
//! parts. The tables of `docs/moea.md` are printed by
//!
//! ```text
//! cargo test --release -p hydrotrace-moea --test losses -- --ignored --nocapture
//! ```

#![allow(clippy::unwrap_used)]

use std::f64::consts::FRAC_PI_2;

use moea::{
    Bounds, Budget, NamedAlgorithm, Population, Problem, Settings, benchmark::Benchmark, compare::Reference,
    optimise, silent,
};
use rayon::prelude::*;

const ALGORITHMS: [&str; 3] = ["nsga3-fo", "nsga3-fo-local", "nsga3"];

/// Never used to choose a setting.
const FIRST_SEED: u64 = 7001;

/// Last populations, one a seed.
fn runs<P: Problem>(problem: &P, name: &str, budget: Budget, seeds: u64) -> Vec<Population> {
    let algorithm = NamedAlgorithm::find(name).unwrap().algorithm;
    let run = |seed| {
        let settings = Settings { algorithm, seed, budget, ..Settings::default() };
        optimise(problem, &settings, silent).unwrap().population
    };
    (FIRST_SEED..FIRST_SEED + seeds).into_par_iter().map(run).collect()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}

#[test]
#[ignore = "three minutes, in release"]
fn many_objectives_with_local_fronts() {
    println!("| problem | objectives | evaluations | {} |", ALGORITHMS.join(" | "));
    for (name, m, points) in
        [("DTLZ1", 4, 120), ("DTLZ3", 4, 120), ("DTLZ1", 5, 210), ("DTLZ3", 5, 210), ("DTLZ3", 8, 156)]
    {
        let problem = Benchmark::named(name, m).unwrap();
        let front = problem.front(points);
        for evaluations in [50_000, 200_000] {
            let igd = |algorithm| {
                let budget = Budget::Evaluations(evaluations);
                let igd = runs(&problem, algorithm, budget, 11)
                    .into_iter()
                    .map(|found| moea::indicator::igd(found.all_f(), &front, m));
                format!("{:.4}", median(igd.collect()))
            };
            println!("| {name} | {m} | {evaluations} | {} |", ALGORITHMS.map(igd).join(" | "));
        }
    }
}

/// MW7 (Ma and Wang 2019): 15 variables, a band about a circle, thinner and thicker by turns.
struct Mw7;

impl Problem for Mw7 {
    type Workspace = ();

    fn bounds(&self) -> Vec<Bounds> {
        vec![(0.0, 1.0); 15]
    }

    fn objectives(&self) -> usize {
        2
    }

    fn evaluate(&self, x: &[f64], f: &mut [f64], (): &mut ()) -> f64 {
        let g = 1.0 + x.windows(2).map(|x| 2.0 * (x[1] + (x[0] - 0.5).powi(2) - 1.0).powi(2)).sum::<f64>();
        (f[0], f[1]) = (g * x[0], g * (1.0 - x[0] * x[0]).sqrt());
        let (inner, outer) = band(f[1].atan2(f[0]));
        let square = f[0] * f[0] + f[1] * f[1];
        (square - outer * outer).max(0.0) + (inner * inner - square).max(0.0)
    }

    fn is_cheap(&self) -> bool {
        true
    }
}

/// Least and largest radius that MW7 allows at an angle.
fn band(angle: f64) -> (f64, f64) {
    let wave = (4.0 * angle).sin();
    (1.15 - 0.2 * wave.powi(8), 1.2 + 0.4 * wave.powi(16))
}

/// OSY (Osyczka and Kundu 1995): six variables, six constraints, a front in five parts.
struct Osy;

impl Problem for Osy {
    type Workspace = ();

    fn bounds(&self) -> Vec<Bounds> {
        vec![(0.0, 10.0), (0.0, 10.0), (1.0, 5.0), (0.0, 6.0), (1.0, 5.0), (0.0, 10.0)]
    }

    fn objectives(&self) -> usize {
        2
    }

    fn evaluate(&self, x: &[f64], f: &mut [f64], (): &mut ()) -> f64 {
        let apart = x.iter().zip([2.0, 2.0, 1.0, 4.0, 1.0]).map(|(x, at)| (x - at).powi(2));
        let sum: f64 = apart.zip([25.0, 1.0, 1.0, 1.0, 1.0]).map(|(square, weight)| weight * square).sum();
        (f[0], f[1]) = (-sum, x.iter().map(|x| x * x).sum());
        let kept = [
            (x[0] + x[1] - 2.0) / 2.0,
            (6.0 - x[0] - x[1]) / 6.0,
            1.0 - (x[1] - x[0]) / 2.0,
            1.0 - (x[0] - 3.0 * x[1]) / 2.0,
            (4.0 - (x[2] - 3.0).powi(2) - x[3]) / 4.0,
            ((x[4] - 3.0).powi(2) + x[5] - 4.0) / 4.0,
        ];
        kept.iter().map(|kept| (-kept).max(0.0)).sum()
    }

    fn is_cheap(&self) -> bool {
        true
    }
}

/// The least feasible radius of MW7 at many angles.
fn front_of_mw7() -> Vec<f64> {
    let at = |i: u32| FRAC_PI_2 * f64::from(i) / 4000.0;
    let feasible = (0..=4000).map(at).filter(|&angle| band(angle).0.max(1.0) <= band(angle).1);
    feasible
        .map(|angle| (angle, band(angle).0.max(1.0)))
        .flat_map(|(a, r)| [r * a.cos(), r * a.sin()])
        .collect()
}

/// The five edges that OSY's front lies on.
fn front_of_osy() -> Vec<f64> {
    let mut flat = Vec::new();
    for i in 0..=200 {
        let u = f64::from(i) / 200.0;
        let x0 = 4.056 + 0.944 * u;
        for x in [
            [5.0, 1.0, 1.0 + 4.0 * u, 0.0, 5.0, 0.0],
            [5.0, 1.0, 1.0, 0.0, 1.0 + 4.0 * u, 0.0],
            [x0, (x0 - 2.0) / 3.0, 1.0, 0.0, 1.0, 0.0],
            [0.0, 2.0, 1.0 + 2.732 * u, 0.0, 1.0, 0.0],
            [u, 2.0 - u, 1.0, 0.0, 1.0, 0.0],
        ] {
            let mut f = [0.0; 2];
            Osy.evaluate(&x, &mut f, &mut ());
            flat.extend(f);
        }
    }
    flat
}

/// Prints the collapses of 200 runs: hypervolumes below nine tenths of the front's.
fn collapses<P: Problem>(name: &str, problem: &P, front: &[f64]) -> [usize; 3] {
    let all = Population::from_objectives(front, 2);
    let front: Vec<f64> = all.front().into_iter().flat_map(|i| all.f(i).to_vec()).collect();
    let whole = Population::from_objectives(&front, 2);
    let reference = Reference::new(front, 2);
    let volume =
        |found: &Population| reference.measure(found).hypervolume / reference.measure(&whole).hypervolume;
    let of = |algorithm| {
        let volumes: Vec<f64> =
            runs(problem, algorithm, Budget::Evaluations(20_000), 200).iter().map(volume).collect();
        (volumes.iter().filter(|v| **v < 0.9).count(), format!("{:.4}", median(volumes)))
    };
    let found = ALGORITHMS.map(of);
    println!(
        "| {name} | {} |",
        found.each_ref().map(|(lost, median)| format!("{lost}, {median}")).join(" | ")
    );
    found.map(|(lost, _)| lost)
}

#[test]
#[ignore = "two minutes, in release"]
fn feasible_regions_in_parts() {
    println!("| collapses of 200, median hypervolume | {} |", ALGORITHMS.join(" | "));
    for lost in [collapses("MW7", &Mw7, &front_of_mw7()), collapses("OSY", &Osy, &front_of_osy())] {
        let [spread, local, nsga3] = lost;
        assert!(spread <= 60 && local <= 40 && nsga3 <= 40, "{lost:?}");
    }
}
