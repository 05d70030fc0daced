//! Names of what is drawn beside a piece of it: colours alone tell nothing in print.

use plotters::prelude::{Circle, Color, PathElement, Rectangle, ShapeStyle, Text, WHITE};
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::{Area, Chart, Drawn, Paper};
use crate::render::kit::{
    clean,
    page::chart::{Role, Shade},
};

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Entry {
    name: String,
    mark: Mark,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Mark {
    Series(Role),
    Band(Shade),
}

const GAP_MM: f64 = 4.0;

/// What the axes leave open, each once: a series alone in its panel is named there.
pub(super) fn entries(charts: &[Chart]) -> Vec<Entry> {
    let mut entries = Vec::new();
    let mut add = |name: &str, mark| {
        let entry = Entry { name: clean(name), mark };
        if !name.is_empty() && !entries.contains(&entry) {
            entries.push(entry);
        }
    };
    for series in charts.iter().flat_map(|c| &c.panels).filter(|p| p.series.len() > 1).flat_map(|p| &p.series)
    {
        add(&series.name, Mark::Series(series.role));
    }
    for shade in Shade::ALL {
        if charts.iter().flat_map(|chart| &chart.bands).any(|band| band.shade == shade) {
            add(shade.names()[0], Mark::Band(shade));
        }
    }
    entries
}

/// As many beside each other as fit.
pub(super) fn rows(entries: &[Entry], room_mm: f64) -> Vec<Vec<Entry>> {
    let mut rows: Vec<Vec<Entry>> = Vec::new();
    let mut left_mm = 0.0;
    for entry in entries {
        let own_mm = taken_mm(entry);
        match rows.last_mut() {
            Some(row) if own_mm <= left_mm => row.push(entry.clone()),
            _ => {
                left_mm = room_mm;
                rows.push(vec![entry.clone()]);
            }
        }
        left_mm -= own_mm;
    }
    rows
}

fn taken_mm(entry: &Entry) -> f64 {
    piece_mm(entry.mark) + 1.0 + Paper::taken_mm(&entry.name, Paper::NAMES) + GAP_MM
}

/// Width of the piece of what is drawn.
fn piece_mm(mark: Mark) -> f64 {
    match mark {
        Mark::Series(role) if role.dots() => 2.0 * role.width_mm(),
        _ => 5.0,
    }
}

pub(super) fn draw(area: &Area, rows: &[Vec<Entry>], from_mm: f64, paper: Paper) -> Drawn {
    let words = paper.text(Paper::NAMES).pos(Pos::new(HPos::Left, VPos::Center));
    for (place, row) in rows.iter().enumerate() {
        let middle_mm = (place as f64 + 0.5) * Paper::LINE_MM + 0.4;
        let mut at_mm = from_mm;
        for entry in row {
            piece(area, entry.mark, [at_mm, middle_mm], paper)?;
            let start = (paper.px(at_mm + piece_mm(entry.mark) + 1.0), paper.px(middle_mm + Paper::LOWER_MM));
            area.draw(&Text::new(entry.name.clone(), start, words.clone()))?;
            at_mm += taken_mm(entry);
        }
    }
    Ok(())
}

fn piece(area: &Area, mark: Mark, [x_mm, y_mm]: [f64; 2], paper: Paper) -> Drawn {
    let length_mm = piece_mm(mark);
    let at = |dx_mm: f64, dy_mm: f64| (paper.px(x_mm + dx_mm), paper.px(y_mm + dy_mm));
    match mark {
        Mark::Band(shade) => {
            let (colour, strength) = shade.colour();
            let fill = colour.mix(strength).filled();
            area.draw(&Rectangle::new([at(0.0, -1.2), at(length_mm, 1.2)], fill))?;
        }
        Mark::Series(role) if role.dots() => {
            for (size, fill) in dot(role, paper) {
                area.draw(&Circle::new(at(0.5 * length_mm, 0.0), size, fill))?;
            }
        }
        Mark::Series(role) => {
            let stroke = role.colour().stroke_width(paper.size(role.width_mm()));
            area.draw(&PathElement::new([at(0.0, 0.0), at(length_mm, 0.0)], stroke))?;
        }
    }
    Ok(())
}

/// Circles, radii and fills, that make a point; those that are named are rings, told apart without colours.
pub(super) fn dot(role: Role, paper: Paper) -> Vec<(u32, ShapeStyle)> {
    let full = (paper.size(role.width_mm()), role.colour().mix(0.8).filled());
    if role == Role::Named {
        vec![(full.0, role.colour().filled()), (paper.size(0.5 * role.width_mm()), WHITE.filled())]
    } else {
        vec![full]
    }
}
