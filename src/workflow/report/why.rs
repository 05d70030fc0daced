//! Why a start comes late. Lag is the delay of the joint's model without limits and dead band, limit what the model loses
//! without limits; the rest of the measured delay is the dead band's, unless it is more than any likely one explains.
//!
//! On simulated machines the misses of the whole model say nothing of those of the model without dead band: so what it
//! misses of a delay is the dead band's, not lag.

use serde::{Deserialize, Serialize};

use crate::{
    fit::{Fit, FitError, JointFit, LEAST_SKILL, Model, fit, predict},
    log::{Recording, SignalRole},
    math::range,
    replay::{Replay, Rules, Transition, replay},
    series::{Pair, Series, Track, align, local_quadratic},
    workflow::fit::observation,
};

/// The model by which a delay is explained.
#[derive(Debug, Clone, Default)]
pub enum DelayModel {
    /// None: no delay is.
    #[default]
    None,
    /// Fitted to the run itself.
    OfThisRun,
    /// The same where that takes a few seconds at most.
    OfThisRunIfShort,
    /// Known before.
    Known(Box<Fit>),
}

/// A part of a delay, s.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Part {
    /// How much; below zero where it makes the start earlier.
    pub delay_s: f64,
    /// 95 % interval, from that of the fitted number behind it.
    pub interval_s: Option<[f64; 2]>,
}

/// One start or reversal with a time, and the parts that add up to its delay.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct LateStart {
    /// The transition's identity.
    pub id: String,
    /// The joint.
    pub joint: String,
    /// When its plan starts, s.
    pub planned_onset_s: f64,
    /// What was measured, s.
    pub onset_delay_s: f64,
    /// While what is sent stays below the dead band, and static friction holds.
    pub dead_band: Part,
    /// Dead time, time constants and what the loop takes to follow.
    pub lag: Part,
    /// Because a limit of speed or acceleration is reached.
    pub limit: Part,
    /// What is left of it without limits and dead band, and is not lag.
    pub unexplained: Part,
}

/// Why the starts of a run come late.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Why {
    /// By joint, then time.
    pub starts: Vec<LateStart>,
    /// Joints whose delays are not explained, and why.
    pub untold: Vec<String>,
    /// Starts with a time whose parts have none.
    pub untimed: usize,
}

/// A machine, and what it was sent.
#[derive(Debug)]
pub(super) struct Ready {
    fit: Fit,
    plan: Series,
    sent: Series,
}

/// Why there is no machine: it was not looked for, or a fit refuses the run.
#[derive(Debug)]
pub(super) enum Unready {
    Long(String),
    Fit(String),
}

impl Unready {
    pub(super) fn message(self) -> String {
        match self {
            Self::Long(why) | Self::Fit(why) => why,
        }
    }

    /// `moves`: a joint is sent through more than what the fit calls little.
    fn refused(error: &FitError, moves: impl Fn(f64) -> bool) -> Self {
        Self::Fit(match error {
            FitError::NothingMoves { least_travel_rad, .. } if moves(*least_travel_rad) => {
                "its motions are too short, or too often broken off by gaps, for a fit".to_owned()
            }
            error => error.to_string(),
        })
    }
}

/// What is short for a fit: joints times seconds.
const SHORT_S: f64 = 4000.0;

/// A start under other circumstances is that of the run whose plan starts within this of the same instant, s.
const SAME_START_S: f64 = 0.5;

impl DelayModel {
    /// What it takes of a log beside plan and measurement.
    pub(super) fn signals(&self) -> &'static [SignalRole] {
        match self {
            Self::None => &[],
            _ => &[SignalRole::Command, SignalRole::Valve],
        }
    }

    /// The machine for a run, before its tracks are given away.
    pub(super) fn ready(&self, recording: &Recording) -> Option<Result<Ready, Unready>> {
        // A long run's tracks are not copied for nothing.
        if matches!(self, Self::None) {
            return None;
        }
        let span_s = recording.measured.span_s().map_or(0.0, |[from, to]| to - from);
        if matches!(self, Self::OfThisRunIfShort) && span_s * recording.measured.tracks.len() as f64 > SHORT_S
        {
            let why = format!("a fit to {span_s:.0} s takes a while; `report --why` makes it");
            return Some(Err(Unready::Long(why)));
        }
        let observed = observation(recording);
        let (plan, sent) = (recording.planned.clone(), observed.sent.clone());
        let fit = if let Self::Known(fit) = self { Ok(Fit::clone(fit)) } else { fit(&[observed]) };
        let moves = |least: f64| {
            let spans = sent.tracks.iter().map(|track| range(track.position().iter().copied()));
            spans.map(|[low, high]| high - low).any(|span| span >= least)
        };
        let fit = fit.map_err(|error| Unready::refused(&error, moves));
        Some(fit.map(|fit| Ready { fit, plan, sent }))
    }
}

/// A machine whose speed and acceleration have no limit.
fn without_limits(model: &Model) -> Model {
    Model { speed_limit_rad_s: [None; 2], acceleration_limit_rad_s2: [None; 2], ..*model }
}

/// A machine that needs this many times as much to leave rest; at 0 it does so at the least that is wanted.
fn with_dead_band(model: &Model, times: f64) -> Model {
    Model {
        dead_band_rad_s: times * model.dead_band_rad_s,
        dead_band_centre_rad_s: times * model.dead_band_centre_rad_s,
        hysteresis_rad_s: times * model.hysteresis_rad_s,
        stiction_rad_s: times * model.stiction_rad_s,
        ..*model
    }
}

impl Ready {
    /// Why no command can be made by this machine.
    pub(super) fn unfit(&self) -> Option<String> {
        let none = !self.fit.joints.iter().any(JointFit::trusted);
        none.then(|| format!("no joint is predicted well enough (a held-out R2 of {LEAST_SKILL} is needed)"))
    }

    pub(super) fn why(&self, pairs: &[Pair], found: &Replay) -> Result<Why, FitError> {
        Why::of(&self.fit, &self.plan, &self.sent, pairs, found)
    }
}

impl Why {
    /// The parts of every delay that was found in these pairs and can be told, by the machine of a fit and by what it
    /// was sent.
    ///
    /// # Errors
    ///
    /// [`FitError`] for a plan that is too long for a model.
    pub fn of(
        fit: &Fit,
        plan: &Series,
        sent: &Series,
        pairs: &[Pair],
        found: &Replay,
    ) -> Result<Self, FitError> {
        let mut why = Self::default();
        for joint in found.joints.iter().filter(|joint| joint.starts > 0) {
            let tracks = [plan, sent].map(|series| series.track(&joint.name));
            let pair = pairs.iter().find(|pair| pair.name == joint.name);
            let ([Some(plan), Some(sent)], Some(pair), Some(model)) = (tracks, pair, fit.joint(&joint.name))
            else {
                why.untold.push(format!("{}: no model of it", joint.name));
                continue;
            };
            if !(model.model_holds && model.trusted()) {
                why.untold.push(format!("{}: its model does not hold", joint.name));
                continue;
            }
            let what_if = WhatIf {
                plan,
                sent,
                pair,
                noise: &noise(pair, joint.thresholds.window_s, found),
                rules: &found.rules,
            };
            let starts = found.transitions.iter().filter(|start| start.joint == joint.name);
            what_if.explain(starts, model, &mut why)?;
        }
        Ok(why)
    }
}

/// What the measurement has beside the motion: a model has no noise, and is timed with that of the measurement.
fn noise(pair: &Pair, window_s: f64, found: &Replay) -> Vec<f64> {
    let points = found.rules.window_points;
    let smooth = local_quadratic(&pair.t_s, &pair.measured, &pair.segments, window_s, points);
    pair.measured.iter().zip(&smooth).map(|(measured, smooth)| measured - smooth.position).collect()
}

/// A joint's run, as it would have been with another machine.
struct WhatIf<'a> {
    plan: &'a Track,
    sent: &'a Track,
    pair: &'a Pair,
    /// Of each measured position.
    noise: &'a [f64],
    rules: &'a Rules,
}

impl WhatIf<'_> {
    /// The starts of a machine, timed as the measured ones are.
    fn timed(&self, model: &Model) -> Result<Vec<Transition>, FitError> {
        let predicted = predict(model, self.sent)?;
        let seen = self.pair.t_s.iter().zip(self.noise);
        let position = seen.map(|(t_s, noise)| predicted.held_at(*t_s).position + noise).collect();
        let cuts: Vec<usize> = self.pair.segments.iter().skip(1).map(|segment| segment.start).collect();
        let track = Track::of(self.pair.kind, &self.pair.name, self.pair.t_s.to_vec(), position, &cuts);
        let pairs: Vec<Pair> = track.ok().and_then(|track| align(self.plan, &track)).into_iter().collect();
        Ok(replay(&pairs, self.rules).transitions)
    }

    fn explain<'a>(
        &self,
        starts: impl Iterator<Item = &'a Transition>,
        joint: &JointFit,
        why: &mut Why,
    ) -> Result<(), FitError> {
        let no_limit = without_limits(&joint.model);
        let limited = if no_limit == joint.model {
            None
        } else {
            Some([self.timed(&joint.model)?, self.timed(&no_limit)?])
        };
        // Every model has a little play, which may be the machine's or stand in for its dead band.
        let free = with_dead_band(&no_limit, 0.0);
        let lag_alone = [self.timed(&free)?, self.timed(&Model { backlash_rad: 0.0, ..free })?];
        // What the largest dead band that is likely would do.
        let band = joint.dead_band_rad_s;
        let most = band.value.zip(band.interval).and_then(|(value, [_, high])| {
            self.timed(&with_dead_band(&no_limit, LIKELY * high / value.max(1e-9))).ok()
        });
        let lag = joint.lag_s.value.zip(joint.lag_s.interval);
        for start in starts {
            let Some(delay_s) = start.onset_delay_s else { continue };
            let of = |what_if: &[Transition]| same_start(what_if, start)?.onset_delay_s;
            let limit_s =
                limited.as_ref().map_or(Some(0.0), |[with, without]| Some(of(with)? - of(without)?));
            let [with_play, without] = lag_alone.each_ref().map(|alone| same_start(alone, start));
            let delays_s = [with_play, without].map(|alone| alone.and_then(|alone| alone.onset_delay_s));
            let (Some(limit_s), [Some(lag_s), without_s]) = (limit_s, delays_s) else {
                why.untimed += 1;
                continue;
            };
            // Limits make no start earlier, and no part of a delay is longer than all of it: another start was timed.
            if limit_s < -2.0 * MISSED_S || lag_s > delay_s.max(0.0) + 2.0 * MISSED_S {
                why.untimed += 1;
                continue;
            }
            let limitless_s = delay_s - limit_s;
            let unknown_s = half(start.onset_delay_interval_s).unwrap_or_default();
            let most_s = most.as_ref().and_then(|most| of(most));
            let explained_s = most_s.map_or(limitless_s, |most_s| limitless_s.min(most_s + unknown_s));
            let part = |delay_s: f64, half_s: Option<f64>| Part {
                delay_s,
                interval_s: half_s.map(|half_s| [delay_s - half_s, delay_s + half_s]),
            };
            // Of the instants of two starts, and of what the model misses.
            let dead_band_half_s =
                band.interval.map(|_| MISSED_S.hypot(std::f64::consts::SQRT_2 * unknown_s));
            // As the model knows it, with and without its play, and as well as a start of it is timed.
            let timed_s = with_play.and_then(|alone| half(alone.onset_delay_interval_s)).unwrap_or_default();
            let play_s = without_s.map_or(0.0, |without_s| (lag_s - without_s).max(0.0));
            let lag = Part {
                delay_s: lag_s,
                interval_s: lag.map(|(value, ends)| {
                    let [low_s, high_s] = ends.map(|end| (end - value).hypot(timed_s));
                    [lag_s - low_s - play_s, lag_s + high_s]
                }),
            };
            let known = [dead_band_half_s, half(lag.interval_s)];
            let half_s = known.into_iter().try_fold(0.0_f64, |sum, half| half.map(|half| sum.hypot(half)));
            why.starts.push(LateStart {
                id: start.id.clone(),
                joint: start.joint.clone(),
                planned_onset_s: start.planned_onset_s,
                onset_delay_s: delay_s,
                dead_band: part(explained_s - lag_s, dead_band_half_s),
                lag,
                limit: part(limit_s, None),
                unexplained: part(limitless_s - explained_s, half_s),
            });
        }
        Ok(())
    }
}

/// At one start a dead band may be this many times the largest that a fit allows: what comes later yet has other causes.
const LIKELY: f64 = 2.0;

/// What models of this form miss of a part, s: nine in ten of simulated machines without dead band start within it
/// (`tests/it/why.rs`).
const MISSED_S: f64 = 0.25;

fn half(interval_s: Option<[f64; 2]>) -> Option<f64> {
    interval_s.map(|[low, high]| 0.5 * (high - low).abs())
}

/// The same start under other circumstances.
fn same_start<'a>(others: &'a [Transition], start: &Transition) -> Option<&'a Transition> {
    let apart = |other: &&Transition| (other.planned_onset_s - start.planned_onset_s).abs();
    others
        .iter()
        .filter(|other| other.kind == start.kind && other.direction == start.direction)
        .filter(|other| apart(other) <= SAME_START_S)
        .min_by(|a, b| apart(a).total_cmp(&apart(b)))
}
