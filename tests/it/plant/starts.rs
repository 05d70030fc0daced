//! What a start costs: a floor for slow ones, growth for fast ones.

use hydrotrace::{
    plant::{Plant, simulate},
    replay::{Rules, replay},
    units::DEGREE_RAD,
};

use crate::support::machine::{POSE_DEG, command, ideal, pairs, paper_plan, plant};

/// Peak error, degrees, averaged over joints and both directions, of starts to 4 degrees a second.
fn peak_deg(plant: &Plant, acceleration_deg_s2: f64) -> f64 {
    const SPEED_DEG_S: f64 = 4.0;
    let ramp_s = SPEED_DEG_S / acceleration_deg_s2;
    let cruise_s = 1.0;
    let way = |since: f64| {
        let rising = since.clamp(0.0, ramp_s);
        let even = (since - ramp_s).clamp(0.0, cruise_s);
        let falling = (since - ramp_s - cruise_s).clamp(0.0, ramp_s);
        let way_deg = 0.5 * acceleration_deg_s2 * (rising * rising - falling * falling)
            + SPEED_DEG_S * (even + falling);
        let speed = acceleration_deg_s2 * (rising - falling);
        (way_deg, speed)
    };
    let duration_s = 2.0 * ramp_s + cruise_s + 4.0;
    let mut peaks = Vec::new();
    // Joints 1 and 3 have room for the longest ramp.
    for (j, sign) in [(0, 1.0), (0, -1.0), (2, 1.0), (2, -1.0)] {
        let from = POSE_DEG[j] - sign * 15.0;
        let command = command(duration_s, |k, t| {
            let (way_deg, speed) = way(t - 1.0);
            if k == j { (from + sign * way_deg, sign * speed) } else { (POSE_DEG[k], 0.0) }
        });
        let record = simulate(plant, &command, &[], 1).unwrap();
        let planned = command.tracks[j].position();
        let end = ((1.0 + ramp_s + cruise_s) * 100.0) as usize;
        let errors = planned.iter().zip(&record.joints[j].true_rad).take(end);
        peaks.push(errors.map(|(p, q)| (p - q).abs() / DEGREE_RAD).fold(0.0, f64::max));
    }
    peaks.iter().sum::<f64>() / peaks.len() as f64
}

#[test]
fn slow_starts_have_a_floor_and_fast_ones_cost_more_where_lag_limits() {
    for preset in ["dead-band-limited", "default", "lag-limited"] {
        let plant = plant(preset, ideal);
        let peaks = [0.4, 1.5, 6.0, 25.0].map(|a| peak_deg(&plant, a));
        println!("{preset}: peak at 0.4, 1.5, 6, 25 deg/s2: {peaks:.2?}");
        assert!(peaks[0] > 0.2 && peaks[0] < 0.65, "{preset}: {peaks:?}");
        assert!(peaks.windows(2).all(|pair| pair[1] > 0.9 * pair[0]), "{preset}: {peaks:?}");
        let growth = peaks[3] / peaks[0];
        match preset {
            "dead-band-limited" => assert!(growth < 2.2, "{peaks:?}"),
            _ => assert!(growth > 1.7, "{preset}: {peaks:?}"),
        }
    }
}

#[test]
fn without_overlap_and_friction_the_floor_is_gone() {
    let quiet = plant("dead-band-limited", |p| {
        ideal(p);
        for joint in &mut p.joints {
            (joint.valve.overlap_extend, joint.valve.overlap_retract) = (0.0, 0.0);
            (joint.valve.hysteresis, joint.control.compensation) = (0.0, 0.0);
        }
    });
    let usual = plant("dead-band-limited", ideal);
    assert!(peak_deg(&quiet, 0.4) < 0.5 * peak_deg(&usual, 0.4));
}

#[test]
fn a_lag_explains_more_of_the_error_the_less_a_plant_is_limited_by_its_dead_band() {
    let (planned, payload) = paper_plan(0, 0.6);
    let found = ["dead-band-limited", "default", "lag-limited"].map(|preset| {
        let record = simulate(&plant(preset, |_| {}), &planned, &payload, 1).unwrap();
        replay(&pairs(&planned, &record), &Rules::default()).whole_run.lag_share.unwrap()
    });
    let shares = found.map(|found| found.share);
    println!("{shares:.3?}");
    assert!(shares[0] + 0.05 < shares[1] && shares[1] + 0.05 < shares[2], "{shares:?}");
    // All three start late by their dead bands before anything else.
    assert!(found.iter().all(|found| !found.mostly), "{found:?}");
}
