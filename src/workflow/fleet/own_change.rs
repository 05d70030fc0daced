//! Whether a change that is found beside what the other machines did is there in the joint's own numbers. Where most of a fleet became
//! better, one that did not is no worse than it was, and one that became better by less did not grow.

use crate::math::{mean, theil_sen};

/// The least share of a change that the joint's own numbers show.
const SHOWN: f64 = 0.25;
/// Runs on either side of a step that tell it.
const BESIDE: usize = 10;
/// Runs that tell a slope, at least.
const FEWEST: usize = 3;

/// Own levels of a joint, days since 1970 and level, before anything is taken off; none where nothing is.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct OwnLevels(pub(super) Vec<(f64, f64)>);

impl OwnLevels {
    /// Whether a jump between two runs is theirs.
    pub(super) fn step(&self, change: f64, [last, first]: [f64; 2]) -> bool {
        let before: Vec<f64> = self.values(|at| at <= last).into_iter().rev().take(BESIDE).collect();
        let after: Vec<f64> = self.values(|at| at >= first).into_iter().take(BESIDE).collect();
        before.is_empty() || after.is_empty() || shows(mean(&after) - mean(&before), change)
    }

    /// Whether a slope over these days is theirs.
    pub(super) fn slope(&self, per_day: f64, [from, to]: [f64; 2]) -> bool {
        let inside: Vec<(f64, f64)> =
            self.0.iter().filter(|(at, _)| (from..=to).contains(at)).copied().collect();
        inside.len() < FEWEST || shows(theil_sen(&inside), per_day)
    }

    fn values(&self, within: impl Fn(f64) -> bool) -> Vec<f64> {
        self.0.iter().filter(|(at, _)| within(*at)).map(|(_, level)| *level).collect()
    }
}

fn shows(own: f64, found: f64) -> bool {
    own * found >= SHOWN * found * found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_there_where_own_levels_go_that_way() {
        let own = OwnLevels((0..20).map(f64::from).map(|t| (t, if t < 10.0 { 1.0 } else { 0.6 })).collect());
        assert!(own.step(-0.3, [9.0, 10.0]) && !own.step(0.2, [9.0, 10.0]) && own.step(-1.0, [9.0, 10.0]));
        assert!(!own.step(-2.0, [9.0, 10.0]), "it is hardly of its own");
        assert!(
            own.slope(-0.04, [5.0, 15.0]) && !own.slope(0.04, [5.0, 15.0]) && !own.slope(0.04, [0.0, 9.0])
        );
        assert!(OwnLevels::default().step(1.0, [1.0, 2.0]) && OwnLevels::default().slope(1.0, [1.0, 2.0]));
    }
}
