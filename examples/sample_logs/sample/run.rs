//! One run of the sample machine: who moved, how, and what the control loop saw of it.

use std::error::Error;

use hydrotrace::{
    rng::{self, Stream},
    units::DEGREE_RAD,
};
use rand_distr::{Distribution, Uniform};

use super::{
    machine::{JOINTS, Motion, follow},
    plan::{JointPlan, panel_install},
    recorder::{Cycle, cycles},
};

/// Joints stand at most this far from home at first, rad.
const OFFSET_RAD: f64 = 0.05 * DEGREE_RAD;

/// A run. All lists but the cycles are in the order of `order`.
#[derive(Debug)]
pub(crate) struct Run {
    pub(crate) seed: u64,
    /// Indices into [`JOINTS`], in the order in which the log lists the joints.
    pub(crate) order: Vec<usize>,
    pub(crate) plans: Vec<JointPlan>,
    /// Angle minus plan before the first start, rad.
    pub(crate) offsets_rad: Vec<f64>,
    pub(crate) motions: Vec<Motion>,
    pub(crate) cycles: Vec<Cycle>,
}

impl Run {
    /// Installs a panel. The joints in `still` are asked for nothing.
    pub(crate) fn new(seed: u64, order: [usize; 6], still: &[usize]) -> Result<Self, Box<dyn Error>> {
        let mut rng = rng::stream(seed, Stream::Motion);
        let offset = Uniform::new(-OFFSET_RAD, OFFSET_RAD)?;
        let by_joint_rad: Vec<f64> = JOINTS.iter().map(|_| offset.sample(&mut rng)).collect();
        let offsets_rad: Vec<f64> = order.iter().map(|&joint| by_joint_rad[joint]).collect();
        let all = panel_install();
        let plan = |&joint: &usize| {
            let plan = all[joint].clone();
            if still.contains(&joint) { plan.at_rest() } else { plan }
        };
        let plans: Vec<JointPlan> = order.iter().map(plan).collect();
        let motions: Vec<Motion> = order
            .iter()
            .zip(&plans)
            .zip(&offsets_rad)
            .map(|((&joint, plan), &offset_rad)| follow(plan, &JOINTS[joint], offset_rad))
            .collect();
        let cycles = cycles(seed, &plans, &motions)?;
        Ok(Self { seed, order: order.to_vec(), plans, offsets_rad, motions, cycles })
    }

    /// Names of the joints, in the order of the log.
    pub(crate) fn joint_names(&self) -> Vec<String> {
        self.order.iter().map(|joint| format!("joint_{}", joint + 1)).collect()
    }
}
