//! The response of a model, step by step.

use super::model::{Model, STEP_S};
use crate::units::DEGREE_RAD;

/// Speed over which stiction fades, rad/s.
const FADE_RAD_S: f64 = 0.15 * DEGREE_RAD;

/// While the sent angle rests, an error below this leaves the integral as it is, rad.
const FREEZE_RAD: f64 = 0.08 * DEGREE_RAD;

/// State in which a run begins.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Start {
    /// Measured angle, rad.
    pub(super) angle_rad: f64,
    /// Its speed, rad/s.
    pub(super) speed_rad_s: f64,
    /// Integral part of the wanted speed, rad/s.
    pub(super) integral_rad_s: f64,
}

impl Start {
    /// At rest where the joint is sent to first.
    pub(super) fn at_rest(model: &Model, sent: &[(f64, f64)]) -> Self {
        let angle_rad = sent.first().map_or(0.0, |sent| sent.0) + model.offset_rad;
        Self { angle_rad, ..Self::default() }
    }
}

/// Answers `sent`, angle and speed every [`STEP_S`], with the measured angle at the same instants.
///
/// `wanted` is room for the speeds that the loop wants; nothing is allocated once it and `measured`
/// are as long as `sent`.
pub(super) fn simulate(
    model: &Model,
    sent: &[(f64, f64)],
    start: Start,
    wanted: &mut Vec<f64>,
    measured_rad: &mut Vec<f64>,
) {
    wanted.clear();
    measured_rad.clear();
    let [lowest, highest] = model.pose_rad;
    let middle = 0.5 * (lowest + highest);
    let gain = |way: f64, angle_rad: f64| {
        let off = angle_rad.max(lowest).min(highest) - middle;
        let bent = model.pose_slope_1_rad + model.pose_curve_1_rad2 * off;
        (way * (0.5 * model.asymmetry + model.pose_asymmetry_1_rad * off) + bent * off).exp()
    };
    let (up, down) = (
        model.dead_band_rad_s + model.dead_band_centre_rad_s,
        -model.dead_band_rad_s + model.dead_band_centre_rad_s,
    );
    let [fastest, slowest] = model.speed_limit_rad_s.map(|limit| limit.unwrap_or(f64::INFINITY));
    let [most, least] =
        model.acceleration_limit_rad_s2.map(|limit| limit.map_or(f64::INFINITY, |limit| limit * STEP_S));
    let approach = -(-STEP_S / model.time_constant_s.max(1e-4)).exp_m1();
    let half_play_rad = 0.5 * model.backlash_rad;
    let integral_step = model.integral_gain_1_s2 * STEP_S;
    let delay = model.dead_time_s / STEP_S;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few hundred steps")]
    let (whole, part) = (delay as usize, delay.fract());
    let mut angle_rad = start.angle_rad - model.offset_rad;
    let mut seen_rad = angle_rad;
    let mut speed_rad_s = start.speed_rad_s;
    let mut integral_rad_s = start.integral_rad_s;
    for (k, &(sent_rad, sent_rad_s)) in sent.iter().enumerate() {
        seen_rad = seen_rad.max(angle_rad - half_play_rad).min(angle_rad + half_play_rad);
        measured_rad.push(seen_rad + model.offset_rad);
        let error_rad = sent_rad - seen_rad;
        if sent_rad_s.abs() > 0.0 || error_rad.abs() >= FREEZE_RAD {
            integral_rad_s += integral_step * error_rad;
        }
        wanted.push(model.feed_forward * sent_rad_s + model.position_gain_1_s * error_rad + integral_rad_s);
        let late = k.saturating_sub(whole);
        let (new, old) = (wanted[late], wanted[late.saturating_sub(1)]);
        let arrived = new + part * (old - new);
        let target = if arrived > up {
            let held = stiction(model, arrived - up, speed_rad_s);
            if held { 0.0 } else { (gain(1.0, angle_rad) * (arrived - up)).min(fastest) }
        } else if arrived < down {
            let held = stiction(model, down - arrived, -speed_rad_s);
            if held { 0.0 } else { (gain(-1.0, angle_rad) * (arrived - down)).max(-slowest) }
        } else {
            0.0
        };
        let before_rad_s = speed_rad_s;
        speed_rad_s += (approach * (target - speed_rad_s)).min(most).max(-least);
        angle_rad += 0.5 * STEP_S * (before_rad_s + speed_rad_s);
    }
}

/// Whether a joint stays at rest though `beyond` more than the dead band is wanted.
fn stiction(model: &Model, beyond: f64, speed_rad_s: f64) -> bool {
    if beyond >= model.stiction_rad_s || speed_rad_s > 3.0 * FADE_RAD_S {
        return false;
    }
    let share = speed_rad_s.max(0.0) / FADE_RAD_S;
    beyond < model.stiction_rad_s * (-share * share).exp()
}
