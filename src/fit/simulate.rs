//! The response of a model, step by step.

use multiversion::multiversion;

use super::model::{Model, STEP_S};
use crate::units::DEGREE_RAD;

/// Speed over which stiction fades, rad/s.
const FADE_RAD_S: f64 = 0.15 * DEGREE_RAD;

/// While the sent angle rests, an error below this leaves the integral as it is, rad.
const FREEZE_RAD: f64 = 0.08 * DEGREE_RAD;

/// No joint is faster, rad/s or m/s: the response of an unstable loop stays a number.
const FASTEST_RAD_S: f64 = 50.0;

/// No joint swings faster, rad/s: steps tell no more.
const FASTEST_SWING_RAD_S: f64 = 60.0;

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
    lanes([model], sent, [start], wanted, measured_rad);
    come_late([model], measured_rad);
}

/// Models that are simulated side by side: chains of dependent operations of one leave a processor idle.
pub(super) const LANES: usize = 8;

/// As [`simulate`], of several models: their angles alternate. Widths differ in speed, not in results.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
pub(super) fn simulate_lanes(
    models: [&Model; LANES],
    sent: &[(f64, f64)],
    start: [Start; LANES],
    wanted: &mut Vec<f64>,
    measured_rad: &mut Vec<f64>,
) {
    lanes(models, sent, start, wanted, measured_rad);
    come_late(models, measured_rad);
}

#[inline(always)]
fn lanes<const N: usize>(
    models: [&Model; N],
    sent: &[(f64, f64)],
    start: [Start; N],
    wanted: &mut Vec<f64>,
    measured_rad: &mut Vec<f64>,
) {
    wanted.clear();
    measured_rad.clear();
    let of = |number: fn(&Model) -> f64| models.map(number);
    let (feed_forward, position_gain) = (of(|m| m.feed_forward), of(|m| m.position_gain_1_s));
    let (integral_step, offset) = (of(|m| m.integral_gain_1_s2 * STEP_S), of(|m| m.offset_rad));
    let integral_most = of(|m| m.integral_limit_rad_s.unwrap_or(f64::INFINITY));
    let up = of(|m| m.dead_band_centre_rad_s + m.dead_band_rad_s);
    let down = of(|m| m.dead_band_centre_rad_s - m.dead_band_rad_s);
    let (lowest, highest) = (of(|m| m.pose_rad[0]), of(|m| m.pose_rad[1]));
    let (slope, curve) = (of(|m| m.pose_slope_1_rad), of(|m| m.pose_curve_1_rad2));
    let (asymmetry, bent) = (of(|m| 0.5 * m.asymmetry), of(|m| m.pose_asymmetry_1_rad));
    let fastest = of(|m| m.speed_limit_rad_s[0].unwrap_or(FASTEST_RAD_S));
    let slowest = of(|m| -m.speed_limit_rad_s[1].unwrap_or(FASTEST_RAD_S));
    let opens = of(|m| 1.0 + m.opens_beyond);
    let most = of(|m| m.acceleration_limit_rad_s2[0].unwrap_or(f64::INFINITY) * STEP_S);
    let least = of(|m| -m.acceleration_limit_rad_s2[1].unwrap_or(f64::INFINITY) * STEP_S);
    let approach = of(|m| -(-STEP_S / m.time_constant_s.max(1e-4)).exp_m1());
    let hysteresis = of(|m| m.hysteresis_rad_s);
    let edge = of(|m| m.edge_rad_s);
    let passes =
        of(|m| if m.set_value_filter_s > 0.0 { -(-STEP_S / m.set_value_filter_s).exp_m1() } else { 1.0 });
    let frequency = of(|m| m.natural_frequency_rad_s.min(FASTEST_SWING_RAD_S));
    let pull = frequency.map(|rad_s| rad_s * rad_s * STEP_S);
    let damped: [f64; N] = std::array::from_fn(|i| 2.0 * models[i].damping_ratio * frequency[i] * STEP_S);
    let swings = frequency.iter().any(|rad_s| *rad_s > 0.0);
    let half_play = of(|m| 0.5 * m.backlash_rad);
    let delay = of(|m| m.dead_time_s / STEP_S);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few hundred steps")]
    let whole = delay.map(|steps| steps as usize);
    let part = delay.map(f64::fract);
    let mut angle: [f64; N] = std::array::from_fn(|i| start[i].angle_rad - offset[i]);
    let (mut seen, mut speed) = (angle, start.map(|start| start.speed_rad_s));
    // The speed that the opening of the valve would give without limit.
    let mut opening = speed;
    // The joint's own where it swings, and how that changes.
    let (mut own, mut gains) = (speed, [0.0; N]);
    let mut spool = [0.0; N];
    let mut set = [sent.first().copied().unwrap_or_default(); N];
    let mut integral = start.map(|start| start.integral_rad_s);
    for (k, &(sent_rad, sent_rad_s)) in sent.iter().enumerate() {
        let moves = sent_rad_s.abs() > 0.0;
        let mut wants = [0.0; N];
        for i in 0..N {
            seen[i] = within(seen[i], angle[i] - half_play[i], angle[i] + half_play[i]);
            set[i].0 = filtered(set[i].0, sent_rad, passes[i]);
            set[i].1 = filtered(set[i].1, sent_rad_s, passes[i]);
            let error_rad = set[i].0 - seen[i];
            let grows = moves || error_rad.abs() >= FREEZE_RAD;
            integral[i] += if grows { integral_step[i] * error_rad } else { 0.0 };
            integral[i] = within(integral[i], -integral_most[i], integral_most[i]);
            wants[i] = feed_forward[i] * set[i].1 + position_gain[i] * error_rad + integral[i];
        }
        wanted.extend_from_slice(&wants);
        measured_rad.extend((0..N).map(|i| seen[i] + offset[i]));
        // What arrives beyond the dead band.
        let mut target = [0.0; N];
        for i in 0..N {
            let late = k.saturating_sub(whole[i]);
            let (new, old) = (wanted[late * N + i], wanted[late.saturating_sub(1) * N + i]);
            let arrived = new + part[i] * (old - new);
            spool[i] = within(spool[i], arrived - hysteresis[i], arrived + hysteresis[i]);
            target[i] = within(spool[i] - up[i], 0.0, f64::INFINITY)
                + within(spool[i] - down[i], f64::NEG_INFINITY, 0.0);
        }
        if target.iter().any(|beyond| *beyond != 0.0) {
            for i in 0..N {
                let way = target[i].signum();
                if target[i] != 0.0 && stiction(models[i], way * target[i], way * speed[i]) {
                    target[i] = 0.0;
                }
            }
            for i in 0..N {
                let way = target[i].signum();
                let beyond = way * target[i];
                target[i] *= if edge[i] > 0.0 { beyond / (beyond + edge[i]) } else { 1.0 };
                let off = within(angle[i], lowest[i], highest[i]) - 0.5 * (lowest[i] + highest[i]);
                let exponent = way * (asymmetry[i] + bent[i] * off) + (slope[i] + curve[i] * off) * off;
                target[i] = within(exp(exponent) * target[i], opens[i] * slowest[i], opens[i] * fastest[i]);
            }
        }
        for i in 0..N {
            let before = own[i];
            opening[i] += within(approach[i] * (target[i] - opening[i]), least[i], most[i]);
            speed[i] = within(opening[i], slowest[i], fastest[i]);
            own[i] = speed[i];
            if swings && frequency[i] > 0.0 {
                gains[i] += pull[i] * (speed[i] - before) - damped[i] * gains[i];
                own[i] = before + STEP_S * gains[i];
            }
            angle[i] += 0.5 * STEP_S * (before + own[i]);
        }
    }
}

/// Lets angles come late by the delay of the set values: a loop does the same a while later. The first are those of the start.
fn come_late<const N: usize>(models: [&Model; N], measured_rad: &mut [f64]) {
    for (lane, model) in models.iter().enumerate().filter(|(_, model)| model.set_value_delay_s > 0.0) {
        let steps = model.set_value_delay_s / STEP_S;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few hundred steps")]
        let (whole, part) = (steps as usize, steps.fract());
        for k in (0..measured_rad.len() / N).rev() {
            let late = k.saturating_sub(whole);
            let (new, old) = (measured_rad[late * N + lane], measured_rad[late.saturating_sub(1) * N + lane]);
            measured_rad[k * N + lane] = new + part * (old - new);
        }
    }
}

/// A value on its way to another, of which a share passes; the other itself where all does.
#[inline]
fn filtered(before: f64, to: f64, passes: f64) -> f64 {
    if passes < 1.0 { before + passes * (to - before) } else { to }
}

/// A number held between two; without the care for what is no number of [`f64::clamp`] two instructions.
#[inline]
fn within(x: f64, lowest: f64, highest: f64) -> f64 {
    let x = if x > lowest { x } else { lowest };
    if x < highest { x } else { highest }
}

/// The exponential function to 5e-16 within 20 of 0: a Taylor polynomial, in a form that compilers turn into vectors.
#[inline]
fn exp(x: f64) -> f64 {
    /// Adding it leaves the nearest whole number in the low bits.
    const ROUND: f64 = 1.5 * (1_u64 << 52) as f64;
    /// ln 2 in two parts; the first ends in zeros, so that its products with small whole numbers are exact.
    const LN_2: [f64; 2] = [f64::from_bits(0x3FE6_2E42_FEE0_0000), f64::from_bits(0x3DEA_39EF_3579_3C76)];
    let x = within(x, -20.0, 20.0);
    let shifted = x * std::f64::consts::LOG2_E + ROUND;
    let whole = shifted - ROUND;
    let r = (x - whole * LN_2[0]) - whole * LN_2[1];
    let y = r * r;
    let even = [1.0 / 2.0, 1.0 / 24.0, 1.0 / 720.0, 1.0 / 40_320.0, 1.0 / 3_628_800.0, 1.0 / 479_001_600.0];
    let odd = [1.0 / 6.0, 1.0 / 120.0, 1.0 / 5_040.0, 1.0 / 362_880.0, 1.0 / 39_916_800.0];
    let [even, odd] = [&even[..], &odd].map(|terms| terms.iter().rev().fold(0.0, |sum, term| sum * y + term));
    (1.0 + y * even + r * (1.0 + y * odd)) * f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52)
}

/// Whether a joint stays at rest though `beyond` more than the dead band is wanted.
fn stiction(model: &Model, beyond: f64, speed_rad_s: f64) -> bool {
    if beyond >= model.stiction_rad_s || speed_rad_s > 3.0 * FADE_RAD_S {
        return false;
    }
    let share = speed_rad_s.max(0.0) / FADE_RAD_S;
    beyond < model.stiction_rad_s * (-share * share).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_those_of_the_library() {
        for x in (-2000..=2000).map(|k| f64::from(k) * 0.0103) {
            let truth = x.clamp(-20.0, 20.0).exp();
            assert!((exp(x) - truth).abs() <= 5e-16 * truth, "{x}: {} {truth}", exp(x));
        }
    }
}
