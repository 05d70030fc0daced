//! Why a start comes late: what of its delay would have gone had the machine had no limits, then no dead band, by the
//! model of the joint; what is left is lag, and what the model does not explain.

use serde::{Deserialize, Serialize};

use crate::{
    fit::{Fit, FitError, JointFit, Model, Observation, fit, predict},
    log::{Recording, SignalRole},
    replay::{JointReplay, Replay, Rules, Sizes, Transition, replay},
    series::{JointKind, Pair, Series, Track, align},
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
    pub(super) fn ready(&self, recording: &Recording) -> Option<Result<Ready, String>> {
        // A long run's tracks are not copied for nothing.
        if matches!(self, Self::None) {
            return None;
        }
        let span_s = recording.measured.span_s().map_or(0.0, |[from, to]| to - from);
        if matches!(self, Self::OfThisRunIfShort) && span_s * recording.measured.tracks.len() as f64 > SHORT_S
        {
            return Some(Err(format!("a fit to {span_s:.0} s takes a while; `report --why` makes it")));
        }
        let sent = recording.command.as_ref().map_or(&recording.planned, |command| &command.series);
        let turning = |series: &Series| Series {
            tracks: series.tracks.iter().filter(|track| track.kind() == JointKind::Turns).cloned().collect(),
        };
        let (plan, sent, measured) =
            (turning(&recording.planned), turning(sent), turning(&recording.measured));
        if measured.tracks.is_empty() {
            return Some(Err("only machines of joints that turn are fitted, and here all slide".to_owned()));
        }
        let fit = if let Self::Known(fit) = self {
            Ok(Fit::clone(fit))
        } else {
            let valve = recording.signals.get(&SignalRole::Valve).map_or(&[][..], Vec::as_slice);
            fit(&[Observation { sent: &sent, measured: &measured, valve }])
        };
        Some(fit.map(|fit| Ready { fit, plan, sent }).map_err(|error| error.to_string()))
    }
}

/// A machine whose speed and acceleration have no limit.
fn without_limits(model: &Model) -> Model {
    Model { speed_limit_rad_s: [None; 2], acceleration_limit_rad_s2: [None; 2], ..*model }
}

/// A machine that leaves rest at the least that is wanted.
fn without_dead_band(model: &Model) -> Model {
    Model { dead_band_rad_s: 0.0, dead_band_centre_rad_s: 0.0, stiction_rad_s: 0.0, ..*model }
}

impl Ready {
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
            let what_if = WhatIf { plan, sent, pair, rules: &found.rules };
            let starts = found.transitions.iter().filter(|start| start.joint == joint.name);
            what_if.explain(starts, model, &as_measured(&found.rules, joint), &mut why)?;
        }
        Ok(why)
    }
}

/// The rules that noise and sampling made of those of the caller: a model has no noise, and must be timed alike.
fn as_measured(rules: &Rules, joint: &JointReplay) -> Rules {
    let mut rules = rules.clone();
    let seen = joint.thresholds;
    let sizes = Sizes {
        start_speed: seen.measured_start,
        stop_speed: seen.measured_stop,
        ..*rules.sizes(joint.kind)
    };
    match joint.kind {
        JointKind::Turns => rules.turning = sizes,
        JointKind::Slides => rules.sliding = sizes,
    }
    rules.window_min_s = rules.window_min_s.max(seen.window_s);
    rules
}

/// A joint's run, as it would have been with another machine.
struct WhatIf<'a> {
    plan: &'a Track,
    sent: &'a Track,
    pair: &'a Pair,
    rules: &'a Rules,
}

impl WhatIf<'_> {
    /// The starts of the run as measured, but for what differs between two models: so what no model explains stays.
    fn changed(&self, from: &Model, to: &Model) -> Result<Vec<Transition>, FitError> {
        let [from, to] = [predict(from, self.sent)?, predict(to, self.sent)?];
        let both = self.pair.t_s.iter().zip(&self.pair.measured);
        let position = both.map(|(t_s, q)| q + to.held_at(*t_s).position - from.held_at(*t_s).position);
        let cuts: Vec<usize> = self.pair.segments.iter().skip(1).map(|segment| segment.start).collect();
        let track = Track::new(&self.pair.name, self.pair.t_s.to_vec(), position.collect(), &cuts);
        Ok(track.map_or(Vec::new(), |track| self.timed(&track, self.rules)))
    }

    fn timed(&self, measured: &Track, rules: &Rules) -> Vec<Transition> {
        let pairs: Vec<Pair> = align(self.plan, measured).into_iter().collect();
        replay(&pairs, rules).transitions
    }

    fn explain<'a>(
        &self,
        starts: impl Iterator<Item = &'a Transition>,
        joint: &JointFit,
        as_measured: &Rules,
        why: &mut Why,
    ) -> Result<(), FitError> {
        let no_limit = without_limits(&joint.model);
        let only_lag = without_dead_band(&no_limit);
        let lag_alone = self.timed(&predict(&only_lag, self.sent)?, as_measured);
        let limitless = self.changed(&joint.model, &no_limit)?;
        let free = self.changed(&joint.model, &only_lag)?;
        // The same from either end of the dead band's interval.
        let band = joint.dead_band_rad_s;
        let from = |end: f64| {
            let share = end / band.value.unwrap_or(end).max(1e-9);
            let model = Model { dead_band_rad_s: share * no_limit.dead_band_rad_s, ..no_limit };
            self.changed(&model, &only_lag)
        };
        let ends = band.interval.map(|[low, high]| Ok([from(low)?, from(high)?])).transpose()?;
        let lag = joint.lag_s.value.zip(joint.lag_s.interval);
        for start in starts {
            let Some(delay_s) = start.onset_delay_s else { continue };
            let of = |what_if: &[Transition]| delay_s_of(what_if, start);
            let (Some(limitless), Some(free), Some(lag_s)) = (of(&limitless), of(&free), of(&lag_alone))
            else {
                why.untimed += 1;
                continue;
            };
            let dead_band_interval = |[low, high]: &[Vec<Transition>; 2]| {
                let ends = [limitless - of(low)?, limitless - of(high)?];
                Some(widened(limitless - free, ends, start.onset_delay_interval_s))
            };
            let dead_band =
                Part { delay_s: limitless - free, interval_s: ends.as_ref().and_then(dead_band_interval) };
            let lag = Part {
                delay_s: lag_s,
                interval_s: lag.map(|(value, ends)| ends.map(|end| lag_s + end - value)),
            };
            let rest_s = free - lag_s;
            let known = [half(dead_band.interval_s), half(lag.interval_s)];
            let half_s = known.into_iter().try_fold(0.0_f64, |sum, half| half.map(|half| sum.hypot(half)));
            why.starts.push(LateStart {
                id: start.id.clone(),
                joint: start.joint.clone(),
                planned_onset_s: start.planned_onset_s,
                onset_delay_s: delay_s,
                dead_band,
                lag,
                limit: Part { delay_s: delay_s - limitless, interval_s: None },
                unexplained: Part {
                    delay_s: rest_s,
                    interval_s: half_s.map(|half_s| [rest_s - half_s, rest_s + half_s]),
                },
            });
        }
        Ok(())
    }
}

/// What models of this form miss of a part, s: nine in ten of simulated machines without dead band start within it
/// (`tests/it/why.rs`).
const MISSED_S: f64 = 0.25;

/// An interval between two ends, wider by what the model misses and by what is not known of the instants themselves:
/// those of two starts.
fn widened(value: f64, [a, b]: [f64; 2], onset_s: Option<[f64; 2]>) -> [f64; 2] {
    let unknown_s = MISSED_S.hypot(std::f64::consts::SQRT_2 * half(onset_s).unwrap_or_default());
    let (low, high) = (value.min(a).min(b), value.max(a).max(b));
    [value - (value - low).hypot(unknown_s), value + (high - value).hypot(unknown_s)]
}

fn half(interval_s: Option<[f64; 2]>) -> Option<f64> {
    interval_s.map(|[low, high]| 0.5 * (high - low).abs())
}

/// The delay of the same start under other circumstances.
fn delay_s_of(others: &[Transition], start: &Transition) -> Option<f64> {
    let apart = |other: &&Transition| (other.planned_onset_s - start.planned_onset_s).abs();
    others
        .iter()
        .filter(|other| other.kind == start.kind && other.direction == start.direction)
        .filter(|other| apart(other) <= SAME_START_S)
        .min_by(|a, b| apart(a).total_cmp(&apart(b)))?
        .onset_delay_s
}
