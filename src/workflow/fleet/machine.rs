//! Which machine a log is of.

use std::path::{Path, PathBuf};

use super::failure::FleetFailure;
use crate::{input_file, workflow::report::Findings};

/// Where the name of a log's machine stands.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum MachineFrom {
    /// In the log: the entry "machine" of its metadata.
    #[default]
    Log,
    /// In the path: a folder named `KEY=NAME`.
    Key(String),
    /// In the path: so many folders above the log, from 1.
    Above(usize),
    /// In the topic of the measurement: its first part.
    Topic,
    /// In a table: the row with the longest text that occurs in the path of the log, not within a word or number.
    Map(Vec<(String, String)>),
}

impl MachineFrom {
    /// Understands `log`, `path:KEY`, `path:NUMBER`, `topic` and the name of a CSV file.
    ///
    /// # Errors
    ///
    /// [`FleetFailure`] if the file cannot be read, or has no columns `path` and `machine`.
    pub fn parse(text: &str) -> Result<Self, FleetFailure> {
        Ok(match (text, text.strip_prefix("path:")) {
            ("log", _) => Self::Log,
            ("topic", _) => Self::Topic,
            (_, Some(key)) => match key.parse() {
                Ok(above) if above > 0 => Self::Above(above),
                _ => Self::Key(key.to_owned()),
            },
            (file, None) => Self::Map(table(Path::new(file))?),
        })
    }

    /// The machine of a log; `None` where nothing names it.
    pub fn of(&self, path: &Path, found: Option<&Findings>) -> Option<String> {
        let text = path.to_string_lossy();
        let named = match self {
            Self::Log => found?.report.machine.clone(),
            Self::Key(key) => text
                .split('/')
                .find_map(|part| part.strip_prefix(key.as_str())?.strip_prefix('='))
                .map(str::to_owned),
            Self::Above(above) => {
                path.ancestors().nth(*above)?.file_name().map(|name| name.to_string_lossy().into_owned())
            }
            Self::Topic => found?
                .report
                .source
                .measured_topic
                .split('/')
                .find(|part| !part.is_empty())
                .map(str::to_owned),
            Self::Map(rows) => {
                let fitting = rows.iter().filter(|(part, _)| occurs(part, &text));
                fitting.max_by_key(|(part, _)| part.len()).map(|(_, machine)| machine.clone())
            }
        };
        named.map(|name| name.trim().to_owned()).filter(|name| !name.is_empty())
    }
}

/// Whether a text has a part that no letter or digit goes on, on either side: `M1` is not in `M12`.
fn occurs(part: &str, text: &str) -> bool {
    let alone = |one: Option<char>, other: Option<char>| {
        !(one.is_some_and(char::is_alphanumeric) && other.is_some_and(char::is_alphanumeric))
    };
    text.match_indices(part).any(|(at, _)| {
        let (before, after) = (text[..at].chars().next_back(), text[at + part.len()..].chars().next());
        alone(before, part.chars().next()) && alone(part.chars().next_back(), after)
    })
}

fn table(path: &Path) -> Result<Vec<(String, String)>, FleetFailure> {
    let bad = |reason: String| FleetFailure::Machines { path: PathBuf::from(path), reason };
    let text = input_file::read_to_string(path).map_err(FleetFailure::file("read", path))?;
    let mut reader =
        csv::ReaderBuilder::new().trim(csv::Trim::All).flexible(true).from_reader(text.as_bytes());
    let header = reader.headers().map_err(|error| bad(error.to_string()))?.clone();
    let place = |name: &str| {
        let missing = || bad(format!("it has no column {name}"));
        header.iter().position(|heading| heading == name).ok_or_else(missing)
    };
    let (from, machine) = (place("path")?, place("machine")?);
    let mut rows = Vec::new();
    for row in reader.records() {
        let row = row.map_err(|error| bad(error.to_string()))?;
        let cell = |k: usize| row.get(k).unwrap_or_default().to_owned();
        if !cell(from).is_empty() {
            rows.push((cell(from), cell(machine)));
        }
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_and_tables_name_machines() {
        let log = Path::new("/logs/site=north/machine=M07/2026-03-01/run.mcap");
        let of = |text: &str| MachineFrom::parse(text).unwrap().of(log, None);
        assert_eq!(of("path:machine").as_deref(), Some("M07"));
        assert_eq!(of("path:1").as_deref(), Some("2026-03-01"));
        assert_eq!(of("path:2").as_deref(), Some("machine=M07"));
        assert_eq!((of("path:arm"), of("path:99"), of("log"), of("topic")), (None, None, None, None));
        let folder = tempfile::tempdir().unwrap();
        let map = folder.path().join("map.csv");
        std::fs::write(
            &map,
            "path, machine\nsite=north, all\nmachine=M07, seven\nM08,eight\nmachine=M07/2026-03-0,no\n",
        )
        .unwrap();
        assert_eq!(of(&map.to_string_lossy()).as_deref(), Some("seven"));
        std::fs::write(&map, "log,arm\na,b\n").unwrap();
        assert!(matches!(MachineFrom::parse(&map.to_string_lossy()), Err(FleetFailure::Machines { .. })));
        assert!(matches!(MachineFrom::parse("nowhere.csv"), Err(FleetFailure::File { .. })));
    }
}
