//! How far a joint's speeds at a limit are from it: one that hangs on something else, such as what other joints draw from the
//! same pump, is another in each stroke.

use super::{
    estimate::{Problem, Workspace},
    model::STEP_S,
    parameters::{Priors, SHARED},
    run::{Run, Sample, steps_in},
};

/// A model that is this near a limit, as a share, is at it.
const AT: f64 = 0.97;

/// Speeds are taken over so long, and shorter stretches at a limit tell none, s.
const OVER_S: f64 = 0.3;

/// Root mean square logarithm of measured speeds by the limits of growing and of shrinking angles, each stretch at a limit
/// once; zero of none.
pub(super) fn missed(problem: &Problem, x: &[f64], workspace: &mut Workspace) -> [f64; 2] {
    let model = problem.model(x);
    let mut logarithms = [Vec::new(), Vec::new()];
    for (run, &integral) in problem.runs.iter().zip(x.iter().skip(SHARED)) {
        workspace.simulate(&model, run, Priors::integral_rad_s(integral));
        for ((own, limit_rad_s), way) in logarithms.iter_mut().zip(model.speed_limit_rad_s).zip([1.0, -1.0]) {
            let Some(limit_rad_s) = limit_rad_s else { continue };
            for steps in workspace.faster_than(way * AT * limit_rad_s) {
                own.extend(
                    fastest_rad_s(run, steps, way).map(|speed_rad_s| (speed_rad_s / limit_rad_s).ln()),
                );
            }
        }
    }
    logarithms.map(|own| {
        let squares: f64 = own.iter().map(|logarithm| logarithm * logarithm).sum();
        (squares / own.len().max(1) as f64).sqrt()
    })
}

/// Fastest way that a joint was measured to go within some steps: the model may be late or early at both ends.
fn fastest_rad_s(run: &Run, [from, to]: [usize; 2], way: f64) -> Option<f64> {
    let at = |step: usize| run.samples.partition_point(|sample| sample.step < step);
    let within = &run.samples[at(from)..at(to)];
    let speed_rad_s = |(k, a): (usize, &Sample)| {
        let later = &within[k..];
        let b = later.get(later.partition_point(|b| b.step < a.step + steps_in(OVER_S)))?;
        let steps = (b.step - a.step) as f64 + b.part - a.part;
        Some(way * (b.measured_rad - a.measured_rad) / (STEP_S * steps))
    };
    within
        .iter()
        .enumerate()
        .filter_map(speed_rad_s)
        .reduce(f64::max)
        .filter(|speed_rad_s| *speed_rad_s > 0.0)
}
