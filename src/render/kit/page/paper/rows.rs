//! Rows with a point and its interval each, over a common axis.

use plotters::{
    prelude::{ChartBuilder, Circle, Color, PathElement, Text},
    style::text_anchor::{HPos, Pos, VPos},
};

use super::{Failure, Paper, cut, document, panel};
use crate::render::kit::{
    axis::{Axis, GRID, INK, steps},
    page::{
        chart::{Role, span},
        strip::Row,
    },
};

const ROW_MM: f64 = 5.0;
/// A name beyond this is cut.
const LONGEST_MM: f64 = 30.0;

/// Numbers with their intervals as an SVG document; `label` names the axis, which has values times `scale`.
pub(in crate::render) fn rows(
    rows: &[Row],
    label: &str,
    scale: f64,
    paper: Paper,
) -> Result<String, Failure> {
    let names: Vec<String> = rows.iter().map(|row| cut(&row.name, Paper::NUMBERS, LONGEST_MM)).collect();
    let longest_mm = names.iter().map(|name| Paper::taken_mm(name, Paper::NUMBERS)).fold(0.0, f64::max);
    let left_mm = longest_mm + 4.0;
    let ends = rows.iter().flat_map(|row| row.interval.into_iter().flatten().chain([row.value, 0.0]));
    let [low, high] = span(ends.map(|value| scale * value));
    let room = 0.04 * (high - low);
    let (low, high) = (low - room, high + room);
    let count = rows.len() as f64;
    let size_mm = [paper.half_mm, panel::ABOVE_MM + ROW_MM * count + panel::BELOW_MM];
    document(size_mm, label, paper, |root| {
        let mut frame = ChartBuilder::on(root)
            .margin_top(paper.size(panel::ABOVE_MM))
            .margin_right(paper.size(panel::RIGHT_MM))
            .x_label_area_size(paper.size(panel::BELOW_MM - 0.4))
            .y_label_area_size(paper.size(left_mm))
            // The first row is the uppermost.
            .build_cartesian_2d(
                Axis::new(
                    low..high,
                    steps(low, high, panel::most(paper.half_mm - left_mm, panel::ACROSS_MM)),
                ),
                Axis::new(0.0..count, Vec::new()),
            )?;
        frame
            .configure_mesh()
            .max_light_lines(0)
            .bold_line_style(GRID.stroke_width(paper.size(0.1)))
            .axis_style(INK.stroke_width(paper.size(0.15)))
            .set_all_tick_mark_size(paper.size(panel::TICK_MM))
            .label_style(paper.text(Paper::NUMBERS))
            .axis_desc_style(paper.text(Paper::NAMES))
            .x_label_formatter(&|x| panel::number(*x))
            .x_desc(label)
            .draw()?;
        let line = |mm: f64, strong: bool| {
            let colour = if strong { Role::Error } else { Role::Measured }.colour();
            colour.stroke_width(paper.size(mm))
        };
        let zero = INK.mix(0.6).stroke_width(paper.size(0.15));
        frame.draw_series([PathElement::new([(0.0, 0.0), (0.0, count)], zero)])?;
        for (place, row) in rows.iter().enumerate() {
            let y = count - place as f64 - 0.5;
            if let Some([from, to]) = row.interval {
                let ends = [(scale * from, y), (scale * to, y)];
                frame.draw_series([PathElement::new(ends, line(0.35, row.strong))])?;
            }
            let (radius, fill) =
                (paper.size(if row.strong { 1.1 } else { 0.8 }), line(0.0, row.strong).filled());
            frame.draw_series([Circle::new((scale * row.value, y), radius, fill)])?;
        }
        let beside = paper.text(Paper::NUMBERS).pos(Pos::new(HPos::Right, VPos::Center));
        for (place, name) in names.iter().enumerate() {
            let y_mm = panel::ABOVE_MM + (place as f64 + 0.5) * ROW_MM + Paper::LOWER_MM;
            let at = (paper.px(left_mm - 1.5), paper.px(y_mm));
            root.draw(&Text::new(name.clone(), at, beside.clone()))?;
        }
        Ok(())
    })
}
