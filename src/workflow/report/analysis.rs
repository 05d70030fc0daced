//! From a recording to what its joints did: every verb that judges a run starts here.

use std::borrow::Borrow;

use super::outcome::Alignment;
use crate::{
    log::Recording,
    remark::{Code, Remarks},
    replay::{Replay, Rules, planned_starts, replay},
    series::{Pair, Track, align},
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
pub fn analyse<'a>(recording: &'a Recording, rules: &Rules, remarks: &mut Remarks) -> Analysis {
    let both = |planned: &'a Track| Some((planned, recording.measured.track(planned.name())?));
    let (alignment, pairs) = aligned(recording.planned.tracks.iter().filter_map(both), rules, remarks);
    let found = Analysis::of(alignment, pairs, rules);
    remark_edges(&found.replay, remarks);
    found
}

/// Planned and measured tracks by joint, moved out of a recording.
pub(super) fn taken(recording: &mut Recording) -> impl Iterator<Item = (Track, Track)> {
    let planned = std::mem::take(&mut recording.planned.tracks);
    let mut measured = std::mem::take(&mut recording.measured.tracks);
    planned.into_iter().filter_map(move |planned| {
        let at = measured.iter().position(|track| track.name() == planned.name())?;
        Some((planned, measured.swap_remove(at)))
    })
}

/// The first half of [`analyse`]. Tracks that are given away are freed joint by joint: a long run's take as much memory
/// as its pairs.
pub(super) fn aligned<T: Borrow<Track>>(
    joints: impl Iterator<Item = (T, T)>,
    rules: &Rules,
    remarks: &mut Remarks,
) -> (Vec<Alignment>, Vec<Pair>) {
    let (mut pairs, mut alignment, mut hidden) = (Vec::<Pair>::new(), Vec::new(), Vec::new());
    for (planned, measured) in joints {
        let (planned, measured): (&Track, &Track) = (planned.borrow(), measured.borrow());
        let Some(mut pair) = align(planned, measured) else {
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
        if let Some(before) = pairs.last().filter(|before| before.t_s == pair.t_s) {
            pair.t_s = before.t_s.clone();
        }
        let seen = |at_s: &f64| pair.spans_s().any(|[from_s, to_s]| (from_s..=to_s).contains(at_s));
        hidden.push(planned_starts(planned, rules).iter().filter(|at_s| !seen(at_s)).count());
        pairs.push(pair);
    }
    remark_unseen(&pairs, &hidden, remarks);
    (alignment, pairs)
}

impl Analysis {
    pub(super) fn of(alignment: Vec<Alignment>, mut pairs: Vec<Pair>, rules: &Rules) -> Self {
        let replay = replay(&pairs, rules);
        // Of no more use, and a third of what a long run takes.
        for pair in &mut pairs {
            pair.planned_velocity = None;
        }
        ::log::info!("{} joints aligned, {} transitions found", pairs.len(), replay.transitions.len());
        Self { alignment, pairs, replay }
    }
}

/// Remarks starts that may lie where a gap ends.
pub(super) fn remark_edges(replay: &Replay, remarks: &mut Remarks) {
    for joint in &replay.joints {
        let message = format!(
            "starts of {} at the edge of a gap are not judged: its plan moves where the gap ends",
            joint.name
        );
        remarks.add(Code::Unmatched, joint.edge_starts as u64, message);
    }
}

/// Measured samples without a plan are usual before and after a run; more than half is not.
const MOST_UNMATCHED: f64 = 0.5;

/// Remarks planned starts without a measurement, and joints most of whose samples have no plan.
fn remark_unseen(pairs: &[Pair], hidden: &[usize], remarks: &mut Remarks) {
    for (pair, hidden) in pairs.iter().zip(hidden) {
        let all = pair.matched + pair.unmatched;
        if pair.unmatched as f64 > MOST_UNMATCHED * all as f64 {
            // One line for all joints.
            let message = "measured samples have no plan at their time, more than half of a joint's; left out; a \
                           start is only seen where the plan also shows the rest before it";
            remarks.add(Code::Unmatched, pair.unmatched as u64, message);
        }
        let message = format!("planned starts of {} lie where nothing was measured; not judged", pair.name);
        remarks.add(Code::Unmatched, *hidden as u64, message);
    }
}
