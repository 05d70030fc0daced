//! Runs in which a joint stood that answers in others: a valve without current says nothing of its machine.

use super::Inputs;
use crate::{
    log::Recording,
    math::deviation,
    remark::{Code, Remarks},
    series::align,
    units::DEGREE_RAD,
    workflow::names::told_apart,
};

/// A joint that moves by a smaller share of its plan stands, one that moves by more than the other answers.
const STANDS: f64 = 0.03;
const ANSWERS: f64 = 0.5;
/// Plans whose motions differ by less, as a share, may be one.
const ALIKE: f64 = 0.05;
/// Plans that move less are not judged, rad: root mean square about the mean.
const LEAST_RAD: f64 = 0.5 * DEGREE_RAD;

/// A run in which a joint stood.
struct DeadRun {
    /// Which one.
    of: usize,
    joint: String,
}

impl DeadRun {
    /// Says that the run is left out.
    fn remark(&self, logs: &[String], remarks: &mut Remarks) {
        let message = format!(
            "{}: {} hardly moves in it although it does in other runs; nothing is learnt from this run",
            logs[self.of], self.joint
        );
        remarks.add(Code::FrozenSensor, 1, message);
    }
}

/// Without the runs in which a joint stood, and what that says.
pub(super) fn without_dead(inputs: &Inputs, observed: Vec<Recording>) -> (Inputs, Vec<Recording>, Remarks) {
    let dead = dead_runs(&observed);
    let (names, mut doubts) = (told_apart(&inputs.logs), Remarks::default());
    for run in &dead {
        run.remark(&names, &mut doubts);
    }
    let stays = |k: usize| dead.iter().all(|run| run.of != k);
    let logs = inputs.logs.iter().enumerate().filter(|(k, _)| stays(*k)).map(|(_, path)| path.clone());
    let inputs = Inputs { logs: logs.collect(), ..inputs.clone() };
    (
        inputs,
        observed.into_iter().enumerate().filter(|(k, _)| stays(*k)).map(|(_, run)| run).collect(),
        doubts,
    )
}

/// The runs but the newest in which a joint stood that answers in the newest and in another one.
fn dead_runs(observed: &[Recording]) -> Vec<DeadRun> {
    let Some((newest, others)) = observed.split_last() else { return Vec::new() };
    let mut found: Vec<DeadRun> = Vec::new();
    for track in &newest.measured.tracks {
        let shares: Vec<Option<f64>> = observed.iter().map(|run| share(run, newest, track.name())).collect();
        let answers = |share: &Option<f64>| share.is_some_and(|share| share > ANSWERS);
        let enough =
            shares.last().is_some_and(answers) && shares.iter().filter(|share| answers(share)).count() > 1;
        let stood = (0..others.len()).filter(|k| enough && shares[*k].is_some_and(|share| share < STANDS));
        for of in stood.collect::<Vec<_>>() {
            if found.iter().all(|run| run.of != of) {
                found.push(DeadRun { of, joint: track.name().to_owned() });
            }
        }
    }
    found
}

/// How far a joint moves by how far its plan does, in a run of the same plan as another one's.
fn share(run: &Recording, newest: &Recording, joint: &str) -> Option<f64> {
    let [asked_rad, moved_rad] = motions_rad(run, joint)?;
    let [newest_rad, _] = motions_rad(newest, joint)?;
    let same = (asked_rad - newest_rad).abs() < ALIKE * newest_rad;
    (same && asked_rad > LEAST_RAD).then_some(moved_rad / asked_rad)
}

/// How far the plan of a joint moves and how far the joint, rad.
fn motions_rad(run: &Recording, joint: &str) -> Option<[f64; 2]> {
    let pair = align(run.planned.track(joint)?, run.measured.track(joint)?)?;
    Some([&pair.planned, &pair.measured].map(|angles| deviation(angles)))
}
