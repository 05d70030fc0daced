//! Survivors of fixed populations: those of pymoo, whatever the units, and of populations that are no front.

#![allow(clippy::unwrap_used, clippy::float_cmp)]

use moea::{Geodesic, LeastContribution, Population, Random, Ranking, Survival};
use serde_json::Value;

/// A new one for every selection.
type Make = fn() -> Box<dyn Survival>;

const SURVIVALS: [(&str, Make); 2] =
    [("age-moea-2", || Box::<Geodesic>::default()), ("sms-emoa", || Box::<LeastContribution>::default())];

/// Survivors of `keep` places and the findings on them.
fn select(name: &str, population: &Population, keep: usize) -> (Vec<usize>, Ranking) {
    let (_, make) = SURVIVALS.iter().find(|(known, _)| *known == name).unwrap();
    let (mut chosen, mut ranking) = (Vec::new(), Ranking::default());
    make().select(population, keep, &mut Random::of_survival(1), &mut chosen, &mut ranking);
    (chosen, ranking)
}

/// Survivors in ascending order.
fn survivors(name: &str, f: &[f64], m: usize, keep: usize) -> Vec<usize> {
    let (mut chosen, _) = select(name, &Population::from_objectives(f, m), keep);
    chosen.sort_unstable();
    chosen
}

struct Case {
    name: String,
    f: Vec<f64>,
    m: usize,
    kept: Vec<usize>,
    /// What pymoo keeps as it is, if it departs from the paper.
    unchanged: Option<Vec<usize>>,
}

fn cases() -> Vec<Case> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/reference/moea-values.json");
    let values: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let places = |value: &Value| -> Option<Vec<usize>> {
        let places = value.as_array()?.iter().map(|i| usize::try_from(i.as_u64().unwrap()).unwrap());
        Some(places.collect())
    };
    let numbers =
        |row: &Value| -> Vec<f64> { row.as_array().unwrap().iter().map(|f| f.as_f64().unwrap()).collect() };
    let case = |case: &Value| {
        let rows: Vec<Vec<f64>> = case["f"].as_array().unwrap().iter().map(numbers).collect();
        Case {
            name: case["algorithm"].as_str().unwrap().to_owned(),
            m: rows[0].len(),
            f: rows.concat(),
            kept: places(&case["kept"]).unwrap(),
            unchanged: places(&case["pymoo"]),
        }
    };
    values["survival"].as_array().unwrap().iter().map(case).collect()
}

#[test]
fn survivors_are_those_of_pymoo() {
    let mut seen = 0;
    for (at, case) in cases().into_iter().enumerate() {
        let kept = survivors(&case.name, &case.f, case.m, case.kept.len());
        assert_eq!(kept, case.kept, "case {at}, {}, {} objectives", case.name, case.m);
        // Without the author's division the same on the surface itself, others beside it.
        seen += usize::from(case.unchanged.is_some_and(|unchanged| unchanged == kept));
    }
    assert!(seen >= 7, "{seen}");
}

#[test]
fn units_and_origins_of_the_objectives_do_not_matter() {
    for case in cases() {
        // Units of powers of two change no digit, origins the last ones.
        let units = [1.0 / 1024.0, 1.0, 1024.0, 1_048_576.0, 4.0];
        let scaled = |i: usize, f: &f64| (f + (i % case.m) as f64) * units[i % case.m];
        let f: Vec<f64> = case.f.iter().enumerate().map(|(i, f)| scaled(i, f)).collect();
        let kept = survivors(&case.name, &f, case.m, case.kept.len());
        assert_eq!(kept, case.kept, "{}, {} objectives", case.name, case.m);
    }
}

#[test]
fn as_many_survive_as_there_are_places_each_once_the_best_fronts_first() {
    for (name, _) in SURVIVALS {
        for case in cases() {
            let population = Population::from_objectives(&case.f, case.m);
            let n = population.len();
            for keep in [0, 1, 2, case.m, n / 3, n - 1, n, n + 5] {
                let (mut chosen, ranking) = select(name, &population, keep);
                assert_eq!(chosen.len(), keep.min(n), "{name} {keep}");
                assert_eq!(ranking.rank.len(), chosen.len());
                assert!(ranking.rank.is_sorted(), "{name} {keep}");
                chosen.sort_unstable();
                chosen.dedup();
                assert_eq!(chosen.len(), keep.min(n), "{name} {keep}");
            }
        }
    }
}

#[test]
fn no_population_is_too_odd() {
    let odd = [0.0, -0.0, 1.0, -1e300, 1e300, 1e-300, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    for (name, _) in SURVIVALS {
        for m in 1..5 {
            for violation in [0.0, 1.0, f64::INFINITY, f64::NAN] {
                for (a, b) in odd.into_iter().flat_map(|a| odd.map(|b| (a, b))) {
                    let mut population = Population::with_capacity(1, m, 12);
                    for i in 0..12 {
                        let mut f = vec![a; m];
                        f[i % m] = if i < 6 { b } else { 0.5 };
                        population.push(&[0.0], &f, if i < 4 { 0.0 } else { violation });
                    }
                    let (mut chosen, ranking) = select(name, &population, 7);
                    assert_eq!(ranking.rank.len(), 7);
                    chosen.sort_unstable();
                    chosen.dedup();
                    assert_eq!(chosen.len(), 7, "{name} {m} {a} {b}");
                }
            }
        }
        assert!(survivors(name, &[], 3, 4).is_empty());
        assert_eq!(survivors(name, &[2.0; 24], 3, 4).len(), 4);
    }
}

#[test]
fn of_a_later_front_those_nearest_to_the_ideal_survive() {
    // A first front of three corners and a middle, and three behind it.
    let f = [
        [0.0, 0.0, 1.0],
        [0.0, 1.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.3, 0.3, 0.3],
        [0.9, 0.9, 0.9],
        [0.4, 0.4, 0.4],
        [0.2, 0.2, 1.3],
    ];
    assert_eq!(survivors("age-moea-2", f.as_flattened(), 3, 5), [0, 1, 2, 3, 5]);
}
