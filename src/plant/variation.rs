//! The same machine on another day.

use std::borrow::Cow;

use rand_distr::{Distribution, StandardUniform};

use super::Parameters;
use crate::rng::{Stream, stream};

impl Parameters {
    /// The machine as it is in one run: null, friction and dead time of each valve drawn anew within their drifts.
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
