//! What tools that draw go by: the arm's description and where its links are.

use std::io::Write;

use super::{
    Cdr, LogWriter, Role, WriteError,
    message::{check_length, encode_array},
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
        let stamp = Stamp::new(stamp_ns)?;
        self.cdr.begin();
        self.cdr.string(urdf);
        let channel = match role {
            Role::Planned => &mut self.channels.planned_description,
            Role::Measured | Role::Command => &mut self.channels.description,
        };
        channel.send(&mut self.mcap, stamp, self.cdr.bytes())?;
        self.flush_if_due(stamp)
    }

    /// Writes where frames are now: `tf2_msgs/msg/TFMessage`.
    ///
    /// # Errors
    ///
    /// [`WriteError::Text`], [`WriteError::TimeRange`] or [`WriteError::Output`].
    pub fn transforms(&mut self, stamp_ns: i64, transforms: &[Transform<'_>]) -> Result<(), WriteError> {
        let stamp = encode_transforms(&mut self.cdr, stamp_ns, transforms)?;
        self.channels.transforms.send(&mut self.mcap, stamp, self.cdr.bytes())?;
        self.flush_if_due(stamp)
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
        let stamp = encode_transforms(&mut self.cdr, stamp_ns, transforms)?;
        self.channels.fixed_transforms.send(&mut self.mcap, stamp, self.cdr.bytes())?;
        self.flush_if_due(stamp)
    }

    /// Writes plan minus measurement, one angle a joint: `std_msgs/msg/Float64MultiArray`, whose only
    /// dimension is labelled with the joint names.
    ///
    /// Rerun plots eight fields at first sight, in an order of its own. A `JointState` counts for three, of
    /// which an error would fill one; this is one field that is always filled.
    ///
    /// # Errors
    ///
    /// [`WriteError::LengthMismatch`], [`WriteError::TimeRange`] or [`WriteError::Output`].
    pub fn tracking_error(&mut self, stamp_ns: i64, error_rad: &[f64]) -> Result<(), WriteError> {
        check_length("tracking error", error_rad, self.joint_names.len())?;
        let stamp = Stamp::new(stamp_ns)?;
        encode_array(&mut self.cdr, &self.joint_label, error_rad);
        self.channels.tracking_error.send(&mut self.mcap, stamp, self.cdr.bytes())?;
        self.flush_if_due(stamp)
    }
}

fn encode_transforms(
    cdr: &mut Cdr,
    stamp_ns: i64,
    transforms: &[Transform<'_>],
) -> Result<Stamp, WriteError> {
    let stamp = Stamp::new(stamp_ns)?;
    cdr.begin();
    cdr.count(transforms.len());
    for transform in transforms {
        check_text("frame", transform.parent)?;
        check_text("frame", transform.child)?;
        stamp.encode(cdr);
        cdr.string(transform.parent);
        cdr.string(transform.child);
        for value in transform.translation_m.iter().chain(&transform.rotation_xyzw) {
            cdr.f64(*value);
        }
    }
    Ok(stamp)
}

fn check_text(kind: &'static str, text: &str) -> Result<(), WriteError> {
    if text.is_empty() || text.contains('\0') {
        return Err(WriteError::Text { kind, name: text.chars().take(40).collect() });
    }
    Ok(())
}
