//! Topics that carry joints: the messages and fields that are read, and the tables they fill.

mod kind;
mod plans;
mod poses;
mod table;
mod versioned;

pub(super) use kind::{Field, Form, NANOSECONDS, Role, SECONDS, Spec, spec_for};
pub(super) use plans::{Plans, RawTrajectory};
pub(super) use poses::{AXES, IN, Poses, is_field, unit};
pub(super) use table::{MAX_JOINTS, Rows, Stamps, Table};
pub(super) use versioned::Versioned;

/// Slots of fields that every form shares.
pub(super) mod slot {
    use crate::log::decode::Slot;

    pub(in crate::log) const SECOND: Slot = 0;
    pub(in crate::log) const NANOSECOND: Slot = 1;
    pub(in crate::log) const NAMES: Slot = 2;
    /// Element of a list of structs: one joint, or one trajectory of several.
    pub(in crate::log) const GROUP: Slot = 3;
    /// Names of the values of one joint.
    pub(in crate::log) const INTERFACES: Slot = 4;
    /// Values of one joint.
    pub(in crate::log) const VALUES: Slot = 5;
    pub(in crate::log) const SPEED_SCALING: Slot = 6;
    pub(in crate::log) const POINT: Slot = 7;
    pub(in crate::log) const POINT_SECOND: Slot = 8;
    pub(in crate::log) const POINT_NANOSECOND: Slot = 9;
    pub(in crate::log) const POSITIONS: Slot = 10;
    pub(in crate::log) const VELOCITIES: Slot = 11;
    pub(in crate::log) const ACCELERATIONS: Slot = 12;
    pub(in crate::log) const VERSION: Slot = 13;
    /// The frame that a pose is of.
    pub(in crate::log) const CHILD: Slot = 14;
    /// The frame that it is told in.
    pub(in crate::log) const PARENT: Slot = 15;
    /// The first of a table's own fields.
    pub(in crate::log) const FIELD: Slot = 32;
}
