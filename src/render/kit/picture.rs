//! Medians over evaluations with bands between the quartiles, as SVG.

use plotters::{
    coord::Shift,
    prelude::{
        ChartBuilder, Color, DrawingArea, DrawingAreaErrorKind, DrawingBackend, IntoDrawingArea, LineSeries,
        PathElement, Polygon, RGBColor, SVGBackend, ShapeStyle, Text, WHITE,
    },
    style::{
        IntoFont,
        text_anchor::{HPos, Pos, VPos},
    },
};

use super::{
    Failure,
    axis::{Axis, FONT, GRID, steps},
    number::short,
};

pub use super::axis::INK;

/// Pixels; drawn large, because the library rounds to whole ones.
const SIZE: (u32, u32) = (1800, 800);
/// Entries of the legend beside one another at most.
const IN_A_ROW: usize = 4;

/// A curve in every panel.
#[derive(Debug, Clone)]
pub struct Line {
    /// Its name.
    pub title: &'static str,
    /// Its colour.
    pub colour: RGBColor,
}

/// Evaluations and quartiles.
pub type Course = Vec<(f64, [f64; 3])>;

/// One part of the picture.
#[derive(Debug, Clone)]
pub struct Panel {
    /// What it shows.
    pub heading: &'static str,
    /// Whether its axis is.
    pub logarithmic: bool,
    /// One for each line.
    pub courses: Vec<Course>,
}

/// Panels side by side. The first line is the one that is looked at.
///
/// # Errors
///
/// What the drawing library says.
pub fn picture(title: &str, lines: &[Line], panels: &[Panel]) -> Result<String, Failure> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        root.fill(&WHITE)?;
        let below = root.margin(20, 0, 0, 0).titled(title, (FONT, 40).into_font().color(&INK))?;
        let rows = lines.len().div_ceil(IN_A_ROW).max(1);
        let (above, rest) = below.split_vertically(50 * u32::try_from(rows).unwrap_or(1));
        legend(&above, rows, lines)?;
        for (area, panel) in rest.split_evenly((1, panels.len().max(1))).iter().zip(panels) {
            draw(area, panel, lines)?;
        }
        root.present()?;
    }
    Ok(svg)
}

/// Names with their lines, each in the middle of its cell.
fn legend<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    rows: usize,
    lines: &[Line],
) -> Result<(), DrawingAreaErrorKind<DB::ErrorType>> {
    const LINE: i32 = 60;
    let style = (FONT, 30).into_font().color(&INK).pos(Pos::new(HPos::Left, VPos::Center));
    let cells = area.split_evenly((rows, lines.len().div_ceil(rows).max(1)));
    for (index, (line, cell)) in lines.iter().zip(cells).enumerate() {
        let title = line.title;
        let (wide, high) = cell.dim_in_pixel();
        let (taken, _) = cell.estimate_text_size(title, &style)?;
        let half = |pixels: u32| i32::try_from(pixels / 2).unwrap_or(0);
        let (x, y) = (half(wide) - half(taken) - LINE / 2, half(high));
        cell.draw(&PathElement::new([(x, y), (x + LINE - 12, y)], stroke(line, index)))?;
        cell.draw(&Text::new(title, (x + LINE, y), style.clone()))?;
    }
    Ok(())
}

fn stroke(line: &Line, index: usize) -> ShapeStyle {
    line.colour.stroke_width(if index == 0 { 6 } else { 4 })
}

fn draw<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    panel: &Panel,
    lines: &[Line],
) -> Result<(), DrawingAreaErrorKind<DB::ErrorType>> {
    let place = |value: f64| if panel.logarithmic { value.max(1e-12).log10() } else { value };
    let courses: Vec<(&Line, Course)> =
        lines.iter().zip(&panel.courses).map(|(line, course)| (line, drawable(course, place))).collect();
    let all = || courses.iter().flat_map(|(_, course)| course);
    let last = all().map(|(evaluations, _)| *evaluations).fold(1.0, f64::max);
    let low = all().map(|(_, values)| values[0]).fold(f64::INFINITY, f64::min);
    let high = all().map(|(_, values)| values[2]).fold(f64::NEG_INFINITY, f64::max);
    let (low, high) = if low < high { (low, high) } else { (0.0, 1.0) };
    let margin = 0.04 * (high - low);
    let (low, high) = (low - margin, high + margin);
    let ticks = if panel.logarithmic { decades(low, high) } else { steps(low, high, 6) };

    let mut chart = ChartBuilder::on(area)
        .margin(20)
        .margin_right(50)
        .caption(panel.heading, (FONT, 32).into_font().color(&INK))
        .x_label_area_size(80)
        .y_label_area_size(110)
        .build_cartesian_2d(Axis::new(0.0..last, steps(0.0, last, 5)), Axis::new(low..high, ticks))?;
    let words = (FONT, 28).into_font().color(&INK);
    chart
        .configure_mesh()
        .max_light_lines(0)
        .bold_line_style(GRID.stroke_width(2))
        .axis_style(INK.stroke_width(2))
        .label_style(words.clone())
        .axis_desc_style(words.clone())
        .x_desc("evaluations")
        .x_label_formatter(&|x| thousands(*x))
        .y_label_formatter(&|y| short(if panel.logarithmic { 10_f64.powf(*y) } else { *y }))
        .draw()?;
    for (line, course) in &courses {
        let band: Vec<(f64, f64)> = (course.iter().map(|(x, [low, ..])| (*x, *low)))
            .chain(course.iter().rev().map(|(x, [.., high])| (*x, *high)))
            .collect();
        chart.draw_series([Polygon::new(band, line.colour.mix(0.18))])?;
    }
    // The first one is drawn last, on top of the others.
    for (index, (line, course)) in courses.iter().enumerate().rev() {
        let medians = course.iter().map(|(x, [_, median, _])| (*x, *median));
        chart.draw_series(LineSeries::new(medians, stroke(line, index)))?;
    }
    Ok(())
}

/// Without what cannot be drawn.
fn drawable(course: &Course, place: impl Fn(f64) -> f64) -> Course {
    let points = course.iter().map(|(x, values)| (*x, values.map(&place)));
    points.filter(|(_, values)| values.iter().all(|value| value.is_finite())).collect()
}

/// Logarithms of powers of ten, or of 1, 2 and 5 times them where there would be few.
fn decades(low: f64, high: f64) -> Vec<f64> {
    let factors: &[f64] = if high - low > 2.5 { &[1.0] } else { &[1.0, 2.0, 5.0] };
    #[expect(clippy::cast_possible_truncation, reason = "logarithms of what was drawn")]
    let powers = low.floor() as i32..=high.ceil() as i32;
    powers
        .flat_map(|power| factors.iter().map(move |factor| f64::from(power) + factor.log10()))
        .filter(|tick| (low..=high).contains(tick))
        .collect()
}

/// `20000` as `20k`.
fn thousands(x: f64) -> String {
    if x >= 1000.0 { format!("{}k", short(x / 1000.0)) } else { short(x) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(steps(0.0, 50_000.0, 5), [0.0, 10_000.0, 20_000.0, 30_000.0, 40_000.0, 50_000.0]);
        assert_eq!(
            steps(0.11, 0.39, 6),
            [0.15, 0.2, 0.25, 0.3, 0.35].map(|v: f64| (v / 0.05).round() * 0.05)
        );
        let shown: Vec<String> = decades(-1.2, 0.1).iter().map(|y| short(10_f64.powf(*y))).collect();
        assert_eq!(shown, ["0.1", "0.2", "0.5", "1"]);
        assert_eq!(decades(-1.2, 3.1), [-1.0, 0.0, 1.0, 2.0, 3.0]);
    }
}
