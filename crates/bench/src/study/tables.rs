//! As tables.

use hydrotrace::render::kit::{Document, Id, NONE, Section, Sentence, Table};

use super::{Cell, Column, Form, Measure, Sample, Study, Tally, Verdict};

/// For a terminal, or as Markdown.
pub fn document(form: &Form, study: &Study) -> Document {
    let (words, numbers, row) = form.reference;
    let references = Table::new(words, numbers, study.references.iter().map(row));
    let columns = form.measures.iter().flat_map(|measure| match measure.column {
        Column::Compared => vec![measure.heading, "p, A"],
        Column::Median => vec![measure.heading],
    });
    let columns: Vec<&str> = std::iter::once("evaluations").chain(columns).collect();
    let cells = study.cells.iter().map(|cell| cell_row(form, cell));
    let cells = Table::new(&[form.subject, "algorithm"], &columns, cells);
    let missed = study.cells.iter().filter_map(missed).map(Sentence::Finding);
    let mut document = Document::titled(form.title)
        .with(Section::plain(Id::METHOD, study.notes.iter().cloned().map(Sentence::Note)))
        .with(Section::new(Id::OTHER, "Measured against", [references]))
        .with(Section::new(Id::SUMMARY, form.heading, [cells]).with_all(missed));
    if !study.tallies.is_empty() {
        let tallied: Vec<&Measure> =
            form.measures.iter().filter(|measure| !measure.tally.is_empty()).collect();
        let columns: Vec<&str> = tallied.iter().map(|measure| measure.tally).collect();
        let rows = study.tallies.iter().map(|tally| tally_row(&tallied, tally));
        let tallies = Table::new(&["algorithm"], &columns, rows);
        let heading = format!("Wins, ties and losses against {}", study.baseline);
        document.sections.push(Section::new(Id::OTHER, heading, [tallies]));
    }
    document.sections.extend((form.paper)(study));
    document
}

fn cell_row(form: &Form, cell: &Cell) -> Vec<String> {
    // The evaluations made, if they are not those asked for.
    let made = if cell.made == cell.evaluations {
        cell.evaluations.to_string()
    } else {
        format!("{} ({})", cell.evaluations, cell.made)
    };
    let mut row = vec![cell.subject.clone(), cell.algorithm.clone(), made];
    for measure in form.measures {
        let Some(sample) = cell.samples.get(measure.key) else { continue };
        let show = |value: f64, digits| {
            if value.is_nan() || (value.is_infinite() && measure.column == Column::Median) {
                NONE.to_owned()
            } else {
                (measure.show)(value, digits)
            }
        };
        match measure.column {
            Column::Compared => {
                let Sample { q1, median, q3, .. } = *sample;
                row.push(format!("{} ({}, {})", show(median, 4), show(q1, 3), show(q3, 3)));
                row.push(against(sample));
            }
            Column::Median => row.push(show(sample.median, 4)),
        }
    }
    row
}

/// Verdict, p and A against the baseline.
fn against(sample: &Sample) -> String {
    sample.against.map_or(NONE.to_owned(), |against| {
        let word = match against.verdict {
            Verdict::Win => "win",
            Verdict::Tie => "tie",
            Verdict::Loss => "loss",
        };
        let p = if against.p < 0.001 { "<.001".to_owned() } else { format!("{:.3}", against.p) };
        format!("{word} {} {:.2}", p.trim_start_matches('0'), against.a12)
    })
}

fn missed(cell: &Cell) -> Option<String> {
    let Cell { subject, algorithm, evaluations, seeds, feasible, .. } = cell;
    let missed = seeds - feasible;
    (missed > 0).then(|| {
        format!(
            "{subject}, {algorithm}, {evaluations} evaluations: {missed} of {seeds} runs found nothing that keeps all \
             limits."
        )
    })
}

fn tally_row(measures: &[&Measure], tally: &Tally) -> Vec<String> {
    let counts = measures.iter().map(|measure| {
        let [wins, ties, losses] = tally.counts.get(measure.key).copied().unwrap_or_default();
        format!("{wins} {ties} {losses}")
    });
    std::iter::once(tally.algorithm.clone()).chain(counts).collect()
}

/// So many decimals.
pub fn decimals(value: f64, digits: u8) -> String {
    format!("{value:.*}", usize::from(digits))
}
