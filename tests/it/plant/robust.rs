//! The same machine on other days, and machines that nobody built.

use hydrotrace::{
    arm::Arm,
    plant::{Parameters, PayloadChange, Plant, Truth, simulate},
    series::Series,
    units::DEGREE_RAD,
};

use crate::support::{
    machine::{POSE_DEG, command, plant},
    variation::Variation,
};

fn pose_rad() -> Vec<f64> {
    POSE_DEG.iter().map(|q| q * DEGREE_RAD).collect()
}

/// Joint 1 goes as fast as it can.
fn dash() -> Series {
    command(2.0, |j, t| {
        let since = if j == 0 { (t - 0.5).clamp(0.0, 0.9) } else { 0.0 };
        (POSE_DEG[j] + 40.0 * since, if since > 0.0 && since < 0.9 { 40.0 } else { 0.0 })
    })
}

fn top_speed_deg_s(parameters: Parameters) -> f64 {
    let plant = Plant::new(&Arm::sample().unwrap(), parameters).unwrap();
    let record = simulate(&plant, &dash(), &[], 1).unwrap();
    let joint = &record.joints[0];
    let window: Vec<f64> = joint.true_rad_s.iter().skip(100).take(30).map(|v| v / DEGREE_RAD).collect();
    window.iter().sum::<f64>() / window.len() as f64
}

#[test]
fn a_lower_supply_makes_the_arm_slower_by_what_the_flow_law_says() {
    let base = Parameters::preset("default").unwrap();
    let low = Variation::LowSupply.parameters(&base);
    let limit = |parameters: &Parameters| {
        let plant = Plant::new(&Arm::sample().unwrap(), parameters.clone()).unwrap();
        plant.truth(&pose_rad(), 0.0).unwrap().joints[0].speed_limit_rad_s[0]
    };
    let expected = limit(&low) / limit(&base);
    let found = top_speed_deg_s(low) / top_speed_deg_s(base);
    assert!(expected < 0.9 && (found / expected - 1.0).abs() < 0.05, "{found}, expected {expected}");
}

#[test]
fn cold_oil_and_friction_slow_the_arm_and_payload_leaves_the_parameters_alone() {
    let base = Parameters::preset("default").unwrap();
    let usual = top_speed_deg_s(base.clone());
    for variation in [Variation::ColdOil, Variation::MoreFriction] {
        assert!(top_speed_deg_s(variation.parameters(&base)) < 0.995 * usual, "{variation:?}");
    }
    assert_eq!(Variation::HeavyPayload.parameters(&base), base);
    let payload = [PayloadChange { at_s: 1.0, mass_kg: 10.0 }];
    assert_eq!(Variation::HeavyPayload.payload(&payload)[0].mass_kg, 30.0);
    assert_eq!(Variation::ColdOil.payload(&payload), payload);
}

#[test]
fn every_random_machine_follows_its_command_more_or_less() {
    let base = Parameters::preset("default").unwrap();
    let command = command(6.0, |j, t| {
        let since = (t - 1.0).max(0.0);
        (POSE_DEG[j] + 3.0 * since.sin().powi(2), 3.0 * (2.0 * since).sin())
    });
    for seed in 0..12 {
        let plant = Plant::new(&Arm::sample().unwrap(), base.random(seed)).unwrap();
        let record = simulate(&plant, &command, &[], seed).unwrap();
        for (joint, track) in record.joints.iter().zip(&command.tracks) {
            let off =
                record.t_s.iter().zip(&joint.true_rad).map(|(&t, q)| {
                    track.at(t).map_or(0.0, |planned| (planned.position - q).abs() / DEGREE_RAD)
                });
            let most = off.fold(0.0, f64::max);
            assert!(most < 3.0, "seed {seed}, {}: {most} degrees", joint.name);
        }
    }
}

#[test]
fn the_truth_survives_a_log_s_metadata() {
    let plant = plant("lag-limited", |_| {});
    let truth = plant.truth(&pose_rad(), 10.0).unwrap();
    let text = serde_json::to_string(&truth).unwrap();
    assert_eq!(serde_json::from_str::<Truth>(&text).unwrap(), truth);
    for joint in &truth.joints {
        assert!((joint.lag_s - joint.dead_time_s) > 0.02);
        for way in 0..2 {
            let speed = joint.speed_limit_rad_s[way] / DEGREE_RAD;
            let rise = joint.acceleration_limit_rad_s2[way] / DEGREE_RAD;
            assert!((14.0..26.0).contains(&speed), "{}: {speed}", joint.name);
            assert!((140.0..420.0).contains(&rise), "{}: {rise}", joint.name);
        }
    }
    assert!(plant.truth(&[0.0; 3], 0.0).is_err());
}
