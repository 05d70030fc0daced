//! Predicted tracking error of a plan, transition by transition, as a report would measure it.

use serde::{Deserialize, Serialize};

use crate::{
    fit::{Fit, FitError, predict},
    replay::{Kind, Rules, replay},
    series::{Series, align},
};

/// Predicted tracking error of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Predicted {
    /// Mean peak error of the transitions, unexplained error included, rad.
    pub mean_peak_rad: f64,
    /// Largest expected peak, rad.
    pub worst_peak_rad: f64,
    /// Mean over transitions of the bound that 90 % of peaks stay below, rad.
    pub mean_peak_margin_rad: f64,
    /// Sum of the expected peaks, rad: a reversal less counts.
    pub sum_of_peaks_rad: f64,
    /// Starts from rest.
    pub starts: usize,
    /// Joints turning round.
    pub reversals: usize,
    /// Each of them.
    pub transitions: Vec<PredictedTransition>,
}

/// One start or reversal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PredictedTransition {
    /// The joint.
    pub joint: String,
    /// Whether it leaves rest or turns round.
    pub kind: Kind,
    /// When the plan does, s.
    pub planned_onset_s: f64,
    /// Peak error of the model's response, rad.
    pub modelled_peak_rad: f64,
    /// The same with the unexplained error after held-out starts, added as independent, rad.
    pub expected_peak_rad: f64,
    /// Bound that 90 % of measured peaks stay below, rad.
    pub peak_margin_rad: f64,
}

/// Predicts the tracking error of `plan` if `sent` is sent; joints that the fit does not know are left out.
///
/// # Errors
///
/// [`FitError`] for a plan longer than an hour.
pub fn predicted(fit: &Fit, plan: &Series, sent: &Series, rules: &Rules) -> Result<Predicted, FitError> {
    let mut pairs = Vec::new();
    for track in &plan.tracks {
        let (Some(joint), Some(sent)) = (fit.joint(track.name()), sent.track(track.name())) else { continue };
        let response = predict(&joint.model, sent)?;
        pairs.extend(align(track, &response));
    }
    let found = replay(&pairs, rules);
    let transition = |t: &crate::replay::Transition| {
        let [mean, q90] =
            fit.joint(&t.joint).and_then(|joint| joint.unexplained_peak_rad).unwrap_or([0.0; 2]);
        let modelled_peak_rad = t.peak_error;
        PredictedTransition {
            joint: t.joint.clone(),
            kind: t.kind,
            planned_onset_s: t.planned_onset_s,
            modelled_peak_rad,
            expected_peak_rad: modelled_peak_rad.hypot(mean),
            peak_margin_rad: (fit.peak_margin * modelled_peak_rad).max(modelled_peak_rad.hypot(q90)),
        }
    };
    let transitions: Vec<PredictedTransition> = found.transitions.iter().map(transition).collect();
    let count = transitions.len().max(1) as f64;
    let sum = |of: fn(&PredictedTransition) -> f64| transitions.iter().map(of).sum::<f64>();
    let of_kind = |kind| transitions.iter().filter(|t| t.kind == kind).count();
    Ok(Predicted {
        mean_peak_rad: sum(|t| t.expected_peak_rad) / count,
        worst_peak_rad: transitions.iter().map(|t| t.expected_peak_rad).fold(0.0, f64::max),
        mean_peak_margin_rad: sum(|t| t.peak_margin_rad) / count,
        sum_of_peaks_rad: sum(|t| t.expected_peak_rad),
        starts: of_kind(Kind::Start),
        reversals: of_kind(Kind::Reversal),
        transitions,
    })
}
