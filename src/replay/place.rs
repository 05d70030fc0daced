//! Where most of the error arises: in the transitions, or elsewhere.

#[cfg(doc)]
use super::Rules;
use serde::{Deserialize, Serialize};

/// Error inside transition windows against elsewhere, over joints whose plan moves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Concentration {
    /// Root mean square error inside.
    pub rms_inside: f64,
    /// Root mean square error elsewhere.
    pub rms_outside: f64,
    /// Root mean square error elsewhere while the plan moves.
    pub rms_outside_moving: Option<f64>,
    /// Share of joint time inside.
    pub time_share_inside: f64,
    /// Share of the squared error inside.
    pub squared_error_share_inside: f64,
    /// The test; `None` if one side is empty.
    pub test: Option<ConcentrationTest>,
    /// What the test says.
    pub verdict: Verdict,
}

/// Mann-Whitney test on root mean square errors of windows and of the stretches between them.
///
/// Samples of one window are not independent, so each window and each stretch counts once.
/// Joints differ in scale, so each value is divided by its joint's root mean square error.
/// Joints that start together are not independent, so values that begin within
/// [`Rules::same_event_s`] are averaged into one event.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ConcentrationTest {
    /// Events inside.
    pub inside_count: usize,
    /// Events elsewhere.
    pub outside_count: usize,
    /// Two-sided probability of such a difference by chance (normal approximation).
    pub p_value: f64,
    /// Probability that an event inside has the larger error: 0.5 is no difference.
    pub effect: f64,
}

/// Where most of the error arises.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// In the transitions.
    Transitions,
    /// Elsewhere.
    Elsewhere,
    /// Too few events to tell.
    Undecided,
}
