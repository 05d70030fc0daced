//! How well the detector finds starts.

use serde::Serialize;

use super::kit::{Document, Id, NONE, Section, Sentence, Table, ms};
use crate::{
    document,
    replay::{Score, Spread},
    units::degrees_from_radians,
};

#[derive(Serialize)]
struct Json<'a> {
    format: &'static str,
    program: &'static str,
    seed: u64,
    rows: &'a [Score],
}

/// As JSON.
pub fn json(seed: u64, scores: &[Score]) -> String {
    document::pretty(&Json {
        format: "hydrotrace.detector.v1",
        program: document::PROGRAM,
        seed,
        rows: scores,
    })
}

/// As a table.
pub fn document(seed: u64, scores: &[Score]) -> Document {
    let spread = |s: &Spread| format!("{} +-{}", ms(s.median_s), ms(s.mad_sd_s));
    let rows = scores.iter().map(|s| {
        vec![
            format!("{:.3}", degrees_from_radians(s.sensing.sigma_rad)),
            s.sensing.lsb_rad.map_or(NONE.to_owned(), |lsb| format!("{:.2}", degrees_from_radians(lsb))),
            format!("{:.0}", s.sensing.rate_hz),
            s.runs.to_string(),
            s.starts.to_string(),
            format!("{:.3}", s.precision),
            format!("{:.3}", s.recall),
            spread(&s.onset_sharp),
            spread(&s.onset_smooth),
            spread(&s.delay_sharp),
            spread(&s.delay_smooth),
            format!("{:.2}", s.delay_coverage),
            format!("{:.2}", s.stop_precision),
            format!("{:.2}", s.stop_recall),
        ]
    });
    let numbers = [
        "noise deg",
        "LSB deg",
        "Hz",
        "runs",
        "starts",
        "precision",
        "recall",
        "sharp ms",
        "smooth ms",
        "delay sharp ms",
        "delay smooth ms",
        "coverage",
        "stop P",
        "stop R",
    ];
    let found = format!(
        "Starts found on synthetic joints with known motions, seed {seed}. Errors of the onset and of the delay: \
         median +- robust standard deviation; coverage is the share of delays inside their 95 % interval."
    );
    let section = Section::plain(Id::SUMMARY, [Sentence::note(found)]).with(Table::new(&[], &numbers, rows));
    Document::default().with(section)
}
