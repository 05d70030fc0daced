//! A place in a pair, for analyses that take all joints at common instants.

use crate::series::Pair;

/// A place in one pair that only moves forward.
#[derive(Clone, Default)]
pub(super) struct Cursor {
    sample: usize,
    /// The segment that it is in.
    pub(super) segment: usize,
}

impl Cursor {
    /// Planned and measured position at a time inside a segment, linear between samples.
    pub(super) fn at(&mut self, pair: &Pair, t_s: f64) -> Option<(f64, f64)> {
        let t = &pair.t_s;
        while self.sample + 1 < t.len() && t[self.sample + 1] <= t_s {
            self.sample += 1;
        }
        while pair.segments.get(self.segment).is_some_and(|s| s.end <= self.sample) {
            self.segment += 1;
        }
        let segment = pair.segments.get(self.segment)?;
        let i = self.sample;
        if t[i] > t_s || !segment.contains(&i) {
            return None;
        }
        if t[i] >= t_s {
            return Some((pair.planned[i], pair.measured[i]));
        }
        if i + 1 >= segment.end {
            return None;
        }
        let share = (t_s - t[i]) / (t[i + 1] - t[i]);
        let between = |x: &[f64]| x[i] + share * (x[i + 1] - x[i]);
        Some((between(&pair.planned), between(&pair.measured)))
    }
}
