//! When joints leave rest: by hand, of sparse logs, and the gates of the detector.

use hydrotrace::{replay::Rules, series::Pair, units::DEGREE_RAD};
use hydrotrace_bench::detector::{Sensing, detector_score};

use crate::replay::{of, ramp, recorded, sampled};

#[test]
fn a_known_start_has_the_metrics_worked_out_by_hand() {
    // The joint waits 0.2 s, then follows at the planned speed: the error grows to 0.8 degrees.
    let found = of(&sampled(1000, |t| ramp(t, 2.0), |t| ramp(t, 2.2)));
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

#[test]
fn a_set_value_that_steps_is_a_start_at_the_step_at_any_rate() {
    for rate_hz in [10.0, 20.0, 50.0, 100.0, 500.0, 1000.0] {
        let t_s: Vec<f64> = (0..(12.0 * rate_hz) as usize).map(|k| k as f64 / rate_hz).collect();
        let steps = |t: f64| {
            if t < 1.9995 {
                0.0
            } else if t < 6.9995 {
                8.0
            } else {
                -3.0
            }
        };
        // Leaves 0.25 s after the step, at 8 degrees per second.
        let follows = |t: f64| {
            let (out, back) = ((t - 2.25).clamp(0.0, 1.0), (t - 7.25).clamp(0.0, 1.375));
            8.0 * (out - back)
        };
        let in_rad = |of: &dyn Fn(f64) -> f64| t_s.iter().map(|&t| of(t) * DEGREE_RAD).collect::<Vec<_>>();
        let pair =
            recorded(t_s.clone(), in_rad(&steps), in_rad(&follows), std::iter::once(0..t_s.len()).collect());
        let found = of(&Pair { planned_interval_s: 1.0 / rate_hz, ..pair });
        let starts: Vec<_> = found.transitions.iter().map(|t| (t.direction, t.planned_onset_s)).collect();
        assert_eq!(starts.len(), 2, "{rate_hz} Hz: {starts:?}");
        for (transition, (direction, at_s, peak)) in
            found.transitions.iter().zip([(1, 2.0, 8.0), (-1, 7.0, 11.0)])
        {
            assert_eq!(transition.direction, direction);
            assert!((transition.planned_onset_s - at_s).abs() < 1e-9, "{rate_hz} Hz: {starts:?}");
            assert!((transition.peak_error - peak * DEGREE_RAD).abs() < 1e-9, "{rate_hz} Hz");
            let [low_s, high_s] = transition.onset_delay_interval_s.unwrap();
            assert!(low_s <= 0.25 && 0.25 <= high_s, "{rate_hz} Hz: {low_s} to {high_s}");
            assert!(transition.settling_time_s.is_some(), "{rate_hz} Hz");
        }
        assert_eq!(found.joints[0].unplanned_starts, 0, "{rate_hz} Hz");
    }
}

#[test]
fn a_log_that_begins_with_its_plan_shows_the_first_start() {
    for (off_deg, starts) in [(0.0, 1), (0.3, 0)] {
        let found = of(&sampled(600, |t| ramp(t, 0.0), |t| ramp(t, 0.3) + off_deg * DEGREE_RAD));
        assert_eq!(found.joints[0].starts, starts, "off by {off_deg} deg");
        if let Some(start) = found.transitions.first() {
            assert!(start.planned_onset_s.abs() < 0.011, "{}", start.planned_onset_s);
            assert!((start.onset_delay_s.unwrap() - 0.3).abs() < 0.04, "{:?}", start.onset_delay_s);
            assert_eq!(found.joints[0].unplanned_starts, 0);
        }
    }
}

#[test]
fn a_plan_that_is_written_once_it_changed_by_a_band_left_before_its_first_value() {
    for band_deg in [0.02, 0.05, 0.2] {
        // Each motion leaves at a whole second.
        let ease = |t: f64| {
            let x = (t / 2.0).clamp(0.0, 1.0);
            10.0 * x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)
        };
        let course = |t: f64| DEGREE_RAD * (ease(t - 1.0) - ease(t - 6.0));
        let t_s: Vec<f64> = (0..1000).map(|k| f64::from(k) * 0.01).collect();
        let mut held = course(0.0);
        let written: Vec<f64> = t_s
            .iter()
            .map(|t| {
                if (course(*t) - held).abs() > band_deg * DEGREE_RAD {
                    held = course(*t);
                }
                held
            })
            .collect();
        // Lines between values that are written soon after another, as a reader draws them.
        let mut planned = written.clone();
        let changes: Vec<usize> =
            (1..written.len()).filter(|k| written[*k].to_bits() != written[k - 1].to_bits()).collect();
        for two in changes.windows(2).filter(|two| two[1] - two[0] < 20) {
            for (at, planned) in planned.iter_mut().enumerate().take(two[1]).skip(two[0]) {
                let share = (at - two[0]) as f64 / (two[1] - two[0]) as f64;
                *planned = written[two[0]] + share * (written[two[1]] - written[two[0]]);
            }
        }
        let measured = t_s.iter().map(|t| course(t - 0.15)).collect();
        let found = of(&recorded(t_s.clone(), planned, measured, std::iter::once(0..t_s.len()).collect()));
        assert_eq!(found.transitions.len(), 2, "{band_deg} deg");
        for start in &found.transitions {
            let [low_s, high_s] = start.onset_delay_interval_s.unwrap();
            assert!(low_s <= 0.15 && 0.15 <= high_s, "{band_deg} deg: {low_s} to {high_s}");
        }
    }
}

#[test]
fn a_stretch_that_begins_with_its_plan_at_rest_shows_its_start_beside_an_offset() {
    let ease = |t: f64| {
        let x = (t / 2.0).clamp(0.0, 1.0);
        10.0 * DEGREE_RAD * x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)
    };
    for (begins_s, starts) in [(0.0, 1), (0.6, 0)] {
        let found = of(&sampled(600, |t| ease(t + begins_s), |t| ease(t - 0.3) + 1.0 * DEGREE_RAD));
        assert_eq!(found.joints[0].starts, starts, "{begins_s} s");
    }
}
