//! Curves as SVG: medians over evaluations, with bands between the quartiles.

use std::fmt::Write as _;

use hydrotrace::render::kit::short;
use moea::ALGORITHMS;

use super::{Curve, Form, Panel};

/// Of the whole picture and of one chart's plot.
const SIZE: (f64, f64) = (900.0, 400.0);
const PLOT: (f64, f64) = (360.0, 250.0);
const INK: &str = "#333333";
/// Entries of the legend beside one another at most.
const IN_A_ROW: usize = 4;

/// One colour for each algorithm and one for the search that is none by itself, told apart by
/// colour-blind readers too if four are shown.
const COLOURS: [&str; ALGORITHMS.len() + 1] = [
    "#D1495B", "#4BB4D2", "#8C5A3C", "#E682B4", "#783C8C", "#2563A8", "#8AA4E0", "#5A5A5A", "#E8A020",
    "#968214", "#148C6E", "#B05A14", "#3C8C46", "#148C6E",
];

/// The colour of an algorithm, by its name.
pub(super) fn colour(name: &str) -> &'static str {
    let place = ALGORITHMS.iter().position(|algorithm| algorithm.name == name);
    COLOURS.get(place.unwrap_or(ALGORITHMS.len())).copied().unwrap_or(INK)
}

/// The panels of a form side by side. All curves are of one subject; the first is drawn on top.
pub fn curve_svg(form: &Form, curves: &[Curve]) -> String {
    let mut svg = String::new();
    let (wide, high) = SIZE;
    let _ = writeln!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {wide} {high}\" font-family=\"sans-serif\" \
         font-size=\"13\" fill=\"{INK}\">\n<rect width=\"{wide}\" height=\"{high}\" fill=\"#FFFFFF\"/>"
    );
    let title = curves.first().map_or(String::new(), |curve| {
        format!(
            "{}, {} objectives: median and quartiles, seeds: {}",
            curve.subject, curve.objectives, curve.seeds
        )
    });
    label(&mut svg, (wide / 2.0, 24.0), "middle", &title);
    let in_a_row = IN_A_ROW.min(curves.len().max(1));
    let cell = wide / in_a_row as f64;
    for (index, curve) in curves.iter().enumerate() {
        let (x, y) = (cell * (index % in_a_row) as f64 + 20.0, 44.0 + 18.0 * (index / in_a_row) as f64);
        line(&mut svg, &[(x, y - 4.0), (x + 24.0, y - 4.0)], curve, index);
        label(&mut svg, (x + 30.0, y), "start", curve.entrant.title);
    }
    for (place, panel) in form.panels.iter().enumerate() {
        let left = 70.0 + place as f64 * wide / 2.0;
        chart(&mut svg, (left, high - PLOT.1 - 45.0), panel, curves);
    }
    svg + "</svg>\n"
}

/// Evaluations and quartiles, without what cannot be drawn.
type Course = Vec<(f64, [f64; 3])>;

fn course(panel: &Panel, curve: &Curve) -> Course {
    let place = |value: f64| {
        let value = (panel.drawn)(value);
        if panel.logarithmic { value.max(1e-12).log10() } else { value }
    };
    let points = curve.points.iter().map(|(evaluations, values)| {
        let mut drawn = values[panel.measure].map(place);
        drawn.sort_unstable_by(f64::total_cmp);
        (*evaluations as f64, drawn)
    });
    points.filter(|(_, drawn)| drawn.iter().all(|value| value.is_finite())).collect()
}

fn chart(svg: &mut String, (left, top): (f64, f64), panel: &Panel, curves: &[Curve]) {
    let courses: Vec<Course> = curves.iter().map(|curve| course(panel, curve)).collect();
    let all = || courses.iter().flatten();
    let last = all().map(|(evaluations, _)| *evaluations).fold(1.0, f64::max);
    let low = all().map(|(_, values)| values[0]).fold(f64::INFINITY, f64::min);
    let high = all().map(|(_, values)| values[2]).fold(f64::NEG_INFINITY, f64::max);
    let (low, high) = if low < high { (low, high) } else { (0.0, 1.0) };
    let margin = 0.04 * (high - low);
    let (low, high) = (low - margin, high + margin);
    let (wide, tall) = PLOT;
    let x = |evaluations: f64| left + wide * evaluations / last;
    let y = |value: f64| top + tall * (high - value) / (high - low);
    label(svg, (left + wide / 2.0, top - 8.0), "middle", panel.heading);
    label(svg, (left + wide / 2.0, top + tall + 36.0), "middle", "evaluations");
    let rule = |svg: &mut String, from: (f64, f64), to: (f64, f64)| {
        let ((x1, y1), (x2, y2)) = (from, to);
        let _ = writeln!(svg, "<path d=\"M{x1:.1},{y1:.1} L{x2:.1},{y2:.1}\" stroke=\"#E1E1E1\"/>");
    };
    for tick in steps(0.0, last, 5) {
        rule(svg, (x(tick), top), (x(tick), top + tall));
        let text = if tick >= 1000.0 { format!("{}k", short(tick / 1000.0)) } else { short(tick) };
        label(svg, (x(tick), top + tall + 18.0), "middle", &text);
    }
    for tick in if panel.logarithmic { decades(low, high) } else { steps(low, high, 6) } {
        rule(svg, (left, y(tick)), (left + wide, y(tick)));
        let value = if panel.logarithmic { 10_f64.powf(tick) } else { tick };
        label(svg, (left - 6.0, y(tick) + 4.0), "end", &short(value));
    }
    for (curve, course) in curves.iter().zip(&courses) {
        let below = course.iter().map(|(at, [low, ..])| (x(*at), y(*low)));
        let above = course.iter().rev().map(|(at, [.., high])| (x(*at), y(*high)));
        let _ = writeln!(
            svg,
            "<polygon points=\"{}\" fill=\"{}\" opacity=\"0.18\"/>",
            points(below.chain(above)),
            colour(curve.entrant.name)
        );
    }
    for (index, (curve, course)) in curves.iter().zip(&courses).enumerate().rev() {
        let medians: Vec<(f64, f64)> =
            course.iter().map(|(at, [_, median, _])| (x(*at), y(*median))).collect();
        line(svg, &medians, curve, index);
    }
}

fn line(svg: &mut String, at: &[(f64, f64)], curve: &Curve, index: usize) {
    let width = if index == 0 { 3 } else { 2 };
    let (colour, at) = (colour(curve.entrant.name), points(at.iter().copied()));
    let _ = writeln!(
        svg,
        "<polyline points=\"{at}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"/>"
    );
}

fn label(svg: &mut String, (x, y): (f64, f64), anchor: &str, text: &str) {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    let _ = writeln!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{text}</text>");
}

fn points(at: impl Iterator<Item = (f64, f64)>) -> String {
    at.map(|(x, y)| format!("{x:.1},{y:.1}")).collect::<Vec<_>>().join(" ")
}

/// Multiples of 1, 2 or 5 times a power of ten, at most `most` of them.
fn steps(low: f64, high: f64, most: u32) -> Vec<f64> {
    let rough = (high - low) / f64::from(most.max(1));
    let power = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|k| k * power).into_iter().find(|s| *s >= rough).unwrap_or(rough);
    let first = (low / step).ceil();
    (0..=most).map(|k| (first + f64::from(k)) * step).filter(|v| *v <= high * (1.0 + 1e-12)).collect()
}

/// Logarithms of powers of ten, or of 1, 2 and 5 times them if there are few.
fn decades(low: f64, high: f64) -> Vec<f64> {
    let factors: &[f64] = if high - low > 2.5 { &[1.0] } else { &[1.0, 2.0, 5.0] };
    #[expect(clippy::cast_possible_truncation, reason = "logarithms of what was drawn")]
    let powers = low.floor() as i32..=high.ceil() as i32;
    let ticks = powers.flat_map(|power| factors.iter().map(move |factor| f64::from(power) + factor.log10()));
    ticks.filter(|tick| (low..=high).contains(tick)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{problems::FORM, study::Entrant};

    fn curve(place: usize) -> Curve {
        let point = |k: u32| {
            let igd = 100.0 * (-f64::from(k)).exp();
            (u64::from(k) * 1000, vec![[0.9 * igd, igd, 1.1 * igd]; 3])
        };
        Curve {
            subject: "DTLZ1".to_owned(),
            objectives: 3,
            entrant: Entrant::from(ALGORITHMS[place]),
            seeds: 11,
            points: (0..8).map(point).collect(),
        }
    }

    #[test]
    fn the_picture_is_xml_and_shows_a_line_and_a_name_for_every_curve() {
        for count in [0, 1, 4, ALGORITHMS.len()] {
            let curves: Vec<Curve> = (0..count).map(curve).collect();
            let svg = curve_svg(&FORM, &curves);
            svg.parse::<xml::Element>().unwrap();
            for curve in &curves {
                assert!(svg.contains(curve.entrant.title), "{svg}");
                let stroke = format!("stroke=\"{}\"", colour(curve.entrant.name));
                let lines = svg.lines().filter(|l| l.starts_with("<polyline") && l.contains(&stroke));
                // One in the legend and one a panel.
                assert_eq!(lines.count(), 3, "{}", curve.entrant.name);
            }
        }
    }

    #[test]
    fn values_that_cannot_be_drawn_are_left_out() {
        let mut broken = curve(0);
        broken.points[0].1[0][2] = f64::INFINITY;
        broken.points[1].1[2] = [f64::NAN; 3];
        let svg = curve_svg(&FORM, &[broken]);
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(steps(0.0, 50_000.0, 5), [0.0, 10_000.0, 20_000.0, 30_000.0, 40_000.0, 50_000.0]);
        let shown: Vec<String> = decades(-1.2, 0.1).iter().map(|y| short(10_f64.powf(*y))).collect();
        assert_eq!(shown, ["0.1", "0.2", "0.5", "1"]);
        assert_eq!(decades(-1.2, 3.1), [-1.0, 0.0, 1.0, 2.0, 3.0]);
    }
}
