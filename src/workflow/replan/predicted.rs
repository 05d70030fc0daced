//! Predicted tracking error of a plan, transition by transition, as a report would measure it.

use serde::{Deserialize, Serialize};

use super::warp::unexplained;
use crate::{
    fit::{Fit, FitError, predict},
    replay::{Kind, Rules, replay},
    series::{Pair, Series, Track, align},
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
    Ok(promised(fit, plan, sent, None, |_| None, rules)?.0)
}

/// How a joint is expected to answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// Its angles.
    pub angle: Track,
    /// Distance from them that 90 % of starts stay within, rad.
    pub band_rad: f64,
}

/// Peak of what differs from run to run by its root mean square, in the mean and nine times of ten.
const PEAKS_OF_SPREAD: [f64; 2] = [2.0, 3.0];

/// Share of what the model does not explain that does not come again in the next run of the plan: the rest is measured in the last
/// one and corrected. From the study of docs/replan.md; the bound keeps the whole.
const NOT_REPEATED: f64 = 0.75;

/// The same with the responses behind it, from what was sent and what came in a run of this plan, if one is known: the model then
/// tells only what changes.
///
/// # Errors
///
/// As [`predicted`].
pub fn promised(
    fit: &Fit,
    plan: &Series,
    sent: &Series,
    run: Option<(&Series, &Series)>,
    spread_rad: impl Fn(&str) -> Option<f64>,
    rules: &Rules,
) -> Result<(Predicted, Vec<Response>), FitError> {
    let repeats = if run.is_some() { NOT_REPEATED } else { 1.0 };
    // A joint that is sent what it was sent before is expected to do what it did.
    let again = |name: &str| {
        let before = run.and_then(|(before, _)| before.track(name)).zip(sent.track(name));
        before.is_some_and(|(before, sent)| alike(before, sent))
    };
    let left_rad = |name: &str| {
        let [mean_rad, most_rad] = left_rad(fit, name, repeats, spread_rad(name));
        [if again(name) { 0.0 } else { mean_rad }, most_rad]
    };
    let (mut pairs, mut responses) = (Vec::new(), Vec::new());
    for track in &plan.tracks {
        let (Some(joint), Some(sent)) = (fit.joint(track.name()), sent.track(track.name())) else { continue };
        let response = predict(&joint.model, sent)?;
        let before =
            run.and_then(|(sent, came)| Some((sent.track(track.name())?, came.track(track.name())?)));
        let response = match before {
            Some((sent, came)) => changed(came, &predict(&joint.model, sent)?, response),
            None => response,
        };
        pairs.extend(align(track, &response));
        responses.push(Response { angle: response, band_rad: left_rad(track.name())[1] });
    }
    Ok((summary(&left_rad, fit.peak_margin, &pairs, rules), responses))
}

/// Angles that differ by less are the same, rad.
const SAME_RAD: f64 = 1e-5;

fn alike(before: &Track, sent: &Track) -> bool {
    let apart = |(t_s, position): (&f64, &f64)| (before.held_at(*t_s).position - position).abs();
    sent.t_s().iter().zip(sent.position()).map(apart).fold(0.0, f64::max) < SAME_RAD
}

/// What came before, and what the model says that changes.
fn changed(came: &Track, modelled_before: &Track, modelled: Track) -> Track {
    let position = (modelled.t_s().iter().zip(modelled.position()))
        .map(|(t_s, now)| now + unexplained(came, modelled_before, *t_s))
        .collect();
    Track::new(modelled.name(), modelled.t_s(), position, &[]).unwrap_or(modelled)
}

/// Peak error that comes beside the modelled one, mean and 0.9 quantile, rad: by the spread of runs where it is known, by held-out
/// starts of the fit otherwise.
fn left_rad(fit: &Fit, name: &str, share: f64, spread_rad: Option<f64>) -> [f64; 2] {
    let unexplained = fit.joint(name).and_then(|joint| joint.unexplained_peak_rad).unwrap_or([0.0; 2]);
    match spread_rad {
        Some(spread_rad) => [0, 1].map(|k| (PEAKS_OF_SPREAD[k] * spread_rad).min(unexplained[k])),
        None => [share * unexplained[0], unexplained[1]],
    }
}

fn summary(left_rad: &dyn Fn(&str) -> [f64; 2], margin: f64, pairs: &[Pair], rules: &Rules) -> Predicted {
    let found = replay(pairs, rules);
    let transition = |t: &crate::replay::Transition| {
        let [mean, q90] = left_rad(&t.joint);
        let modelled_peak_rad = t.peak_error;
        PredictedTransition {
            joint: t.joint.clone(),
            kind: t.kind,
            planned_onset_s: t.planned_onset_s,
            modelled_peak_rad,
            expected_peak_rad: modelled_peak_rad.hypot(mean),
            peak_margin_rad: (margin * modelled_peak_rad).max(modelled_peak_rad.hypot(q90)),
        }
    };
    let transitions: Vec<PredictedTransition> = found.transitions.iter().map(transition).collect();
    let count = transitions.len().max(1) as f64;
    let sum = |of: fn(&PredictedTransition) -> f64| transitions.iter().map(of).sum::<f64>();
    let of_kind = |kind| transitions.iter().filter(|t| t.kind == kind).count();
    Predicted {
        mean_peak_rad: sum(|t| t.expected_peak_rad) / count,
        worst_peak_rad: transitions.iter().map(|t| t.expected_peak_rad).fold(0.0, f64::max),
        mean_peak_margin_rad: sum(|t| t.peak_margin_rad) / count,
        sum_of_peaks_rad: sum(|t| t.expected_peak_rad),
        starts: of_kind(Kind::Start),
        reversals: of_kind(Kind::Reversal),
        transitions,
    }
}
