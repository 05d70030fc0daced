//! When a motion began: before any speed threshold can tell.
//!
//! A curve that rests until t0 and then rises is fitted to the angle for every t0; the best
//! fit is the onset and the fits almost as good are its interval.

use std::ops::Range;

use super::Rules;

/// An onset with its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Onset {
    pub(super) at_s: f64,
    /// 95 %, without the time resolution, s.
    pub(super) interval_s: [f64; 2],
}

/// Of chi-squared with one degree of freedom, 95 %.
const CHI_SQUARED_95: f64 = 3.841_458_820_694_124;

/// More samples than this are averaged in blocks: blocks of 5 ms lose nothing at this resolution.
const MOST_POINTS: usize = 200;

/// How a joint leaves rest, as travel over time since the onset.
#[derive(Clone, Copy)]
pub(super) enum Rise {
    /// Constant acceleration for this long, perhaps no time at all, then constant speed, s.
    Ramp(f64),
    /// Constant acceleration.
    Quadratic,
}

/// Joints have mass; plans need not respect it.
pub(super) const MEASURED_RISES: &[Rise] =
    &[Rise::Ramp(0.03), Rise::Ramp(0.08), Rise::Ramp(0.16), Rise::Quadratic];
/// As for a joint, or straight to speed.
pub(super) const PLANNED_RISES: &[Rise] =
    &[Rise::Ramp(0.0), Rise::Ramp(0.03), Rise::Ramp(0.08), Rise::Ramp(0.16), Rise::Quadratic];

impl Rise {
    fn travel(self, since_s: f64) -> f64 {
        match self {
            Rise::Ramp(ramp_s) if since_s >= ramp_s => since_s - 0.5 * ramp_s,
            Rise::Ramp(ramp_s) => 0.5 * since_s * since_s / ramp_s,
            Rise::Quadratic => since_s * since_s,
        }
    }
}

/// Refines the start of a motion in direction `direction` whose speed crossed a threshold at
/// `crossing_s` after `rest_s` at rest.
///
/// `window_s` is the half width of the smoothing that found the crossing. `None` with fewer
/// than six samples to fit.
pub(super) fn onset(
    t_s: &[f64],
    position_rad: &[f64],
    segment: &Range<usize>,
    direction: i8,
    (crossing_s, rest_s, window_s): (f64, f64, f64),
    rises: &[Rise],
    rules: &Rules,
) -> Option<Onset> {
    let before_s = (rules.onset_rest_share * rest_s).min(rules.onset_before_s);
    let times = &t_s[segment.clone()];
    let first = times.partition_point(|&t| t < crossing_s - before_s);
    let end = times.partition_point(|&t| t <= crossing_s + window_s + rules.onset_after_s);
    if end < first + 6 {
        return None;
    }
    let block = (end - first).div_ceil(MOST_POINTS);
    let mean_of = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let t: Vec<f64> = times[first..end].chunks(block).map(|t| mean_of(t) - crossing_s).collect();
    let x: Vec<f64> =
        position_rad[segment.start + first..segment.start + end].chunks(block).map(mean_of).collect();
    let mean = mean_of(&x);
    let x: Vec<f64> = x.iter().map(|x| f64::from(direction) * (x - mean)).collect();

    // The crossing of a smoothed speed may lie closer to the segment's start than the rest does.
    let before_s = before_s.min(crossing_s - times[first]);
    let on_s = window_s.min(times[end - 1] - crossing_s);
    let steps = |span_s: f64| (span_s / rules.onset_step_s).floor().clamp(0.0, 10_000.0);
    let (back, on) = (steps(before_s), steps(on_s));
    #[expect(clippy::cast_possible_truncation, reason = "clamped above")]
    let grid: Vec<f64> = (-(back as i64)..=on as i64).map(|k| k as f64 * rules.onset_step_s).collect();
    let total: f64 = x.iter().map(|x| x * x).sum();
    if !total.is_finite() {
        return None;
    }
    let fits: Vec<Fit> = grid
        .iter()
        .filter_map(|&t0| {
            let fits = rises.iter().map(|&rise| Fit::new(&t, &x, total, t0, rise));
            fits.min_by(|a, b| a.squares.total_cmp(&b.squares))
        })
        .collect();
    let misfit: Vec<f64> = fits.iter().map(|fit| fit.squares).collect();
    let best = (0..misfit.len()).min_by(|&a, &b| misfit[a].total_cmp(&misfit[b]))?;
    let freedom = (t.len() as f64 - 4.0).max(1.0) / fits[best].redundancy(&t, &x);
    let limit = misfit[best] * (1.0 + CHI_SQUARED_95 / freedom.max(1.0));
    let inside = |k: &usize| misfit[*k] <= limit;
    let low = (0..misfit.len()).find(inside).unwrap_or(best);
    let high = (0..misfit.len()).rev().find(inside).unwrap_or(best);
    Some(Onset {
        at_s: crossing_s + grid[best] + vertex(&misfit, best) * rules.onset_step_s,
        interval_s: [crossing_s + grid[low], crossing_s + grid[high]],
    })
}

/// The best rest level and scale of a rise that begins at `t0`.
#[derive(Clone, Copy)]
struct Fit {
    t0: f64,
    rise: Rise,
    level: f64,
    slope: f64,
    /// Sum of squared residuals.
    squares: f64,
}

impl Fit {
    /// Fits values of zero mean, whose squares sum to `total`.
    fn new(t: &[f64], x: &[f64], total: f64, t0: f64, rise: Rise) -> Self {
        let n = t.len() as f64;
        let from = t.partition_point(|&t| t <= t0);
        let (mut f1, mut f2, mut fx) = (0.0, 0.0, 0.0);
        for (t, x) in t[from..].iter().zip(&x[from..]) {
            let f = rise.travel(t - t0);
            f1 += f;
            f2 += f * f;
            fx += f * x;
        }
        let spread = f2 - f1 * f1 / n;
        // The values have zero mean, so the covariance needs no correction.
        let slope = if spread > 0.0 { (fx / spread).max(0.0) } else { 0.0 };
        // What the rise explains is gone from the sum of squares.
        Self { t0, rise, level: -slope * f1 / n, slope, squares: (total - slope * fx).max(0.0) }
    }

    fn residual(&self, t: f64, x: f64) -> f64 {
        let risen = if t > self.t0 { self.slope * self.rise.travel(t - self.t0) } else { 0.0 };
        x - self.level - risen
    }

    /// How many samples carry the information of one, at least 1, from the correlation of
    /// neighbouring residuals: rounding and a wrong shape repeat themselves.
    fn redundancy(&self, t: &[f64], x: &[f64]) -> f64 {
        let r: Vec<f64> = t.iter().zip(x).map(|(&t, &x)| self.residual(t, x)).collect();
        let neighbours: f64 = r.windows(2).map(|w| w[0] * w[1]).sum();
        let correlation = if self.squares > 0.0 { (neighbours / self.squares).clamp(0.0, 0.95) } else { 0.0 };
        (1.0 + correlation) / (1.0 - correlation)
    }
}

/// Where the parabola through a minimum and its neighbours has its vertex, in steps.
fn vertex(y: &[f64], k: usize) -> f64 {
    if k == 0 || k + 1 >= y.len() {
        return 0.0;
    }
    let bend = y[k - 1] - 2.0 * y[k] + y[k + 1];
    if bend > 0.0 { (0.5 * (y[k - 1] - y[k + 1]) / bend).clamp(-0.5, 0.5) } else { 0.0 }
}
