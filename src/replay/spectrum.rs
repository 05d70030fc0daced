//! A joint's run by frequency: how large the error is at each, and how the joint answers what the plan holds there.

use std::f64::consts::{PI, TAU};

use crate::{
    math::{median, whole},
    series::Pair,
};

/// Windows are the share of the longest stretch that this is one part of, within bounds, s; each begins half a window
/// after the one before.
const PARTS: f64 = 8.0;
const WINDOW_S: [f64; 2] = [4.0, 20.0];
/// Windows looked at at most, evenly over the run.
const MOST_WINDOWS: usize = 120;
/// Frequencies are told up to this, Hz, and to this share of the sampling rate.
const MOST_HZ: f64 = 10.0;
const MOST_OF_RATE: f64 = 0.4;
/// A joint goes with its plan where the coherence is so large; of chance alone it is one by the number of windows.
pub const COHERENT: f64 = 0.7;
/// A response is told from so many windows on, where the joint goes with the plan at so many neighbours.
const LEAST_WINDOWS: usize = 6;
const NEIGHBOURS: usize = 5;
/// Share of the plan's largest amplitude under which the plan holds nothing at a frequency.
const HOLDS: f64 = 1e-3;

/// A joint's run by frequency (Welch's method: windows of Hann, half overlapping, straight lines removed).
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Frequencies, Hz, `[n]`, evenly from one by the window's length on.
    pub frequency_hz: Vec<f64>,
    /// Amplitude of the sinusoid that the error holds at each, in the joint's unit.
    pub error: Vec<f64>,
    /// Amplitude of the sinusoid that the plan holds at each.
    pub planned: Vec<f64>,
    /// How measured answers planned, where the plan asks enough.
    pub response: Option<Response>,
    /// Length of a window, s.
    pub window_s: f64,
    /// Windows that were averaged.
    pub windows: usize,
}

/// Measured position by planned position at the first frequencies of a spectrum, `[m]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// Amplitude by amplitude.
    pub gain: Vec<f64>,
    /// Phase, rad, below zero where the joint follows late; without jumps of a turn.
    pub phase_rad: Vec<f64>,
    /// Share of what is measured that goes with the plan, 0 to 1.
    pub coherence: Vec<f64>,
}

/// Sums over windows at one frequency.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    error: f64,
    planned: f64,
    measured: f64,
    cross: [f64; 2],
}

/// By frequency; `None` where no stretch without a gap is long enough for two windows.
pub fn spectrum(pair: &Pair) -> Option<Spectrum> {
    let longest_s = pair.spans_s().map(|[from, to]| to - from).fold(0.0, f64::max);
    let window_s = (longest_s / PARTS).clamp(WINDOW_S[0], WINDOW_S[1]);
    let steps =
        pair.segments.iter().flat_map(|part| pair.t_s[part.clone()].windows(2).map(|two| two[1] - two[0]));
    let steps_s: Vec<f64> = steps.collect();
    if longest_s < 1.5 * window_s || steps_s.is_empty() {
        return None;
    }
    // A finer grid than the highest frequency takes is averaged, so that faster swings fold into no slower ones.
    let sampled_s = median(steps_s);
    let most_hz = MOST_HZ.min(MOST_OF_RATE / sampled_s);
    let count = whole(window_s / sampled_s.max(0.25 / most_hz) + 0.5);
    let finer = whole((window_s / (count.max(1) as f64 * sampled_s)).round()).max(1);
    let frequencies = whole(most_hz * window_s);
    if count < 8 || frequencies == 0 {
        return None;
    }
    let starts_s = starts_s(pair, window_s);
    let mut sums = vec![Sums::default(); frequencies];
    let hann: Vec<f64> = (0..count).map(|i| 0.5 - 0.5 * (TAU * i as f64 / count as f64).cos()).collect();
    for start_s in &starts_s {
        let step_s = window_s / (count * finer) as f64;
        let from_s = start_s - (finer - 1) as f64 * step_s;
        let t_s = (0..(count + 1) * finer + finer - 2).map(|i| from_s + i as f64 * step_s);
        let [planned, measured] = sampled(pair, t_s).map(|values| averaged(&values, finer));
        let error: Vec<f64> = planned.iter().zip(&measured).map(|(p, m)| p - m).collect();
        let windowed = [planned, measured, error].map(|values| straightened(&values, &hann));
        for (k, sums) in sums.iter_mut().enumerate() {
            sums.add(windowed.each_ref().map(|values| at_frequency(values, k + 1)));
        }
    }
    let windows = starts_s.len();
    let scale = 2.0 / hann.iter().sum::<f64>();
    let amplitude = |power: f64| scale * (power / windows as f64).sqrt();
    let of = |power: fn(&Sums) -> f64| {
        let amplitude = |(k, sums): (usize, &Sums)| {
            amplitude(power(sums)) / gain_of_average((k + 1) as f64 / count as f64, finer)
        };
        sums.iter().enumerate().map(amplitude).collect()
    };
    Some(Spectrum {
        frequency_hz: (1..=frequencies).map(|k| k as f64 / window_s).collect(),
        error: of(|sums| sums.error),
        planned: of(|sums| sums.planned),
        response: response(&sums, windows),
        window_s,
        windows,
    })
}

/// An error is no answer to the plan where it is so many times what the plan holds, and a peak where it is so many times
/// what it falls to towards slower frequencies.
const OWN: f64 = 3.0;

impl Spectrum {
    /// Frequency, Hz, and amplitude of a swing that the plan does not ask for: the largest peak of the error that stands out.
    pub fn swing(&self) -> Option<[f64; 2]> {
        let mut valley = f64::INFINITY;
        let mut found: Option<usize> = None;
        for k in 1..self.error.len().saturating_sub(1) {
            valley = valley.min(self.error[k]);
            let peak = self.error[k] >= self.error[k - 1] && self.error[k] >= self.error[k + 1];
            let own = self.error[k] > OWN * self.planned[k] && self.error[k] > OWN * valley;
            if peak && own && found.is_none_or(|best| self.error[k] > self.error[best]) {
                found = Some(k);
            }
        }
        let of_note = |k: &usize| self.error[*k] > OF_NOTE * self.error.iter().copied().fold(0.0, f64::max);
        found.filter(of_note).map(|k| [self.frequency_hz[k], self.error[k]])
    }
}

/// Share of the largest amplitude from which a swing is told.
const OF_NOTE: f64 = 0.1;

impl Sums {
    fn add(&mut self, [planned, measured, error]: [[f64; 2]; 3]) {
        let power = |[re, im]: [f64; 2]| re * re + im * im;
        self.error += power(error);
        self.planned += power(planned);
        self.measured += power(measured);
        // Measured times the conjugate of planned.
        self.cross[0] += measured[0] * planned[0] + measured[1] * planned[1];
        self.cross[1] += measured[1] * planned[0] - measured[0] * planned[1];
    }

    fn coherence(&self) -> f64 {
        let both = self.planned * self.measured;
        if both > 0.0 { ((self.cross[0].powi(2) + self.cross[1].powi(2)) / both).min(1.0) } else { 0.0 }
    }
}

/// Where windows begin, s, evenly over all stretches that hold one.
fn starts_s(pair: &Pair, window_s: f64) -> Vec<f64> {
    let mut starts_s = Vec::new();
    for [from_s, to_s] in pair.spans_s().filter(|[from, to]| to - from >= window_s) {
        let more = whole((to_s - from_s - window_s) / (0.5 * window_s));
        starts_s.extend((0..=more).map(|k| from_s + 0.5 * window_s * k as f64));
    }
    let every = starts_s.len().div_ceil(MOST_WINDOWS).max(1);
    starts_s.into_iter().step_by(every).collect()
}

/// Averages under a triangle that reaches to the neighbours, of values so many times as fine.
fn averaged(values: &[f64], finer: usize) -> Vec<f64> {
    let weights: Vec<f64> = (1..2 * finer).map(|i| i.min(2 * finer - i) as f64).collect();
    let whole: f64 = weights.iter().sum();
    let mean =
        |own: &[f64]| own.iter().zip(&weights).map(|(value, weight)| value * weight).sum::<f64>() / whole;
    values.windows(weights.len()).step_by(finer).map(mean).collect()
}

/// What that leaves of a swing of so many cycles a step.
fn gain_of_average(cycles: f64, finer: usize) -> f64 {
    let (step, n) = (PI * cycles / finer as f64, finer as f64);
    ((n * step).sin() / (n * step.sin())).powi(2)
}

/// Planned and measured positions at instants that ascend, about within a stretch.
fn sampled(pair: &Pair, t_s: impl Iterator<Item = f64>) -> [Vec<f64>; 2] {
    let (mut planned, mut measured) = (Vec::new(), Vec::new());
    let mut next = 0;
    for t_s in t_s {
        if next == 0 {
            next = pair.t_s.partition_point(|t| *t <= t_s).clamp(1, (pair.t_s.len() - 1).max(1));
        }
        while next + 1 < pair.t_s.len() && pair.t_s[next] <= t_s {
            next += 1;
        }
        let (Some(from_s), Some(to_s)) = (pair.t_s.get(next - 1), pair.t_s.get(next)) else { continue };
        let share = ((t_s - from_s) / (to_s - from_s)).clamp(0.0, 1.0);
        let at = |values: &[f64]| values[next - 1] + share * (values[next] - values[next - 1]);
        planned.push(at(&pair.planned));
        measured.push(at(&pair.measured));
    }
    [planned, measured]
}

/// Values without their straight line, under a window.
fn straightened(values: &[f64], window: &[f64]) -> Vec<f64> {
    let count = values.len() as f64;
    let middle = 0.5 * (count - 1.0);
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = (0..values.len()).map(|i| (i as f64 - middle).powi(2)).sum();
    let along: f64 = values.iter().enumerate().map(|(i, value)| (i as f64 - middle) * value).sum();
    let slope = if squares > 0.0 { along / squares } else { 0.0 };
    let left = |(i, value): (usize, &f64)| value - mean - slope * (i as f64 - middle);
    values.iter().enumerate().map(left).zip(window).map(|(value, weight)| value * weight).collect()
}

/// What values hold at a frequency of `cycles` in all of them (Goertzel's recurrence).
fn at_frequency(values: &[f64], cycles: usize) -> [f64; 2] {
    let step = TAU * cycles as f64 / values.len() as f64;
    let (sine, cosine) = step.sin_cos();
    let (mut last, mut before) = (0.0, 0.0);
    for value in values {
        (last, before) = (value + 2.0 * cosine * last - before, last);
    }
    [last * cosine - before, last * sine]
}

/// Up to the last of some neighbours at which the joint goes with the plan.
fn response(sums: &[Sums], windows: usize) -> Option<Response> {
    let largest = sums.iter().map(|sums| sums.planned).fold(0.0, f64::max);
    let goes = |sums: &Sums| sums.coherence() >= COHERENT && sums.planned > HOLDS * HOLDS * largest;
    let end = (NEIGHBOURS..=sums.len()).rev().find(|end| sums[end - NEIGHBOURS..*end].iter().all(goes))?;
    let told = &sums[..end];
    let gain = |sums: &Sums| (sums.cross[0].hypot(sums.cross[1])) / sums.planned.max(f64::MIN_POSITIVE);
    let mut phase_rad: Vec<f64> = told.iter().map(|sums| sums.cross[1].atan2(sums.cross[0])).collect();
    for k in 1..phase_rad.len() {
        phase_rad[k] -= TAU * ((phase_rad[k] - phase_rad[k - 1] + PI) / TAU).floor();
    }
    (windows >= LEAST_WINDOWS).then(|| Response {
        gain: told.iter().map(gain).collect(),
        phase_rad,
        coherence: told.iter().map(Sums::coherence).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        rng::{Stream, stream},
        series::{Track, align},
    };
    use rand_distr::{Distribution as _, Uniform};

    /// A run of a minute whose positions are functions of time.
    fn run(planned: impl Fn(f64) -> f64, measured: impl Fn(f64) -> f64, cut: Option<usize>) -> Pair {
        let t_s: Vec<f64> = (0..6000).map(|k| 0.01 * f64::from(k)).collect();
        let track = |of: &dyn Fn(f64) -> f64| {
            let cuts: Vec<usize> = cut.into_iter().collect();
            Track::new("boom", t_s.clone(), t_s.iter().map(|t| of(*t)).collect::<Vec<_>>(), &cuts).unwrap()
        };
        align(&track(&planned), &track(&measured)).unwrap()
    }

    #[test]
    fn a_sinusoid_in_the_error_is_found_with_its_frequency_and_amplitude() {
        for (amplitude, hz) in [(0.02, 1.3), (0.005, 4.1)] {
            let plan = |t: f64| 0.3 + 0.01 * t;
            let found = spectrum(&run(plan, |t| plan(t) + amplitude * (TAU * hz * t).sin(), None)).unwrap();
            let at =
                (0..found.error.len()).max_by(|a, b| found.error[*a].total_cmp(&found.error[*b])).unwrap();
            assert!((found.frequency_hz[at] - hz).abs() < 1.0 / found.window_s, "{}", found.frequency_hz[at]);
            assert!((found.error[at] / amplitude - 1.0).abs() < 0.2, "{} of {amplitude}", found.error[at]);
            let [swing_hz, swing] = found.swing().unwrap();
            assert!((swing_hz - hz).abs() < 1.0 / found.window_s && (swing / amplitude - 1.0).abs() < 0.2);
            assert!(found.windows >= 10 && found.response.is_none(), "{found:?}");
        }
    }

    /// Twelve sinusoids through a lag of the first order and a dead time.
    #[test]
    fn a_lag_and_a_dead_time_come_back_as_gain_and_phase() {
        let (tau_s, dead_s) = (0.25, 0.1);
        let hz: Vec<f64> = (1..=12).map(|k| 0.13 * f64::from(k)).collect();
        let sum = |of: &dyn Fn(f64) -> f64| hz.iter().map(|hz| of(*hz)).sum::<f64>();
        let planned = |t: f64| sum(&|hz| 0.02 * (TAU * hz * t + 7.0 * hz * hz).sin());
        let answer = |hz: f64| {
            let w = TAU * hz;
            (1.0 / (1.0 + (w * tau_s).powi(2)).sqrt(), -(w * tau_s).atan() - w * dead_s)
        };
        let measured = |t: f64| {
            sum(&|hz| {
                let (gain, phase) = answer(hz);
                0.02 * gain * (TAU * hz * t + 7.0 * hz * hz + phase).sin()
            })
        };
        for cut in [None, Some(2900)] {
            let found = spectrum(&run(planned, measured, cut)).unwrap();
            assert_eq!(found.swing(), None);
            let told = found.response.unwrap();
            assert!(told.gain.len() as f64 / found.window_s > 1.3, "{} frequencies", told.gain.len());
            let asked = found.frequency_hz.iter().enumerate().take_while(|(_, hz)| **hz < 1.5);
            for (k, hz) in asked.skip(1) {
                let (gain, phase) = answer(*hz);
                assert!(told.coherence[k] > 0.9, "{hz} Hz: {}", told.coherence[k]);
                assert!((told.gain[k] / gain - 1.0).abs() < 0.1, "{hz} Hz: {} of {gain}", told.gain[k]);
                assert!((told.phase_rad[k] - phase).abs() < 0.1, "{hz} Hz: {} of {phase}", told.phase_rad[k]);
            }
        }
    }

    #[test]
    fn nothing_is_told_of_a_joint_that_does_not_answer_or_of_a_short_run() {
        let mut rng = stream(1, Stream::SensorNoise);
        let noise: Vec<f64> = Uniform::new(-1e-3, 1e-3).unwrap().sample_iter(&mut rng).take(6000).collect();
        let of = |t: f64| noise[whole(100.0 * t + 0.5) % noise.len()];
        let asked = |t: f64| 0.1 * (0.7 * t).sin() + 0.05 * (2.9 * t).sin();
        assert!(spectrum(&run(asked, of, None)).unwrap().response.is_none());
        let t_s: Vec<f64> = (0..300).map(|k| 0.01 * f64::from(k)).collect();
        let short = Track::new("boom", t_s.clone(), t_s, &[]).unwrap();
        assert!(spectrum(&align(&short, &short).unwrap()).is_none());
    }

    #[test]
    fn a_vibration_that_is_faster_than_the_band_is_no_slow_swing() {
        let plan = |t: f64| 0.3 + 0.01 * t;
        for hz in [37.0, 43.0] {
            let found = spectrum(&run(plan, |t| plan(t) + 0.02 * (TAU * hz * t).sin(), None)).unwrap();
            let most = found.error.iter().copied().fold(0.0, f64::max);
            assert!(most < 0.002, "{hz} Hz: {most}");
        }
    }
}
