//! From a recording to what its joints did: every verb that judges a run starts here.

use super::outcome::Alignment;
use crate::{
    log::Recording,
    remark::{Code, Remarks},
    replay::{Replay, Rules, planned_starts, replay},
    series::{Pair, Series, align},
};

/// Plan and measurement of a run, aligned and judged.
#[derive(Debug, Clone, PartialEq)]
pub struct Analysis {
    /// How plan and measurement were matched, by joint.
    pub alignment: Vec<Alignment>,
    /// The aligned samples, by joint; none where plan and measurement do not overlap.
    pub pairs: Vec<Pair>,
    /// What was found in them.
    pub replay: Replay,
}

/// Aligns the joints of a recording and replays them; remarks what plan or measurement lacks.
pub fn analyse(recording: &Recording, rules: &Rules, remarks: &mut Remarks) -> Analysis {
    let (alignment, pairs) = aligned(recording, rules, remarks);
    Analysis::of(alignment, pairs, rules)
}

/// The first half of [`analyse`], after which the recording is no longer needed.
pub(super) fn aligned(
    recording: &Recording,
    rules: &Rules,
    remarks: &mut Remarks,
) -> (Vec<Alignment>, Vec<Pair>) {
    let (mut pairs, mut alignment) = (Vec::new(), Vec::new());
    for planned in &recording.planned.tracks {
        let Some(measured) = recording.measured.track(planned.name()) else { continue };
        let Some(pair) = align(planned, measured) else {
            let message = format!("{} has no plan while it was measured; left out", planned.name());
            remarks.add(Code::UnpairedJoint, 1, message);
            continue;
        };
        ::log::debug!("{}: {} samples aligned, {} without a plan", pair.name, pair.matched, pair.unmatched);
        alignment.push(Alignment {
            joint: pair.name.clone(),
            matched: pair.matched,
            unmatched: pair.unmatched,
            segments: pair.segments.len(),
        });
        pairs.push(pair);
    }
    remark_unseen(&recording.planned, &pairs, rules, remarks);
    (alignment, pairs)
}

impl Analysis {
    pub(super) fn of(alignment: Vec<Alignment>, pairs: Vec<Pair>, rules: &Rules) -> Self {
        let replay = replay(&pairs, rules);
        ::log::info!("{} joints aligned, {} transitions found", pairs.len(), replay.transitions.len());
        Self { alignment, pairs, replay }
    }
}

/// Measured samples without a plan are usual before and after a run; more than half is not.
const MOST_UNMATCHED: f64 = 0.5;

/// Remarks planned starts without a measurement, and joints most of whose samples have no plan.
fn remark_unseen(planned: &Series, pairs: &[Pair], rules: &Rules, remarks: &mut Remarks) {
    for pair in pairs {
        let all = pair.matched + pair.unmatched;
        if pair.unmatched as f64 > MOST_UNMATCHED * all as f64 {
            // One line for all joints.
            let message = "measured samples have no plan at their time, more than half of a joint's; left out; a \
                           start is only seen where the plan also shows the rest before it";
            remarks.add(Code::Unmatched, pair.unmatched as u64, message);
        }
        let Some(track) = planned.track(&pair.name) else { continue };
        let seen = |at_s: &f64| {
            pair.segments.iter().any(|s| (pair.t_s[s.start]..=pair.t_s[s.end - 1]).contains(at_s))
        };
        let hidden = planned_starts(track, rules).iter().filter(|at_s| !seen(at_s)).count();
        let message = format!("planned starts of {} lie where nothing was measured; not judged", pair.name);
        remarks.add(Code::Unmatched, hidden as u64, message);
    }
}
