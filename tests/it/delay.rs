//! When joints leave rest: by hand, of sparse logs, and the gates of the detector.

use hydrotrace::{replay::Rules, series::Pair, units::DEGREE_RAD};
use hydrotrace_bench::detector::{Sensing, detector_score};

use crate::replay::{of, ramp, recorded};

#[test]
fn a_known_start_has_the_metrics_worked_out_by_hand() {
    // The joint waits 0.2 s, then follows at the planned speed: the error grows to 0.8 degrees.
    let t_s: Vec<f64> = (0..1000).map(|k| 0.01 * f64::from(k)).collect();
    let planned: Vec<f64> = t_s.iter().map(|&t| ramp(t, 2.0)).collect();
    let measured: Vec<f64> = t_s.iter().map(|&t| ramp(t, 2.2)).collect();
    let found = of(&recorded(t_s, planned, measured, std::iter::once(0..1000).collect()));
    let transition = &found.transitions[0];
    let near = |got: f64, want: f64, tolerance: f64| assert!((got - want).abs() < tolerance, "{got} {want}");
    near(transition.planned_onset_s, 2.0, 0.01);
    // No joint jumps to speed as this one does: the fit gives it 30 ms for it.
    near(transition.onset_delay_s.unwrap(), 0.2, 0.02);
    near(transition.displacement_delay_s.unwrap(), 0.2, 1e-6);
    near(transition.breakaway_error.unwrap(), 0.8 * DEGREE_RAD, 0.1 * DEGREE_RAD);
    near(transition.peak_error, 0.8 * DEGREE_RAD, 1e-9);
    // 0.8 degrees for 3 s, less the two ramps of 0.2 s, which make up for each other.
    near(transition.error_area, 2.4 * DEGREE_RAD, 0.01 * DEGREE_RAD);
    near(transition.settling_time_s.unwrap(), 3.2, 0.05);
    assert_eq!(transition.overshoot, 0.0);
    // Being late at the end is no standstill error.
    assert!(found.joints[0].standstill_error.unwrap().peak < 1e-12);
}

/// How many of 40 intervals hold a delay of 0.15 s, each of a start elsewhere between two samples; none lies below 0 s.
fn held(t_s: &[f64], interval_s: f64) -> usize {
    let middle_s = 0.5 * t_s[t_s.len() - 1];
    let case = |case: u32| {
        let start_s = middle_s + f64::from(case) / 40.0 * 0.2;
        let wave = |t: f64| 0.01 * DEGREE_RAD * (1e3 * t).sin();
        let measured = t_s.iter().map(|&t| ramp(t, start_s + 0.15) + wave(t)).collect();
        let planned = t_s.iter().map(|&t| ramp(t, start_s)).collect();
        let whole = std::iter::once(0..t_s.len()).collect();
        let pair =
            Pair { planned_interval_s: interval_s, ..recorded(t_s.to_vec(), planned, measured, whole) };
        let interval_s = of(&pair).transitions.first().and_then(|t| t.onset_delay_interval_s);
        let [low_s, high_s] = interval_s.unwrap_or([f64::NAN; 2]);
        assert!(high_s >= 0.0, "every {interval_s:?} s, case {case}: {low_s} to {high_s}");
        low_s <= 0.15 && 0.15 <= high_s
    };
    (0..40).filter(|k| case(*k)).count()
}

#[test]
fn of_a_sparse_log_the_intervals_are_wider_and_hold_the_delay() {
    for rate_hz in [5.0, 8.0, 10.0, 12.5, 20.0] {
        let t_s: Vec<f64> = (0..80).map(|k| f64::from(k) / rate_hz).collect();
        let held = held(&t_s, 1.0 / rate_hz);
        assert!(held >= 38, "{rate_hz} Hz: {held} of 40");
    }
}

#[test]
fn of_a_log_of_uneven_samples_too() {
    let even = |k: u32| f64::from(k) * 0.01;
    // Four samples at 100 Hz, then none for 0.12 s; and two fifths of the samples of a log at 20 Hz.
    let bursts: Vec<f64> = (0..1600).filter(|k| k % 15 < 4).map(even).collect();
    let lossy: Vec<f64> =
        (0..320_u32).filter(|k| k.wrapping_mul(2_654_435_761) >> 16 & 7 < 3).map(|k| even(5 * k)).collect();
    for (name, t_s, interval_s) in [("bursts", bursts, 0.01), ("lossy", lossy, 0.05)] {
        let held = held(&t_s, interval_s);
        assert!(held >= 38, "{name}: {held} of 40");
    }
}

#[test]
fn starts_are_found_at_the_promised_rate_and_sharp_onsets_to_30_ms() {
    for (sigma_deg, gate) in [(0.02, 0.99), (0.05, 0.95)] {
        let sensing = Sensing { sigma_rad: sigma_deg * DEGREE_RAD, ..Sensing::default() };
        let score = detector_score(1, 30, &sensing, &Rules::default());
        assert!(score.starts > 300, "{score:?}");
        assert!(score.precision >= gate && score.recall >= gate, "{score:?}");
        assert!(score.onset_sharp.median_s.abs() < 0.030, "{score:?}");
        assert!(score.onset_sharp.mad_sd_s < 0.035, "{score:?}");
        assert!(score.delay_coverage >= 0.95, "{score:?}");
    }
}
