//! As tables.

use super::{notes, paper};
use crate::{
    render::{
        Part, Sheet,
        sample::{against, counts, sample, significant},
    },
    workflow::moea::{Cell, Inputs, Ruler, Study, Tally},
};

/// For a terminal, or as Markdown.
pub fn moea_parts(inputs: &Inputs, study: &Study) -> Vec<Part> {
    let mut parts = vec![Part::Title("Evolutionary algorithms on problems with known fronts".to_owned())];
    parts.extend(notes(inputs).into_iter().map(Part::Line));
    parts.push(Part::Heading("Measured against".to_owned()));
    parts.push(Part::Sheet(Sheet {
        head: vec!["problem", "HV reference point", "objectives", "variables", "front points"],
        left: 2,
        rows: study.rulers.iter().map(ruler).collect(),
    }));
    parts.push(Part::Heading("Medians (quartiles), and against nsga3".to_owned()));
    parts.push(Part::Sheet(Sheet {
        head: vec!["problem", "algorithm", "evaluations", "IGD", "p, A", "IGD+", "p, A", "HV", "p, A"],
        left: 2,
        rows: study.cells.iter().map(cell).collect(),
    }));
    if !study.tallies.is_empty() {
        parts.push(Part::Heading("Wins, ties and losses against nsga3".to_owned()));
        parts.push(Part::Sheet(Sheet {
            head: vec!["algorithm", "IGD", "IGD+", "HV"],
            left: 1,
            rows: study.tallies.iter().map(tally).collect(),
        }));
    }
    parts.extend(paper::parts(study));
    parts
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
