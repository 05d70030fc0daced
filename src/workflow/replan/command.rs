//! The command to send for a plan, held to the arm's limits.

use serde::{Deserialize, Serialize};

use crate::{
    fit::{Compensation, Fit, FitError, JointCompensation, STEP_S, compensate},
    plan::{KEPT_SHARE, Limit, Margin, Setup},
    series::Series,
};

/// Gains that are tried for a joint whose command breaks a limit, as shares of the gain asked for.
const GAINS: [f64; 4] = [0.75, 0.5, 0.25, 0.0];

/// The command of one joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct JointCommand {
    /// The correction.
    #[serde(flatten)]
    pub compensation: JointCompensation,
    /// Share of the correction that is applied.
    pub gain: f64,
    /// The limit for which that is less than was asked for.
    pub because: Option<Limit>,
}

/// A command, and how near it comes to the arm's limits.
#[derive(Debug, Clone, PartialEq)]
pub struct Commanded {
    /// What to send.
    pub series: Series,
    /// One entry a joint of the plan.
    pub joints: Vec<JointCommand>,
    /// The limits of the task's arm; empty without a task.
    pub margins: Vec<Margin>,
}

/// A command for a plan. Where it breaks a limit of position, speed, acceleration or rod that the plan
/// keeps, the joint's gain is lowered until it does not.
///
/// # Errors
///
/// [`FitError`] for settings out of range.
pub(super) fn commanded(
    fit: &Fit,
    plan: &Series,
    settings: Compensation,
    setup: Option<&Setup>,
) -> Result<Commanded, FitError> {
    let made = compensate(fit, plan, settings)?;
    let mut series = made.command;
    let of = |compensation: JointCompensation| {
        let gain = if compensation.applied { settings.gain } else { 0.0 };
        JointCommand { compensation, gain, because: None }
    };
    let mut joints: Vec<JointCommand> = made.joints.into_iter().map(of).collect();
    let Some(setup) = setup else { return Ok(Commanded { series, joints, margins: Vec::new() }) };
    let names = setup.joint_names();
    let allowed = setup.sampled_margins(plan, STEP_S);
    let share_of_plan = |margin: &Margin| {
        let same = |other: &&Margin| (other.limit, other.joint) == (margin.limit, margin.joint);
        allowed.iter().find(same).map_or(0.0, |found| found.share)
    };
    let broken = |margin: &&Margin| margin.share > KEPT_SHARE.max(share_of_plan(margin) + 1e-9);
    for share in GAINS {
        let margins = setup.sampled_margins(&series, STEP_S);
        let worst: Vec<(usize, Limit)> =
            margins.iter().filter(broken).filter_map(|margin| Some((margin.joint?, margin.limit))).collect();
        if worst.is_empty() {
            break;
        }
        for (j, joint) in joints.iter_mut().enumerate() {
            let name = &joint.compensation.name;
            let Some((_, limit)) = worst.iter().find(|(k, _)| names.get(*k) == Some(name)) else { continue };
            let Some(track) = plan.tracks.get(j) else { continue };
            let alone = Series { tracks: vec![track.clone()] };
            let gain = share * settings.gain;
            let again = compensate(fit, &alone, Compensation { gain, ..settings })?;
            let (Some(track), Some(compensation)) =
                (again.command.tracks.into_iter().next(), again.joints.into_iter().next())
            else {
                continue;
            };
            series.tracks[j] = track;
            *joint = JointCommand { compensation, gain, because: Some(*limit) };
        }
    }
    let margins = setup.sampled_margins(&series, STEP_S);
    Ok(Commanded { series, joints, margins })
}
