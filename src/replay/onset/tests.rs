//! Onsets of simulated motions whose truth is known.

use super::*;

const STOP: f64 = 0.05 * crate::units::DEGREE_RAD;

/// Noise between -1 and 1, by a shuffle of a counter.
fn noise(k: u64) -> f64 {
    let mixed = (k + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    ((mixed ^ (mixed >> 29)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// By how much the onset of a motion up that crosses a threshold at an instant is found late, s, and whether its interval misses it.
fn off(t_s: &[f64], position: &[f64], crossing_s: f64, true_s: f64) -> (f64, bool) {
    let search = Search {
        segment: 0..t_s.len(),
        direction: 1,
        crossing_s,
        rest_s: 2.9,
        window_s: 0.1,
        stop_speed: STOP,
        sticks: true,
    };
    let found = onset(t_s, position, &search, &Rules::default()).unwrap();
    let [from_s, to_s] = found.interval_s;
    (found.at_s - true_s, !(from_s - 0.01..=to_s + 0.01).contains(&true_s))
}

#[test]
fn the_onset_of_a_joint_that_sinks_at_rest_is_that_of_its_own_speed() {
    let (mut missed, mut late_s) = (0, 0.0_f64);
    for round in 0..20_u64 {
        for sinks_deg_s in [0.0, 0.01, 0.03, 0.045] {
            let (sinks, acceleration) = (sinks_deg_s * crate::units::DEGREE_RAD, 0.05);
            let leaves_s = 3.0 + 0.003 * round as f64;
            let t_s: Vec<f64> = (0..500).map(|k| f64::from(k) * 0.01).collect();
            let position: Vec<f64> = (0_u64..)
                .zip(&t_s)
                .map(|(k, t_s)| {
                    let since_s = (t_s - leaves_s).max(0.0);
                    let scatter = 1e-4 * noise(1000 * round + k);
                    scatter - sinks * t_s + 0.5 * acceleration * since_s * since_s
                })
                .collect();
            let true_s = leaves_s + (STOP + sinks) / acceleration;
            let (off_s, misses) = off(&t_s, &position, true_s + 0.05, true_s);
            missed += usize::from(misses);
            late_s = late_s.max(off_s.abs());
        }
    }
    assert!(missed <= 4 && late_s < 0.08, "{missed} of 80 intervals missed, {late_s} s off at most");
}

/// What sticks breaks away: its speed grows e-fold every 4 ms to 1 deg/s, swings up to 8 and back to rest.
#[test]
fn the_onset_of_what_breaks_away_is_not_that_of_its_first_visible_motion() {
    let degree = crate::units::DEGREE_RAD;
    let (mut missed, mut off_s) = (0, Vec::new());
    for round in 0..40_u64 {
        let (toe_s, up_s) = (0.004, 0.06 + 0.0005 * round as f64);
        let speed = |since_s: f64| {
            let swings = (since_s / (2.0 * up_s)).clamp(0.0, 1.0);
            if since_s < 0.0 {
                (since_s / toe_s).exp()
            } else {
                1.0 + 7.0 * (std::f64::consts::PI * swings).sin()
            }
        };
        let begins_s = 3.0 + 0.0007 * round as f64;
        let true_s = begins_s + toe_s * 0.05_f64.ln();
        let (mut t_s, mut position, mut at) = (Vec::new(), Vec::new(), 0.0);
        for k in 0..8000_u64 {
            let now_s = 0.0005 * k as f64;
            at += 0.0005 * if now_s - begins_s > 2.0 * up_s { 0.0 } else { speed(now_s - begins_s) };
            if k % 20 == 0 {
                t_s.push(now_s);
                position.push(degree * (at + 0.015 * noise(1000 * round + k)));
            }
        }
        let (by_s, misses) = off(&t_s, &position, begins_s, true_s);
        missed += usize::from(misses);
        off_s.push(by_s);
    }
    let middle_s = crate::math::median(off_s);
    assert!(
        missed <= 14 && middle_s.abs() < 0.018,
        "{missed} of 40 intervals missed, {middle_s} s off in the middle"
    );
}
