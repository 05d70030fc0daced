//! Largest measured speed and acceleration.

use std::ops::Range;

use super::Rules;
use crate::series::{LocalFit, Pair, each_local_quadratic};

/// Largest measured speed and acceleration of a joint, smoothed over a half window; `None` where no window is whole.
pub fn peak_motion(pair: &Pair, window_s: f64, rules: &Rules) -> [Option<f64>; 2] {
    let mut peaks = Peaks::default();
    let window = (window_s, rules.window_points);
    each_local_quadratic(&pair.t_s, &pair.measured, &pair.segments, window, |segment, i, fit| {
        peaks.take(&pair.t_s, window_s, (segment, i), &fit);
    });
    peaks.0
}

/// The largest so far of fits at every sample.
#[derive(Default)]
pub(super) struct Peaks(pub(super) [Option<f64>; 2]);

impl Peaks {
    /// Takes in the fit at sample `i` of a segment. At the ends of a segment a window is cut, and its fit is mostly
    /// noise.
    pub(super) fn take(&mut self, t_s: &[f64], window_s: f64, at: (&Range<usize>, usize), fit: &LocalFit) {
        let (segment, i) = at;
        if t_s[i] - t_s[segment.start] >= window_s && t_s[segment.end - 1] - t_s[i] >= window_s {
            let larger = |a: Option<f64>, b: f64| Some(a.map_or(b.abs(), |a| a.max(b.abs())));
            self.0 = [larger(self.0[0], fit.velocity), larger(self.0[1], fit.acceleration)];
        }
    }
}
