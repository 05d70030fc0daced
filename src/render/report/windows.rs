//! Windows of starts that plots draw whole.

use std::ops::Range;

use super::tiles::MOST as TILES;
use crate::{
    replay::{Replay, Transition},
    series::Pair,
};

/// Of the worst starts of a joint so many places more in each window, nearly, and in all.
pub(super) const EACH: usize = 400;
const PARTS: usize = 12_000;
/// Shown before a start, s.
const BEFORE_S: f64 = 0.5;

/// Samples of a joint in the windows of starts that are drawn whole: the worst of all joints, which a click shows, then its own.
pub(super) fn windows(pair: &Pair, replay: &Replay) -> Vec<Range<usize>> {
    let worst = replay.worst_first();
    let own = worst.iter().filter(|start| start.joint == pair.name);
    let at = |time_s: f64| pair.t_s.partition_point(|t_s| *t_s < time_s);
    let window = |start: &&Transition| at(start.window_s[0] - BEFORE_S)..at(start.window_s[1]);
    let mut left = PARTS;
    let fits = |part: &Range<usize>| {
        let enough = left > 0;
        left = left.saturating_sub(part.len().min(EACH));
        enough
    };
    worst.iter().take(TILES).chain(own).map(window).take_while(fits).collect()
}
