//! Plots as files of their own, for papers.

use super::page::{
    chart::Chart,
    paper::{Failure, Paper, svg},
};

/// A plot as a file of its own.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Figure {
    /// Letters, digits, `-` and `_`: safe as a file's, without an ending.
    pub(crate) name: String,
    /// An SVG document, 85 mm wide; 180 mm, where it is of many small plots.
    pub(crate) svg: String,
}

/// One a joint, in their order.
pub(in crate::render) fn numbered(kind: &str, charts: &[(String, Chart)]) -> Result<Vec<Figure>, Failure> {
    let own = |(place, (joint, chart)): (usize, &(String, Chart))| {
        figure(&format!("{kind}-{:02}-{}", place + 1, file_name(joint)), chart)
    };
    charts.iter().enumerate().map(own).collect()
}

pub(in crate::render) fn figure(name: &str, chart: &Chart) -> Result<Figure, Failure> {
    Ok(Figure { name: name.to_owned(), svg: svg(chart, Paper::FIGURE)? })
}

/// A joint's name as part of a file's: names come from logs.
fn file_name(joint: &str) -> String {
    const LONGEST: usize = 40;
    let plain = |c: char| if c.is_ascii_alphanumeric() || c == '-' || c == '_' { c } else { '-' };
    joint.chars().take(LONGEST).map(plain).collect()
}
