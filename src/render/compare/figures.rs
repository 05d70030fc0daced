//! The plots of a comparison one by one.

use super::{
    page::{change_rows, error_charts, pair_charts},
    together,
};
use crate::{
    render::{
        kit::{
            Failure, Figure,
            figure::{figure, numbered},
            page::paper::{Paper, rows},
        },
        metric::unit,
    },
    replay::Dimension,
    workflow::compare::Comparison,
};

pub(crate) fn figures(comparison: &Comparison) -> Result<Vec<Figure>, Failure> {
    let mut figures = Vec::new();
    for (k, all) in together(comparison).enumerate() {
        let changes = change_rows(comparison, all.kind);
        if !changes.is_empty() {
            let label = format!("Mean change of the peak error ({})", unit(Dimension::Position, all.kind));
            let svg = rows(&changes, &label, 1.0, Paper::FIGURE)?;
            let name = if k == 0 { "change-of-peak-error" } else { "change-of-peak-error-sliding" };
            figures.push(Figure { name: name.to_owned(), svg });
        }
    }
    if !comparison.pairs.is_empty() {
        for (name, chart) in pair_charts(comparison) {
            figures.push(figure(&format!("pairs-{}", name.replace(", ", "-").replace(' ', "-")), &chart)?);
        }
    }
    figures.extend(numbered("error", &error_charts(comparison))?);
    Ok(figures)
}
