//! Prediction error of a model on held-out data.

use super::{
    Model,
    estimate::{Part, Problem, Workspace},
    parameters::{Priors, SHARED},
    run::{FOLDS, Run, Sample},
};
use crate::math::quantile;

/// Margin where there are too few starts to measure it.
const MARGIN: f64 = 1.2;

/// No margin is larger.
pub const MOST_MARGIN: f64 = 3.0;

/// Prediction that is worse than this has nothing to do with the joint, and is not told apart: such as a model of one that
/// is stuck.
const WORST_R2: f64 = -1.0;

/// The largest of some hundreds of residuals by their scale.
const PEAK_BY_SCALE: f64 = 5.0;

/// Fewest starts of other runs that say how far a model holds for them.
pub(super) const FEWEST: usize = 3;

/// Fewest starts that make a margin.
pub const STARTS: usize = 10;

/// Errors of prediction on held-out data of one joint.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Skill {
    pub(super) held_out_r2: f64,
    /// Measured and predicted tracking error of every sample, by run, rad.
    pub(super) errors: Vec<Vec<(f64, f64)>>,
    /// Each start, by run.
    pub(super) starts: Vec<Vec<HeldOutStart>>,
}

/// Peak errors after a start that was not fitted to.
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(clippy::struct_field_names, reason = "the unit")]
pub(super) struct HeldOutStart {
    measured_rad: f64,
    predicted_rad: f64,
    /// Of the difference of measured and predicted error.
    unexplained_rad: f64,
}

impl HeldOutStart {
    /// Measured and predicted peak.
    pub(super) fn peaks_rad(&self) -> [f64; 2] {
        [self.measured_rad, self.predicted_rad]
    }

    /// Measured by predicted peak.
    pub(super) fn ratio(&self) -> Option<f64> {
        (self.predicted_rad > 0.0 && self.measured_rad > 0.0).then(|| self.measured_rad / self.predicted_rad)
    }
}

/// Fits all parts of the data but one, in so many rounds from the fit to all of it, and predicts that one, for
/// each in turn.
pub(super) fn skill(problem: &Problem, x: &[f64], rounds: usize, workspace: &mut Workspace) -> Skill {
    // Tracking error, measured and predicted, of every sample.
    let mut errors: Vec<Vec<(f64, f64)>> =
        problem.runs.iter().map(|run| vec![(0.0, 0.0); run.samples.len()]).collect();
    for fold in 0..FOLDS {
        let rest = Problem { part: Part::Without(fold), ..problem.clone() };
        let found = rest.descend(x.to_vec(), rounds, workspace);
        let model = rest.model(&found.x);
        for ((run, errors), &integral) in
            problem.runs.iter().zip(&mut errors).zip(found.x.iter().skip(SHARED))
        {
            workspace.simulate(&model, run, Priors::integral_rad_s(integral));
            for (sample, error) in run.samples.iter().zip(errors).filter(|(sample, _)| sample.fold == fold) {
                let sent_rad = run.sent_rad(sample);
                *error = (sent_rad - sample.measured_rad, sent_rad - workspace.at(sample));
            }
        }
    }
    Skill::of(problem.runs, errors)
}

/// Share of the squared measured error, about its mean, that is predicted; no less than [`WORST_R2`].
fn r2(errors: &[Vec<(f64, f64)>]) -> f64 {
    let all = || errors.iter().flatten();
    let count = all().count().max(1) as f64;
    let mean = all().map(|error| error.0).sum::<f64>() / count;
    let total: f64 = all().map(|error| (error.0 - mean).powi(2)).sum();
    let left: f64 = all().map(|error| (error.0 - error.1).powi(2)).sum();
    let r2 = 1.0 - left / total;
    if r2.is_finite() { r2.max(WORST_R2) } else { WORST_R2 }
}

impl Skill {
    fn of(runs: &[Run], errors: Vec<Vec<(f64, f64)>>) -> Self {
        let starts = runs.iter().zip(&errors).map(|(run, errors)| starts(run, errors)).collect();
        Self { held_out_r2: r2(&errors), errors, starts }
    }

    /// The skill of [`Model::FOLLOWS`](super::Model), where no model predicts anything: all error is unexplained.
    pub(super) fn without_model(self, runs: &[Run]) -> Self {
        let measured = |of_run: Vec<(f64, f64)>| of_run.into_iter().map(|error| (error.0, 0.0)).collect();
        Self::of(runs, self.errors.into_iter().map(measured).collect())
    }

    /// Peak that the model leaves unexplained beyond what residuals of this scale make of one, by the measured one, in the
    /// mean over starts; `None` without any.
    pub(super) fn unexplained_share(&self, scale_rad: f64) -> Option<f64> {
        let starts = || self.starts.iter().flatten();
        let measured_rad: f64 = starts().map(|start| start.measured_rad).sum();
        let unexplained_rad: f64 =
            starts().map(|start| (start.unexplained_rad - PEAK_BY_SCALE * scale_rad).max(0.0)).sum();
        (measured_rad > 0.0).then(|| unexplained_rad / measured_rad)
    }

    /// Whether the model is farther off than the mean of the error by all that can be told.
    pub(super) fn explains_nothing(&self) -> bool {
        self.held_out_r2 <= WORST_R2
    }
}

/// Peak errors after each start.
fn starts(run: &Run, errors: &[(f64, f64)]) -> Vec<HeldOutStart> {
    let found = |(k, &start): (usize, &usize)| {
        let end = run.window_end(k);
        let until = |step: usize| run.samples.partition_point(|sample| sample.step < step);
        let within = &errors[until(start)..until(end).max(until(start))];
        let peak = |of: fn(&(f64, f64)) -> f64| within.iter().map(|e| of(e).abs()).fold(0.0, f64::max);
        (!within.is_empty()).then(|| HeldOutStart {
            measured_rad: peak(|e| e.0),
            predicted_rad: peak(|e| e.1),
            unexplained_rad: peak(|e| e.0 - e.1),
        })
    };
    run.starts.iter().enumerate().filter_map(found).collect()
}

/// Mean and 0.9 quantile of the peak errors that the model leaves unexplained, rad; `None` without
/// starts.
pub(super) fn unexplained_rad(starts: &[Vec<HeldOutStart>]) -> Option<[f64; 2]> {
    let peaks: Vec<f64> = starts.iter().flatten().map(|start| start.unexplained_rad).collect();
    let mean = peaks.iter().sum::<f64>() / peaks.len() as f64;
    (!peaks.is_empty()).then(|| [mean, quantile(peaks, 0.9)])
}

/// The same of a model that was fitted to other runs than these; `None` with fewer than `fewest` starts.
pub(super) fn unexplained_by(
    model: &Model,
    runs: &[Run],
    fewest: usize,
    workspace: &mut Workspace,
) -> Option<[f64; 2]> {
    let mut all = Vec::new();
    for run in runs {
        workspace.simulate(model, run, 0.0);
        let error = |sample: &Sample| {
            let sent_rad = run.sent_rad(sample);
            (sent_rad - sample.measured_rad, sent_rad - workspace.at(sample))
        };
        all.push(starts(run, &run.samples.iter().map(error).collect::<Vec<_>>()));
    }
    (all.iter().map(Vec::len).sum::<usize>() >= fewest).then(|| unexplained_rad(&all))?
}

/// Factor on predicted peaks: 90 % of the measured ones stay below.
pub(super) fn margin(peak_ratios: Vec<f64>) -> f64 {
    if peak_ratios.len() < STARTS { MARGIN } else { quantile(peak_ratios, 0.9).clamp(1.0, MOST_MARGIN) }
}
