//! The words of `fleet`.

mod answers;
mod csv;
mod page;

pub(in crate::render) use answers::said;
pub(crate) use answers::{drift, effect, gate, gate_verdicts, worst};
pub(crate) use csv::{drift_csv, effect_csv, worst_csv};
pub(in crate::render) use page::{chart, days};
pub(crate) use page::{drift_page, effect_page, worst_page};

use std::path::Path;

use super::kit::{
    Block, Document, Id, NONE, Section, Sentence, Table, argument, command, counted, deg, fact, mm, ms, word,
};
use crate::{
    series::JointKind,
    units::degrees_from_radians,
    workflow::fleet::{By, Compacted, Intervention, Notes, Progress, Scanned},
};

/// How far a scan is, in a line.
pub(crate) fn progress(now: &Progress) -> String {
    let Progress { done, of, failed } = *now;
    let failed = if failed > 0 { format!(", {failed} failed") } else { String::new() };
    format!("{done} of {}{failed}", counted(of, "log"))
}

const MOST_FAILED: usize = 10;

pub(crate) fn scanned(scanned: &Scanned) -> Document {
    let Scanned { logs, unchanged, analysed, replaced, transitions, failures, .. } = scanned;
    let again = if *replaced > 0 { format!(", {replaced} of them again") } else { String::new() };
    let found =
        format!("{}: {analysed} analysed now{again}, {unchanged} known already.", counted(*logs, "log"));
    let mut section = Section::plain(Id::SUMMARY, [Sentence::finding(found)]);
    if *analysed > failures.len() {
        let written = format!(
            "Written to {}: {} of {}, {}.",
            scanned.into.display(),
            counted(analysed - failures.len(), "run"),
            counted(scanned.machines.len(), "machine"),
            counted(*transitions, "start")
        );
        section = section.with(Sentence::finding(written));
    }
    let lines = failures.iter().take(MOST_FAILED).map(|failure| {
        let name = failure.log.rsplit('/').next().unwrap_or_default();
        fact(name.to_owned(), failure.error.clone())
    });
    let lines: Vec<_> = lines.collect();
    if !lines.is_empty() {
        let first =
            if failures.len() > MOST_FAILED { format!("; the first {MOST_FAILED}") } else { String::new() };
        let shown = format!("{} could not be analysed{first}:", counted(failures.len(), "log"));
        section = section.with(Sentence::note(shown)).with(Block::Facts(lines));
    }
    if scanned.tables_left > 0 {
        section = section.with(Sentence::note(format!(
            "{} (.csv, .jsonl) beside the logs were left out; a pattern names them, such as 'FOLDER/**/*.csv'.",
            counted(scanned.tables_left, "table")
        )));
    }
    let into = argument(&scanned.into);
    let next = if scanned.machines.is_empty() && *analysed > 0 {
        let aim = "No log names its machine, and answers are by machine: scan again with --machine-from path:1, which takes the folder of \
                   each log, or as `hydrotrace fleet scan --help` says.";
        section.with(Sentence::advice(aim))
    } else {
        section
            .with(Sentence::advice("To see which joints change over the days:"))
            .with(Block::Command(command(&["fleet", "drift", &into])))
    };
    Document::default().with(next).remarked(&scanned.remarks)
}

/// What was done to machines, and the question that follows.
pub(crate) fn notes(notes: &Notes, made: Option<&Intervention>, dataset: &Path) -> Document {
    let Some(asked) = made.or(notes.interventions.last()) else {
        let none = Sentence::finding("Nothing is noted.");
        return Document::default().with(Section::plain(Id::SUMMARY, [none]));
    };
    let at = |one: &Intervention| one.at.strip_suffix("T00:00:00Z").unwrap_or(&one.at).to_owned();
    let rows = notes.interventions.iter().map(|one| {
        let joint = one.joint.clone().unwrap_or_else(|| NONE.to_owned());
        vec![at(one), one.machine.clone(), joint, one.what.clone()]
    });
    let table = Table::new(&["at", "machine", "joint", "what"], &[], rows);
    let (machine, at) = (format!("--machine={}", word(&asked.machine)), format!("--at={}", at(asked)));
    let joint = asked.joint.as_ref().map(|joint| format!("--joint={}", word(joint)));
    let dataset = argument(dataset);
    let next: Vec<&str> =
        ["fleet", "effect", &dataset, &machine, &at].into_iter().chain(joint.as_deref()).collect();
    let section = Section::plain(Id::SUMMARY, [table])
        .with(Sentence::advice("To see what it did:"))
        .with(Block::Command(command(&next)));
    Document::default().with(section)
}

pub(crate) fn compacted(done: &Compacted) -> Document {
    let Compacted { runs, files_before, files_after, .. } = *done;
    let now = format!("{} in {}", counted(runs, "run"), counted(files_after, "file"));
    let joined = files_before > files_after;
    let found =
        if joined { format!("{now} now, {files_before} before.") } else { now + ": nothing to join." };
    Document::default().with(Section::plain(Id::SUMMARY, [Sentence::finding(found)]))
}

fn name(by: By) -> &'static str {
    match by {
        By::Peak => "peak error",
        By::Delay => "dead time",
        By::Lag => "lag",
    }
}

/// The unit that people read, for a unit of a document.
pub(in crate::render) fn shown_unit(unit: &str) -> &'static str {
    match unit {
        "s" => "ms",
        unit if unit == JointKind::Slides.unit() => "mm",
        _ => "deg",
    }
}

/// A value in the unit that people read, without it.
pub(in crate::render) fn shown(unit: &str, value: f64) -> String {
    match shown_unit(unit) {
        "ms" => ms(value),
        "mm" => mm(value),
        _ => deg(value),
    }
}

/// The same of a difference, with more decimals: what a day brings is small.
fn shown_change(unit: &str, value: f64) -> String {
    let text = match shown_unit(unit) {
        "ms" => format!("{:.1}", 1e3 * value),
        "mm" => format!("{:.3}", 1e3 * value),
        _ => deg(value),
    };
    super::kit::signed(value, |_| text.clone())
}

/// A change a day in its unit, without its name: with two digits at least that say something, however slow it is.
fn shown_rate(unit: &str, value: f64) -> String {
    let size = value.abs()
        * match shown_unit(unit) {
            "ms" | "mm" => 1e3,
            _ => degrees_from_radians(1.0),
        };
    let usual = if shown_unit(unit) == "ms" { 1 } else { 3 };
    let decimals = (usual..7).find(|decimals| size >= 10.0_f64.powi(1 - decimals)).unwrap_or(usual);
    let decimals = usize::try_from(if size > 0.0 { decimals } else { usual }).unwrap_or_default();
    super::kit::signed(value, |_| format!("{:.decimals$}", size.copysign(value)))
}

fn day(at: &str) -> &str {
    at.split('T').next().unwrap_or(at)
}
