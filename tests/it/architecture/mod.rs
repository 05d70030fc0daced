//! The form of the crate: layers, circles, sizes, who may depend on what.

mod circles;
mod dependencies;
mod imports;
mod layers;
mod sizes;

use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Rust files below a folder of the project, by path below it.
fn sources(folder: &str) -> Vec<(String, String)> {
    let base = root().join(folder);
    let mut files = Vec::new();
    walk(&base, &mut files);
    files.sort();
    assert!(!files.is_empty(), "no files found in {folder}");
    let shown = |file: &Path| file.strip_prefix(&base).unwrap().to_string_lossy().into_owned();
    files.iter().map(|file| (shown(file), std::fs::read_to_string(file).unwrap())).collect()
}

fn walk(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.ends_with("target") {
            // What a build of the fuzz targets made.
            continue;
        }
        if path.is_dir() {
            walk(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}
