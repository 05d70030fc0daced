//! Plans to choose from: duration to the right, jerk upwards, both logarithmic; more power larger.

use rerun::{Color, LineStrips2D, Points2D, RecordingStream};

use super::{ViewError, color, stream::single};
use crate::{
    math::range,
    units::degrees_from_radians,
    workflow::view::{Front, Scene},
};

/// Where the fronts of all runs are.
pub(super) const ROOT: &str = "/plans";
/// How much wider than high the axes are drawn.
const WIDE: f64 = 2.4;
/// What is to be seen along x and y: the axes and their words.
pub(super) const SIGHT: [[f64; 2]; 2] = [[-0.3, WIDE + 0.3], [-0.12, 1.22]];

/// Duration, s, jerk, rad/s³, power, W.
type Objectives = [f64; 3];

pub(super) fn send(rec: &RecordingStream, scenes: &[Scene]) -> Result<(), ViewError> {
    let fronts: Vec<(usize, &Front)> =
        scenes.iter().enumerate().filter_map(|(i, scene)| Some((i, scene.front.as_ref()?))).collect();
    let all: Vec<Objectives> =
        fronts.iter().flat_map(|(_, front)| front.objectives.iter().chain(&front.chosen)).copied().collect();
    if all.len() < 2 {
        return Ok(());
    }
    let axes = Axes::of(&all);
    axes.send(rec)?;
    for (k, (run, front)) in fronts.iter().enumerate() {
        let name = scenes.get(*run).map_or("", |scene| &scene.name);
        // Runs of one plan hold the same front.
        let known = fronts.iter().take(k).any(|(_, before)| before.objectives == front.objectives);
        if !known {
            let points = Points2D::new(front.objectives.iter().map(|f| axes.place(f)))
                .with_radii(front.objectives.iter().map(|f| axes.radius(f)))
                .with_colors([color::planned(*run)])
                .with_labels(front.objectives.iter().map(words))
                .with_show_labels(false);
            rec.log_static(format!("{ROOT}/{k}/all"), &points)?;
        }
        let same = fronts.iter().take(k).any(|(_, before)| before.chosen == front.chosen);
        if let Some(chosen) = front.chosen.filter(|_| !same) {
            let whose = if fronts.len() > 1 { name } else { "chosen" };
            let point = Points2D::new([axes.place(&chosen)])
                .with_radii([0.026_f32])
                .with_colors([color::run(*run)])
                .with_labels([format!("{whose}: {}", words(&chosen))])
                .with_show_labels(true);
            rec.log_static(format!("{ROOT}/{k}/chosen"), &point)?;
        }
    }
    Ok(())
}

fn words(f: &Objectives) -> String {
    format!("{:.2} s, {:.1} deg/s³, {:.0} W", f[0], degrees_from_radians(f[1]), f[2])
}

/// Fronts fall steeply and end flat: even steps would hide most of one in the corner.
fn log(value: f64) -> f64 {
    value.max(f64::MIN_POSITIVE).ln()
}

/// Least and most of each objective.
struct Axes([[f64; 2]; 3]);

impl Axes {
    fn of(all: &[Objectives]) -> Self {
        Self([0, 1, 2].map(|k| range(all.iter().map(|f| f[k]))))
    }

    fn share(&self, f: &Objectives, k: usize) -> f64 {
        let [least, most] = self.0[k].map(log);
        (log(f[k]) - least) / (most - least).max(f64::MIN_POSITIVE)
    }

    fn place(&self, f: &Objectives) -> [f32; 2] {
        single([WIDE * self.share(f, 0), 1.0 - self.share(f, 1)])
    }

    fn radius(&self, f: &Objectives) -> f32 {
        single([0.008 + 0.012 * self.share(f, 2)])[0]
    }

    fn send(&self, rec: &RecordingStream) -> Result<(), ViewError> {
        let [r, g, b] = color::AXIS;
        let grey = Color::from_rgb(r, g, b);
        let frame = [[0.0, 0.0], [0.0, 1.0], [WIDE, 1.0]].map(single);
        let lines =
            LineStrips2D::new([frame]).with_colors([grey]).with_radii([rerun::Radius::new_ui_points(0.7)]);
        rec.log_static(format!("{ROOT}/axes"), &lines)?;
        let [duration_s, jerk_rad_s3, _] = self.0;
        let jerk_deg_s3 = jerk_rad_s3.map(degrees_from_radians);
        let ticks = [
            ([0.0, 1.08], format!("{:.1} s", duration_s[0])),
            ([WIDE, 1.08], format!("{:.1} s", duration_s[1])),
            ([-0.16, 0.96], format!("{:.1} deg/s³", jerk_deg_s3[0])),
            ([-0.16, 0.0], format!("{:.1} deg/s³", jerk_deg_s3[1])),
        ];
        let words = Points2D::new(ticks.iter().map(|(place, _)| single(*place)))
            .with_labels(ticks.iter().map(|(_, words)| words.as_str()))
            .with_show_labels(true)
            .with_colors([grey])
            .with_radii([0.0_f32]);
        Ok(rec.log_static(format!("{ROOT}/ticks"), &words)?)
    }
}
