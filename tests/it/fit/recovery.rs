//! What fits find against what is there.

use hydrotrace::{
    fit::{Excitation, Observation, fit},
    plant::{JointRecord, Plant, simulate},
    series::{Quantity, Signal},
    units::DEGREE_RAD,
};

use crate::support::{
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
fn a_smooth_task_shows_no_limit_and_no_lag() {
    let (columns, _) = recover(200..202, &task(1));
    for (column, (name, ..)) in columns.iter().zip(QUANTITIES) {
        if name == "lag" || is_limit(name) {
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
