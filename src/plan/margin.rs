//! How near a plan comes to every limit, exactly, and where.

use super::{Evaluator, Margin, Setup, limit::Limit, mesh::LOADED, shares::vertex};
use crate::{
    arm::LANES,
    spline::{Extremum, Motion, Quantity},
};

/// Groups of instants that a segment is scanned by at least, and each piece of its spline; the peak is then looked at closer.
const GROUPS: usize = 64;
const EACH: usize = 8;
/// How often the instants about a peak are looked at closer, each time by a factor of four or more.
const CLOSER: usize = 3;

impl Setup {
    /// Margins of the limits that the plan has, joint by joint and then those of the arm: angles,
    /// speeds, accelerations and jerks from exact extrema; torques, rods, flow and tool by a search
    /// among 512 instants a segment, or 64 a piece of its spline if those are more, and then about the largest.
    ///
    /// `evaluator` must be of this setup; what it evaluated before is lost.
    pub fn margins(&self, motion: &Motion, evaluator: &mut Evaluator) -> Vec<Margin> {
        let joints = self.joint_count();
        evaluator.motion.clone_from(motion);
        let mut margins = Vec::new();
        evaluator.mesh.scan(self, motion, GROUPS, EACH);
        let mut tops: Vec<(usize, f64)> = Vec::new();
        for row in 0..joints * LOADED + 2 {
            tops.push(top(evaluator.mesh.row(row)));
        }
        let places: Vec<(usize, f64, f64, f64)> = tops
            .iter()
            .map(|&(i, share)| {
                let segment = evaluator.mesh.segment_of(i);
                let steps = evaluator.mesh.segment[segment].len() - 1;
                let step_s = motion.segments()[segment].spline.duration_s() / steps as f64;
                (segment, evaluator.mesh.t_s[i], step_s, share)
            })
            .collect();
        let mut sampled =
            places.into_iter().enumerate().map(|(row, place)| self.closer(motion, evaluator, row, place));
        let sampled: Vec<(f64, f64)> = sampled.by_ref().collect();
        for joint in 0..joints {
            self.of_splines(motion, joint, &mut margins);
            for (k, limit) in Limit::OF_JOINT[Quantity::ALL.len()..].iter().enumerate() {
                let (t_s, share) = sampled[joint * LOADED + k];
                margins.extend(self.loaded(motion, evaluator, (*limit, Some(joint)), t_s, share));
            }
        }
        for (k, limit) in Limit::OF_ARM.into_iter().enumerate() {
            let (t_s, share) = sampled[joints * LOADED + k];
            margins.extend(self.loaded(motion, evaluator, (limit, None), t_s, share));
        }
        margins
    }

    /// Whether a joint, or the arm, has a limit of the quantity.
    pub fn is_limited(&self, limit: Limit) -> bool {
        let finite = |of: &dyn Fn(usize) -> f64| (0..self.joint_count()).any(|joint| of(joint).is_finite());
        match limit {
            Limit::Position => self.limits.iter().any(|own| own.range().is_some()),
            Limit::Speed => finite(&|joint| self.limits[joint].speed(1.0)),
            Limit::Acceleration => finite(&|joint| self.limits[joint].acceleration_rad_s2),
            Limit::Jerk => finite(&|joint| self.limits[joint].jerk_rad_s3),
            Limit::Torque => finite(&|joint| self.limits[joint].torque_n_m),
            Limit::RodSpeed => {
                let own = self.limits.iter().zip(self.arm.hydraulics.cylinders());
                let mut own =
                    own.filter(|(_, cylinder)| cylinder.is_some()).flat_map(|(own, _)| own.rod_speed_m_s);
                own.any(f64::is_finite)
            }
            Limit::RodForce => {
                let cylinders = self.arm.hydraulics.cylinders().iter().flatten();
                cylinders.flat_map(|own| [own.push_n(), own.pull_n()]).any(f64::is_finite)
            }
            Limit::PumpFlow => self.arm.hydraulics.pump_flow_m3_s().is_finite(),
            Limit::ToolSpeed => self.tool_speed_m_s.is_finite(),
        }
    }

    /// Rows that are splines themselves.
    fn of_splines(&self, motion: &Motion, joint: usize, margins: &mut Vec<Margin>) {
        let limits = &self.limits[joint];
        let [low, high] = limits.range_rad;
        if let Some((middle, half)) = limits.range() {
            let found = motion.extrema(joint, Quantity::Position);
            let outer = |at: Extremum| (at.value - middle).abs() / half;
            // Where there is no end, none is come near to.
            let up = match (low.is_finite(), high.is_finite()) {
                (true, true) => outer(found.greatest) >= outer(found.least),
                (_, bounded) => bounded,
            };
            let (at, allowed) = if up { (found.greatest, high) } else { (found.least, low) };
            margins.push(Margin {
                limit: Limit::Position,
                joint: Some(joint),
                kind: self.kind(Some(joint)),
                value: at.value,
                allowed,
                share: outer(at),
                t_s: at.t_s,
            });
        }
        let each = [
            (Limit::Speed, Quantity::Velocity, limits.speed_rad_s),
            (Limit::Acceleration, Quantity::Acceleration, limits.acceleration()),
            (Limit::Jerk, Quantity::Jerk, limits.jerk()),
        ];
        for (limit, quantity, [low, high]) in each.into_iter().filter(|(_, _, [_, high])| high.is_finite()) {
            let found = motion.extrema(joint, quantity);
            let shares = [found.least.value / low, found.greatest.value / high];
            let (at, allowed) =
                if shares[1] >= shares[0] { (found.greatest, high) } else { (found.least, low) };
            let share = shares[0].max(shares[1]);
            let (joint, kind) = (Some(joint), self.kind(Some(joint)));
            margins.push(Margin { limit, joint, kind, value: at.value, allowed, share, t_s: at.t_s });
        }
    }

    /// Time and size of a sampled peak, looked at closer.
    fn closer(
        &self,
        motion: &Motion,
        evaluator: &mut Evaluator,
        row: usize,
        (segment, t_s, step_s, share): (usize, f64, f64, f64),
    ) -> (f64, f64) {
        let own = &motion.segments()[segment];
        let (start_s, end_s) = (own.start_s, own.start_s + own.spline.duration_s());
        let (mut t_s, mut step_s, mut share) = (t_s, step_s, share);
        for _ in 0..CLOSER {
            let first_s = (t_s - step_s).max(start_s);
            let last_s = (t_s + step_s).min(end_s);
            let finer_s = (last_s - first_s) / (LANES - 1) as f64;
            let instants: [f64; LANES] = std::array::from_fn(|i| first_s + finer_s * i as f64);
            evaluator.mesh.look(self, motion, segment, instants);
            let values = evaluator.mesh.row(row);
            let (i, found) = top(values);
            if found < share {
                break;
            }
            (t_s, share) = if i > 0 && i + 1 < LANES {
                vertex([i - 1, i, i + 1].map(|i| (instants[i], values[i])))
            } else {
                (instants[i], found)
            };
            step_s = finer_s;
        }
        (t_s, share)
    }

    /// A row that comes from the mechanics, unless there is no such limit.
    fn loaded(
        &self,
        motion: &Motion,
        evaluator: &mut Evaluator,
        (limit, joint): (Limit, Option<usize>),
        t_s: f64,
        share: f64,
    ) -> Option<Margin> {
        let allowed = self.allowed(motion, evaluator, limit, joint, t_s)?;
        Some(Margin { limit, joint, kind: self.kind(joint), value: share * allowed, allowed, share, t_s })
    }

    /// Largest value allowed of a mechanical quantity at an instant, with the sign of the quantity.
    fn allowed(
        &self,
        motion: &Motion,
        evaluator: &mut Evaluator,
        limit: Limit,
        joint: Option<usize>,
        t_s: f64,
    ) -> Option<f64> {
        let Some(joint) = joint else {
            let most = match limit {
                Limit::ToolSpeed => self.tool_speed_m_s,
                _ => self.arm.hydraulics.pump_flow_m3_s(),
            };
            return most.is_finite().then_some(most);
        };
        let segment = motion.segments().partition_point(|segment| segment.start_s <= t_s).saturating_sub(1);
        evaluator.mesh.look(self, motion, segment, [t_s; LANES]);
        let (position, speed) = (
            evaluator.mesh.samples.of(Quantity::Position, joint)[0],
            evaluator.mesh.samples.of(Quantity::Velocity, joint)[0],
        );
        let torque = evaluator.mesh.torque_n_m(joint);
        let limits = &self.limits[joint];
        if limit == Limit::Torque {
            return limits.torque_n_m.is_finite().then(|| limits.torque_n_m.copysign(torque));
        }
        let cylinder = self.arm.hydraulics.cylinders()[joint]?;
        let found = cylinder.actuation(position.sin_cos(), speed, torque);
        let [extend_m_s, retract_m_s] = limits.rod_speed_m_s;
        Some(match (limit, found.rod_speed_m_s > 0.0, found.force_n > 0.0) {
            (Limit::RodSpeed, true, _) => extend_m_s,
            (Limit::RodSpeed, false, _) => -retract_m_s,
            (_, _, true) => cylinder.push_n(),
            (_, _, false) => -cylinder.pull_n(),
        })
        .filter(|most| most.is_finite())
    }
}

/// Index and value of the largest.
fn top(values: &[f64]) -> (usize, f64) {
    values.iter().copied().enumerate().fold((0, 0.0), |best, next| if next.1 > best.1 { next } else { best })
}
