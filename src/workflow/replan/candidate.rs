//! Plans with their commands and what is expected of them, and which is sent.

use super::{
    Commanded, Decision, Inputs, JointCommand, OfRuns, Predicted, ReplanFailure, Response,
    command::commanded, history::History, last::Last, promised, subject::Subject, warp::Warp,
};
use crate::{
    fit::{Fit, Learning, Step, Supply, TRAVELS_RAD, Trial},
    math::range,
    plan::{PlanEvaluation, Setup},
    series::Series,
    threads,
    workflow::carried::rest::PLAN_LEAD_S,
};

/// A new timing must be expected to lower the sum of all peaks by this share; otherwise the proven one stays.
const WORTH: f64 = 0.02;

/// The same where only a part of the correction is sent: the rest of it gains more, and gives up what this run tells of its own timing.
const WORTH_OF_A_PART: f64 = 0.1;

/// A plan under the limits of the search, where it is not the last one, and its samples.
pub(super) type Sampled = (Option<PlanEvaluation>, Series);

/// A plan with its command and what is expected of it.
pub(super) struct Candidate {
    /// The plan under the limits of the search, if it is not the last one.
    pub(super) new: Option<PlanEvaluation>,
    pub(super) plan: Series,
    /// Points a second of a trajectory to send.
    pub(super) points_hz: f64,
    pub(super) command: Option<Commanded>,
    pub(super) predicted: Predicted,
    pub(super) responses: Vec<Response>,
}

impl Candidate {
    /// What to keep where more error is expected of a correction of the last plan than its best run had.
    fn kept_instead(&self, history: &History) -> Option<Decision> {
        let corrects = self.new.is_none() && self.command.as_ref().is_some_and(Commanded::applied);
        history.better_than(self.predicted.mean_peak_rad).filter(|_| corrects)
    }

    /// What to keep where this is hardly expected to gain.
    fn settled(&self, history: &History) -> Option<Decision> {
        let command = self.command.as_ref().filter(|command| self.new.is_none() && command.applied())?;
        history.settled(&command.series, self.predicted.mean_peak_rad)
    }

    /// Whether half of the joints that are to move, or more, do not follow.
    pub(super) fn astray(&self) -> bool {
        let moves = |joint: &&JointCommand| {
            self.plan.track(&joint.name).is_some_and(|track| {
                let [lowest, highest] = range(track.position().iter().copied());
                highest - lowest > TRAVELS_RAD
            })
        };
        let joints = || self.command.iter().flat_map(|command| &command.joints).filter(moves);
        let astray = joints().filter(|joint| joint.step == Step::Astray).count();
        astray > 0 && 2 * astray >= joints().count()
    }
}

/// The candidate to send, and whether to go on. A machine that was taken to go on changing one way is none where more is then expected
/// of the next run than the newest had.
pub(super) fn decided(
    maker: &Maker<'_>,
    history: &mut History,
    options: &[Sampled],
    learns: bool,
) -> Result<(Candidate, Decision), ReplanFailure> {
    let decides = |history: &History| if learns { history.decision() } else { Decision::Send };
    let mut chosen = maker.best(history, &decides(history), options)?;
    if history.follows && chosen.kept_instead(history).is_some() {
        history.follows = false;
        chosen = maker.best(history, &decides(history), options)?;
    }
    let (history, decision) = (&*history, decides(history));
    if decision != Decision::Send {
        return Ok((chosen, decision));
    }
    let kept = |keep: &Decision| maker.candidate(history, keep, None, maker.last.plan.clone());
    // What is kept is no other correction, whatever is expected of it.
    if let Some(keep) = chosen.kept_instead(history) {
        let kept = kept(&keep)?;
        // Joints that the kept run spoilt are sent something else.
        if kept.predicted.mean_peak_rad < chosen.predicted.mean_peak_rad {
            return Ok((kept, keep));
        }
    }
    match chosen.settled(history).filter(|_| learns) {
        Some(keep) => Ok((kept(&keep)?, keep)),
        None => Ok((chosen, decision)),
    }
}

/// Makes candidates.
pub(super) struct Maker<'a> {
    pub(super) inputs: &'a Inputs,
    /// Whether a command is wanted and some joint is known well enough for one.
    pub(super) precompensates: bool,
    pub(super) fit: &'a Fit,
    pub(super) setup: Option<&'a Setup>,
    pub(super) last: &'a Last,
}

impl Maker<'_> {
    /// The best of some plans.
    fn best(
        &self,
        history: &History,
        decision: &Decision,
        options: &[Sampled],
    ) -> Result<Candidate, ReplanFailure> {
        let of =
            |(): &mut (), (new, plan): &Sampled| self.candidate(history, decision, new.clone(), plan.clone());
        let made = threads::mapped(options, || (), of);
        let worth = if self.inputs.learning.gain < 1.0 { WORTH_OF_A_PART } else { WORTH };
        choose(made.into_iter().collect::<Result<_, _>>()?, worth).ok_or_else(|| ReplanFailure::AtRest {
            path: self.inputs.logs.last().cloned().unwrap_or_default(),
        })
    }

    /// `new` is of another plan than the last; its runs say nothing of this one.
    fn candidate(
        &self,
        history: &History,
        decision: &Decision,
        new: Option<PlanEvaluation>,
        plan: Series,
    ) -> Result<Candidate, ReplanFailure> {
        let Self { inputs, precompensates, fit, setup, last } = self;
        let kept = new.is_none();
        let motion = match (&new, setup) {
            (Some(new), Some(setup)) => Some((setup.motion_through(&new.times_s, &new.via)?, PLAN_LEAD_S)),
            _ => last.motion().zip(last.starts_s),
        };
        let warped = new.as_ref().and_then(|new| self.warped(history, &new.times_s, &plan));
        let trials = match &warped {
            _ if kept => history.trials(),
            Some(measured) => vec![Trial { sent: &plan, measured }],
            None => Vec::new(),
        };
        let keep = match decision {
            Decision::Keep { run, .. } if kept => Some(*run),
            _ => None,
        };
        let gain = inputs.learning.gain * if kept { history.trust() } else { 1.0 };
        let anew = kept && history.anew();
        let learning = Learning { gain, keep, anew, follow: kept && history.follows, ..inputs.learning };
        let subject = Subject::new(&plan, motion, *setup);
        let points_hz = subject.points_hz;
        let corrects = *precompensates && (kept || !self.starved());
        let command = corrects.then(|| commanded(fit, &subject, &trials, learning)).transpose()?;
        let sent = command.as_ref().map_or(&plan, |command| &command.series);
        // What is kept may have come since with some joints sent something else.
        let again = keep.and_then(|_| history.sent_in(sent));
        let newest = again.or(keep).unwrap_or(trials.len().saturating_sub(1));
        let times = (0..trials.len()).filter(|k| kept && history.same(*k, newest)).count();
        let base = trials.get(newest).map(|trial| (trial.sent, trial.measured, times));
        let joints = || command.iter().flat_map(|command| &command.joints);
        // What came by chance came in the newest run.
        let newest = newest + 1 == trials.len();
        let of = |one: &JointCommand| OfRuns {
            spread_rad: one.spread_rad,
            tried: kept && times < trials.len(),
            held: one.held,
            by_chance: one.by_chance.filter(|_| newest),
        };
        let learnt = |name: &str| joints().find(|joint| joint.name == name).map_or_else(OfRuns::default, of);
        let (predicted, responses) = promised(fit, &plan, sent, base, learnt, &inputs.rules)?;
        let predicted = if kept { predicted.unsteady(history.unsteady_rad()) } else { predicted };
        Ok(Candidate { new, plan, points_hz, command, predicted, responses })
    }

    /// Whether joints were held back in the last run by what they share: of how they go where that is enough the run says nothing.
    fn starved(&self) -> bool {
        asks_too_much(self.fit, &self.last.plan, self.setup)
    }

    /// Where joints were held back, the plans that ask for no more than they share, if there are such: no correction makes up for that,
    /// and what is expected of other plans is of joints that are held back.
    pub(super) fn within_shared(&self, options: Vec<Sampled>) -> Vec<Sampled> {
        let within = |option: &&Sampled| !asks_too_much(self.fit, &option.1, self.setup);
        if !self.starved() || !options.iter().any(|option| within(&option)) {
            return options;
        }
        options.iter().filter(within).cloned().collect()
    }

    /// What the newest run tells of another timing.
    fn warped(&self, history: &History, new_s: &[f64], plan: &Series) -> Option<Series> {
        let Self { fit, last, .. } = self;
        let (starts_s, old_s) = (last.starts_s?, last.times_s.as_ref()?);
        let warp = Warp {
            old_s: old_s.iter().map(|t_s| starts_s + t_s).collect(),
            new_s: new_s.iter().map(|t_s| PLAN_LEAD_S + t_s).collect(),
        };
        warp.run(fit, plan, history.newest()?)
    }
}

/// A plan that asks for this many times what its joints share, at an instant, hardly holds them back.
const BRIEFLY: f64 = 1.1;

/// Whether a plan asks for more than its joints share, or than their pump gives.
pub(super) fn asks_too_much(fit: &Fit, plan: &Series, setup: Option<&Setup>) -> bool {
    let shared = fit.shared.as_ref().and_then(|shared| Some(shared.asked(plan)?.0));
    let of_pump = || Some(Supply::asked_m3_s(plan, setup?.arm())? / fit.supply?.gives_m3_s()?);
    shared.is_some_and(|asked| asked > BRIEFLY) || of_pump().is_some_and(|asked| asked > BRIEFLY)
}

/// The first unless another is expected to be better by enough.
fn choose(made: Vec<Candidate>, worth: f64) -> Option<Candidate> {
    let mut all = made.into_iter();
    let first = all.next()?;
    let most = (1.0 - worth) * first.predicted.sum_of_peaks_rad;
    let better = all.min_by(|a, b| a.predicted.sum_of_peaks_rad.total_cmp(&b.predicted.sum_of_peaks_rad));
    Some(better.filter(|better| better.predicted.sum_of_peaks_rad < most).unwrap_or(first))
}
