//! A joint whose motions are known exactly, to measure the detector against.
//!
//! Motions of both directions, 0.4 to 12 degrees per second, start sharply (trapezoid) or
//! smoothly (minimum jerk, Flash and Hogan 1985, doi:10.1523/JNEUROSCI.05-07-01688.1985),
//! after a rest or straight out of the opposite motion. The joint follows the plan exactly but
//! late, so every planned and measured onset is known. It knows no dead-band, lag or load.

use hydrotrace::{
    rng::{Stream, stream},
    series::{JointKind, Pair},
    units::DEGREE_RAD,
};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal, StandardUniform};
use serde::{Deserialize, Serialize};

/// How a synthetic joint is sensed and logged.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Sensing {
    /// Standard deviation of white encoder noise, rad.
    pub sigma_rad: f64,
    /// Step of the encoder, rad; `None` for a continuous one.
    pub lsb_rad: Option<f64>,
    /// Rate of the log, Hz.
    pub rate_hz: f64,
    /// How late the joint follows its plan, s.
    pub delay_s: f64,
}

impl Default for Sensing {
    fn default() -> Self {
        Self { sigma_rad: 0.01 * DEGREE_RAD, lsb_rad: None, rate_hz: 100.0, delay_s: 0.12 }
    }
}

/// One planned motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrueMotion {
    /// +1 or -1.
    pub direction: i8,
    /// Whether it starts sharply.
    pub sharp: bool,
    /// Whether it follows the opposite motion without a rest.
    pub reversal: bool,
    /// Whether the opposite motion follows it without a rest.
    pub reversed: bool,
    /// When the plan starts, s; the joint starts [`Sensing::delay_s`] later.
    pub start_s: f64,
    /// When the plan stops, s.
    pub end_s: f64,
    speed_rad_s: f64,
    ramp_s: f64,
}

/// One minute of one joint, and the truth.
#[derive(Debug, Clone, PartialEq)]
pub struct SyntheticRun {
    /// What a log would hold.
    pub pair: Pair,
    /// What happened, in time order.
    pub motions: Vec<TrueMotion>,
}

/// Length of a run, s.
const DURATION_S: f64 = 60.0;
/// Share of motions that follow the opposite one without a rest.
const REVERSALS: f64 = 0.25;
/// Standard deviation of the stamps, s.
const JITTER_S: f64 = 5e-4;
/// Share of samples lost.
const DROPS: f64 = 0.002;

/// Draws one run; equal arguments give equal runs.
pub fn synthetic_run(seed: u64, sensing: &Sensing) -> SyntheticRun {
    let motions = motions(&mut stream(seed, Stream::Motion));
    let t_s = stamps(&mut stream(seed, Stream::Sampling), sensing.rate_hz);
    let mut noise = stream(seed, Stream::SensorNoise);
    let sense = |angle_rad: f64| {
        let white: f64 = StandardNormal.sample(&mut noise);
        let noisy = angle_rad + sensing.sigma_rad * white;
        sensing.lsb_rad.map_or(noisy, |lsb| (noisy / lsb).round() * lsb)
    };
    let n = t_s.len();
    let pair = Pair {
        name: "synthetic".into(),
        kind: JointKind::Turns,
        planned: t_s.iter().map(|&t| state(&motions, t).0).collect(),
        planned_velocity: Some(t_s.iter().map(|&t| state(&motions, t).1).collect()),
        measured: t_s.iter().map(|&t| state(&motions, t - sensing.delay_s).0).map(sense).collect(),
        segments: std::iter::once(0..n).collect(),
        planned_interval_s: 1.0 / sensing.rate_hz,
        planned_step: None,
        matched: n,
        unmatched: 0,
        t_s: t_s.into(),
    };
    SyntheticRun { pair, motions }
}

fn uniform(rng: &mut ChaCha8Rng, low: f64, high: f64) -> f64 {
    let unit: f64 = StandardUniform.sample(rng);
    low + (high - low) * unit
}

fn motions(rng: &mut ChaCha8Rng) -> Vec<TrueMotion> {
    let mut motions: Vec<TrueMotion> = Vec::new();
    let mut now_s = uniform(rng, 1.0, 2.0);
    loop {
        let turn = uniform(rng, 0.0, 1.0) < REVERSALS;
        let rest_s = uniform(rng, 0.4, 2.5);
        let sharp = uniform(rng, 0.0, 1.0) < 0.5;
        let forward = uniform(rng, 0.0, 1.0) < 0.5;
        let speed_rad_s = DEGREE_RAD * (uniform(rng, 0.4_f64.ln(), 12.0_f64.ln())).exp();
        let length_s = uniform(rng, 0.8, 3.0);
        let ramp_s = uniform(rng, 0.02, 0.10);
        let last = motions.last_mut();
        let (direction, start_s) = match last {
            Some(last) if turn => {
                last.reversed = true;
                (-last.direction, now_s)
            }
            _ => (if forward { 1 } else { -1 }, now_s + rest_s),
        };
        let end_s = start_s + length_s;
        if end_s > DURATION_S - 1.0 {
            if let Some(last) = motions.last_mut() {
                last.reversed = false;
            }
            return motions;
        }
        let reversal = motions.last().is_some_and(|last| last.reversed);
        motions.push(TrueMotion {
            direction,
            sharp,
            reversal,
            reversed: false,
            start_s,
            end_s,
            speed_rad_s,
            ramp_s,
        });
        now_s = end_s;
    }
}

/// Angle and speed of the plan, rad and rad/s.
fn state(motions: &[TrueMotion], t_s: f64) -> (f64, f64) {
    let mut angle_rad = 0.0;
    for motion in motions.iter().take_while(|m| m.start_s < t_s) {
        let (travel_rad, speed_rad_s) = motion.state(t_s.min(motion.end_s) - motion.start_s);
        angle_rad += f64::from(motion.direction) * travel_rad;
        if t_s < motion.end_s {
            return (angle_rad, f64::from(motion.direction) * speed_rad_s);
        }
    }
    (angle_rad, 0.0)
}

impl TrueMotion {
    /// Travel and speed some time after the start, rad and rad/s.
    fn state(&self, since_s: f64) -> (f64, f64) {
        let (v, length_s, ramp_s) = (self.speed_rad_s, self.end_s - self.start_s, self.ramp_s);
        if !self.sharp {
            let u = since_s / length_s;
            // The peak speed of a minimum-jerk motion is 15/8 of its mean speed.
            let travel_rad = v * length_s / 1.875;
            let shape = u * u * u * (10.0 + u * (6.0 * u - 15.0));
            return (travel_rad * shape, v * 16.0 * u * u * (1.0 - u) * (1.0 - u));
        }
        let left_s = length_s - since_s;
        if since_s < ramp_s {
            (0.5 * v / ramp_s * since_s * since_s, v / ramp_s * since_s)
        } else if left_s < ramp_s {
            (v * (length_s - ramp_s) - 0.5 * v / ramp_s * left_s * left_s, v / ramp_s * left_s)
        } else {
            (v * (since_s - 0.5 * ramp_s), v)
        }
    }
}

fn stamps(rng: &mut ChaCha8Rng, rate_hz: f64) -> Vec<f64> {
    let mut t_s = vec![0.0];
    let mut k = 1.0;
    while k < DURATION_S * rate_hz {
        let white: f64 = StandardNormal.sample(rng);
        let lost = uniform(rng, 0.0, 1.0) < DROPS;
        let at_s = k / rate_hz + JITTER_S.min(0.1 / rate_hz) * white;
        if !lost && t_s.last().is_none_or(|&last| at_s > last) {
            t_s.push(at_s);
        }
        k += 1.0;
    }
    t_s
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_depends_on_its_seed_alone() {
        let sensing = Sensing::default();
        assert_eq!(synthetic_run(3, &sensing), synthetic_run(3, &sensing));
        assert_ne!(synthetic_run(3, &sensing), synthetic_run(4, &sensing));
    }

    #[test]
    fn noise_and_step_leave_plan_and_stamps_alone() {
        let clean = synthetic_run(5, &Sensing::default()).pair;
        let coarse =
            synthetic_run(5, &Sensing { lsb_rad: Some(1e-3), sigma_rad: 1e-3, ..Sensing::default() }).pair;
        assert_eq!((clean.t_s, clean.planned), (coarse.t_s, coarse.planned));
    }

    #[test]
    fn speeds_are_the_slope_of_angles() {
        let motions = synthetic_run(7, &Sensing::default()).motions;
        assert!(motions.iter().any(|m| m.sharp) && motions.iter().any(|m| !m.sharp));
        assert!(motions.iter().any(|m| m.reversal));
        for k in 0..6000 {
            let t = 0.01 * f64::from(k) + 0.003;
            let slope = (state(&motions, t + 1e-6).0 - state(&motions, t - 1e-6).0) / 2e-6;
            assert!((slope - state(&motions, t).1).abs() < 1e-4, "at {t} s");
        }
    }
}
