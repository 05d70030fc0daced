//! Whether to go on with corrections, or what to keep.

use serde::{Deserialize, Serialize};

use super::history::{History, PastRun, WORTH};
use crate::{fit::MORE_ERROR, series::Series};

/// A mean peak up to this times the least is as good; up to this, it may be made up for by less error over the whole run.
const NEARLY: f64 = 1.05;
const MADE_UP: f64 = 1.25;

/// A correction that is expected to come above the best run by this factor is not worth sending; above the newest, of a machine that goes
/// on changing. Runs of one command scatter by less.
const WORSE: f64 = 1.1;
const WORSE_AGAIN: f64 = 1.25;

/// A correction that came to more than the best before it by this factor took too large a step, or met what was there that day alone.
const MORE: f64 = 1.1;

/// So many corrections that gained nothing are enough, and so many that gained less than a tenth together.
const FAILURES: usize = 2;
const SEVERAL: usize = 3;

/// Whether to go on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum Decision {
    /// Send the new command.
    Send,
    /// Keep what was sent in a run (by index): there is nothing more to gain.
    Keep {
        /// The run.
        run: usize,
        /// How that is known.
        #[serde(default)]
        because: KeepReason,
        /// Its mean peak, rad.
        best_rad: f64,
        /// Mean peak of the last run, rad.
        last_rad: f64,
    },
}

/// Why nothing more is to be gained.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(tag = "why", rename_all = "snake_case")]
pub enum KeepReason {
    /// The last correction gained less than a tenth, or nothing.
    #[default]
    GainedLittle,
    /// So many corrections brought nothing.
    Failed {
        /// How many.
        corrections: usize,
    },
    /// Hardly less is expected of the next correction, after some that gained little together or as the same again.
    Settled,
    /// The next correction is expected to do worse.
    ExpectedWorse {
        /// Its mean peak, rad.
        expected_rad: f64,
    },
    /// All that it had gained was undone in the newest run, which may never come again.
    Undone {
        /// Its mean peak before that, rad.
        before_rad: f64,
    },
}

/// Error over the whole run, starts, stops and rests: root mean square over all joints, and what that of every joint is
/// below for 95 % of the time, rad.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Overall {
    /// In a corrected run.
    pub rms_rad: f64,
    /// What the error is below for 95 % of it.
    pub p95_rad: f64,
    /// Of the plan as it is, the run that had least.
    pub plain_rms_rad: f64,
    /// What that is below, alike.
    pub plain_p95_rad: f64,
    /// Both of the corrected run before it that had least; null without one.
    #[serde(default)]
    pub before_rad: Option<[f64; 2]>,
}

impl Overall {
    /// Of a corrected run among others; `None` if it is not corrected, or all are.
    pub(super) fn of(runs: &[PastRun], at: usize) -> Option<Self> {
        let least = |runs: &[PastRun], corrected: bool| {
            let own = runs.iter().filter(|run| run.corrected == corrected);
            let least = own.min_by(|a, b| a.rms_error_rad.total_cmp(&b.rms_error_rad));
            least.map(|run| [run.rms_error_rad, run.p95_error_rad])
        };
        let run = runs.get(at).filter(|run| run.corrected)?;
        let [plain_rms_rad, plain_p95_rad] = least(runs, false)?;
        let (rms_rad, p95_rad) = (run.rms_error_rad, run.p95_error_rad);
        Some(Self { rms_rad, p95_rad, plain_rms_rad, plain_p95_rad, before_rad: least(&runs[..at], true) })
    }

    /// Whether the correction left more than the plan as it is.
    pub fn is_worse(&self) -> bool {
        self.exceeds(MORE_ERROR, [self.plain_rms_rad, self.plain_p95_rad])
    }

    /// Whether it left more than a correction before it.
    pub fn is_worse_than_before(&self) -> bool {
        self.before_rad.is_some_and(|before_rad| self.exceeds([WORSE, WORSE_AGAIN], before_rad))
    }

    fn exceeds(&self, by: [f64; 2], [rms_rad, p95_rad]: [f64; 2]) -> bool {
        self.rms_rad > by[0] * rms_rad || self.p95_rad > by[1] * p95_rad
    }
}

impl History {
    /// Mean peak of each run that has one, rad, by its index.
    pub(super) fn peaks_rad(&self) -> Vec<(usize, f64)> {
        self.runs.iter().enumerate().filter_map(|(k, run)| Some((k, run.mean_peak_rad?))).collect()
    }

    /// The run with the least mean peak, rad, or of those that are nearly as good the one with the least error over the whole run; an
    /// earlier correction, too, that had clearly less of that than the later one had less at starts, and the plan as it is where a
    /// correction gained less than a tenth at starts and lost more elsewhere.
    /// Of what was sent again, the last time counts, and by what that grew all else that was sent before it would have grown.
    fn best(&self) -> Option<(usize, f64)> {
        let peaks_rad = self.peaks_rad();
        let again = |k: usize| peaks_rad.iter().rev().find(|(later, _)| *later > k && self.same(k, *later));
        let grown = peaks_rad.iter().filter_map(|(k, rad)| again(*k).map(|(later, now)| (*later, now / rad)));
        let grown: Vec<(usize, f64)> = grown.collect();
        let by =
            |k: usize| grown.iter().filter(|(later, _)| *later > k).fold(1.0, |most, (_, by)| by.max(most));
        let now = |of: fn(&PastRun) -> f64, k: usize| of(&self.runs[k]) * by(k);
        let peak = |k: usize| now(|run| run.mean_peak_rad.unwrap_or(f64::INFINITY), k);
        let left = peaks_rad.iter().rev().map(|(k, _)| *k);
        let left = left.filter(|k| again(*k).is_none());
        let left: Vec<usize> = left.collect();
        let left_of_corrections: Vec<usize> =
            left.iter().copied().filter(|k| self.runs[*k].corrected).collect();
        let least_rad = left.iter().map(|k| peak(*k)).reduce(f64::min)?;
        let lost = |k: &usize| Overall::of(&self.runs, *k).is_some_and(|overall| overall.is_worse());
        let rms = |k: usize| now(|run| run.rms_error_rad, k);
        let plain = |k: usize| !self.runs[k].corrected && WORTH * peak(k) <= least_rad;
        let near: Vec<usize> = left.iter().copied().filter(|k| peak(*k) <= NEARLY * least_rad).collect();
        let none_better = near.iter().all(lost);
        let best = left.into_iter().filter(|k| near.contains(k) || none_better && plain(*k));
        let best = best.min_by(|a, b| rms(*a).total_cmp(&rms(*b)))?;
        let made_up = left_of_corrections.into_iter().filter(|k| {
            let [peak, rms] = [peak(*k) / peak(best), rms(*k) / rms(best)];
            *k < best && peak <= MADE_UP && WORSE * peak * rms < 1.0
        });
        let best =
            made_up.min_by(|a, b| (peak(*a) * rms(*a)).total_cmp(&(peak(*b) * rms(*b)))).unwrap_or(best);
        Some((best, self.runs[best].mean_peak_rad?))
    }

    /// Each thing that was sent once, in the order in which that was first done, with the newest run of it: sent again it is no
    /// other correction.
    fn commands(&self) -> Vec<(usize, f64)> {
        let mut commands: Vec<(usize, f64)> = Vec::new();
        for (k, peak_rad) in self.peaks_rad().into_iter().filter(|(k, _)| !self.foreign.contains(k)) {
            match commands.iter_mut().find(|(other, _)| self.same(*other, k)) {
                Some(command) => *command = (k, peak_rad),
                None => commands.push((k, peak_rad)),
            }
        }
        commands
    }

    /// Corrections that were not worth it.
    fn failures(&self, commands: &[(usize, f64)]) -> usize {
        let failed = |k: &usize| {
            let (run, peak_rad) = commands[*k];
            let worth = best(&commands[..*k]).is_none_or(|best| peak_rad < WORTH * best.1);
            self.runs[run].corrected && !worth
        };
        (0..commands.len()).filter(failed).count()
    }

    /// Whether the last correction was worth it, whatever was sent again since; of a plan that was sent as it is again, whether the
    /// corrections before it were.
    pub(super) fn decision(&self) -> Decision {
        let Some((last, last_rad)) = self.peaks_rad().pop() else { return Decision::Send };
        if let Some(before_rad) = self.undone_rad.filter(|_| !self.follows) {
            let because = KeepReason::Undone { before_rad };
            return Decision::Keep { run: last, because, best_rad: last_rad, last_rad };
        }
        let commands = self.commands();
        let because = if self.runs[last].corrected {
            let newest = commands.split_last().filter(|(_, before)| before.len() > 1);
            let by = newest.and_then(|((newest, rad), before)| Some((*newest, rad / best(before)?.1)));
            let gained_little = by.is_some_and(|(newest, by)| {
                // Where the best came to as little as before since, a smaller step is worth a try.
                let passed = by > MORE && newest < last && self.failures(&commands) < SEVERAL;
                by >= WORTH && !passed
            });
            (gained_little && !self.follows).then_some(KeepReason::GainedLittle)
        } else {
            let corrections = self.failures(&commands);
            (corrections >= FAILURES).then_some(KeepReason::Failed { corrections })
        };
        let Some(because) = because else { return Decision::Send };
        // What is told is of the correction that was judged.
        let last_rad = match (because, commands.last()) {
            (KeepReason::GainedLittle, Some((_, rad))) => *rad,
            _ => last_rad,
        };
        let (run, best_rad) = self.best().unwrap_or((last, last_rad));
        Decision::Keep { run, because, best_rad, last_rad }
    }

    /// What to keep in place of a correction whose mean peak is expected to be clearly above that of the best run; of a machine that
    /// goes on changing above that of the newest.
    pub(super) fn better_than(&self, expected_rad: f64) -> Option<Decision> {
        let last = self.peaks_rad().pop()?;
        let ((run, best_rad), most) = if self.follows { (last, WORSE_AGAIN) } else { (self.best()?, WORSE) };
        let because = KeepReason::ExpectedWorse { expected_rad };
        let worse = expected_rad > most * best_rad;
        worse.then_some(Decision::Keep { run, because, best_rad, last_rad: last.1 })
    }

    /// What to keep where hardly less is expected of a command that was sent in the newest run already, or after several corrections
    /// that gained less than a tenth together.
    pub(super) fn settled(&self, command: &Series, expected_rad: f64) -> Option<Decision> {
        let peaks = self.peaks_rad();
        let (last, last_rad) = *peaks.last()?;
        let corrected = |(k, _): &&(usize, f64)| self.runs[*k].corrected;
        let newest = peaks.iter().rev().take_while(corrected).take(SEVERAL).count();
        let (before, after) = peaks.split_at(peaks.len() - newest);
        let least = |peaks: &[(usize, f64)]| best(peaks).map_or(f64::INFINITY, |best| best.1);
        let slow = newest == SEVERAL && least(after) >= WORTH * least(before);
        let little = expected_rad >= WORTH * last_rad && newest > 0 && !self.follows;
        let (run, best_rad) = if slow { self.best()? } else { (last, last_rad) };
        let because = KeepReason::Settled;
        (little && (slow || self.is_again(last, command))).then_some(Decision::Keep {
            run,
            because,
            best_rad,
            last_rad,
        })
    }
}

fn best(peaks: &[(usize, f64)]) -> Option<(usize, f64)> {
    peaks.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1))
}

#[cfg(test)]
mod tests {
    use super::{
        super::history::tests::{history, sent},
        *,
    };

    #[test]
    fn learning_goes_on_while_a_run_gains_a_tenth_and_then_the_best_is_kept() {
        assert_eq!(history(&[]).decision(), Decision::Send);
        assert_eq!(history(&[1.0]).decision(), Decision::Send);
        assert_eq!(history(&[1.0, 1.2]).decision(), Decision::Send);
        assert_eq!(history(&[1.0, 0.3, 0.2]).decision(), Decision::Send);
        let because = KeepReason::GainedLittle;
        let kept = |run, best_rad, last_rad| Decision::Keep { run, because, best_rad, last_rad };
        assert_eq!(history(&[1.0, 0.3, 0.28]).decision(), kept(2, 0.28, 0.28));
        assert_eq!(history(&[1.0, 0.3, 0.2, 0.4]).decision(), kept(2, 0.2, 0.4));
    }

    #[test]
    fn after_two_corrections_that_gained_nothing_the_plan_is_kept_however_often_it_is_run() {
        let mut history = history(&[4.19, 4.24, 4.25, 4.18]);
        history.runs[3].corrected = false;
        let because = KeepReason::Failed { corrections: 2 };
        let kept = Decision::Keep { run: 3, because, best_rad: 4.18, last_rad: 4.18 };
        assert_eq!(history.decision(), kept);
        history.runs.remove(2);
        assert_eq!(history.decision(), Decision::Send);
    }

    #[test]
    fn of_two_runs_that_are_as_good_the_one_that_is_better_overall_is_kept() {
        let mut history = history(&[2.9, 0.736, 0.746]);
        for (run, rms) in history.runs.iter_mut().zip([2.0, 0.48, 0.39]) {
            run.rms_error_rad = rms;
        }
        assert_eq!(history.decision(), kept(2, KeepReason::GainedLittle, 0.746, 0.746));
        history.runs[2].rms_error_rad = 2.1;
        let overall = Overall::of(&history.runs, 2).unwrap();
        assert!(overall.is_worse() && history.decision() == kept(1, KeepReason::GainedLittle, 0.736, 0.746));
        assert_eq!(Overall::of(&history.runs, 0), None);
    }

    #[test]
    fn a_correction_that_lost_more_over_the_whole_run_than_it_gained_at_starts_is_not_kept() {
        let mut history = history(&[2.9, 0.78, 0.72]);
        for (run, rms) in history.runs.iter_mut().zip([2.0, 0.4, 0.51]) {
            run.rms_error_rad = rms;
        }
        assert_eq!(history.decision(), kept(1, KeepReason::GainedLittle, 0.78, 0.72));
        let overall = Overall::of(&history.runs, 2).unwrap();
        assert!(overall.is_worse_than_before() && !overall.is_worse());
        history.runs[2].rms_error_rad = 0.42;
        assert_eq!(history.decision(), kept(2, KeepReason::GainedLittle, 0.72, 0.72));
    }

    fn kept(run: usize, because: KeepReason, best_rad: f64, last_rad: f64) -> Decision {
        Decision::Keep { run, because, best_rad, last_rad }
    }

    #[test]
    fn what_is_sent_again_is_no_other_correction() {
        let of = |by: &[f64], peaks: &[f64]| {
            let mut history = history(peaks);
            history.series = by.iter().map(|by| (sent(1.0 + by), sent(0.0))).collect();
            history.corrections_rad = by.to_vec();
            history.runs.iter_mut().zip(by).for_each(|(run, by)| run.corrected = *by > 0.0);
            history.decision()
        };
        assert_eq!(of(&[0.0, 0.1, 0.1], &[1.0, 0.5, 0.52]), Decision::Send, "half of a correction, twice");
        assert_eq!(of(&[0.0, 0.1, 0.2, 0.1], &[1.0, 0.5, 0.1, 0.5]), Decision::Send, "an older one again");
        let kept = kept(3, KeepReason::GainedLittle, 0.1, 0.1);
        assert_eq!(of(&[0.0, 0.1, 0.2, 0.25], &[1.0, 0.5, 0.1, 0.1]), kept);
    }

    #[test]
    fn the_plan_is_kept_where_corrections_gained_little_at_starts_and_lost_more_elsewhere() {
        let mut history = history(&[1.0, 0.95, 0.96]);
        history.runs[1..].iter_mut().for_each(|run| run.rms_error_rad = 0.6);
        assert_eq!(history.decision(), kept(0, KeepReason::GainedLittle, 1.0, 0.96));
        history.runs[1].rms_error_rad = 0.45;
        assert_eq!(history.decision(), kept(1, KeepReason::GainedLittle, 0.95, 0.96));
    }

    #[test]
    fn of_a_machine_that_goes_on_changing_the_newest_run_counts() {
        let mut history = history(&[4.2, 1.0, 1.2]);
        history.follows = true;
        assert_eq!(history.better_than(1.4), None);
        let because = KeepReason::ExpectedWorse { expected_rad: 1.6 };
        assert_eq!(history.better_than(1.6), Some(kept(2, because, 1.2, 1.2)));
    }

    #[test]
    fn what_was_sent_already_is_kept() {
        let mut history = history(&[1.0, 0.5]);
        history.plan = sent(1.0);
        history.series = [1.0, 1.1].map(|by| (sent(by), sent(0.0))).into();
        history.corrections_rad = vec![0.0, 0.1];
        let settled =
            |history: &History, by: f64, expected_rad: f64| history.settled(&sent(by), expected_rad);
        assert_eq!(settled(&history, 1.2, 0.49), None);
        assert_eq!(settled(&history, 1.102, 0.49), Some(kept(1, KeepReason::Settled, 0.5, 0.5)));
        assert_eq!(settled(&history, 1.102, 0.3), None, "it is expected to gain");
        history.follows = true;
        assert_eq!(settled(&history, 1.102, 0.49), None);
        // Small corrections are as different as large ones, by what they leave.
        history.follows = false;
        history.series = [1.0, 1.01].map(|by| (sent(by), sent(0.0))).into();
        (history.corrections_rad, history.runs[1].mean_peak_rad) = (vec![0.0, 0.01], Some(1e-3));
        assert_eq!(settled(&history, 1.0105, 1e-3), None);
    }

    #[test]
    fn after_three_corrections_that_gained_little_together_the_best_is_kept() {
        let mut history = history(&[1.0, 0.101, 0.096, 0.094, 0.093]);
        history.plan = sent(1.0);
        history.series = [1.0, 1.2, 1.21, 1.22, 1.23].map(|by| (sent(by), sent(0.0))).into();
        history.corrections_rad = vec![0.0, 0.2, 0.21, 0.22, 0.23];
        assert_eq!(history.settled(&sent(1.3), 0.09), Some(kept(4, KeepReason::Settled, 0.093, 0.093)));
        assert_eq!(history.settled(&sent(1.3), 0.05), None);
    }

    #[test]
    fn what_is_expected_to_be_worse_than_the_best_run_is_not_sent() {
        assert_eq!(history(&[]).better_than(9.0), None);
        assert_eq!(history(&[4.2, 4.3]).better_than(4.5), None);
        let because = KeepReason::ExpectedWorse { expected_rad: 6.0 };
        let kept = Decision::Keep { run: 0, because, best_rad: 4.2, last_rad: 4.3 };
        assert_eq!(history(&[4.2, 4.3]).better_than(6.0), Some(kept));
    }
}
