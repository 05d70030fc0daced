//! Lays a plan onto measured stamps.

use std::{ops::Range, sync::Arc};

use super::{JointKind, Track, rounding::rounding};

/// Planned and measured position of one joint at the same instants, in the joint\'s unit: rad or m.
///
/// All arrays are `[n]`, n >= 1; times strictly increase; `segments` cover `0..n` and are cut
/// wherever either track was, and where samples found no plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// The joint.
    pub name: String,
    /// Whether it turns or slides.
    pub kind: JointKind,
    /// Measured stamps, s since the start of the log; joints of one topic share them.
    pub t_s: Arc<[f64]>,
    /// Plan at these stamps.
    pub planned: Vec<f64>,
    /// Velocity of the plan, per second, where the plan gives one.
    pub planned_velocity: Option<Vec<f64>>,
    /// Measured position.
    pub measured: Vec<f64>,
    /// Continuous stretches.
    pub segments: Vec<Range<usize>>,
    /// Median time between samples of the plan itself, s: its starts are known no better.
    pub planned_interval_s: f64,
    /// Step that the plan is rounded to, where it shows one: its starts are known no better than it travels half of it.
    pub planned_step: Option<f64>,
    /// Measured samples for which there is a plan: n.
    pub matched: usize,
    /// Measured samples without a plan, left out.
    pub unmatched: usize,
}

impl Pair {
    /// First and last instant of each continuous stretch, s.
    pub fn spans_s(&self) -> impl Iterator<Item = [f64; 2]> {
        let ends = |part: &Range<usize>| {
            Some([*self.t_s.get(part.start)?, *self.t_s.get(part.end.checked_sub(1)?)?])
        };
        self.segments.iter().filter_map(ends)
    }
}

impl Pair {
    /// The samples from one instant to another, both included; `None` if there are none.
    pub(crate) fn within(&self, [from_s, to_s]: [f64; 2]) -> Option<Self> {
        let kept = self.t_s.partition_point(|t| *t < from_s)..self.t_s.partition_point(|t| *t <= to_s);
        let t_s = self.t_s.get(kept.clone()).filter(|t_s| !t_s.is_empty())?;
        let part = |values: &[f64]| values.get(kept.clone()).unwrap_or_default().to_vec();
        let inside = |segment: &Range<usize>| {
            let part = segment.start.max(kept.start)..segment.end.min(kept.end);
            (part.start < part.end).then(|| part.start - kept.start..part.end - kept.start)
        };
        Some(Self {
            t_s: t_s.into(),
            planned: part(&self.planned),
            planned_velocity: self.planned_velocity.as_deref().map(part),
            measured: part(&self.measured),
            segments: self.segments.iter().filter_map(inside).collect(),
            matched: t_s.len(),
            ..self.clone()
        })
    }
}

/// Interpolates `planned` onto the stamps of `measured`; `None` if they never overlap in time, or if
/// one turns and the other slides.
pub fn align(planned: &Track, measured: &Track) -> Option<Pair> {
    if planned.kind() != measured.kind() {
        return None;
    }
    let n = measured.len();
    let mut pair = Pair {
        name: measured.name().to_owned(),
        kind: measured.kind(),
        t_s: Arc::default(),
        planned: Vec::with_capacity(n),
        planned_velocity: None,
        measured: Vec::with_capacity(n),
        segments: Vec::new(),
        planned_interval_s: planned.sample_interval_s(),
        planned_step: rounding(planned),
        matched: 0,
        unmatched: 0,
    };
    let mut t_s = Vec::with_capacity(n);
    let gives_velocity = planned.velocity().is_some();
    let mut velocity = Vec::with_capacity(if gives_velocity { n } else { 0 });
    let mut cursor = 0;
    for segment in measured.segments() {
        let mut start = t_s.len();
        let mut plan_segment = None;
        for i in segment.clone() {
            let at_s = measured.t_s()[i];
            let found = planned.at_after(&mut cursor, at_s);
            let inside = found.map(|_| planned.segment_of(cursor));
            if inside != plan_segment && t_s.len() > start {
                pair.segments.push(start..t_s.len());
                start = t_s.len();
            }
            plan_segment = inside;
            match found {
                Some(plan) => {
                    t_s.push(at_s);
                    pair.planned.push(plan.position);
                    if gives_velocity {
                        velocity.push(plan.velocity);
                    }
                    pair.measured.push(measured.position()[i]);
                }
                None => pair.unmatched += 1,
            }
        }
        if t_s.len() > start {
            pair.segments.push(start..t_s.len());
        }
    }
    pair.matched = t_s.len();
    pair.t_s = if pair.unmatched == 0 { measured.signal().shared_t_s() } else { t_s.into() };
    pair.planned_velocity = gives_velocity.then_some(velocity);
    (pair.matched > 0).then_some(pair)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(t_s: Vec<f64>, cuts: &[usize]) -> Track {
        let position = t_s.iter().map(|t| 2.0 * t).collect();
        Track::new("a", t_s, position, cuts).unwrap()
    }

    #[test]
    fn equal_motion_sampled_differently_has_no_error() {
        let planned = track((0..11).map(|k| f64::from(k) * 0.1).collect(), &[]);
        let measured = track((0..30).map(|k| 0.013 + f64::from(k) * 0.03).collect(), &[]);
        let pair = align(&planned, &measured).unwrap();
        assert_eq!((pair.matched, pair.unmatched, pair.segments.len()), (30, 0, 1));
        for (r, y) in pair.planned.iter().zip(&pair.measured) {
            assert!((r - y).abs() < 1e-12);
        }
    }

    #[test]
    fn samples_without_a_plan_are_counted_and_cut_the_run() {
        let planned = track(vec![0.0, 1.0, 3.0, 4.0], &[2]);
        let measured = track((0..=50).map(|k| f64::from(k) * 0.1).collect(), &[]);
        let pair = align(&planned, &measured).unwrap();
        assert_eq!(pair.matched + pair.unmatched, 51);
        assert_eq!(pair.segments, [0..11, 11..22]);
        assert!(pair.t_s[11] > 2.99);
    }

    #[test]
    fn a_part_of_a_pair_has_its_samples_and_stretches() {
        let planned = track(vec![0.0, 1.0, 3.0, 4.0], &[2]);
        let measured = track((0..=40).map(|k| f64::from(k) * 0.1).collect(), &[]);
        let pair = align(&planned, &measured).unwrap();
        let part = pair.within([0.55, 3.55]).unwrap();
        assert_eq!((part.t_s[0], part.t_s.len(), part.matched), (pair.t_s[6], 11, 11));
        assert_eq!(part.segments, [0..5, 5..11]);
        assert_eq!(part.measured, pair.measured[6..17]);
        assert_eq!(pair.within([1.1, 2.9]), None);
    }

    #[test]
    fn a_plan_elsewhere_in_time_is_no_pair() {
        assert_eq!(align(&track(vec![0.0, 1.0], &[]), &track(vec![2.0, 3.0], &[])), None);
    }
}
