//! Charts as pictures: for paper, for readers without the script, for `--figures`.

use plotters::{
    coord::Shift,
    prelude::{
        ChartBuilder, Circle, Color, DrawingArea, DrawingAreaErrorKind, DrawingBackend, IntoDrawingArea,
        LineSeries, PathElement, RGBColor, Rectangle, SVGBackend, Text, WHITE,
    },
    style::{
        IntoFont,
        text_anchor::{HPos, Pos, VPos},
    },
};

use super::chart::{Chart, Panel, Role, Series, Size};
use crate::report::picture::{Axis, FONT, GRID, INK, short, steps};

/// Why a picture could not be drawn.
pub(in crate::report) type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Pixels; drawn large, because the library rounds to whole ones.
const WIDTH: u32 = 1800;
/// Of a tile.
const TILE: u32 = 560;
/// Picture pixels for one on the screen.
const SCALE: u32 = 2;
const LATE: RGBColor = RGBColor(232, 160, 32);
const HEAD: u32 = 44;

/// One chart as an SVG document.
pub(super) fn svg(chart: &Chart) -> Result<String, Failure> {
    grid(std::slice::from_ref(chart), 1)
}

/// Charts in rows of so many as one SVG document.
pub(super) fn grid(charts: &[Chart], columns: usize) -> Result<String, Failure> {
    let columns = columns.clamp(1, charts.len().max(1));
    let rows = charts.len().div_ceil(columns).max(1);
    let pixels = |count: usize, each: u32| each.saturating_mul(u32::try_from(count).unwrap_or(u32::MAX));
    let height = charts.iter().map(|chart| SCALE * chart.height + HEAD).max().unwrap_or(HEAD);
    let size = (
        pixels(columns, charts.iter().map(|chart| width(chart.size)).max().unwrap_or(WIDTH)),
        pixels(rows, height),
    );
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, size).into_drawing_area();
        root.fill(&WHITE)?;
        for (area, chart) in root.split_evenly((rows, columns)).iter().zip(charts) {
            draw(area, chart)?;
        }
        root.present()?;
    }
    Ok(text)
}

fn width(size: Size) -> u32 {
    match size {
        Size::Wide => WIDTH,
        Size::Half => WIDTH / 2,
        Size::Tile => TILE,
    }
}

type Drawn<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;

fn draw<DB: DrawingBackend>(area: &DrawingArea<DB, Shift>, chart: &Chart) -> Drawn<DB> {
    let head = (FONT, if chart.is_tile() { 24 } else { 30 }).into_font().color(&INK);
    area.draw(&Text::new(
        crate::report::markup::clean(&format!("{}  {}", chart.title, chart.note)),
        (14, 10),
        head,
    ))?;
    if !chart.is_tile() {
        legend(area, chart)?;
    }
    let (_, mut below) = area.split_vertically(HEAD);
    let (_, height) = below.dim_in_pixel();
    let all: f64 = chart.panels.iter().map(|panel| panel.share).sum();
    for (place, panel) in chart.panels.iter().enumerate() {
        let last = place + 1 == chart.panels.len();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of pixels")]
        let own = (f64::from(height) * panel.share / all) as u32;
        let (above, rest) = if last { (below.clone(), below) } else { below.split_vertically(own) };
        draw_panel(&above, chart, panel, last)?;
        below = rest;
    }
    Ok(())
}

/// Names of the series in their colours, from the right.
fn legend<DB: DrawingBackend>(area: &DrawingArea<DB, Shift>, chart: &Chart) -> Drawn<DB> {
    let (width, _) = area.dim_in_pixel();
    let mut right = i32::try_from(width).unwrap_or(i32::MAX) - 24;
    for series in chart.panels.iter().flat_map(|panel| &panel.series).rev().filter(|s| !s.name.is_empty()) {
        let style = (FONT, 26).into_font().color(&series.role.colour());
        let name = crate::report::markup::clean(&series.name);
        let (wide, _) = area.estimate_text_size(&name, &style)?;
        right -= i32::try_from(wide).unwrap_or(0);
        area.draw(&Text::new(name, (right, 12), style))?;
        right -= 36;
    }
    Ok(())
}

fn draw_panel<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    chart: &Chart,
    panel: &Panel,
    last: bool,
) -> Drawn<DB> {
    let ([from, to], [low, high]) = (chart.span(), panel.span());
    let words = (FONT, if chart.is_tile() { 20 } else { 24 }).into_font().color(&INK);
    let mut frame = ChartBuilder::on(area)
        .margin(6)
        .margin_right(24)
        .x_label_area_size(if !last {
            8
        } else if chart.is_tile() {
            34
        } else {
            64
        })
        .y_label_area_size(if chart.is_tile() { 70 } else { 110 })
        .build_cartesian_2d(
            Axis::new(from..to, steps(from, to, if chart.is_tile() { 4 } else { 10 })),
            Axis::new(low..high, steps(low, high, if chart.is_tile() { 3 } else { 5 })),
        )?;
    let bands = chart.bands.iter().map(|band| {
        let fill = if band.late { LATE.mix(0.45) } else { LATE.mix(0.13) };
        Rectangle::new([(band.from.max(from), low), (band.to.min(to), high)], fill.filled())
    });
    frame.draw_series(bands)?;
    let x_label = |x: &f64| if last { short(*x) } else { String::new() };
    let y_label = |y: &f64| short(*y);
    let mut mesh = frame.configure_mesh();
    mesh.max_light_lines(0)
        .bold_line_style(GRID.stroke_width(1))
        .axis_style(INK.stroke_width(1))
        .label_style(words.clone())
        .axis_desc_style(words.clone())
        .x_label_formatter(&x_label)
        .y_label_formatter(&y_label);
    if !chart.is_tile() {
        mesh.y_desc(panel.label.clone());
        if last {
            mesh.x_desc(chart.x_label);
        }
    }
    mesh.draw()?;
    if low < 0.0 && high > 0.0 {
        frame.draw_series([PathElement::new([(from, 0.0), (to, 0.0)], INK.mix(0.5).stroke_width(1))])?;
    }
    for series in &panel.series {
        let colour = series.role.colour();
        if series.role.dots() {
            let radius = if series.role == Role::Named { 9 } else { 5 };
            frame.draw_series(
                points(chart, series).map(|at| Circle::new(at, radius, colour.mix(0.8).filled())),
            )?;
            let beside = words.clone().pos(Pos::new(HPos::Left, VPos::Bottom));
            if series.role == Role::Named {
                let named = points(chart, series).zip(&series.names);
                frame.draw_series(
                    named.map(|(at, name)| Text::new(format!("  {name}"), at, beside.clone())),
                )?;
            }
        } else {
            for stroke in strokes(chart, series) {
                let style = colour.stroke_width(series.role.width());
                frame.draw_series(LineSeries::new(stroke, style))?;
            }
        }
    }
    Ok(())
}

fn points(chart: &Chart, series: &Series) -> impl Iterator<Item = (f64, f64)> {
    let x = chart.xs.get(series.x).map_or(&[][..], Vec::as_slice);
    x.iter().copied().zip(series.y.iter().copied()).filter(|(x, y)| x.is_finite() && y.is_finite())
}

/// Continuous stretches of a line.
fn strokes(chart: &Chart, series: &Series) -> Vec<Vec<(f64, f64)>> {
    let x = chart.xs.get(series.x).map_or(&[][..], Vec::as_slice);
    let all: Vec<(f64, f64)> = x.iter().copied().zip(series.y.iter().copied()).collect();
    let pieces = all.split(|(x, y)| !x.is_finite() || !y.is_finite());
    pieces.filter(|piece| piece.len() > 1).map(<[_]>::to_vec).collect()
}
