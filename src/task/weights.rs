//! Ceilings on the objectives and their weights.

use crate::remark::{Code, Remarks};

/// Ceilings on the objectives (paper, section V: "f1 must be less than 40, ..."); `None` is none.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Bounds {
    /// Total time, s (f1).
    pub duration_s: Option<f64>,
    /// Sum over joints of the root mean square jerk, rad/s³ (f2).
    pub rms_jerk_rad_s3: Option<f64>,
    /// Sum over joints of the root mean square power, W (f3).
    pub rms_power_w: Option<f64>,
}

/// Relative weights of the objectives, each scaled by its range over the front; not negative, not
/// all zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weights {
    /// Of the total time.
    pub duration: f64,
    /// Of the root mean square jerk.
    pub rms_jerk: f64,
    /// Of the root mean square power.
    pub rms_power: f64,
}

/// A ceiling this many times above what is needed binds nothing.
const INACTIVE: f64 = 10.0;

impl Bounds {
    /// Remarks on ceilings that bind nothing: more than ten times above the largest value that
    /// any plan of the front has. The arguments are those values.
    pub fn remark_inactive(
        &self,
        duration_s: f64,
        rms_jerk_rad_s3: f64,
        rms_power_w: f64,
        remarks: &mut Remarks,
    ) {
        let each = [
            ("max_duration_s", self.duration_s, duration_s),
            ("max_rms_jerk_deg_s3", self.rms_jerk_rad_s3, rms_jerk_rad_s3),
            ("max_rms_power_w", self.rms_power_w, rms_power_w),
        ];
        for (key, bound, largest) in each {
            if let Some(bound) = bound
                && bound > INACTIVE * largest
            {
                let message = format!(
                    "{key} is {:.0} times above the largest value of any plan found: it binds nothing; is its unit right?",
                    bound / largest
                );
                remarks.add(Code::InactiveBound, 1, message);
            }
        }
    }
}
