//! The paper's comparison beside ours.

use std::collections::BTreeSet;

use hydrotrace::render::kit::{Id, NONE, Section, Sentence, Table, significant};

use crate::study::{Cell, Published, Study};

/// Nothing if no problem of the paper was run.
pub(super) fn sections(study: &Study) -> Vec<Section> {
    table_1(study).into_iter().chain(figure_3(study)).collect()
}

fn table_1(study: &Study) -> Option<Section> {
    let entry = |cell: &Cell| {
        cell.published.iter().find_map(|published| match published {
            Published::Table1 { mean, spread } => Some((*mean, *spread)),
            Published::Figure3 { .. } => None,
        })
    };
    let known: Vec<(&Cell, (f64, f64))> =
        study.cells.iter().filter_map(|cell| Some((cell, entry(cell)?))).collect();
    // By problem and algorithm, budgets beside one another.
    let mut rows: Vec<Vec<String>> = Vec::new();
    for (cell, (mean, sd)) in &known {
        let Some(igd) = cell.samples.get("igd") else { continue };
        let ours = format!("{}{}", significant(igd.mean, 4), spread(igd.sd));
        match rows.iter_mut().find(|row| row[0] == cell.subject && row[1] == cell.algorithm) {
            Some(row) => row[3] = format!("{}, {ours}", row[3]),
            None => rows.push(vec![
                cell.subject.clone(),
                cell.algorithm.clone(),
                format!("{}{}", significant(*mean, 4), spread(*sd)),
                ours,
            ]),
        }
    }
    if rows.is_empty() {
        return None;
    }
    let budgets: BTreeSet<u64> = known.iter().map(|(cell, _)| cell.evaluations).collect();
    let budgets: Vec<String> = budgets.iter().map(u64::to_string).collect();
    let finding = "The table names no budget, and contradicts Figure 3, where runs of 50000 evaluations end near the \
                   front: nsga3 has 343.9 on DTLZ3 here after about 500 evaluations, and 0.6122 on WFG3 after about \
                   350. The table's gaps between NSGA-III-FO and NSGA-III are a tenth of its own spread.";
    let which = format!("Means and standard deviations; ours after {} evaluations.", budgets.join(", "));
    let notes = [Sentence::note(finding), Sentence::note(which)];
    let table = Table::new(&["problem", "algorithm"], &["paper", "ours"], rows);
    Some(Section::new(Id::OTHER, "IGD beside the paper's Table 1", notes).with(table))
}

/// Nothing for one run.
fn spread(sd: f64) -> String {
    if sd.is_finite() { format!(" +-{}", significant(sd, 3)) } else { String::new() }
}

fn figure_3(study: &Study) -> Option<Section> {
    let mean = |cell: &Cell| cell.samples.get("hypervolume").map_or(f64::NAN, |sample| sample.mean);
    let share = |cell: &Cell| {
        let focused = study.cells.iter().find(|other| {
            (&other.subject, other.evaluations, &*other.algorithm)
                == (&cell.subject, cell.evaluations, "nsga3-fo")
        });
        let share = focused.map_or(f64::NAN, |focused| mean(cell) / mean(focused));
        if share.is_finite() { format!("{:.1} %", 100.0 * share) } else { NONE.to_owned() }
    };
    let row = |cell: &Cell| {
        cell.published.iter().find_map(|published| match published {
            Published::Table1 { .. } => None,
            Published::Figure3 { said, platemo_defaults } => Some(vec![
                cell.subject.clone(),
                cell.algorithm.clone(),
                said.clone(),
                cell.evaluations.to_string(),
                platemo_defaults.map_or(NONE.to_owned(), |hv| format!("{hv:.3}")),
                format!("{:.3}", cell.samples.get("hypervolume").map_or(f64::NAN, |sample| sample.median)),
                format!("{:.3}", mean(cell)),
                share(cell),
            ]),
        })
    };
    let rows: Vec<Vec<String>> = study.cells.iter().filter_map(row).collect();
    if rows.is_empty() {
        return None;
    }
    let note = "The paper's words, for its curves are not at hand; then the hypervolume of another implementation at \
                PlatEMO's defaults (91 members, 12 variables). The share is our mean divided by the mean of nsga3-fo.";
    let numbers = ["evaluations", "other", "our median", "our mean", "share"];
    let table = Table::new(&["problem", "algorithm", "paper"], &numbers, rows);
    Some(
        Section::new(Id::OTHER, "Hypervolume beside the paper's Figure 3", [Sentence::note(note)])
            .with(table),
    )
}
