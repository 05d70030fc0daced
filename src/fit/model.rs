//! The closed loop of one joint, reduced to what logs of positions can tell.

use serde::{Deserialize, Serialize};

use super::FitError;

/// Step of the simulation, s; that of the position loops it stands for.
pub const STEP_S: f64 = 0.01;

/// Whole steps in a time, rounded down within rounding errors.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a log has few steps")]
pub(super) fn steps_in(span_s: f64) -> usize {
    (span_s / STEP_S + 1e-6).clamp(0.0, 1e9) as usize
}

/// A joint with its valve, its position loop and its sensor, from sent to measured angle.
///
/// The set values, angle and speed, come late by a `delay` and pass a filter of first order. The loop wants a speed
/// w = `feed_forward` * sent speed + `position_gain` * error + integral, the last held within ±`integral_limit`, which arrives after the dead time; the spool follows it with a play of ±`hysteresis`. What is left beyond the dead band,
/// b, gives the speed b² / (b + `edge`). Scaled by exp(±`asymmetry` / 2) for growing and shrinking angles and by the
/// pose, and clipped to what the valve opens to, it is approached with a time constant, within the acceleration limits; of that the
/// joint has what its speed limits leave. A valve that `opens_beyond` them takes time to come back. A joint that swings on its oil
/// or its link follows that speed as a mass on a spring does.
/// Speeds, gains and dead band are as the joint shows them: a loop gain that no log can tell apart is in all of them.
///
/// Pairs are for growing and for shrinking angles, both positive; a limit that no data showed is
/// `None`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Model {
    /// From sent to valve, s.
    pub dead_time_s: f64,
    /// Of the joint's speed, s.
    pub time_constant_s: f64,
    /// Wanted speed per position error, 1/s.
    pub position_gain_1_s: f64,
    /// Growth of the wanted speed per position error, 1/s².
    pub integral_gain_1_s2: f64,
    /// Largest integral part of the wanted speed either way, rad/s; `None` where no data showed one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub integral_limit_rad_s: Option<f64>,
    /// Wanted speed per sent speed.
    pub feed_forward: f64,
    /// Logarithm of the ratio of the gains for growing and shrinking angles.
    pub asymmetry: f64,
    /// Half width, rad/s.
    pub dead_band_rad_s: f64,
    /// Middle of the dead band, rad/s.
    pub dead_band_centre_rad_s: f64,
    /// Wanted speed beyond the dead band that is needed to leave rest, rad/s.
    pub stiction_rad_s: f64,
    /// Measured angle less the one that the loop sees, rad.
    pub offset_rad: f64,
    /// Lowest and highest angle that the gain is known for, rad; beyond them it stays.
    pub pose_rad: [f64; 2],
    /// Growth of the gain's logarithm with the angle, from the middle of the known angles, 1/rad.
    pub pose_slope_1_rad: f64,
    /// The same of half the asymmetry, 1/rad.
    pub pose_asymmetry_1_rad: f64,
    /// Growth of the gain's logarithm with the square of the angle, 1/rad².
    pub pose_curve_1_rad2: f64,
    /// Largest speeds, rad/s.
    #[serde(with = "limits")]
    #[cfg_attr(test, schemars(with = "[Option<f64>; 2]"))]
    pub speed_limit_rad_s: [Option<f64>; 2],
    /// Largest changes of speed, rad/s².
    #[serde(with = "limits")]
    #[cfg_attr(test, schemars(with = "[Option<f64>; 2]"))]
    pub acceleration_limit_rad_s2: [Option<f64>; 2],
    /// Half width of the play of the valve's spool behind what is wanted, rad/s.
    #[serde(default)]
    pub hysteresis_rad_s: f64,
    /// What is wanted beyond the dead band, rad/s, at which the edges of the valve pass half of their share; 0 where
    /// speed grows in proportion.
    #[serde(default)]
    pub edge_rad_s: f64,
    /// Time constant of a filter of the set values before the loop, s; 0 without one.
    #[serde(default)]
    pub set_value_filter_s: f64,
    /// Delay of the set values before the loop, or of the stamps of measured angles, s.
    #[serde(default)]
    pub set_value_delay_s: f64,
    /// How far the valve opens beyond what the largest speeds take, as a share of that; 0 where it opens no farther.
    #[serde(default)]
    pub opens_beyond: f64,
    /// Natural frequency of a joint that swings between valve and sensor, rad/s; 0 where none shows.
    #[serde(default)]
    pub natural_frequency_rad_s: f64,
    /// Its damping, as a share of the critical one.
    #[serde(default)]
    pub damping_ratio: f64,
    /// Full width of the play before the sensor, rad.
    pub backlash_rad: f64,
}

impl Model {
    /// A joint that is where it is sent, within a step: what is predicted where no model holds.
    pub(super) const FOLLOWS: Self = Self {
        dead_time_s: 0.0,
        time_constant_s: 0.0,
        position_gain_1_s: 10.0,
        integral_gain_1_s2: 0.0,
        integral_limit_rad_s: None,
        feed_forward: 1.0,
        asymmetry: 0.0,
        dead_band_rad_s: 0.0,
        dead_band_centre_rad_s: 0.0,
        stiction_rad_s: 0.0,
        offset_rad: 0.0,
        pose_rad: [0.0; 2],
        pose_slope_1_rad: 0.0,
        pose_asymmetry_1_rad: 0.0,
        pose_curve_1_rad2: 0.0,
        speed_limit_rad_s: [None; 2],
        acceleration_limit_rad_s2: [None; 2],
        hysteresis_rad_s: 0.0,
        edge_rad_s: 0.0,
        set_value_filter_s: 0.0,
        set_value_delay_s: 0.0,
        opens_beyond: 0.0,
        natural_frequency_rad_s: 0.0,
        damping_ratio: 0.0,
        backlash_rad: 0.0,
    };

    /// Holds every number to what it may be.
    ///
    /// # Errors
    ///
    /// [`FitError::Value`], naming the joint.
    pub fn check(&self, joint: &str) -> Result<(), FitError> {
        let positive = [
            ("dead_time_s", self.dead_time_s),
            ("time_constant_s", self.time_constant_s),
            ("position_gain_1_s", self.position_gain_1_s),
            ("integral_gain_1_s2", self.integral_gain_1_s2),
            ("integral_limit_rad_s", self.integral_limit_rad_s.unwrap_or_default()),
            ("feed_forward", self.feed_forward),
            ("dead_band_rad_s", self.dead_band_rad_s),
            ("stiction_rad_s", self.stiction_rad_s),
            ("hysteresis_rad_s", self.hysteresis_rad_s),
            ("edge_rad_s", self.edge_rad_s),
            ("set_value_filter_s", self.set_value_filter_s),
            ("set_value_delay_s", self.set_value_delay_s),
            ("opens_beyond", self.opens_beyond),
            ("natural_frequency_rad_s", self.natural_frequency_rad_s),
            ("damping_ratio", self.damping_ratio),
            ("backlash_rad", self.backlash_rad),
        ];
        let limits = [
            ("speed_limit_rad_s", self.speed_limit_rad_s),
            ("acceleration_limit_rad_s2", self.acceleration_limit_rad_s2),
        ];
        let limits = limits.iter().flat_map(|(key, pair)| pair.iter().flatten().map(|limit| (*key, *limit)));
        let any = [
            ("asymmetry", self.asymmetry),
            ("dead_band_centre_rad_s", self.dead_band_centre_rad_s),
            ("offset_rad", self.offset_rad),
            ("pose_rad", self.pose_rad[0]),
            ("pose_rad", self.pose_rad[1]),
            ("pose_slope_1_rad", self.pose_slope_1_rad),
            ("pose_asymmetry_1_rad", self.pose_asymmetry_1_rad),
            ("pose_curve_1_rad2", self.pose_curve_1_rad2),
        ];
        let bad = positive
            .into_iter()
            .chain(limits)
            .map(|(key, found)| (key, found, 0.0))
            .chain(any.into_iter().map(|(key, found)| (key, found, -MOST)))
            .find(|&(_, found, least)| !(found >= least && found <= MOST));
        match bad {
            None => Ok(()),
            Some((key, found, least)) => {
                Err(FitError::Value { joint: joint.to_owned(), key, found, least, most: MOST })
            }
        }
    }

    /// What must be wanted before the joint leaves rest: dead band, hysteresis and stiction, rad/s.
    pub(super) fn leaves_rest_rad_s(&self) -> f64 {
        self.dead_band_rad_s + self.hysteresis_rad_s + self.stiction_rad_s
    }

    /// How late the loop asks for what is sent, s.
    pub fn set_values_late_s(&self) -> f64 {
        self.set_value_delay_s + self.set_value_filter_s
    }

    /// What passes between a change of the speed that the loop wants and half of its effect, s: dead time, time
    /// constant, swing and half a step of the loop. What delays set values comes before that.
    pub fn lag_s(&self) -> f64 {
        self.dead_time_s + self.time_constant_s + self.swing_s() + 0.5 * STEP_S
    }

    /// The model without its swing, as far behind.
    pub(super) fn calmed(&self) -> Self {
        Self {
            dead_time_s: self.dead_time_s + self.swing_s(),
            natural_frequency_rad_s: 0.0,
            damping_ratio: 0.0,
            ..*self
        }
    }

    /// Whether the joint swings between valve and sensor.
    pub fn swings(&self) -> bool {
        self.natural_frequency_rad_s > 0.0
    }

    /// How far a joint that swings is behind where it moves evenly, s.
    pub(super) fn swing_s(&self) -> f64 {
        if self.swings() { 2.0 * self.damping_ratio / self.natural_frequency_rad_s } else { 0.0 }
    }
}

/// No number of a model is larger.
const MOST: f64 = 1e4;

/// Limits in files, in which infinity stands for one that no data showed: TOML has no null in arrays.
mod limits {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(super) fn serialize<S: Serializer>(limits: &[Option<f64>; 2], to: S) -> Result<S::Ok, S::Error> {
        limits.map(|limit| limit.unwrap_or(f64::INFINITY)).serialize(to)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<[Option<f64>; 2], D::Error> {
        // JSON writes infinity as null. What is no number is told by the check.
        let limits = <[Option<f64>; 2]>::deserialize(from)?;
        Ok(limits.map(|limit| limit.filter(|limit| *limit != f64::INFINITY)))
    }
}
