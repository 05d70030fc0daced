//! The joints of an arm at common instants.

use std::ops::Range;

use super::super::{Rules, cursor::Cursor, path::densest};
use crate::series::Pair;

/// Positions beyond this are of no arm, rad or m: sums and products of lengths would overflow.
const FARTHEST: f64 = 1e6;

/// Positions at common instants, `[n, joints]` row-major.
#[derive(Default)]
pub(super) struct Instants {
    pub(super) joints: usize,
    pub(super) t_s: Vec<f64>,
    planned: Vec<f64>,
    measured: Vec<f64>,
    /// Continuous stretches.
    pub(super) segments: Vec<Range<usize>>,
}

impl Instants {
    /// At the stamps of the joint with most of them, thinned to about [`Rules::tool_rate_hz`], where every joint has data.
    pub(super) fn of(pairs: &[&Pair], rules: &Rules) -> Self {
        let mut found = Self { joints: pairs.len(), ..Self::default() };
        let Some(lead) = densest(pairs) else { return found };
        // Less than the step, so that jitter around it loses no stamps.
        let step_s = 0.75 / rules.tool_rate_hz;
        let mut cursors = vec![Cursor::default(); pairs.len()];
        let (mut last_s, mut last_places, mut start) = (f64::NEG_INFINITY, Vec::new(), 0);
        for t_s in lead.t_s.iter().copied().filter(|t_s| t_s.is_finite()) {
            if t_s - last_s < step_s {
                continue;
            }
            let all: Option<Vec<_>> =
                pairs.iter().zip(&mut cursors).map(|(pair, cursor)| cursor.at(pair, t_s)).collect();
            let sane = |(planned, measured): &(f64, f64)| planned.abs().max(measured.abs()) < FARTHEST;
            let Some(all) = all.filter(|all| all.iter().all(sane)) else { continue };
            let places: Vec<usize> = cursors.iter().map(|cursor| cursor.segment).collect();
            if places != last_places && found.t_s.len() > start {
                found.segments.push(start..found.t_s.len());
                start = found.t_s.len();
            }
            (last_s, last_places) = (t_s, places);
            found.t_s.push(t_s);
            for (planned, measured) in all {
                found.planned.push(planned);
                found.measured.push(measured);
            }
        }
        if found.t_s.len() > start {
            found.segments.push(start..found.t_s.len());
        }
        found
    }

    /// Planned and measured positions of all joints.
    pub(super) fn at(&self, i: usize) -> [&[f64]; 2] {
        let own = i * self.joints..(i + 1) * self.joints;
        [&self.planned[own.clone()], &self.measured[own]]
    }

    /// Their means over some instants.
    pub(super) fn mean(&self, some: Range<usize>) -> [Vec<f64>; 2] {
        let count = some.len().max(1) as f64;
        [&self.planned, &self.measured].map(|all| {
            let sum = |j: usize| some.clone().map(|i| all[i * self.joints + j]).sum::<f64>();
            (0..self.joints).map(|j| sum(j) / count).collect()
        })
    }
}

/// The instants of a segment within a time of one of them, and its neighbours in any case.
pub(super) fn around(t_s: &[f64], segment: &Range<usize>, i: usize, window_s: f64) -> [usize; 2] {
    let low = segment.start + t_s[segment.start..i].partition_point(|t| *t < t_s[i] - window_s);
    let high = i + t_s[i..segment.end].partition_point(|t| *t <= t_s[i] + window_s);
    [low.min(i.saturating_sub(1)).max(segment.start), (high - 1).max(i + 1).min(segment.end - 1)]
}
