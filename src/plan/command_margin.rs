//! How near something given by samples comes to the limits of angles and speeds.

use super::{Limit, Margin, Setup};
use crate::{
    math::{State, range},
    series::Series,
};

/// Accelerations are differences of speeds over this, s.
const ACCELERATION_S: f64 = 0.05;

impl Setup {
    /// Margins of what is sent to the joints rather than planned: angles, speeds, accelerations (mean
    /// over 0.05 s), rod speeds, pump flow and tool speed, every `step_s` from the first sample to the last. Nothing
    /// is said of torques, which a command does not have. A joint without a track is taken to rest at
    /// its first key point.
    pub fn sampled_margins(&self, sent: &Series, step_s: f64) -> Vec<Margin> {
        let joints = self.joint_count();
        let names = self.joint_names();
        let tracks: Vec<_> = names.iter().map(|name| sent.track(name)).collect();
        let stamps = || tracks.iter().flatten().flat_map(|track| [track.t_s().first(), track.t_s().last()]);
        let [from_s, to_s] = range(stamps().flatten().copied());
        let mut tops: Vec<Margin> = Vec::new();
        let mut note = |limit, joint, value: f64, allowed: f64, share: f64, t_s| {
            if !allowed.is_finite() {
                return;
            }
            let found = Margin { limit, joint, value, allowed, share, t_s };
            match tops.iter_mut().find(|top| (top.limit, top.joint) == (limit, joint)) {
                Some(top) if top.share >= share => {}
                Some(top) => *top = found,
                None => tops.push(found),
            }
        };
        let home = self.template.points().of(0);
        let at = |joint: usize, t_s: f64| {
            let rest = State { position: home[joint], velocity: 0.0, acceleration: 0.0 };
            tracks[joint].map_or(rest, |track| track.held_at(t_s))
        };
        let (mut angle_rad, mut speed_rad_s) = (vec![0.0; joints], vec![0.0; joints]);
        let mut k = 0_u32;
        while from_s + f64::from(k) * step_s <= to_s {
            let t_s = from_s + f64::from(k) * step_s;
            k += 1;
            let mut flow_m3_s = 0.0;
            for (j, limits) in self.limits.iter().enumerate() {
                let now = at(j, t_s);
                (angle_rad[j], speed_rad_s[j]) = (now.position, now.velocity);
                let [low, high] = limits.range_rad;
                let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
                let end = if now.position < middle { low } else { high };
                let share = (now.position - middle).abs() / half;
                note(
                    Limit::Position,
                    Some(j),
                    now.position,
                    if half.is_finite() { end } else { half },
                    share,
                    t_s,
                );
                let speed = now.velocity.abs() / limits.speed_rad_s;
                note(Limit::Speed, Some(j), now.velocity, limits.speed_rad_s, speed, t_s);
                let rise = (now.velocity - at(j, t_s - ACCELERATION_S).velocity) / ACCELERATION_S;
                let share = rise.abs() / limits.acceleration_rad_s2;
                note(Limit::Acceleration, Some(j), rise, limits.acceleration_rad_s2, share, t_s);
                if let Some(cylinder) = &self.arm.hydraulics.cylinders()[j] {
                    let (sin, cos) = now.position.sin_cos();
                    let found = cylinder.actuation((sin, cos), now.velocity, 0.0);
                    let [extend_m_s, retract_m_s] = limits.rod_speed_m_s;
                    let most = if found.rod_speed_m_s > 0.0 { extend_m_s } else { retract_m_s };
                    note(
                        Limit::RodSpeed,
                        Some(j),
                        found.rod_speed_m_s,
                        most,
                        found.rod_speed_m_s.abs() / most,
                        t_s,
                    );
                    flow_m3_s += found.flow_m3_s;
                }
            }
            let pump_m3_s = self.arm.hydraulics.pump_flow_m3_s();
            note(Limit::PumpFlow, None, flow_m3_s, pump_m3_s, flow_m3_s / pump_m3_s, t_s);
            if self.tool_speed_m_s.is_finite() {
                let speed_m_s = self.arm.chain.tool_speed_m_s(&angle_rad, &speed_rad_s);
                let share = speed_m_s / self.tool_speed_m_s;
                note(Limit::ToolSpeed, None, speed_m_s, self.tool_speed_m_s, share, t_s);
            }
        }
        tops
    }
}
