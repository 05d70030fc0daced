//! The plan to join, and where in a run it was sent.

use std::path::Path;

use super::{JoinFailure, gain::other_share};
use crate::{
    log::{ReadOptions, SignalRole, WantedSignal, read_plan},
    remark::{Code, Remarks},
    series::{Located, Series, Track, left_at, locate, moving_s},
    workflow::carried::Carried,
};

/// Largest difference, as a share of the motion, at which a place is taken to be that of the plan.
const FITS: f64 = 0.1;
/// The same at a time that the caller gives, who may know of clocks that run apart.
const ELSEWHERE: f64 = 0.3;
/// What leaves less than this share of what the command leaves was the plan.
const CLEARLY: f64 = 0.5;
/// Largest difference, as a share, at which the sent signal is taken to be the planned one.
const SAME: f64 = 0.01;

/// A recording that lacks less of a motion lacks a sample or two, s.
const LACKS_S: f64 = 0.1;

/// A plan and its command, on the plan's clock.
pub(super) struct Plan {
    pub(super) planned: Series,
    /// Where it is not the plan.
    pub(super) command: Option<Series>,
    /// Task, plan and provenance.
    pub(super) carried: Carried,
}

impl Plan {
    pub(super) fn read(path: &Path) -> Result<Self, JoinFailure> {
        let signals = vec![WantedSignal::usual(SignalRole::Command)];
        let plan = read_plan(&[path.to_owned()], &ReadOptions { signals, ..ReadOptions::default() })?;
        let carried = Carried::of(&plan).of_plan();
        let command = plan.command.map(|command| command.series);
        Ok(Self { command, carried, planned: plan.planned })
    }

    /// First and last sample, s.
    pub(super) fn span_s(&self) -> [f64; 2] {
        self.planned.span_s().unwrap_or_default()
    }

    /// Where it was sent, and whether the command was sent and not the plan itself.
    pub(super) fn place(
        &self,
        sent: &Series,
        path: &Path,
        topic: &str,
        remarks: &mut Remarks,
    ) -> Result<(bool, Located), JoinFailure> {
        let other_kind =
            |track: &&Track| sent.track(track.name()).is_some_and(|own| own.kind() != track.kind());
        if let Some(track) = self.planned.tracks.iter().find(other_kind) {
            return Err(JoinFailure::OtherKind { plan: path.to_owned(), joint: track.name().to_owned() });
        }
        let as_planned = locate(&self.planned, sent).map(|found| (false, found));
        let as_command = self.command.as_ref().and_then(|command| Some((true, locate(command, sent)?)));
        // What neither is told quite, as after a hold, was the command: a plan is made for it.
        let best = match (as_command, as_planned) {
            (Some(command), Some(plan)) if share(&plan.1) < CLEARLY * share(&command.1) => Some(plan),
            (command, plan) => command.or(plan),
        };
        let nowhere = || JoinFailure::Nowhere { plan: path.to_owned(), topic: topic.to_owned() };
        let (commanded, found) = best.ok_or_else(nowhere)?;
        if share(&found) > FITS {
            return Err(self.sent_otherwise(&found, path, topic));
        }
        if found.is_apart_by_most() {
            let longer = found.pace.is_some_and(|pace| pace > 1.0);
            return Err(JoinFailure::OtherPace { plan: path.to_owned(), topic: topic.to_owned(), longer });
        }
        self.check_share(sent, found.at_s, path, topic)?;
        if let Some(doubt) = doubt(&found, path, topic) {
            remarks.add(Code::SentOtherwise, 1, doubt);
        }
        if !commanded && self.command.is_some() {
            remarks.add(Code::SentOtherwise, 1, the_plan(path, topic));
        }
        if found.covered < 1.0 {
            let doubt = format!(
                "what was sent on {topic} has {:.0} % of the plan: the run was stopped, or its recording began late",
                100.0 * found.covered
            );
            remarks.add(Code::Unmatched, 1, doubt);
        } else if let Some(doubt) = self.cut(sent, found.at_s, topic) {
            remarks.add(Code::Unmatched, 1, doubt);
        }
        let message = "other places fit as well, the first is taken; --at SECONDS names another";
        remarks.add(Code::Ambiguous, found.others as u64, message);
        Ok((commanded, found))
    }

    /// That the recording lacks the beginning or the end of the plan's motion, whose start is then nowhere.
    fn cut(&self, sent: &Series, at_s: f64, topic: &str) -> Option<String> {
        let [first_s, last_s] = moving_s(&self.planned)?.map(|t_s| t_s + at_s);
        let [from_s, to_s] = sent.span_s()?;
        let lacks = |s: f64, end: &str| {
            format!(
                "{topic} lacks {s:.2} s of the plan's motion at its {end}: what starts there is not judged"
            )
        };
        if from_s - first_s > LACKS_S {
            return Some(lacks(from_s - first_s, "beginning"));
        }
        (last_s - to_s > LACKS_S).then(|| lacks(last_s - to_s, "end"))
    }

    /// Whether what was sent beside the plan is the command that was made for it.
    pub(super) fn check_command(&self, sent: &Series, path: &Path, topic: &str) -> Result<(), JoinFailure> {
        let Some(found) = self.command.as_ref().and_then(|command| locate(command, sent)) else {
            return Ok(());
        };
        if share(&found) <= FITS {
            return self.check_share(sent, found.at_s, path, topic);
        }
        Err(self.sent_otherwise(&found, path, topic))
    }

    fn sent_otherwise(&self, found: &Located, path: &Path, topic: &str) -> JoinFailure {
        let (plan, topic, at_s) = (path.to_owned(), topic.to_owned(), found.at_s + self.span_s()[0]);
        JoinFailure::SentOtherwise { plan, topic, at_s, share: share(found) }
    }

    /// Whether the command was sent, at a time that the caller gives for the plan's own 0; with what is to be doubted about that.
    pub(super) fn commanded_at(
        &self,
        sent: Option<&Series>,
        at_s: f64,
        path: &Path,
        topic: &str,
        remarks: &mut Remarks,
    ) -> Result<bool, JoinFailure> {
        let Some(sent) = sent else { return Ok(self.command.is_some()) };
        self.check_share(sent, at_s, path, topic)?;
        if let Some(doubt) = self.doubt_at(sent, at_s, path, topic) {
            remarks.add(Code::SentOtherwise, 1, doubt);
        }
        Ok(self.command.is_some() && !self.is_sent_itself(sent, at_s))
    }

    /// Whether what was sent then is the plan, and not the command that was made for it.
    fn is_sent_itself(&self, sent: &Series, at_s: f64) -> bool {
        let command = self.command.as_ref().and_then(|command| left_at(command, sent, at_s));
        left_at(&self.planned, sent, at_s)
            .zip(command)
            .is_some_and(|(plan, command)| plan < CLEARLY * command)
    }

    /// What is to be said of a time that the caller gives: something else was sent then, or the plan itself.
    fn doubt_at(&self, sent: &Series, at_s: f64, path: &Path, topic: &str) -> Option<String> {
        let of = |motion: &Series| left_at(motion, sent, at_s);
        let sides = [Some(&self.planned), self.command.as_ref()];
        let left = sides.into_iter().flatten().filter_map(of).reduce(f64::min)?;
        if left <= ELSEWHERE {
            return self.is_sent_itself(sent, at_s).then(|| the_plan(path, topic));
        }
        let left = if left.is_finite() {
            format!("leaves {:.0} % of its motion", 100.0 * left)
        } else {
            "is not in the log for all of it".to_owned()
        };
        Some(format!(
            "what was sent on {topic} is not the plan at the time that --at gives: it {left}; without --at the time is found"
        ))
    }

    /// Whether what was sent, with the time 0 of the plan at `at_s`, is no other command of the same plan.
    fn check_share(&self, sent: &Series, at_s: f64, path: &Path, topic: &str) -> Result<(), JoinFailure> {
        let found = self.command.as_ref().and_then(|own| other_share(&self.planned, own, sent, at_s));
        found.map_or(Ok(()), |share| {
            Err(JoinFailure::OtherShare { plan: path.to_owned(), topic: topic.to_owned(), share })
        })
    }
}

fn the_plan(path: &Path, topic: &str) -> String {
    format!("what was sent on {topic} is the plan of {}, not its command", path.display())
}

/// Why what was sent may not be what the plan's file holds.
fn doubt(found: &Located, path: &Path, topic: &str) -> Option<String> {
    let plan = path.display();
    let Some(pace) = found.pace else {
        let left = 100.0 * share(found);
        let doubt = format!(
            "what was sent on {topic} is not quite what {plan} holds: {left:.1} % of the motion is left; where it \
             was held or changed on the way its time is that of the whole, and --at SECONDS gives another"
        );
        return (!is_same(found)).then_some(doubt);
    };
    let [lasts, runs] = if pace > 1.0 { ["longer", "faster"] } else { ["shorter", "slower"] };
    Some(format!(
        "what was sent on {topic} lasts {:.2} % {lasts} than in {plan}: the recorder's clock runs {runs} than the sender's, or an \
         override was set. Where it is the clock, multiply the times of the recording by {:.5} before it is imported: its errors \
         grow with what the two are apart",
        100.0 * (pace - 1.0).abs(),
        1.0 / pace
    ))
}

/// Whether the sent signal is the planned one, at its own times.
pub(super) fn is_same(found: &Located) -> bool {
    share(found) <= SAME && found.pace.is_none()
}

/// Difference as a share of the motion.
fn share(found: &Located) -> f64 {
    found.rms_rad / found.spread_rad
}
