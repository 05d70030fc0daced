//! The runs of the plan that were made so far: what was sent, what came, and whether it is worth going on.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::{ReplanFailure, last::moving_s, samples::cut};
use crate::{
    fit::Trial,
    log::Recording,
    replay::{Rules, replay},
    series::{Series, align},
    workflow::carried::{Carried, Promise, rest::PLAN_LEAD_S},
};

/// Plans whose angles differ by less are the same, rad.
const SAME_RAD: f64 = 1e-3;

/// Rounds that bring a plan onto the clock of another, and the longest step of one, s.
const ROUNDS: usize = 3;
const MOST_AHEAD_S: f64 = 0.5;

/// A correction below this is none, rad.
const NONE_RAD: f64 = 1e-3;

/// A run whose mean peak is not below this share of the best before it was not worth its correction.
const WORTH: f64 = 0.9;

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
    /// Keep the command of a run (by index): the last correction gained too little.
    Keep {
        /// The run.
        run: usize,
        /// Its mean peak, rad.
        best_rad: f64,
        /// Mean peak of the last run, rad.
        last_rad: f64,
    },
}

/// Runs of one plan on its clock.
pub(super) struct History {
    series: Vec<(Series, Series)>,
    pub(super) runs: Vec<PastRun>,
}

impl History {
    /// Of the logs whose plan is `plan`, which lasts to `end_s`, in their order.
    pub(super) fn of(
        paths: &[PathBuf],
        recordings: &[Recording],
        plan: &Series,
        rules: &Rules,
    ) -> Result<Self, ReplanFailure> {
        let mut history = Self { series: Vec::new(), runs: Vec::new() };
        let end_s = plan.span_s().map_or(0.0, |[_, end_s]| end_s);
        for (path, recording) in paths.iter().zip(recordings) {
            let Some([from_s, _]) = moving_s(&recording.planned) else { continue };
            let mut starts_s = from_s - PLAN_LEAD_S;
            let mut planned = cut(&recording.planned, starts_s, starts_s + end_s)?;
            // The first moving sample tells the start to a sample; the whole plan tells it better.
            for _ in 0..ROUNDS {
                starts_s -= ahead_s(&planned, plan);
                planned = cut(&recording.planned, starts_s, starts_s + end_s)?;
            }
            let on_clock = |series: &Series| cut(series, starts_s, starts_s + end_s);
            if !same(&planned, plan) {
                continue;
            }
            let sent = recording.command.as_ref().map_or(&recording.planned, |command| &command.series);
            let (sent, measured) = (on_clock(sent)?, on_clock(&recording.measured)?);
            let pairs: Vec<_> = (recording.measured.tracks.iter())
                .filter_map(|track| align(recording.planned.track(track.name())?, track))
                .collect();
            let found = replay(&pairs, rules);
            let count = found.transitions.len() as f64;
            let sum: f64 = found.transitions.iter().map(|t| t.peak_error).sum();
            history.runs.push(PastRun {
                log: path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned(),
                corrected: !within(&sent, plan, NONE_RAD),
                mean_peak_rad: (count > 0.0).then(|| sum / count),
                promised: Carried::of(recording).promise(),
            });
            history.series.push((sent, measured));
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

    /// Whether the last correction was worth it.
    pub(super) fn decision(&self) -> Decision {
        let peaks: Vec<(usize, f64)> =
            self.runs.iter().enumerate().filter_map(|(k, run)| Some((k, run.mean_peak_rad?))).collect();
        let Some(((last, last_rad), before)) = peaks.split_last() else { return Decision::Send };
        let best_before = before.iter().min_by(|a, b| a.1.total_cmp(&b.1));
        let Some(best_before) = best_before.filter(|_| self.runs[*last].corrected && before.len() > 1) else {
            return Decision::Send;
        };
        if *last_rad < WORTH * best_before.1 {
            return Decision::Send;
        }
        let (run, best_rad) = if *last_rad < best_before.1 { (*last, *last_rad) } else { *best_before };
        Decision::Keep { run, best_rad, last_rad: *last_rad }
    }
}

/// How far a plan is ahead of another of equal samples, s: the shift of least squares, at most [`MOST_AHEAD_S`].
fn ahead_s(planned: &Series, plan: &Series) -> f64 {
    let (mut along, mut square) = (0.0, 0.0);
    for track in &plan.tracks {
        let Some(other) = planned.track(track.name()) else { continue };
        let steps = track.t_s().windows(2).zip(track.position().windows(2));
        for ((t_s, position), other) in steps.zip(other.position()) {
            let speed = (position[1] - position[0]) / (t_s[1] - t_s[0]);
            along += speed * (other - position[0]);
            square += speed * speed;
        }
    }
    if square > 0.0 { (along / square).clamp(-MOST_AHEAD_S, MOST_AHEAD_S) } else { 0.0 }
}

fn same(planned: &Series, plan: &Series) -> bool {
    planned.tracks.len() == plan.tracks.len() && within(planned, plan, SAME_RAD)
}

fn within(series: &Series, plan: &Series, most_rad: f64) -> bool {
    plan.tracks.iter().all(|plan| {
        series.track(plan.name()).is_some_and(|track| {
            let pairs = track.position().iter().zip(plan.position());
            track.len() == plan.len() && pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < most_rad
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn history(peaks: &[f64]) -> History {
        let run = |(k, peak): (usize, &f64)| PastRun {
            log: format!("run-{k}"),
            corrected: k > 0,
            mean_peak_rad: Some(*peak),
            promised: None,
        };
        History { series: Vec::new(), runs: peaks.iter().enumerate().map(run).collect() }
    }

    #[test]
    fn a_plan_recorded_between_the_samples_is_brought_onto_the_clock() {
        use crate::series::Track;
        let wave = |shift_s: f64| {
            let t_s: Vec<f64> = (0..2000).map(|k| f64::from(k) * 0.01).collect();
            let position = t_s.iter().map(|t| 0.3 * (0.4 * (t + shift_s)).sin()).collect();
            Series { tracks: vec![Track::new("J", t_s, position, &[]).unwrap()] }
        };
        for shift_s in [-0.2, -0.004, 0.0, 0.0071, 0.15] {
            let found = ahead_s(&wave(shift_s), &wave(0.0));
            assert!((found - shift_s).abs() < 0.01 * shift_s.abs() + 1e-4, "{shift_s} {found}");
        }
    }

    #[test]
    fn learning_goes_on_while_a_run_gains_a_tenth_and_then_the_best_is_kept() {
        assert_eq!(history(&[]).decision(), Decision::Send);
        assert_eq!(history(&[1.0]).decision(), Decision::Send);
        assert_eq!(history(&[1.0, 1.2]).decision(), Decision::Send);
        assert_eq!(history(&[1.0, 0.3, 0.2]).decision(), Decision::Send);
        let kept = |run, best_rad, last_rad| Decision::Keep { run, best_rad, last_rad };
        assert_eq!(history(&[1.0, 0.3, 0.28]).decision(), kept(2, 0.28, 0.28));
        assert_eq!(history(&[1.0, 0.3, 0.2, 0.4]).decision(), kept(2, 0.2, 0.4));
    }
}
