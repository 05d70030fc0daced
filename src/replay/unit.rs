//! The unit of a joint's position in documents: "rad" or "m".

use serde::{Deserialize, Deserializer, Serializer, de::Error};

use crate::series::JointKind;

#[expect(clippy::trivially_copy_pass_by_ref, reason = "the form that serde asks for")]
pub(crate) fn serialize<S: Serializer>(kind: &JointKind, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(kind.unit())
}

pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<JointKind, D::Error> {
    let unit = String::deserialize(deserializer)?;
    let kinds = [JointKind::Turns, JointKind::Slides];
    let kind = kinds.into_iter().find(|kind| kind.unit() == unit);
    kind.ok_or_else(|| D::Error::custom(format!("found unit {unit:?}, expected \"rad\" or \"m\"")))
}
