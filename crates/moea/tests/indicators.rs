//! Quality of odd fronts and members: objectives below 0, without extent, that are no numbers.

#![allow(clippy::unwrap_used, clippy::float_cmp)]

use moea::{
    Algorithm, Budget, Population, Settings,
    benchmark::{Benchmark, NAMES},
    compare::Reference,
    indicator::{igd, igd_plus},
    optimise, silent,
};

/// A front from (0, 2) to (2, 0), moved and in other units.
fn line(origin: f64, unit: f64) -> Vec<f64> {
    (0..=8)
        .flat_map(|i| [0.25 * f64::from(i), 2.0 - 0.25 * f64::from(i)])
        .map(|f| origin + unit * f)
        .collect()
}

#[test]
fn a_hypervolume_depends_neither_on_origin_nor_on_unit() {
    let volume = |origin: f64, unit: f64| {
        let reference = Reference::new(line(origin, unit), 2);
        let members = Population::from_objectives(&[0.75, 1.25].map(|f| origin + unit * f), 2);
        reference.measure(&members).hypervolume
    };
    // (2.2 - 0.75) (2.2 - 1.25) of 2.2 x 2.2.
    let want = 1.45 * 0.95 / 4.84;
    for (origin, unit) in [(0.0, 1.0), (-1.0, 1.0), (-2.0, 1.0), (-1000.0, 1.0), (64.0, 8.0), (0.0, 1e-9)] {
        let got = volume(origin, unit);
        assert!((got - want).abs() < 1e-12, "{origin} {unit}: {got}, not {want}");
    }
    let moved = Reference::new(line(-2.0, 1.0), 2);
    let near = |got: Vec<f64>, want: f64| got.iter().all(|got| (got - want).abs() < 1e-12);
    assert!(near(moved.reference_point(), 0.2), "{:?}", moved.reference_point());
}

#[test]
fn fronts_without_extent_and_odd_members_have_a_finite_hypervolume() {
    for front in [vec![], vec![0.0, 0.0], vec![-3.0, -3.0], vec![f64::NAN; 2], vec![f64::INFINITY, 1.0]] {
        let reference = Reference::new(front.clone(), 2);
        for f in [0.0, -3.5, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1e90] {
            let quality = reference.measure(&Population::from_objectives(&[f, f], 2));
            assert!(quality.hypervolume.is_finite(), "{front:?} {f}: {quality:?}");
        }
    }
    let reference = Reference::of(&Benchmark::named("DTLZ2", 3).unwrap(), 100);
    let quality = reference.measure(&Population::from_objectives(&[0.1; 4], 2));
    assert_eq!((quality.igd, quality.hypervolume), (f64::INFINITY, 0.0), "two objectives, not three");
}

#[test]
fn a_member_that_is_no_number_brings_no_front_nearer() {
    let (front, nan) = ([1.0, 1.0, 2.0, 0.5], f64::NAN);
    for set in [&[nan, nan][..], &[nan, 0.0], &[0.0, nan]] {
        assert_eq!(igd_plus(set, &front, 2), f64::INFINITY, "{set:?}");
        assert_eq!(igd(set, &front, 2), f64::INFINITY, "{set:?}");
        let both = [set, &[3.0, 3.0]].concat();
        assert_eq!(igd_plus(&both, &front, 2), igd_plus(&[3.0, 3.0], &front, 2));
    }
}

#[test]
fn a_front_is_whole_if_nothing_found_lies_beyond_it() {
    for name in NAMES {
        for m in 2..5 {
            let Some(problem) = Benchmark::named(name, m) else { continue };
            let (front, nadir) = (problem.front(3000), problem.nadir());
            let budget = Budget::Evaluations(10_000);
            let settings = Settings { algorithm: Algorithm::Nsga2, budget, ..Settings::default() };
            let found = optimise(&problem, &settings, silent).unwrap().population;
            // Beyond the front is who beats each of its points in some objective by more than their spacing.
            let beats = |f: &[f64], z: &[f64]| (0..m).any(|k| f[k] < z[k] - 0.15 * nadir[k]);
            let beyond = (0..found.len())
                .filter(|&i| found.is_feasible(i) && front.chunks_exact(m).all(|z| beats(found.f(i), z)))
                .count();
            assert_eq!(beyond == 0, problem.has_whole_front(), "{name}, {m} objectives: {beyond}");
        }
    }
}
