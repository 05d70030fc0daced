//! Finds the files of one recording, in order, from paths of files and bag directories.

use std::path::{Path, PathBuf};

use yaml_rust2::parser::{Event, Parser};

use super::error::LogError;
use crate::{
    input_file,
    remark::{Code, Remarks},
};

/// The files that together are one recording: files as given, bag directories opened.
///
/// # Errors
///
/// [`LogError`] if a directory is no bag, or of another storage.
pub fn recording_files(paths: &[PathBuf], remarks: &mut Remarks) -> Result<Vec<PathBuf>, LogError> {
    let mut files = Vec::new();
    for path in paths {
        if path.is_dir() {
            files.extend(directory(path, remarks)?);
        } else {
            files.push(path.clone());
        }
    }
    Ok(files)
}

fn directory(path: &Path, remarks: &mut Remarks) -> Result<Vec<PathBuf>, LogError> {
    let description = path.join(DESCRIPTION);
    if description.is_file() {
        let named = named_files(&description)?;
        let (there, missing): (Vec<_>, Vec<_>) =
            named.into_iter().map(|name| path.join(name)).partition(|p| p.is_file());
        for absent in &missing {
            let name = absent.file_name().unwrap_or_default().to_string_lossy();
            remarks.add(
                Code::MissingFile,
                1,
                format!("metadata.yaml names {name}, which is not there; read without it"),
            );
        }
        if !there.is_empty() {
            return Ok(there);
        }
    }
    let entries = std::fs::read_dir(path).map_err(LogError::file("read", path))?;
    let entries: Vec<PathBuf> = entries.filter_map(|entry| entry.ok().map(|entry| entry.path())).collect();
    let ending = |ending: &&str| {
        let named = |path: &&PathBuf| path.to_string_lossy().to_lowercase().ends_with(*ending);
        entries.iter().filter(named).cloned().collect::<Vec<PathBuf>>()
    };
    let mut found = ENDINGS.iter().map(ending).find(|found| !found.is_empty()).unwrap_or_default();
    found.sort_by_key(|path| natural_key(path));
    if found.is_empty() {
        return Err(LogError::EmptyBag { path: path.to_owned() });
    }
    Ok(found)
}

/// `relative_file_paths` of a rosbag2 description.
fn named_files(description: &Path) -> Result<Vec<String>, LogError> {
    let bad = |reason: String| LogError::BagMetadata { path: description.to_owned(), reason };
    let text = input_file::read_to_string(description).map_err(LogError::file("read", description))?;
    let mut names = None;
    let mut key = String::new();
    // Walked as events: a tree would let aliases and nesting ask for any amount of memory.
    let mut parser = Parser::new_from_str(&text);
    loop {
        match parser.next_token().map_err(|error| bad(error.to_string()))?.0 {
            Event::StreamEnd => break,
            Event::Scalar(value, ..) => match key.as_str() {
                LIST => names.get_or_insert_with(Vec::new).push(value),
                "storage_identifier" if !STORAGES.contains(&value.as_str()) => {
                    return Err(bad(format!(
                        "storage is {value:?}, expected \"mcap\" or \"sqlite3\"; convert with `ros2 bag convert` to \
                         MCAP storage"
                    )));
                }
                "storage_identifier" => key.clear(),
                _ => key = value,
            },
            Event::SequenceStart(..) if key == LIST => names = Some(Vec::new()),
            Event::SequenceStart(..) | Event::SequenceEnd | Event::MappingStart(..) | Event::MappingEnd => {
                key.clear();
            }
            _ => {}
        }
    }
    names.ok_or_else(|| bad(format!("it has no list {LIST}")))
}

const STORAGES: [&str; 2] = ["mcap", "sqlite3"];
/// Endings of the files of a bag, the first one counts where it is there with several.
const ENDINGS: [&str; 4] = [".mcap", ".db3", ".mcap.zstd", ".db3.zstd"];

/// What a recorder says of the files of its bag.
pub(super) const DESCRIPTION: &str = "metadata.yaml";

const LIST: &str = "relative_file_paths";

/// Orders `run_2` before `run_10`, and `run` before its next part, `run-2`.
fn natural_key(path: &Path) -> Vec<(u64, String)> {
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut key = Vec::new();
    let mut rest = name.as_str();
    while !rest.is_empty() {
        let text_end = rest.find(|c: char| c.is_ascii_digit()).unwrap_or(rest.len());
        let (text, after) = rest.split_at(text_end);
        let digits_end = after.find(|c: char| !c.is_ascii_digit()).unwrap_or(after.len());
        let (digits, after) = after.split_at(digits_end);
        key.push((0, text.to_owned()));
        key.push((digits.parse().unwrap_or(u64::MAX), String::new()));
        rest = after;
    }
    key
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_ordered_as_people_count() {
        let mut names: Vec<PathBuf> = ["run_10.mcap", "run_2.mcap", "run_1.mcap"].map(PathBuf::from).to_vec();
        names.sort_by_key(|path| natural_key(path));
        assert_eq!(names, ["run_1.mcap", "run_2.mcap", "run_10.mcap"].map(PathBuf::from));
        let mut names: Vec<PathBuf> = ["run-10.mcap", "run-2.mcap", "run.mcap"].map(PathBuf::from).to_vec();
        names.sort_by_key(|path| natural_key(path));
        assert_eq!(names, ["run.mcap", "run-2.mcap", "run-10.mcap"].map(PathBuf::from));
    }

    #[test]
    fn a_bag_of_another_storage_says_how_to_convert_it() {
        let folder = tempfile::tempdir().unwrap();
        let text =
            "rosbag2_bagfile_information:\n  storage_identifier: hdf5\n  relative_file_paths: [a.h5]\n";
        std::fs::write(folder.path().join("metadata.yaml"), text).unwrap();
        let error =
            recording_files(&[folder.path().to_owned()], &mut Remarks::default()).unwrap_err().to_string();
        assert!(error.contains("hdf5") && error.contains("ros2 bag convert"), "{error}");
    }
}
