//! Speeds that rods, pump and tool leave to a command, where it asks them for more than they give.

use super::Setup;
use crate::math::State;

/// What is asked for is brought below this share of a limit.
const AIM: f64 = 0.995;

/// Lowest and highest speed, rad/s, by joint and step.
pub type SpeedRoom = Vec<Vec<[f64; 2]>>;

impl Setup {
    /// Narrows `room` at each step at which what is sent breaks a limit of rods, pump or tool: what they give beyond the plan is dealt
    /// among the joints by what each asked for. `false` if nothing is broken.
    ///
    /// `planned` and `sent`: states by joint of the arm and step; `room`: of as many joints and steps.
    pub fn narrow(&self, planned: &[Vec<State>], sent: &[Vec<State>], room: &mut SpeedRoom) -> bool {
        let joints = self.limits.len().min(planned.len()).min(sent.len()).min(room.len());
        let steps = sent.iter().chain(planned).map(Vec::len).min().unwrap_or_default();
        let mut narrowed = false;
        for k in 0..steps {
            let at =
                |states: &[Vec<State>]| -> Vec<State> { states.iter().take(joints).map(|s| s[k]).collect() };
            let step = Step { planned: at(planned), sent: at(sent) };
            let found = [Some(self.rods(&step)), self.pump(&step), self.tool(&step)];
            for (j, share) in found.iter().flatten().flatten() {
                let [least, most] = &mut room[*j][k];
                let (own, asked) = (step.planned[*j].velocity, step.sent[*j].velocity);
                let bound = own + share * (asked - own);
                if asked > own {
                    *most = most.min(bound);
                } else {
                    *least = least.max(bound);
                }
                narrowed = true;
            }
        }
        narrowed
    }

    /// Joints whose rod is too fast, with the share of the correction's speed that it can follow.
    fn rods(&self, step: &Step) -> Vec<(usize, f64)> {
        let cylinders = self.arm.hydraulics.cylinders().iter().zip(&self.limits).enumerate();
        let found = cylinders.filter_map(|(j, (cylinder, limits))| {
            let speed_m_s = |state: &State| {
                let (sin, cos) = state.position.sin_cos();
                Some(cylinder.as_ref()?.actuation((sin, cos), state.velocity, 0.0).rod_speed_m_s)
            };
            let (own, asked) = (speed_m_s(step.planned.get(j)?)?, speed_m_s(step.sent.get(j)?)?);
            let [extend_m_s, retract_m_s] = limits.rod_speed_m_s;
            let most = AIM * if asked > 0.0 { extend_m_s } else { retract_m_s };
            over(asked.abs(), own.abs(), most, (asked - own).abs()).map(|share| (j, share))
        });
        found.collect()
    }

    fn pump(&self, step: &Step) -> Option<Vec<(usize, f64)>> {
        let most_m3_s = AIM * self.arm.hydraulics.pump_flow_m3_s();
        let flows = |states: &[State]| -> Vec<f64> {
            let of = |(cylinder, state): (&Option<_>, &State)| flow_m3_s(cylinder.as_ref(), state);
            self.arm.hydraulics.cylinders().iter().zip(states).map(of).collect()
        };
        dealt(&flows(&step.planned), &flows(&step.sent), most_m3_s)
    }

    fn tool(&self, step: &Step) -> Option<Vec<(usize, f64)>> {
        if !self.tool_speed_m_s.is_finite() {
            return None;
        }
        let angle_rad: Vec<f64> = step.sent.iter().map(|state| state.position).collect();
        let mut speed_rad_s: Vec<f64> = step.planned.iter().map(|state| state.velocity).collect();
        let own = self.arm.chain.tool_speed_m_s(&angle_rad, &speed_rad_s);
        let sent_rad_s: Vec<f64> = step.sent.iter().map(|state| state.velocity).collect();
        let asked = self.arm.chain.tool_speed_m_s(&angle_rad, &sent_rad_s);
        let most = AIM * self.tool_speed_m_s;
        if asked <= self.tool_speed_m_s {
            return None;
        }
        // What each joint's correction does alone.
        let alone: Vec<f64> = (0..step.sent.len())
            .map(|j| {
                let planned = std::mem::replace(&mut speed_rad_s[j], sent_rad_s[j]);
                let speed_m_s = self.arm.chain.tool_speed_m_s(&angle_rad, &speed_rad_s);
                speed_rad_s[j] = planned;
                speed_m_s - own
            })
            .collect();
        Some(share_of(&alone, own, most))
    }
}

/// One step of all joints.
struct Step {
    planned: Vec<State>,
    sent: Vec<State>,
}

fn flow_m3_s(cylinder: Option<&crate::arm::Cylinder>, state: &State) -> f64 {
    let (sin, cos) = state.position.sin_cos();
    cylinder.map_or(0.0, |cylinder| cylinder.actuation((sin, cos), state.velocity, 0.0).flow_m3_s)
}

/// Share of a correction that stays below a limit; `None` if it is kept, or not by the correction that it is broken.
fn over(asked: f64, own: f64, most: f64, correction: f64) -> Option<f64> {
    (asked * AIM > most && asked > own && correction > 0.0)
        .then(|| ((most - own) / (asked - own)).clamp(0.0, 1.0))
}

/// Joints that ask for more of a sum than their plan, with the share that they get.
fn dealt(own: &[f64], asked: &[f64], most: f64) -> Option<Vec<(usize, f64)>> {
    let total: f64 = asked.iter().sum();
    if total * AIM <= most {
        return None;
    }
    let more: Vec<f64> = asked.iter().zip(own).map(|(asked, own)| asked - own).collect();
    Some(share_of(&more, own.iter().sum(), most))
}

fn share_of(more: &[f64], own: f64, most: f64) -> Vec<(usize, f64)> {
    let sum: f64 = more.iter().map(|more| more.max(0.0)).sum();
    let share = if sum > 0.0 { ((most - own) / sum).clamp(0.0, 1.0) } else { 0.0 };
    more.iter().enumerate().filter(|(_, more)| **more > 0.0).map(|(j, _)| (j, share)).collect()
}
