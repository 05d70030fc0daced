//! As tables.

use hydrotrace::render::{Part, Sheet};

use super::{BASELINE, Cell, Column, Form, Measure, Sample, Study, Tally, Verdict};

/// A cell without a value.
pub(crate) const NONE: &str = "-";

/// For a terminal, or as Markdown.
pub fn parts(form: &Form, study: &Study) -> Vec<Part> {
    let mut parts = vec![Part::Title(form.title.to_owned())];
    parts.extend(study.notes.iter().cloned().map(Part::Line));
    let (head, row) = form.reference;
    parts.push(Part::Heading("Measured against".to_owned()));
    parts.push(Part::Sheet(Sheet {
        head: head.to_vec(),
        left: form.reference_words,
        rows: study.references.iter().map(row).collect(),
    }));
    parts.push(Part::Heading(form.heading.to_owned()));
    let columns = form.measures.iter().flat_map(|measure| match measure.column {
        Column::Compared => vec![measure.heading, "p, A"],
        Column::Median => vec![measure.heading],
    });
    parts.push(Part::Sheet(Sheet {
        head: [form.subject, "algorithm", "evaluations"].into_iter().chain(columns).collect(),
        left: 2,
        rows: study.cells.iter().map(|cell| cell_row(form, cell)).collect(),
    }));
    parts.extend(study.cells.iter().filter_map(missed).map(Part::Line));
    if !study.tallies.is_empty() {
        parts.push(Part::Heading(format!("Wins, ties and losses against {BASELINE}")));
        let tallied = form.measures.iter().filter(|measure| !measure.tally.is_empty());
        parts.push(Part::Sheet(Sheet {
            head: std::iter::once("algorithm").chain(tallied.clone().map(|measure| measure.tally)).collect(),
            left: 1,
            rows: study.tallies.iter().map(|tally| tally_row(tallied.clone(), tally)).collect(),
        }));
    }
    parts.extend((form.paper)(study));
    parts
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

fn tally_row<'a>(measures: impl Iterator<Item = &'a Measure>, tally: &Tally) -> Vec<String> {
    let counts = measures.map(|measure| {
        let [wins, ties, losses] = tally.counts.get(measure.key).copied().unwrap_or_default();
        format!("{wins} {ties} {losses}")
    });
    std::iter::once(tally.algorithm.clone()).chain(counts).collect()
}

/// So many decimals.
pub fn decimals(value: f64, digits: u8) -> String {
    format!("{value:.*}", usize::from(digits))
}

/// So many significant digits.
pub fn significant(value: f64, digits: u8) -> String {
    if !value.is_finite() {
        return value.to_string();
    }
    #[expect(clippy::cast_possible_truncation, reason = "an exponent")]
    let exponent = if value == 0.0 { 0 } else { value.abs().log10().floor() as i32 };
    let after = i32::from(digits.max(1)) - 1;
    let places = |count: i32| usize::try_from(count).unwrap_or(0);
    if exponent < -2 {
        format!("{value:.*e}", places(after))
    } else {
        format!("{value:.*}", places(after - exponent))
    }
}

#[cfg(test)]
mod tests {
    use super::significant;

    #[test]
    fn figures_keep_their_digits_at_every_size() {
        let values = [343.91, 19.4134, 1.18, 0.0557, 0.000_123_45, 12_345.6, 0.0, f64::INFINITY];
        let shown = values.map(|value| significant(value, 4));
        assert_eq!(shown, ["343.9", "19.41", "1.180", "0.05570", "1.234e-4", "12346", "0.000", "inf"]);
    }
}
