//! The correction of one joint that is wanted next: from its model, from what came of what was sent, or from both.

use super::{
    super::{
        model::{Model, STEP_S, steps_in},
        simulate::{Start, simulate},
    },
    answer::Answer,
    oscillation::Character,
};
use crate::{
    math::{lowpass, rms},
    units::DEGREE_RAD,
};

/// Corrections below this are none, rad.
pub(super) const NONE_RAD: f64 = 1e-3 * DEGREE_RAD;

/// A correction acts this much later than the lag says, s.
const BEYOND_LAG_S: f64 = 0.05;

/// Frequency above which a calm joint's error is not learnt, Hz.
const CALM_HZ: f64 = 0.5;

/// The same of one that oscillates, by its frequency.
const OF_OSCILLATION: f64 = 0.35;

/// A model is inverted below this, Hz: of a calm joint beside data and alone, and of one that oscillates.
const CALM_INVERTED_HZ: f64 = 0.8;
pub(super) const CALM_MODEL_HZ: f64 = 1.0;
const INVERTED_HZ: f64 = 4.0;

/// Rounds of the inversion, and the share of the predicted error that one corrects.
const ROUNDS: usize = 100;
const SHARE: f64 = 0.3;

/// What is left of an error counts with this share of a correction as large as the error itself, and with more of a larger
/// one: where the model is at its limits, corrections grow and gain little.
const WORTH: f64 = 0.05;

/// Share of a first measured error that is corrected.
const FIRST_GAIN: f64 = 0.9;

/// Weight of the model = this / (this + square of the unexplained share of the error).
const TRUSTED: f64 = 2.0;

/// Of one joint: what its corrections are made with.
#[derive(Debug, Clone, Copy)]
pub(super) struct Manner {
    pub(super) character: Character,
    /// Frequency above which nothing is learnt, Hz.
    pub(super) cut_off_hz: f64,
    /// Steps by which a correction precedes its effect.
    ahead: usize,
    /// Largest correction, rad.
    pub(super) most_rad: f64,
}

impl Manner {
    pub(super) fn new(model: &Model, character: Character, frequency_hz: f64, most_rad: f64) -> Self {
        let cut_off_hz = match character {
            Character::Calm => CALM_HZ,
            Character::Rings | Character::Hunts => CALM_HZ.min(OF_OSCILLATION * frequency_hz),
        };
        Self {
            character,
            cut_off_hz,
            ahead: steps_in(model.set_values_late_s() + model.lag_s() + BEYOND_LAG_S),
            most_rad,
        }
    }

    fn calm(&self) -> bool {
        self.character == Character::Calm
    }

    /// The value that an error asks for: earlier by the lag, without what is too fast to be learnt.
    pub(super) fn learnt(&self, error_rad: &[f64], gain: f64) -> Vec<f64> {
        let mut slow = error_rad.to_vec();
        lowpass(&mut slow, self.cut_off_hz, STEP_S);
        let last = slow.len().saturating_sub(1);
        (0..slow.len()).map(|k| gain * slow[(k + self.ahead).min(last)]).collect()
    }
}

/// Room for simulations.
#[derive(Default)]
pub(super) struct Workspace {
    wanted: Vec<f64>,
    angle_rad: Vec<f64>,
    sent: Vec<(f64, f64)>,
}

impl Workspace {
    /// Response of the model to what was sent, rad.
    pub(super) fn response(&mut self, model: &Model, sent: &[(f64, f64)]) -> &[f64] {
        simulate(model, sent, Start::at_rest(model, sent), &mut self.wanted, &mut self.angle_rad);
        &self.angle_rad
    }

    /// Response to the plan with a correction.
    fn corrected(&mut self, model: &Model, planned: &[(f64, f64)], correction_rad: &[f64]) -> &[f64] {
        self.sent.clear();
        let last = planned.len().saturating_sub(1);
        for (k, planned) in planned.iter().enumerate() {
            let (before, after) = (k.saturating_sub(1), (k + 1).min(last));
            let span_s = (after - before).max(1) as f64 * STEP_S;
            let speed_rad_s = (correction_rad[after] - correction_rad[before]) / span_s;
            self.sent.push((planned.0 + correction_rad[k], planned.1 + speed_rad_s));
        }
        simulate(model, &self.sent, Start::at_rest(model, planned), &mut self.wanted, &mut self.angle_rad);
        &self.angle_rad
    }
}

/// What an inversion takes for granted beside the model.
#[derive(Debug, Clone, Copy)]
pub(super) struct Aim<'a> {
    /// What the model does not explain and comes again, rad.
    pub(super) disturbance_rad: Option<&'a [f64]>,
    /// A calm joint's model is inverted below this, Hz.
    pub(super) calm_hz: f64,
    /// What the model measures beside the plan's zero, and no correction mends, rad.
    pub(super) offset_rad: f64,
}

/// A loop that feeds less speed forward is behind by its gain, too, and may need more time ahead.
const FED: f64 = 0.5;

/// No more steps than this.
const MOST_AHEAD: usize = 100;

/// The correction whose predicted response, with a disturbance that repeats itself, is the plan; none where `fade` is zero.
pub(super) fn inverted(
    model: &Model,
    manner: &Manner,
    (planned, fade): (&[(f64, f64)], &[f64]),
    aim: Aim,
    workspace: &mut Workspace,
) -> Vec<f64> {
    let by_lag = inverted_ahead(model, manner, manner.ahead, (planned, fade), aim, workspace);
    let short = 1.0 - model.feed_forward;
    if short < FED {
        return by_lag.1;
    }
    let more = steps_in(0.5 * short / model.position_gain_1_s.max(f64::MIN_POSITIVE)).min(MOST_AHEAD);
    let by_gain = inverted_ahead(model, manner, manner.ahead + more, (planned, fade), aim, workspace);
    if by_gain.0 < by_lag.0 { by_gain.1 } else { by_lag.1 }
}

/// The same with corrections so many steps before what they correct, after what is left of the error.
fn inverted_ahead(
    model: &Model,
    manner: &Manner,
    ahead: usize,
    (planned, fade): (&[(f64, f64)], &[f64]),
    aim: Aim,
    workspace: &mut Workspace,
) -> (f64, Vec<f64>) {
    let last = planned.len().saturating_sub(1);
    // What a loop that rings leaves unexplained is not the same in the next run.
    let disturbance_rad = aim.disturbance_rad.filter(|_| manner.calm());
    let inner_hz = if manner.calm() { aim.calm_hz } else { INVERTED_HZ };
    let mut correction_rad = vec![0.0; planned.len()];
    let mut best = (f64::INFINITY, correction_rad.clone());
    let mut unaided_rad = None;
    for _ in 0..=ROUNDS {
        let response = workspace.corrected(model, planned, &correction_rad);
        let error_rad: Vec<f64> = (planned.iter().zip(response).enumerate())
            .map(|(k, (planned, response))| {
                planned.0 + aim.offset_rad - response - disturbance_rad.map_or(0.0, |d| d[k])
            })
            .collect();
        let error = rms(&error_rad);
        let unaided_rad = unaided_rad.get_or_insert(error).max(f64::MIN_POSITIVE);
        let left = error + WORTH * rms(&correction_rad).powi(2) / unaided_rad;
        if left < best.0 {
            best = (left, correction_rad.clone());
        }
        for (k, correction) in correction_rad.iter_mut().enumerate() {
            *correction += SHARE * error_rad[(k + ahead).min(last)];
        }
        lowpass(&mut correction_rad, inner_hz, STEP_S);
        faded(&mut correction_rad, fade);
        for correction in &mut correction_rad {
            *correction = correction.clamp(-manner.most_rad, manner.most_rad);
        }
    }
    if !manner.calm() {
        lowpass(&mut best.1, manner.cut_off_hz, STEP_S);
    }
    best
}

/// A first correction, from the model and from the run behind it: what was sent, what the model makes of it,
/// and what came.
pub(super) fn first(
    model: &Model,
    manner: &Manner,
    (planned, fade): (&[(f64, f64)], &[f64]),
    run: &Answer,
    skill: f64,
    workspace: &mut Workspace,
) -> (Vec<f64>, f64) {
    let unexplained_rad = unexplained_rad(run, model, workspace);
    let error_rad = run.error_rad(planned);
    let beta = model_weight(manner, &unexplained_rad, &error_rad, skill);
    let mut disturbance_rad = unexplained_rad;
    lowpass(&mut disturbance_rad, manner.cut_off_hz, STEP_S);
    let aim = Aim {
        disturbance_rad: Some(&disturbance_rad),
        calm_hz: CALM_INVERTED_HZ,
        offset_rad: run.offset_rad(model),
    };
    let by_model = inverted(model, manner, (planned, fade), aim, workspace);
    let sent_rad = run.correction_rad(planned);
    let learnt_rad = manner.learnt(&error_rad, FIRST_GAIN);
    let by_data = sent_rad
        .iter()
        .zip(learnt_rad)
        .map(|(sent, more)| (sent + more).clamp(-manner.most_rad, manner.most_rad));
    let blend = by_model.iter().zip(by_data).map(|(model, data)| beta * model + (1.0 - beta) * data);
    (blend.collect(), beta)
}

/// Measured less modelled angles, rad; without what their zeros differ by where the measurement's is known to be shifted.
pub(super) fn unexplained_rad(run: &Answer, model: &Model, workspace: &mut Workspace) -> Vec<f64> {
    let zero_rad = run.shifted_rad - run.offset_rad(model);
    let response = workspace.response(model, &run.sent);
    run.measured_rad.iter().zip(response).map(|(measured, response)| measured - response - zero_rad).collect()
}

/// How much a model counts beside data, 0 to 1.
pub(super) fn model_weight(manner: &Manner, unexplained_rad: &[f64], error_rad: &[f64], skill: f64) -> f64 {
    let hunts = manner.character == Character::Hunts;
    if hunts || (manner.calm() && skill < 0.0) {
        return 0.0;
    }
    let left = rms(unexplained_rad) / rms(error_rad).max(f64::MIN_POSITIVE);
    let beta = TRUSTED / (TRUSTED + left * left);
    if beta.is_finite() { beta } else { 0.0 }
}

/// Fades a correction out where it must be none.
pub(super) fn faded(correction_rad: &mut [f64], fade: &[f64]) {
    correction_rad.iter_mut().zip(fade).for_each(|(correction, fade)| *correction *= fade);
}

/// Largest distance from zero.
pub(super) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}
