//! The paper's Table 3 beside ours.

use super::FINDING;
use crate::{
    render::{
        kit::{Id, NONE, Section, Sentence, Table},
        plan::limit_cell,
    },
    units::degrees_from_radians,
    workflow::contest::{Row, Table3, Whose},
};

pub(super) fn section(table: &Table3) -> Section {
    let printed = "Printed: the paper's f2 and f3, that of the stretched A from the paper's f2 of A. The rest is measured \
                   here, on an arm and limits that are not the paper's, which prints none.";
    let numbers = ["printed f2 N", "printed f3 J", "f1 s", "f2 deg/s3", "f3 W"];
    let rows = table.rows.iter().map(|entry| row(entry, &table.joints));
    let notes = [Sentence::note(FINDING), Sentence::note(printed)];
    Section::new(Id::OTHER, "The paper's Table 3 (task simulation)", notes).with(Table::new(
        &["plan", "worst limit"],
        &numbers,
        rows,
    ))
}

pub(super) fn name(whose: Whose) -> String {
    match whose {
        Whose::Paper(plan) => format!("paper's {plan}"),
        Whose::Stretched => "paper's A as long as B".to_owned(),
        Whose::Better(plan) => format!("ours, no worse than {plan} in f1, f2, f3"),
        Whose::Smoothest(plan) => format!("ours, as fast as {plan}: least f2"),
        Whose::Thriftiest(plan) => format!("ours, as fast as {plan}: least f3"),
        Whose::End(plan) => format!("ours, {plan} of the front"),
    }
}

fn row(row: &Row, joints: &[String]) -> Vec<String> {
    let printed = |value: Option<f64>| value.map_or(NONE.to_owned(), |value| format!("{value:.2}"));
    let mut cells = vec![name(row.whose)];
    let (limit, worth) = match &row.evaluation {
        Some(evaluation) => {
            let [f1, f2, f3] = [0, 1, 2].map(|k| evaluation.objectives.plan()[k]);
            let f2 = degrees_from_radians(f2);
            let worth = [format!("{f1:.2}"), format!("{f2:.4}"), format!("{f3:.2}")];
            (limit_cell(evaluation, joints), worth)
        }
        None => ("no such plan".to_owned(), [NONE; 3].map(str::to_owned)),
    };
    cells.push(limit);
    cells.push(printed(row.printed.map(|printed| printed.f2)));
    cells.push(printed(row.printed.and_then(|printed| printed.f3)));
    cells.extend(worth);
    cells
}
