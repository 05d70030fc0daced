//! Postures that bring the tool where it is wanted: damped least squares (Nakamura and Hanafusa
//! 1986, doi:10.1115/1.3143764) within the joint limits, with the freedom left over spent on
//! staying near a posture (Liégeois 1977, doi:10.1109/TSMC.1977.4309644).

use nalgebra::{DVector, Matrix6xX, SVD, UnitQuaternion, Vector6};

use super::{ArmError, Chain, Pose};

/// Starts: the posture asked for, then a sequence that fills the joint ranges evenly.
const STARTS: u32 = 32;
/// Starts while none has reached the pose.
const MOST_STARTS: u32 = 256;
const MOST_STEPS: usize = 200;
/// Steps without progress after which a descent far from the pose is given up.
const PATIENCE: usize = 25;
/// Nearer than this a descent is not given up, m and rad.
const FAR: f64 = 1e-3;
/// A pose counts as reached, m and rad.
const REACHED: f64 = 1e-11;
/// So does one that an arm of few joints comes so near and no nearer, m and rad: descriptions round their angles.
const ROUNDED: f64 = 1e-5;
/// Steps of Newton's method to a pose nearby.
const ONTO: usize = 8;
/// Further than this the tool's motion is no longer nearly linear, m or rad.
const LONGEST_ERROR: f64 = 0.3;
/// Weight of the joints' motion in the least squares, by what is left to the pose.
const DAMPING: f64 = 0.01;
/// Share of the way back to the posture asked for that one step takes.
const RETURN: f64 = 0.5;
/// Directions that the tool can move in at less than this, against the easiest, it cannot.
const RIGID: f64 = 1e-9;

/// A posture and what it leaves to the pose.
struct Nearest {
    distance_m: f64,
    angle_rad: f64,
    found: DVector<f64>,
}

impl Chain {
    /// The same with other ranges of the joints, rad; missing ones stay.
    pub fn within(mut self, ranges_rad: impl IntoIterator<Item = [f64; 2]>) -> Self {
        for (joint, [lower_rad, upper_rad]) in self.joints.iter_mut().zip(ranges_rad) {
            (joint.limit.lower_rad, joint.limit.upper_rad) = (lower_rad, upper_rad);
        }
        self
    }

    /// The posture nearest to `near_rad` (root of the summed squares, rad) that has the tool at a
    /// pose of the base's frame and all joints within their limits.
    ///
    /// Works for redundant arms and for arms that move in a plane, whose poses must lie in it. It is
    /// the nearest of what descents from many starts find: for the sample arm the nearest of all, for
    /// skew axes and narrow limits now and then (a few in a hundred) a farther one, or none at all.
    /// `near_rad` has an entry a joint; missing ones count as zero.
    ///
    /// # Errors
    ///
    /// [`ArmError::Unreachable`] with what the nearest attempt leaves.
    pub fn reach(&self, pose: &Pose, near_rad: &[f64]) -> Result<Vec<f64>, ArmError> {
        let near = DVector::from_fn(self.joint_count(), |i, _| {
            near_rad.get(i).copied().filter(|q| q.is_finite()).unwrap_or(0.0)
        });
        let mut least = Nearest { distance_m: f64::INFINITY, angle_rad: f64::INFINITY, found: near.clone() };
        let best = self
            .nearest(pose, &near, &mut least, |start| self.descend(pose, start, &near, RETURN))
            // Between the ends of narrow ranges the way back may hold what the pose needs.
            .or_else(|| self.nearest(pose, &near, &mut least, |start| self.there(pose, start, &near)));
        let Nearest { distance_m, angle_rad, found } = least;
        best.or_else(|| (distance_m.max(angle_rad) < ROUNDED).then_some(found))
            .map(|found| found.iter().copied().collect())
            .ok_or(ArmError::Unreachable { distance_m, angle_rad })
    }

    /// Of the postures that descents from the starts find at a pose the nearest; in `least` goes the nearest attempt.
    fn nearest(
        &self,
        pose: &Pose,
        near: &DVector<f64>,
        least: &mut Nearest,
        descent: impl Fn(DVector<f64>) -> DVector<f64>,
    ) -> Option<DVector<f64>> {
        let mut best: Option<DVector<f64>> = None;
        for start in 0..MOST_STARTS {
            if start >= STARTS && best.is_some() {
                break;
            }
            let found = descent(self.start(start, near));
            let left = self.left(pose, &found);
            let (distance_m, angle_rad) = (left.fixed_rows::<3>(0).norm(), left.fixed_rows::<3>(3).norm());
            if distance_m + angle_rad < least.distance_m + least.angle_rad || least.distance_m.is_infinite() {
                *least = Nearest { distance_m, angle_rad, found: found.clone() };
            }
            let nearer = best.as_ref().is_none_or(|best| (&found - near).norm() < (best - near).norm());
            if left.norm() < REACHED && nearer {
                best = Some(found);
            }
        }
        best
    }

    /// Directions in which the joints move the tool, each of length one, and how far a pose is along each, rad: postures
    /// that keep the tool there differ from this one across them, to the first order.
    pub fn held(&self, pose: &Pose, position_rad: &[f64]) -> Vec<(Vec<f64>, f64)> {
        let left = self.left(pose, &DVector::from_column_slice(position_rad));
        let svd = SVD::try_new(self.tool_jacobian(position_rad), true, true, f64::EPSILON, 1000);
        let Some((u, v_t, values)) = svd.and_then(|svd| Some((svd.u?, svd.v_t?, svd.singular_values))) else {
            return Vec::new();
        };
        let strongest = values.max();
        let moved = values.iter().enumerate().filter(|(_, strength)| **strength > RIGID * strongest);
        moved
            .map(|(i, strength)| (v_t.row(i).iter().copied().collect(), u.column(i).dot(&left) / strength))
            .collect()
    }

    /// The posture beside one that has the tool at a pose, whatever the joints' limits; `None` if none is near.
    pub fn onto(&self, pose: &Pose, near_rad: &[f64]) -> Option<Vec<f64>> {
        let mut position_rad = near_rad.to_vec();
        for _ in 0..ONTO {
            for (direction, left_rad) in self.held(pose, &position_rad) {
                position_rad.iter_mut().zip(direction).for_each(|(q, by)| *q += left_rad * by);
            }
        }
        self.is_at(pose, &position_rad, REACHED).then_some(position_rad)
    }

    /// Whether a posture has the tool at a pose, within so many m and rad.
    pub fn is_at(&self, pose: &Pose, position_rad: &[f64], within: f64) -> bool {
        position_rad.len() == self.joint_count()
            && self.left(pose, &DVector::from_column_slice(position_rad)).norm() < within
    }

    /// A pose, or the one that a posture has in place of it where it is not the same to rounding.
    pub(crate) fn pose_beside(&self, pose: Pose, position_rad: &[f64]) -> Pose {
        if self.is_at(&pose, position_rad, REACHED) { pose } else { self.tool_pose(position_rad) }
    }

    /// Starts after the first follow the multiples of powers of the generalised golden ratio.
    fn start(&self, number: u32, near: &DVector<f64>) -> DVector<f64> {
        let dimensions = self.joint_count() as f64;
        let ratio = (0..64).fold(2.0_f64, |x, _| (1.0 + x).powf(1.0 / (dimensions + 1.0)));
        let mut power = 1.0;
        DVector::from_fn(self.joint_count(), |i, _| {
            power /= ratio;
            let (lower, upper) = self.range(i, near[i]);
            if number == 0 {
                return near[i].clamp(lower, upper);
            }
            lower + (upper - lower) * (0.5 + f64::from(number - 1) * power).fract()
        })
    }

    /// Limits of a joint; a turn about the posture where it has none.
    fn range(&self, joint: usize, near_rad: f64) -> (f64, f64) {
        let limit = self.joints[joint].limit;
        let pi = std::f64::consts::PI;
        match (limit.lower_rad.is_finite(), limit.upper_rad.is_finite()) {
            (true, true) => (limit.lower_rad, limit.upper_rad),
            (true, false) => (limit.lower_rad, limit.lower_rad.max(near_rad) + pi),
            (false, true) => (limit.upper_rad.min(near_rad) - pi, limit.upper_rad),
            (false, false) => (near_rad - pi, near_rad + pi),
        }
    }

    /// What is left to the pose: distance, m, above the rotation vector, rad.
    fn left(&self, pose: &Pose, position: &DVector<f64>) -> Vector6<f64> {
        let now = self.tool_pose(position.as_slice());
        let shift = pose.translation.vector - now.translation.vector;
        // By way of the quaternion: exact for small turns, where the trace of the matrix is not.
        let turn = pose.rotation * now.rotation.inverse();
        let turn = UnitQuaternion::from_rotation_matrix(&turn).scaled_axis();
        Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z)
    }

    /// A descent to the pose, and from there back to the posture asked for, as far as the tool stays.
    fn there(&self, pose: &Pose, start: DVector<f64>, near: &DVector<f64>) -> DVector<f64> {
        let there = self.descend(pose, start, near, 0.0);
        let back = self.descend(pose, there.clone(), near, RETURN);
        if self.left(pose, &back).norm() < REACHED { back } else { there }
    }

    fn descend(&self, pose: &Pose, start: DVector<f64>, near: &DVector<f64>, back: f64) -> DVector<f64> {
        let mut position = start;
        let (mut least, mut progress) = (f64::INFINITY, 0);
        for number in 0..MOST_STEPS {
            let left = self.left(pose, &position);
            let size = left.norm();
            if size < 0.99 * least {
                (least, progress) = (size, number);
            }
            if !size.is_finite() || (size > FAR && number > progress + PATIENCE) {
                break;
            }
            // The last steps only approach the pose, wherever the return to the posture has got to.
            let share = if number + 8 < MOST_STEPS { back } else { 0.0 };
            let back = (near - &position) * share;
            let Some(step) = self.step(&position, &(left * (LONGEST_ERROR / size).min(1.0)), &back) else {
                break;
            };
            position += &step;
            if size < REACHED && step.norm() < REACHED {
                break;
            }
        }
        position
    }

    /// One step: joints that it would take beyond a limit stop there and the others do the rest.
    fn step(
        &self,
        position: &DVector<f64>,
        left: &Vector6<f64>,
        back: &DVector<f64>,
    ) -> Option<DVector<f64>> {
        let whole = self.tool_jacobian(position.as_slice());
        let (mut free, mut left, mut back) = (whole.clone(), *left, back.clone());
        let mut stopped: Vec<Option<f64>> = vec![None; self.joint_count()];
        loop {
            let mut step = least_squares(&free, &left, &back)?;
            let mut worst = (0.0, 0, 0.0);
            for (i, joint) in self.joints.iter().enumerate() {
                let (low, high) = (joint.limit.lower_rad - position[i], joint.limit.upper_rad - position[i]);
                if let Some(stop) = stopped[i] {
                    step[i] = stop;
                } else if (low - step[i]).max(step[i] - high) > worst.0 {
                    worst = ((low - step[i]).max(step[i] - high), i, step[i].clamp(low.min(high), high));
                }
            }
            let (excess, joint, stop) = worst;
            if excess <= 0.0 {
                return Some(step);
            }
            stopped[joint] = Some(stop);
            left -= whole.column(joint) * stop;
            free.column_mut(joint).fill(0.0);
            back[joint] = 0.0;
        }
    }
}

/// The joint step that best makes the tool's step and, where the tool does not care, goes `back`.
fn least_squares(
    jacobian: &Matrix6xX<f64>,
    left: &Vector6<f64>,
    back: &DVector<f64>,
) -> Option<DVector<f64>> {
    let svd = SVD::try_new(jacobian.clone(), true, true, f64::EPSILON, 1000)?;
    let (u, v_t) = (svd.u?, svd.v_t?);
    let strongest = svd.singular_values.max();
    let damping = (DAMPING * left.norm()).powi(2);
    let mut step = back.clone();
    for (i, &strength) in svd.singular_values.iter().enumerate() {
        if strength > RIGID * strongest {
            let direction = v_t.row(i).transpose();
            let wanted = u.column(i).dot(left) * strength / (strength * strength + damping);
            step += &direction * (wanted - direction.dot(back));
        }
    }
    step.iter().all(|q| q.is_finite()).then_some(step)
}
