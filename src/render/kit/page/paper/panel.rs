//! The panels of a chart above one another, with their axes.

use plotters::{
    prelude::{ChartBuilder, Circle, Color, EmptyElement, LineSeries, PathElement, Polygon, Rectangle, Text},
    style::text_anchor::{HPos, Pos, VPos},
};

use super::{Area, Chart, Drawn, Paper, legend::dot};
use crate::render::kit::{
    axis::{Axis, GRID, INK, steps},
    page::chart::{Panel, Role, Series},
    short,
};

pub(super) const BELOW_MM: f64 = 8.6;
/// Room where there is no such axis, so that numbers of two panels do not touch.
const APART_MM: f64 = 2.4;
/// For half of the last number.
pub(super) const RIGHT_MM: f64 = 3.0;
/// Letters must not touch the edge.
pub(super) const LEFT_MM: f64 = 0.6;
pub(super) const TICK_MM: f64 = 0.6;
/// For half of the topmost number.
pub(super) const ABOVE_MM: f64 = 1.2;
/// One number on the vertical axis takes so much at least.
const UP_MM: f64 = 4.5;
/// The same for the horizontal one.
pub(super) const ACROSS_MM: f64 = 9.0;

pub(super) fn left_mm(chart: &Chart) -> f64 {
    let numbers = chart.panels.iter().flat_map(|panel| {
        let [low, high] = panel.span();
        steps(low, high, 7)
    });
    let longest = numbers.map(|y| Paper::taken_mm(&number(y), Paper::NUMBERS)).fold(0.0, f64::max);
    longest + 2.0 * TICK_MM + 4.8
}

/// With a typographer's minus.
pub(super) fn number(value: f64) -> String {
    short(value).replace('-', "\u{2212}")
}

/// `outer`: whether the horizontal and the vertical axes are named.
pub(super) fn draw(area: &Area, chart: &Chart, left_mm: f64, outer: [bool; 2], paper: Paper) -> Drawn {
    let own_mm = Paper::body_mm(chart) - BELOW_MM + APART_MM;
    let all: f64 = chart.panels.iter().map(|panel| panel.share).sum();
    let mut below = area.clone();
    for (place, panel) in chart.panels.iter().enumerate() {
        let last = place + 1 == chart.panels.len();
        let high_mm = own_mm * panel.share / all;
        let (above, rest) =
            if last { (below.clone(), below) } else { below.split_vertically(paper.px(high_mm)) };
        let frame = Frame { chart, panel, left_mm, high_mm: high_mm - APART_MM, last, outer, paper };
        frame.draw(&above)?;
        below = rest;
    }
    Ok(())
}

/// More stretches are not told apart on paper, and none is shaded.
const MOST_BANDS: usize = 400;

struct Frame<'a> {
    chart: &'a Chart,
    panel: &'a Panel,
    left_mm: f64,
    /// Between the axes' ends.
    high_mm: f64,
    /// The lowest panel has the horizontal axis.
    last: bool,
    outer: [bool; 2],
    paper: Paper,
}

impl Frame<'_> {
    fn draw(&self, area: &Area) -> Drawn {
        let Self { chart, panel, paper, last, .. } = *self;
        let ([from, to], [low, high]) = (chart.span(), panel.span());
        let wide_mm = paper.width_mm(chart.size) - self.left_mm - RIGHT_MM;
        let mut frame = ChartBuilder::on(area)
            .margin_top(paper.size(ABOVE_MM))
            .margin_right(paper.size(RIGHT_MM))
            .margin_left(paper.size(LEFT_MM))
            .x_label_area_size(paper.size(if last { BELOW_MM - 0.4 } else { APART_MM - ABOVE_MM }))
            .y_label_area_size(paper.size(self.left_mm - LEFT_MM))
            .build_cartesian_2d(
                Axis::new(from..to, steps(from, to, most(wide_mm, ACROSS_MM))),
                Axis::new(low..high, steps(low, high, most(self.high_mm, UP_MM).min(7))),
            )?;
        let told_apart = chart.bands.len() <= MOST_BANDS;
        let bands =
            chart.bands.iter().filter(|band| told_apart && band.to > from && band.from < to).map(|band| {
                let (colour, strength) = band.shade.colour();
                let fill = colour.mix(strength).filled();
                Rectangle::new([(band.from.max(from), low), (band.to.min(to), high)], fill)
            });
        frame.draw_series(bands)?;
        let points = if chart.is_tile() { Paper::SMALL } else { Paper::NAMES };
        let x_label = |x: &f64| if last { number(*x) } else { String::new() };
        let y_label = |y: &f64| number(*y);
        let mut mesh = frame.configure_mesh();
        mesh.max_light_lines(0)
            .bold_line_style(GRID.stroke_width(paper.size(0.1)))
            .axis_style(INK.stroke_width(paper.size(0.15)))
            .y_label_offset(paper.px(Paper::LOWER_MM))
            .set_all_tick_mark_size(paper.size(TICK_MM))
            .label_style(paper.text(Paper::NUMBERS))
            .axis_desc_style(paper.text(points))
            .x_label_formatter(&x_label)
            .y_label_formatter(&y_label);
        if self.outer[1] {
            mesh.y_desc(panel.label.clone());
        }
        if last && self.outer[0] {
            mesh.x_desc(&*chart.x_label);
        }
        mesh.draw()?;
        if low < 0.0 && high > 0.0 {
            let zero = INK.mix(0.5).stroke_width(paper.size(0.1));
            frame.draw_series([PathElement::new([(from, 0.0), (to, 0.0)], zero)])?;
        }
        frame
            .draw_series(shaded(chart, panel).map(|area| Polygon::new(area, Role::Band.colour().filled())))?;
        for series in panel.series.iter().filter(|series| series.role != Role::Band) {
            let (colour, size) = (series.role.colour(), paper.size(series.role.width_mm()));
            if series.role.dots() {
                for (size, fill) in dot(series.role, paper) {
                    frame.draw_series(drawn(chart, series).map(|at| Circle::new(at, size, fill)))?;
                }
            } else {
                for stroke in strokes(chart, series) {
                    let stroke = thinned(&stroke, wide_mm * paper.columns_mm / (to - from));
                    frame.draw_series(LineSeries::new(stroke, colour.stroke_width(size)))?;
                }
            }
            if series.role == Role::Named {
                for (at, name) in named(chart, series) {
                    let [right, up] = self.free(at);
                    let side = if right { HPos::Left } else { HPos::Right };
                    let words = paper.text(Paper::NUMBERS);
                    let words = words.pos(Pos::new(side, if up { VPos::Bottom } else { VPos::Top }));
                    let toward = |way: bool, mm: f64| paper.px(if way { mm } else { -mm });
                    let beside = (toward(right, 1.3), toward(!up, 0.5));
                    frame.draw_series([EmptyElement::at(at) + Text::new(name, beside, words)])?;
                }
            }
        }
        Ok(())
    }

    /// Whether a point's name finds most room to the right, and above.
    fn free(&self, (x, y): (f64, f64)) -> [bool; 2] {
        let ([from, to], [low, high]) = (self.chart.span(), self.panel.span());
        let right = x - from <= 0.75 * (to - from);
        let taken = |up: f64| {
            let within = |(dx, dy): (f64, f64)| (0.0..0.2).contains(&dx) && (0.0..0.1).contains(&dy);
            let place = |at: (f64, f64)| {
                let side = if right { 1.0 } else { -1.0 };
                (side * (at.0 - x) / (to - from), up * (at.1 - y) / (high - low))
            };
            let points = self.panel.series.iter().flat_map(|series| drawn(self.chart, series));
            points.filter(|at| within(place(*at))).count()
        };
        // Below the lowest are the numbers of the axis.
        [right, taken(1.0) <= taken(-1.0) || y - low < 0.1 * (high - low)]
    }
}

/// Steps that a length has room for.
pub(super) fn most(length_mm: f64, each_mm: f64) -> u32 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few")]
    let most = (length_mm / each_mm) as u32;
    most.clamp(2, 10)
}

fn drawn(chart: &Chart, series: &Series) -> impl Iterator<Item = (f64, f64)> {
    let x = chart.xs.get(series.x).map_or(&[][..], Vec::as_slice);
    x.iter().copied().zip(series.y.iter().copied()).filter(|(x, y)| x.is_finite() && y.is_finite())
}

/// Points with their names; one that has several has them all.
fn named(chart: &Chart, series: &Series) -> Vec<((f64, f64), String)> {
    let mut named: Vec<((f64, f64), String)> = Vec::new();
    for (at, name) in drawn(chart, series).zip(&series.names) {
        match named.iter_mut().find(|(other, _)| *other == at) {
            Some((_, names)) => *names = format!("{names}, {name}"),
            None => named.push((at, name.clone())),
        }
    }
    named
}

/// The outline of the shaded area, if the panel has one.
fn shaded(chart: &Chart, panel: &Panel) -> Option<Vec<(f64, f64)>> {
    let mut edges = panel.series.iter().filter(|series| series.role == Role::Band);
    let (low, high) = (edges.next()?, edges.next()?);
    let back: Vec<(f64, f64)> = drawn(chart, high).collect();
    Some(drawn(chart, low).chain(back.into_iter().rev()).collect())
}

/// Continuous stretches of a line.
fn strokes(chart: &Chart, series: &Series) -> Vec<Vec<(f64, f64)>> {
    let x = chart.xs.get(series.x).map_or(&[][..], Vec::as_slice);
    let all: Vec<(f64, f64)> = x.iter().copied().zip(series.y.iter().copied()).collect();
    let pieces = all.split(|(x, y)| !x.is_finite() || !y.is_finite());
    pieces.filter(|piece| piece.len() > 1).map(<[_]>::to_vec).collect()
}

/// A line with so many columns a unit of its axis: of more points than two a column, its least and its most are left.
fn thinned(stroke: &[(f64, f64)], columns: f64) -> Vec<(f64, f64)> {
    let [Some((first, _)), Some((last, _))] = [stroke.first(), stroke.last()] else { return Vec::new() };
    if stroke.len() as f64 <= 2.0 * columns * (last - first) {
        return stroke.to_vec();
    }
    let column = |(x, _): &(f64, f64)| ((x - first) * columns).floor();
    let mut kept = vec![stroke[0]];
    for own in stroke.chunk_by(|a, b| column(a) <= column(b) && column(a) >= column(b)) {
        let by_height = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let ends = [own.iter().min_by(by_height), own.iter().max_by(by_height)];
        let [Some(least), Some(most)] = ends else { continue };
        kept.extend(if least.0 <= most.0 { [*least, *most] } else { [*most, *least] });
    }
    kept.extend(stroke.last());
    kept.dedup();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thinned_line_keeps_its_peaks_and_its_ends() {
        let at =
            |k: i32| (0.01 * f64::from(k), f64::from(u8::from(k == 1234)) - f64::from(u8::from(k == 4321)));
        let line: Vec<(f64, f64)> = (0..6000).map(at).collect();
        let thin = thinned(&line, 5.0);
        assert!((300..=606).contains(&thin.len()), "{}", thin.len());
        assert!(thin.contains(&line[1234]) && thin.contains(&line[4321]));
        assert_eq!([thin[0], thin[thin.len() - 1]], [line[0], line[5999]]);
        assert!(thin.windows(2).all(|two| two[0].0 <= two[1].0));
        assert_eq!(thinned(&line[..50], 500.0), line[..50]);
        assert!(thinned(&[], 5.0).is_empty());
    }
}
