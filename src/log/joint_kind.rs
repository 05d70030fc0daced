//! What our logs say of joints that slide, where no URDF does: one writer, one reader. And the doubt where nothing says it.

use std::collections::{BTreeMap, BTreeSet};

use crate::{
    arm::{names_a_cylinder, names_a_slide},
    remark::{Code, Remarks},
    series::JointKind,
    text::shell_word,
};

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

/// A remark on joints whose name is one of a joint that slides and that are taken as angles, for nothing says that they are lengths.
pub(super) fn doubt_sliding<'a>(turning: impl Iterator<Item = &'a str>, remarks: &mut Remarks) {
    let names: BTreeSet<&str> =
        turning.filter(|name| names_a_cylinder(name) || names_a_slide(name)).collect();
    let slides: Vec<_> = names.iter().map(|name| shell_word(name)).collect();
    let message = format!(
        "joints that nothing says to be lengths although their names are those of joints that slide, or of cylinders, taken as angles: {}; if they are \
         lengths, say --slides {} (in m; with =mm behind a name in mm)",
        names.iter().copied().collect::<Vec<_>>().join(", "),
        slides.join(",")
    );
    remarks.add(Code::Guessed, names.len() as u64, message);
}
