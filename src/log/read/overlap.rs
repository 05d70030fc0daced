//! Rejects files of one run whose samples overlap.

use super::{
    candidates::Candidate,
    content::{Content, Extracted, Source},
};
use crate::{
    log::{error::LogError, options::TimeBase, source::Table},
    units::{NS_PER_S, seconds_since},
};

/// Parts that meet may share this much: recorders split between threads.
const SHARED_S: f64 = 1.0;

/// Parts of one run are no farther apart, s.
const MOST_APART_S: f64 = 3600.0;

/// Rejects two files with samples of one joint in one topic for the same time, or far apart: the caller must say
/// which of them is the run.
pub(super) fn check<'a>(
    extracted: &Extracted,
    chosen: impl IntoIterator<Item = &'a Candidate>,
    base: TimeBase,
) -> Result<(), LogError> {
    for candidate in chosen {
        let source = &extracted.sources[candidate.source];
        if source.parts.len() < 2 {
            continue;
        }
        let (Content::Table(table), Some(field)) = (&source.content, candidate.field) else { continue };
        let stamp_ns = table.stamps.of(base);
        let parts = parts(source, table, stamp_ns);
        let name = |part: &Part| extracted.files.get(part.file).map(|file| file.name.clone());
        let files = |a: &Part, b: &Part| [a, b].map(|part| name(part).unwrap_or_default());
        let topic = || extracted.topics[source.topic].topic.clone();
        for (k, a) in parts.iter().enumerate() {
            for b in &parts[k + 1..] {
                let from_ns = a.span_ns[0].max(b.span_ns[0]);
                let shared_s = seconds_since(from_ns, a.span_ns[1].min(b.span_ns[1]));
                let shortest_s = a.length_s().min(b.length_s());
                if shared_s > SHARED_S.min(shortest_s / 2.0) && tell_alike(table, field, a, b) {
                    return Err(LogError::ToldTwice { topic: topic(), files: files(a, b), shared_s });
                }
            }
        }
        let mut in_time: Vec<&Part> = parts.iter().collect();
        in_time.sort_by_key(|part| part.span_ns);
        for two in in_time.windows(2) {
            let apart_s = seconds_since(two[0].span_ns[1], two[1].span_ns[0]);
            // A recorder may pause within a bag that it describes.
            if apart_s > MOST_APART_S && !extracted.described {
                return Err(LogError::Apart { topic: topic(), files: files(two[0], two[1]), apart_s });
            }
        }
    }
    Ok(())
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
