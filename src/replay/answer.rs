//! Why a planned start has no measured instant.

use std::ops::Range;

use super::{Answer, Rules, signals::Signals};
use crate::series::Pair;

/// Where the log ends before the window does, an answer may still have come: this many times as much has to be seen.
const CUT_BY: f64 = 2.0;

/// What became of a planned start that no measured start answers, by what plan and joint travel in its
/// window of samples.
///
/// A share of the planned travel that the measurement could not show proves nothing, nor does a window
/// shorter than the time that every answer is given, or twice as long where the data end with it (`cut`).
pub(super) fn untimed(
    pair: &Pair,
    signals: &Signals,
    direction: i8,
    window: Range<usize>,
    cut: bool,
    rules: &Rules,
) -> Answer {
    let needed_rad = rules.follow_share * rise(&pair.planned[window.clone()], direction);
    if rise(&signals.measured_rad[window.clone()], direction) >= needed_rad.max(signals.min_travel) {
        return Answer::Creeps;
    }
    let lasts_s = pair.t_s[window.end - 1] - pair.t_s[window.start];
    let enough_s = if cut { CUT_BY * rules.match_after_s } else { rules.match_after_s };
    if needed_rad < signals.min_travel || lasts_s < enough_s { Answer::Unclear } else { Answer::Never }
}

/// Largest travel in a direction from any angle to a later one: a joint that comes out of the
/// opposite motion is measured from where it turns.
pub(super) fn rise(angle_rad: &[f64], direction: i8) -> f64 {
    let mut lowest = f64::INFINITY;
    let mut most = 0.0_f64;
    for angle_rad in angle_rad {
        let along = f64::from(direction) * angle_rad;
        lowest = lowest.min(along);
        most = most.max(along - lowest);
    }
    most
}

#[cfg(test)]
mod tests {
    #[test]
    fn travel_counts_from_the_turning_point_and_only_along_the_motion() {
        let rise = |angle_rad: &[f64], direction| format!("{:.3}", super::rise(angle_rad, direction));
        assert_eq!(rise(&[1.0, 0.5, 2.0, 1.5], 1), "1.500");
        assert_eq!(rise(&[1.0, 0.5, 2.0, 1.5], -1), "0.500");
        assert_eq!(rise(&[3.0, 2.0, 1.0], 1), "0.000");
        assert_eq!(rise(&[], 1), "0.000");
    }
}
