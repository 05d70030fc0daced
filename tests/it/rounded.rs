//! Starts after plans that were rounded when they were written, or measured themselves.

use std::slice::from_ref;

use rand_distr::{Distribution as _, StandardNormal};

use hydrotrace::{
    replay::{Rules, replay},
    series::{Pair, Track, align},
    units::DEGREE_RAD,
};

/// Six motions of a plan rounded to a step, and of a joint that follows 0.18 s later.
fn run(step_deg: f64, every_s: f64, takes_s: f64) -> Pair {
    run_of(12.0, |x, _| (x / step_deg).round() * step_deg, every_s, takes_s)
}

/// Six motions of a plan as it was written, by its values and their numbers, and of a joint that follows 0.18 s later.
fn run_of(travel_deg: f64, written: impl Fn(f64, usize) -> f64, every_s: f64, takes_s: f64) -> Pair {
    let t_s: Vec<f64> = (0..3200).map(|k| f64::from(k) * every_s).filter(|t_s| *t_s < 32.0).collect();
    let at_deg = |t_s: f64| -> f64 {
        let motion = |k: i32| {
            let s = ((t_s - 1.5 - 5.003 * f64::from(k)) / takes_s).clamp(0.0, 1.0);
            let sign = if k % 2 == 0 { travel_deg } else { -travel_deg };
            sign * s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s)
        };
        10.0 + (0..6).map(motion).sum::<f64>()
    };
    let planned = t_s.iter().enumerate().map(|(k, t_s)| written(at_deg(*t_s), k) * DEGREE_RAD).collect();
    let late = |(k, t_s): (usize, &f64)| {
        (at_deg(t_s - 0.18) + 0.004 * ((k * 7919 % 101) as f64 / 50.0 - 1.0)) * DEGREE_RAD
    };
    let measured = t_s.iter().enumerate().map(late).collect();
    let track = |position| Track::new("a", t_s.clone(), position, &[]).unwrap();
    align(&track(planned), &track(measured)).unwrap()
}

#[test]
fn the_delay_after_a_rounded_plan_is_known_as_well_as_its_interval_says() {
    for (step_deg, every_s, takes_s) in
        [(0.1, 0.01, 2.5), (0.1, 0.05, 2.5), (0.1, 0.01, 4.0), (0.02, 0.01, 2.5)]
    {
        let pair = run(step_deg, every_s, takes_s);
        let found = replay(from_ref(&pair), &Rules::default());
        let of = format!("{step_deg} deg, {every_s} s, {takes_s} s");
        assert_eq!(found.transitions.len(), 6, "{of}");
        let delays: Vec<f64> = found.transitions.iter().filter_map(|t| t.onset_delay_s).collect();
        let held = found.transitions.iter().filter_map(|t| t.onset_delay_interval_s);
        let held = held.filter(|[low_s, high_s]| (*low_s..=*high_s).contains(&0.18)).count();
        let mean_s = delays.iter().sum::<f64>() / 6.0;
        assert!(held == 6 && (mean_s - 0.18).abs() < 0.06, "{of}: {held} held, {mean_s} s");
    }
}

#[test]
fn a_slow_plan_of_few_digits_has_its_own_starts_alone() {
    // Angles to 1e-4 rad, as many write them, and to hundredths of a degree.
    for step_deg in [0.002, 1e-4 / DEGREE_RAD, 0.01, 0.02] {
        for travel_deg in [2.0, 3.5, 6.0] {
            let pair = run_of(travel_deg, |x, _| (x / step_deg).round() * step_deg, 0.01, 4.0);
            let found = replay(from_ref(&pair), &Rules::default());
            assert_eq!(found.transitions.len(), 6, "{step_deg} deg, {travel_deg} deg");
            for start in &found.transitions {
                let (delay_s, [low_s, high_s]) =
                    (start.onset_delay_s.unwrap(), start.onset_delay_interval_s.unwrap());
                let near = (delay_s - 0.18).abs() < 0.12 && low_s < 0.25 && high_s > 0.11;
                assert!(near, "{step_deg} deg, {travel_deg} deg: {delay_s} s, {low_s} to {high_s}");
            }
        }
    }
}

#[test]
fn the_next_step_of_a_plan_is_no_error_of_the_one_before() {
    let t_s: Vec<f64> = (0..1700).map(|k| 0.01 * f64::from(k)).collect();
    let step = |t_s: f64| 0.1 * ((t_s - 2.0) / 3.0).floor().max(-1.0);
    let mut at = step(0.0);
    let follow = |t: &f64| {
        at += (step(t - 0.1) - at) * 0.04;
        at
    };
    let measured = t_s.iter().map(follow).collect();
    let planned = t_s.iter().map(|t| step(*t)).collect();
    let track = |position| Track::new("a", t_s.clone(), position, &[]).unwrap();
    let pair = align(&track(planned), &track(measured)).unwrap();
    let found = replay(from_ref(&pair), &Rules::default());
    assert_eq!(found.transitions.len(), 5);
    for start in &found.transitions {
        let settled_s = start.settling_time_s.unwrap_or(9.0);
        assert!(start.time_to_peak_s < 0.2 && start.peak_error < 0.11 && settled_s < 2.0, "{start:?}");
    }
}

#[test]
fn the_delay_after_a_plan_that_was_measured_is_known_as_well_as_its_interval_says() {
    let mut rng = hydrotrace::rng::stream(5, hydrotrace::rng::Stream::SensorNoise);
    let white: Vec<f64> = (0..3200).map(|_| StandardNormal.sample(&mut rng)).collect();
    for noise_deg in [0.002, 0.005, 0.01] {
        let pair = run_of(12.0, |x, k| x + noise_deg * white[k], 0.01, 2.5);
        let found = replay(from_ref(&pair), &Rules::default());
        assert_eq!(found.transitions.len(), 6, "{noise_deg} deg");
        let held = found.transitions.iter().filter_map(|t| t.onset_delay_interval_s);
        let held = held.filter(|[low_s, high_s]| (*low_s..=*high_s).contains(&0.18)).count();
        let off_s = found.transitions.iter().filter_map(|t| Some((t.onset_delay_s? - 0.18).abs()));
        let off_s = off_s.fold(0.0, f64::max);
        assert!(held == 6 && off_s < 0.1, "{noise_deg} deg: {held} held, {off_s} s off at most");
    }
}
