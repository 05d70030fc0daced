//! Charts as pictures: on pages that are printed, and one by one for papers.

mod legend;
mod panel;
mod rows;

use plotters::{
    coord::Shift,
    prelude::{DrawingArea, IntoDrawingArea, SVGBackend, Text, WHITE},
    style::{IntoFont, TextStyle},
};

use super::chart::{Chart, Size};
use crate::render::kit::{
    axis::{FONT, INK},
    clean,
};

pub(in crate::render) use rows::rows;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Why a picture could not be drawn: what the drawing library says.
pub(crate) type Failure = Box<dyn std::error::Error + Send + Sync>;

type Drawn = Result<(), Failure>;

/// What pictures are drawn for. Lengths are millimetres on paper.
#[derive(Debug, Clone, Copy)]
pub(in crate::render) struct Paper {
    /// The library rounds to whole pixels; a millimetre is so many.
    pixels_mm: f64,
    /// Of a chart as wide as it gets.
    wide_mm: f64,
    /// Of one of two beside each other.
    half_mm: f64,
    /// Columns a millimetre of which a line shows the least and the most.
    columns_mm: f64,
    /// Charts say what they are; figures of papers have captions for that.
    titled: bool,
}

impl Paper {
    /// A printed page of A4.
    pub(in crate::render) const PAGE: Self =
        Self { pixels_mm: 10.0, wide_mm: 180.0, half_mm: 90.0, columns_mm: 3.0, titled: true };
    /// A figure in one column of a journal; many small ones take two.
    pub(in crate::render) const FIGURE: Self =
        Self { pixels_mm: 40.0, wide_mm: 85.0, half_mm: 85.0, columns_mm: 12.0, titled: false };

    const TILE_MM: f64 = 60.0;
    /// A line of text with room.
    const LINE_MM: f64 = 4.2;
    /// Below a legend.
    const APART_MM: f64 = 1.0;
    /// Points, of legends and names of axes.
    const NAMES: f64 = 8.0;
    /// Points, of numbers.
    const NUMBERS: f64 = 7.0;
    /// Points, of names of axes in small charts.
    const SMALL: f64 = 6.5;
    /// By how much the library centres capitals and digits too high.
    const LOWER_MM: f64 = 0.25;
    /// Mean width of a character as a share of its size; drawing knows no font.
    const CHARACTER: f64 = 0.54;

    fn width_mm(self, size: Size) -> f64 {
        match size {
            Size::Wide => self.wide_mm,
            Size::Half => self.half_mm,
            Size::Tile => Self::TILE_MM,
        }
    }

    /// Height of the panels with their axes.
    fn body_mm(chart: &Chart) -> f64 {
        f64::from(chart.height) * if chart.is_tile() { 0.26 } else { 0.22 }
    }

    fn px(self, mm: f64) -> i32 {
        #[expect(clippy::cast_possible_truncation, reason = "a length on paper")]
        let px = (mm * self.pixels_mm).round() as i32;
        px
    }

    /// The same for what cannot be negative.
    fn size(self, mm: f64) -> u32 {
        u32::try_from(self.px(mm)).unwrap_or(0)
    }

    /// The library writes sizes of text divided by 1.24.
    fn text(self, points: f64) -> TextStyle<'static> {
        (FONT, 1.24 * mm(points) * self.pixels_mm).into_font().color(&INK)
    }

    /// About how wide a text of so many points is.
    fn taken_mm(text: &str, points: f64) -> f64 {
        text.chars().count() as f64 * Self::CHARACTER * mm(points)
    }
}

/// Millimetres of printers' points.
fn mm(points: f64) -> f64 {
    points * 25.4 / 72.0
}

/// As much of a text as there is room for.
fn cut(text: &str, points: f64, room_mm: f64) -> String {
    let mut text = clean(text);
    if Paper::taken_mm(&text, points) > room_mm {
        while Paper::taken_mm(&text, points) + mm(points) > room_mm && text.pop().is_some() {}
        text.push('\u{2026}');
    }
    text
}

/// A text in as many lines as it needs, one at least.
fn wrapped(text: &str, points: f64, room_mm: f64) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in clean(text).split(' ') {
        let Some(line) = lines.last_mut() else { break };
        let longer = format!("{line} {word}");
        if line.is_empty() {
            line.push_str(word);
        } else if Paper::taken_mm(&longer, points) <= room_mm {
            *line = longer;
        } else {
            lines.push(word.to_owned());
        }
    }
    lines.iter().map(|line| cut(line, points, room_mm)).collect()
}

/// A line above a small chart.
const HEAD_MM: f64 = 3.4;

pub(in crate::render) fn svg(chart: &Chart, paper: Paper) -> Result<String, Failure> {
    grid(std::slice::from_ref(chart), 1, paper)
}

/// Charts in rows of so many as one SVG document, with one legend for all.
pub(in crate::render) fn grid(charts: &[Chart], columns: usize, paper: Paper) -> Result<String, Failure> {
    let columns = columns.clamp(1, charts.len().max(1));
    let rows = charts.len().div_ceil(columns).max(1);
    let most = |lengths: &mut dyn Iterator<Item = f64>| lengths.fold(0.0, f64::max);
    let wide_mm = most(&mut charts.iter().map(|chart| paper.width_mm(chart.size))) * columns as f64;
    // Small charts say what they are by themselves.
    let lines = if charts.iter().all(Chart::is_tile) { 2 } else { 0 };
    let head_mm = HEAD_MM * lines as f64;
    let own_mm = most(&mut charts.iter().map(Paper::body_mm)) + head_mm;
    let alone = paper.titled && charts.iter().all(Chart::is_tile);
    let left_mm = most(&mut charts.iter().map(panel::left_mm));
    let entries = if alone { Vec::new() } else { legend::entries(charts) };
    let legend = legend::rows(&entries, wide_mm - left_mm);
    let legend_mm =
        if legend.is_empty() { 0.0 } else { legend.len() as f64 * Paper::LINE_MM + Paper::APART_MM };
    let title = match charts {
        [only] if only.note.is_empty() => only.title.clone(),
        [only] => format!("{}: {}", only.title, only.note),
        _ => String::new(),
    };
    let titles = wrapped(&title, Paper::NAMES, wide_mm - left_mm);
    let title_mm = if paper.titled && !alone { Paper::LINE_MM * titles.len() as f64 } else { 0.0 };
    document([wide_mm, title_mm + legend_mm + own_mm * rows as f64], &title, paper, |root| {
        let (above, below) = root.split_vertically(paper.px(title_mm));
        if title_mm > 0.0 {
            for (line, words) in titles.into_iter().enumerate() {
                let at = (paper.px(left_mm), paper.px(0.6 + Paper::LINE_MM * line as f64));
                above.draw(&Text::new(words, at, paper.text(Paper::NAMES)))?;
            }
        }
        let (above, below) = below.split_vertically(paper.px(legend_mm));
        legend::draw(&above, &legend, left_mm, paper)?;
        for (place, (area, chart)) in below.split_evenly((rows, columns)).iter().zip(charts).enumerate() {
            let (head, body) = area.split_vertically(paper.px(head_mm));
            for (line, words) in [&chart.title, &chart.note].into_iter().take(lines).enumerate() {
                let at = (paper.px(left_mm), paper.px(0.4 + HEAD_MM * line as f64));
                let words = cut(words, Paper::NUMBERS, paper.width_mm(chart.size) - left_mm);
                head.draw(&Text::new(words, at, paper.text(Paper::NUMBERS)))?;
            }
            // Neighbours to the left and below say what the axes are.
            let outer = [place + columns >= charts.len(), place % columns == 0];
            panel::draw(&body, chart, left_mm, outer, paper)?;
        }
        Ok(())
    })
}

/// An SVG document of a size on paper, mm. What it is of is told to programs, not shown.
fn document(
    size_mm: [f64; 2],
    title: &str,
    paper: Paper,
    draw: impl FnOnce(&Area) -> Drawn,
) -> Result<String, Failure> {
    let size = size_mm.map(|mm| paper.size(mm).max(1));
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, size.into()).into_drawing_area();
        root.fill(&WHITE)?;
        draw(&root)?;
        root.present()?;
    }
    let [wide_mm, high_mm] = size.map(|px| f64::from(px) / paper.pixels_mm);
    let [wide, high] = size;
    let root = maud::html! {
        svg xmlns="http://www.w3.org/2000/svg" width=(format!("{wide_mm}mm")) height=(format!("{high_mm}mm"))
            viewBox=(format!("0 0 {wide} {high}")) stroke-linejoin="round" {
            @if !title.is_empty() { title { (clean(title)) } }
            (maud::PreEscaped(inner(&text)))
        }
    };
    Ok(root.into_string())
}

/// What an element holds.
fn inner(element: &str) -> &str {
    let inner = element.split_once('>').map_or("", |(_, rest)| rest);
    inner.rsplit_once("</svg>").map_or(inner, |(inner, _)| inner)
}
