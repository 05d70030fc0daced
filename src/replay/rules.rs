//! Every threshold and window of the analysis, in one place, printed with every report.

use serde::{Deserialize, Serialize};

use crate::{series::JointKind, units::DEGREE_RAD};

/// Thresholds of positions and speeds, in the unit of a joint's position and that unit per second.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Sizes {
    /// Speed above which a joint has started, at least.
    pub start_speed: f64,
    /// Speed below which a joint has stopped, at least.
    pub stop_speed: f64,
    /// Speed that the fit window is widened for when the signal is noisy.
    pub target_speed: f64,
    /// Net travel of a motion, at least.
    pub min_travel: f64,
    /// A joint without an answered start moves if one of its motions travels this far; less is
    /// being shaken by the others.
    pub moves_travel: f64,
    /// Travel at which plan and measurement are compared for the displacement delay.
    pub displacement: f64,
    /// Error band of settling, at least.
    pub settle_band: f64,
}

impl Sizes {
    /// Of joints that turn, where one is a tenth of a degree, and of joints that slide, where one is two millimetres.
    fn of(one: f64) -> Self {
        Self {
            start_speed: one,
            stop_speed: 0.5 * one,
            target_speed: 2.0 * one,
            min_travel: 0.5 * one,
            moves_travel: 2.0 * one,
            displacement: one,
            settle_band: one,
        }
    }
}

/// Thresholds and windows. The default is for arms that move at 0.4 to 25 degrees or 8 to 500 mm per second.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Rules {
    /// Thresholds of joints that turn, rad and rad/s.
    pub turning: Sizes,
    /// Thresholds of joints that slide, m and m/s.
    pub sliding: Sizes,
    /// Start threshold of a measured speed, in standard deviations of that speed.
    pub start_sigmas: f64,
    /// Stop threshold of a measured speed, in standard deviations of that speed.
    pub stop_sigmas: f64,
    /// Narrowest half window of the velocity fit, s.
    pub window_min_s: f64,
    /// Widest half window of the velocity fit, s.
    pub window_max_s: f64,
    /// Fewest samples in a velocity fit.
    pub window_points: usize,
    /// Half window of the velocity fit to a plan that gives no speeds, s.
    pub planned_window_s: f64,
    /// Shortest motion, s.
    pub min_motion_s: f64,
    /// A plan that travels so many times the least travel moves, however short it takes: set values may step.
    #[serde(default = "step_travels")]
    pub step_travels: f64,
    /// Net travel of a measured motion, at least, in standard deviations of the angle.
    pub min_travel_sigmas: f64,
    /// Net travel of a measured motion, at least, in encoder steps.
    pub min_travel_lsbs: f64,
    /// Rest shorter than this joins two motions of the same direction, and makes a reversal of
    /// two motions of opposite direction, s.
    pub min_rest_s: f64,
    /// A segment must be at rest this long before its first motion counts as a start, s.
    pub opening_rest_s: f64,
    /// How far before the threshold crossing the onset may lie, s.
    pub onset_before_s: f64,
    /// Share of the rest before a motion in which its onset may lie.
    pub onset_rest_share: f64,
    /// How far after the threshold crossing the onset fit looks, beyond the half window, s.
    pub onset_after_s: f64,
    /// Step of the onset search, s.
    pub onset_step_s: f64,
    /// A measured start may precede its planned one by this, s.
    pub match_before_s: f64,
    /// A measured start before its planned one must cover this share of the planned travel.
    pub early_travel_share: f64,
    /// A measured start may follow the window of its planned one by this, s.
    pub match_after_s: f64,
    /// A joint that covers this share of the planned travel within the window follows, whether the
    /// instant at which it left rest is seen or not.
    pub follow_share: f64,
    /// Longest window of a transition, s.
    pub transition_window_s: f64,
    /// How long after the measured onset a jump of speed is looked for, s.
    pub jump_window_s: f64,
    /// Error band of settling, in standard deviations of the angle.
    pub settle_sigmas: f64,
    /// How long the error must stay in the band, s.
    pub settle_hold_s: f64,
    /// A plan at rest for longer than this is at standstill, s.
    pub standstill_after_s: f64,
    /// Rate at which speeds are compared for the lag, at most, Hz.
    pub lag_rate_hz: f64,
    /// Least correlation of the speeds at which a shift is a lag.
    pub lag_min_correlation: f64,
    /// Largest lag looked for, either way, s.
    pub lag_max_s: f64,
    /// Share of the squared error from which on a lag explains it: at 0.75, shifting the plan by the lag at
    /// least halves the root mean square error.
    pub mostly_lag_share: f64,
    /// Rate at which the path error is taken, at most, Hz.
    pub path_rate_hz: f64,
    /// The nearest planned point is looked for within this time, either way, s.
    pub path_window_s: f64,
    /// Rate at which the tool is placed, at most, Hz.
    pub tool_rate_hz: f64,
    /// Where the tool comes to rest is the mean over the last of a rest, so long at most and half of it at most, s.
    pub tool_rest_s: f64,
    /// Starts closer together than this, over all joints, are one event of the test, s.
    pub same_event_s: f64,
    /// Stretches shorter than this are left out of the test, s.
    pub min_stretch_s: f64,
    /// Probability of error below which the test decides.
    pub significance: f64,
}

/// Also of reports that were written before there was a rule.
const fn step_travels() -> f64 {
    4.0
}

impl Default for Rules {
    fn default() -> Self {
        Self {
            turning: Sizes::of(0.1 * DEGREE_RAD),
            sliding: Sizes::of(0.002),
            start_sigmas: 6.0,
            stop_sigmas: 3.0,
            window_min_s: 0.08,
            window_max_s: 0.25,
            window_points: 7,
            planned_window_s: 0.03,
            min_motion_s: 0.12,
            step_travels: step_travels(),
            min_travel_sigmas: 5.0,
            min_travel_lsbs: 2.0,
            min_rest_s: 0.20,
            opening_rest_s: 0.10,
            onset_before_s: 0.70,
            onset_rest_share: 0.9,
            onset_after_s: 0.12,
            onset_step_s: 0.005,
            match_before_s: 0.3,
            early_travel_share: 0.3,
            match_after_s: 1.0,
            follow_share: 0.3,
            transition_window_s: 4.0,
            jump_window_s: 0.4,
            settle_sigmas: 5.0,
            settle_hold_s: 0.3,
            standstill_after_s: 1.0,
            lag_rate_hz: 100.0,
            lag_min_correlation: 0.5,
            lag_max_s: 1.0,
            mostly_lag_share: 0.75,
            path_rate_hz: 50.0,
            path_window_s: 2.0,
            tool_rate_hz: 100.0,
            tool_rest_s: 0.5,
            same_event_s: 1.0,
            min_stretch_s: 0.1,
            significance: 0.05,
        }
    }
}

impl Rules {
    /// Thresholds of a joint of this kind.
    pub fn sizes(&self, kind: JointKind) -> &Sizes {
        match kind {
            JointKind::Turns => &self.turning,
            JointKind::Slides => &self.sliding,
        }
    }

    /// An error of a joint of this kind in error bands of settling: joints that turn and joints that slide have no unit in common.
    pub fn bands(&self, kind: JointKind, error: f64) -> f64 {
        error / self.sizes(kind).settle_band
    }

    /// Half window of the velocity fit, s: as narrow as lets a motion at the target speed pass
    /// the start threshold (an even window of n samples within h has the slope deviation
    /// sigma sqrt(1.5 dt / h³)), and as wide as holds the fewest samples.
    pub fn window_s(&self, kind: JointKind, sample_interval_s: f64, sigma: f64) -> f64 {
        let noise = self.start_sigmas * sigma / self.sizes(kind).target_speed;
        let needed_s = (1.5 * sample_interval_s * noise * noise).cbrt();
        let filled_s = 0.5 * self.window_points.saturating_sub(1) as f64 * sample_interval_s;
        needed_s.min(self.window_max_s).max(self.window_min_s).max(filled_s)
    }
}
