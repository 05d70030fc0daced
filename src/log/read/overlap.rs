//! Rejects files of one run whose samples overlap.

use std::collections::BTreeMap;

use super::{
    candidates::Candidate,
    content::{Content, Extracted, Source},
};
use crate::{
    log::{error::LogError, options::TimeBase, source::Table},
    remark::{Code, Remarks},
    units::{NS_PER_S, seconds_since},
};

/// Parts that meet may share this much: recorders split between threads.
const SHARED_S: f64 = 1.0;

/// Parts of one run are no farther apart, s.
const MOST_APART_S: f64 = 3600.0;

/// Nor by more than this and than they are long together, s.
const PAUSE_S: f64 = 10.0;

/// Rejects two files with samples of one joint in one topic for the same time, or far apart: the caller must say
/// which of them is the run. What is nearer and yet looks like two runs is remarked.
pub(super) fn check<'a>(
    extracted: &Extracted,
    chosen: impl IntoIterator<Item = &'a Candidate>,
    base: TimeBase,
) -> Result<Remarks, LogError> {
    // Joints of one topic may be in several tables.
    let mut of_topics: BTreeMap<usize, Vec<Part>> = BTreeMap::new();
    for candidate in chosen {
        let source = &extracted.sources[candidate.source];
        let (Content::Table(table), Some(field)) = (&source.content, candidate.field) else { continue };
        let parts = parts(source, table, table.stamps.of(base));
        for (k, a) in parts.iter().enumerate() {
            for b in &parts[k + 1..] {
                let from_ns = a.span_ns[0].max(b.span_ns[0]);
                let shared_s = seconds_since(from_ns, a.span_ns[1].min(b.span_ns[1]));
                let shortest_s = a.length_s().min(b.length_s());
                if shared_s > SHARED_S.min(shortest_s / 2.0) && tell_alike(table, field, a, b) {
                    let topic = extracted.topics[source.topic].topic.clone();
                    return Err(LogError::ToldTwice { topic, files: names(extracted, a, b), shared_s });
                }
            }
        }
        of_topics.entry(source.topic).or_default().extend(parts);
    }
    // A recorder may pause within a bag that it describes.
    let alone = of_topics.into_iter().filter(|_| !extracted.described);
    let mut remarks = Remarks::default();
    for (topic, mut parts) in alone {
        parts.sort_by_key(|part| part.span_ns);
        for two in parts.windows(2).filter(|two| two[0].file != two[1].file) {
            let apart_s = seconds_since(two[0].span_ns[1], two[1].span_ns[0]);
            let files = names(extracted, &two[0], &two[1]);
            if apart_s > MOST_APART_S {
                let topic = extracted.topics[topic].topic.clone();
                return Err(LogError::Apart { topic, files, apart_s });
            }
            let lengths_s = [0, 1].map(|k| two[k].length_s());
            if remarks.is_empty() && apart_s > PAUSE_S.max(lengths_s[0] + lengths_s[1]) {
                remarks.add(Code::SeveralRuns, 1, two_runs(&files, apart_s, lengths_s));
            }
        }
    }
    Ok(remarks)
}

fn two_runs([a, b]: &[String; 2], apart_s: f64, [a_s, b_s]: [f64; 2]) -> String {
    format!(
        "{a} ({a_s:.1} s) and {b} ({b_s:.1} s) are {apart_s:.1} s apart, longer than both are, and read as one run; if they are two, \
         `hydrotrace compare` says what changed between them, and `hydrotrace fleet` takes each log of a folder for a run"
    )
}

fn names(extracted: &Extracted, a: &Part, b: &Part) -> [String; 2] {
    let name = |part: &Part| extracted.files.get(part.file).map(|file| file.name.clone());
    [a, b].map(|part| name(part).unwrap_or_default())
}

/// The rows that one file gave to a table.
struct Part {
    file: usize,
    rows: std::ops::Range<usize>,
    span_ns: [i64; 2],
}

impl Part {
    fn length_s(&self) -> f64 {
        (self.span_ns[1] as f64 - self.span_ns[0] as f64) / NS_PER_S
    }
}

fn parts(source: &Source, table: &Table, stamp_ns: &[i64]) -> Vec<Part> {
    let ends = source.parts.iter().skip(1).map(|(_, row)| *row).chain([table.len()]);
    let part = |(&(file, start), end): (&(usize, usize), usize)| {
        let stamps = stamp_ns.get(start..end)?.iter().filter(|ns| **ns != 0);
        let span_ns = [*stamps.clone().min()?, *stamps.max()?];
        Some(Part { file, rows: start..end, span_ns })
    };
    source.parts.iter().zip(ends).filter_map(part).collect()
}

/// Whether both parts have numbers of one joint.
fn tell_alike(table: &Table, field: usize, a: &Part, b: &Part) -> bool {
    (0..table.joints.len()).any(|joint| {
        let column = table.column(field, joint);
        let told = |part: &Part| {
            column.get(part.rows.clone()).is_some_and(|rows| rows.iter().any(|value| value.is_finite()))
        };
        told(a) && told(b)
    })
}
