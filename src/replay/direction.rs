//! Whether a joint leaves standstill later in one direction than in the other, as one does whose valve has a larger dead band
//! there.

use serde::{Deserialize, Serialize};

use crate::math::difference;

/// Less tells nothing that a valve is set by, s.
const LEAST_S: f64 = 0.03;

/// Starts from rest in the direction that is later, and in the other.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct DirectionDelay {
    /// The later direction: 1 or -1.
    pub direction: i8,
    /// Mean delay there, and in the other direction, s.
    pub mean_delay_s: [f64; 2],
    /// Starts behind these.
    pub starts: [usize; 2],
    /// 95 % interval of their difference, s.
    pub interval_s: [f64; 2],
    /// Two-sided probability of such a difference by chance (Welch).
    pub p_value: f64,
}

impl DirectionDelay {
    /// Whether it is told of one of so many joints: by chance once in twenty runs at most.
    pub fn counts(&self, joints: usize) -> bool {
        let [later_s, other_s] = self.mean_delay_s;
        self.p_value * joints as f64 <= 0.05 && later_s - other_s >= LEAST_S
    }
}

/// Of the delays of one joint's starts from rest, s, each with its direction; `None` with fewer than three of either.
pub(super) fn direction_delay(
    delays: impl Iterator<Item = (i8, f64)>,
    sample_interval_s: f64,
) -> Option<DirectionDelay> {
    let (up, down): (Vec<_>, Vec<_>) = delays.partition(|(direction, _)| *direction > 0);
    let [up, down] =
        [up, down].map(|side| side.into_iter().map(|(_, delay_s)| delay_s).collect::<Vec<f64>>());
    let mean = |delays: &[f64]| delays.iter().sum::<f64>() / delays.len() as f64;
    let direction = if mean(&up) >= mean(&down) { 1 } else { -1 };
    let [later, other] = if direction == 1 { [&up, &down] } else { [&down, &up] };
    let found = difference(other, later, (0.0, 0.0, sample_interval_s))?;
    Some(DirectionDelay {
        direction,
        mean_delay_s: [mean(later), mean(other)],
        starts: [later.len(), other.len()],
        interval_s: found.interval,
        p_value: found.p,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(up_s: &[f64], down_s: &[f64]) -> Option<DirectionDelay> {
        let side =
            |direction: i8, delays: &[f64]| delays.iter().map(move |s| (direction, *s)).collect::<Vec<_>>();
        direction_delay(side(1, up_s).into_iter().chain(side(-1, down_s)), 0.01)
    }

    #[test]
    fn a_direction_that_is_later_is_told_with_how_much() {
        let found = of(&[0.1, 0.11, 0.12, 0.1], &[0.3, 0.31, 0.33]).unwrap();
        assert_eq!((found.direction, found.starts), (-1, [3, 4]));
        let apart_s = found.mean_delay_s[0] - found.mean_delay_s[1];
        assert!((apart_s - 0.2058).abs() < 1e-3 && found.counts(6), "{found:?}");
        assert!(found.interval_s[0] > 0.15 && found.interval_s[1] < 0.25, "{found:?}");
        // 22 ms, however sure, sets no valve; and scatter is none.
        assert!(!of(&[0.1, 0.101, 0.1, 0.101], &[0.122, 0.123, 0.122, 0.123]).unwrap().counts(1));
        assert!(!of(&[0.1, 0.3, 0.2], &[0.3, 0.2, 0.25]).unwrap().counts(1));
        assert_eq!(of(&[0.1, 0.2], &[0.3, 0.4, 0.5]), None);
    }
}
