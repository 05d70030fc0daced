//! Comparisons that say nothing of a change.

use super::{Comparison, Summary, TransitionPair, summary::clear_joints};
use crate::{remark::Code, replay::PEAK_ERROR};

/// What writing and reading a table changes an error by at most, rad or m.
const WRITTEN: f64 = 1e-8;

/// Why a comparison says nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Idle {
    /// No start of one side has a counterpart in the other; runs of one plan without any can be compared as a whole.
    NoPair,
    /// Both sides are one run.
    SameRun,
}

impl Comparison {
    /// Why it says nothing of a change; `None` if it does.
    pub fn idle(&self) -> Option<Idle> {
        let same = || self.remarks.as_slice().iter().any(|remark| remark.code == Code::SameRun);
        if self.pairs.is_empty() && !(self.same_plan && self.unpaired.is_empty()) {
            Some(Idle::NoPair)
        } else {
            (same() && self.is_unchanged()).then_some(Idle::SameRun)
        }
    }

    /// Peak errors and start delays of the joints that clearly changed, in the order of joints.
    pub fn clear_joints(&self) -> Vec<&Summary> {
        clear_joints(&self.summaries, &self.rules)
    }

    /// Whether no peak differs by more than a table's last digit.
    fn is_unchanged(&self) -> bool {
        let change = |pair: &TransitionPair| pair.changes.get(PEAK_ERROR).difference.unwrap_or(0.0);
        self.pairs.iter().all(|pair| change(pair).abs() <= WRITTEN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workflow::compare;

    #[test]
    fn unlike_runs_and_one_run_twice_are_no_comparison() {
        let compared = |after: &str| {
            let log = |name: &str| {
                vec![std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("sample-logs").join(name)]
            };
            let (before, after) = (log("task-1-run.mcap"), log(after));
            compare::run(&compare::Inputs { before, after, ..compare::Inputs::default() }).unwrap()
        };
        let twice = compared("task-1-run.mcap");
        assert_eq!(twice.idle(), Some(Idle::SameRun));
        let mut other = compared("precompensated-run.mcap");
        assert_eq!(other.idle(), None);
        other.pairs.clear();
        other.same_plan = false;
        assert_eq!(other.idle(), Some(Idle::NoPair));
    }
}
