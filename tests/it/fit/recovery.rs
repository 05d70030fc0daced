//! What fits find against what is there.

use hydrotrace::{
    fit::{Estimated, Excitation, Observation, fit},
    plant::{JointRecord, Plant, simulate},
    series::{Quantity, Series, Signal, Track},
    units::DEGREE_RAD,
};

use crate::support::{
    fleet::smooth,
    machine::{HOME_DEG, excitation, measured, task},
    recovery::{QUANTITIES, is_limit, recover},
};

#[test]
fn a_trial_of_each_joint_finds_lag_dead_band_gains_and_speed_limits() {
    let (columns, skills) = recover(200..203, &excitation(&Excitation::minimal()));
    assert!(skills.iter().all(|r2| *r2 > 0.9), "{skills:?}");
    for (column, (name, ..)) in columns.iter().zip(QUANTITIES) {
        let most = match name {
            "lag" | "feed forward" | "gain ratio" | "speed +" | "speed -" => 0.10,
            "position gain" | "integral gain" => 0.15,
            "dead band" | "dead band error" => 0.20,
            // What the oil makes of the spool's slew rate is no limit of the joint.
            _ => continue,
        };
        assert!(column.median_error() < most, "{name}: {}", column.median_error());
        assert!(column.coverage() > 0.85, "{name}: {}", column.coverage());
        assert!(column.errors.len() * 10 >= column.joints * 8, "{name}: {}", column.errors.len());
    }
}

#[test]
fn a_smooth_task_shows_no_limit_no_lag_and_no_position_gain() {
    let (columns, _) = recover(200..202, &task(1));
    for (column, (name, ..)) in columns.iter().zip(QUANTITIES) {
        if name == "lag" || name == "position gain" || is_limit(name) {
            assert_eq!(column.errors.len(), 0, "{name}");
        }
    }
}

#[test]
fn signals_to_the_valves_show_the_dead_band_of_each_direction() {
    let plant = Plant::preset("default").unwrap();
    let job = task(1);
    let record = simulate(&plant, &job.plan, &job.payload, 1).unwrap();
    let signals = |joint: &JointRecord| {
        let values = joint.valve_command.clone();
        Signal::new(&joint.name, Quantity::Share, record.t_s.clone(), values, &[]).unwrap()
    };
    let valve: Vec<Signal> = record.joints.iter().map(signals).collect();
    let log = Observation { sent: &job.plan, measured: &measured(&record), valve: &valve };
    let fit = fit(&[log]).unwrap();
    let truth = plant.truth(&HOME_DEG.map(|q| q * DEGREE_RAD), 0.0).unwrap();
    let mut found = 0;
    for ((joint, truth), own) in fit.joints.iter().zip(&truth.joints).zip(&plant.parameters().joints) {
        let Some(bands) = joint.valve_dead_band else { continue };
        found += 1;
        for (band, wanted_rad_s) in bands.iter().zip(truth.dead_band_rad_s) {
            let share = (wanted_rad_s / own.control.compensation_speed_rad_s).min(1.0);
            let signal = wanted_rad_s / own.control.nominal_speed_rad_s + own.control.compensation * share;
            let error = (band.value.unwrap() / signal).ln();
            println!("{}: {:.3} and {signal:.3}", joint.name, band.value.unwrap());
            assert!(error.abs() < 0.25, "{}: {error}", joint.name);
        }
    }
    assert!(found >= 4, "{found}");
}

/// A smooth plan of one joint, there and back, with what came of it.
fn there_and_back(came: impl Fn(f64, usize) -> f64) -> [Series; 2] {
    let t_s: Vec<f64> = (0..4000).map(|k| 0.01 * f64::from(k)).collect();
    let at = |t: f64| {
        (0..4).map(|k| smooth((t - 2.0 - 8.0 * f64::from(k)) / 4.0) * [0.2, -0.2][k as usize % 2]).sum()
    };
    let planned: Vec<f64> = t_s.iter().map(|t| at(*t)).collect();
    let came = planned.iter().enumerate().map(|(k, planned)| came(*planned, k)).collect();
    [planned, came]
        .map(|position| Series { tracks: vec![Track::new("boom", t_s.clone(), position, &[]).unwrap()] })
}

/// The same for each seed, and nearly normal.
fn noise(k: usize) -> f64 {
    let one = |salt: usize| ((k * 7919 + salt * 104_729) % 10_007) as f64 / 10_007.0;
    (1..=6).map(one).sum::<f64>() - 3.0
}

#[test]
fn of_a_joint_that_stands_no_number_is_told() {
    for sigma_rad in [0.0, 3e-4] {
        let [sent, measured] = there_and_back(|_, k| 0.4 + sigma_rad * noise(k));
        let fit = fit(&[Observation { sent: &sent, measured: &measured, valve: &[] }]).unwrap();
        let joint = fit.joint("boom").unwrap();
        assert!(!joint.model_holds && !joint.trusted(), "{joint:?}");
        let numbers = [
            joint.dead_band_rad_s, joint.position_gain_1_s, joint.feed_forward,
            joint.speed_limit_growing_rad_s,
        ];
        assert!(numbers.iter().all(|number| !number.identified), "{joint:?}");
    }
}

#[test]
fn noise_is_no_speed_that_was_reached() {
    // The plan's largest speed is 1.875 times its mean of 0.05 rad/s, less over half a second.
    let [sent, measured] = there_and_back(|planned, k| planned + 1.5e-3 * noise(k));
    let fit = fit(&[Observation { sent: &sent, measured: &measured, valve: &[] }]).unwrap();
    let joint = fit.joint("boom").unwrap();
    for limit in [joint.speed_limit_growing_rad_s, joint.speed_limit_shrinking_rad_s] {
        let reached = limit.lower_bound.unwrap();
        assert!(reached < 0.0935 && reached > 0.07, "{reached}");
    }
}

#[test]
fn the_order_of_the_logs_changes_nothing() {
    let runs = [1, 2, 3].map(|seed| {
        there_and_back(|planned, k| if k < 350 { 0.0 } else { 0.97 * planned } + 1e-3 * noise(k + seed))
    });
    let of = |order: [usize; 3]| {
        let logs = order.map(|k| Observation { sent: &runs[k][0], measured: &runs[k][1], valve: &[] });
        fit(&logs).unwrap()
    };
    let first = of([0, 1, 2]);
    assert!(first.joints[0].held_out_r2 > 0.0);
    assert!([[2, 1, 0], [1, 2, 0]].map(of) == [first.clone(), first]);
}

/// A joint behind a dead time and a lag, with feed-forward, gain and a dead band, that makes 20 deg/s and no more.
fn limited(sent: &[f64]) -> Vec<f64> {
    const STEP_S: f64 = 0.01;
    let (mut angle, mut speed) = (sent[0], 0.0);
    let of = |k: usize| {
        let [before, now] = [k.saturating_sub(16), k.saturating_sub(15)].map(|k| sent[k]);
        let asked = 0.9 * (now - before) / STEP_S + 3.0 * (now - angle);
        let dead = 0.4 * DEGREE_RAD;
        let asked = if asked.abs() > dead { asked - dead.copysign(asked) } else { 0.0 };
        speed += (asked.clamp(-20.0 * DEGREE_RAD, 20.0 * DEGREE_RAD) - speed) * STEP_S / 0.1;
        angle += speed * STEP_S;
        angle
    };
    (0..sent.len()).map(of).collect()
}

#[test]
fn a_joint_that_is_asked_for_little_more_than_it_makes_shows_its_limit() {
    // Strokes of 60 deg in 4.69 s, 24 deg/s at most.
    let t_s: Vec<f64> = (0..5000).map(|k| 0.01 * f64::from(k)).collect();
    let at = |t: f64| {
        (0..5).map(|k| smooth((t - 2.0 - 8.7 * f64::from(k)) / 4.69) * [1.047, -1.047][k as usize % 2]).sum()
    };
    let sent: Vec<f64> = t_s.iter().map(|t| at(*t)).collect();
    let came: Vec<f64> =
        limited(&sent).iter().enumerate().map(|(k, angle)| angle + 1e-4 * noise(k)).collect();
    let [sent, measured] = [sent, came]
        .map(|position| Series { tracks: vec![Track::new("tilt", t_s.clone(), position, &[]).unwrap()] });
    let fit = fit(&[Observation { sent: &sent, measured: &measured, valve: &[] }]).unwrap();
    let joint = fit.joint("tilt").unwrap();
    let deg_s = |limit: Estimated| limit.value.unwrap_or(0.0) / DEGREE_RAD;
    let limits = [joint.speed_limit_growing_rad_s, joint.speed_limit_shrinking_rad_s].map(deg_s);
    assert!(limits.iter().all(|limit| (limit - 20.0).abs() < 0.4), "{limits:?} {joint:?}");
    // It is 7.6 deg off its plan, and without the limit 1.2 deg of that were unexplained.
    let [left_rad, _] = joint.unexplained_peak_rad.unwrap();
    assert!(left_rad < 0.1 * DEGREE_RAD, "{joint:?}");
}
