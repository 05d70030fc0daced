//! Which joints behave otherwise than they should in a way that has a name.

use super::{DirectionDelay, JointReplay, Kind, Replay, Sizes, TrackingError, Transition};
use crate::math::median;

/// A joint stays off its plan at rest from so many bands of settling on: 0.5 deg, 10 mm.
const STAYS_OFF: f64 = 5.0;

/// Share of the intervals of single starts that may be alike for all starts of a direction.
const ALIKE: f64 = 0.6;

impl Replay {
    /// In which direction a joint leaves standstill later, if by more than chance makes of the joints of this run, and than
    /// the intervals of its starts leave open.
    pub fn later_one_way(&self, joint: &JointReplay) -> Option<DirectionDelay> {
        let tested = self.joints.iter().filter(|joint| joint.direction_delay.is_some()).count();
        let own = || self.transitions.iter().filter(|start| start.joint == joint.name);
        joint.direction_delay.filter(|found| found.counts(tested) && is_beyond(own(), found))
    }
}

/// Whether a direction is later than the intervals of the single starts leave open. Their mean is no better known: an encoder
/// that rounds, or a plan of few samples, dates all starts of a direction wrong alike.
fn is_beyond<'a>(starts: impl Iterator<Item = &'a Transition>, found: &DirectionDelay) -> bool {
    let mut open_s = [Vec::new(), Vec::new()];
    for start in starts.filter(|start| start.kind == Kind::Start) {
        if let (Some(delay_s), Some([least_s, most_s])) = (start.onset_delay_s, start.onset_delay_interval_s)
        {
            let later = start.direction == found.direction;
            open_s[usize::from(later)].push(if later { delay_s - least_s } else { most_s - delay_s });
        }
    }
    let [other_s, later_s] = open_s.map(|open_s| if open_s.is_empty() { 0.0 } else { median(open_s) });
    found.mean_delay_s[0] - found.mean_delay_s[1] > ALIKE * other_s.hypot(later_s)
}

impl JointReplay {
    /// The error of a joint at rest that stays off its plan there: one that slipped, or does not reach its target.
    pub fn stays_off(&self, sizes: &Sizes) -> Option<&TrackingError> {
        let off = |error: &&TrackingError| error.rms >= STAYS_OFF * sizes.settle_band;
        self.standstill_error.as_ref().filter(|_| self.moves && self.plan_moves).filter(off)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_direction_is_not_later_by_what_each_start_leaves_open() {
        let found = DirectionDelay {
            direction: -1,
            mean_delay_s: [0.29, 0.16],
            starts: [3, 3],
            interval_s: [0.09, 0.17],
            p_value: 0.006,
        };
        let start = |direction: i8, delay_s: f64, open_s: f64| Transition {
            direction,
            onset_delay_s: Some(delay_s),
            onset_delay_interval_s: Some([delay_s - open_s, delay_s + open_s]),
            ..Transition::default()
        };
        let both = |open_s: f64| [start(1, 0.16, open_s), start(-1, 0.29, open_s)];
        assert!(is_beyond(both(0.05).iter(), &found) && is_beyond([].iter(), &found));
        assert!(!is_beyond(both(0.2).iter(), &found), "an encoder that rounds");
    }
}
