//! Free points between the key points, which give a plan its shape.

use serde::{Deserialize, Serialize};

use super::{PlanError, Setup};
use crate::spline::{Dwell, KeyPoints, Motion};

/// A free point is a key point's own where its time is the key point's to within this, s.
const SAME_S: f64 = 1e-9;
/// Distance of the tool from where a key point has it, m and rad, that rounding in files may make.
const SAME_POSE: f64 = 1e-6;

/// A point that a plan passes between two key points; or, at the very time of a key point of which the task gives the
/// tool alone, the angles that the joints have there. Key points and these, with their times, determine the spline.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Via {
    /// When the arm passes it, s.
    pub t_s: f64,
    /// Positions of the joints, base first, rad, of those that slide m.
    pub position_rad: Vec<f64>,
}

/// A setup with free points as key points.
pub(super) struct Through {
    /// Its template has the times, too.
    pub(super) setup: Setup,
    /// Times of movement from each point to the next, s.
    pub(super) interval_s: Vec<f64>,
}

impl Setup {
    /// The motion that arrives at the key points at these times, s, and passes free points.
    ///
    /// # Errors
    ///
    /// [`PlanError`] as [`Setup::motion`], and for free points that are not on the way, or of another number of joints.
    pub fn motion_through(&self, times_s: &[f64], via: &[Via]) -> Result<Motion, PlanError> {
        if via.is_empty() { self.motion(times_s) } else { Ok(self.through(times_s, via)?.setup.template) }
    }

    pub(super) fn through(&self, times_s: &[f64], via: &[Via]) -> Result<Through, PlanError> {
        self.intervals_s(times_s)?;
        let (points, joints) = (self.template.points(), self.joint_count());
        let mut rest = via.iter().enumerate().peekable();
        let (mut t_s, mut position_rad) = (Vec::new(), Vec::new());
        let (mut dwells, mut dwell_before_s) = (Vec::new(), Vec::new());
        for (point, &arrive_s) in times_s.iter().enumerate() {
            if let Some(length_s) = self.template.dwell_s(point) {
                dwells.push(Dwell { point: t_s.len(), length_s });
            }
            t_s.push(arrive_s);
            let own = rest.next_if(|(_, via)| {
                (via.t_s - arrive_s).abs() < SAME_S && self.may_have(point, &via.position_rad)
            });
            position_rad.extend_from_slice(own.map_or(points.of(point), |(_, via)| &via.position_rad));
            let Some((next_s, dwell_s)) = times_s.get(point + 1).zip(self.dwell_before_s.get(point)) else {
                break;
            };
            dwell_before_s.push(*dwell_s);
            while let Some((_, via)) = rest.next_if(|(_, via)| {
                via.t_s > arrive_s + dwell_s && via.t_s < *next_s && via.position_rad.len() == joints
            }) {
                t_s.push(via.t_s);
                position_rad.extend_from_slice(&via.position_rad);
                dwell_before_s.push(0.0);
            }
        }
        if let Some((index, via)) = rest.next() {
            return Err(PlanError::Via {
                point: index + 1,
                t_s: via.t_s,
                angles: via.position_rad.len(),
                joints,
            });
        }
        let degree = self.template.degree();
        let template = Motion::new(degree, KeyPoints::new(joints, position_rad)?, &self.ends, &dwells, &t_s)?;
        let interval_s =
            t_s.windows(2).zip(&dwell_before_s).map(|(pair, dwell_s)| pair[1] - pair[0] - dwell_s).collect();
        Ok(Through { setup: Self { template, dwell_before_s, ..self.clone() }, interval_s })
    }

    /// Whether a key point may have these angles in place of its own: where the task gives the tool alone, and they
    /// bring it there.
    fn may_have(&self, point: usize, position_rad: &[f64]) -> bool {
        let pose = self.poses.get(point).and_then(Option::as_ref);
        pose.is_some_and(|pose| self.arm.chain.is_at(pose, position_rad, SAME_POSE))
    }

    /// Rests at key points.
    pub(super) fn dwells(&self) -> Vec<Dwell> {
        let of = |point| Some(Dwell { point, length_s: self.template.dwell_s(point)? });
        (0..self.template.points().len()).filter_map(of).collect()
    }
}
