//! How well a model predicts what it was not fitted to.

use super::{
    estimate::{Part, Problem, Room},
    parameters::{Priors, SHARED},
    run::{FOLDS, Run, Sample},
};
use crate::math::quantile;

/// Longest stretch after a start in which its peak error is looked for, s.
const WINDOW_S: f64 = 4.0;

/// Margin where there are too few starts to measure it.
const MARGIN: f64 = 1.2;

/// Fewest starts that make a margin.
const STARTS: usize = 10;

/// Errors of prediction on held-out data of one joint.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Skill {
    pub(super) held_out_r2: f64,
    /// Measured by predicted peak error of each start.
    pub(super) peak_ratios: Vec<f64>,
}

/// Fits all parts of the data but one, and predicts that, for each in turn.
pub(super) fn skill(problem: &Problem, dead_time_s: f64, room: &mut Room) -> Skill {
    // Tracking error, measured and predicted, of every sample.
    let mut errors: Vec<Vec<(f64, f64)>> =
        problem.runs.iter().map(|run| vec![(0.0, 0.0); run.samples.len()]).collect();
    let mut x = vec![0.0; SHARED + problem.runs.len()];
    x[super::parameters::DEAD_TIME] = problem.priors.of(super::parameters::DEAD_TIME).place(dead_time_s);
    for fold in 0..FOLDS {
        let rest = Problem { part: Part::Without(fold), ..problem.clone() };
        let found = rest.descend(x.clone(), 25, room);
        let model = rest.model(&found.x);
        for ((run, errors), &integral) in
            problem.runs.iter().zip(&mut errors).zip(found.x.iter().skip(SHARED))
        {
            room.simulate(&model, run, Priors::integral_rad_s(integral));
            for (sample, error) in run.samples.iter().zip(errors).filter(|(sample, _)| sample.fold == fold) {
                let sent_rad = sent_rad(run, sample);
                *error = (sent_rad - sample.measured_rad, sent_rad - room.at(sample));
            }
        }
    }
    let all = || errors.iter().flatten();
    let count = all().count().max(1) as f64;
    let mean = all().map(|error| error.0).sum::<f64>() / count;
    let total: f64 = all().map(|error| (error.0 - mean).powi(2)).sum();
    let left: f64 = all().map(|error| (error.0 - error.1).powi(2)).sum();
    let held_out_r2 = 1.0 - left / total;
    let held_out_r2 = if held_out_r2.is_finite() { held_out_r2 } else { -1.0 };
    Skill { held_out_r2, peak_ratios: peak_ratios(problem.runs, &errors) }
}

/// What was sent at a sample, rad.
fn sent_rad(run: &Run, sample: &Sample) -> f64 {
    match run.sent.get(sample.step..sample.step + 2) {
        Some([a, b]) => a.0 + sample.part * (b.0 - a.0),
        _ => f64::NAN,
    }
}

/// Measured by predicted peak error after each start.
fn peak_ratios(runs: &[Run], errors: &[Vec<(f64, f64)>]) -> Vec<f64> {
    let mut ratios = Vec::new();
    for (run, errors) in runs.iter().zip(errors) {
        for (k, &start) in run.starts.iter().enumerate() {
            let latest = start + super::run::steps_in(WINDOW_S);
            let end = run.starts.get(k + 1).map_or(latest, |&next| next.min(latest));
            let inside = |sample: &Sample| (start..end).contains(&sample.step);
            let within = run.samples.iter().zip(errors).filter(|(sample, _)| inside(sample));
            let (measured, predicted) =
                within.fold((0.0_f64, 0.0_f64), |(measured, predicted), (_, error)| {
                    (measured.max(error.0.abs()), predicted.max(error.1.abs()))
                });
            if predicted > 0.0 && measured > 0.0 {
                ratios.push(measured / predicted);
            }
        }
    }
    ratios
}

/// What predicted peaks are to be multiplied with so that nine of ten measured ones lie below.
pub(super) fn margin(peak_ratios: Vec<f64>) -> f64 {
    if peak_ratios.len() < STARTS { MARGIN } else { quantile(peak_ratios, 0.9).clamp(1.0, 3.0) }
}
