//! Convergence curves as a picture.

use plotters::style::RGBColor;

use crate::{
    render::{
        kit::{
            Failure, counted,
            picture::{Course, Line, Panel, picture},
        },
        moea::colour,
    },
    workflow::contest::{Curve, Point},
};

/// The search that is no contender by itself.
const OWN: RGBColor = RGBColor(20, 140, 110);

/// What is missing is drawn down to this share.
const LEAST: f64 = 1e-4;

/// The hypervolume of the population as a share of the reference front's and, on a logarithmic axis,
/// what is missing to it of all found: medians over evaluations with bands between the quartiles, as SVG. All curves are of one task.
///
/// # Errors
///
/// What the drawing library says.
pub fn contest_svg(curves: &[Curve]) -> Result<String, Failure> {
    let title = curves.first().map_or(String::new(), |curve| {
        let seeds = counted(usize::try_from(curve.seeds).unwrap_or(usize::MAX), "seed");
        format!("{}: median and quartiles of {seeds}", curve.task)
    });
    let lines: Vec<Line> = curves
        .iter()
        .map(|curve| Line {
            title: curve.entrant.title,
            colour: if curve.entrant.seeded { OWN } else { colour(curve.entrant.name) },
        })
        .collect();
    let panel = |heading, logarithmic, of: fn(&Point, f64) -> [f64; 3]| {
        let course = |curve: &Curve| -> Course {
            let points = curve.points.iter();
            points.map(|point| (point.evaluations as f64, of(point, curve.reference))).collect()
        };
        Panel { heading, logarithmic, courses: curves.iter().map(course).collect() }
    };
    let panels = [
        panel("population: share of the reference's hypervolume", false, |point, reference| {
            point.hypervolume.map(|value| value / reference)
        }),
        panel("all plans found: what is missing, logarithmic scale", true, |point, reference| {
            let [q1, median, q3] = point.of_all;
            [q3, median, q1].map(|value| (1.0 - value / reference).max(LEAST))
        }),
    ];
    picture(&title, &lines, &panels)
}
