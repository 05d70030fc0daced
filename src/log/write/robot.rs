//! Messages for tools that draw the arm: its description and the poses of its links.

use std::io::Write;

use super::{
    Kind, LogWriter, Role, WriteError,
    message::{check_length, encode_header, encode_joint_state},
    stamp::Stamp,
};

/// Where one frame is in another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transform<'a> {
    /// The frame it is seen from.
    pub parent: &'a str,
    /// The frame that is placed.
    pub child: &'a str,
    /// Its origin, m.
    pub translation_m: [f64; 3],
    /// Its orientation, a unit quaternion x, y, z, w.
    pub rotation_xyzw: [f64; 4],
}

impl<W: Write> LogWriter<W> {
    /// Writes the text of a URDF, once and before all else: `std_msgs/msg/String`. [`Role::Planned`]
    /// is the arm drawn where the plan wants it, beside the one that every other role means.
    ///
    /// # Errors
    ///
    /// [`WriteError::Text`], [`WriteError::TimeRange`] or [`WriteError::Output`].
    pub fn description(&mut self, role: Role, stamp_ns: i64, urdf: &str) -> Result<(), WriteError> {
        check_text("robot description", urdf)?;
        let stamp = Stamp::new(stamp_ns, self.log_delay_ns)?;
        self.cdr.begin();
        self.cdr.string(urdf);
        let kind = if role == Role::Planned { Kind::PlannedDescription } else { Kind::Description };
        self.send(kind, stamp)
    }

    /// Writes where frames are now: `tf2_msgs/msg/TFMessage`.
    ///
    /// # Errors
    ///
    /// [`WriteError::Text`], [`WriteError::TimeRange`] or [`WriteError::Output`].
    pub fn transforms(&mut self, stamp_ns: i64, transforms: &[Transform<'_>]) -> Result<(), WriteError> {
        self.placed(Kind::Transforms, stamp_ns, transforms)
    }

    /// Writes where frames are for the whole run, all in one call: `tf2_msgs/msg/TFMessage`.
    ///
    /// # Errors
    ///
    /// As [`transforms`](Self::transforms).
    pub fn fixed_transforms(
        &mut self,
        stamp_ns: i64,
        transforms: &[Transform<'_>],
    ) -> Result<(), WriteError> {
        self.placed(Kind::FixedTransforms, stamp_ns, transforms)
    }

    /// Writes plan minus measurement, one angle a joint: `sensor_msgs/msg/JointState`.
    ///
    /// # Errors
    ///
    /// [`WriteError::LengthMismatch`], [`WriteError::TimeRange`] or [`WriteError::Output`].
    pub fn tracking_error(&mut self, stamp_ns: i64, error_rad: &[f64]) -> Result<(), WriteError> {
        check_length("tracking error", error_rad, self.joint_names.len())?;
        let stamp = Stamp::new(stamp_ns, self.log_delay_ns)?;
        encode_header(&mut self.cdr, stamp, &self.joint_names);
        encode_joint_state(&mut self.cdr, [error_rad, &[], &[]]);
        self.send(Kind::TrackingError, stamp)
    }

    fn placed(&mut self, kind: Kind, stamp_ns: i64, transforms: &[Transform<'_>]) -> Result<(), WriteError> {
        let stamp = Stamp::new(stamp_ns, self.log_delay_ns)?;
        self.cdr.begin();
        self.cdr.count(transforms.len());
        for transform in transforms {
            check_text("frame", transform.parent)?;
            check_text("frame", transform.child)?;
            stamp.encode(&mut self.cdr);
            self.cdr.string(transform.parent);
            self.cdr.string(transform.child);
            for value in transform.translation_m.iter().chain(&transform.rotation_xyzw) {
                self.cdr.f64(*value);
            }
        }
        self.send(kind, stamp)
    }
}

fn check_text(kind: &'static str, text: &str) -> Result<(), WriteError> {
    if text.is_empty() || text.contains('\0') {
        return Err(WriteError::Text { kind, name: text.chars().take(40).collect() });
    }
    Ok(())
}
