//! The plots of a page one by one, for papers.

use super::{
    chart::Chart,
    compared::{change_rows, error_charts, pair_charts},
    front::front_charts,
    joints::{joint_charts, lag_rows},
    paper::{Failure, Paper, grid, rows, svg},
    planned::motion_charts,
    transitions::tiles,
};
use crate::{
    plan::SampledMotion,
    workflow::{compare::Comparison, plan::Planned, plan::front::Front, report::Report},
};

/// A plot as a file of its own.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    /// Letters, digits, `-` and `_`: safe as a file's, without an ending.
    pub name: String,
    /// An SVG document, 85 mm wide; 180 mm, where it is of many small plots.
    pub svg: String,
}

/// The plots of a report.
///
/// # Errors
///
/// What the drawing library says.
pub fn report_figures(report: &Report) -> Result<Vec<Figure>, Failure> {
    const COLUMNS: usize = 3;
    /// What a page of paper holds.
    const ON_A_PAGE: usize = 5 * COLUMNS;
    let mut figures = numbered("joint", &joint_charts(report))?;
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

/// The plots of a comparison.
///
/// # Errors
///
/// What the drawing library says.
pub fn compare_figures(comparison: &Comparison) -> Result<Vec<Figure>, Failure> {
    let mut figures = Vec::new();
    let changes = change_rows(comparison);
    if !changes.is_empty() {
        let svg = rows(&changes, "Mean change of the peak error (deg)", 1.0, Paper::FIGURE)?;
        figures.push(Figure { name: "change-of-peak-error".to_owned(), svg });
    }
    if !comparison.pairs.is_empty() {
        for (name, chart) in
            ["pairs-peak-error", "pairs-start-delay"].into_iter().zip(pair_charts(comparison))
        {
            figures.push(figure(name, &chart)?);
        }
    }
    figures.extend(numbered("error", &error_charts(comparison))?);
    Ok(figures)
}

/// The plots of a search and of the motion it chose.
///
/// # Errors
///
/// What the drawing library says.
pub fn plan_figures(title: &str, planned: &Planned, course: &SampledMotion) -> Result<Vec<Figure>, Failure> {
    let mut figures = front_figures(&Front::of(title, planned))?;
    figures.extend(motion_figures(&planned.joints, course)?);
    Ok(figures)
}

/// The plots of one motion.
///
/// # Errors
///
/// What the drawing library says.
pub fn motion_figures(joints: &[String], course: &SampledMotion) -> Result<Vec<Figure>, Failure> {
    numbered("motion", &motion_charts(joints, course))
}

fn front_figures(front: &Front) -> Result<Vec<Figure>, Failure> {
    front_charts(front).into_iter().map(|(name, chart)| figure(name, &chart)).collect()
}

/// One a joint, in their order.
fn numbered(kind: &str, charts: &[(String, Chart)]) -> Result<Vec<Figure>, Failure> {
    let own = |(place, (joint, chart)): (usize, &(String, Chart))| {
        figure(&format!("{kind}-{:02}-{}", place + 1, file_name(joint)), chart)
    };
    charts.iter().enumerate().map(own).collect()
}

fn figure(name: &str, chart: &Chart) -> Result<Figure, Failure> {
    Ok(Figure { name: name.to_owned(), svg: svg(chart, Paper::FIGURE)? })
}

/// A joint's name as part of a file's: names come from logs.
fn file_name(joint: &str) -> String {
    const LONGEST: usize = 40;
    let plain = |c: char| if c.is_ascii_alphanumeric() || c == '-' || c == '_' { c } else { '-' };
    joint.chars().take(LONGEST).map(plain).collect()
}
