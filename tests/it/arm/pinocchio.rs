//! Agreement with `tests/reference/arm-pinocchio.json`, written by `generate_arm.py`.

use std::collections::BTreeMap;

use hydrotrace::arm::{Motion, Pose, Workspace};
use nalgebra::{Matrix3, Vector3};
use serde::Deserialize;

use super::*;

#[derive(Deserialize)]
struct Reference {
    arms: BTreeMap<String, Case>,
}

#[derive(Deserialize)]
struct Case {
    joints: Vec<String>,
    states: Vec<State>,
}

#[derive(Deserialize)]
struct State {
    position_rad: Vec<f64>,
    speed_rad_s: Vec<f64>,
    acceleration_rad_s2: Vec<f64>,
    torque_nm: Vec<f64>,
    tool_speed_m_s: f64,
    poses: BTreeMap<String, Vec<f64>>,
}

fn cases() -> Vec<(Chain, Case)> {
    let reference: Reference =
        serde_json::from_str(include_str!("../../reference/arm-pinocchio.json")).unwrap();
    assert_eq!(reference.arms.len(), 4);
    let arms = reference.arms.into_iter().map(|(name, case)| {
        let chain = match name.as_str() {
            "arm" => sample().chain,
            "arm-with-plate" => Chain::from_urdf(PLATE, &name, Some("tool")).unwrap(),
            "sliding-5" => sliding(),
            _ => spatial(),
        };
        assert!(chain.joints().iter().map(|joint| &joint.name).eq(&case.joints));
        assert_eq!(case.states.len(), 40);
        (chain, case)
    });
    arms.collect()
}

fn close(found: &[f64], expected: &[f64]) {
    let off: Vec<f64> = found.iter().zip(expected).map(|(a, b)| a - b).collect();
    assert_eq!(found.len(), expected.len());
    assert!(norm(&off) < 1e-11 * norm(expected), "{found:?} is not {expected:?}");
}

#[test]
fn torques_agree_to_eleven_digits() {
    for (chain, case) in cases() {
        for s in &case.states {
            let found = torque(&chain, None, &s.position_rad, &s.speed_rad_s, &s.acceleration_rad_s2);
            close(&found, &s.torque_nm);
        }
    }
}

#[test]
fn eight_instants_at_once_are_bit_for_bit_the_instants_one_by_one() {
    for (chain, case) in cases() {
        let mut work = Workspace::<8>::new(&chain);
        for eight in case.states.chunks_exact(8) {
            let lanes = |of: fn(&State) -> &Vec<f64>| -> Vec<[f64; 8]> {
                let row = |joint: usize| std::array::from_fn(|lane| of(&eight[lane])[joint]);
                (0..chain.joint_count()).map(row).collect()
            };
            let (q, qd, qdd) =
                (lanes(|s| &s.position_rad), lanes(|s| &s.speed_rad_s), lanes(|s| &s.acceleration_rad_s2));
            let motion = Motion { position_rad: &q, speed_rad_s: &qd, acceleration_rad_s2: &qdd };
            let mut found = vec![[0.0; 8]; chain.joint_count()];
            chain.inverse_dynamics(&chain.load(None), motion, &mut work, &mut found);
            for (lane, s) in eight.iter().enumerate() {
                let one = torque(&chain, None, &s.position_rad, &s.speed_rad_s, &s.acceleration_rad_s2);
                let lane: Vec<f64> = found.iter().map(|joint| joint[lane]).collect();
                assert_eq!(lane, one);
            }
        }
    }
}

#[test]
fn the_plate_as_payload_is_the_plate_as_link() {
    let (_, plate) = cases().swap_remove(1);
    let tensor = Matrix3::from_diagonal(&Vector3::new(1.066_667, 0.533_337, 0.533_337));
    let payload = Inertia::new(10.0, Vector3::new(0.001_000_000_000_000_000_9, 0.0, 0.0), tensor);
    for s in &plate.states {
        let chain = sample().chain;
        let found = torque(&chain, payload.as_ref(), &s.position_rad, &s.speed_rad_s, &s.acceleration_rad_s2);
        close(&found, &s.torque_nm);
    }
}

#[test]
fn poses_of_all_links_agree() {
    for (chain, case) in cases() {
        for s in &case.states {
            let poses = chain.link_poses(&s.position_rad);
            assert_eq!(poses.len(), chain.link_names().count());
            for (name, pose) in chain.link_names().zip(&poses).skip(1) {
                close(&rows(pose), &s.poses[name]);
            }
            close(&rows(&chain.tool_pose(&s.position_rad)), &s.poses["tool"]);
        }
    }
}

#[test]
fn the_tool_is_as_fast() {
    for (chain, case) in cases() {
        for s in &case.states {
            close(&[chain.tool_speed_m_s(&s.position_rad, &s.speed_rad_s)], &[s.tool_speed_m_s]);
        }
    }
}

fn rows(pose: &Pose) -> Vec<f64> {
    let whole = pose.to_homogeneous();
    (0..3).flat_map(|r| (0..4).map(move |c| whole[(r, c)])).collect()
}
