//! Joints that have little to do with their plan.

use super::{
    super::{Fit, JointFit},
    Trial,
    answer::Answer,
    correct::Workspace,
};
use crate::{
    math::{deviation, range, rms},
    series::{JointKind, Series},
    units::DEGREE_RAD,
};

/// A joint whose error is more than this share of its motion does not follow its plan: what it does is no error to be
/// corrected.
const FOLLOWS: f64 = 0.5;

/// Smaller errors are corrected, however little the plan asks for, rad or m.
const fn detail(kind: JointKind) -> f64 {
    match kind {
        JointKind::Turns => 0.3 * DEGREE_RAD,
        JointKind::Slides => 0.003,
    }
}

/// Largest correction of a plan that is off by little, rad.
pub(super) const CAP_RAD: f64 = 1.5 * DEGREE_RAD;

/// Share of the error of a slow joint that its model may leave.
const EXPLAINED: f64 = 0.2;

/// A plan of a joint that travels less is to hold it, rad.
pub const TRAVELS_RAD: f64 = 0.5 * DEGREE_RAD;

/// Whether half of the joints that a plan moves, or more, do not follow it in a run: no command is made of one.
pub fn half_astray(fit: &Fit, plan: &Series, run: Trial) -> bool {
    let mut workspace = Workspace::default();
    let (mut moving, mut astray) = (0, 0);
    for track in &plan.tracks {
        let [lowest, highest] = range(track.position().iter().copied());
        let from_s = track.t_s().first().copied().unwrap_or_default();
        let Ok(planned) = super::super::predict::grid(track) else { continue };
        let Some(answer) = Answer::of(0, &run, track.name(), from_s, &planned) else { continue };
        if highest - lowest > TRAVELS_RAD {
            moving += 1;
            astray += usize::from(is_astray(
                (track.kind(), &planned),
                &answer,
                fit.joint(track.name()),
                &mut workspace,
            ));
        }
    }
    astray > 0 && 2 * astray >= moving
}

/// Whether a run has little to do with the plan: wrong sign, zero, unit or name, or a joint that is stuck. One that moves,
/// and is as far off as its model says, is no such joint but a slow one.
pub(super) fn is_astray(
    (kind, planned): (JointKind, &[(f64, f64)]),
    run: &Answer,
    fit: Option<&JointFit>,
    workspace: &mut Workspace,
) -> bool {
    // A zero that is shifted by more than the motion is no detail of it.
    let missed_rad = |by: &mut dyn Iterator<Item = f64>| {
        rms(&by.zip(&run.measured_rad).map(|(angle, measured)| angle - measured).collect::<Vec<f64>>())
    };
    let error_rad = missed_rad(&mut planned.iter().map(|planned| planned.0));
    let asked_rad = deviation(&planned.iter().map(|planned| planned.0).collect::<Vec<f64>>());
    let slow = |fit: &JointFit| {
        let left_rad = missed_rad(&mut workspace.response(&fit.model, &run.sent).iter().copied());
        let moves = deviation(&run.measured_rad) > FOLLOWS * asked_rad;
        fit.trusted() && moves && left_rad < EXPLAINED * error_rad
    };
    error_rad > detail(kind).max(FOLLOWS * asked_rad) && !fit.is_some_and(slow)
}
