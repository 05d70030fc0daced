//! Error at equal instants: tracking error, and standstill error apart.

use std::ops::Range;

use super::{Rules, TrackingError, signals::Signals};
use crate::series::Pair;

/// A sample of error: stamp s, planned minus measured rad, time it stands for s.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub(super) t_s: f64,
    pub(super) error_rad: f64,
    pub(super) weight_s: f64,
}

/// The 95 % quantile is taken over at most about this many samples, evenly thinned.
const ENOUGH: usize = 250_000;
/// A lone sample stands for next to no time.
pub(super) const LONE_S: f64 = 1e-9;

/// The error of a joint, computed where it is asked for: a long run has no room for it.
pub(super) fn samples(pair: &Pair) -> impl Iterator<Item = Sample> + Clone {
    pair.segments.iter().flat_map(|segment| segment.clone().map(|i| sample(pair, segment, i)))
}

/// The error at sample `i` of a segment; it stands for half the way to its neighbours there.
pub(super) fn sample(pair: &Pair, segment: &Range<usize>, i: usize) -> Sample {
    let (first, last) = (segment.start, segment.end.saturating_sub(1));
    let span_s = pair.t_s[(i + 1).min(last)] - pair.t_s[i.saturating_sub(1).max(first)];
    let error_rad = pair.planned[i] - pair.measured[i];
    Sample { t_s: pair.t_s[i], error_rad, weight_s: (0.5 * span_s).max(LONE_S) }
}

/// Statistics of samples; `None` of none.
pub(super) fn tracking_error(samples: impl Iterator<Item = Sample> + Clone) -> Option<TrackingError> {
    let (mut count, mut time, mut sum, mut magnitude, mut square) = (0, 0.0, 0.0, 0.0, 0.0);
    let (mut peak, mut peak_time_s) = (-1.0, 0.0);
    for s in samples.clone() {
        count += 1;
        time += s.weight_s;
        sum += s.weight_s * s.error_rad;
        magnitude += s.weight_s * s.error_rad.abs();
        square += s.weight_s * s.error_rad * s.error_rad;
        if s.error_rad.abs() > peak {
            (peak, peak_time_s) = (s.error_rad.abs(), s.t_s);
        }
    }
    let half = samples.clone().find(|s| s.error_rad.abs() >= 0.5 * peak);
    (count > 0).then(|| TrackingError {
        rms: (square / time).sqrt(),
        mean_abs: magnitude / time,
        peak,
        peak_time_s,
        half_peak_time_s: half.map_or(peak_time_s, |s| s.t_s),
        p95: weighted_quantile(samples.step_by(count / ENOUGH + 1), 0.95),
        bias: sum / time,
        samples: count,
        duration_s: time,
    })
}

/// The smallest magnitude that at least the share `p` of the time does not exceed.
fn weighted_quantile(samples: impl Iterator<Item = Sample>, p: f64) -> f64 {
    let mut magnitudes: Vec<(f64, f64)> = samples.map(|s| (s.error_rad.abs(), s.weight_s)).collect();
    magnitudes.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let wanted = p * magnitudes.iter().map(|m| m.1).sum::<f64>();
    let mut time = 0.0;
    for &(magnitude, weight) in &magnitudes {
        time += weight;
        if time >= wanted {
            return magnitude;
        }
    }
    magnitudes.last().map_or(0.0, |m| m.0)
}

/// For every sample, whether the plan has been at rest for long enough, in its segment: in no motion, and not on a way either that is too
/// slow to be one.
pub(super) fn at_standstill(pair: &Pair, signals: &Signals, rules: &Rules) -> Vec<bool> {
    let t_s = &pair.t_s;
    let mut rest = vec![false; t_s.len()];
    let mut motions = signals.planned.iter().peekable();
    for segment in &pair.segments {
        let mut since_s = t_s.get(segment.start).copied().unwrap_or(0.0);
        let mut i = segment.start;
        while i < segment.end {
            match motions.peek() {
                Some(motion) if motion.samples.contains(&i) => {
                    since_s = motion.end_s;
                    i = motion.samples.end;
                    motions.next();
                }
                _ => {
                    if let Some(end) = slow_way(pair, signals, i..segment.end) {
                        since_s = t_s[end - 1];
                        i = end;
                    } else {
                        rest[i] = t_s[i] - since_s > rules.standstill_after_s;
                        i += 1;
                    }
                }
            }
        }
    }
    rest
}

/// Where a way of the plan ends that begins with a range of samples, faster than a rest is and as far as a start needs.
fn slow_way(pair: &Pair, signals: &Signals, range: Range<usize>) -> Option<usize> {
    let first = range.start;
    let moves = |k: &usize| signals.planned_rad_s[*k].abs() > signals.thresholds.planned_stop;
    let end = first + range.take_while(moves).count();
    let travel = (pair.planned.get(end.checked_sub(1)?)? - pair.planned[first]).abs();
    (end > first && travel >= signals.sizes.min_travel).then_some(end)
}
