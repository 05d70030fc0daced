//! Planned and measured speed of one joint, and the motions in each.

use std::{borrow::Cow, ops::Range};

use super::{
    Rules, Sizes, Thresholds,
    motion::{Motion, Speed},
    peak_motion::Peaks,
    unrounded::unrounded,
};
use crate::{
    math::{median, usual_step},
    series::{Noise, Pair, Track, each_local_quadratic, is_sensed, noise, over_window, white},
};

/// Fewest samples in the velocity fit to a plan that gives no speeds.
const PLAN_POINTS: usize = 5;

/// A plan has samples of its own where these are no farther apart, in sample intervals of the measurement.
const AS_DENSE: f64 = 1.5;

/// Noise of which a fit sees so many of its standard errors more than white noise would leave is alike from sample to sample; looked for
/// so often.
const ALIKE: f64 = 4.0;
const ROUNDS: usize = 2;

/// More deviations than this make their median no better; longer signals are thinned evenly.
const ENOUGH: usize = 200_000;

/// What the detector derives from a pair; arrays are `[n]`.
pub(super) struct Signals<'a> {
    pub(super) noise: Noise,
    pub(super) sample_interval_s: f64,
    /// Step of a plan that is rounded so much that its starts are blurred.
    pub(super) planned_step: Option<f64>,
    /// Half window of the fit to a plan that is measured itself, with so much noise that its starts are blurred, s.
    pub(super) noisy_plan_s: Option<f64>,
    pub(super) thresholds: Thresholds,
    pub(super) planned_rad_s: Cow<'a, [f64]>,
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
    /// Planned motions that may have left rest where a stretch after a gap begins, and whose starts are not seen.
    pub(super) edge_starts: usize,
}

impl<'a> Signals<'a> {
    pub(super) fn new(pair: &'a Pair, rules: &Rules) -> Self {
        let (t_s, segments) = (&pair.t_s, &pair.segments);
        let sizes = *rules.sizes(pair.kind);
        let noise = noise(t_s, &pair.measured, segments);
        let sample_interval_s = sample_interval_s(pair);
        let (window_s, sigma) = window(pair, sample_interval_s, &noise, rules);

        let column = || vec![0.0; t_s.len()];
        let (mut smooth_rad, mut measured_rad_s, mut deviation_rad_s) = (column(), column(), column());
        let (mut peaks, window) = (Peaks::default(), (window_s, rules.window_points));
        each_local_quadratic(t_s, &pair.measured, segments, window, |segment, i, fit| {
            (smooth_rad[i], measured_rad_s[i]) = (fit.position, fit.velocity);
            deviation_rad_s[i] = fit.velocity_gain_per_s * sigma;
            peaks.take(t_s, window_s, (segment, i), &fit);
        });
        let given = pair.planned_velocity.as_deref().map(Cow::Borrowed);
        let interval_s = sample_interval_s.max(pair.planned_interval_s);
        // A finer step is passed within a sample even at the slowest start.
        let blurs = |step: &f64| given.is_none() && 0.5 * step > sizes.stop_speed * interval_s;
        let planned_step = pair.planned_step.filter(blurs);
        let noise_of_plan = || plan_noise(pair, (&sizes, sample_interval_s), rules);
        let planned_noise = if given.is_none() && planned_step.is_none() { noise_of_plan() } else { None };
        let planned_sigma = planned_step.map(|step| step / 12.0_f64.sqrt()).or(planned_noise);
        let planned_window_s = planned_sigma
            .map_or(rules.planned_window_s, |sigma| rules.window_s(pair.kind, interval_s, sigma));
        let mut planned_deviation = planned_sigma.map(|_| column());
        let planned_sigma = planned_sigma.unwrap_or(0.0);
        let planned_rad_s = given.unwrap_or_else(|| {
            let mut velocity = column();
            let unrounded = planned_step.map(|step| unrounded(t_s, &pair.planned, segments, step));
            each_local_quadratic(
                t_s,
                unrounded.as_ref().unwrap_or(&pair.planned),
                segments,
                (planned_window_s, PLAN_POINTS),
                |_, i, fit| {
                    velocity[i] = fit.velocity;
                    if let Some(deviation) = &mut planned_deviation {
                        deviation[i] = fit.velocity_gain_per_s * planned_sigma;
                    }
                },
            );
            velocity.into()
        });

        let min_travel = sizes
            .min_travel
            .max(rules.min_travel_sigmas * noise.sigma)
            .max(rules.min_travel_lsbs * noise.lsb.unwrap_or(0.0));
        let planned = Speed {
            t_s,
            position_rad: &pair.planned,
            velocity_rad_s: &planned_rad_s,
            deviation_rad_s: planned_deviation.as_deref(),
            is_plan: true,
            segments,
            min_travel: sizes.min_travel.max(rules.min_travel_lsbs * planned_step.unwrap_or(0.0)),
            sizes,
        };
        let measured = Speed {
            position_rad: &smooth_rad,
            velocity_rad_s: &measured_rad_s,
            deviation_rad_s: Some(&deviation_rad_s),
            is_plan: false,
            min_travel,
            ..planned
        };
        let stride = deviation_rad_s.len() / ENOUGH + 1;
        let usual_of = |deviation: &[f64]| median(deviation.iter().step_by(stride).copied().collect());
        let usual = usual_of(&deviation_rad_s);
        let planned_usual = planned_deviation.as_deref().map_or(0.0, usual_of);
        let thresholds = Thresholds {
            planned_start: sizes.start_speed.max(rules.start_sigmas * planned_usual),
            planned_stop: sizes.stop_speed.max(rules.stop_sigmas * planned_usual),
            measured_start: sizes.start_speed.max(rules.start_sigmas * usual),
            measured_stop: sizes.stop_speed.max(rules.stop_sigmas * usual),
            window_s,
        };
        let (mut planned, measured) = (planned.motions(rules), measured.motions(rules));
        let edge_starts = begin_at_rest(
            &mut planned,
            &measured,
            |at| (pair.planned[at] - smooth_rad[at]).abs() < sizes.displacement,
            |motion| leaves(pair, motion, &planned_rad_s, thresholds.planned_start),
        );
        Self {
            noise,
            sample_interval_s,
            planned_step,
            noisy_plan_s: planned_noise.map(|_| planned_window_s),
            thresholds,
            planned_rad_s,
            measured_rad: smooth_rad,
            measured_rad_s,
            min_travel,
            sizes,
            deviation_rad_s,
            peaks: peaks.0,
            planned,
            measured,
            edge_starts,
        }
    }
}

/// Half window of the fit to the measured speed, s, and the noise that the fit sees: what it was widened for may look larger yet.
fn window(pair: &Pair, sample_interval_s: f64, noise: &Noise, rules: &Rules) -> (f64, f64) {
    let window_s = |sigma: f64| rules.window_s(pair.kind, sample_interval_s, sigma);
    let mut sigma = noise.sigma;
    for _ in 0..ROUNDS {
        let window = (2.0 * window_s(sigma), sample_interval_s);
        let seen = over_window(&pair.t_s, &pair.measured, &pair.segments, window);
        // Less than makes a start is no matter: of a joint without noise it is a part of its motion.
        let half_s = window_s(sigma);
        let starts = |seen: f64| {
            let speed = seen * (1.5 * sample_interval_s / half_s.powi(3)).sqrt();
            rules.start_sigmas * speed > rules.sizes(pair.kind).start_speed
        };
        let alike = |(seen, error): &(f64, f64)| {
            noise.lsb.is_none() && *seen > (1.0 + ALIKE * error) * sigma && starts(*seen)
        };
        let Some((seen, _)) = seen.filter(alike) else { break };
        sigma = seen;
    }
    (window_s(sigma), sigma)
}

/// Noise of a plan that gives no speeds, such as a set value that was measured itself, if it makes starts of its own;
/// between samples of a coarser plan there is none.
fn plan_noise(pair: &Pair, (sizes, sample_interval_s): (&Sizes, f64), rules: &Rules) -> Option<f64> {
    let dense = pair.planned_interval_s <= AS_DENSE * sample_interval_s;
    if !dense || !is_sensed(&pair.planned, &pair.segments) {
        return None;
    }
    let sigma = white(&pair.t_s, &pair.planned, &pair.segments);
    let half_s = rules.planned_window_s.max(0.5 * (PLAN_POINTS - 1) as f64 * sample_interval_s);
    let speed = sigma * (1.5 * sample_interval_s / half_s.powi(3)).sqrt();
    (rules.start_sigmas * speed > sizes.start_speed).then_some(sigma)
}

/// A plan is as good as at rest at this share of the speed that it reaches.
const AT_REST: f64 = 0.05;

/// Whether a plan that moves when its segment opens begins there next to rest, by its first two samples: one that is sent during
/// motions alone does.
fn leaves(pair: &Pair, motion: &Motion, planned_rad_s: &[f64], start_speed: f64) -> bool {
    let first = motion.segment.start;
    let speed = match &pair.planned_velocity {
        Some(given) => given[first],
        None if first + 1 < motion.segment.end => {
            (pair.planned[first + 1] - pair.planned[first]) / (pair.t_s[first + 1] - pair.t_s[first])
        }
        None => return false,
    };
    let most = motion.samples.clone().map(|at| planned_rad_s[at].abs()).fold(0.0, f64::max);
    speed.abs() <= start_speed.max(AT_REST * most)
}

/// A log, or a stretch of it after a gap, may begin where its plan does: a plan that moves when a segment opens has just left rest if
/// the joint stands and is still on it, or the plan is about to move. Returns how many after a gap may have done so and are not seen.
fn begin_at_rest(
    planned: &mut [Motion],
    measured: &[Motion],
    on_plan: impl Fn(usize) -> bool,
    leaves: impl Fn(&Motion) -> bool,
) -> usize {
    let mut hidden = 0;
    for motion in planned.iter_mut().filter(|motion| motion.opens) {
        let stands = !measured.iter().any(|seen| seen.opens && seen.segment == motion.segment);
        let leaves = leaves(motion);
        motion.opens = !(stands && (leaves || on_plan(motion.segment.start)));
        hidden += usize::from(motion.opens && motion.segment.start > 0 && (stands || leaves));
    }
    hidden
}

/// When a plan leaves rest, by its own samples, s.
pub fn planned_starts(planned: &Track, rules: &Rules) -> Vec<f64> {
    planned_motions(planned, rules).iter().filter(|m| m.starts()).map(|m| m.start_s).collect()
}

/// The first motion of a plan that is one step from sample to sample: when, s, and how far. One that moves no joint, such as the last
/// digit of a plan that was measured, is none.
pub fn planned_step(planned: &Track, rules: &Rules) -> Option<(f64, f64)> {
    let (t_s, position) = (planned.t_s(), planned.position());
    let least = rules.sizes(planned.kind()).moves_travel;
    planned_motions(planned, rules).iter().find_map(|motion| {
        let at = motion.step(position)?;
        let sudden = t_s[at] - t_s[at - 1] <= rules.min_motion_s;
        let distance = (position[at] - position[at - 1]).abs();
        (sudden && distance >= least).then_some((t_s[at], distance))
    })
}

fn planned_motions(planned: &Track, rules: &Rules) -> Vec<Motion> {
    let (t_s, segments) = (planned.t_s(), planned.segments());
    let sizes = *rules.sizes(planned.kind());
    let given = planned.velocity().map(Cow::Borrowed);
    let velocity_rad_s = given.unwrap_or_else(|| slopes(t_s, planned.position(), segments, rules).into());
    let speed = Speed {
        t_s,
        position_rad: planned.position(),
        velocity_rad_s: &velocity_rad_s,
        deviation_rad_s: None,
        is_plan: true,
        segments,
        min_travel: sizes.min_travel,
        sizes,
    };
    speed.motions(rules)
}

/// Planned and measured speed at the instants of a pair, fitted within half a window, s, of each: what
/// [`JointReplay::thresholds`](super::JointReplay) says of the joint.
pub fn speeds(pair: &Pair, window_s: f64, rules: &Rules) -> [Vec<f64>; 2] {
    let mut measured = vec![0.0; pair.t_s.len()];
    let window = (window_s, rules.window_points);
    each_local_quadratic(&pair.t_s, &pair.measured, &pair.segments, window, |_, i, fit| {
        measured[i] = fit.velocity;
    });
    [slopes(&pair.t_s, &pair.planned, &pair.segments, rules), measured]
}

/// Speeds of a plan that gives none.
fn slopes(t_s: &[f64], angle_rad: &[f64], segments: &[Range<usize>], rules: &Rules) -> Vec<f64> {
    let mut velocity_rad_s = vec![0.0; t_s.len()];
    let window = (rules.planned_window_s, PLAN_POINTS);
    each_local_quadratic(t_s, angle_rad, segments, window, |_, i, fit| velocity_rad_s[i] = fit.velocity);
    velocity_rad_s
}

/// Usual time between neighbours inside segments, s; 0 where there are none.
fn sample_interval_s(pair: &Pair) -> f64 {
    let steps = pair.segments.iter().flat_map(|s| pair.t_s[s.clone()].windows(2).map(|w| w[1] - w[0]));
    usual_step(&steps.collect::<Vec<_>>())
}
