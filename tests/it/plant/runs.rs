//! What every run keeps to.

use hydrotrace::{
    plant::{PayloadChange, Plant, PlantError, Record, simulate},
    series::Series,
    units::DEGREE_RAD,
};

use crate::support::machine::{POSE_DEG, command, ideal, plant};

/// All joints rest for a second, then swing.
fn swing() -> Series {
    command(6.0, |j, t| {
        let since = (t - 1.0).max(0.0);
        (POSE_DEG[j] + 3.0 * since.sin().powi(2), 3.0 * (2.0 * since).sin())
    })
}

fn still(duration_s: f64) -> Series {
    command(duration_s, |j, _| (POSE_DEG[j], 0.0))
}

fn run(plant: &Plant, command: &Series, seed: u64) -> Record {
    simulate(plant, command, &[], seed).unwrap()
}

#[test]
fn equal_seeds_give_equal_bytes() {
    let plant = Plant::preset("default").unwrap();
    let bytes = |seed| serde_json::to_vec(&run(&plant, &swing(), seed)).unwrap();
    assert_eq!(bytes(3), bytes(3));
    assert_ne!(bytes(3), bytes(4));
}

#[test]
fn without_noise_jitter_and_losses_the_seed_means_nothing() {
    let plant = plant("default", ideal);
    assert_eq!(run(&plant, &swing(), 3), run(&plant, &swing(), 4));
}

#[test]
fn the_seed_moves_the_true_angle_by_no_more_than_the_noise_does() {
    let plant = plant("default", |p| (p.cycle.jitter_s, p.cycle.loss) = (0.0, 0.0));
    let [a, b] = [3, 4].map(|seed| run(&plant, &swing(), seed));
    assert_ne!(a.joints[0].measured_rad, b.joints[0].measured_rad);
    for (a, b) in a.joints.iter().zip(&b.joints) {
        let most = a.true_rad.iter().zip(&b.true_rad).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(most < 0.1 * DEGREE_RAD, "{}: {most} rad", a.name);
    }
}

#[test]
fn stamps_jitter_and_some_samples_are_lost() {
    let plant = Plant::preset("default").unwrap();
    let record = run(&plant, &still(60.0), 1);
    assert!(record.t_s.windows(2).all(|pair| pair[1] > pair[0]));
    let lost = 6001 - record.t_s.len();
    assert!((1..=40).contains(&lost), "{lost} of 6001 lost");
    let off_s = |t: &f64| t - (t * 100.0).round() / 100.0;
    let sigma_s = (record.t_s.iter().map(|t| off_s(t).powi(2)).sum::<f64>() / record.t_s.len() as f64).sqrt();
    assert!((sigma_s - 5e-4).abs() < 5e-5, "{sigma_s}");
    assert_eq!((record.t_s[0], *record.t_s.last().unwrap()), (0.0, 60.0));
    for joint in &record.joints {
        let columns = [&joint.measured_rad, &joint.true_rad_s, &joint.spool, &joint.rod_pressure_pa];
        assert!(columns.iter().all(|column| column.len() == record.t_s.len()));
    }
}

#[test]
fn measured_angles_are_true_ones_with_noise_on_whole_counts() {
    let plant = Plant::preset("default").unwrap();
    let record = run(&plant, &swing(), 1);
    let encoder = &plant.parameters().joints[0].encoder;
    let joint = &record.joints[0];
    let off: Vec<f64> = joint.measured_rad.iter().zip(&joint.true_rad).map(|(m, t)| m - t).collect();
    let sigma_rad = (off.iter().map(|x| x * x).sum::<f64>() / off.len() as f64).sqrt();
    let expected_rad = encoder.noise_rad.hypot(encoder.count_rad / 12.0_f64.sqrt());
    assert!((sigma_rad / expected_rad - 1.0).abs() < 0.1, "{sigma_rad} and {expected_rad}");
    let counts = joint.measured_rad.iter().map(|m| m / encoder.count_rad);
    assert!(counts.into_iter().all(|c| (c - c.round()).abs() < 1e-6));
}

#[test]
fn the_driver_s_speed_follows_the_true_one() {
    let plant = Plant::preset("default").unwrap();
    let joint = &run(&plant, &swing(), 1).joints[0];
    let rms = |values: &mut dyn Iterator<Item = f64>| {
        let (sum, count) = values.fold((0.0, 0.0), |(sum, count), x| (sum + x * x, count + 1.0));
        (sum / count).sqrt()
    };
    let off = rms(&mut joint.measured_rad_s.iter().zip(&joint.true_rad_s).map(|(m, t)| m - t));
    let own = rms(&mut joint.true_rad_s.iter().copied());
    assert!(off < 0.4 * own, "{off} and {own} rad/s");
}

#[test]
fn holding_still_stays_within_noise_and_the_limit_cycle() {
    for preset in ["dead-band-limited", "default", "lag-limited"] {
        let plant = Plant::preset(preset).unwrap();
        let record = run(&plant, &still(20.0), 5);
        for (j, joint) in record.joints.iter().enumerate() {
            let off = joint.true_rad.iter().map(|q| (q / DEGREE_RAD - POSE_DEG[j]).abs());
            let most = off.fold(0.0, f64::max);
            assert!(most < 0.15, "{preset} {}: {most} degrees", joint.name);
            let first = joint.measured_rad.iter().take(100).map(|q| (q / DEGREE_RAD - POSE_DEG[j]).abs());
            assert!(first.fold(0.0, f64::max) < 0.06, "{preset} {}", joint.name);
        }
    }
}

#[test]
fn dead_time_shifts_the_response_by_exactly_that_much() {
    // An open loop, so that what is late does not change what is sent.
    let late = |more_s: f64| {
        plant("default", |p| {
            ideal(p);
            for joint in &mut p.joints {
                (joint.control.position_gain_1_s, joint.control.integral_gain_1_s2) = (0.0, 0.0);
                (joint.control.feed_forward, joint.chambers.leakage_m3_s_pa) = (1.0, 0.0);
                joint.valve.dead_time_s += more_s;
            }
        })
    };
    let (early, late) = (run(&late(0.0), &swing(), 1), run(&late(0.13), &swing(), 1));
    for (early, late) in early.joints.iter().zip(&late.joints) {
        assert!(early.true_rad_s.iter().any(|v| v.abs() > 1.0 * DEGREE_RAD));
        for (early, late) in early.true_rad.iter().zip(&late.true_rad[13..]) {
            assert!((early - late).abs() < 1e-9, "{early} and {late}");
        }
    }
}

#[test]
fn a_payload_presses_the_arm_down_and_the_loop_lifts_it_again() {
    let plant = plant("default", |p| {
        ideal(p);
        p.joints.iter_mut().for_each(|joint| joint.encoder.backlash_rad = 0.0);
    });
    let payload = [PayloadChange { at_s: 2.0, mass_kg: 10.0 }];
    let record = simulate(&plant, &still(20.0), &payload, 1).unwrap();
    let without = run(&plant, &still(20.0), 1);
    let (with, without) = (&record.joints[0], &without.joints[0]);
    // Positive angles of joint 1 turn the arm down.
    let sag = |k: usize| (with.true_rad[k] - without.true_rad[k]) / DEGREE_RAD;
    assert!(sag(150).abs() < 1e-9);
    assert!(sag(300) > 0.002, "{} degrees", sag(300));
    assert!((with.true_rad[2000] / DEGREE_RAD - POSE_DEG[0]).abs() < 0.15);
    assert_eq!((record.payload_kg[100], record.payload_kg[1000]), (0.0, 10.0));
    assert!(record.payload_kg[240] > 4.0 && record.payload_kg[240] < 6.0);
}

#[test]
fn a_command_without_a_joint_or_without_speeds_is_refused() {
    let plant = Plant::preset("default").unwrap();
    let mut short = swing();
    let last = short.tracks.pop().unwrap();
    let error = simulate(&plant, &short, &[], 1).unwrap_err();
    assert_eq!(error, PlantError::NoCommand { joint: "J6".into(), what: "track" });
    let bare = hydrotrace::series::Track::new("J6", last.t_s(), last.position().to_vec(), &[]).unwrap();
    short.tracks.push(bare);
    let error = simulate(&plant, &short, &[], 1).unwrap_err();
    assert_eq!(error, PlantError::NoCommand { joint: "J6".into(), what: "speeds" });
}
