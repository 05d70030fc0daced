//! What an imported log was read from.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};

use crate::{
    log::{
        csv::{
            GIVEN_OF_ORIGIN, GUESSED_OF_ORIGIN, LengthUnit, TIME_OF_ORIGIN, UNDATED_OF_ORIGIN,
            UNIT_OF_ORIGIN, UNUSED_OF_ORIGIN, is_angle,
        },
        error::LogError,
        import_line::{Given, line},
        options::ReadOptions,
        write::Topics,
    },
    series::Series,
    text::shell_word,
};

const SIDES: [&str; 2] = ["planned", "measured"];

/// What a log that was imported tells of its table.
pub(super) struct Imported<'a> {
    /// Its name.
    pub(super) file: &'a str,
    /// What became of which column.
    origin: &'a BTreeMap<String, String>,
}

/// The joints of an imported table whose columns had a unit.
pub(super) fn joints_with_unit(origin: &BTreeMap<String, String>) -> impl Iterator<Item = &str> {
    origin.keys().filter_map(|key| Some(key.strip_prefix(UNIT_OF_ORIGIN)?.split_once(" position of ")?.1))
}

impl<'a> Imported<'a> {
    /// `None` of a log that was recorded, or of several tables, of which none is the one.
    pub(super) fn of(tables: &'a [BTreeMap<String, String>]) -> Option<Self> {
        let [origin] = tables else { return None };
        Self::one(origin)
    }

    pub(super) fn one(origin: &'a BTreeMap<String, String>) -> Option<Self> {
        Some(Self { file: origin.get("file")?, origin })
    }

    /// The joints and columns that it has positions of.
    fn positions(&self) -> impl Iterator<Item = (&'a str, &'a str)> {
        let joint = |key: &'a str| {
            let (side, joint) = key.split_once(" position of ")?;
            let of_unit = [UNIT_OF_ORIGIN, GUESSED_OF_ORIGIN].iter().any(|begins| side.starts_with(begins));
            (!of_unit).then_some(joint)
        };
        self.origin.iter().filter_map(move |(key, column)| Some((joint(key)?, column.as_str())))
    }

    /// An error where an option would convert positions of an imported log to rad that were when its table was read.
    pub(super) fn check(tables: &[BTreeMap<String, String>], options: &ReadOptions) -> Result<(), LogError> {
        tables.iter().filter_map(Imported::one).try_for_each(|table| table.check_one(options))
    }

    fn check_one(&self, options: &ReadOptions) -> Result<(), LogError> {
        let degrees = [
            ("--planned-degrees", options.planned_in_degrees),
            ("--measured-degrees", options.measured_in_degrees),
        ];
        for ((option, given), side) in degrees.into_iter().zip(SIDES) {
            let mut stated = self.stated(side).filter(|_| given);
            stated
                .next()
                .map_or(Ok(()), |(joint, unit)| Err(self.converted_before(option, (side, joint), unit)))?;
        }
        // Metres are what a log holds, unless its table held angles.
        let converts = |joint: &str, unit: &str| {
            options.slides.get(joint).is_some_and(|to| *to != LengthUnit::Metres || is_angle(unit))
        };
        for side in SIDES {
            let mut stated = self.stated(side).filter(|(joint, unit)| converts(joint, unit));
            stated.next().map_or(Ok(()), |(joint, unit)| {
                Err(self.converted_before("--slides", (side, joint), unit))
            })?;
        }
        Ok(())
    }

    /// Whether positions of a side were taken as degrees already, by a guess that an option then confirms.
    pub(super) fn guessed_degrees(tables: &[BTreeMap<String, String>], side: &str) -> bool {
        let begins = format!("{GUESSED_OF_ORIGIN}{side} position of ");
        let mut all = tables.iter().flatten();
        all.any(|(key, unit)| key.starts_with(&begins) && unit == "deg")
    }

    /// The joints whose positions on a side had a unit, and which.
    fn stated(&self, side: &str) -> impl Iterator<Item = (&'a str, &'a str)> + use<'a> {
        let begins = format!("{UNIT_OF_ORIGIN}{side} position of ");
        self.origin.iter().filter_map(move |(key, unit)| Some((key.strip_prefix(&begins)?, unit.as_str())))
    }

    fn converted_before(&self, option: &'static str, (side, joint): (&str, &str), unit: &str) -> LogError {
        let header = self.origin.get(&format!("{side} position of {joint}")).cloned().unwrap_or_default();
        LogError::ConvertedBefore { option, header, unit: unit.to_owned(), file: self.file.to_owned() }
    }

    /// Whether it has a column of this name.
    pub(super) fn has(&self, column: &str) -> bool {
        let unused = self.origin.get(UNUSED_OF_ORIGIN).map_or("", String::as_str);
        self.positions().any(|(_, used)| used == column) || unused.split(", ").any(|one| one == column)
    }

    /// Its columns, in use or not.
    pub(super) fn columns(&self) -> String {
        let used: Vec<&str> = self.positions().map(|(_, column)| column).collect();
        let unused = self.origin.get(UNUSED_OF_ORIGIN);
        let unused = unused.map_or(String::new(), |unused| format!(", whose columns {unused} were not used"));
        format!("{} of {}{unused}", used.join(", "), self.file)
    }

    /// Where the table is, of one that was read with a log or from it: beside it, if it is there.
    pub(super) fn place(&self, log: &Path) -> PathBuf {
        let beside = log.with_file_name(self.file);
        if beside.exists() { beside } else { PathBuf::from(self.file) }
    }

    /// The line that imports it again with what is given now, and with columns of an option that lacks them, which are to
    /// be filled in. `path` is where the log was read from: the table itself, if it has its name.
    pub(super) fn import_line(&self, path: &Path, lacking: Option<&str>, given: &Given) -> String {
        let file = self.place(path);
        let columns =
            self.positions().map(|(joint, _)| format!("{joint}=COLUMN")).collect::<Vec<_>>().join(",");
        let mut words = self.given_but(|option| given.has(option) || lacking == Some(option));
        words.extend(
            given.words().filter(|word| lacking.is_none_or(|option| !word.starts_with(option))).cloned(),
        );
        words.extend(lacking.map(|option| format!("{option} {}", shell_word(&columns))));
        line(&file, &words.iter().map(String::as_str).collect::<Vec<_>>(), path)
    }

    /// The options that it was imported with, but for some.
    fn given_but(&self, but: impl Fn(&str) -> bool) -> Vec<String> {
        let given = self.origin.iter().filter_map(|(key, value)| {
            let (_, given) = key.strip_prefix(GIVEN_OF_ORIGIN)?.split_once(' ')?;
            (!but(given)).then_some((given, value))
        });
        let words = given.map(|(given, value)| match value.as_str() {
            "" => given.to_owned(),
            value => format!("{given} {}", shell_word(value)),
        });
        words.collect()
    }
}

/// Columns of a table, or fields of messages, that an imported log was read from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Origin {
    /// Name of the file that had them.
    pub file: String,
    /// Name of the file of the measurement, where that is another.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured_file: Option<String>,
    /// Headers of the plan, by joint; none if the plan is from elsewhere.
    pub planned: Vec<String>,
    /// Headers of the measurement, by joint; none if it is from elsewhere.
    pub measured: Vec<String>,
    /// Column of the time, and its form; of several tables, those of each that differ.
    pub time: String,
    /// Whether its times say no date, but count from a fixed instant.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub undated: bool,
}

impl Origin {
    /// `None` of a log that was recorded, or of which other topics are read.
    pub(super) fn of(
        tables: &[BTreeMap<String, String>],
        topics: [&String; 2],
        series: [&Series; 2],
    ) -> Option<Self> {
        let [planned, measured] = [0, 1].map(|side| {
            let of = |table| (table, headers(table, topics[side], series[side]));
            tables.iter().map(of).find(|(_, headers)| !headers.is_empty())
        });
        let used: Vec<_> = [&planned, &measured].into_iter().flatten().map(|(table, _)| *table).collect();
        let text = |key: &str| {
            let mut texts: Vec<String> = used
                .iter()
                .filter_map(|table| table.get(key))
                .filter(|text| !text.is_empty())
                .cloned()
                .collect();
            texts.dedup();
            texts
        };
        let mut files = text("file").into_iter();
        Some(Self {
            file: used.first().and_then(|_| files.next())?,
            measured_file: files.next(),
            planned: planned.map_or_else(Vec::new, |(_, headers)| headers),
            measured: measured.map_or_else(Vec::new, |(_, headers)| headers),
            time: text(TIME_OF_ORIGIN).join("; "),
            undated: used.iter().any(|table| table.contains_key(UNDATED_OF_ORIGIN)),
        })
    }
}

/// The headers that became the positions of a topic of ours.
fn headers(table: &BTreeMap<String, String>, topic: &String, series: &Series) -> Vec<String> {
    let known = Topics::default();
    let becomes = [
        (&known.planned, "planned position"),
        (&known.measured, "measured position"),
        (&known.command, "command position"),
    ];
    let becomes = becomes.iter().find(|(one, _)| *one == topic).map(|(_, becomes)| becomes);
    let header =
        |joint: &str| table.get(&format!("{} of {joint}", becomes?)).filter(|one| !one.is_empty()).cloned();
    series.tracks.iter().filter_map(|track| header(track.name())).collect()
}
