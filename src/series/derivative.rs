//! Velocity of a sampled position: a local quadratic in actual time.
//!
//! Jitter and lost samples shift no estimate, because the fit uses each sample's own stamp
//! (Cleveland and Devlin 1988, doi:10.1080/01621459.1988.10478639, with uniform weights).

use std::ops::Range;

use nalgebra::{Matrix3, Vector3};

/// A local quadratic at the sample that it was fitted around, in the unit of the samples.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LocalFit {
    /// Smoothed value.
    pub position: f64,
    /// Slope, per second.
    pub velocity: f64,
    /// Second derivative, per second squared.
    pub acceleration: f64,
    /// Standard deviation of the slope per standard deviation of the samples, 1/s.
    pub velocity_gain_per_s: f64,
}

/// Fits a quadratic around every sample, to the samples within `half_width_s` of it and to at
/// least `min_points` where the segment has them.
///
/// Arrays are `[n]`, times strictly increase inside `segments`; no fit reaches across a cut.
/// Samples outside every segment keep the default. A window of two samples gives their slope,
/// one sample gives no motion. O(n): sums slide, and are rebuilt every half window so that
/// rounding cannot pile up.
pub fn local_quadratic(
    t_s: &[f64],
    position: &[f64],
    segments: &[Range<usize>],
    half_width_s: f64,
    min_points: usize,
) -> Vec<LocalFit> {
    let mut fits = vec![LocalFit::default(); t_s.len()];
    each_local_quadratic(t_s, position, segments, (half_width_s, min_points), |_, i, fit| fits[i] = fit);
    fits
}

/// As [`local_quadratic`], one fit after another, for series too long to hold all of them: with its segment and the
/// index of its sample. A window is a half width and the fewest samples.
pub fn each_local_quadratic(
    t_s: &[f64],
    position: &[f64],
    segments: &[Range<usize>],
    (half_width_s, min_points): (f64, usize),
    mut visit: impl FnMut(&Range<usize>, usize, LocalFit),
) {
    for segment in segments {
        let (t, x) = (&t_s[segment.clone()], &position[segment.clone()]);
        let mut window = 0..0;
        let mut sums = Sums::default();
        for i in 0..t.len() {
            let next = widen(t, i, slide(t, i, &window, half_width_s), min_points.max(3));
            if (t[i] - sums.t_ref_s).abs() > 0.5 * sums.scale_s || next.start >= window.end || i == 0 {
                sums = Sums::around(t, x, i, &next);
            } else {
                sums.slide(t, x, &window, &next);
            }
            window = next;
            visit(segment, segment.start + i, sums.fit(t[i], window.len()));
        }
    }
}

/// The samples within the half width of sample `i`; windows only move forward.
fn slide(t: &[f64], i: usize, last: &Range<usize>, half_width_s: f64) -> Range<usize> {
    // The last window may have been widened, so its ends are only a hint.
    let mut start = last.start.min(i);
    while start > 0 && t[i] - t[start - 1] <= half_width_s {
        start -= 1;
    }
    while t[i] - t[start] > half_width_s {
        start += 1;
    }
    let mut end = last.end.max(i + 1);
    while end > i + 1 && t[end - 1] - t[i] > half_width_s {
        end -= 1;
    }
    while end < t.len() && t[end] - t[i] <= half_width_s {
        end += 1;
    }
    start..end
}

/// Takes in the nearest samples outside until there are enough.
fn widen(t: &[f64], i: usize, mut window: Range<usize>, min_points: usize) -> Range<usize> {
    while window.len() < min_points.min(t.len()) {
        let left = (window.start > 0).then(|| t[i] - t[window.start - 1]);
        let right = (window.end < t.len()).then(|| t[window.end] - t[i]);
        match (left, right) {
            (Some(l), Some(r)) if l <= r => window.start -= 1,
            (_, Some(_)) => window.end += 1,
            _ => window.start -= 1,
        }
    }
    window
}

/// Sums of powers of time since a reference over a scale, alone and with the angle.
#[derive(Default)]
struct Sums {
    t_ref_s: f64,
    scale_s: f64,
    x_ref: f64,
    u: [f64; 5],
    x: [f64; 3],
}

impl Sums {
    fn around(t: &[f64], x: &[f64], i: usize, window: &Range<usize>) -> Self {
        let reach_s = (t[i] - t[window.start]).max(t[window.end - 1] - t[i]);
        let scale_s = if reach_s > 0.0 { reach_s } else { 1.0 };
        let mut sums = Self { t_ref_s: t[i], scale_s, x_ref: x[i], ..Self::default() };
        for k in window.clone() {
            sums.add(t[k], x[k], 1.0);
        }
        sums
    }

    fn slide(&mut self, t: &[f64], x: &[f64], from: &Range<usize>, to: &Range<usize>) {
        for (gone, sign) in [(from.start..to.start, -1.0), (to.start..from.start, 1.0)] {
            gone.for_each(|k| self.add(t[k], x[k], sign));
        }
        for (come, sign) in [(from.end..to.end, 1.0), (to.end..from.end, -1.0)] {
            come.for_each(|k| self.add(t[k], x[k], sign));
        }
    }

    fn add(&mut self, t_s: f64, x: f64, sign: f64) {
        let u = (t_s - self.t_ref_s) / self.scale_s;
        let x = sign * (x - self.x_ref);
        let u2 = u * u;
        for (sum, power) in self.u.iter_mut().zip([1.0, u, u2, u2 * u, u2 * u2]) {
            *sum += sign * power;
        }
        for (sum, power) in self.x.iter_mut().zip([1.0, u, u2]) {
            *sum += x * power;
        }
    }

    fn fit(&self, t_s: f64, points: usize) -> LocalFit {
        let ([s0, s1, s2, s3, s4], [x0, x1, x2]) = (self.u, self.x);
        let u = (t_s - self.t_ref_s) / self.scale_s;
        let quadratic = (points > 2).then(|| Matrix3::new(s0, s1, s2, s1, s2, s3, s2, s3, s4).cholesky());
        let Some(quadratic) = quadratic.flatten() else {
            return self.line(u, points);
        };
        let c = quadratic.solve(&Vector3::new(x0, x1, x2));
        let slope_at = Vector3::new(0.0, 1.0, 2.0 * u);
        let variance = slope_at.dot(&quadratic.solve(&slope_at));
        LocalFit {
            position: self.x_ref + c[0] + u * (c[1] + u * c[2]),
            velocity: slope_at.dot(&c) / self.scale_s,
            acceleration: 2.0 * c[2] / (self.scale_s * self.scale_s),
            velocity_gain_per_s: variance.max(0.0).sqrt() / self.scale_s,
        }
    }

    fn line(&self, u: f64, points: usize) -> LocalFit {
        let ([s0, s1, s2, ..], [x0, x1, _]) = (self.u, self.x);
        let spread = s2 - s1 * s1 / s0;
        if points < 2 || spread <= 0.0 {
            return LocalFit { position: self.x_ref, ..LocalFit::default() };
        }
        let slope = (x1 - s1 * x0 / s0) / spread;
        LocalFit {
            position: self.x_ref + x0 / s0 + slope * (u - s1 / s0),
            velocity: slope / self.scale_s,
            acceleration: 0.0,
            velocity_gain_per_s: (1.0 / spread).sqrt() / self.scale_s,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stamps with a repeating jitter and every ninth sample lost.
    fn uneven(n: u32) -> Vec<f64> {
        (0..n).filter(|k| k % 9 != 4).map(|k| 0.01 * f64::from(k) + 0.002 * f64::from(k * 7 % 5)).collect()
    }

    #[test]
    fn a_parabola_on_uneven_stamps_has_its_own_slope_everywhere() {
        let t_s = uneven(4000);
        let x: Vec<f64> = t_s.iter().map(|t| 3.0 - 2.0 * t + 0.7 * t * t).collect();
        let n = t_s.len();
        for (i, fit) in local_quadratic(&t_s, &x, std::slice::from_ref(&(0..n)), 0.1, 7).iter().enumerate() {
            assert!((fit.velocity - (-2.0 + 1.4 * t_s[i])).abs() < 1e-7, "{i} {fit:?}");
            assert!((fit.acceleration - 1.4).abs() < 1e-6, "{i} {fit:?}");
        }
    }

    #[test]
    fn sliding_sums_equal_a_fit_of_each_window_alone() {
        let t_s = uneven(500);
        let x: Vec<f64> = t_s.iter().map(|t| (9.0 * t).sin() + 1e3).collect();
        let n = t_s.len();
        let all = local_quadratic(&t_s, &x, std::slice::from_ref(&(0..n)), 0.06, 7);
        for i in 0..n {
            let window = widen(&t_s, i, slide(&t_s, i, &(0..0), 0.06), 7);
            let alone = Sums::around(&t_s, &x, i, &window).fit(t_s[i], window.len());
            assert!((alone.velocity - all[i].velocity).abs() < 1e-7, "{i}");
            assert!((alone.velocity_gain_per_s / all[i].velocity_gain_per_s - 1.0).abs() < 1e-7, "{i}");
        }
    }

    #[test]
    fn the_gain_of_an_even_window_is_the_textbook_one() {
        // Slope of a symmetric window of 2m + 1 samples: 1 / (dt sqrt(2 (1 + 4 + ... + m^2))).
        let t_s: Vec<f64> = (0..21).map(|k| f64::from(k) * 0.5).collect();
        let fit = local_quadratic(&t_s, &[0.0; 21], std::slice::from_ref(&(0..21)), 2.6, 7)[10];
        assert!((fit.velocity_gain_per_s - 1.0 / (0.5 * 110.0_f64.sqrt())).abs() < 1e-12);
    }

    #[test]
    fn a_step_at_a_cut_is_no_motion_and_short_segments_are_served() {
        let t_s: Vec<f64> = (0..12).map(f64::from).collect();
        let x: Vec<f64> = (0..12).map(|k| if k < 9 { 1.0 } else { 5.0 * f64::from(k) }).collect();
        let fits = local_quadratic(&t_s, &x, &[0..8, 8..9, 9..11, 11..12], 2.0, 7);
        assert!(fits[..9].iter().all(|fit| fit.velocity == 0.0));
        assert!((fits[9].velocity - 5.0).abs() < 1e-12);
        assert_eq!((fits[11].velocity, fits[11].position), (0.0, 55.0));
    }
}
