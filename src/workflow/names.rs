//! Names of logs.

use std::path::{Component, Path, PathBuf};

/// The name of each log: that of its file, behind as many of its folders as tell it from others of that name.
pub(super) fn told_apart(paths: &[PathBuf]) -> Vec<String> {
    let of = |path: &PathBuf| {
        let differs = |parts: &usize| {
            paths.iter().filter(|other| *other != path).all(|other| last(other, *parts) != last(path, *parts))
        };
        last(path, (1..=path.components().count()).find(differs).unwrap_or(1))
    };
    paths.iter().map(of).collect()
}

/// The last parts of a path.
fn last(path: &Path, parts: usize) -> String {
    let all: Vec<Component<'_>> = path.components().collect();
    all[all.len().saturating_sub(parts)..].iter().collect::<PathBuf>().to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logs_of_one_name_are_told_by_as_much_of_their_folders_as_differs() {
        let names = |paths: &[&str]| told_apart(&paths.iter().map(PathBuf::from).collect::<Vec<_>>());
        assert_eq!(names(&["a/run.mcap"]), ["run.mcap"]);
        assert_eq!(names(&["a/run.mcap", "a/run-2.mcap"]), ["run.mcap", "run-2.mcap"]);
        assert_eq!(names(&["x/1/run.mcap", "x/2/run.mcap", "3.csv"]), ["1/run.mcap", "2/run.mcap", "3.csv"]);
        assert_eq!(names(&["1/x/run.mcap", "2/x/run.mcap"]), ["1/x/run.mcap", "2/x/run.mcap"]);
        assert_eq!(names(&["run.mcap", "old/run.mcap"]), ["run.mcap", "old/run.mcap"]);
        assert_eq!(names(&["run.mcap", "run.mcap"]), ["run.mcap"; 2], "one twice");
        assert_eq!(names(&["/", ""]), ["/", ""]);
    }
}
