//! As tables.

use super::{notes, published};
use crate::{
    render::{
        kit::{Document, Id, NONE, Section, Sentence, Table, significant},
        sample::{against, counts, sample},
    },
    units::degrees_from_radians,
    workflow::contest::{BASELINE, Cell, Inputs, Ruler, Study, Tally},
};

/// For a terminal, or as Markdown.
pub fn contest_document(inputs: &Inputs, study: &Study) -> Document {
    let numbers = [
        "variables",
        "reference plans",
        "its HV",
        "fastest s",
        "smoothest deg/s3",
        "least power W",
        "feasible at first",
    ];
    let rulers = Table::new(&["task"], &numbers, study.rulers.iter().map(ruler));
    let numbers = [
        "evaluations",
        "HV, population",
        "p, A",
        "HV, all found",
        "p, A",
        "of reference",
        "fastest s",
        "smoothest deg/s3",
    ];
    let cells = Table::new(&["task", "algorithm"], &numbers, study.cells.iter().map(cell));
    let missed = study.cells.iter().filter_map(missed).map(Sentence::Finding);
    let numbers = ["HV, population", "HV, all found", "fastest", "smoothest"];
    let tallies = Table::new(&["algorithm"], &numbers, study.tallies.iter().map(tally));
    let first = "Feasible at first: share of the first, random population that keeps all limits (quartiles).";
    let heading = format!("Hypervolume: medians (quartiles), and against {BASELINE}");
    let mut document = Document::titled("Evolutionary algorithms on tasks of the arm")
        .with(Section::plain(Id::METHOD, notes(inputs).into_iter().map(Sentence::Note)))
        .with(Section::new(Id::OTHER, "Measured against", [rulers]).with(Sentence::note(first)))
        .with(Section::new(Id::SUMMARY, heading, [cells]).with_all(missed));
    if !study.tallies.is_empty() {
        let heading = format!("Wins, ties and losses against {BASELINE}");
        document.sections.push(Section::new(Id::OTHER, heading, [tallies]));
    }
    document.sections.extend(study.table_3.as_ref().map(published::section));
    document
}

fn ruler(ruler: &Ruler) -> Vec<String> {
    let [fastest_s, smoothest_rad_s3, least_w] = ruler.ideal;
    let [q1, median, q3] = ruler.feasible_at_first.map(|share| 100.0 * share);
    vec![
        ruler.task.clone(),
        ruler.intervals.to_string(),
        ruler.plans.to_string(),
        format!("{:.4}", ruler.hypervolume),
        format!("{fastest_s:.3}"),
        significant(degrees_from_radians(smoothest_rad_s3), 4),
        format!("{least_w:.2}"),
        format!("{median:.1} % ({q1:.1}, {q3:.1})"),
    ]
}

fn cell(cell: &Cell) -> Vec<String> {
    let end = |value: f64, digits| {
        if value.is_finite() { significant(value, digits) } else { NONE.to_owned() }
    };
    let decimals = |value: f64, digits| format!("{value:.*}", usize::from(digits));
    // Evaluations that were made, where they are not those that were asked for.
    let made = if cell.made == cell.evaluations {
        cell.evaluations.to_string()
    } else {
        format!("{} ({})", cell.evaluations, cell.made)
    };
    vec![
        cell.task.clone(),
        cell.algorithm.to_owned(),
        made,
        sample(&cell.hypervolume, decimals),
        against(&cell.hypervolume),
        sample(&cell.of_all, decimals),
        against(&cell.of_all),
        format!("{:.2} %", 100.0 * cell.share),
        end(cell.fastest_s.median, 4),
        end(degrees_from_radians(cell.smoothest_rad_s3.median), 4),
    ]
}

fn missed(cell: &Cell) -> Option<String> {
    (cell.feasible < cell.seeds).then(|| {
        format!(
            "{}, {}, {} evaluations: {} of {} runs found no plan that keeps all limits.",
            cell.task,
            cell.algorithm,
            cell.evaluations,
            cell.seeds - cell.feasible,
            cell.seeds
        )
    })
}

fn tally(tally: &Tally) -> Vec<String> {
    vec![
        tally.algorithm.to_owned(),
        counts(tally.hypervolume),
        counts(tally.of_all),
        counts(tally.fastest),
        counts(tally.smoothest),
    ]
}
