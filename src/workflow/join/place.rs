//! The plan to join, and where in a run it was sent.

use std::path::Path;

use super::JoinFailure;
use crate::{
    log::{LogError, ReadOptions, Selector, Topics, read_plan},
    remark::{Code, Remarks},
    series::{Located, Series, locate},
    workflow::{carried::Carried, fit::observe::on_origin},
};

/// What is left of a motion at most for a place to be its own, as a share.
const FITS: f64 = 0.1;
/// The same for what was sent to be what was made.
const SAME: f64 = 0.01;

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
        let paths = [path.to_owned()];
        let plan = read_plan(&paths, &ReadOptions::default())?;
        let topic = Selector { topic: Topics::default().command, field: None };
        let command = match read_plan(&paths, &ReadOptions { planned: vec![topic], ..ReadOptions::default() })
        {
            Ok(command) => Some(on_origin(&command, plan.source.epoch_ns)?),
            Err(LogError::NoTopic { .. }) => None,
            Err(error) => return Err(error.into()),
        };
        Ok(Self { command, carried: Carried::of(&plan).of_plan(), planned: plan.planned })
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
        let as_planned = locate(&self.planned, sent).map(|found| (false, found));
        let as_command = self.command.as_ref().and_then(|command| Some((true, locate(command, sent)?)));
        let both = as_command.into_iter().chain(as_planned);
        let best = both.min_by(|a, b| share(&a.1).total_cmp(&share(&b.1)));
        let nowhere = || JoinFailure::Nowhere { plan: path.to_owned(), topic: topic.to_owned() };
        let (commanded, found) = best.ok_or_else(nowhere)?;
        if share(&found) > FITS {
            let (plan, topic, at_s) = (path.to_owned(), topic.to_owned(), found.at_s + self.span_s()[0]);
            return Err(JoinFailure::SentOtherwise { plan, topic, at_s, share: share(&found) });
        }
        if !is_same(&found) {
            let message = format!(
                "what was sent on {topic} is not quite what {} holds: {:.1} % of the motion is left",
                path.display(),
                100.0 * share(&found)
            );
            remarks.add(Code::SentOtherwise, 1, message);
        }
        if !commanded && self.command.is_some() {
            let message =
                format!("what was sent on {topic} is the plan of {}, not its command", path.display());
            remarks.add(Code::SentOtherwise, 1, message);
        }
        let message = "other places fit as well, the first is taken; --at SECONDS names another";
        remarks.add(Code::Ambiguous, found.others as u64, message);
        Ok((commanded, found))
    }
}

/// Whether what was sent is what was made.
pub(super) fn is_same(found: &Located) -> bool {
    share(found) <= SAME
}

/// What is left of the motion, as a share.
fn share(found: &Located) -> f64 {
    found.rms_rad / found.spread_rad
}
