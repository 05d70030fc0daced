//! How a joint of the sample machine follows its plan.
//!
//! Not the hydraulic plant: no oil, no load, no neighbouring joint. A position loop drives a
//! valve with a dead-band, the joint takes up the speed with a lag, and out of standstill
//! everything is late by a dead time. That is enough for a joint that sticks, jumps and catches
//! up, and every number of it is known.

use hydrotrace::units::DEGREE_RAD;

use super::plan::{DURATION_S, JointPlan};

/// Time step of the simulation, s.
pub(crate) const STEP_S: f64 = 1e-3;

/// A plan asks a joint to move as long as its speed exceeds this, rad/s.
pub(crate) const ASKED_RAD_S: f64 = 0.05 * DEGREE_RAD;

/// A joint slower than this sticks once nothing asks it to go on, rad/s.
const STICKS_RAD_S: f64 = 0.05 * DEGREE_RAD;

/// For so long after a start, at most, its peak error is looked for, s.
pub(crate) const WINDOW_S: f64 = 4.0;

/// One joint of the machine.
#[derive(Debug, Clone, Copy)]
#[expect(clippy::struct_field_names, reason = "names end in units")]
pub(crate) struct Joint {
    /// Time from being asked to leaving standstill, s, towards larger and towards smaller angles.
    pub(crate) dead_time_s: [f64; 2],
    /// Lag of the speed behind the opening of the valve, s.
    pub(crate) lag_s: f64,
    /// Half width of the band in which the valve lets nothing through, as commanded speed, rad/s.
    pub(crate) dead_band_rad_s: f64,
    /// Gain of the position loop, 1/s.
    pub(crate) gain_1_s: f64,
}

/// Integral gain of the position loop, 1/s². It works only while the plan moves.
pub(crate) const INTEGRAL_GAIN_1_S2: f64 = 0.2;

/// Pressure builds up while a joint sticks; what it is late by then becomes extra speed, 1/s.
pub(crate) const JUMP_1_S: f64 = 8.0;

const fn joint(dead_time_s: [f64; 2], lag_s: f64, dead_band_deg_s: f64, gain_1_s: f64) -> Joint {
    Joint { dead_time_s, lag_s, dead_band_rad_s: dead_band_deg_s * DEGREE_RAD, gain_1_s }
}

/// `joint_1` to `joint_6`.
pub(crate) const JOINTS: [Joint; 6] = [
    joint([0.16, 0.18], 0.060, 0.50, 1.5),
    joint([0.15, 0.17], 0.055, 0.48, 1.5),
    joint([0.25, 0.22], 0.070, 1.15, 2.3),
    joint([0.13, 0.15], 0.045, 0.42, 1.5),
    joint([0.12, 0.14], 0.035, 0.40, 1.4),
    joint([0.14, 0.13], 0.040, 0.44, 1.5),
];

/// One departure of a joint from standstill; times since the start of the run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Start {
    /// When the plan's speed began to exceed [`ASKED_RAD_S`], s.
    pub(crate) asked_s: f64,
    /// When the joint left standstill, s.
    pub(crate) leaves_s: f64,
    /// Plan minus angle where it is largest in size, until the next start or for [`WINDOW_S`], rad.
    pub(crate) peak_rad: f64,
}

/// What a joint did.
#[derive(Debug, Clone)]
pub(crate) struct Motion {
    /// Angle at every [`STEP_S`], rad.
    angle_rad: Vec<f64>,
    /// Its departures from standstill, in order.
    pub(crate) starts: Vec<Start>,
}

impl Motion {
    /// The angle at an instant, rad.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to 0..40 000")]
    pub(crate) fn at(&self, t_s: f64) -> f64 {
        let place = (t_s / STEP_S).clamp(0.0, (self.angle_rad.len() - 2) as f64);
        let (before, part) = (place as usize, place.fract());
        self.angle_rad[before] + part * (self.angle_rad[before + 1] - self.angle_rad[before])
    }
}

/// Runs a joint along its plan. It stands at `offset_rad` from home at first.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "40 000 steps")]
pub(crate) fn follow(plan: &JointPlan, joint: &Joint, offset_rad: f64) -> Motion {
    let steps = (DURATION_S / STEP_S).round() as usize + 1;
    let mut angle_rad = plan.at(0.0).angle_rad + offset_rad;
    let (mut speed_rad_s, mut integral_rad_s) = (0.0_f64, 0.0);
    let mut stuck = true;
    let (mut direction, mut asked_s, mut asked_rad) = (0, 0.0, 0.0);
    let mut motion = Motion { angle_rad: Vec::with_capacity(steps), starts: Vec::new() };
    let mut errors_rad = Vec::with_capacity(steps);
    for step in 0..steps {
        let t_s = step as f64 * STEP_S;
        let planned = plan.at(t_s);
        let error_rad = planned.angle_rad - angle_rad;
        motion.angle_rad.push(angle_rad);
        errors_rad.push(error_rad);

        let asks = planned.speed_rad_s.abs() > ASKED_RAD_S;
        let wanted = if !asks {
            0_i8
        } else if planned.speed_rad_s > 0.0 {
            1
        } else {
            -1
        };
        if wanted != direction {
            (direction, asked_s, asked_rad) = (wanted, t_s, planned.angle_rad);
        }
        let command_rad_s = planned.speed_rad_s + joint.gain_1_s * error_rad + integral_rad_s;
        let valve_rad_s = beyond(command_rad_s, joint.dead_band_rad_s);
        let dead_time_s = joint.dead_time_s[usize::from(wanted < 0)];
        // Half a step keeps rounding from deciding at which step the dead time is over.
        if stuck && valve_rad_s * f64::from(wanted) > 0.0 && t_s - asked_s > dead_time_s - 0.5 * STEP_S {
            stuck = false;
            speed_rad_s = valve_rad_s + JUMP_1_S * (planned.angle_rad - asked_rad);
            motion.starts.push(Start { asked_s, leaves_s: t_s, peak_rad: 0.0 });
        } else if speed_rad_s.abs() < STICKS_RAD_S && speed_rad_s * f64::from(wanted) <= 0.0 {
            stuck = true;
        }
        if stuck {
            (speed_rad_s, integral_rad_s) = (0.0, 0.0);
            continue;
        }
        integral_rad_s = if asks { integral_rad_s + INTEGRAL_GAIN_1_S2 * error_rad * STEP_S } else { 0.0 };
        speed_rad_s += (valve_rad_s - speed_rad_s) / joint.lag_s * STEP_S;
        angle_rad += speed_rad_s * STEP_S;
    }
    find_peaks(&mut motion.starts, &errors_rad);
    motion
}

/// What of a command lies beyond a dead-band.
fn beyond(command: f64, half_width: f64) -> f64 {
    command - command.clamp(-half_width, half_width)
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "40 000 steps")]
fn find_peaks(starts: &mut [Start], errors_rad: &[f64]) {
    let step = |t_s: f64| ((t_s / STEP_S).round() as usize).min(errors_rad.len());
    for index in 0..starts.len() {
        let asked_s = starts[index].asked_s;
        let next_s = starts.get(index + 1).map_or(DURATION_S, |next| next.asked_s);
        let window = &errors_rad[step(asked_s)..step(next_s.min(asked_s + WINDOW_S))];
        let peak_rad = window.iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs()));
        starts[index].peak_rad = peak_rad.unwrap_or(0.0);
    }
}
