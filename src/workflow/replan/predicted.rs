//! Predicted tracking error of a plan, transition by transition, as a report would measure it.

use serde::{Deserialize, Serialize};

use super::{
    history::{SAME, apart_rad},
    warp::unexplained,
};
use crate::{
    fit::{Chance, Fit, FitError, Stop, predict},
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

impl Predicted {
    /// With what a machine that changes adds to each peak, rad: in the mean, and what nine of ten stay below.
    pub(super) fn unsteady(mut self, [mean_rad, most_rad]: [f64; 2]) -> Self {
        for one in &mut self.transitions {
            one.expected_peak_rad = one.expected_peak_rad.hypot(mean_rad);
            one.peak_margin_rad += most_rad;
        }
        let kinds = [self.starts, self.reversals];
        Self::of(self.transitions, kinds)
    }

    fn of(transitions: Vec<PredictedTransition>, [starts, reversals]: [usize; 2]) -> Self {
        let count = transitions.len().max(1) as f64;
        let sum = |of: fn(&PredictedTransition) -> f64| transitions.iter().map(of).sum::<f64>();
        Self {
            mean_peak_rad: sum(|t| t.expected_peak_rad) / count,
            worst_peak_rad: transitions.iter().map(|t| t.expected_peak_rad).fold(0.0, f64::max),
            mean_peak_margin_rad: sum(|t| t.peak_margin_rad) / count,
            sum_of_peaks_rad: sum(|t| t.expected_peak_rad),
            starts,
            reversals,
            transitions,
        }
    }
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
    /// The same with what the model does not explain, added as independent, rad.
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
    Ok(promised(fit, plan, sent, None, |_| OfRuns::default(), rules)?.0)
}

/// What runs tell of a joint beside its model.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct OfRuns {
    /// What comes differently each time, rad.
    pub spread_rad: Option<f64>,
    /// Whether one of the runs was sent something else than the newest: the spread then holds what the model misses of a change.
    pub tried: bool,
    /// Where it comes no farther.
    pub held: Option<Stop>,
    /// What came in the newest run alone.
    pub by_chance: Option<Chance>,
}

/// What comes at an instant by what came before.
enum Comes {
    /// The same.
    Again,
    /// The same but for what the model says that changes.
    Changed,
    /// What the model says.
    Otherwise,
}

/// How a joint is expected to answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// Its angles.
    pub angle: Track,
    /// Distance from them that 90 % of starts stay within, rad.
    pub band_rad: f64,
}

/// Peak of what differs from run to run by its root mean square: in the mean, and what nine of ten stay below. A correction brings
/// what the last run had of it, too.
const PEAKS_OF_SPREAD: [f64; 2] = [1.8, 2.5];

/// The mean of what is sent again, where it was sent once: of the run that came best, which was lucky.
const PEAK_AGAIN: f64 = 1.0;

/// Share of what the model does not explain that comes again beside what the last run of this plan shows. This and the others are
/// from two studies: that of docs/replan.md, and forty machines of a simulator that knows no part of this one.
const REPEATED: f64 = 0.85;

/// Peak error that a change of what is sent brings by the largest change, in the mean, and what nine of ten stay below.
const OF_CHANGE: [f64; 2] = [0.02, 0.03];

/// The same where runs tell the spread: the second half of a first correction changes as much as the first.
const OF_CHANGE_AGAIN: [f64; 2] = [0.02, 0.06];

/// The same with the responses behind it, from what was sent and what came in a run of this plan, if one is known, and how often
/// that was sent: the model then tells only what changes. `learnt` tells of each joint what those runs did.
///
/// # Errors
///
/// As [`predicted`].
pub fn promised(
    fit: &Fit,
    plan: &Series,
    sent: &Series,
    run: Option<(&Series, &Series, usize)>,
    learnt: impl Fn(&str) -> OfRuns,
    rules: &Rules,
) -> Result<(Predicted, Vec<Response>), FitError> {
    let left = |name: &str| {
        let before = run.and_then(|(before, ..)| before.track(name)).zip(sent.track(name));
        let changed = before.zip(plan.track(name)).map(|((before, sent), plan)| {
            let (changed_rad, corrected_rad) = (apart_rad(sent, before), apart_rad(sent, plan));
            if changed_rad < SAME_RAD.max(SAME * corrected_rad) { 0.0 } else { changed_rad }
        });
        let times = run.map_or(1, |(.., times)| times);
        Left::of(fit, name, (changed, times), learnt(name))
    };
    let (mut pairs, mut responses) = (Vec::new(), Vec::new());
    for track in &plan.tracks {
        let (Some(joint), Some(sent)) = (fit.joint(track.name()), sent.track(track.name())) else {
            // A joint that is not fitted is sent what it was sent, and does what it did.
            if let Some(came) = run.and_then(|(_, came, _)| came.track(track.name())) {
                pairs.extend(align(track, came));
            }
            continue;
        };
        let response = predict(&joint.model, sent)?;
        let before =
            run.and_then(|(sent, came, _)| Some((sent.track(track.name())?, came.track(track.name())?)));
        let response = match before {
            Some((sent, came)) => {
                let OfRuns { held, by_chance, .. } = learnt(track.name());
                let from_s = track.t_s().first().copied().unwrap_or_default();
                let comes = |t_s: f64| match (held, by_chance) {
                    (Some(stop), _) if stop.is_before(track.held_at(t_s).position) => Comes::Again,
                    (_, Some(chance)) if (chance.from_s..chance.to_s).contains(&(t_s - from_s)) => {
                        Comes::Otherwise
                    }
                    _ => Comes::Changed,
                };
                changed(came, &predict(&joint.model, sent)?, response, comes)
            }
            None => response,
        };
        pairs.extend(align(track, &response));
        responses.push(Response { angle: response, band_rad: left(track.name()).most_rad });
    }
    Ok((summary(&left, fit.peak_margin, &pairs, rules), responses))
}

/// Commands that differ by less are the same, rad, or by [`SAME`] of what they correct: a command that is kept is fitted to its plan
/// anew.
const SAME_RAD: f64 = 2e-4;

/// What came before, and what the model says that changes.
fn changed(came: &Track, modelled_before: &Track, modelled: Track, comes: impl Fn(f64) -> Comes) -> Track {
    let position = (modelled.t_s().iter().zip(modelled.position()))
        .map(|(t_s, now)| match comes(*t_s) {
            Comes::Again => came.held_at(*t_s).position,
            Comes::Changed => now + unexplained(came, modelled_before, *t_s),
            Comes::Otherwise => *now,
        })
        .collect();
    Track::of(modelled.kind(), modelled.name(), modelled.t_s(), position, &[]).unwrap_or(modelled)
}

/// Peak error beside the modelled one, rad.
struct Left {
    /// Its mean, independent of the modelled one.
    mean_rad: f64,
    /// What nine of ten stay below, on top of the modelled one.
    most_rad: f64,
}

impl Left {
    /// By the spread of runs where it is known, by held-out starts of the fit and by what changes otherwise. `changed_rad` is `None`
    /// where no run of this plan is known.
    fn of(
        fit: &Fit,
        name: &str,
        (changed_rad, times): (Option<f64>, usize),
        OfRuns { spread_rad, tried, .. }: OfRuns,
    ) -> Self {
        let joint = fit.joint(name);
        let [mean_rad, most_rad] = joint.and_then(|joint| joint.unexplained_peak_rad).unwrap_or([0.0; 2]);
        // A joint that is sent what it was sent before is expected to do what it did.
        let again = changed_rad.is_some_and(|changed_rad| changed_rad <= 0.0);
        let [mean_rad, most_rad] = match (spread_rad, changed_rad) {
            // Runs that were all sent the same tell nothing of what the model misses of a change.
            (Some(spread_rad), Some(changed_rad)) if !again && !tried => {
                let [mean, most] = OF_CHANGE.map(|share| share * changed_rad);
                let [of_new, of_most] = PEAKS_OF_SPREAD.map(|peaks| peaks * spread_rad);
                [(REPEATED * mean_rad).hypot(mean).hypot(of_new), most_rad.hypot(most).hypot(of_most)]
            }
            (Some(spread_rad), changed_rad) => {
                let [mean, most] = OF_CHANGE_AGAIN.map(|share| share * changed_rad.unwrap_or(0.0));
                let [of_new, of_most] = PEAKS_OF_SPREAD.map(|peaks| peaks * spread_rad);
                let lucky = if times > 1 { 0.0 } else { PEAK_AGAIN * spread_rad };
                let of_mean = if again { lucky } else { of_new };
                [of_mean.hypot(mean), of_most.hypot(most)]
            }
            (None, None) => [mean_rad, most_rad],
            (None, Some(_)) if again => [0.0, most_rad],
            (None, Some(changed_rad)) => {
                let [mean, most] = OF_CHANGE.map(|share| share * changed_rad);
                [(REPEATED * mean_rad).hypot(mean), most_rad.hypot(most)]
            }
        };
        Self { mean_rad, most_rad }
    }
}

fn summary(left: &dyn Fn(&str) -> Left, margin: f64, pairs: &[Pair], rules: &Rules) -> Predicted {
    let found = replay(pairs, rules);
    let transition = |t: &crate::replay::Transition| {
        let Left { mean_rad, most_rad } = left(&t.joint);
        let modelled_peak_rad = t.peak_error;
        PredictedTransition {
            joint: t.joint.clone(),
            kind: t.kind,
            planned_onset_s: t.planned_onset_s,
            modelled_peak_rad,
            expected_peak_rad: modelled_peak_rad.hypot(mean_rad),
            peak_margin_rad: (margin * modelled_peak_rad).max(modelled_peak_rad + most_rad),
        }
    };
    let transitions: Vec<PredictedTransition> = found.transitions.iter().map(transition).collect();
    let of_kind = |kind| transitions.iter().filter(|t| t.kind == kind).count();
    let kinds = [of_kind(Kind::Start), of_kind(Kind::Reversal)];
    Predicted::of(transitions, kinds)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{fit::Observation, math::smooth_step};

    #[test]
    fn runs_that_were_sent_the_same_do_not_tell_what_a_change_leaves() {
        let moved = |late_s: f64| {
            move |t: f64| {
                0.3 * (smooth_step((t - 2.0 - late_s) / 3.0) - smooth_step((t - 9.0 - late_s) / 3.0))
            }
        };
        let [sent, measured] = [0.0, 0.2].map(|late_s| Series::sampled("boom", 1600, moved(late_s)));
        let mut fit =
            crate::fit::fit(&[Observation { sent: &sent, measured: &measured, valve: &[] }]).unwrap();
        fit.joints[0].unexplained_peak_rad = Some([0.03, 0.05]);
        let left = |changed_rad: f64, spread_rad: Option<f64>, tried: bool| {
            Left::of(&fit, "boom", (Some(changed_rad), 2), OfRuns { spread_rad, tried, ..OfRuns::default() })
        };
        let [alone, again, tried] = [(None, false), (Some(1e-4), false), (Some(1e-4), true)]
            .map(|(spread_rad, tried)| left(0.05, spread_rad, tried));
        assert!(again.mean_rad >= alone.mean_rad && again.most_rad >= alone.most_rad);
        assert!(tried.mean_rad < 0.1 * again.mean_rad && tried.most_rad < 0.1 * again.most_rad);
        // What is sent again comes again.
        assert!(left(0.0, Some(1e-4), false).most_rad < 1e-3);
    }
}
