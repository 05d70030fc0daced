//! The line that imports a table, for a person to paste.

use std::path::Path;

use super::options::{ReadOptions, Selector};
use crate::text::{shell_argument, shell_word};

/// What the caller gave to read a table as a log.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Given {
    /// What `import` takes as well, as words of a shell.
    words: Vec<String>,
    /// Whether more was given, which is for the verb that reads the log.
    more: bool,
}

impl Given {
    pub(super) fn of(options: &ReadOptions) -> Self {
        let ReadOptions {
            planned,
            measured,
            joints,
            time_base,
            range,
            slides,
            continuous,
            cylinders,
            map,
            ..
        } = options;
        let sides = [("--planned", planned), ("--measured", measured)];
        let columns =
            sides.map(|(option, all)| valued(option, &all.iter().filter_map(column).collect::<Vec<_>>()));
        let slide = valued(
            "--slides",
            &slides.iter().map(|(joint, unit)| format!("{joint}={}", unit.name())).collect::<Vec<_>>(),
        );
        let [first, second] = [options.planned_in_degrees, options.measured_in_degrees];
        let map = map.as_ref().map(|file| format!("--map {}", shell_word(&file.to_string_lossy())));
        let degrees = (first && second).then(|| "--degrees".to_owned());
        let of_log = planned.iter().chain(measured).any(|one| column(one).is_none());
        let more = of_log
            || first != second
            || time_base.is_some()
            || range.cuts()
            || cylinders.is_some()
            || options.measured_delay_ns.is_some()
            || !(joints.is_empty() && continuous.is_empty());
        Self { words: columns.into_iter().chain([slide, map, degrees]).flatten().collect(), more }
    }

    pub(super) fn words(&self) -> impl Iterator<Item = &String> {
        self.words.iter()
    }

    /// Whether an option is among them.
    pub(super) fn has(&self, option: &str) -> bool {
        self.words.iter().any(|word| word.split(' ').next() == Some(option))
    }

    /// The line that imports a table with these options and those that are missing.
    pub(super) fn line(&self, path: &Path, missing: &[String]) -> String {
        let missing = missing.iter().filter(|one| !self.has(one.split(' ').next().unwrap_or_default()));
        let words: Vec<&str> = missing.chain(self.words()).map(String::as_str).collect();
        line(path, &words, path)
    }

    /// What to do with the options that the line does not repeat.
    pub(super) fn rest(&self) -> &'static str {
        if self.more { ", with the other options of this line" } else { "" }
    }
}

fn valued(option: &str, values: &[String]) -> Option<String> {
    (!values.is_empty()).then(|| format!("{option} {}", shell_word(&values.join(","))))
}

/// `JOINT=COLUMN` of what was named as a topic of a table; `None` of what is a topic.
fn column(named: &Selector) -> Option<String> {
    let text = named.to_string();
    match () {
        () if text.contains('=') => Some(text),
        () if text.contains('/') => None,
        () => Some(format!("JOINT={text}")),
    }
}

/// The line that imports a table with options; the name of its output is that of the table, with a number where
/// a file has it already.
pub(super) fn line(table: &Path, options: &[&str], log: &Path) -> String {
    let (table, output) = (shell_argument(table), shell_argument(output(table, log)));
    ["hydrotrace import", &table]
        .iter()
        .chain(options)
        .chain(&["-o", &output])
        .copied()
        .collect::<Vec<_>>()
        .join(" ")
}

fn output(table: &Path, log: &Path) -> String {
    const PACKED: [&str; 3] = ["gz", "zst", "zstd"];
    let packed =
        table.extension().is_some_and(|ending| PACKED.iter().any(|one| ending.eq_ignore_ascii_case(one)));
    let inner = if packed { table.with_extension("") } else { table.to_owned() };
    let stem = inner.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let names = std::iter::once(format!("{stem}.mcap")).chain((2..).map(|k| format!("{stem}-{k}.mcap")));
    let taken = |name: &str| log.file_name().is_some_and(|log| *log == *name) || Path::new(name).exists();
    names.take(100).find(|name| !taken(name)).unwrap_or(format!("{stem}-new.mcap"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    use crate::log::{csv::LengthUnit, options::TimeBase};

    #[test]
    fn a_line_repeats_what_import_takes_and_its_output_has_the_name_of_the_table() {
        let line = |options: &ReadOptions, path: &str, missing: Option<&str>| {
            let (given, missing) = (Given::of(options), missing.map(str::to_owned));
            given.line(Path::new(path), missing.as_slice()) + given.rest()
        };
        let plain = ReadOptions::default();
        assert_eq!(line(&plain, "x/a b.csv.gz", None), "hydrotrace import 'x/a b.csv.gz' -o 'a b.mcap'");
        assert_eq!(
            line(&plain, "a.mcap", Some("--degrees")),
            "hydrotrace import a.mcap --degrees -o a-2.mcap"
        );
        let named = |all: &[&str]| all.iter().map(|one| Selector::parse(one)).collect();
        let options = ReadOptions {
            planned: named(&["a=p1", "b=p2"]),
            measured: named(&["raw 1"]),
            slides: BTreeMap::from([("a".to_owned(), LengthUnit::Metres)]),
            planned_in_degrees: true,
            measured_in_degrees: true,
            ..ReadOptions::default()
        };
        let words = "--planned a=p1,b=p2 --measured 'JOINT=raw 1' --slides a=m --degrees";
        assert_eq!(
            line(&options, "a.csv", Some("--degrees")),
            format!("hydrotrace import a.csv {words} -o a.mcap")
        );
        let more = ReadOptions { time_base: Some(TimeBase::Log), planned: named(&["/plan"]), ..plain };
        assert_eq!(
            line(&more, "a.csv", None),
            "hydrotrace import a.csv -o a.mcap, with the other options of this line"
        );
    }
}
