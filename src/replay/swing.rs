//! Swings of joints that their plans do not ask for, over the run by its spectrum, or where the plan rests.

use super::{Replay, rest_swing::rest_swing, spectrum::spectrum};
use crate::series::{JointKind, Pair};

/// A swing of a joint that its plan does not ask for.
#[derive(Debug, Clone, PartialEq)]
pub struct Swing {
    /// The joint.
    pub joint: String,
    /// Whether it turns or slides.
    pub kind: JointKind,
    /// How often, Hz.
    pub frequency_hz: f64,
    /// Over the run, or over the rests, in the joint's unit.
    pub amplitude: f64,
    /// Whether it was looked for where the plan rests alone.
    pub at_rest: bool,
}

/// Joints that swing by more than half of what counts as a way.
pub fn swings(pairs: &[Pair], replay: &Replay) -> Vec<Swing> {
    let over_run = |pair: &Pair| {
        let found = spectrum(pair)?.swing()?;
        (found[1] > 0.5 * replay.rules.sizes(pair.kind).displacement).then_some((found, false))
    };
    let at_rest = |pair: &Pair| {
        let joint = replay.joints.iter().find(|joint| joint.name == pair.name)?;
        Some((rest_swing(pair, joint.noise.sigma, &replay.rules)?, true))
    };
    let of = |pair: &Pair| {
        let ([frequency_hz, amplitude], at_rest) = over_run(pair).or_else(|| at_rest(pair))?;
        Some(Swing { joint: pair.name.clone(), kind: pair.kind, frequency_hz, amplitude, at_rest })
    };
    pairs.iter().filter_map(of).collect()
}
