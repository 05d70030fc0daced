//! Which joints behave otherwise than they should in a way that has a name.

use super::{DirectionDelay, JointReplay, Replay, Sizes, TrackingError};

/// A joint stays off its plan at rest from so many bands of settling on: 0.5 deg, 5 mm.
const STAYS_OFF: f64 = 5.0;

impl Replay {
    /// In which direction a joint leaves standstill later, if by more than chance makes of the joints of this run.
    pub fn later_one_way(&self, joint: &JointReplay) -> Option<DirectionDelay> {
        let tested = self.joints.iter().filter(|joint| joint.direction_delay.is_some()).count();
        joint.direction_delay.filter(|found| found.counts(tested))
    }
}

impl JointReplay {
    /// The error of a joint at rest that stays off its plan there: one that slipped, or does not reach its target.
    pub fn stays_off(&self, sizes: &Sizes) -> Option<&TrackingError> {
        let off = |error: &&TrackingError| error.rms >= STAYS_OFF * sizes.settle_band;
        self.standstill_error.as_ref().filter(|_| self.moves && self.plan_moves).filter(off)
    }
}
