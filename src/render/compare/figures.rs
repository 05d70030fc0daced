//! The plots of a comparison one by one.

use super::page::{change_rows, error_charts, pair_charts};
use crate::{
    render::kit::{
        Failure, Figure,
        figure::{figure, numbered},
        page::paper::{Paper, rows},
    },
    workflow::compare::Comparison,
};

/// The plots of a comparison.
///
/// # Errors
///
/// What the drawing library says.
pub fn figures(comparison: &Comparison) -> Result<Vec<Figure>, Failure> {
    let mut figures = Vec::new();
    let changes = change_rows(comparison);
    if !changes.is_empty() {
        let svg = rows(&changes, "Mean change of the peak error (deg)", 1.0, Paper::FIGURE)?;
        figures.push(Figure { name: "change-of-peak-error".to_owned(), svg });
    }
    if !comparison.pairs.is_empty() {
        let names = ["pairs-peak-error", "pairs-start-delay"];
        for (name, chart) in names.into_iter().zip(pair_charts(comparison)) {
            figures.push(figure(name, &chart)?);
        }
    }
    figures.extend(numbered("error", &error_charts(comparison))?);
    Ok(figures)
}
