//! Convergence curves as a picture.

use plotters::style::RGBColor;

use crate::{
    moea::CONTENDERS,
    render::kit::{
        Failure, counted,
        picture::{INK, Line, Panel, picture},
    },
    workflow::moea::{Curve, Point},
};

/// One colour for each contender, told apart by colour-blind readers too where four are shown.
const COLOURS: [RGBColor; 9] = [
    RGBColor(209, 73, 91),
    RGBColor(140, 90, 60),
    RGBColor(230, 130, 180),
    RGBColor(120, 60, 140),
    RGBColor(37, 99, 168),
    RGBColor(90, 90, 90),
    RGBColor(232, 160, 32),
    RGBColor(150, 130, 20),
    RGBColor(20, 140, 110),
];

/// Hypervolume and, on a logarithmic axis, IGD: medians over evaluations with bands between the
/// quartiles, as SVG. All curves are of one problem.
///
/// # Errors
///
/// What the drawing library says.
pub fn curve_svg(curves: &[Curve]) -> Result<String, Failure> {
    let title = curves.first().map_or(String::new(), |curve| {
        format!(
            "{}, {} objectives: median and quartiles of {}",
            curve.problem,
            curve.objectives,
            counted(usize::try_from(curve.seeds).unwrap_or(usize::MAX), "seed")
        )
    });
    let lines: Vec<Line> = curves
        .iter()
        .map(|curve| Line { title: curve.contender.title, colour: colour(curve.contender.name) })
        .collect();
    let panel = |heading, logarithmic, get: fn(&Point) -> [f64; 3]| {
        let course = |curve: &Curve| curve.points.iter().map(|p| (p.evaluations as f64, get(p))).collect();
        Panel { heading, logarithmic, courses: curves.iter().map(course).collect() }
    };
    let panels = [
        panel("hypervolume (more is better)", false, |point| point.hypervolume),
        panel("IGD, logarithmic scale (less is better)", true, |point| point.igd),
    ];
    picture(&title, &lines, &panels)
}

/// The colour of an algorithm, by its name; that of text for one without.
pub(in crate::render) fn colour(algorithm: &str) -> RGBColor {
    let place = CONTENDERS.iter().position(|contender| contender.name == algorithm);
    place.and_then(|place| COLOURS.get(place)).copied().unwrap_or(INK)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(contender: usize) -> Curve {
        let point = |k: u32| {
            let igd = 100.0 * (-f64::from(k)).exp();
            let point = [0.9 * igd, igd, 1.1 * igd];
            Point { evaluations: u64::from(k) * 1000, igd: point, igd_plus: point, hypervolume: point }
        };
        Curve {
            problem: "DTLZ1".to_owned(),
            objectives: 3,
            contender: CONTENDERS[contender],
            seeds: 11,
            points: (0..8).map(point).collect(),
        }
    }

    #[test]
    fn the_picture_is_xml_and_shows_a_line_and_a_name_for_every_curve() {
        for count in [0, 1, 4, CONTENDERS.len()] {
            let curves: Vec<Curve> = (0..count).map(curve).collect();
            let svg = curve_svg(&curves).unwrap();
            svg.parse::<xml::Element>().unwrap();
            for curve in &curves {
                assert!(svg.contains(curve.contender.title), "{svg}");
                let RGBColor(r, g, b) = colour(curve.contender.name);
                let stroke = format!("stroke=\"#{r:02X}{g:02X}{b:02X}\"");
                let lines = svg.lines().filter(|l| l.starts_with("<polyline") && l.contains(&stroke));
                // One in the legend and one a panel.
                assert_eq!(lines.count(), 3, "{}", curve.contender.name);
            }
        }
    }

    #[test]
    fn values_that_cannot_be_drawn_are_left_out() {
        let mut broken = curve(0);
        broken.points[0].igd[2] = f64::INFINITY;
        broken.points[1].hypervolume = [f64::NAN; 3];
        let svg = curve_svg(&[broken]).unwrap();
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
}
