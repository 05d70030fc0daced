//! Largest measured speed and acceleration.

use super::Rules;
use crate::series::{LocalFit, Pair, local_quadratic};

/// Largest measured speed and acceleration of a joint, smoothed over a half window; `None` where no window is whole.
pub fn peak_motion(pair: &Pair, window_s: f64, rules: &Rules) -> [Option<f64>; 2] {
    of_fits(
        pair,
        &local_quadratic(&pair.t_s, &pair.measured, &pair.segments, window_s, rules.window_points),
        window_s,
    )
}

/// The same of fits at every sample. At the ends of a segment a window is cut, and its fit is mostly noise.
pub(super) fn of_fits(pair: &Pair, fits: &[LocalFit], window_s: f64) -> [Option<f64>; 2] {
    let whole = pair.segments.iter().flat_map(|segment| {
        let [first_s, last_s] = [pair.t_s[segment.start], pair.t_s[segment.end - 1]];
        segment
            .clone()
            .filter(move |&i| pair.t_s[i] - first_s >= window_s && last_s - pair.t_s[i] >= window_s)
    });
    whole.fold([None, None], |[speed, acceleration], i| {
        let larger = |a: Option<f64>, b: f64| Some(a.map_or(b.abs(), |a| a.max(b.abs())));
        [larger(speed, fits[i].velocity), larger(acceleration, fits[i].acceleration)]
    })
}
