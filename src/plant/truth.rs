//! What a fit to a log of the machine should find.

use serde::{Deserialize, Serialize};

use super::{Parameters, Plant, PlantError, cylinder::steady_speed_m_s, mechanics::Mechanics};

/// A machine as a fit sees it, and the numbers behind it. Joints in the order of the arm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// The pose in which it holds, rad, `[joint]`.
    pub position_rad: Vec<f64>,
    /// The payload with which it holds, kg.
    pub payload_kg: f64,
    /// The limits.
    pub joints: Vec<JointTruth>,
    /// Everything.
    pub parameters: Parameters,
}

/// Limits of one joint in a pose. Pairs are for growing and for shrinking angles, both positive.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointTruth {
    /// The joint.
    pub name: String,
    /// From the loop's output to the valve, s.
    pub dead_time_s: f64,
    /// Dead time, the spool's time constant and half a period of the loop, s.
    pub lag_s: f64,
    /// Speed that the loop must want before oil flows: past overlap, hysteresis and compensation, rad/s.
    pub dead_band_rad_s: [f64; 2],
    /// Speed at full signal, the other joints at rest, rad/s.
    pub speed_limit_rad_s: [f64; 2],
    /// Change of speed while the spool runs at its slew rate, rad/s².
    pub acceleration_limit_rad_s2: [f64; 2],
    /// Speed by wanted speed beyond the dead band.
    pub gain: [f64; 2],
    /// Of the loop, 1/s.
    pub position_gain_1_s: f64,
    /// Of the loop, 1/s².
    pub integral_gain_1_s2: f64,
    /// Of the loop.
    pub feed_forward: f64,
    /// Full width, rad.
    pub backlash_rad: f64,
    /// Torque that breaks the joint away, N m.
    pub breakaway_n_m: f64,
    /// Inertia that the joint alone accelerates, the others free to give way, kg m².
    pub inertia_kg_m2: f64,
}

impl Plant {
    /// The limits in a pose, rad, with a payload, kg.
    ///
    /// Closed forms of the flow law and of the controller; a pose changes speeds by the lever and
    /// by the weight that the oil must lift.
    ///
    /// # Errors
    ///
    /// [`PlantError::NoCommand`] for a joint that the pose leaves out.
    pub fn truth(&self, position_rad: &[f64], payload_kg: f64) -> Result<Truth, PlantError> {
        if let Some(name) = self.joints().nth(position_rad.len()) {
            return Err(PlantError::NoCommand { joint: name.to_owned(), what: "angle" });
        }
        let mut mechanics = Mechanics::new(self);
        mechanics.look(self, position_rad.iter().map(|&q| (q, 0.0)), payload_kg);
        let joints = (0..self.axes.len()).map(|j| self.joint_truth(j, &mechanics)).collect();
        let position_rad = position_rad.iter().take(self.axes.len()).copied().collect();
        Ok(Truth { position_rad, payload_kg, joints, parameters: self.parameters.clone() })
    }

    fn joint_truth(&self, j: usize, mechanics: &Mechanics) -> JointTruth {
        let (axis, joint) = (&self.axes[j], &self.parameters.joints[j]);
        let (valve, control) = (&joint.valve, &joint.control);
        let lever_m = mechanics.lever_m[j];
        let force_n = mechanics.bias_nm[j] / lever_m;
        // Which way the rod goes for growing and for shrinking angles.
        let ways = [axis.sense, -axis.sense];
        let overlap = ways.map(|way| if way > 0.0 { valve.overlap_extend } else { valve.overlap_retract });
        let speed_at = |way: f64, opening: f64| {
            let parts = (&axis.size, valve, &joint.friction);
            (steady_speed_m_s(parts, &self.parameters.supply, way * valve.port(opening), force_n) / lever_m)
                .abs()
        };
        let both = |of: &dyn Fn(usize) -> f64| [of(0), of(1)];
        // The play keeps the spool short of the full signal.
        let speed_limit_rad_s = both(&|i| speed_at(ways[i], 1.0 - valve.hysteresis - overlap[i]));
        let slope = both(&|i| speed_limit_rad_s[i] / (1.0 - valve.hysteresis - overlap[i]).max(1e-9));
        let cycle = &self.parameters.cycle;
        JointTruth {
            name: joint.name.clone(),
            dead_time_s: valve.dead_time_s,
            lag_s: valve.dead_time_s + valve.spool_lag_s + 0.5 * cycle.period_s,
            dead_band_rad_s: overlap.map(|overlap| {
                let opens_rad_s = control.wanted_rad_s(overlap + valve.hysteresis);
                opens_rad_s.max(control.window_rad_s()) / (1.0 + control.speed_gain)
            }),
            speed_limit_rad_s,
            acceleration_limit_rad_s2: slope.map(|slope| slope * valve.spool_slew_1_s),
            gain: slope.map(|slope| slope / control.nominal_speed_rad_s),
            position_gain_1_s: control.position_gain_1_s,
            integral_gain_1_s2: control.integral_gain_1_s2,
            feed_forward: control.feed_forward,
            backlash_rad: joint.encoder.backlash_rad,
            breakaway_n_m: joint.friction.breakaway_n * lever_m.abs(),
            inertia_kg_m2: 1.0 / mechanics.mobility[j * self.axes.len() + j],
        }
    }
}
