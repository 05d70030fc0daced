//! The arm against Pinocchio, against its own derived values, and against the laws of mechanics.

mod cylinders;
mod drawing;
mod dynamics;
mod pinocchio;
mod reach;
mod urdf;

use hydrotrace::{
    arm::{Arm, Chain, Inertia, Motion, Workspace},
    rng::{Stream, stream},
};
use rand_distr::{Distribution, Uniform};

const SPATIAL: &str = include_str!("../../reference/spatial-7.urdf");
const SLIDING: &str = include_str!("../../reference/sliding-5.urdf");
const PLATE: &str = include_str!("../../../sample-logs/arm/arm-with-plate.urdf");

fn sample() -> Arm {
    Arm::sample().unwrap()
}

fn spatial() -> Chain {
    Chain::from_urdf(SPATIAL, "spatial-7.urdf", Some("tool")).unwrap()
}

/// Skew joints of which some slide.
fn sliding() -> Chain {
    Chain::from_urdf(SLIDING, "sliding-5.urdf", Some("tool")).unwrap()
}

/// One of the two.
fn skew(seed: u64) -> Chain {
    if seed.is_multiple_of(2) { spatial() } else { sliding() }
}

/// Torques of one instant.
fn torque(chain: &Chain, payload: Option<&Inertia>, q: &[f64], qd: &[f64], qdd: &[f64]) -> Vec<f64> {
    let lane = |values: &[f64]| -> Vec<[f64; 1]> { values.iter().map(|&v| [v]).collect() };
    let mut torque = vec![[0.0]; chain.joint_count()];
    let (q, qd, qdd) = (lane(q), lane(qd), lane(qdd));
    let motion = Motion { position_rad: &q, speed_rad_s: &qd, acceleration_rad_s2: &qdd };
    chain.inverse_dynamics(&chain.load(payload), motion, &mut Workspace::new(chain), &mut torque);
    torque.concat()
}

/// Numbers in a range, from a seed.
fn random(seed: u64, count: usize, most: f64) -> Vec<f64> {
    let mut rng = stream(seed, Stream::Motion);
    Uniform::new(-most, most).unwrap().sample_iter(&mut rng).take(count).collect()
}

fn norm(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum::<f64>().sqrt()
}
