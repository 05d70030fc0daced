//! Machines that nobody built.

use rand_distr::{Distribution, StandardUniform};

use super::{
    Parameters,
    quantity::{Place, QUANTITIES},
};
use crate::rng::{Stream, stream};

impl Parameters {
    /// A machine around this one: every number of the hydraulics, of the mechanics and of the loop's gains is
    /// multiplied with a number of its own, within 20 to 50 % of 1. Equal seeds give equal machines.
    pub fn random(&self, seed: u64) -> Self {
        let mut rng = stream(seed, Stream::Machine);
        let mut other = self.clone();
        other.title = format!("{}, varied by seed {seed}", self.title);
        for quantity in QUANTITIES.iter().filter(|quantity| quantity.spread > 0.0) {
            let mut vary = |value: &mut f64| {
                let unit: f64 = StandardUniform.sample(&mut rng);
                let (least, most) = quantity.range;
                let varied = *value * (1.0 + quantity.spread * (2.0 * unit - 1.0));
                *value = varied.max(least * quantity.unit).min(most * quantity.unit);
            };
            match quantity.place {
                Place::Machine(of) => vary(of(&mut other)),
                Place::Joint(of) => other.joints.iter_mut().for_each(|joint| vary(of(joint))),
            }
        }
        for joint in &mut other.joints {
            joint.friction.breakaway_n = joint.friction.breakaway_n.max(joint.friction.coulomb_n);
        }
        other
    }
}

#[cfg(test)]
mod tests {
    use super::{super::Plant, *};
    use crate::arm::Arm;

    #[test]
    fn random_machines_can_be_built_and_depend_on_their_seed_alone() {
        let base = Parameters::preset("default").unwrap();
        let arm = Arm::sample().unwrap();
        for seed in 0..50 {
            let random = base.random(seed);
            assert_eq!(random, base.random(seed));
            assert_ne!(random.joints, base.random(seed + 1).joints);
            Plant::new(&arm, random).unwrap();
        }
    }

    #[test]
    fn noise_and_log_are_those_of_the_machine_varied() {
        let base = Parameters::preset("default").unwrap();
        let random = base.random(3);
        assert_eq!(random.cycle, base.cycle);
        assert!((random.joints[2].encoder.noise_rad - base.joints[2].encoder.noise_rad).abs() < 1e-18);
    }
}
