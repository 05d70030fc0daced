//! As tables.

use super::{notes, paper};
use crate::{
    render::{
        kit::{Document, Id, Section, Sentence, Table, significant},
        sample::{against, counts, sample},
    },
    workflow::moea::{Cell, Inputs, Ruler, Study, Tally},
};

/// For a terminal, or as Markdown.
pub fn moea_document(inputs: &Inputs, study: &Study) -> Document {
    let objectives = ["objectives", "variables", "front points"];
    let rulers = Table::new(&["problem", "HV reference point"], &objectives, study.rulers.iter().map(ruler));
    let numbers = ["evaluations", "IGD", "p, A", "IGD+", "p, A", "HV", "p, A"];
    let cells = Table::new(&["problem", "algorithm"], &numbers, study.cells.iter().map(cell));
    let tallies = Table::new(&["algorithm"], &["IGD", "IGD+", "HV"], study.tallies.iter().map(tally));
    let mut document = Document::titled("Evolutionary algorithms on problems with known fronts")
        .with(Section::plain(Id::METHOD, notes(inputs).into_iter().map(Sentence::Note)))
        .with(Section::new(Id::OTHER, "Measured against", [rulers]))
        .with(Section::new(Id::SUMMARY, "Medians (quartiles), and against nsga3", [cells]));
    if !study.tallies.is_empty() {
        document.sections.push(Section::new(Id::OTHER, "Wins, ties and losses against nsga3", [tallies]));
    }
    document.sections.extend(paper::sections(study));
    document
}

fn ruler(ruler: &Ruler) -> Vec<String> {
    let point: Vec<String> = ruler.reference_point.iter().map(|&f| significant(f, 3)).collect();
    vec![
        ruler.problem.clone(),
        format!("({})", point.join(", ")),
        ruler.objectives.to_string(),
        ruler.variables.to_string(),
        ruler.front_points.to_string(),
    ]
}

fn cell(cell: &Cell) -> Vec<String> {
    vec![
        cell.problem.clone(),
        cell.algorithm.to_owned(),
        cell.evaluations.to_string(),
        sample(&cell.igd, significant),
        against(&cell.igd),
        sample(&cell.igd_plus, significant),
        against(&cell.igd_plus),
        sample(&cell.hypervolume, |value, digits| format!("{value:.*}", usize::from(digits))),
        against(&cell.hypervolume),
    ]
}

fn tally(tally: &Tally) -> Vec<String> {
    vec![tally.algorithm.to_owned(), counts(tally.igd), counts(tally.igd_plus), counts(tally.hypervolume)]
}
