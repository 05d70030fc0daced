//! Laws of the machine with its loops open.

#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use std::fmt::Write;

use super::{
    cylinder::{Pressures, steady_speed_m_s},
    machine::Machine,
    mechanics::Mechanics,
    *,
};
use crate::{
    arm::{Motion, Workspace},
    units::DEGREE_RAD,
};

/// The joints of the sample arm amid their ranges, rad.
const POSE_RAD: [f64; 6] = [1.05, 1.9, -0.35, 0.14, 0.14, 0.14];

/// A preset whose loops, pistons and sensors are ideal where the test does not ask.
fn sample(change: impl FnOnce(&mut Parameters)) -> Plant {
    let mut parameters = Parameters::preset("default").unwrap();
    change(&mut parameters);
    Plant::new(&Arm::sample().unwrap(), parameters).unwrap()
}

fn without_leaks(parameters: &mut Parameters) {
    parameters.joints.iter_mut().for_each(|joint| joint.chambers.leakage_m3_s_pa = 0.0);
}

fn run(machine: &mut Machine, time_s: f64) {
    (0..(time_s / STEP_S).round() as u32).for_each(|_| machine.step(|| 0.0));
}

/// A chain of like links that turn about upright axes, so that nothing weighs on the joints.
fn upright(joints: usize) -> (Arm, Parameters) {
    let mut urdf = String::from("<robot name=\"r\"><link name=\"l0\"/>");
    let mut cylinders = String::from(
        "supply_pressure_pa = 16e6\nreturn_pressure_pa = 0.0\nmechanical_efficiency = 1.0\npump_flow_m3_s = 1e-2\n",
    );
    for j in 1..=joints {
        write!(
            urdf,
            "<joint name=\"A{j}\" type=\"revolute\"><parent link=\"l{}\"/><child link=\"l{j}\"/>\
             <origin xyz=\"{} 0 0\"/><axis xyz=\"0 0 1\"/>\
             <limit lower=\"-1\" upper=\"1\" effort=\"1e4\" velocity=\"1\"/></joint>\
             <link name=\"l{j}\"><inertial><origin xyz=\"0.5 0 0\"/><mass value=\"30\"/>\
             <inertia ixx=\"2\" iyy=\"2\" izz=\"2\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>",
            j - 1,
            if j == 1 { 0.0 } else { 1.0 },
        )
        .unwrap();
        write!(
            cylinders,
            "[joint.A{j}]\nbore_m = 0.05\nrod_m = 0.035\na_m = 0.4\nb_m = 0.2\ndelta_rad = 1.5\nangle_sign = 1\n"
        )
        .unwrap();
    }
    urdf += "</robot>";
    let arm = Arm::new(("r.urdf", &urdf), None, ("r.toml", &cylinders)).unwrap();
    let base = Parameters::preset("default").unwrap();
    let mut parameters = base.clone();
    parameters.supply.return_pressure_pa = 0.0;
    parameters.supply.flow_m3_s = 1e-2;
    parameters.joints =
        (1..=joints).map(|j| JointParameters { name: format!("A{j}"), ..base.joints[0].clone() }).collect();
    (arm, parameters)
}

#[test]
fn a_machine_at_rest_stays_where_it_is() {
    let plant = sample(without_leaks);
    let mut machine = Machine::at_rest(&plant, &POSE_RAD, 0.0).unwrap();
    run(&mut machine, 5.0);
    for (state, start_rad) in machine.states.iter().zip(POSE_RAD) {
        assert!((state.position_rad - start_rad).abs() < 1e-9, "{}", state.position_rad - start_rad);
    }
}

#[test]
fn leakage_lowers_a_loaded_arm_no_faster_than_the_oil_that_passes() {
    let plant = sample(|_| {});
    let mut machine = Machine::at_rest(&plant, &POSE_RAD, 0.0).unwrap();
    let drop_pa = machine.states.iter().map(|s| (s.pressures.cap_pa - s.pressures.rod_pa).abs());
    let drop_pa: Vec<f64> = drop_pa.collect();
    run(&mut machine, 20.0);
    for (j, state) in machine.states.iter().enumerate() {
        let rod_m_s = 2e-15 * drop_pa[j] / plant.axes[j].size.rod_area_m2;
        let bound_rad = 20.0 * rod_m_s / 0.05 + 1e-4;
        assert!((state.position_rad - POSE_RAD[j]).abs() < bound_rad, "joint {j}");
    }
}

#[test]
fn a_push_dies_out_once_all_valves_are_closed() {
    let plant = sample(without_leaks);
    let mut machine = Machine::at_rest(&plant, &POSE_RAD, 0.0).unwrap();
    machine.states.iter_mut().for_each(|state| state.speed_rad_s = 0.02);
    run(&mut machine, 20.0);
    for (state, start_rad) in machine.states.iter().zip(POSE_RAD) {
        assert!(state.speed_rad_s.abs() < 1e-5, "{} rad/s", state.speed_rad_s);
        assert!((state.position_rad - start_rad).abs() < 1e-3);
    }
}

#[test]
fn a_constant_opening_settles_at_the_speed_of_the_flow_law() {
    let plant = sample(without_leaks);
    for (j, signal) in (0..6).flat_map(|j| [(j, 0.3), (j, -0.3), (j, 0.6)]) {
        let mut machine = Machine::at_rest(&plant, &POSE_RAD, 0.0).unwrap();
        machine.states[j].signal = signal;
        run(&mut machine, 0.6);
        let mean_rad_s = |machine: &mut Machine| {
            let before_rad = machine.states[j].position_rad;
            run(machine, 0.4);
            (machine.states[j].position_rad - before_rad) / 0.4
        };
        // Speed against the law in the middle of the way, where the pose is that of the middle.
        let opening = machine.states[j].spool.opening(&plant.parameters.joints[j].valve);
        run(&mut machine, 0.2);
        let middle: Vec<(f64, f64)> = machine.states.iter().map(|state| (state.position_rad, 0.0)).collect();
        let mut machine = Machine::at_rest(&plant, &POSE_RAD, 0.0).unwrap();
        machine.states[j].signal = signal;
        run(&mut machine, 0.6);
        let speed_rad_s = mean_rad_s(&mut machine);
        let mut mechanics = Mechanics::new(&plant);
        mechanics.look(&plant, middle.into_iter(), 0.0);
        let joint = &plant.parameters.joints[j];
        let rod_m_s = steady_speed_m_s(
            (&plant.axes[j].size, &joint.valve, &joint.friction),
            &plant.parameters.supply,
            opening,
            mechanics.bias_nm[j] / mechanics.lever_m[j],
        );
        let law_rad_s = rod_m_s / mechanics.lever_m[j];
        let off = speed_rad_s / law_rad_s - 1.0;
        assert!(off.abs() < 0.03, "joint {j} at {signal}: {speed_rad_s} and {law_rad_s} rad/s");
    }
}

#[test]
fn with_equal_edges_and_no_load_extending_is_faster_by_the_root_of_the_areas() {
    let (arm, mut parameters) = upright(1);
    let joint = &mut parameters.joints[0];
    joint.friction.coulomb_n = 1.0;
    joint.friction.breakaway_n = 1.0;
    joint.friction.viscous_n_s_m = 0.0;
    (joint.valve.overlap_extend, joint.valve.overlap_retract) = (0.08, 0.08);
    let plant = Plant::new(&arm, parameters).unwrap();
    let speed = |signal: f64| {
        let mut machine = Machine::at_rest(&plant, &[0.0], 0.0).unwrap();
        machine.states[0].signal = signal;
        run(&mut machine, 0.5);
        let start_rad = machine.states[0].position_rad;
        run(&mut machine, 0.1);
        // By lever: rod speed.
        let (sin, cos) = (0.5 * (start_rad + machine.states[0].position_rad)).sin_cos();
        let lever_m = plant.axes[0].cylinder.length_and_lever(sin, cos).1;
        lever_m * (machine.states[0].position_rad - start_rad) / 0.1
    };
    let size = plant.axes[0].size;
    let expected = (size.cap_area_m2 / size.rod_area_m2).sqrt();
    let found = -speed(0.3) / speed(-0.3);
    assert!((found / expected - 1.0).abs() < 0.01, "{found}, expected {expected}");
}

#[test]
fn a_rod_stops_at_the_end_of_its_stroke() {
    let (arm, parameters) = upright(1);
    let plant = Plant::new(&arm, parameters).unwrap();
    let mut machine = Machine::at_rest(&plant, &[0.8], 0.0).unwrap();
    machine.states[0].signal = 1.0;
    run(&mut machine, 3.0);
    assert!((machine.states[0].position_rad - 1.0).abs() < 0.02, "{}", machine.states[0].position_rad);
    assert!(machine.states[0].speed_rad_s.abs() < 1e-3);
}

#[test]
fn inertia_is_that_of_inverse_dynamics_for_any_number_of_joints() {
    for joints in [1, 7, 8, 9] {
        let (arm, parameters) = upright(joints);
        let plant = Plant::new(&arm, parameters).unwrap();
        let q: Vec<f64> = (0..joints).map(|j| 0.3 - 0.1 * j as f64).collect();
        let mut mechanics = Mechanics::new(&plant);
        mechanics.look(&plant, q.iter().map(|&q| (q, 0.0)), 4.0);
        let load = arm.chain.load(crate::arm::Inertia::point(4.0, nalgebra::Vector3::zeros()).as_ref());
        for column in 0..joints {
            let lanes =
                |of: &dyn Fn(usize) -> f64| -> Vec<[f64; 1]> { (0..joints).map(|j| [of(j)]).collect() };
            let motion = (lanes(&|j| q[j]), lanes(&|_| 0.0), lanes(&|j| f64::from(u8::from(j == column))));
            let mut torque = vec![[0.0]; joints];
            let motion =
                Motion { position_rad: &motion.0, speed_rad_s: &motion.1, acceleration_rad_s2: &motion.2 };
            arm.chain.inverse_dynamics(&load, motion, &mut Workspace::new(&arm.chain), &mut torque);
            for row in 0..joints {
                let product: f64 =
                    (0..joints).map(|k| mechanics.mobility[row * joints + k] * torque[k][0]).sum();
                assert!((product - f64::from(u8::from(row == column))).abs() < 1e-8, "{joints} joints");
            }
        }
    }
}

#[test]
fn joints_that_move_at_once_share_the_pump() {
    let plant = sample(|parameters| parameters.supply.flow_m3_s = 1.5e-4);
    let way_rad = |joints: &[usize]| {
        let mut machine = Machine::at_rest(&plant, &POSE_RAD, 0.0).unwrap();
        for &j in joints {
            machine.states[j].signal = 0.9;
        }
        run(&mut machine, 0.8);
        ((machine.states[0].position_rad - POSE_RAD[0]).abs(), machine.supply_pa)
    };
    let (alone_rad, alone_pa) = way_rad(&[0]);
    let (together_rad, together_pa) = way_rad(&[0, 1, 2]);
    assert!(together_rad < 0.8 * alone_rad, "{together_rad} and {alone_rad} rad");
    assert!(together_pa < alone_pa - 1e6);
}

#[test]
fn a_start_that_the_supply_cannot_hold_is_refused() {
    let plant = sample(|parameters| parameters.supply.pressure_pa = 3e6);
    let error = Machine::at_rest(&plant, &[0.4, 2.4, 0.0, 0.0, 0.0, 0.0], 200.0).err().unwrap();
    assert!(matches!(&error, PlantError::TooHeavy { .. }), "{error}");
}

#[test]
fn a_machine_too_stiff_for_the_step_is_refused() {
    let (arm, mut parameters) = upright(1);
    parameters.joints[0].friction.bristle_stiffness_n_m = 1e9;
    parameters.joints[0].friction.bristle_damping_n_s_m = 1e7;
    let plant = Plant::new(&arm, parameters).unwrap();
    assert!(matches!(Machine::at_rest(&plant, &[0.0], 0.0), Err(PlantError::TooStiff { .. })));
}

#[test]
fn the_true_speed_limit_is_where_a_full_signal_takes_the_joint() {
    let plant = sample(without_leaks);
    let truth = plant.truth(&POSE_RAD, 0.0).unwrap();
    for (j, way) in (0..6).flat_map(|j| [(j, 0), (j, 1)]) {
        let sign = if way == 0 { 1.0 } else { -1.0 };
        // So far back that the joint passes the pose at full speed, and no farther.
        let ahead_rad = 0.35 * truth.joints[j].speed_limit_rad_s[way];
        let mut pose = POSE_RAD;
        pose[j] -= sign * ahead_rad;
        let mut machine = Machine::at_rest(&plant, &pose, 0.0).unwrap();
        machine.states[j].signal = sign;
        let (mut steepest, mut before) = (0.0_f64, 0.0);
        let mut passes = Vec::new();
        for step in 0..120 {
            run(&mut machine, 0.005);
            let speed_rad_s = sign * machine.states[j].speed_rad_s;
            steepest = steepest.max((speed_rad_s - before) / 0.005);
            before = speed_rad_s;
            // Meanwhile oil and arm have swung to and fro.
            if step >= 60
                && passes.len() < 31
                && sign * (machine.states[j].position_rad - POSE_RAD[j]) > -0.025
            {
                passes.push(speed_rad_s);
            }
        }
        let speed_rad_s = passes.iter().sum::<f64>() / passes.len() as f64;
        let (limit, rise) =
            (truth.joints[j].speed_limit_rad_s[way], truth.joints[j].acceleration_limit_rad_s2[way]);
        assert!((speed_rad_s / limit - 1.0).abs() < 0.05, "joint {j} {way}: {speed_rad_s} and {limit} rad/s");
        assert!(steepest > 0.8 * rise, "joint {j} {way}: {steepest} and {rise} rad/s²");
        assert!(limit > 14.0 * DEGREE_RAD && limit < 26.0 * DEGREE_RAD);
    }
}

#[test]
fn oil_flows_once_the_wanted_speed_leaves_the_true_dead_band() {
    let plant = sample(without_leaks);
    let truth = plant.truth(&POSE_RAD, 0.0).unwrap();
    for (j, way) in (0..6).flat_map(|j| [(j, 0), (j, 1)]) {
        let sign = if way == 0 { 1.0 } else { -1.0 };
        let way_rad = |share: f64| {
            let mut machine = Machine::at_rest(&plant, &POSE_RAD, 0.0).unwrap();
            let wanted_rad_s = sign * share * truth.joints[j].dead_band_rad_s[way];
            machine.states[j].signal = plant.parameters.joints[j].control.signal(wanted_rad_s);
            run(&mut machine, 4.0);
            sign * (machine.states[j].position_rad - POSE_RAD[j])
        };
        assert!(way_rad(0.98).abs() < 1e-9, "joint {j} {way}");
        assert!(way_rad(1.1) > 5e-4, "joint {j} {way}: {}", way_rad(1.1));
    }
}

#[test]
fn oil_leaves_past_a_counterbalance_valve_only_once_load_and_pilot_open_it() {
    let least = |preset: &str| {
        let mut parameters = Parameters::preset(preset).unwrap();
        without_leaks(&mut parameters);
        let plant = Plant::new(&Arm::sample().unwrap(), parameters).unwrap();
        let mut least_pa = f64::INFINITY;
        for (j, signal) in (0..6).flat_map(|j| [(j, 0.3), (j, -0.3)]) {
            let mut machine = Machine::at_rest(&plant, &POSE_RAD, 0.0).unwrap();
            machine.states[j].signal = signal;
            run(&mut machine, 0.8);
            let Pressures { cap_pa, rod_pa } = machine.states[j].pressures;
            let extends = machine.states[j].spool.travel > 0.0;
            let (feeds_pa, drains_pa) = if extends { (cap_pa, rod_pa) } else { (rod_pa, cap_pa) };
            least_pa = least_pa.min(drains_pa + 2.5 * feeds_pa);
        }
        least_pa
    };
    let (with_pa, without_pa) = (least("counterbalance"), least("default"));
    assert!(with_pa > 30e6 && without_pa < 25e6, "{with_pa} and {without_pa} Pa");
}
