//! The same machine, changed.

use hydrotrace::plant::{Parameters, PayloadChange};

/// What has changed since a model of the machine was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Variation {
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
    #[allow(dead_code, reason = "tried by the slow tests only")]
    pub(crate) const ALL: [Self; 4] =
        [Self::HeavyPayload, Self::ColdOil, Self::LowSupply, Self::MoreFriction];

    /// The numbers of the machine as it is now.
    pub(crate) fn parameters(self, before: &Parameters) -> Parameters {
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
    pub(crate) fn payload(self, before: &[PayloadChange]) -> Vec<PayloadChange> {
        let factor = if self == Self::HeavyPayload { 3.0 } else { 1.0 };
        before.iter().map(|change| PayloadChange { mass_kg: factor * change.mass_kg, ..*change }).collect()
    }
}
