//! Headers in the form that `export` writes: the joint's name before their ending is taken as it is.

use super::{Role, name::joint_name, word::words};

const ENDINGS: [(&str, Role); 3] =
    [("_planned", Role::Planned), ("_measured", Role::Measured), ("_command", Role::Command)];

/// The joint of a header in this form, what is said of it, and the joint as its words would be read.
pub(super) fn own(name: &str) -> Option<(&str, Role, String)> {
    let found = ENDINGS.iter().find_map(|(ending, role)| Some((name.strip_suffix(ending)?, *role)));
    let (joint, role) = found.filter(|(joint, _)| !joint.is_empty())?;
    Some((joint, role, joint_name(&words(name))))
}
