//! Whether what a model leaves unexplained rings.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use super::super::model::STEP_S;
use crate::{
    math::{lowpass, range, rms, whole},
    series::Track,
};

/// Frequencies above this are noise of sensors, Hz.
const LOOKED_AT_HZ: f64 = 3.0;

/// First minimum of the autocorrelation below which a loop may oscillate; low-passed noise has -0.4.
const RINGS_BELOW: f64 = -0.45;

/// Next maximum above which it does.
const RINGS_ABOVE: f64 = 0.3;

/// Next maximum above which it goes on by itself.
const HUNTS_ABOVE: f64 = 0.8;

/// Highest line of the spectrum by the frequency that the autocorrelation repeats itself with.
const AGREES: [f64; 2] = [0.75, 1.35];

/// A peak has so many times the power of what is slower by this factor.
const STANDS_OUT: f64 = 1.5;
const SLOWER: f64 = 0.7;

/// Frequencies at which a peak is looked for, Hz.
const PEAK_HZ: [f64; 2] = [0.4, 4.0];

/// Distance of these frequencies, Hz.
const PEAK_STEP_HZ: f64 = 0.02;

/// Longest period that is looked for, s.
const LONGEST_S: f64 = 3.0;

/// Less than this share of what a plan is off by unaided does not ring.
const LITTLE: f64 = 0.04;

/// How a joint answers where the model has no explanation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Character {
    /// Nothing periodic is left.
    Calm,
    /// It rings after it is moved.
    Rings,
    /// It oscillates by itself.
    Hunts,
}

/// Periodicity of the unexplained motion of one joint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Oscillation {
    /// First minimum of the autocorrelation of the unexplained speed, below 3 Hz.
    pub first_minimum: f64,
    /// The maximum after it; 0 without one within 3 s.
    pub next_maximum: f64,
    /// Where the spectrum of that speed is highest, between 0.4 and 4 Hz.
    pub frequency_hz: f64,
    /// What follows from the two.
    pub character: Character,
}

impl Oscillation {
    /// Of what a joint does beside its plan.
    pub fn of_error(planned: &Track, measured: &Track) -> Self {
        let [from_s, to_s] = range(measured.t_s().iter().copied());
        let steps = (0..).map(|k| from_s + f64::from(k) * STEP_S).take_while(|t_s| *t_s <= to_s);
        let error_rad = |t_s: f64| measured.held_at(t_s).position - planned.held_at(t_s).position;
        Self::of(&steps.map(error_rad).collect::<Vec<_>>())
    }

    /// Of measured less modelled angles, rad, beside what the plan would be off by unaided; what a model leaves where it
    /// explains nearly all has some period by itself.
    pub(super) fn beside(unexplained_rad: &[f64], unaided_rad: &[f64]) -> Self {
        let found = Self::of(unexplained_rad);
        let little = Self::is_little((rms(unexplained_rad) / rms(unaided_rad)).powi(2));
        Self { character: if little { Character::Calm } else { found.character }, ..found }
    }

    /// Whether so small a share of the squared error is too little to ring.
    pub(in crate::fit) fn is_little(share: f64) -> bool {
        share < LITTLE * LITTLE
    }

    /// Of measured less modelled angles, rad, every [`STEP_S`].
    pub(in crate::fit) fn of(unexplained_rad: &[f64]) -> Self {
        let mut smooth = unexplained_rad.to_vec();
        lowpass(&mut smooth, LOOKED_AT_HZ, STEP_S);
        let mut speed_rad_s: Vec<f64> = smooth.windows(2).map(|w| (w[1] - w[0]) / STEP_S).collect();
        let mean = speed_rad_s.iter().sum::<f64>() / speed_rad_s.len().max(1) as f64;
        for speed in &mut speed_rad_s {
            *speed -= mean;
        }
        let Turns { first_minimum, next_maximum, period_s } = turns(&speed_rad_s);
        let (frequency_hz, stands_out) = peak_hz(&speed_rad_s);
        let agrees = stands_out && (AGREES[0]..AGREES[1]).contains(&(frequency_hz * period_s));
        let rings = first_minimum < RINGS_BELOW && next_maximum > RINGS_ABOVE && agrees;
        let character = match (rings, next_maximum > HUNTS_ABOVE) {
            (true, true) => Character::Hunts,
            (true, false) => Character::Rings,
            (false, _) => Character::Calm,
        };
        Self { first_minimum, next_maximum, frequency_hz, character }
    }
}

/// First minimum of an autocorrelation, and the maximum after it with its lag.
#[derive(Default)]
struct Turns {
    first_minimum: f64,
    next_maximum: f64,
    period_s: f64,
}

fn turns(values: &[f64]) -> Turns {
    let power: f64 = values.iter().map(|x| x * x).sum();
    if power <= 0.0 {
        return Turns::default();
    }
    let most = whole(LONGEST_S / STEP_S).min(values.len() / 2);
    let correlation =
        |lag: usize| values.iter().zip(values.iter().skip(lag)).map(|(a, b)| a * b).sum::<f64>() / power;
    let all: Vec<f64> = (0..most).map(correlation).collect();
    let turn = |from: usize, way: f64| {
        (from + 1..all.len().saturating_sub(1))
            .find(|&k| way * all[k] >= way * all[k - 1] && way * all[k] > way * all[k + 1])
    };
    let Some(minimum) = turn(0, -1.0) else { return Turns::default() };
    let (maximum, lag) = turn(minimum, 1.0).map_or((0.0, 0), |maximum| (all[maximum].max(0.0), maximum));
    Turns { first_minimum: all[minimum], next_maximum: maximum, period_s: lag as f64 * STEP_S }
}

/// Frequency of the highest line of the spectrum, under a Hann window, and whether it stands above what is slower: of a slow
/// error the slowest line is the highest.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "two hundred lines")]
fn peak_hz(values: &[f64]) -> (f64, bool) {
    let last = values.len().saturating_sub(1).max(1) as f64;
    let windowed: Vec<f64> = values
        .iter()
        .enumerate()
        .map(|(k, x)| x * 0.5 * (1.0 - (2.0 * PI * k as f64 / last).cos()))
        .collect();
    let power = |frequency_hz: f64| {
        // Goertzel's recursion.
        let turn = 2.0 * (2.0 * PI * frequency_hz * STEP_S).cos();
        let (mut one, mut two) = (0.0, 0.0);
        for x in &windowed {
            (one, two) = (x + turn * one - two, one);
        }
        one * one + two * two - turn * one * two
    };
    let lines = ((PEAK_HZ[1] - PEAK_HZ[0]) / PEAK_STEP_HZ).round() as u32;
    let (peak_hz, most) = (0..=lines)
        .map(|line| PEAK_HZ[0] + PEAK_STEP_HZ * f64::from(line))
        .map(|frequency_hz| (frequency_hz, power(frequency_hz)))
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or((PEAK_HZ[0], 0.0));
    (peak_hz, most > STANDS_OUT * power(SLOWER * peak_hz))
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::rng::{Stream, stream};

    fn noise(count: usize, seed: u64) -> Vec<f64> {
        let mut rng = stream(seed, Stream::SensorNoise);
        (0..count).map(|_| StandardNormal.sample(&mut rng)).collect()
    }

    /// White noise of the encoder over a slow unexplained error, and an oscillation.
    fn left(seed: u64, amplitude: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut slow = noise(4500, seed + 100);
        lowpass(&mut slow, 0.2, STEP_S);
        let fast = noise(4500, seed);
        slow.iter()
            .zip(fast)
            .enumerate()
            .map(|(k, (slow, fast))| {
                let t_s = k as f64 * STEP_S;
                3e-3 * slow + 2e-5 * fast + amplitude(t_s) * (2.0 * PI * 1.1 * t_s).sin()
            })
            .collect()
    }

    #[test]
    fn slow_errors_and_noise_are_calm() {
        for seed in 0..20 {
            let found = Oscillation::of(&left(seed, |_| 0.0));
            assert_eq!(found.character, Character::Calm, "{seed}: {found:?}");
        }
    }

    #[test]
    fn ringing_after_starts_and_hunting_are_told_apart_with_their_frequency() {
        for seed in 0..5 {
            let rings = Oscillation::of(&left(seed, |t_s| 2e-3 * (-(t_s % 12.0) / 2.0).exp()));
            assert_eq!(rings.character, Character::Rings, "{seed}: {rings:?}");
            let hunts = Oscillation::of(&left(seed, |_| 4e-3));
            assert_eq!(hunts.character, Character::Hunts, "{seed}: {hunts:?}");
            for found in [rings, hunts] {
                assert!((found.frequency_hz - 1.1).abs() < 0.05, "{seed}: {found:?}");
            }
        }
    }

    #[test]
    fn no_length_of_data_panics() {
        for count in 0..6 {
            let found = Oscillation::of(&vec![0.1; count]);
            assert_eq!(found.character, Character::Calm);
        }
    }
}
