//! The paper's comparison beside ours.

use std::collections::BTreeSet;

use crate::{
    render::kit::{Id, NONE, Section, Sentence, Table, significant},
    workflow::moea::{Cell, Published, Study},
};

/// Nothing where no problem of the paper was run.
pub(super) fn sections(study: &Study) -> impl Iterator<Item = Section> {
    table_1(study).into_iter().chain(figure_3(study))
}

fn table_1(study: &Study) -> Option<Section> {
    let known: Vec<(&Cell, Published)> =
        study.cells.iter().filter_map(|cell| Some((cell, cell.table_1?))).collect();
    // By problem and algorithm, budgets beside one another.
    let mut rows: Vec<Vec<String>> = Vec::new();
    for (cell, published) in &known {
        let ours = format!("{}{}", significant(cell.igd.mean, 4), spread(cell.igd.sd));
        match rows.iter_mut().find(|row| row[0] == cell.problem && row[1] == cell.algorithm) {
            Some(row) => row[3] = format!("{}, {ours}", row[3]),
            None => rows.push(vec![
                cell.problem.clone(),
                cell.algorithm.to_owned(),
                format!("{}{}", significant(published.mean, 4), spread(published.spread)),
                ours,
            ]),
        }
    }
    let budgets: BTreeSet<u64> = known.iter().map(|(cell, _)| cell.evaluations).collect();
    let budgets: Vec<String> = budgets.iter().map(u64::to_string).collect();
    let gaps = "The table names no budget, and contradicts Figure 3, where runs of 50000 evaluations end near the \
                front: nsga3 has 343.9 on DTLZ3 here after about 500 evaluations, and 0.6122 on WFG3 after about 350. \
                The table's gaps between NSGA-III-FO and NSGA-III are a tenth of its own spread.";
    let means = format!("Means and standard deviations; ours after {} evaluations.", budgets.join(", "));
    (!rows.is_empty()).then(|| {
        let notes = [Sentence::note(gaps), Sentence::note(means)];
        Section::new(Id::OTHER, "IGD beside the paper's Table 1", notes).with(Table::new(
            &["problem", "algorithm"],
            &["paper", "ours"],
            rows,
        ))
    })
}

/// Nothing for one run.
fn spread(sd: f64) -> String {
    if sd.is_finite() { format!(" +-{}", significant(sd, 3)) } else { String::new() }
}

fn figure_3(study: &Study) -> Option<Section> {
    let share = |cell: &Cell| {
        let focused = study.cells.iter().find(|other| {
            (&other.problem, other.evaluations, other.algorithm)
                == (&cell.problem, cell.evaluations, "nsga3-fo")
        });
        let share = focused.map_or(f64::NAN, |focused| cell.hypervolume.mean / focused.hypervolume.mean);
        if share.is_finite() { format!("{:.1} %", 100.0 * share) } else { NONE.to_owned() }
    };
    let row = |cell: &Cell| {
        cell.figure_3.map(|checkpoint| {
            vec![
                cell.problem.clone(),
                cell.algorithm.to_owned(),
                checkpoint.said.to_owned(),
                cell.evaluations.to_string(),
                checkpoint.platemo_defaults.map_or(NONE.to_owned(), |hv| format!("{hv:.3}")),
                format!("{:.3}", cell.hypervolume.median),
                format!("{:.3}", cell.hypervolume.mean),
                share(cell),
            ]
        })
    };
    let rows: Vec<Vec<String>> = study.cells.iter().filter_map(row).collect();
    let words = "The paper's words, for its curves are not at hand; then what another implementation gave at PlatEMO's \
                 defaults (91 members, 12 variables). The share is that of our mean in the mean of nsga3-fo.";
    let numbers = ["evaluations", "other", "our median", "our mean", "share"];
    (!rows.is_empty()).then(|| {
        Section::new(Id::OTHER, "Hypervolume beside the paper's Figure 3", [Sentence::note(words)])
            .with(Table::new(&["problem", "algorithm", "paper"], &numbers, rows))
    })
}
