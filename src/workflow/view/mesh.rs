//! Where the files of an arm's meshes lie.

use std::path::{Path, PathBuf};

use crate::input_file;

/// Kinds of files that are taken for meshes; nothing else is opened, whatever a description says.
const KINDS: [&str; 5] = ["dae", "glb", "gltf", "obj", "stl"];
/// More than any mesh of an arm.
const LARGEST_BYTES: u64 = 256 << 20;

/// Where meshes are looked for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Places<'a> {
    /// The folder of the description that was given; without one nothing is looked for: a log names files of others.
    pub(super) folder: Option<&'a Path>,
    /// Folders that hold packages, or are one.
    pub(super) packages: &'a [PathBuf],
}

impl Places<'_> {
    /// The file of a mesh by its name in a description, which may begin with `package://` or `file://`.
    /// Packages are also looked for around the folder.
    pub(super) fn find(&self, uri: &str) -> Option<PathBuf> {
        let folder = self.folder?;
        let found = match uri.split_once("://") {
            Some(("package" | "model", rest)) => {
                let (package, rest) = rest.split_once('/')?;
                let around = self.packages.iter().map(PathBuf::as_path).chain(folder.ancestors());
                let mut candidates = around.flat_map(|place| {
                    let own =
                        (place.file_name().is_some_and(|name| name == package)).then(|| place.join(rest));
                    [Some(place.join(package).join(rest)), own]
                });
                candidates.find_map(|candidate| candidate.filter(|path| is_mesh(path)))?
            }
            Some(("file", rest)) => PathBuf::from(rest),
            Some(_) => return None,
            None => folder.join(uri),
        };
        let found = is_mesh(&found).then_some(found)?;
        // The viewer opens it.
        input_file::will_read(&found);
        Some(found)
    }
}

fn is_mesh(path: &Path) -> bool {
    let kind = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    KINDS.contains(&kind.as_str())
        && path.metadata().is_ok_and(|file| file.is_file() && file.len() <= LARGEST_BYTES)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn a_mesh_is_found_in_packages_around_the_description_and_by_path_and_nothing_else_is_opened() {
        let root = tempfile::tempdir().unwrap();
        let [package, other] = ["near/robot", "far/share/other"].map(|name| root.path().join(name));
        for (folder, file) in
            [(&package, "meshes/a.stl"), (&package, "urdf/b.OBJ"), (&other, "c.dae"), (&other, "d.txt")]
        {
            let path = folder.join(file);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, "solid").unwrap();
        }
        let (folder, packages) = (package.join("urdf"), [root.path().join("far/share")]);
        let places = Places { folder: Some(&folder), packages: &packages };
        assert_eq!(places.find("package://robot/meshes/a.stl"), Some(package.join("meshes/a.stl")));
        assert_eq!(places.find("package://other/c.dae"), Some(other.join("c.dae")));
        assert_eq!(places.find("b.OBJ"), Some(folder.join("b.OBJ")));
        let absolute = other.join("c.dae");
        assert_eq!(places.find(&format!("file://{}", absolute.display())), Some(absolute));
        for none in [
            "package://other/d.txt", "package://other", "package://robot/none.stl", "../meshes",
            "https://a/b.stl",
        ] {
            assert_eq!(places.find(none), None, "{none}");
        }
        assert_eq!(Places { packages: &[], ..places }.find("package://other/c.dae"), None);
        assert_eq!(Places { folder: None, ..places }.find("package://other/c.dae"), None);
    }
}
