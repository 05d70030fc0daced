//! What a file holds, by its structure alone: to say what would be lost with it.

use std::{collections::BTreeSet, fs::File, path::Path};

use super::{
    channel::Definitions,
    csv::MAP_BEGINS,
    file::{Source, Span, scan},
    looks::{LOOKED_AT, is_document, is_table},
};

/// What a file holds, as far as its first bytes and its records tell.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Contents {
    /// An MCAP log.
    Log {
        /// Names of its topics; empty of a log without a summary.
        topics: BTreeSet<String>,
        /// Names of its metadata.
        metadata: BTreeSet<String>,
    },
    /// A recording of another format, or what belongs to one, and which.
    Recording(&'static str),
    /// Columns in Parquet, and whether this program wrote them.
    Parquet(bool),
    /// Rows of cells, and the first line.
    Table(String),
    /// A page for browsers, and its first bytes.
    Page(String),
    /// Anything else that this program did not write: a task, an arm, notes, a damaged recording.
    Foreign,
    /// What this program wrote beside these, a picture of points, or nothing.
    Other,
}

/// Formats of recordings, and of what this program never writes, by their first bytes.
const RECORDINGS: [(&[u8], &str); 10] = [
    (b"\x1F\x8B", "a packed file"),
    (b"\x28\xB5\x2F\xFD", "a packed file"),
    (b"PK\x03\x04", "an archive or a workbook"),
    (b"%PDF", "a PDF document"),
    (b"\x7FELF", "a program"),
    (b"SQLite format 3\0", "a database, as ROS 2 bags are"),
    (b"#ROSBAG", "a ROS 1 bag"),
    (b"MDF     ", "an MF4 recording"),
    (b"ULog", "a ULog recording"),
    (b"rosbag2_bagfile_information", "the description of a ROS 2 bag"),
];

const PARQUET: &[u8] = b"PAR1";
/// Bytes of its end that are looked at.
const FOOTER: u64 = 1 << 16;
/// What the end of a Parquet table holds that this program wrote.
const OWN_PARQUET: &[u8] = concat!("hydrotrace ", env!("CARGO_PKG_VERSION_MAJOR"), ".").as_bytes();
/// What documents, layouts and settings begin with that this program wrote.
const OWN_TEXTS: [&str; 5] =
    ["{\n  \"format\": \"hydrotrace.", "{\n  \"configById\": {", LIMITS_BEGIN, MAP_BEGINS, "separator = \""];
/// What its figures and manual pages hold near their beginning.
const OWN_PARTS: [[&str; 2]; 2] = [["<svg xmlns", "stroke-linejoin=\"round\">"], [".ie ", ".TH hydrotrace"]];
/// The last line of a text that the program wrote to a file, which has no other mark; in Markdown within a comment.
pub const WRITTEN: &str = "Written by hydrotrace.";
/// Bytes of the end of a text that hold it.
const LAST_LINE: u64 = 64;
/// What pictures of points and recordings of the viewer begin with: whose they are nothing tells.
const ANYBODYS: [&[u8]; 2] = [b"\x89PNG", b"RRF"];
/// The first line of limits.
const LIMITS_BEGIN: &str = "# What a machine does with what it is sent, as `hydrotrace fit` found it";
const TIMES: [&str; 4] = ["\"t\"", "\"time", "time\"", "stamp\""];

/// What a file holds. Its name is not remembered as that of an input. A pipe, which is there once, is not looked into.
///
/// # Errors
///
/// As the file system says.
pub fn contents(path: &Path) -> std::io::Result<Contents> {
    if !path.metadata()?.is_file() {
        return Ok(Contents::Other);
    }
    let source = Source::of(File::open(path)?)?;
    let mut bytes = Vec::new();
    source.read(LOOKED_AT, &mut bytes)?;
    if let Some((_, what)) = RECORDINGS.iter().find(|(start, _)| bytes.starts_with(start)) {
        return Ok(Contents::Recording(what));
    }
    if bytes.starts_with(PARQUET) {
        let end = source.length();
        source.read(Span { start: end.saturating_sub(FOOTER), end }, &mut bytes)?;
        let own = bytes.windows(OWN_PARQUET.len()).any(|part| part == OWN_PARQUET);
        return Ok(Contents::Parquet(own));
    }
    let layouts = scan(&source);
    if !layouts.is_empty() {
        let channels = layouts.iter().flat_map(|one| Definitions::gather(one, &source, false).channels);
        return Ok(Contents::Log {
            topics: channels.map(|(_, channel)| channel.topic).collect(),
            metadata: layouts.into_iter().flat_map(|one| one.metadata).map(|one| one.name).collect(),
        });
    }
    let start = String::from_utf8_lossy(&bytes);
    if ["<!doctype html", "<html"].iter().any(|tag| begins(&start, tag)) {
        return Ok(Contents::Page(start.into_owned()));
    }
    if start.contains("<robot ") {
        return Ok(Contents::Recording("a robot description"));
    }
    // Settings have lists, too, and no time.
    let timed = || is_document(path, &bytes) && TIMES.iter().any(|key| start.contains(key));
    if !is_text(path, &start) && (is_table(path, &bytes) || timed()) {
        let line = bytes.split(|byte| *byte == b'\n').next().unwrap_or_default();
        return Ok(Contents::Table(String::from_utf8_lossy(line).into_owned()));
    }
    let anybodys = bytes.is_empty() || ANYBODYS.iter().any(|begins| bytes.starts_with(begins));
    let own = anybodys || is_own(&start) || {
        let end = source.length();
        source.read(Span { start: end.saturating_sub(LAST_LINE), end }, &mut bytes)?;
        let last = String::from_utf8_lossy(&bytes);
        last.trim_end().trim_end_matches("-->").trim_end().ends_with(WRITTEN)
    };
    Ok(if own { Contents::Other } else { Contents::Foreign })
}

/// Whether a file holds words or a document, which tables of cells are not told from by their separators alone: Markdown that
/// does not begin with a printed table, and what this program writes.
fn is_text(path: &Path, start: &str) -> bool {
    let words = ["md", "markdown"].iter().any(|one| is_named(path, one));
    words && !start.trim_start().starts_with('|') || is_own(start)
}

fn is_own(start: &str) -> bool {
    OWN_TEXTS.iter().any(|text| start.starts_with(text))
        || OWN_PARTS.iter().any(|[begins, holds]| start.starts_with(begins) && start.contains(holds))
}

fn is_named(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|end| end.eq_ignore_ascii_case(ending))
}

/// Whether a text begins with a tag, in letters of any case, behind a mark of its encoding and comments.
fn begins(text: &str, tag: &str) -> bool {
    let mut text = text.trim_start_matches('\u{feff}').trim_start();
    while let Some((_, rest)) = text.strip_prefix("<!--").and_then(|text| text.split_once("-->")) {
        text = rest.trim_start();
    }
    text.get(..tag.len()).is_some_and(|start| start.eq_ignore_ascii_case(tag))
}
