//! The plots of a report one by one.

use super::{
    joints::{joint_charts, lag_rows},
    tiles::tiles,
    tool_page::error_chart,
};
use crate::{
    render::{
        kit::{
            Failure, Figure,
            figure::{figure, numbered},
            page::{
                chart::Chart,
                paper::{Paper, grid, rows},
            },
        },
        plan::front_figures,
    },
    workflow::report::{Report, Tool},
};

pub(crate) fn figures(report: &Report) -> Result<Vec<Figure>, Failure> {
    const COLUMNS: usize = 3;
    /// What a page of paper holds.
    const ON_A_PAGE: usize = 5 * COLUMNS;
    let mut figures = numbered("joint", &joint_charts(report))?;
    if let Tool::Placed(found, path) = &report.tool {
        figures.push(figure("tool", &error_chart(found, path))?);
    }
    let tiles: Vec<Chart> = tiles(report).into_iter().map(|(_, chart)| chart).collect();
    for (page, tiles) in tiles.chunks(ON_A_PAGE).enumerate() {
        let svg = grid(tiles, COLUMNS, Paper::FIGURE)?;
        figures.push(Figure { name: format!("transitions-{:02}", page + 1), svg });
    }
    let lags = lag_rows(report);
    if !lags.is_empty() {
        let svg = rows(&lags, "Lag (ms)", 1e3, Paper::FIGURE)?;
        figures.push(Figure { name: "lag".to_owned(), svg });
    }
    if let Some(front) = &report.front {
        figures.extend(front_figures(front)?);
    }
    Ok(figures)
}
