//! The plots of a comparison one by one.

use super::{
    kind,
    page::{change_rows, error_charts, pair_charts},
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
    workflow::compare::{Comparison, Scope},
};

/// The plots of a comparison.
///
/// # Errors
///
/// What the drawing library says.
pub(crate) fn figures(comparison: &Comparison) -> Result<Vec<Figure>, Failure> {
    let mut figures = Vec::new();
    let changes = change_rows(comparison);
    if !changes.is_empty() {
        let unit = unit(Dimension::Position, kind(comparison, &Scope::All));
        let label = format!("Mean change of the peak error ({unit})");
        let svg = rows(&changes, &label, 1.0, Paper::FIGURE)?;
        figures.push(Figure { name: "change-of-peak-error".to_owned(), svg });
    }
    if !comparison.pairs.is_empty() {
        for (name, chart) in pair_charts(comparison) {
            figures.push(figure(&format!("pairs-{}", name.replace(' ', "-")), &chart)?);
        }
    }
    figures.extend(numbered("error", &error_charts(comparison))?);
    Ok(figures)
}
