//! Plans to choose from: duration to the right, jerk upwards, both logarithmic; more power larger.

use rerun::{Color, LineStrips2D, Points2D, RecordingStream};

use super::{ViewError, color, stream::single};
use crate::{
    task::{Objective, Objectives},
    workflow::{plan::PlanDocument, view::Scene},
};

/// Where the fronts of all runs are.
pub(super) const ROOT: &str = "/plans";
/// How much wider than high the axes are drawn.
const WIDE: f64 = 2.4;
/// Visible range along x and y, with room for the labels of the axes.
pub(super) const SIGHT: [[f64; 2]; 2] = [[-0.3, WIDE + 0.3], [-0.12, 1.22]];

pub(super) fn send(rec: &RecordingStream, scenes: &[Scene]) -> Result<(), ViewError> {
    let fronts: Vec<(usize, &PlanDocument)> =
        scenes.iter().enumerate().filter_map(|(i, scene)| Some((i, scene.front.as_ref()?))).collect();
    let all: Vec<Objectives> = fronts
        .iter()
        .flat_map(|(_, plan)| objectives(plan).chain([&plan.chosen.entry.objectives]))
        .copied()
        .collect();
    if all.len() < 2 {
        return Ok(());
    }
    let axes = Axes::of(&all);
    axes.send(rec)?;
    for (k, (run, front)) in fronts.iter().enumerate() {
        let name = scenes.get(*run).map_or("", |scene| &scene.name);
        // Runs of one plan hold the same front.
        let known = fronts.iter().take(k).any(|(_, before)| before.front == front.front);
        if !known {
            let points = Points2D::new(objectives(front).map(|f| axes.place(f)))
                .with_radii(objectives(front).map(|f| axes.radius(f)))
                .with_colors([color::planned(*run)])
                .with_labels(objectives(front).map(words))
                .with_show_labels(false);
            rec.log_static(format!("{ROOT}/{k}/all"), &points)?;
        }
        let chosen = front.chosen.entry.objectives;
        if !fronts.iter().take(k).any(|(_, before)| before.chosen.entry.objectives == chosen) {
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
    let each: Vec<String> = Objective::OF_PLAN.iter().map(|&k| k.text(f[k])).collect();
    each.join(", ")
}

/// Logarithmic: a front falls steeply and ends flat, and a linear axis would hide most of it in a corner.
fn log(value: f64) -> f64 {
    value.max(f64::MIN_POSITIVE).ln()
}

/// The objectives to the right, upwards, and by size.
const SHOWN: [Objective; 3] = [Objective::Duration, Objective::RmsJerk, Objective::RmsPower];

/// Least and most of each objective shown.
struct Axes([[f64; 2]; SHOWN.len()]);

fn objectives(plan: &PlanDocument) -> impl Iterator<Item = &Objectives> {
    plan.front.iter().map(|plan| &plan.objectives)
}

impl Axes {
    fn of(all: &[Objectives]) -> Self {
        Self(SHOWN.map(|k| crate::math::range(all.iter().map(|f| f[k]))))
    }

    fn share(&self, f: &Objectives, k: usize) -> f64 {
        let [least, most] = self.0[k].map(log);
        (log(f[SHOWN[k]]) - least) / (most - least).max(f64::MIN_POSITIVE)
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
        let [across, up, _] = SHOWN;
        let [right, top, _] = self.0;
        let ticks = [
            ([0.0, 1.08], across.text(right[0])),
            ([WIDE, 1.08], across.text(right[1])),
            ([-0.16, 0.96], up.text(top[0])),
            ([-0.16, 0.0], up.text(top[1])),
        ];
        let words = Points2D::new(ticks.iter().map(|(place, _)| single(*place)))
            .with_labels(ticks.iter().map(|(_, words)| words.as_str()))
            .with_show_labels(true)
            .with_colors([grey])
            .with_radii([0.0_f32]);
        Ok(rec.log_static(format!("{ROOT}/ticks"), &words)?)
    }
}
