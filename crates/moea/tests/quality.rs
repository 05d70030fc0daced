//! AGE-MOEA-II and SMS-EMOA beside NSGA-III. The table of `docs/moea.md` is printed by
//!
//! ```text
//! cargo test --release -p hydrotrace-moea --test quality -- --ignored --nocapture
//! ```

#![allow(clippy::unwrap_used)]

use moea::{
    Budget, NamedAlgorithm, Settings,
    benchmark::Benchmark,
    compare::{Quality, Reference},
    optimise, silent,
};

/// Never used to choose a setting.
const FIRST_SEED: u64 = 7001;

/// Quality of a run for each seed.
fn runs(name: &str, problem: &Benchmark, evaluations: u64, seeds: u64) -> Vec<Quality> {
    let reference = Reference::of(problem, 1000);
    let run = |seed| {
        let algorithm = NamedAlgorithm::find(name).unwrap().algorithm;
        let settings =
            Settings { algorithm, seed, budget: Budget::Evaluations(evaluations), ..Settings::default() };
        reference.measure(&optimise(problem, &settings, silent).unwrap().population)
    };
    (FIRST_SEED..FIRST_SEED + seeds).map(run).collect()
}

/// Smaller is better.
type Indicator = fn(&Quality) -> f64;
const INDICATORS: [Indicator; 3] = [|q| q.igd, |q| q.igd_plus, |q| -q.hypervolume];

fn median(runs: &[Quality], indicator: Indicator) -> f64 {
    let mut values: Vec<f64> = runs.iter().map(indicator).collect();
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Probability that a run is better than one of the others.
fn better(runs: &[Quality], others: &[Quality], indicator: Indicator) -> f64 {
    let pairs = runs.iter().flat_map(|a| others.iter().map(move |b| (indicator(a), indicator(b))));
    let points = pairs.map(|(a, b)| if a < b { 1.0 } else { f64::from(u8::from(a <= b)) / 2.0 });
    points.sum::<f64>() / (runs.len() * others.len()) as f64
}

#[test]
#[ignore = "a minute, in release"]
fn medians_beside_those_of_nsga3() {
    println!(
        "| problem | algorithm | IGD | A | IGD+ | A | hypervolume | A |\n|---|---|---|---|---|---|---|---|"
    );
    for name in ["DTLZ2", "DTLZ7", "WFG1", "WFG2", "WFG3"] {
        let problem = Benchmark::named(name, 3).unwrap();
        let baseline = runs("nsga3", &problem, 20_000, 11);
        for algorithm in ["age-moea-2", "sms-emoa", "nsga3"] {
            let runs = runs(algorithm, &problem, 20_000, 11);
            let cells = INDICATORS.map(|indicator| {
                let better = better(&runs, &baseline, indicator);
                let better = if algorithm == "nsga3" { "-".to_owned() } else { format!("{better:.2}") };
                format!("{:.4} | {better}", median(&runs, indicator).abs())
            });
            println!("| {name} | {algorithm} | {} |", cells.join(" | "));
            let [_, plus, volume] = INDICATORS.map(|indicator| median(&runs, indicator));
            let [_, base_plus, base_volume] = INDICATORS.map(|indicator| median(&baseline, indicator));
            assert!(plus < 1.15 * base_plus, "{name}, {algorithm}: IGD+ {plus}, NSGA-III {base_plus}");
            assert!(-volume > 0.99 * -base_volume, "{name}, {algorithm}: {volume}, NSGA-III {base_volume}");
        }
    }
}

#[test]
fn without_directions_a_front_that_is_a_curve_is_covered_better() {
    let problem = Benchmark::named("WFG3", 3).unwrap();
    let [age, sms, nsga3] = ["age-moea-2", "sms-emoa", "nsga3"].map(|name| runs(name, &problem, 5000, 3));
    for runs in [age, sms] {
        for indicator in INDICATORS {
            assert!(median(&runs, indicator) < median(&nsga3, indicator), "{runs:?} {nsga3:?}");
        }
    }
}

#[test]
fn decomposition_into_few_directions_finds_the_whole_front() {
    let problem = Benchmark::named("DTLZ1", 3).unwrap();
    let reference = Reference::of(&problem, 1000);
    for (divisions, most) in [(5, 0.055), (6, 0.045)] {
        for name in ["moead", "moead-normalized"] {
            let algorithm = NamedAlgorithm::find(name).unwrap().algorithm;
            let run = |seed| {
                let directions = moea::Directions::Divisions(divisions);
                let settings = Settings { algorithm, directions, seed, ..Settings::default() };
                reference.measure(&optimise(&problem, &settings, silent).unwrap().population)
            };
            let runs: Vec<Quality> = (1..=7).map(run).collect();
            assert!(median(&runs, |q| q.igd) < most, "{name}: {runs:?}");
        }
    }
}
