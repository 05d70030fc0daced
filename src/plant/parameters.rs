//! Everything that makes one machine differ from another, beyond its arm and its cylinders.

use serde::{Deserialize, Serialize};

/// Numbers of a whole machine. [`Plant::new`](super::Plant::new) checks them; the default, all zero, is none.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// What people call it.
    pub title: String,
    /// The pump that all joints share, and its oil.
    pub supply: Supply,
    /// The digital loop and the log.
    pub cycle: Cycle,
    /// One entry a joint, in the order of the arm.
    pub joints: Vec<JointParameters>,
}

/// The shared pump, the line behind it, and the oil of the whole machine.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Supply {
    /// Pressure at which the pump gives nothing, Pa.
    pub pressure_pa: f64,
    /// Pressure behind the valves, Pa.
    pub return_pressure_pa: f64,
    /// Largest flow of the pump, m³/s.
    pub flow_m3_s: f64,
    /// The pump gives its largest flow once the pressure has fallen by this, Pa.
    pub droop_pa: f64,
    /// Oil between pump and valves, m³.
    pub volume_m3: f64,
    /// Of the oil with the air in it and the hoses around it, Pa.
    pub bulk_modulus_pa: f64,
}

/// Timing of the loop and of the log.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Cycle {
    /// Of loop and log; a multiple of [`STEP_S`](super::STEP_S), s.
    pub period_s: f64,
    /// Time constant with which the driver smooths the differences of angles to a speed, s.
    pub speed_filter_s: f64,
    /// Standard deviation of the instants at which the log takes its samples, s.
    pub jitter_s: f64,
    /// Share of the log's samples that get lost.
    pub loss: f64,
    /// How long the arm takes to take over a new payload, s.
    pub payload_ramp_s: f64,
    /// Set values reach the loop this often and are held in between; 0: with every turn, s.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub set_value_period_s: f64,
    /// Each comes late by a random time of up to this, none before an earlier one, s.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub set_value_jitter_s: f64,
    /// All come late by this, s.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub set_value_delay_s: f64,
}

/// Structures that a machine lacks stay out of its JSON, as if there were none.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands out references")]
fn is_zero(value: &f64) -> bool {
    value.abs() < f64::MIN_POSITIVE
}

/// Numbers of one joint.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct JointParameters {
    /// Name of the joint in the arm.
    pub name: String,
    /// The proportional valve.
    pub valve: Valve,
    /// The oil on both sides of the pistons.
    pub chambers: Chambers,
    /// Friction of rods, pistons and bearings, at the rods.
    pub friction: Friction,
    /// What bends between cylinder and sensor.
    #[serde(default, skip_serializing_if = "Link::is_rigid")]
    pub link: Link,
    /// The position loop.
    pub control: Control,
    /// The angle sensor.
    pub encoder: Encoder,
}

/// A valve with overlap. Signal and spool travel are shares of the full travel; positive extends.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Valve {
    /// From the controller's output to the spool's drive, s.
    pub dead_time_s: f64,
    /// Half width of the play between signal and spool.
    pub hysteresis: f64,
    /// Travel before the ports open for extending.
    pub overlap_extend: f64,
    /// Travel before the ports open for retracting.
    pub overlap_retract: f64,
    /// Time constant of the spool, s.
    pub spool_lag_s: f64,
    /// Largest speed of the spool, full travels a second, 1/s.
    pub spool_slew_1_s: f64,
    /// Flow through one edge by opening and square root of pressure drop, m³/(s √Pa).
    pub flow_gain_m3_s_sqrt_pa: f64,
    /// Edges are metering notches: flow grows with the opening to the power of 1 + this, the same at full opening.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub progression: f64,
    /// Oil leaves a side through a counterbalance valve that begins to open once the pressure of this
    /// side and `counterbalance_pilot_ratio` times that of the other add up to this; 0: none, Pa.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub counterbalance_pa: f64,
    /// Pilot area by relief area.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub counterbalance_pilot_ratio: f64,
    /// The null is off by up to this either way, another amount each run.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub null_drift: f64,
    /// The dead time is off by up to this either way, another amount each run, s.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub dead_time_drift_s: f64,
}

/// The oil on both sides of the pistons of a joint.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Chambers {
    /// Hose and cylinder end on each side, m³.
    pub dead_volume_m3: f64,
    /// Leakage past the piston by pressure difference, m³/(s Pa).
    pub leakage_m3_s_pa: f64,
}

/// `LuGre` friction (Canudas de Wit et al. 1995, doi:10.1109/9.376053).
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Friction {
    /// In motion, without the viscous part, N.
    pub coulomb_n: f64,
    /// What it takes to leave standstill; not below `coulomb_n`, N.
    pub breakaway_n: f64,
    /// Speed at which breakaway has mostly become Coulomb friction, m/s.
    pub stribeck_m_s: f64,
    /// Growth with speed, N s/m.
    pub viscous_n_s_m: f64,
    /// Stiffness of the contact at standstill, N/m.
    pub bristle_stiffness_n_m: f64,
    /// Its damping, N s/m.
    pub bristle_damping_n_s_m: f64,
    /// Coulomb, breakaway and viscous friction are off by up to this share, another each run.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub drift: f64,
}

/// A link that bends: a light mass on a spring, which joint and sensor hang between. What it does
/// to the joint is left out, and each joint bends by itself.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Link {
    /// Its own frequency; 0: rigid, Hz.
    pub frequency_hz: f64,
    /// Share of critical damping.
    pub damping_ratio: f64,
}

impl Link {
    pub(super) fn is_rigid(&self) -> bool {
        is_zero(&self.frequency_hz)
    }
}

/// Position loop with feed-forward of speed and compensation of the valve's overlap:
/// w = `feed_forward` * planned speed + `position_gain` * error + integral,
/// signal = w / `nominal_speed` + compensation * clip(w / `compensation_speed`, ±1).
///
/// A cascade has a speed loop within: w grows by `speed_gain` * (w - speed) and by the integral of
/// `speed_integral_gain` * (w - speed). An axis module has a positioning window: no signal while w
/// is less than what an error of the window's size makes it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Control {
    /// Wanted speed by error, 1/s.
    pub position_gain_1_s: f64,
    /// Growth of the wanted speed by error, 1/s².
    pub integral_gain_1_s2: f64,
    /// Wanted speed by planned speed.
    pub feed_forward: f64,
    /// Speed that the controller expects of a full signal, rad/s.
    pub nominal_speed_rad_s: f64,
    /// Spool travel that the controller adds to get past the overlap.
    pub compensation: f64,
    /// Wanted speed from which on all of it is added, rad/s.
    pub compensation_speed_rad_s: f64,
    /// While the plan rests, an error below this leaves the integral as it is, rad.
    pub freeze_error_rad: f64,
    /// Time constant with which set values are smoothed before the loop, s.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub set_value_filter_s: f64,
    /// Wanted speed by error of the speed.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub speed_gain: f64,
    /// Growth of the wanted speed by error of the speed, 1/s.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub speed_integral_gain_1_s: f64,
    /// Half width of the positioning window, rad.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub window_rad: f64,
}

/// An angle sensor behind a joint with play.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Encoder {
    /// Full width of the play between cylinder and sensor, rad.
    pub backlash_rad: f64,
    /// Standard deviation of white noise, rad.
    pub noise_rad: f64,
    /// What one count stands for, rad.
    pub count_rad: f64,
}
