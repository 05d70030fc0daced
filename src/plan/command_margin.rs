//! How near something sent by samples comes to the limits, as a controller interpolates it.

use super::{Limit, Margin, Setup};
use crate::{
    math::{State, cubic, linear, quintic},
    series::JointKind,
};

/// What a controller makes of samples: those of the ROS 2 joint trajectory controller by what a point holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpolation {
    /// Positions: straight lines, whose accelerations and jerks nobody can keep to a limit.
    Linear,
    /// Positions and velocities.
    Cubic,
    /// Positions, velocities and accelerations.
    Quintic,
}

impl Interpolation {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Linear, Self::Cubic, Self::Quintic];

    fn at(self, a: State, b: State, span_s: f64, at_s: f64) -> State {
        match self {
            Self::Linear => linear(a.position, b.position, span_s, at_s),
            Self::Cubic => cubic(a, b, span_s, at_s),
            Self::Quintic => quintic(a, b, span_s, at_s),
        }
    }

    /// Coefficients of the powers of the share of the way from `a` to `b`.
    fn powers(self, a: State, b: State, span_s: f64) -> [f64; 6] {
        let rise = b.position - a.position;
        let (v0, v1) = (a.velocity * span_s, b.velocity * span_s);
        let (a0, a1) = (a.acceleration * span_s * span_s, b.acceleration * span_s * span_s);
        match self {
            Self::Linear => [a.position, rise, 0.0, 0.0, 0.0, 0.0],
            Self::Cubic => [a.position, v0, 3.0 * rise - 2.0 * v0 - v1, v0 + v1 - 2.0 * rise, 0.0, 0.0],
            Self::Quintic => [
                a.position,
                v0,
                0.5 * a0,
                10.0 * rise - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1,
                -15.0 * rise + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1,
                6.0 * rise - 3.0 * (v0 + v1) - 0.5 * a0 + 0.5 * a1,
            ],
        }
    }
}

/// Bounds above this share of a limit are looked at more closely.
const NEAR: f64 = 0.98;

const PARTS: f64 = 8.0;

/// Bounds of a polynomial, by powers, between 0 and 1: least and largest of its Bernstein coefficients.
fn bounds(powers: &[f64]) -> [f64; 2] {
    const CHOICES: [[f64; 6]; 6] = [
        [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [1.0, 1.0, 0.0, 0.0, 0.0, 0.0],
        [1.0, 2.0, 1.0, 0.0, 0.0, 0.0],
        [1.0, 3.0, 3.0, 1.0, 0.0, 0.0],
        [1.0, 4.0, 6.0, 4.0, 1.0, 0.0],
        [1.0, 5.0, 10.0, 10.0, 5.0, 1.0],
    ];
    let degree = powers.len() - 1;
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for chosen in CHOICES.iter().take(degree + 1) {
        let value: f64 =
            powers.iter().zip(chosen).zip(&CHOICES[degree]).map(|((power, a), b)| power * a / b).sum();
        (least, most) = (least.min(value), most.max(value));
    }
    [least, most]
}

/// The same by eight parts of the way, where the whole comes near a limit: sixty-four times nearer to the truth.
fn near_bounds(powers: &[f64]) -> [f64; 2] {
    let part = 1.0 / PARTS;
    let of = |from: f64| {
        // Powers of u in p(from + part u), by Taylor's theorem.
        let (mut derivative, mut scale) = (powers.to_vec(), 1.0);
        let mut shifted = Vec::with_capacity(powers.len());
        for k in 0..powers.len() {
            let value = derivative.iter().rev().fold(0.0, |sum, c| sum * from + c);
            shifted.push(value * scale);
            derivative = derived(&derivative, 1.0);
            scale *= part / (k + 1) as f64;
        }
        bounds(&shifted)
    };
    let all = (0_u32..8).map(|k| of(f64::from(k) * part));
    all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], [least, most]| {
        [low.min(least), high.max(most)]
    })
}

/// The derivative of a polynomial by powers.
fn derived(powers: &[f64], span_s: f64) -> Vec<f64> {
    powers.iter().enumerate().skip(1).map(|(k, c)| k as f64 * c / span_s).collect()
}

impl Setup {
    /// Margins of what is sent to the joints: angles, speeds, accelerations and jerks by bounds that no instant between
    /// the samples exceeds, rod speeds, pump flow and tool speed at the samples and midway. Nothing is said of torques,
    /// which a command does not have.
    ///
    /// `sent`: states every `step_s`, by joint of the arm.
    pub fn command_margins(&self, sent: &[Vec<State>], step_s: f64, how: Interpolation) -> Vec<Margin> {
        let mut tops = Tops::default();
        let count = sent.iter().map(Vec::len).min().unwrap_or_default();
        let joints = self.limits.len().min(sent.len());
        let (mut angle_rad, mut speed_rad_s) = (vec![0.0; joints], vec![0.0; joints]);
        for k in 1..count {
            let t_s = (k - 1) as f64 * step_s;
            for (j, states) in sent.iter().enumerate().take(joints) {
                let powers = how.powers(states[k - 1], states[k], step_s);
                self.joint_margins(j, powers, (t_s, step_s), how, &mut tops);
            }
            for at_s in [0.0, 0.5 * step_s] {
                for (states, (angle, speed)) in sent.iter().zip(angle_rad.iter_mut().zip(&mut speed_rad_s)) {
                    let now = how.at(states[k - 1], states[k], step_s, at_s);
                    (*angle, *speed) = (now.position, now.velocity);
                }
                self.arm_margins(&angle_rad, &speed_rad_s, t_s + at_s, &mut tops);
            }
        }
        for margin in &mut tops.0 {
            margin.kind = self.kind(margin.joint);
        }
        tops.0
    }

    fn joint_margins(
        &self,
        j: usize,
        powers: [f64; 6],
        (t_s, step_s): (f64, f64),
        how: Interpolation,
        tops: &mut Tops,
    ) {
        let limits = &self.limits[j];
        let degree = match how {
            Interpolation::Linear => 1,
            Interpolation::Cubic => 3,
            Interpolation::Quintic => 5,
        };
        let mut polynomial = powers[..=degree].to_vec();
        let [low, high] = limits.range_rad;
        let (middle, half) = limits.range().unwrap_or((0.0, f64::INFINITY));
        for angle_rad in bounds(&polynomial) {
            let end = if angle_rad < middle { low } else { high };
            let allowed = if half.is_finite() { end } else { half };
            tops.note(Limit::Position, Some(j), angle_rad, allowed, (angle_rad - middle).abs() / half, t_s);
        }
        let derivatives = [
            (Limit::Speed, limits.speed_rad_s),
            (Limit::Acceleration, limits.acceleration()),
            (Limit::Jerk, limits.jerk()),
        ];
        for (limit, most) in derivatives.into_iter().take(degree) {
            polynomial = derived(&polynomial, step_s);
            let mut found = bounds(&polynomial);
            let of = |value: f64| most[usize::from(value > 0.0)].abs();
            if found.iter().any(|value| value.abs() > NEAR * of(*value)) {
                found = near_bounds(&polynomial);
            }
            for value in found {
                tops.note(limit, Some(j), value, of(value), value.abs() / of(value), t_s);
            }
        }
    }

    fn arm_margins(&self, angle_rad: &[f64], speed_rad_s: &[f64], t_s: f64, tops: &mut Tops) {
        let mut flow_m3_s = 0.0;
        let cylinders = self.arm.hydraulics.cylinders().iter().zip(&self.limits);
        for (j, ((cylinder, limits), (angle, speed))) in
            cylinders.zip(angle_rad.iter().zip(speed_rad_s)).enumerate()
        {
            let Some(cylinder) = cylinder else { continue };
            let (sin, cos) = angle.sin_cos();
            let found = cylinder.actuation((sin, cos), *speed, 0.0);
            let [extend_m_s, retract_m_s] = limits.rod_speed_m_s;
            let most = if found.rod_speed_m_s > 0.0 { extend_m_s } else { retract_m_s };
            let share = found.rod_speed_m_s.abs() / most;
            tops.note(Limit::RodSpeed, Some(j), found.rod_speed_m_s, most, share, t_s);
            flow_m3_s += found.flow_m3_s;
        }
        let pump_m3_s = self.arm.hydraulics.pump_flow_m3_s();
        tops.note(Limit::PumpFlow, None, flow_m3_s, pump_m3_s, flow_m3_s / pump_m3_s, t_s);
        if self.tool_speed_m_s.is_finite() {
            let speed_m_s = self.arm.chain.tool_speed_m_s(angle_rad, speed_rad_s);
            let share = speed_m_s / self.tool_speed_m_s;
            tops.note(Limit::ToolSpeed, None, speed_m_s, self.tool_speed_m_s, share, t_s);
        }
    }

    /// Lowest and highest angle, rad, speed, rad/s, acceleration, rad/s², and jerk, rad/s³, of a joint; infinite without limits.
    pub fn joint_limits(&self, joint: usize) -> Option<[[f64; 2]; 4]> {
        let limits = self.limits.get(joint)?;
        Some([limits.range_rad, limits.speed_rad_s, limits.acceleration(), limits.jerk()])
    }
}

/// The nearest margin of each limit.
#[derive(Default)]
struct Tops(Vec<Margin>);

impl Tops {
    fn note(&mut self, limit: Limit, joint: Option<usize>, value: f64, allowed: f64, share: f64, t_s: f64) {
        if !allowed.is_finite() {
            return;
        }
        let found = Margin { limit, joint, kind: JointKind::default(), value, allowed, share, t_s };
        match self.0.iter_mut().find(|top| (top.limit, top.joint) == (limit, joint)) {
            Some(top) if top.share >= share => {}
            Some(top) => *top = found,
            None => self.0.push(found),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_hold_every_value_between_the_samples_and_are_near_them() {
        let a = State { position: 0.3, velocity: -0.7, acceleration: 2.0 };
        let b = State { position: 0.31, velocity: 0.4, acceleration: -1.0 };
        for how in Interpolation::ALL {
            let powers = how.powers(a, b, 0.04);
            let mut polynomial = powers.to_vec();
            for derivative in 0..3 {
                let [low, high] = bounds(&polynomial);
                let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
                for step in 0..=400 {
                    let state = how.at(a, b, 0.04, 0.04 * f64::from(step) / 400.0);
                    let value = [state.position, state.velocity, state.acceleration][derivative];
                    (least, most) = (least.min(value), most.max(value));
                }
                let [near_low, near_high] = near_bounds(&polynomial);
                assert!(low <= near_low + 1e-9 && near_low <= least + 1e-9, "{low} {near_low} {least}");
                assert!(high >= near_high - 1e-9 && near_high >= most - 1e-9, "{high} {near_high} {most}");
                assert!((near_high - most).max(least - near_low) <= 1e-9 + 0.1 * (most - least));
                let slack = 1e-9 + 3.0 * (most - least);
                assert!(low <= least + 1e-9 && low > least - slack, "{how:?} {derivative}: {low} {least}");
                assert!(high >= most - 1e-9 && high < most + slack, "{how:?} {derivative}: {high} {most}");
                polynomial = derived(&polynomial, 0.04);
            }
        }
    }
}
