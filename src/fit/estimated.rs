//! A number with what is known of it.

use serde::{Deserialize, Serialize};

use super::FitError;

/// An estimated number.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Estimated {
    /// Best guess; `None` for a limit that the joint never reached.
    pub value: Option<f64>,
    /// 95 % interval, widened for model error; `None` without a value.
    pub interval: Option<[f64; 2]>,
    /// Whether the data decide it, and not the prior.
    pub identified: bool,
    /// Largest value reached: the limit is not below.
    pub lower_bound: Option<f64>,
    /// A lag that smooth starts do not show is not above.
    #[serde(default)]
    pub upper_bound: Option<f64>,
}

impl Estimated {
    /// Holds what a file says to what a magnitude can be; a limit that never showed is infinite.
    pub(super) fn check(&self, joint: &str, key: &'static str) -> Result<(), FitError> {
        let ends = self.interval.into_iter().flatten();
        let told = [self.value, self.lower_bound, self.upper_bound].into_iter().flatten().chain(ends);
        let value = |found, least, most| FitError::Value { joint: joint.to_owned(), key, found, least, most };
        if let Some(found) = told.into_iter().find(|found| found.is_nan() || *found < 0.0) {
            return Err(value(found, 0.0, f64::INFINITY));
        }
        let Some(([low, high], found)) = self.interval.zip(self.value) else { return Ok(()) };
        // Digits of a file.
        let inside = (low * (1.0 - 1e-6)..=high * (1.0 + 1e-6)).contains(&found);
        if inside { Ok(()) } else { Err(value(found, low, high)) }
    }

    /// The same where another model explains the data as well, with another value: the interval holds both, and where that
    /// one lies outside, the data do not decide.
    pub(super) fn with_rival(self, other: f64) -> Self {
        let Some([low, high]) = self.interval else { return self };
        let identified = self.identified && (low..=high).contains(&other);
        let upper_bound = self.upper_bound.map(|bound| bound.max(other));
        Self { interval: Some([low.min(other), high.max(other)]), identified, upper_bound, ..self }
    }
}
