//! How much of the error is plain following lag.
//!
//! A joint that follows its plan by a constant lag is off by the planned travel of that lag: what remains of
//! the error against the plan shifted by the lag is not lag. The shift is that of best correlation of the
//! speeds, not the one that lowers the error most: offsets and late starts draw the latter towards
//! themselves, and say nothing to the former, which the whole motion decides.

use statrs::distribution::{ContinuousCDF, StudentsT};

use super::{
    LagShare, Rules,
    motion::Motion,
    tracking::{Sample, sample},
};
use crate::series::Pair;

/// A planned motion up to the next one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    start_s: f64,
    /// Integral of the squared error, rad² s.
    whole: f64,
    /// The same against the shifted plan.
    left: f64,
}

/// One block a motion; all of the error is left where no lag is known.
pub(super) fn blocks(
    pair: &Pair,
    planned_rad_s: &[f64],
    motions: &[Motion],
    lag_s: Option<f64>,
) -> Vec<Block> {
    let mut blocks: Vec<Block> =
        motions.iter().map(|motion| Block { start_s: motion.start_s, whole: 0.0, left: 0.0 }).collect();
    if blocks.is_empty() {
        // The error of a joint whose plan rests is error all the same, and no lag.
        let start_s = pair.t_s.first().copied().unwrap_or_default();
        blocks.push(Block { start_s, whole: 0.0, left: 0.0 });
    }
    let mut place = 0;
    for segment in &pair.segments {
        let mut cursor = segment.start;
        for i in segment.clone() {
            let Sample { t_s, error_rad, weight_s } = sample(pair, segment, i);
            while motions.get(place + 1).is_some_and(|next| next.start_s <= t_s) {
                place += 1;
            }
            let Some(block) = blocks.get_mut(place) else { return blocks };
            let left_rad = lag_s.map_or(error_rad, |lag_s| {
                let at_s = t_s - lag_s;
                while cursor + 1 < segment.end && pair.t_s[cursor + 1] <= at_s {
                    cursor += 1;
                }
                // Beyond the segment's ends the plan is taken to keep its speed.
                let next = cursor + 1;
                let speed_rad_s = if pair.t_s[cursor] <= at_s && next < segment.end {
                    (pair.planned[next] - pair.planned[cursor]) / (pair.t_s[next] - pair.t_s[cursor])
                } else {
                    planned_rad_s[cursor]
                };
                pair.planned[cursor] + speed_rad_s * (at_s - pair.t_s[cursor]) - pair.measured[i]
            });
            block.whole += weight_s * error_rad * error_rad;
            block.left += weight_s * left_rad * left_rad;
        }
    }
    blocks
}

/// Blocks, each of which begins within a moment of the one before it, summed: joints that move together are one event.
pub(super) fn events(mut blocks: Vec<Block>, rules: &Rules) -> Vec<Block> {
    blocks.sort_by(|a, b| a.start_s.total_cmp(&b.start_s));
    let together = blocks.chunk_by(|a, b| b.start_s - a.start_s <= rules.same_event_s);
    let sum = |event: &[Block]| Block {
        start_s: event[0].start_s,
        whole: event.iter().map(|block| block.whole).sum(),
        left: event.iter().map(|block| block.left).sum(),
    };
    together.map(sum).collect()
}

/// The share over blocks; `None` without an error to explain.
///
/// The interval is that of a ratio of sums (Cochran 1977, Sampling Techniques, eq. 6.12), with Student's t; it takes
/// the lag as known.
pub(super) fn lag_share(blocks: &[Block], rules: &Rules) -> Option<LagShare> {
    let sum = |of: fn(&Block) -> f64| blocks.iter().map(of).sum::<f64>();
    let (whole, left) = (sum(|b| b.whole), sum(|b| b.left));
    let ratio = left / whole;
    if whole <= 0.0 || !ratio.is_finite() {
        return None;
    }
    let n = blocks.len() as f64;
    let student = (blocks.len() >= 3).then(|| StudentsT::new(0.0, 1.0, n - 1.0).ok()).flatten();
    let interval = student.map(|student| {
        let squares: f64 = blocks.iter().map(|b| (b.left - ratio * b.whole).powi(2)).sum();
        let half = student.inverse_cdf(0.975) * (squares * n / (n - 1.0)).sqrt() / whole;
        [1.0 - ratio - half, 1.0 - ratio + half].map(|end| end.clamp(0.0, 1.0))
    });
    let share = (1.0 - ratio).clamp(0.0, 1.0);
    Some(LagShare { share, interval, events: blocks.len(), mostly: share >= rules.mostly_lag_share })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(start_s: f64, whole: f64, left: f64) -> Block {
        Block { start_s, whole, left }
    }

    #[test]
    fn the_share_is_of_sums_and_its_interval_that_of_a_ratio() {
        let blocks = [block(0.0, 4.0, 1.0), block(5.0, 2.0, 1.0), block(9.0, 2.0, 0.0)];
        let found = lag_share(&blocks, &Rules::default()).unwrap();
        assert_eq!((found.share, found.events, found.mostly), (0.75, 3, true));
        // Residuals 0, 0.5, -0.5; t of two degrees of freedom 4.302653.
        let half = 4.302_653 * (0.5_f64 * 1.5).sqrt() / 8.0;
        assert!((found.interval.unwrap()[0] - (0.75 - half)).abs() < 1e-6, "{found:?}");
        assert!((found.interval.unwrap()[1] - 1.0).abs() < 1e-12, "cut at all of it");
    }

    #[test]
    fn a_shift_that_makes_it_worse_explains_nothing_and_no_error_has_no_share() {
        let found = lag_share(&[block(0.0, 1.0, 3.0)], &Rules::default()).unwrap();
        assert_eq!((found.share, found.interval, found.mostly), (0.0, None, false));
        assert_eq!(lag_share(&[block(0.0, 0.0, 0.0)], &Rules::default()), None);
        assert_eq!(lag_share(&[], &Rules::default()), None);
    }

    #[test]
    fn joints_that_move_together_are_one_event() {
        let events =
            events(vec![block(9.0, 1.0, 0.5), block(1.0, 2.0, 1.0), block(1.9, 4.0, 1.0)], &Rules::default());
        assert_eq!(events.len(), 2);
        assert_eq!((events[0].whole, events[0].left), (6.0, 2.0));
    }

    #[test]
    fn joints_that_start_one_after_the_other_are_one_event() {
        let starts = (0..6).map(|k| block(0.7 * f64::from(k), 1.0, 0.0)).collect();
        assert_eq!(events(starts, &Rules::default()).len(), 1);
    }
}
