//! Plans to choose from, each with its command and prediction.

use super::{
    Inputs, ReplanFailure,
    command::{Commanded, commanded},
    last::Last,
    predicted::{Predicted, predicted},
    retime::Search,
    samples::sampled,
};
use crate::{fit::Fit, plan::Setup, series::Series};

/// Timings of the search that are looked at with their commands.
const CANDIDATES: usize = 6;

/// A new timing must be expected to lower the sum of all peaks by this share; otherwise the proven one stays.
const WORTH: f64 = 0.02;

/// A plan: times of movement, s, where it is one of the task's, and its samples.
pub(super) type Sampled = (Option<Vec<f64>>, Series);

/// Plans to look at with their commands: the last one first.
pub(super) fn candidates(last: &Last, search: Option<&Search>) -> Result<Vec<Sampled>, ReplanFailure> {
    let (Some(search), Some(request)) = (search, &last.request) else {
        return Ok(vec![(None, last.plan.clone())]);
    };
    let kept = search.start.iter().filter(|_| search.keeps());
    let others = search.front.iter().map(|timing| &timing.interval_s);
    let all: Vec<&Vec<f64>> = kept.chain(others).take(CANDIDATES + 1).collect();
    if all.is_empty() {
        return Ok(vec![(None, last.plan.clone())]);
    }
    let sample = |interval_s: &Vec<f64>| -> Result<Sampled, ReplanFailure> {
        let motion = request.setup.motion(&request.setup.times_s(interval_s))?;
        Ok((Some(interval_s.clone()), sampled(&request.setup, &motion)?))
    };
    all.into_iter().map(sample).collect()
}

/// A plan with its command and what is expected of it.
pub(super) struct Candidate {
    pub(super) interval_s: Option<Vec<f64>>,
    pub(super) plan: Series,
    pub(super) command: Option<Commanded>,
    pub(super) predicted: Predicted,
}

impl Candidate {
    pub(super) fn of(
        inputs: &Inputs,
        fit: &Fit,
        setup: Option<&Setup>,
        interval_s: Option<Vec<f64>>,
        plan: Series,
    ) -> Result<Self, ReplanFailure> {
        let command = if inputs.precompensate {
            let made = commanded(fit, &plan, inputs.compensation, setup)?;
            made.joints.iter().any(|joint| joint.compensation.applied).then_some(made)
        } else {
            None
        };
        let sent = command.as_ref().map_or(&plan, |command| &command.series);
        let predicted = predicted(fit, &plan, sent, &inputs.rules)?;
        Ok(Self { interval_s, plan, command, predicted })
    }
}

/// The first unless another is expected to be better by enough.
pub(super) fn choose(made: Vec<Candidate>) -> Option<Candidate> {
    let mut all = made.into_iter();
    let first = all.next()?;
    let most = (1.0 - WORTH) * first.predicted.sum_of_peaks_rad;
    let better = all.min_by(|a, b| a.predicted.sum_of_peaks_rad.total_cmp(&b.predicted.sum_of_peaks_rad));
    Some(better.filter(|better| better.predicted.sum_of_peaks_rad < most).unwrap_or(first))
}
