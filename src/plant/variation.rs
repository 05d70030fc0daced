//! The same machine on another day.

use std::borrow::Cow;

use rand_distr::{Distribution, StandardUniform};

use super::{Parameters, PayloadChange};
use crate::rng::{Stream, stream};

impl Parameters {
    /// The machine as it is in one run: null, friction and dead time of each valve drawn anew within
    /// their drifts.
    pub(super) fn of_run(&self, seed: u64) -> Cow<'_, Self> {
        let drifts = |joint: &super::JointParameters| {
            joint.valve.null_drift + joint.valve.dead_time_drift_s + joint.friction.drift > 0.0
        };
        if !self.joints.iter().any(drifts) {
            return Cow::Borrowed(self);
        }
        let mut rng = stream(seed, Stream::Run);
        let mut within = move |most: f64| {
            let share: f64 = StandardUniform.sample(&mut rng);
            most * (2.0 * share - 1.0)
        };
        let mut now = self.clone();
        for joint in &mut now.joints {
            let (valve, friction) = (&mut joint.valve, &mut joint.friction);
            // A null that has moved is more overlap on one side and less on the other.
            let null = within(valve.null_drift).max(-valve.overlap_retract).min(valve.overlap_extend);
            valve.overlap_extend -= null;
            valve.overlap_retract += null;
            valve.dead_time_s = (valve.dead_time_s + within(valve.dead_time_drift_s)).max(0.0);
            let factor = 1.0 + within(friction.drift);
            friction.coulomb_n *= factor;
            friction.breakaway_n *= factor;
            friction.viscous_n_s_m *= factor;
        }
        Cow::Owned(now)
    }
}

/// What has changed since a model of the machine was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Variation {
    /// Three times the payload.
    HeavyPayload,
    /// Viscous friction times 2.5, spool lag times 1.6, dead time 30 ms longer, flow less by 10 %.
    ColdOil,
    /// A supply of 12 megapascal.
    LowSupply,
    /// Coulomb, breakaway and viscous friction times 1.5.
    MoreFriction,
}

impl Variation {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::HeavyPayload, Self::ColdOil, Self::LowSupply, Self::MoreFriction];

    /// The numbers of the machine as it is now.
    #[must_use]
    pub fn parameters(self, before: &Parameters) -> Parameters {
        let mut now = before.clone();
        match self {
            Self::HeavyPayload => {}
            Self::LowSupply => now.supply.pressure_pa = 12e6,
            Self::ColdOil => {
                for joint in &mut now.joints {
                    joint.friction.viscous_n_s_m *= 2.5;
                    joint.valve.spool_lag_s *= 1.6;
                    joint.valve.dead_time_s += 0.03;
                    joint.valve.flow_gain_m3_s_sqrt_pa *= 0.9;
                }
            }
            Self::MoreFriction => {
                for friction in now.joints.iter_mut().map(|joint| &mut joint.friction) {
                    friction.coulomb_n *= 1.5;
                    friction.breakaway_n *= 1.5;
                    friction.viscous_n_s_m *= 1.5;
                }
            }
        }
        now
    }

    /// The payload as it is now.
    #[must_use]
    pub fn payload(self, before: &[PayloadChange]) -> Vec<PayloadChange> {
        let factor = if self == Self::HeavyPayload { 3.0 } else { 1.0 };
        before.iter().map(|change| PayloadChange { mass_kg: factor * change.mass_kg, ..*change }).collect()
    }
}
