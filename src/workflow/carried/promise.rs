//! What a command promises, carried with it so that the log of its run can be held to it.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

const EXPECTED: &str = "expected_mean_peak_rad";
const MARGIN: &str = "expected_mean_peak_margin_rad";

/// Expected error of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Promise {
    /// Mean peak error of starts and reversals, rad.
    pub mean_peak_rad: f64,
    /// What the mean stays below in nine runs of ten, rad.
    pub mean_peak_margin_rad: f64,
}

/// A promise beside what came.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Held {
    /// What the command promised.
    #[serde(flatten)]
    pub promised: Promise,
    /// Mean peak error that came, rad; null without a start or reversal.
    pub measured_mean_peak_rad: Option<f64>,
    /// Starts and reversals that were measured.
    pub transitions: usize,
}

impl Held {
    /// Whether the mean stayed below what nine runs of ten stay below; `None` if nothing was measured.
    pub fn kept(&self) -> Option<bool> {
        Some(self.measured_mean_peak_rad? <= self.promised.mean_peak_margin_rad)
    }
}

impl Promise {
    /// Held to the peak errors of starts and reversals, rad.
    pub fn held(self, peaks_rad: impl Iterator<Item = f64>) -> Held {
        let (transitions, sum) = peaks_rad.fold((0, 0.0), |(count, sum), peak| (count + 1, sum + peak));
        let measured_mean_peak_rad = (transitions > 0).then(|| sum / transitions as f64);
        Held { promised: self, measured_mean_peak_rad, transitions }
    }

    /// As entries of the provenance.
    pub(super) fn entries(&self) -> [(String, String); 2] {
        [(EXPECTED, self.mean_peak_rad), (MARGIN, self.mean_peak_margin_rad)]
            .map(|(key, value)| (key.to_owned(), value.to_string()))
    }

    /// From such entries.
    pub(super) fn of(entries: &BTreeMap<String, String>) -> Option<Self> {
        let number = |key| entries.get(key)?.parse().ok().filter(|x: &f64| x.is_finite() && *x >= 0.0);
        Some(Self { mean_peak_rad: number(EXPECTED)?, mean_peak_margin_rad: number(MARGIN)? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_promise_reads_back_and_broken_ones_are_none() {
        let promise = Promise { mean_peak_rad: 0.0123, mean_peak_margin_rad: 0.02 };
        let mut entries = BTreeMap::from(promise.entries());
        assert_eq!(Promise::of(&entries), Some(promise));
        entries.insert(MARGIN.to_owned(), "NaN".to_owned());
        assert_eq!(Promise::of(&entries), None);
        assert_eq!(Promise::of(&BTreeMap::new()), None);
    }
}
