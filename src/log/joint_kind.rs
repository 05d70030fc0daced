//! What our logs say of joints that slide, where no URDF does: one writer, one reader.

use std::collections::{BTreeMap, BTreeSet};

use crate::series::JointKind;

/// Name of the metadata: joint to how it moves.
pub(crate) const METADATA: &str = "hydrotrace.joints";

const SLIDES: &str = "slides";

/// The entries for joints that slide; those that turn need none.
pub(crate) fn entries<'a>(joints: impl Iterator<Item = (&'a str, JointKind)>) -> BTreeMap<String, String> {
    let sliding = joints.filter(|(_, kind)| *kind == JointKind::Slides);
    sliding.map(|(joint, _)| (joint.to_owned(), SLIDES.to_owned())).collect()
}

/// Names of the joints that slide.
pub(super) fn sliding(metadata: &BTreeMap<String, BTreeMap<String, String>>) -> BTreeSet<String> {
    let joints = metadata.get(METADATA).into_iter().flatten();
    joints.filter(|(_, kind)| *kind == SLIDES).map(|(joint, _)| joint.clone()).collect()
}
