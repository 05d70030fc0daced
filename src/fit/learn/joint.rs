//! One joint: its runs, and the correction that follows from them.

use std::ops::Range;

use super::{
    super::{FitError, JointFit, model::STEP_S},
    JointStep, Learning, Room, SHARE, Step, Trial,
    answer::Answer,
    astray::{CAP_RAD, is_astray},
    chance::{Chance, unlearnt},
    correct::{
        Aim, CALM_MODEL_HZ, Manner, NONE_RAD, Workspace, faded, first, inverted, largest, unexplained_rad,
    },
    oscillation::{Character, Oscillation},
    part::{is_part, still_asked},
    shape::{Wanted, shaped},
    spoilt::{Left, unspoilt},
    spread::{compared, spread_rad},
    stalled::stalled,
    stop::Stop,
};
use crate::{
    math::{lowpass, smooth_step},
    series::{JointKind, Track},
    units::DEGREE_RAD,
};

/// Part of these over which a wanted correction fades, s.
const FADES_S: f64 = 0.5;

/// Largest correction of a plan by what that is off by, where that is more than little.
const CAP_BY_ERROR: f64 = 1.25;

/// Frequency of what is left of a finished correction by half, Hz, and by that of what is learnt.
const FINISHED_HZ: f64 = 1.2;

const FINISHED_BY_CUT_OFF: f64 = 2.0;

/// The same of a correction that is kept: it was finished when it was sent.
const KEPT_HZ: f64 = 8.0;

/// A part of another run's correction that differs by more is told, rad.
const TOLD_RAD: f64 = 0.1 * DEGREE_RAD;

/// An error that is larger than the best so far by this factor has grown; so has one that is larger by less, and by so much, rad.
const GROWN: f64 = 1.1;
const GROWN_BY: (f64, f64) = (1.04, 0.03 * DEGREE_RAD);

/// Share of an error that a later run corrects: of a calm joint, of one that rings slowly, of one that rings fast
/// or hunts.
const GAINS: [f64; 3] = [0.7, 0.6, 0.9];

/// Between slow and fast, Hz.
const FAST_HZ: f64 = 1.5;

/// Corrections that differ by less than this share are the same.
const AGAIN: f64 = 0.05;

/// Errors that differ from run to run by this share of them tell nothing of what a correction gained.
const DIFFERS: f64 = 0.3;

/// One joint with its runs.
pub(super) struct Joint<'a> {
    fit: Option<&'a JointFit>,
    name: &'a str,
    kind: JointKind,
    pub(super) planned: Vec<(f64, f64)>,
    answers: Vec<Answer>,
    /// What was added to the plan in each run, rad.
    sent: Vec<Vec<f64>>,
    stop: Option<Stop>,
    chance: Option<Chance>,
    /// Whether the newest run has little to do with the plan.
    astray: bool,
    pub(super) oscillation: Option<Oscillation>,
    workspace: Workspace,
}

impl<'a> Joint<'a> {
    pub(super) fn of(fit: Option<&'a JointFit>, track: &'a Track, runs: &[Trial]) -> Result<Self, FitError> {
        let mut planned = super::super::predict::grid(track)?;
        planned.pop();
        let from_s = track.t_s().first().copied().unwrap_or_default();
        let answer = |(run, trial): (usize, &Trial)| Answer::of(run, trial, track.name(), from_s, &planned);
        let mut answers: Vec<Answer> = runs.iter().enumerate().filter_map(answer).collect();
        let stop = Stop::of(&planned, &answers);
        if let Some(stop) = &stop {
            for run in &mut answers {
                stop.unlearnt(run, &planned);
            }
        }
        let sent = answers.iter().map(|run| run.correction_rad(&planned)).collect();
        let mut workspace = Workspace::default();
        let astray =
            answers.last().is_some_and(|run| is_astray((track.kind(), &planned), run, fit, &mut workspace));
        let known = fit.filter(|_| !astray);
        let chance = known.and_then(|fit| unlearnt(&mut answers, &planned, &fit.model, &mut workspace));
        // What a joint does that follows another plan, or none, is no oscillation of its loop.
        let newest = fit.zip(answers.last()).filter(|_| !astray);
        let oscillation = newest.map(|(fit, run)| {
            let unaided = run.correction_rad(&planned).into_iter().zip(run.error_rad(&planned));
            let unaided_rad: Vec<f64> = unaided.map(|(sent, error)| sent + error).collect();
            Oscillation::beside(&unexplained_rad(run, &fit.model.calmed(), &mut workspace), &unaided_rad)
        });
        Ok(Self {
            fit,
            name: track.name(),
            kind: track.kind(),
            planned,
            answers,
            sent,
            stop,
            chance,
            astray,
            oscillation,
            workspace,
        })
    }

    pub(super) fn next(
        mut self,
        settings: Learning,
        all_ring: bool,
        untouched: bool,
        free: &[Range<usize>],
        room: &impl Fn(&str) -> Option<Room>,
    ) -> JointStep {
        let errors: Vec<Vec<f64>> = self.answers.iter().map(|run| run.error_rad(&self.planned)).collect();
        let largest_rad = errors.iter().map(|error_rad| largest(error_rad)).fold(0.0, f64::max);
        // The newest run up to the one to be kept in which the joint was measured.
        let kept = settings.keep.filter(|_| !self.answers.is_empty());
        let kept = kept.map(|keep| self.answers.iter().rposition(|run| run.of_run <= keep).unwrap_or(0));
        // What the plan is off by unaided, as its first run tells; what was sent beyond that is never clipped, and does not grow
        // where a joint cannot follow.
        let unaided = |(sent, error): (&Vec<f64>, &Vec<f64>)| {
            largest(&sent.iter().zip(error).map(|(sent, error)| sent + error).collect::<Vec<f64>>())
        };
        let unaided_rad = self.sent.iter().zip(&errors).next().map_or(0.0, unaided);
        let sent_rad = self.sent.iter().map(|sent| largest(sent)).fold(0.0, f64::max);
        let most_rad = settings
            .most(self.kind)
            .unwrap_or(CAP_RAD.max(CAP_BY_ERROR * largest_rad.max(unaided_rad)).max(sent_rad / SHARE));
        let rms_error_rad: Vec<f64> = errors.iter().map(|error_rad| compared(error_rad)).collect();
        let nothing = vec![[0.0; 3]; self.planned.len()];
        let mut made = JointStep {
            name: self.name.to_owned(),
            step: Step::None,
            oscillation: self.oscillation,
            rms_error_rad,
            spread_rad: None,
            most_rad,
            cut_off_hz: 0.0,
            unseen_s: self.answers.last().map_or(0.0, |run| run.unseen_s),
            shifted_rad: self.answers.last().map_or(0.0, |run| run.shifted_rad),
            stalled: stalled(&self.sent, &errors, free),
            stop: self.stop,
            chance: self.chance,
            correction: nothing,
        };
        let Some(fit) = self.fit.filter(|_| !untouched && !free.is_empty() && settings.gain > 0.0) else {
            return made;
        };
        if self.astray && kept.is_none() {
            made.step = Step::Astray;
            return made;
        }
        let mut character = self.oscillation.map_or(Character::Calm, |found| found.character);
        if all_ring && character == Character::Calm {
            character = Character::Rings;
        }
        let frequency_hz = self.oscillation.map_or(f64::INFINITY, |found| found.frequency_hz);
        // A loop that rings is not to be driven at its frequency, however well that is known.
        let calmed = (character != Character::Calm && fit.model.swings())
            .then(|| JointFit { model: fit.model.calmed(), ..fit.clone() });
        let fit = calmed.as_ref().unwrap_or(fit);
        let manner = Manner::new(&fit.model, character, frequency_hz, most_rad);
        made.cut_off_hz = manner.cut_off_hz;
        made.spread_rad = spread_rad(&self.answers, &self.sent, &fit.model, &mut self.workspace);
        // Where runs differ by themselves, a larger correction that gained nothing tells of no limit.
        let spread_rad = made.spread_rad.unwrap_or(0.0);
        made.stalled.retain(|held| spread_rad < DIFFERS * held.error_rad);
        let fade = fade(self.planned.len(), free);
        let (step, mut wanted_rad) = if let Some(from) = kept {
            let (from, _) = unspoilt(from, &self.sent, &self.whole_rad());
            let (mut kept, mut but) = (self.sent[from].clone(), None);
            // Also of a command that is kept as a whole, not what left more error than less of it.
            for held in &made.stalled {
                let (steps, less) = (held.steps.clone(), &self.sent[held.from][held.steps.clone()]);
                let smaller = largest(less) < largest(&kept[steps.clone()]);
                if smaller && Left::of(&errors[from][steps.clone()]).rms_rad > held.error_rad {
                    let apart = less.iter().zip(&kept[steps.clone()]).map(|(a, b)| a - b);
                    but = but.or((largest(&apart.collect::<Vec<f64>>()) > TOLD_RAD).then_some(held.from));
                    kept[steps].copy_from_slice(less);
                }
            }
            (Step::Kept { from, but }, kept)
        } else {
            let name = self.name;
            let within = |wanted_rad: &[f64]| {
                let mut wanted_rad = wanted_rad.to_vec();
                faded(&mut wanted_rad, &fade);
                let wanted =
                    Wanted { correction_rad: &wanted_rad, cut_off_hz: finished_hz(&manner), most_rad };
                shaped(wanted, free, room(name).as_ref()).into_iter().map(|state| state[0]).collect()
            };
            let (step, mut wanted_rad) =
                self.wanted(fit, &manner, &made.rms_error_rad, &fade, &within, settings);
            for held in &made.stalled {
                wanted_rad[held.steps.clone()].copy_from_slice(&self.sent[held.from][held.steps.clone()]);
            }
            faded(&mut wanted_rad, &fade);
            (step, wanted_rad)
        };
        let relieved_rad = self.stop.map_or(0.0, |stop| stop.relieved(&mut wanted_rad, &self.planned));
        let (cut_off_hz, room) = match step {
            Step::Kept { .. } if relieved_rad < TOLD_RAD => {
                (KEPT_HZ, room(self.name).and_then(Room::of_sent))
            }
            _ => (finished_hz(&manner), room(self.name)),
        };
        // Runs in which the joint was not measured count, too.
        let of_run = |from: usize| self.answers[from].of_run;
        made.step = match step {
            Step::Later { from, gain } => Step::Later { from: of_run(from), gain },
            Step::Rest { from, share } => Step::Rest { from: of_run(from), share },
            Step::Kept { from, but } => Step::Kept { from: of_run(from), but: but.map(of_run) },
            other => other,
        };
        made.stalled.iter_mut().for_each(|held| held.from = of_run(held.from));
        let wanted = Wanted { correction_rad: &wanted_rad, cut_off_hz, most_rad };
        made.correction = shaped(wanted, free, room.as_ref());
        made
    }

    /// What each run was off by, also after the plan, rad.
    fn whole_rad(&self) -> Vec<Vec<f64>> {
        self.answers.iter().map(|run| run.whole_rad(&self.planned)).collect()
    }

    /// The correction before it is made to fit its plan; `within` gives what is left of one that is.
    fn wanted(
        &mut self,
        fit: &JointFit,
        manner: &Manner,
        rms_rad: &[f64],
        fade: &[f64],
        within: &dyn Fn(&[f64]) -> Vec<f64>,
        settings: Learning,
    ) -> (Step, Vec<f64>) {
        let (gain, whole) = (settings.gain, self.whole_rad());
        let Self { planned, answers, sent, workspace, .. } = self;
        let scaled = |mut values: Vec<f64>, by: f64| {
            for x in &mut values {
                *x *= by;
            }
            values
        };
        let Some(newest) = answers.last() else {
            if !fit.trusted() {
                return (Step::None, vec![0.0; planned.len()]);
            }
            let aim = Aim { disturbance_rad: None, calm_hz: CALM_MODEL_HZ, offset_rad: 0.0 };
            let by_model = inverted(&fit.model, manner, (planned, fade), aim, workspace);
            return (Step::Model, scaled(by_model, gain));
        };
        let plain = sent.iter().all(|sent| largest(sent) <= NONE_RAD);
        if plain || (answers.len() == 1 && settings.anew) {
            let (wanted, model_weight) =
                first(&fit.model, manner, (planned, fade), newest, fit.held_out_r2, workspace);
            return (Step::First { model_weight }, scaled(wanted, gain));
        }
        let follow = settings.follow && manner.character == Character::Calm;
        let (from, trust) = if follow { (answers.len() - 1, 1.0) } else { trusted(rms_rad, sent) };
        let (from, trust) = match unspoilt(from, sent, &whole) {
            // One correction may be mended by the next; twice is enough.
            (_, 0 | 1) => (from, trust),
            (other, _) => return (Step::Kept { from: other, but: None }, sent[other].clone()),
        };
        let usual = match manner.character {
            Character::Calm => GAINS[0],
            Character::Rings if manner.cut_off_hz < FAST_HZ * 0.35 => GAINS[1],
            Character::Rings | Character::Hunts => GAINS[2],
        };
        // However often it was sent.
        let none = |k: &usize| largest(&sent[*k]) <= NONE_RAD;
        let again = |k: usize| {
            let apart = sent[k].iter().zip(&sent[from]).map(|(a, b)| a - b);
            largest(&apart.collect::<Vec<f64>>()) < AGAIN * largest(&sent[from])
        };
        let failed = |k: usize| grown(rms_rad[k], rms_rad[from]);
        let is_first = (0..answers.len()).all(|k| none(&k) || again(k) || failed(k));
        let plain = (0..from).rev().find(none);
        if let Some(plain) = plain.filter(|_| is_first && manner.character != Character::Hunts) {
            // What no error tells, such as the step over a dead band, is in the whole of a first correction alone.
            let plain = &answers[plain];
            let (whole, _) = first(&fit.model, manner, (planned, fade), plain, fit.held_out_r2, workspace);
            if is_part(&sent[from], &within(&whole)) {
                let share = gain * trust;
                let rest: Vec<f64> =
                    sent[from].iter().zip(&whole).map(|(sent, whole)| whole - sent).collect();
                let learnt = manner.learnt(&answers[from].error_rad(planned), 1.0);
                let asked = still_asked(planned, &rest, &learnt);
                let more = rest.iter().zip(&learnt).zip(asked);
                let more = more.map(|((rest, learnt), asked)| asked * rest + (1.0 - asked) * usual * learnt);
                let next = sent[from].iter().zip(more).map(|(sent, more)| sent + share * more);
                return (Step::Rest { from, share }, next.collect());
            }
        }
        let gain = gain * trust * usual;
        let mut next = sent[from].clone();
        for (next, more) in next.iter_mut().zip(manner.learnt(&answers[from].error_rad(planned), gain)) {
            *next = (*next + more).clamp(-manner.most_rad, manner.most_rad);
        }
        if manner.character != Character::Calm {
            lowpass(&mut next, manner.cut_off_hz, STEP_S);
        }
        (Step::Later { from, gain }, next)
    }
}

/// Frequency of what is left of a finished correction by half, Hz.
fn finished_hz(manner: &Manner) -> f64 {
    FINISHED_HZ.max(FINISHED_BY_CUT_OFF * manner.cut_off_hz)
}

fn grown(now_rad: f64, best_rad: f64) -> bool {
    now_rad > GROWN * best_rad || (now_rad > GROWN_BY.0 * best_rad && now_rad - best_rad > GROWN_BY.1)
}

/// The run to go on from, and what is left of trust in a step: half for each run that grew the error by another command, and twice for
/// each that did not. The same sent again tells nothing of a step.
fn trusted(rms_rad: &[f64], sent: &[Vec<f64>]) -> (usize, f64) {
    let (mut best, mut trust) = (0, 1.0_f64);
    let again = |k: usize, best: usize| {
        let apart = sent[k].iter().zip(&sent[best]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        apart < (AGAIN * largest(&sent[best])).max(AGAIN * TOLD_RAD)
    };
    for (k, now) in rms_rad.iter().enumerate().skip(1) {
        if !again(k, best) {
            trust = if grown(*now, rms_rad[best]) { 0.5 * trust } else { (2.0 * trust).min(1.0) };
        }
        if *now < rms_rad[best] {
            best = k;
        }
    }
    let last = rms_rad.len().saturating_sub(1);
    let worse = rms_rad.get(last).is_some_and(|now| grown(*now, rms_rad[best])) && !again(last, best);
    (if worse { best } else { last }, trust)
}

/// What is left of a correction that fades out towards the ends of its stretches, 0 to 1 by step.
fn fade(steps: usize, free: &[Range<usize>]) -> Vec<f64> {
    let mut weight = vec![0.0; steps];
    let over = FADES_S / STEP_S;
    for stretch in free {
        for k in stretch.clone() {
            let [since, until] =
                [k - stretch.start, stretch.end - 1 - k].map(|steps| smooth_step(steps as f64 / over));
            weight[k] = since * until;
        }
    }
    weight
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trust_comes_back_and_the_same_sent_again_takes_none() {
        let sent = |of: &[f64]| of.iter().map(|deg| vec![deg * DEGREE_RAD; 4]).collect::<Vec<_>>();
        let rad = |of: &[f64]| of.iter().map(|deg| deg * DEGREE_RAD).collect::<Vec<_>>();
        // The same command again and again, on a machine that differs from run to run.
        assert_eq!(trusted(&rad(&[1.0, 0.5, 0.6, 0.5, 0.6]), &sent(&[0.0, 0.5, 0.5, 0.5, 0.5])), (4, 1.0));
        // More of it grew the error twice, and then not.
        let grew = [1.0, 0.5, 0.7, 0.8];
        assert_eq!(trusted(&rad(&grew), &sent(&[0.0, 0.5, 1.0, 1.4])), (1, 0.25));
        assert_eq!(trusted(&rad(&[1.0, 0.5, 0.7, 0.4]), &sent(&[0.0, 0.5, 1.0, 0.6])), (3, 1.0));
        // Sent back after it grew the error, and as before: half a step is next.
        assert_eq!(trusted(&rad(&[1.0, 0.5, 0.7, 0.5]), &sent(&[0.0, 0.5, 1.0, 0.5])), (3, 0.5));
    }
}
