//! What is said of a machine that changed between runs.

use std::collections::BTreeSet;

use super::{
    changed::Sign,
    history::{History, PastRun},
};
use crate::{
    remark::{Code, Remarks},
    series::Track,
};

impl History {
    /// What is to be said of a machine that changed, and of one that goes on to.
    pub(super) fn remark_changes(&self, changed: Option<String>, remarks: &mut Remarks) {
        let again = (changed.is_some() && self.changes > 1).then(|| {
            let message = format!(
                "the machine changed {} times between these runs, by up to {} of mean peak error: it may again, so half of \
                 the usual step is taken, and more error is expected",
                self.changes,
                self.says(self.unsteady_rad)
            );
            (self.changes, message)
        });
        for (count, message) in changed.map(|message| (1, message)).into_iter().chain(again) {
            remarks.add(Code::MachineChanged, count as u64, message);
        }
    }

    pub(super) fn said_of_return(&self, run: usize, passed: &BTreeSet<usize>) -> String {
        let logs: Vec<&str> = passed.iter().map(|k| self.runs[*k].log.as_str()).collect();
        format!(
            "the machine had changed for a time and moves in {} as before: what came meanwhile, in {}, is left out",
            self.runs[run].log,
            logs.join(", ")
        )
    }

    pub(super) fn said(&self, run: usize, sign: &Sign) -> String {
        let of =
            |run: &PastRun| format!("{} in {}", self.says(run.mean_peak_rad.unwrap_or_default()), run.log);
        let log = |k: usize| &self.runs[k].log;
        match sign {
            Sign::Pair(before, from) => format!(
                "the same was sent twice and gave a mean peak error of {}, then of {}: the machine has changed in between, and \
                 logs before {} are left out",
                of(&self.runs[*before]),
                of(&self.runs[run]),
                log(*from)
            ),
            Sign::Drift(before) => format!(
                "the same was sent twice and gave a mean peak error of {}, then of {}, more than nine runs of ten should have: \
                 the machine drifts, and the next command goes on from that run alone",
                of(&self.runs[*before]),
                of(&self.runs[run]),
            ),
            Sign::Model { joint, missed_rad, own_rad, before_rad } => {
                let own = self.series[run].1.track(joint).map_or(self.kind, Track::kind);
                format!(
                    "{joint} moved otherwise in {} than runs before it have it: the model of those misses it by {} (root mean square), \
                     where it missed {} by {} and one of this run alone misses it by {}; the machine has changed, and logs up to {} \
                     are left out",
                    log(run),
                    own.says(*missed_rad),
                    log(run - 1),
                    own.says(*before_rad),
                    own.says(*own_rad),
                    log(run - 1)
                )
            }
        }
    }
}
