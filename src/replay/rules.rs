//! Every threshold and window of the analysis, in one place, printed with every report.

use serde::{Deserialize, Serialize};

use crate::units::DEGREE_RAD;

/// Thresholds and windows. The default is for arms that move at 0.4 to 25 degrees per second.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Rules {
    /// Speed above which a joint has started, at least, rad/s.
    pub start_floor_rad_s: f64,
    /// Speed below which a joint has stopped, at least, rad/s.
    pub stop_floor_rad_s: f64,
    /// Start threshold of a measured speed, in standard deviations of that speed.
    pub start_sigmas: f64,
    /// Stop threshold of a measured speed, in standard deviations of that speed.
    pub stop_sigmas: f64,
    /// Speed that the fit window is widened for when the signal is noisy, rad/s.
    pub target_speed_rad_s: f64,
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
    /// Net travel of a motion, at least, rad.
    pub min_travel_rad: f64,
    /// Net travel of a measured motion, at least, in standard deviations of the angle.
    pub min_travel_sigmas: f64,
    /// Net travel of a measured motion, at least, in encoder steps.
    pub min_travel_lsbs: f64,
    /// A joint without an answered start moves if one of its motions travels this far; less is
    /// being shaken by the others, rad.
    pub moves_travel_rad: f64,
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
    /// Travel at which plan and measurement are compared for the displacement delay, rad.
    pub displacement_rad: f64,
    /// How long after the measured onset a jump of speed is looked for, s.
    pub jump_window_s: f64,
    /// Error band of settling, at least, rad.
    pub settle_band_rad: f64,
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
    /// Starts closer together than this, over all joints, are one event of the test, s.
    pub same_event_s: f64,
    /// Stretches shorter than this are left out of the test, s.
    pub min_stretch_s: f64,
    /// Probability of error below which the test decides.
    pub significance: f64,
}

impl Default for Rules {
    fn default() -> Self {
        Self {
            start_floor_rad_s: 0.10 * DEGREE_RAD,
            stop_floor_rad_s: 0.05 * DEGREE_RAD,
            start_sigmas: 6.0,
            stop_sigmas: 3.0,
            target_speed_rad_s: 0.20 * DEGREE_RAD,
            window_min_s: 0.08,
            window_max_s: 0.25,
            window_points: 7,
            planned_window_s: 0.03,
            min_motion_s: 0.12,
            min_travel_rad: 0.05 * DEGREE_RAD,
            min_travel_sigmas: 5.0,
            min_travel_lsbs: 2.0,
            moves_travel_rad: 0.2 * DEGREE_RAD,
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
            displacement_rad: 0.1 * DEGREE_RAD,
            jump_window_s: 0.4,
            settle_band_rad: 0.1 * DEGREE_RAD,
            settle_sigmas: 5.0,
            settle_hold_s: 0.3,
            standstill_after_s: 1.0,
            lag_rate_hz: 100.0,
            lag_min_correlation: 0.5,
            lag_max_s: 1.0,
            mostly_lag_share: 0.75,
            path_rate_hz: 50.0,
            path_window_s: 2.0,
            same_event_s: 1.0,
            min_stretch_s: 0.1,
            significance: 0.05,
        }
    }
}

impl Rules {
    /// Half window of the velocity fit, s: as narrow as lets a motion at the target speed pass
    /// the start threshold (an even window of n samples within h has the slope deviation
    /// sigma sqrt(1.5 dt / h³)).
    pub fn window_s(&self, sample_interval_s: f64, sigma_rad: f64) -> f64 {
        let noise = self.start_sigmas * sigma_rad / self.target_speed_rad_s;
        let needed_s = (1.5 * sample_interval_s * noise * noise).cbrt();
        needed_s.min(self.window_max_s).max(self.window_min_s)
    }
}
