//! Planned and measured speed of one joint, and the motions in each.

use super::{
    Rules, Sizes, Thresholds,
    motion::{Motion, Speed},
    peak_motion::of_fits,
};
use crate::{
    math::median,
    series::{LocalFit, Noise, Pair, Track, local_quadratic, noise},
};

/// Fewest samples in the velocity fit to a plan that gives no speeds.
const PLAN_POINTS: usize = 5;

/// What the detector derives from a pair; arrays are `[n]`.
pub(super) struct Signals {
    pub(super) noise: Noise,
    pub(super) sample_interval_s: f64,
    pub(super) thresholds: Thresholds,
    pub(super) planned_rad_s: Vec<f64>,
    /// Measured angle, smoothed, rad.
    pub(super) measured_rad: Vec<f64>,
    pub(super) measured_rad_s: Vec<f64>,
    /// Least travel of a measured motion.
    pub(super) min_travel: f64,
    /// Thresholds of a joint of this kind.
    pub(super) sizes: Sizes,
    pub(super) deviation_rad_s: Vec<f64>,
    /// Largest measured speed and acceleration.
    pub(super) peaks: [Option<f64>; 2],
    pub(super) planned: Vec<Motion>,
    pub(super) measured: Vec<Motion>,
}

impl Signals {
    pub(super) fn new(pair: &Pair, rules: &Rules) -> Self {
        let (t_s, segments) = (&pair.t_s, &pair.segments);
        let sizes = *rules.sizes(pair.kind);
        let noise = noise(t_s, &pair.measured, segments);
        let sample_interval_s = sample_interval_s(pair);
        let window_s = rules.window_s(pair.kind, sample_interval_s, noise.sigma);

        let fits = local_quadratic(t_s, &pair.measured, segments, window_s, rules.window_points);
        let of = |value: fn(&LocalFit) -> f64| fits.iter().map(value).collect::<Vec<f64>>();
        let smooth_rad = of(|fit| fit.position);
        let measured_rad_s = of(|fit| fit.velocity);
        let mut deviation_rad_s = of(|fit| fit.velocity_gain_per_s);
        let peaks = of_fits(pair, &fits, window_s);
        drop(fits);
        for deviation in &mut deviation_rad_s {
            *deviation *= noise.sigma;
        }

        let planned_rad_s = pair.planned_velocity.clone().unwrap_or_else(|| {
            let fits = local_quadratic(t_s, &pair.planned, segments, rules.planned_window_s, PLAN_POINTS);
            fits.iter().map(|fit| fit.velocity).collect()
        });

        let min_travel = sizes
            .min_travel
            .max(rules.min_travel_sigmas * noise.sigma)
            .max(rules.min_travel_lsbs * noise.lsb.unwrap_or(0.0));
        let planned = Speed {
            t_s,
            position_rad: &pair.planned,
            velocity_rad_s: &planned_rad_s,
            deviation_rad_s: None,
            segments,
            min_travel: sizes.min_travel,
            sizes,
        };
        let measured = Speed {
            position_rad: &smooth_rad,
            velocity_rad_s: &measured_rad_s,
            deviation_rad_s: Some(&deviation_rad_s),
            min_travel,
            ..planned
        };
        let usual = median(deviation_rad_s.clone());
        let thresholds = Thresholds {
            planned_start: sizes.start_speed,
            planned_stop: sizes.stop_speed,
            measured_start: sizes.start_speed.max(rules.start_sigmas * usual),
            measured_stop: sizes.stop_speed.max(rules.stop_sigmas * usual),
            window_s,
        };
        let (planned, measured) = (planned.motions(rules), measured.motions(rules));
        Self {
            noise,
            sample_interval_s,
            thresholds,
            planned_rad_s,
            measured_rad: smooth_rad,
            measured_rad_s,
            min_travel,
            sizes,
            deviation_rad_s,
            peaks,
            planned,
            measured,
        }
    }
}

/// When a plan leaves rest, by its own samples, s.
pub fn planned_starts(planned: &Track, rules: &Rules) -> Vec<f64> {
    let (t_s, segments) = (planned.t_s(), planned.segments());
    let sizes = *rules.sizes(planned.kind());
    let sloped = |angle_rad: &[f64]| -> Vec<f64> {
        let fits = local_quadratic(t_s, angle_rad, segments, rules.planned_window_s, PLAN_POINTS);
        fits.iter().map(|fit| fit.velocity).collect()
    };
    let velocity_rad_s = planned.velocity().map_or_else(|| sloped(planned.position()), <[f64]>::to_vec);
    let speed = Speed {
        t_s,
        position_rad: planned.position(),
        velocity_rad_s: &velocity_rad_s,
        deviation_rad_s: None,
        segments,
        min_travel: sizes.min_travel,
        sizes,
    };
    speed.motions(rules).iter().filter(|m| m.starts()).map(|m| m.start_s).collect()
}

/// Median time between neighbours inside segments, s; 0 where there are none.
fn sample_interval_s(pair: &Pair) -> f64 {
    let steps = pair.segments.iter().flat_map(|s| pair.t_s[s.clone()].windows(2).map(|w| w[1] - w[0]));
    let steps: Vec<f64> = steps.collect();
    if steps.is_empty() { 0.0 } else { median(steps) }
}
