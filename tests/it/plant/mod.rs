//! The simulated arm from outside: laws of its runs, and the regimes of the paper's tasks.

mod detector;
mod log;
mod paper;
mod robust;
mod runs;
mod starts;

use hydrotrace::{
    arm::Arm,
    plant::{Parameters, Plant, Record},
    series::{Pair, Series, Track, align},
    units::DEGREE_RAD,
};

/// The joints of the sample arm amid their ranges, degrees.
const POSE_DEG: [f64; 6] = [60.0, 110.0, -20.0, 8.0, 8.0, 8.0];

/// The sample arm with a preset that a test changes.
fn plant(preset: &str, change: impl FnOnce(&mut Parameters)) -> Plant {
    let mut parameters = Parameters::preset(preset).unwrap();
    change(&mut parameters);
    Plant::new(&Arm::sample().unwrap(), parameters).unwrap()
}

/// Sensors and log that lose and add nothing.
fn ideal(parameters: &mut Parameters) {
    (parameters.cycle.jitter_s, parameters.cycle.loss) = (0.0, 0.0);
    for joint in &mut parameters.joints {
        (joint.encoder.noise_rad, joint.encoder.count_rad) = (0.0, 1e-9);
    }
}

/// A command at 100 Hz from angles and speeds, degrees and degrees a second, by joint and time.
fn command(duration_s: f64, state_deg: impl Fn(usize, f64) -> (f64, f64)) -> Series {
    let t_s: Vec<f64> = (0..=(duration_s * 100.0).round() as u32).map(|k| f64::from(k) * 0.01).collect();
    let track = |j: usize| {
        let (q, qd): (Vec<f64>, Vec<f64>) = t_s.iter().map(|&t| state_deg(j, t)).unzip();
        let radians = |values: Vec<f64>| values.iter().map(|x| x * DEGREE_RAD).collect::<Vec<f64>>();
        let track = Track::new(format!("J{}", j + 1), t_s.clone(), radians(q), &[]).unwrap();
        track.with_velocity(radians(qd)).unwrap()
    };
    Series { tracks: (0..6).map(track).collect() }
}

/// Plan and measurement, by joint.
fn pairs(plan: &Series, record: &Record) -> Vec<Pair> {
    let pair = |joint: &hydrotrace::plant::JointRecord| {
        let measured = Track::new(&joint.name, record.t_s.clone(), joint.measured_rad.clone(), &[]).unwrap();
        align(plan.track(&joint.name).unwrap(), &measured).unwrap()
    };
    record.joints.iter().map(pair).collect()
}
