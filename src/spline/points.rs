//! What a trajectory is made through: key points, and the motion at its ends.

use super::{SplineError, error::check};

/// Key points of all joints, at least two, all finite.
#[derive(Debug, Clone, PartialEq)]
pub struct KeyPoints {
    joints: usize,
    /// `[point][joint]`, rad.
    position_rad: Vec<f64>,
}

impl KeyPoints {
    /// Takes positions `[point][joint]`, rad.
    ///
    /// # Errors
    ///
    /// [`SplineError`]: no joints, a length that is no multiple of them, fewer than two points,
    /// a value that is not finite.
    pub fn new(joints: usize, position_rad: Vec<f64>) -> Result<Self, SplineError> {
        if joints == 0 {
            return Err(SplineError::NoJoints);
        }
        let points = position_rad.len() / joints;
        check("position", &position_rad, points * joints)?;
        if points < 2 {
            return Err(SplineError::TooFewPoints { points });
        }
        Ok(Self { joints, position_rad })
    }

    /// Number of joints, at least one.
    pub fn joints(&self) -> usize {
        self.joints
    }

    /// Number of key points, at least two.
    #[expect(clippy::len_without_is_empty, reason = "there are always two")]
    pub fn len(&self) -> usize {
        self.position_rad.len() / self.joints
    }

    /// All joints at one key point, rad; panics if there is no such key point.
    pub fn of(&self, point: usize) -> &[f64] {
        &self.position_rad[point * self.joints..][..self.joints]
    }

    pub(super) fn stretch(&self, first: usize, last: usize) -> Self {
        let position_rad = self.position_rad[first * self.joints..(last + 1) * self.joints].to_vec();
        Self { joints: self.joints, position_rad }
    }
}

/// Speed, acceleration and jerk of every joint at both ends, each `[joint]`.
///
/// A quintic holds speed and acceleration only; jerk is then not used.
#[derive(Debug, Clone, PartialEq)]
#[expect(missing_docs, reason = "named by quantity and unit")]
pub struct Ends {
    pub start_velocity_rad_s: Vec<f64>,
    pub start_acceleration_rad_s2: Vec<f64>,
    pub start_jerk_rad_s3: Vec<f64>,
    pub end_velocity_rad_s: Vec<f64>,
    pub end_acceleration_rad_s2: Vec<f64>,
    pub end_jerk_rad_s3: Vec<f64>,
}

impl Ends {
    /// All zero.
    pub fn at_rest(joints: usize) -> Self {
        let zero = || vec![0.0; joints];
        Self {
            start_velocity_rad_s: zero(),
            start_acceleration_rad_s2: zero(),
            start_jerk_rad_s3: zero(),
            end_velocity_rad_s: zero(),
            end_acceleration_rad_s2: zero(),
            end_jerk_rad_s3: zero(),
        }
    }

    pub(super) fn check(&self, joints: usize) -> Result<(), SplineError> {
        check("velocity at the start", &self.start_velocity_rad_s, joints)?;
        check("acceleration at the start", &self.start_acceleration_rad_s2, joints)?;
        check("jerk at the start", &self.start_jerk_rad_s3, joints)?;
        check("velocity at the end", &self.end_velocity_rad_s, joints)?;
        check("acceleration at the end", &self.end_acceleration_rad_s2, joints)?;
        check("jerk at the end", &self.end_jerk_rad_s3, joints)
    }

    /// Speed, acceleration, jerk of one joint at the start.
    pub(super) fn start(&self, joint: usize) -> [f64; 3] {
        [
            self.start_velocity_rad_s[joint], self.start_acceleration_rad_s2[joint],
            self.start_jerk_rad_s3[joint],
        ]
    }

    /// Speed, acceleration, jerk of one joint at the end.
    pub(super) fn end(&self, joint: usize) -> [f64; 3] {
        [self.end_velocity_rad_s[joint], self.end_acceleration_rad_s2[joint], self.end_jerk_rad_s3[joint]]
    }
}
