//! The runs of the plan that were made so far: what was sent, what came, and whether it is worth going on.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::{ReplanFailure, held::Held, peaks};
use crate::{
    fit::{AFTER_S, Trial},
    log::Recording,
    math::quantile,
    replay::Rules,
    series::{JointKind, Series, Track, bridged, moving_s},
    units::DEGREE_RAD,
    workflow::{
        carried::{Carried, Promise, rest::PLAN_LEAD_S},
        same_plan::{
            SAME_RAD, breaks_off_after_s, cut, cut_measured, found_at_s, of_same_rows, onto, within,
        },
    },
};

/// Commands that differ by less than these shares of their corrections, and of the mean peak that is left, are the same.
pub(super) const SAME: f64 = 0.05;
const SAME_OF_LEFT: f64 = 0.1;

/// A sample nearer to its plan, rad, lies on it.
const ON_PLAN_RAD: f64 = 1e-3 * DEGREE_RAD;

/// A machine that changed so often changes from run to run.
const OFTEN: usize = 2;

/// Runs after a change from which on it is known how the machine is now.
const KNOWN_AFTER: usize = 2;

/// Share of what the newest run was off by that a machine which goes on changing adds to the next.
const GOES_ON: f64 = 0.7;

/// A run whose mean peak is not below this share of the best before it was not worth its correction.
pub(super) const WORTH: f64 = 0.9;

/// A log that ends by more before the last motion of its plan does is cut off, s: what slowly comes to rest is seen to be there sooner.
const CUT_OFF_S: f64 = 0.3;

/// Share of the usual gain that is left however much a command broke its promise.
const LEAST_TRUST: f64 = 0.5;

/// One run of the plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PastRun {
    /// Its log.
    pub log: String,
    /// That as it was given; not written.
    #[serde(skip)]
    pub path: PathBuf,
    /// Whether something else than the plan was sent.
    pub corrected: bool,
    /// Mean peak error of its starts and reversals, rad; null without any. One that stands alone, in its joint and among the runs, counts
    /// as the next largest of its joint.
    pub mean_peak_rad: Option<f64>,
    /// The same with it as it came, as a report has it, rad; null where none stands alone.
    #[serde(default)]
    pub mean_peak_as_it_came_rad: Option<f64>,
    /// Root mean square error over all joints, the whole plan and what all logs have of four seconds after it, rad.
    #[serde(default)]
    pub rms_error_rad: f64,
    /// What the error of every joint is below for 95 % of it, rad.
    #[serde(default)]
    pub p95_error_rad: f64,
    /// How long its log goes on after the last motion of the plan while the arm is to stay there, s.
    #[serde(default)]
    pub after_s: f64,
    /// What was promised of it, as far as its log tells.
    pub promised: Option<Promise>,
}

/// Runs of one plan on its clock.
#[derive(Default)]
pub(super) struct History {
    pub(super) series: Vec<(Series, Series)>,
    pub(super) plan: Series,
    /// Places of their logs among all.
    pub(super) places: Vec<usize>,
    pub(super) runs: Vec<PastRun>,
    /// Logs of other plans, of which the machine is learnt alone.
    pub(super) others: Vec<String>,
    /// Logs that end before their plan does, and by how much, s: of their error nothing is learnt.
    pub(super) cut_off: Vec<(String, f64)>,
    /// How often runs were left out because the machine changed.
    pub(super) changes: usize,
    /// Whether the first of these runs is left because what was sent in it, as before, came to more.
    pub(super) drifts: bool,
    /// Whether it goes on changing one way: what was sent before the newest run is no guide.
    pub(super) follows: bool,
    /// Runs whose command was made for the machine as it was for a time: of a correction they say nothing.
    pub(super) foreign: Vec<usize>,
    /// Mean peak that the command of the newest run gave before, where that run undid all that it gained, rad.
    pub(super) undone_rad: Option<f64>,
    /// In whose unit means over the joints are told.
    pub(super) kind: JointKind,
    /// Largest difference of mean peaks by which that was told, rad.
    pub(super) unsteady_rad: f64,
    /// Largest correction of each run, rad.
    pub(super) corrections_rad: Vec<f64>,
}

impl History {
    /// Of the logs whose plan is `plan`, which lasts to `end_s`, in their order.
    pub(super) fn of(
        (names, paths): (&[String], &[PathBuf]),
        recordings: &[Recording],
        plan: &Series,
        rules: &Rules,
    ) -> Result<Self, ReplanFailure> {
        let mut history = Self { kind: plan.common_kind(), plan: plan.clone(), ..Self::default() };
        let end_s = plan.span_s().map_or(0.0, |[_, end_s]| end_s);
        let rest_s = moving_s(plan).map_or(0.0, |[_, moving_to_s]| end_s - moving_to_s);
        let mut after_s = AFTER_S;
        let mut held: Vec<Held> = Vec::new();
        let mut of_runs = Vec::new();
        for (place, (log, recording)) in names.iter().zip(recordings).enumerate() {
            let Some([from_s, _]) = moving_s(&recording.planned) else { continue };
            let Some(starts_s) = found_at_s(plan, &*bridged(&recording.planned)?, from_s - PLAN_LEAD_S)?
            else {
                if let Some(after_s) = breaks_off_after_s(plan, &recording.planned)? {
                    return Err(ReplanFailure::BreaksOff { log: log.clone(), after_s });
                }
                history.others.extend((!Carried::identifies(recording)).then(|| log.clone()));
                continue;
            };
            let motion_s = end_s - rest_s;
            let ends_s = [&recording.planned, &recording.measured]
                .map(|side| side.span_s().map_or(0.0, |span_s| span_s[1]));
            let seen_to_s = ends_s[0].min(ends_s[1]) - starts_s;
            if place + 1 < recordings.len() && seen_to_s < motion_s - CUT_OFF_S {
                history.cut_off.push((log.clone(), motion_s - seen_to_s));
                continue;
            }
            held.extend(Held::of(log, &recording.planned, plan, starts_s));
            let rests_s = rests_s(&recording.planned, plan, starts_s + end_s);
            let seen = recording.measured.tracks.iter().filter_map(|track| track.t_s().last());
            let seen_s = seen.map(|t_s| t_s - starts_s - end_s).fold(f64::INFINITY, f64::min);
            after_s = f64::min(after_s, rests_s.min(seen_s)).max(0.0);
            let ended_s = end_s + rests_s;
            let sent = recording.command.as_ref().map_or(&recording.planned, |command| &command.series);
            let [of_sent, of_measured] =
                [sent, &recording.measured].map(|series| of_same_rows(series, &recording.planned));
            let (mut sent, mut measured) = (
                cut(&*bridged(sent)?, starts_s, starts_s + end_s)?,
                cut_measured(&recording.measured, starts_s, starts_s + ended_s)?,
            );
            let own = cut(&*bridged(&recording.planned)?, starts_s, starts_s + end_s)?;
            if !within(&own, plan, SAME_RAD) {
                // Its stamps jitter: what its rows say of their own plan holds.
                let moved = |of_rows, series| if of_rows { onto(&series, &own, plan) } else { Ok(series) };
                (sent, measured) = (moved(of_sent, sent)?, moved(of_measured, measured)?);
            }
            // What was sent to a joint that has no command is not known: nothing is learnt of it, and nothing corrected.
            let unsent = plan.tracks.iter().filter(|track| sent.track(track.name()).is_none());
            let unsent: Vec<Track> = unsent.cloned().collect();
            sent.tracks.extend(unsent);
            let corrected = !within(&sent, plan, SAME_RAD);
            if !corrected
                && recording.command.as_ref().is_some_and(|command| {
                    lies_on(&command.series, &recording.planned, [starts_s, starts_s + end_s])
                })
            {
                sent = plan.clone();
            }
            history.runs.push(PastRun {
                log: log.clone(),
                path: paths[place].clone(),
                corrected,
                mean_peak_rad: None,
                mean_peak_as_it_came_rad: None,
                rms_error_rad: 0.0,
                p95_error_rad: 0.0,
                after_s: (rest_s + rests_s.min(seen_s)).max(0.0),
                promised: Carried::of(recording).promise(),
            });
            of_runs.push(peaks::Peaks::of(&peaks::of_plan(recording, [starts_s, starts_s + end_s], rules)));
            history.corrections_rad.push(farthest(&sent, plan));
            history.series.push((sent, measured));
            history.places.push(place);
        }
        if let Some((newest, others)) = held.split_last() {
            others.iter().try_for_each(|other| newest.check(other))?;
        }
        for (k, run) in history.runs.iter_mut().enumerate() {
            let others = of_runs.iter().enumerate().filter(|(other, _)| *other != k);
            run.mean_peak_rad = of_runs[k].usual_mean(&others.map(|(_, peaks)| peaks).collect::<Vec<_>>());
            let came_rad = of_runs[k].usual_mean(&[]);
            run.mean_peak_as_it_came_rad = came_rad.filter(|_| came_rad > run.mean_peak_rad);
        }
        // Only what all logs have can be compared.
        for (run, (_, measured)) in history.runs.iter_mut().zip(&mut history.series) {
            *measured = cut_measured(measured, 0.0, end_s + after_s)?;
            [run.rms_error_rad, run.p95_error_rad] = errors_rad(measured, plan);
        }
        Ok(history)
    }

    /// A mean over the joints in words; of joints that turn and joints that slide it has no unit.
    pub(super) fn says(&self, mean: f64) -> String {
        let mixed = self.plan.tracks.iter().any(|track| track.kind() != self.kind);
        if mixed { format!("{mean:.4} (rad, m)") } else { self.kind.says(mean) }
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

    /// Whether nothing but what was made for another machine was sent since that has changed.
    pub(super) fn anew(&self) -> bool {
        let same = (1..self.runs.len()).all(|k| self.same(0, k));
        self.changes > 0 && !self.runs.is_empty() && same && !self.drifts
    }

    /// What is to be expected beside all else of a machine that changed, rad: in the mean, where it did more than once, and
    /// what nine runs of ten stay below.
    pub(super) fn unsteady_rad(&self) -> [f64; 2] {
        if self.follows {
            // By as much again, less what is learnt of it.
            let now_rad = self.runs.last().and_then(|run| run.mean_peak_rad).unwrap_or(0.0);
            return [GOES_ON * now_rad, now_rad];
        }
        let again = self.changes >= OFTEN;
        // What was made and measured since it changed once tells what to expect.
        if !again && self.runs.len() > KNOWN_AFTER {
            return [0.0; 2];
        }
        [if again { 0.5 * self.unsteady_rad } else { 0.0 }, self.unsteady_rad]
    }

    /// Share of the usual gain, by what the newest command promised: less than one where more came than nine runs of ten
    /// should have, in the ratio of the two, and no less than a half.
    pub(super) fn trust(&self) -> f64 {
        let of = |run: &PastRun| Some(run.promised?.mean_peak_margin_rad / run.mean_peak_rad?);
        // Of a machine that goes on changing what is left is no want of trust.
        let first = self.follows || self.runs.len() == 1 && (self.changes > 0 || self.drifts);
        let ratio = self.runs.last().filter(|run| run.corrected && !first).and_then(of).unwrap_or(1.0);
        let most = if self.changes >= OFTEN { LEAST_TRUST } else { 1.0 };
        if ratio.is_finite() { ratio.clamp(LEAST_TRUST, most) } else { most }
    }

    /// Whether what was sent in two runs differs by less than so much anywhere, rad.
    pub(super) fn differ_by(&self, one: usize, other: usize, most_rad: f64) -> bool {
        let both = self.series.get(one).zip(self.series.get(other));
        both.is_some_and(|((a, _), (b, _))| within(a, b, most_rad))
    }

    /// Whether the same was sent in two runs, but for a share of what they corrected and left.
    pub(super) fn same(&self, one: usize, other: usize) -> bool {
        self.differ_by(
            one,
            other,
            self.alike_rad(one, self.corrected_rad(other))
                .min(self.alike_rad(other, self.corrected_rad(one))),
        )
    }

    /// The newest run in which a command was sent, but for a share of what it corrects.
    pub(super) fn sent_in(&self, command: &Series) -> Option<usize> {
        let corrects_rad = farthest(command, &self.plan);
        let same = |k: &usize| within(&self.series[*k].0, command, self.alike_rad(*k, corrects_rad));
        (0..self.series.len()).rev().find(same)
    }

    /// Whether a command is what was sent in a run, but for less than a share of what it corrects and left.
    pub(super) fn is_again(&self, run: usize, command: &Series) -> bool {
        let most_rad = self.shares_rad(run, farthest(command, &self.plan));
        self.series.get(run).is_some_and(|(sent, _)| within(sent, command, most_rad))
    }

    fn corrected_rad(&self, run: usize) -> f64 {
        self.corrections_rad.get(run).copied().unwrap_or(0.0)
    }

    /// What was sent in a run and a command that corrects by so much are alike if they differ by less than this, rad.
    fn alike_rad(&self, run: usize, corrects_rad: f64) -> f64 {
        SAME_RAD.max(self.shares_rad(run, corrects_rad))
    }

    fn shares_rad(&self, run: usize, corrects_rad: f64) -> f64 {
        let left_rad = self.runs.get(run).and_then(|run| run.mean_peak_rad).unwrap_or(f64::INFINITY);
        (SAME * corrects_rad.min(self.corrected_rad(run))).min(SAME_OF_LEFT * left_rad)
    }
}

/// Whether what was sent has its samples on its plan between two instants: what it differs by between them, its interpolation makes.
fn lies_on(sent: &Series, planned: &Series, [from_s, to_s]: [f64; 2]) -> bool {
    planned.tracks.iter().all(|planned| {
        let samples = sent.track(planned.name()).map(|sent| sent.t_s().iter().zip(sent.position()));
        let within = |(t_s, _): &(&f64, &f64)| (from_s..=to_s).contains(*t_s);
        let on =
            |(t_s, position): (&f64, &f64)| (planned.held_at(*t_s).position - position).abs() < ON_PLAN_RAD;
        samples.is_none_or(|samples| samples.filter(within).all(on))
    })
}

/// Largest distance of what was sent from the plan, rad.
fn farthest(sent: &Series, plan: &Series) -> f64 {
    let of = |track: &Track| Some(apart_rad(track, plan.track(track.name())?));
    sent.tracks.iter().filter_map(of).fold(0.0, f64::max)
}

/// The same of a joint.
pub(super) fn apart_rad(sent: &Track, plan: &Track) -> f64 {
    let apart = |(t_s, position): (&f64, &f64)| (plan.held_at(*t_s).position - position).abs();
    sent.t_s().iter().zip(sent.position()).map(apart).fold(0.0, f64::max)
}

/// How long a log holds the end of a plan after an instant, [`AFTER_S`] at most, s: then the arm may do something else.
fn rests_s(planned: &Series, plan: &Series, ended_s: f64) -> f64 {
    const STEP_S: f64 = 0.1;
    let holds = |after_s: &f64| {
        plan.tracks.iter().all(|track| {
            let end = track.position().last().copied().unwrap_or_default();
            let own = planned.track(track.name());
            let at = own.and_then(|own| own.at(ended_s + after_s));
            at.is_some_and(|state| (state.position - end).abs() < SAME_RAD)
        })
    };
    let steps = (0_u32..).map(|k| STEP_S * f64::from(k));
    steps.take_while(|after_s| *after_s <= AFTER_S && holds(after_s)).last().unwrap_or(0.0)
}

/// Root mean square over all joints of what a plan and what was measured of it differ by, and what that of every joint is below for
/// 95 % of the time, rad; zero of nothing.
fn errors_rad(measured: &Series, plan: &Series) -> [f64; 2] {
    let (mut squares, mut p95_rad) = (Vec::new(), 0.0_f64);
    for track in &measured.tracks {
        let Some(planned) = plan.track(track.name()) else { continue };
        let own = track.t_s().iter().zip(track.position());
        let errors: Vec<f64> = own.map(|(t_s, q)| (q - planned.held_at(*t_s).position).abs()).collect();
        squares.push(errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64);
        p95_rad = p95_rad.max(quantile(errors, 0.95));
    }
    [(squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt(), p95_rad]
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A joint that goes on at a speed for a second.
    pub(in crate::workflow::replan) fn sent(by: f64) -> Series {
        Series::sampled("J", 100, |t| by * t)
    }

    pub(in crate::workflow::replan) fn history(peaks: &[f64]) -> History {
        let run = |(k, peak): (usize, &f64)| PastRun {
            log: format!("run-{k}"),
            path: PathBuf::new(),
            corrected: k > 0,
            mean_peak_rad: Some(*peak),
            mean_peak_as_it_came_rad: None,
            rms_error_rad: 0.5 * peak,
            p95_error_rad: *peak,
            after_s: AFTER_S,
            promised: None,
        };
        let runs = peaks.iter().enumerate().map(run).collect();
        History { runs, ..History::default() }
    }

    #[test]
    fn a_broken_promise_lowers_the_gain_and_a_kept_one_does_not() {
        let trust = |promised: Option<f64>, came: f64, corrected: bool| {
            let promised = promised.map(|margin| Promise::new([0.5 * margin, margin], None));
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
}
