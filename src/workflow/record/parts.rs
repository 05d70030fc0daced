//! Names of the parts of a recording.

use std::path::{Path, PathBuf};

/// `run.mcap`, `run-2.mcap`, `run-3.mcap`.
pub(super) fn part_name(output: &Path, number: usize) -> PathBuf {
    if number == 1 { output.to_owned() } else { with_ending(output, &format!("-{number}")) }
}

/// `run*.mcap`.
pub(super) fn part_pattern(output: &Path) -> String {
    with_ending(output, "*").display().to_string()
}

fn with_ending(output: &Path, more: &str) -> PathBuf {
    let stem = output.file_stem().unwrap_or_default().to_string_lossy();
    let ending =
        output.extension().map(|ending| format!(".{}", ending.to_string_lossy())).unwrap_or_default();
    output.with_file_name(format!("{stem}{more}{ending}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_numbered_from_the_second_on() {
        let name = |number| part_name(Path::new("a/run.mcap"), number);
        assert_eq!([name(1), name(2)], [Path::new("a/run.mcap"), Path::new("a/run-2.mcap")]);
    }
}
