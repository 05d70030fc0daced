//! What a command promises, carried with it so that the log of its run can be held to it.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

const EXPECTED: &str = "expected_mean_peak_rad";
const MARGIN: &str = "expected_mean_peak_margin_rad";
const TRANSITIONS: &str = "expected_transitions";

/// Share of the promised transitions that tell whether the promise was kept: of fewer, as of one joint, the mean is another.
const ENOUGH: f64 = 0.75;

/// Expected error of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Promise {
    /// Mean peak error of starts and reversals, rad.
    pub mean_peak_rad: f64,
    /// What the mean stays below in nine runs of ten, rad.
    pub mean_peak_margin_rad: f64,
    /// Starts and reversals that these are means of; null of older logs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub promised_transitions: Option<usize>,
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
    /// Whether the mean stayed below what nine runs of ten stay below; `None` if too little was measured.
    pub fn kept(&self) -> Option<bool> {
        let all = self.promised.promised_transitions.unwrap_or_default();
        if (self.transitions as f64) < ENOUGH * all as f64 {
            return None;
        }
        Some(self.measured_mean_peak_rad? <= self.promised.mean_peak_margin_rad)
    }
}

impl Promise {
    /// Expected mean peak and what it stays below in nine runs of ten, rad, and of how many transitions.
    pub fn new([mean_peak_rad, mean_peak_margin_rad]: [f64; 2], promised_transitions: Option<usize>) -> Self {
        Self { mean_peak_rad, mean_peak_margin_rad, promised_transitions }
    }

    /// Held to the peak errors of starts and reversals, rad.
    pub fn held(self, peaks_rad: impl Iterator<Item = f64>) -> Held {
        let (transitions, sum) = peaks_rad.fold((0, 0.0), |(count, sum), peak| (count + 1, sum + peak));
        let measured_mean_peak_rad = (transitions > 0).then(|| sum / transitions as f64);
        Held { promised: self, measured_mean_peak_rad, transitions }
    }

    /// As entries of the provenance.
    pub(super) fn entries(&self) -> Vec<(String, String)> {
        let transitions = self.promised_transitions.map(|count| (TRANSITIONS, count.to_string()));
        [(EXPECTED, self.mean_peak_rad.to_string()), (MARGIN, self.mean_peak_margin_rad.to_string())]
            .into_iter()
            .chain(transitions)
            .map(|(key, value)| (key.to_owned(), value))
            .collect()
    }

    /// From such entries.
    pub(super) fn of(entries: &BTreeMap<String, String>) -> Option<Self> {
        let number = |key| entries.get(key)?.parse().ok().filter(|x: &f64| x.is_finite() && *x >= 0.0);
        let transitions = entries.get(TRANSITIONS).and_then(|count| count.parse().ok());
        Some(Self::new([number(EXPECTED)?, number(MARGIN)?], transitions))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_promise_reads_back_and_broken_ones_are_none() {
        let promise = Promise::new([0.0123, 0.02], Some(8));
        let mut entries: BTreeMap<String, String> = promise.entries().into_iter().collect();
        assert_eq!(Promise::of(&entries), Some(promise));
        entries.insert(MARGIN.to_owned(), "NaN".to_owned());
        assert_eq!(Promise::of(&entries), None);
        assert_eq!(Promise::of(&BTreeMap::new()), None);
    }

    #[test]
    fn what_came_of_some_joints_alone_keeps_no_promise_and_breaks_none() {
        let promise = Promise::new([0.1, 0.15], Some(8));
        let kept = |peaks_rad: &[f64]| promise.held(peaks_rad.iter().copied()).kept();
        assert_eq!(kept(&[0.2; 3]), None);
        assert_eq!(kept(&[0.1; 5]), None);
        assert_eq!((kept(&[0.1; 7]), kept(&[0.2; 8])), (Some(true), Some(false)));
        let older = Promise::new([0.1, 0.15], None);
        assert_eq!(older.held([0.2].into_iter()).kept(), Some(false));
    }
}
