//! Whether runs were measured alike: noise and rate of a measurement move peaks and delays by themselves.

/// Noise, or time between samples, that is larger by this on one side changes peaks and delays by itself.
const APART: f64 = 1.6;

/// Noise that is this share of the peak error of the run at most changes no peak that counts.
const LITTLE: f64 = 0.005;

/// How a joint was measured in a run, or in the mean over runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::workflow) struct Sensed {
    pub(in crate::workflow) noise: f64,
    pub(in crate::workflow) interval_s: f64,
    pub(in crate::workflow) peak_error: f64,
}

impl Sensed {
    /// Whether the noise is another one, by so much that it counts.
    pub(in crate::workflow) fn other_noise(self, other: Self) -> bool {
        let counts = self.noise.max(other.noise) > LITTLE * self.peak_error.min(other.peak_error);
        counts && apart(self.noise, other.noise)
    }

    /// Whether the rate is another one.
    pub(in crate::workflow) fn other_rate(self, other: Self) -> bool {
        self.interval_s.min(other.interval_s) > 0.0 && apart(self.interval_s, other.interval_s)
    }
}

fn apart(a: f64, b: f64) -> bool {
    a.max(b) > APART * a.min(b)
}
