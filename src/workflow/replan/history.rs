//! The runs of the plan that were made so far: what was sent, what came, and whether it is worth going on.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::{
    ReplanFailure,
    samples::{cut, cut_measured, found_at_s, within},
};
use crate::{
    fit::Trial,
    log::Recording,
    replay::{Rules, replay},
    series::{Series, Track, align, bridged, moving_s},
    workflow::carried::{Carried, Promise, rest::PLAN_LEAD_S},
};

/// A correction below this is none, rad.
pub(super) const NONE_RAD: f64 = 1e-3;

/// Commands that differ by less than this share of their corrections are the same.
const SAME: f64 = 0.05;

/// A run whose mean peak is not below this share of the best before it was not worth its correction.
const WORTH: f64 = 0.9;

/// A correction that is expected to come above the best run by this factor is not worth sending.
const WORSE: f64 = 1.1;

/// So many corrections that gained nothing are enough.
const FAILURES: usize = 2;

/// A machine that changed so often changes from run to run.
const OFTEN: usize = 2;

/// Share of the usual gain that is left however much a command broke its promise.
const LEAST_TRUST: f64 = 0.5;

/// One run of the plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PastRun {
    /// Its log.
    pub log: String,
    /// Whether something else than the plan was sent.
    pub corrected: bool,
    /// Mean peak error of its starts and reversals, rad; null without any.
    pub mean_peak_rad: Option<f64>,
    /// What was promised of it, as far as its log tells.
    pub promised: Option<Promise>,
}

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
    /// The next correction is expected to do worse.
    ExpectedWorse {
        /// Its mean peak, rad.
        expected_rad: f64,
    },
}

/// Runs of one plan on its clock.
#[derive(Default)]
pub(super) struct History {
    pub(super) series: Vec<(Series, Series)>,
    /// Places of their logs among all.
    pub(super) places: Vec<usize>,
    pub(super) runs: Vec<PastRun>,
    /// How often runs were left out because the machine changed.
    pub(super) changes: usize,
    /// Largest difference of mean peaks by which that was told, rad.
    pub(super) unsteady_rad: f64,
    /// Largest correction of each run, rad.
    pub(super) corrections_rad: Vec<f64>,
}

impl History {
    /// Of the logs whose plan is `plan`, which lasts to `end_s`, in their order.
    pub(super) fn of(
        paths: &[PathBuf],
        recordings: &[Recording],
        plan: &Series,
        rules: &Rules,
    ) -> Result<Self, ReplanFailure> {
        let mut history = Self::default();
        let end_s = plan.span_s().map_or(0.0, |[_, end_s]| end_s);
        for (place, (path, recording)) in paths.iter().zip(recordings).enumerate() {
            let Some([from_s, _]) = moving_s(&recording.planned) else { continue };
            let Some(starts_s) = found_at_s(plan, &*bridged(&recording.planned)?, from_s - PLAN_LEAD_S)?
            else {
                continue;
            };
            let sent = recording.command.as_ref().map_or(&recording.planned, |command| &command.series);
            let (sent, measured) = (
                cut(&*bridged(sent)?, starts_s, starts_s + end_s)?,
                cut_measured(&recording.measured, starts_s, starts_s + end_s)?,
            );
            let pairs: Vec<_> = (recording.measured.tracks.iter())
                .filter_map(|track| align(recording.planned.track(track.name())?, track))
                .collect();
            let found = replay(&pairs, rules);
            let count = found.turning_peaks_rad().count() as f64;
            let sum: f64 = found.turning_peaks_rad().sum();
            history.runs.push(PastRun {
                log: path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned(),
                corrected: !within(&sent, plan, NONE_RAD),
                mean_peak_rad: (count > 0.0).then(|| sum / count),
                promised: Carried::of(recording).promise(),
            });
            history.corrections_rad.push(farthest(&sent, plan));
            history.series.push((sent, measured));
            history.places.push(place);
        }
        Ok(history)
    }

    /// As the learning takes them.
    pub(super) fn trials(&self) -> Vec<Trial<'_>> {
        self.series.iter().map(|(sent, measured)| Trial { sent, measured }).collect()
    }

    /// What was sent and what came of it in the newest run.
    pub(super) fn newest(&self) -> Option<(&Series, &Series)> {
        self.series.last().map(|(sent, measured)| (sent, measured))
    }

    /// Whether any run was corrected: learning has begun.
    pub(super) fn begun(&self) -> bool {
        self.runs.iter().any(|run| run.corrected)
    }

    /// Whether the only run is the first of a machine that has changed: what was sent in it was made for another one.
    pub(super) fn anew(&self) -> bool {
        self.changes > 0 && self.runs.len() == 1
    }

    /// What is to be expected beside all else of a machine that changed, rad: in the mean, where it did more than once, and
    /// what nine runs of ten stay below.
    pub(super) fn unsteady_rad(&self) -> [f64; 2] {
        let again = self.changes >= OFTEN;
        [if again { 0.5 * self.unsteady_rad } else { 0.0 }, self.unsteady_rad]
    }

    /// Share of the usual gain, by what the newest command promised: less than one where more came than nine runs of ten
    /// should have, in the ratio of the two, and no less than a half.
    pub(super) fn trust(&self) -> f64 {
        let of = |run: &PastRun| Some(run.promised?.mean_peak_margin_rad / run.mean_peak_rad?);
        let ratio = self.runs.last().filter(|run| run.corrected && !self.anew()).and_then(of).unwrap_or(1.0);
        let most = if self.changes >= OFTEN { LEAST_TRUST } else { 1.0 };
        if ratio.is_finite() { ratio.clamp(LEAST_TRUST, most) } else { most }
    }

    /// Mean peak of each run that has one, rad, by its index.
    pub(super) fn peaks_rad(&self) -> Vec<(usize, f64)> {
        self.runs.iter().enumerate().filter_map(|(k, run)| Some((k, run.mean_peak_rad?))).collect()
    }

    /// The run with the least mean peak, rad; of what was sent again, the last time counts.
    fn best(&self) -> Option<(usize, f64)> {
        let again = |k: usize| (k + 1..self.runs.len()).any(|later| self.same(k, later));
        best(&self.peaks_rad().into_iter().filter(|(k, _)| !again(*k)).collect::<Vec<_>>())
    }

    /// Whether the same was sent in two runs, but for a share of what they corrected.
    pub(super) fn same(&self, one: usize, other: usize) -> bool {
        let corrected = |k: usize| self.corrections_rad.get(k).copied().unwrap_or(0.0);
        let most_rad = NONE_RAD.max(SAME * corrected(one).min(corrected(other)));
        let both = self.series.get(one).zip(self.series.get(other));
        both.is_some_and(|((a, _), (b, _))| within(a, b, most_rad))
    }

    /// Corrections that were not worth it.
    fn failures(&self, peaks_rad: &[(usize, f64)]) -> usize {
        let failed = |k: &usize| {
            let (run, peak_rad) = peaks_rad[*k];
            let worth = best(&peaks_rad[..*k]).is_none_or(|best| peak_rad < WORTH * best.1);
            self.runs[run].corrected && !worth
        };
        (0..peaks_rad.len()).filter(failed).count()
    }

    /// Whether the last correction was worth it; of a plan that was sent as it is again, whether those before it were.
    pub(super) fn decision(&self) -> Decision {
        let peaks = self.peaks_rad();
        let Some(((last, last_rad), before)) = peaks.split_last() else { return Decision::Send };
        let Some(best_before) = best(before).filter(|_| before.len() > 1) else { return Decision::Send };
        let because = if self.runs[*last].corrected {
            (*last_rad >= WORTH * best_before.1).then_some(KeepReason::GainedLittle)
        } else {
            let corrections = self.failures(before);
            (corrections >= FAILURES).then_some(KeepReason::Failed { corrections })
        };
        let Some(because) = because else { return Decision::Send };
        let (run, best_rad) = self.best().unwrap_or((*last, *last_rad));
        Decision::Keep { run, because, best_rad, last_rad: *last_rad }
    }

    /// What to keep in place of a correction whose mean peak is expected to be clearly above that of the best run.
    pub(super) fn better_than(&self, expected_rad: f64) -> Option<Decision> {
        let peaks = self.peaks_rad();
        let (last, (run, best_rad)) = (peaks.last()?, self.best()?);
        let because = KeepReason::ExpectedWorse { expected_rad };
        (expected_rad > WORSE * best_rad).then_some(Decision::Keep {
            run,
            because,
            best_rad,
            last_rad: last.1,
        })
    }
}

/// Largest distance of what was sent from the plan, rad.
fn farthest(sent: &Series, plan: &Series) -> f64 {
    let of = |track: &Track| {
        let planned = plan.track(track.name())?;
        let apart = track
            .t_s()
            .iter()
            .zip(track.position())
            .map(|(t_s, q)| (q - planned.held_at(*t_s).position).abs());
        Some(apart.fold(0.0, f64::max))
    };
    sent.tracks.iter().filter_map(of).fold(0.0, f64::max)
}

fn best(peaks: &[(usize, f64)]) -> Option<(usize, f64)> {
    peaks.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(in crate::workflow::replan) fn history(peaks: &[f64]) -> History {
        let run = |(k, peak): (usize, &f64)| PastRun {
            log: format!("run-{k}"),
            corrected: k > 0,
            mean_peak_rad: Some(*peak),
            promised: None,
        };
        let runs = peaks.iter().enumerate().map(run).collect();
        History { runs, ..History::default() }
    }

    #[test]
    fn a_broken_promise_lowers_the_gain_and_a_kept_one_does_not() {
        let trust = |promised: Option<f64>, came: f64, corrected: bool| {
            let promised =
                promised.map(|margin| Promise { mean_peak_rad: 0.5 * margin, mean_peak_margin_rad: margin });
            let mut history = history(&[came]);
            history.runs[0].promised = promised;
            history.runs[0].corrected = corrected;
            history.trust()
        };
        for (promised, came, corrected, expected) in [
            (Some(0.2), 0.1, true, 1.0),
            (Some(0.2), 0.2, true, 1.0),
            (Some(0.2), 0.25, true, 0.8),
            (Some(0.2), 5.0, true, 0.5),
            (Some(0.2), 5.0, false, 1.0),
            (None, 5.0, true, 1.0),
        ] {
            assert!((trust(promised, came, corrected) - expected).abs() < 1e-12, "{promised:?} {came}");
        }
    }

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
    fn what_is_expected_to_be_worse_than_the_best_run_is_not_sent() {
        assert_eq!(history(&[]).better_than(9.0), None);
        assert_eq!(history(&[4.2, 4.3]).better_than(4.5), None);
        let because = KeepReason::ExpectedWorse { expected_rad: 6.0 };
        let kept = Decision::Keep { run: 0, because, best_rad: 4.2, last_rad: 4.3 };
        assert_eq!(history(&[4.2, 4.3]).better_than(6.0), Some(kept));
    }
}
