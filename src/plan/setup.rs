//! A task on its arm, checked and in the form that an evaluation needs.

use nalgebra::{Matrix3, Vector3};

use super::{
    Limit, PlanError,
    checked::check,
    joint_limits::{JointLimits, merged},
    posture::{key_points, poses},
};
use crate::{
    arm::{Arm, Inertia, Joint, Load, Pose},
    series::JointKind,
    spline::{Degree, Dwell, Ends, KeyPoints, Motion},
    task::{Boundary, Task},
};

/// Angles as close as this are one, rad.
const ROUNDED_RAD: f64 = 1e-9;
/// Key points lie at the end of a range from so near, as a share of it: numbers of a task are rounded.
const ROUNDED: f64 = 1e-5;
/// Key points that differ by less are equal, rad or m.
const EQUAL_RAD: f64 = 1e-6;

/// A departure within this is at zero, s.
const FROM_ZERO_S: f64 = 1e-9;

/// A task on its arm. All joint arrays are in the arm's order, base first.
#[derive(Debug, Clone)]
pub struct Setup {
    pub(super) arm: Arm,
    pub(super) limits: Vec<JointLimits>,
    pub(super) tool_speed_m_s: f64,
    /// A motion with the task's key points, dwells and ends; its times are arbitrary.
    pub(super) template: Motion,
    /// Motion at the start and the end.
    pub(super) ends: Ends,
    /// Dwell that precedes each interval, s, `[points - 1]`; zero for none.
    pub(super) dwell_before_s: Vec<f64>,
    /// Load at the last joint in each segment.
    pub(super) loads: Vec<Load>,
    /// Shortest and longest interval, s.
    pub(super) interval_s: [f64; 2],
    /// Per limit: safety factor for peaks between evaluation nodes; 1 until one was found.
    pub(super) slack: Vec<f64>,
    /// Key points where the arm stops because the next or the last one is the same.
    pub(super) stops: Vec<usize>,
    /// Key points where it stops because the range of a joint ends there.
    pub(super) range_ends: Vec<usize>,
    /// Payload by segment, kg.
    pub(super) payload_kg: Vec<f64>,
    /// Where the tool is at key points whose joints may have any angles that bring it there.
    pub(super) poses: Vec<Option<Pose>>,
}

impl Setup {
    /// Puts a task on its arm: joints in the arm's order, key points by inverse kinematics where
    /// they are given by the tool, limits merged.
    ///
    /// # Errors
    ///
    /// [`PlanError`] if the joints differ, a key point cannot be reached or lies outside a joint's
    /// range, an end is beyond a limit, or a mass is none.
    pub fn new(task: &Task, arm: Arm) -> Result<Self, PlanError> {
        check(task)?;
        let joints = arm.chain.joint_count();
        let names: Vec<&str> = arm.chain.joints().iter().map(|joint| joint.name.as_str()).collect();
        let order: Option<Vec<usize>> =
            names.iter().map(|name| task.joints.iter().position(|own| own == name)).collect();
        let order = order
            .filter(|_| task.joints.len() == joints)
            .ok_or_else(|| PlanError::JointsDiffer { task: task.joints.join(", "), arm: names.join(", ") })?;
        for (joint, &own) in arm.chain.joints().iter().zip(&order) {
            if task.kinds[own].is_some_and(|kind| kind != joint.kind) {
                return Err(PlanError::KindsDiffer { joint: joint.name.clone(), arm: joint.kind });
            }
        }
        for ((joint, &own), cylinder) in arm.chain.joints().iter().zip(&order).zip(arm.hydraulics.cylinders())
        {
            let rod_speed_m_s = task.limits[own].rod_speed_m_s;
            if rod_speed_m_s.is_finite() && cylinder.is_none() {
                return Err(PlanError::NoCylinder { joint: joint.name.clone(), rod_speed_m_s });
            }
        }
        let limits: Vec<JointLimits> =
            order.iter().enumerate().map(|(j, &own)| merged(task, &arm, j, own)).collect();
        let range_rad: Vec<[f64; 2]> = limits.iter().map(|limits| limits.range_rad).collect();
        let points = key_points(task, &arm, &order, &range_rad)?;
        let limits: Vec<JointLimits> = limits
            .into_iter()
            .enumerate()
            .map(|(joint, limits)| limits.judged((0..points.len()).map(|point| points.of(point)[joint])))
            .collect();
        let ends = ends(task, &order);
        check_ends(&ends, &limits, &names)?;
        let given: Vec<Option<f64>> = task.points.iter().map(|key| key.dwell_s).collect();
        let stops = stops(&points, &ends, &given);
        let range_ends = range_ends(&points, &given, &range_rad);
        let dwells: Vec<Dwell> = given
            .iter()
            .enumerate()
            .filter_map(|(point, given_s)| {
                let stopped = stops.contains(&point) || range_ends.contains(&point);
                Some(Dwell { point, length_s: given_s.or(stopped.then_some(0.0))? })
            })
            .collect();
        let rests: Vec<usize> = dwells.iter().map(|dwell| dwell.point).collect();
        let mut dwell_before_s = vec![0.0; task.points.len() - 1];
        for dwell in &dwells {
            if let Some(before) = dwell_before_s.get_mut(dwell.point) {
                *before = dwell.length_s;
            }
        }
        let nominal_s = (task.interval_s[0] * task.interval_s[1]).sqrt();
        let degree = match task.degree {
            5 => Degree::Quintic,
            7 => Degree::Septic,
            _ => Degree::Sextic,
        };
        let poses = poses(task, &rests).into_iter().enumerate().map(|(point, pose)| {
            // What the arm comes near enough to is kept as it comes there.
            pose.map(|pose| arm.chain.pose_beside(pose, points.of(point)))
        });
        let poses = poses.collect();
        let t_s = arrivals(&vec![nominal_s; dwell_before_s.len()], &dwell_before_s);
        let template = Motion::new(degree, points, &ends, &dwells, &t_s)?;
        let payload_kg: Vec<f64> =
            template.segments().iter().map(|segment| payload_from(task, segment.first_point)).collect();
        let loads = payload_kg.iter().map(|&mass| load(task, &arm, mass)).collect::<Result<_, _>>()?;
        Ok(Self {
            arm,
            limits,
            tool_speed_m_s: task.tool_speed_m_s,
            template,
            ends,
            dwell_before_s,
            loads,
            interval_s: task.interval_s,
            slack: vec![1.0; Limit::rows(joints)],
            stops,
            range_ends,
            payload_kg,
            poses,
        })
    }

    /// The arm.
    pub fn arm(&self) -> &Arm {
        &self.arm
    }

    /// Whether the tool gives a key point, so that its angles may be others than those of the template.
    pub(crate) fn is_free(&self, point: usize) -> bool {
        self.poses.get(point).is_some_and(Option::is_some)
    }

    /// A motion with the task's key points, dwells and ends, to be given its times.
    pub fn template(&self) -> &Motion {
        &self.template
    }

    /// Lowest and highest angle of a joint, rad; infinite without limits, also for a joint that is not there.
    pub fn range_rad(&self, joint: usize) -> [f64; 2] {
        self.limits.get(joint).map_or([f64::NEG_INFINITY, f64::INFINITY], |limits| limits.range_rad)
    }

    /// Number of joints.
    pub fn joint_count(&self) -> usize {
        self.limits.len()
    }

    /// Names of the joints, base first.
    pub fn joint_names(&self) -> Vec<String> {
        self.arm.chain.joints().iter().map(|joint| joint.name.clone()).collect()
    }

    /// Joints whose damping and friction take more than a little of their torque at their speed limit, and which share.
    pub fn resisting(&self) -> Vec<(&str, f64)> {
        const LITTLE: f64 = 0.02;
        let share = |joint: &Joint, limits: &JointLimits| {
            let [damping, friction] = joint.resists.map(|by| by.max(0.0));
            let [low, high] = limits.speed_rad_s;
            let speed = if high.is_finite() { high.max(-low) } else { 0.0 };
            (friction + damping * speed) / limits.torque_n_m
        };
        let joints = self.arm.chain.joints().iter();
        let shares =
            joints.zip(&self.limits).map(|(joint, limits)| (joint.name.as_str(), share(joint, limits)));
        shares.filter(|(_, share)| *share > LITTLE).collect()
    }

    /// How the joints move, base first.
    pub fn joint_kinds(&self) -> impl Iterator<Item = JointKind> + '_ {
        self.arm.chain.joints().iter().map(|joint| joint.kind)
    }

    /// How a joint moves; turning of the arm as a whole.
    pub(super) fn kind(&self, joint: Option<usize>) -> JointKind {
        joint
            .and_then(|joint| self.arm.chain.joints().get(joint))
            .map_or(JointKind::Turns, |joint| joint.kind)
    }

    /// Number of intervals between key points: the variables of a plan.
    pub fn interval_count(&self) -> usize {
        self.dwell_before_s.len()
    }

    /// Whether times of movement, s, are as long as the task has them.
    pub(super) fn has(&self, interval_s: &[f64]) -> bool {
        let [shortest_s, longest_s] = self.interval_s;
        interval_s.iter().all(|s| (shortest_s..=longest_s).contains(s))
    }

    /// Arrival at each key point, s, from the times of movement between them, s.
    pub fn times_s(&self, interval_s: &[f64]) -> Vec<f64> {
        arrivals(interval_s, &self.dwell_before_s)
    }

    /// Times of movement between the key points, s, from the arrivals, s.
    ///
    /// # Errors
    ///
    /// [`PlanError::Times`] for another number of times than key points, [`PlanError::Begins`] for a departure at another
    /// time than 0; what the intervals must be
    /// is checked where they become a motion.
    pub fn intervals_s(&self, times_s: &[f64]) -> Result<Vec<f64>, PlanError> {
        if times_s.len() != self.interval_count() + 1 {
            return Err(PlanError::Times { found: times_s.len(), expected: self.interval_count() + 1 });
        }
        let begins_s = times_s.first().copied().unwrap_or_default();
        if begins_s.abs() > FROM_ZERO_S {
            return Err(PlanError::Begins { found_s: begins_s });
        }
        Ok(times_s
            .windows(2)
            .zip(&self.dwell_before_s)
            .map(|(pair, dwell_s)| pair[1] - pair[0] - dwell_s)
            .collect())
    }

    /// Duration of a motion with all intervals alike, s, dwells included.
    pub(super) fn even_s(&self, interval_s: f64) -> f64 {
        self.resting_s() + interval_s * self.interval_count() as f64
    }

    /// Sum of the dwells, s.
    pub(super) fn resting_s(&self) -> f64 {
        let last_s = self.template.dwell_s(self.interval_count()).unwrap_or(0.0);
        self.dwell_before_s.iter().sum::<f64>() + last_s
    }

    /// The motion with these arrivals, s.
    ///
    /// # Errors
    ///
    /// [`PlanError`] if there are more or fewer than key points, or they leave no time to move.
    pub fn motion(&self, times_s: &[f64]) -> Result<Motion, PlanError> {
        self.intervals_s(times_s)?;
        let mut motion = self.template.clone();
        motion.retime(times_s)?;
        Ok(motion)
    }

    /// Indices of key points without a dwell at which the arm stops all the same: a spline through two equal key points
    /// would drift between them.
    pub fn stops(&self) -> &[usize] {
        &self.stops
    }

    /// The same of key points at the end of a joint's range, which a spline through them would pass.
    pub fn range_ends(&self) -> &[usize] {
        &self.range_ends
    }

    /// Payload from the start of each segment of the motion on, kg.
    pub fn payload_kg(&self) -> &[f64] {
        &self.payload_kg
    }
}

/// Key points without a dwell that equal a neighbour; those at an end that moves are left as they are.
fn stops(points: &KeyPoints, ends: &Ends, dwell_s: &[Option<f64>]) -> Vec<usize> {
    let last = points.len() - 1;
    let resting = Ends::at_rest(points.joints());
    let free = |point: usize| dwell_s[point].is_none() && (point > 0 && point < last || *ends == resting);
    // Postures that poses lead to differ by rounding.
    let equal = |(a, b): (&f64, &f64)| (a - b).abs() <= EQUAL_RAD;
    let same = |point: usize| point < last && points.of(point).iter().zip(points.of(point + 1)).all(equal);
    (0..=last).filter(|&point| free(point) && (same(point) || point > 0 && same(point - 1))).collect()
}

/// Key points without a dwell, but first and last, at which a joint comes to the end of its range or leaves it.
fn range_ends(points: &KeyPoints, dwell_s: &[Option<f64>], range_rad: &[[f64; 2]]) -> Vec<usize> {
    let turns = |point: usize, joint: usize, [lower, upper]: [f64; 2]| {
        let [before, angle, after] = [point - 1, point, point + 1].map(|point| points.of(point)[joint]);
        let moves = (angle - before).abs() > ROUNDED_RAD || (angle - after).abs() > ROUNDED_RAD;
        let near =
            ROUNDED_RAD.max(if upper - lower < f64::INFINITY { ROUNDED * (upper - lower) } else { 0.0 });
        moves && (angle <= lower + near || angle >= upper - near)
    };
    let stops = |point: usize| range_rad.iter().enumerate().any(|(joint, range)| turns(point, joint, *range));
    (1..points.len() - 1).filter(|&point| dwell_s[point].is_none() && stops(point)).collect()
}

fn arrivals(interval_s: &[f64], dwell_before_s: &[f64]) -> Vec<f64> {
    let mut t_s = Vec::with_capacity(interval_s.len() + 1);
    t_s.push(0.0);
    let mut now_s = 0.0;
    for (interval_s, dwell_s) in interval_s.iter().zip(dwell_before_s) {
        now_s += dwell_s + interval_s;
        t_s.push(now_s);
    }
    t_s
}

fn ends(task: &Task, order: &[usize]) -> Ends {
    let pick = |values: &[f64]| order.iter().map(|&own| values[own]).collect();
    let of =
        |end: &Boundary| (pick(&end.velocity_rad_s), pick(&end.acceleration_rad_s2), pick(&end.jerk_rad_s3));
    let (start, end) = (of(&task.start), of(&task.end));
    Ends {
        start_velocity_rad_s: start.0,
        start_acceleration_rad_s2: start.1,
        start_jerk_rad_s3: start.2,
        end_velocity_rad_s: end.0,
        end_acceleration_rad_s2: end.1,
        end_jerk_rad_s3: end.2,
    }
}

fn check_ends(ends: &Ends, limits: &[JointLimits], names: &[&str]) -> Result<(), PlanError> {
    type Quantity = (&'static str, fn(&JointLimits, f64) -> f64);
    let quantities: [Quantity; 3] = [
        ("speed", |limit, value| limit.speed(value)),
        ("acceleration", |limit, _| limit.acceleration_rad_s2),
        ("jerk", |limit, _| limit.jerk_rad_s3),
    ];
    let start = [&ends.start_velocity_rad_s, &ends.start_acceleration_rad_s2, &ends.start_jerk_rad_s3];
    let last = [&ends.end_velocity_rad_s, &ends.end_acceleration_rad_s2, &ends.end_jerk_rad_s3];
    for (end, values) in [("start", start), ("end", last)] {
        for ((quantity, of), values) in quantities.iter().zip(values) {
            for ((value, limit), joint) in values.iter().zip(limits).zip(names) {
                let share = value.abs() / of(limit, *value);
                if share > 1.0 {
                    return Err(PlanError::EndOutside { end, joint: (*joint).to_owned(), quantity, share });
                }
            }
        }
    }
    Ok(())
}

/// Payload when the arm leaves a key point, kg.
fn payload_from(task: &Task, point: usize) -> f64 {
    let mut changes = task.points[..=point].iter().filter_map(|key| key.payload_kg);
    changes.next_back().unwrap_or(task.payload_kg)
}

/// The payload as a box before the tool.
fn load(task: &Task, arm: &Arm, payload_kg: f64) -> Result<Load, PlanError> {
    let [x_m, y_m, z_m] = task.payload_size_m;
    let twelfth = payload_kg / 12.0;
    let (xx, yy, zz) = (x_m * x_m, y_m * y_m, z_m * z_m);
    let tensor = Vector3::new(twelfth * (yy + zz), twelfth * (xx + zz), twelfth * (xx + yy));
    let centre_m = Vector3::new(0.5 * x_m, 0.0, 0.0);
    let payload = Inertia::new(payload_kg, centre_m, Matrix3::from_diagonal(&tensor))
        .ok_or(PlanError::Payload { payload_kg })?;
    Ok(arm.chain.load((payload_kg > 0.0).then_some(&payload)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::Quantity;

    #[test]
    fn between_equal_key_points_without_a_dwell_the_arm_stops() {
        // A payload changes at a dwell.
        let kept = |line: &&str| !line.starts_with("dwell_s") && !line.starts_with("payload_kg");
        let lines = include_str!("../../sample-logs/tasks/task-1.toml").lines().filter(kept);
        let text = lines.collect::<Vec<_>>().join("\n");
        let from = text.find("[[point]]\nname = \"key point 4\"").unwrap();
        let to = from + 1 + text[from + 1..].find("[[point]]").unwrap();
        let twice = format!("{}{}{}", &text[..to], &text[from..to], &text[to..]);
        let once = Setup::new(&Task::parse(&text).unwrap(), Arm::sample().unwrap()).unwrap();
        assert!(once.stops().is_empty());
        let setup = Setup::new(&Task::parse(&twice).unwrap(), Arm::sample().unwrap()).unwrap();
        assert_eq!(setup.stops(), [3, 4]);
        let motion = setup.motion(&[0.0, 4.0, 8.0, 12.0, 14.0, 18.0, 22.0]).unwrap();
        for t_s in [12.0, 12.7, 13.9] {
            let at = motion.at(t_s);
            for joint in 0..setup.joint_count() {
                assert!(at.of(Quantity::Velocity, joint)[0].abs() < 1e-12);
                let key = setup.template().points().of(3)[joint];
                assert!((at.of(Quantity::Position, joint)[0] - key).abs() < 1e-12);
            }
        }
    }
}
