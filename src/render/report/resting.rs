//! Joints that behave otherwise than the rest in a way that has a name: later in one direction, off their plan or moving at
//! rest.

use crate::{
    render::{
        kit::{counted, ms, starts_of},
        metric::position,
    },
    replay::{Answer, JointReplay, Replay, RestDrift, Transition},
    series::JointKind,
};

/// What a joint does while its plan rests that it should not.
pub(super) fn at_rest(replay: &Replay, joint: &JointReplay) -> Vec<String> {
    let drift = drifts(replay, joint);
    let off = if drift.is_none() { stays_off(replay, joint) } else { None };
    off.into_iter().chain(drift).collect()
}

/// A joint that stays off its plan while that rests: one that slipped, or does not reach its target.
fn stays_off(replay: &Replay, joint: &JointReplay) -> Option<String> {
    let error = joint.stays_off(replay.rules.sizes(joint.kind))?;
    let size = |value: f64| position(joint.kind, value);
    Some(format!(
        "{} stays off its plan where that rests: by {} (RMS), {} at most at {:.1} s, half of that first at {:.1} s (mean {}; {:.0} s of rest looked at).",
        joint.name,
        size(error.rms),
        size(error.peak),
        error.peak_time_s,
        error.half_peak_time_s,
        size(error.bias),
        error.duration_s
    ))
}

/// Starts that a joint which moves otherwise does not answer.
pub(super) fn unanswered(replay: &Replay, joint: &JointReplay) -> Option<String> {
    const MOST: usize = 3;
    let never = |start: &&Transition| start.joint == joint.name && start.answer == Answer::Never;
    let at: Vec<String> =
        replay.transitions.iter().filter(never).map(|t| format!("{:.2} s", t.planned_onset_s)).collect();
    let more = if at.len() > MOST { " and others" } else { "" };
    (joint.moves && !at.is_empty()).then(|| {
        format!(
            "{} leaves {} of {} unanswered: at {}{more}.",
            joint.name,
            at.len(),
            starts_of(joint.starts, joint.reversals),
            at[..at.len().min(MOST)].join(", ")
        )
    })
}

/// A joint that leaves standstill later in one direction.
pub(super) fn one_way(replay: &Replay, joint: &JointReplay) -> Option<String> {
    let found = replay.later_one_way(joint)?;
    let [sign, other] = if found.direction > 0 { ["+", "-"] } else { ["-", "+"] };
    let [later_s, other_s] = found.mean_delay_s;
    Some(format!(
        "{} leaves standstill {} ms later in {sign} than in {other} (95 %: {} to {} ms; {} ms on average of {}, {} ms of {}): a \
         wider dead band, a larger load, {}or gentler planned starts that way.",
        joint.name,
        ms(later_s - other_s),
        ms(found.interval_s[0]),
        ms(found.interval_s[1]),
        ms(later_s),
        counted(found.starts[0], "start"),
        ms(other_s),
        counted(found.starts[1], "start"),
        if drift(replay, joint).is_some() { "its drift at rest, " } else { "" },
    ))
}

/// A joint that moves while its plan rests.
fn drifts(replay: &Replay, joint: &JointReplay) -> Option<String> {
    let drift = drift(replay, joint)?;
    let [low, high] = drift.interval?.map(|speed| per_minute(joint.kind, speed));
    Some(format!(
        "{} drifts while its plan rests: {} a minute ({low} to {high}; {:.0} s of rest looked at).",
        joint.name,
        per_minute(joint.kind, drift.speed),
        drift.duration_s
    ))
}

fn drift(replay: &Replay, joint: &JointReplay) -> Option<RestDrift> {
    joint.rest_drift.filter(|drift| drift.counts(replay.rules.sizes(joint.kind)))
}

/// A slow speed, as what it amounts to.
fn per_minute(kind: JointKind, speed: f64) -> String {
    position(kind, 60.0 * speed)
}
