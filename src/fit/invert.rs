//! A command whose predicted response is the plan.

use serde::{Deserialize, Serialize};

use super::{
    Fit, FitError, JointFit, Model,
    model::STEP_S,
    predict::grid,
    run::{MOVES_RAD_S, steps_in},
    simulate::{Start, simulate},
    smooth::smooth,
};
use crate::{
    math::range,
    series::{Series, Track},
    units::DEGREE_RAD,
};

/// How often the command is corrected.
const ROUNDS: usize = 30;

/// Share of the predicted error that one round corrects.
const SHARE: f64 = 0.5;

/// A correction acts this much later than the lag says, s.
const BEYOND_LAG_S: f64 = 0.05;

/// The command is the plan for so long from its start, s.
const UNTOUCHED_S: f64 = 0.2;

/// Shortest and longest time over which it then comes free, s: where the plan rests first, there is time to
/// take up a standing error without haste.
const FREED_S: [f64; 2] = [0.2, 1.0];

/// Slower corrections count as zero, so that a plan at rest stays a command at rest.
const STILL_RAD_S: f64 = 1e-4;

/// Accelerations are differences of speeds over this, s.
const ACCELERATION_S: f64 = 0.05;

/// How far a command may leave its plan.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Compensation {
    /// Share of the correction that is applied, 0 to 1: less while a model is new.
    pub gain: f64,
    /// Largest distance of command and plan, rad.
    pub most_rad: f64,
}

impl Default for Compensation {
    fn default() -> Self {
        Self { gain: 1.0, most_rad: 1.5 * DEGREE_RAD }
    }
}

/// A command and what it promises.
#[derive(Debug, Clone, PartialEq)]
pub struct Compensated {
    /// Positions and speeds of all tracks of the plan, every [`STEP_S`] where a joint was corrected, as
    /// planned elsewhere.
    pub command: Series,
    /// One entry a track of the plan.
    pub joints: Vec<JointCompensation>,
}

/// Correction of one joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct JointCompensation {
    /// The joint.
    pub name: String,
    /// Whether it was corrected: a fit knows it, and predicts well enough.
    pub applied: bool,
    /// Predicted root mean square error of the plan sent as it is, rad; `None` if no fit knows the
    /// joint.
    pub plain_rms_rad: Option<f64>,
    /// The same of the command, rad.
    pub compensated_rms_rad: Option<f64>,
    /// Largest distance of command and plan, rad.
    pub peak_correction_rad: f64,
    /// Whether the correction was cut off at [`Compensation::most_rad`]: a larger one would take more away.
    pub cut_off: bool,
    /// Lowest and highest angle of the command, rad.
    pub range_rad: [f64; 2],
    /// Largest speed of the command, rad/s.
    pub peak_speed_rad_s: f64,
    /// Largest acceleration of the command, rad/s².
    pub peak_acceleration_rad_s2: f64,
    /// Largest speed of the command by that of the plan; 1 for a plan at rest.
    pub speed_ratio: f64,
    /// Largest acceleration of the command by that of the plan; 1 for a plan at rest.
    pub acceleration_ratio: f64,
}

/// Corrects every joint of a plan that the fit predicts well enough.
///
/// Ranges, speeds and accelerations of the result are the caller's to hold against the arm's limits.
///
/// # Errors
///
/// [`FitError::Setting`], [`FitError::Value`] for an impossible model, [`FitError::Duration`] for a plan longer than
/// an hour.
pub fn compensate(fit: &Fit, plan: &Series, settings: Compensation) -> Result<Compensated, FitError> {
    let bounded = |key, found: f64, most: f64| {
        let inside = (0.0..=most).contains(&found);
        if inside { Ok(()) } else { Err(FitError::Setting { key, found, least: 0.0, most }) }
    };
    bounded("gain", settings.gain, 1.0)?;
    bounded("most_rad", settings.most_rad, 1.0)?;
    fit.check()?;
    let mut joints = Vec::with_capacity(plan.tracks.len());
    let mut tracks = Vec::with_capacity(plan.tracks.len());
    for track in &plan.tracks {
        let planned = grid(track)?;
        let known = fit.joint(track.name());
        let trusted = known.filter(|joint| joint.trusted() && settings.gain > 0.0);
        let (sent, cut_off) = trusted
            .map(|joint| corrected(&joint.model, &planned, settings))
            .map_or((None, false), |made| (Some(made.0), made.1));
        let built = sent.and_then(|sent| Some((on_grid(track, &sent)?, sent)));
        let sent = built.as_ref().map_or(&planned, |(_, sent)| sent);
        let applied = built.is_some();
        let cut_off = applied && cut_off;
        joints.push(JointCompensation { cut_off, ..account(track.name(), known, &planned, sent, applied) });
        tracks.push(built.map_or_else(|| track.clone(), |(track, _)| track));
    }
    Ok(Compensated { command: Series { tracks }, joints })
}

/// The track of a command on the steps of the model; the step past the end is left out.
fn on_grid(plan: &Track, sent: &[(f64, f64)]) -> Option<Track> {
    let (_, sent) = sent.split_last()?;
    let from_s = plan.t_s().first()?;
    let t_s: Vec<f64> = (0..sent.len()).map(|k| from_s + k as f64 * STEP_S).collect();
    let (position_rad, velocity_rad_s): (Vec<f64>, Vec<f64>) = sent.iter().copied().unzip();
    Track::new(plan.name(), t_s, position_rad, &[]).ok()?.with_velocity(velocity_rad_s).ok()
}

/// The plan with a correction that brings the predicted response onto it, and whether that was cut off.
fn corrected(model: &Model, planned: &[(f64, f64)], settings: Compensation) -> (Vec<(f64, f64)>, bool) {
    let n = planned.len();
    let ahead = steps_in(model.lag_s() + BEYOND_LAG_S);
    let rests = planned.iter().position(|planned| planned.1.abs() > MOVES_RAD_S).unwrap_or(0);
    let freed_s = (rests.saturating_sub(ahead) as f64 * STEP_S - UNTOUCHED_S).clamp(FREED_S[0], FREED_S[1]);
    let mut workspace = Workspace::default();
    let mut correction = vec![0.0; n];
    let mut smoothed = Vec::with_capacity(n);
    let mut sent = planned.to_vec();
    let mut best = (workspace.rms_rad(model, planned, &sent), correction.clone());
    for _ in 0..ROUNDS {
        for (k, correction) in correction.iter_mut().enumerate() {
            let later = (k + ahead).min(n - 1);
            *correction += SHARE * (planned[later].0 - workspace.angle_rad[later]);
        }
        smooth(&correction, &mut smoothed);
        for (k, (correction, smoothed)) in correction.iter_mut().zip(&smoothed).enumerate() {
            let since = ((k as f64 * STEP_S - UNTOUCHED_S) / freed_s).clamp(0.0, 1.0);
            let freed = since * since * (3.0 - 2.0 * since);
            *correction = freed * smoothed.clamp(-settings.most_rad, settings.most_rad);
        }
        send(planned, &correction, 1.0, &mut sent);
        let rms_rad = workspace.rms_rad(model, planned, &sent);
        if rms_rad < best.0 {
            best = (rms_rad, correction.clone());
        }
    }
    // The rounds would make up for a smaller gain.
    send(planned, &best.1, settings.gain, &mut sent);
    let cut_off = best.1.iter().any(|correction| correction.abs() >= settings.most_rad);
    (sent, cut_off)
}

/// Plan and correction with the speed that belongs to their sum.
fn send(planned: &[(f64, f64)], correction: &[f64], gain: f64, sent: &mut [(f64, f64)]) {
    let last = planned.len() - 1;
    for (k, (sent, planned)) in sent.iter_mut().zip(planned).enumerate() {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(last));
        let span_s = (after - before).max(1) as f64 * STEP_S;
        let speed_rad_s = gain * (correction[after] - correction[before]) / span_s;
        let still = planned.1.abs() < MOVES_RAD_S && speed_rad_s.abs() < STILL_RAD_S;
        sent.0 = planned.0 + gain * correction[k];
        sent.1 = if still { planned.1 } else { planned.1 + speed_rad_s };
    }
}

/// Workspace for the simulations of one joint.
#[derive(Default)]
struct Workspace {
    wanted: Vec<f64>,
    angle_rad: Vec<f64>,
}

impl Workspace {
    /// Root mean square distance of plan and predicted response, rad.
    fn rms_rad(&mut self, model: &Model, planned: &[(f64, f64)], sent: &[(f64, f64)]) -> f64 {
        simulate(model, sent, Start::at_rest(model, planned), &mut self.wanted, &mut self.angle_rad);
        let squares = planned.iter().zip(&self.angle_rad).map(|(planned, angle)| (planned.0 - angle).powi(2));
        (squares.sum::<f64>() / planned.len().max(1) as f64).sqrt()
    }
}

fn account(
    name: &str,
    known: Option<&JointFit>,
    planned: &[(f64, f64)],
    sent: &[(f64, f64)],
    applied: bool,
) -> JointCompensation {
    let mut workspace = Workspace::default();
    let mut rms_rad = |sent: &[(f64, f64)]| known.map(|joint| workspace.rms_rad(&joint.model, planned, sent));
    let span = steps_in(ACCELERATION_S);
    let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0_f64, |most, x| most.max(x.abs()));
    let speed = |of: &[(f64, f64)]| most(&mut of.iter().map(|s| s.1));
    let acceleration =
        |of: &[(f64, f64)]| most(&mut of.windows(span + 1).map(|w| (w[span].1 - w[0].1) / ACCELERATION_S));
    let ratio = |sent: f64, planned: f64| if planned > 0.0 { sent / planned } else { 1.0 };
    let [least, highest] = range(sent.iter().map(|s| s.0));
    JointCompensation {
        name: name.to_owned(),
        applied,
        plain_rms_rad: rms_rad(planned),
        compensated_rms_rad: rms_rad(sent),
        cut_off: false,
        peak_correction_rad: most(&mut sent.iter().zip(planned).map(|(sent, planned)| sent.0 - planned.0)),
        range_rad: [least, highest],
        peak_speed_rad_s: speed(sent),
        peak_acceleration_rad_s2: acceleration(sent),
        speed_ratio: ratio(speed(sent), speed(planned)),
        acceleration_ratio: ratio(acceleration(sent), acceleration(planned)),
    }
}
