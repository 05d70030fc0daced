//! Runs in which a joint stood that answers in others: a valve without current says nothing of its machine.

use std::path::PathBuf;

use super::Inputs;
use crate::{
    log::Recording,
    remark::{Code, Remarks},
    series::{Pair, align},
    units::DEGREE_RAD,
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
    fn remark(&self, logs: &[PathBuf], remarks: &mut Remarks) {
        let name = logs.get(self.of).and_then(|path| path.file_name()).unwrap_or_default().to_string_lossy();
        let message = format!(
            "{name}: {} hardly moves in it although it does in other runs; nothing is learnt from this run",
            self.joint
        );
        remarks.add(Code::FrozenSensor, 1, message);
    }
}

/// Without the runs in which a joint stood, and what that says.
pub(super) fn without_dead(inputs: &Inputs, observed: Vec<Recording>) -> (Inputs, Vec<Recording>, Remarks) {
    let dead = dead_runs(&observed);
    let mut doubts = Remarks::default();
    for run in &dead {
        run.remark(&inputs.logs, &mut doubts);
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
    for track in newest.measured.tracks.iter().filter(|track| track.turns()) {
        let asked_rad = asked(newest, track.name());
        let same = |run: &Recording| {
            let own_rad = asked(run, track.name());
            own_rad.zip(asked_rad).is_some_and(|(own, newest)| (own - newest).abs() < ALIKE * newest)
        };
        let shares: Vec<Option<f64>> =
            observed.iter().map(|run| share(run, track.name()).filter(|_| same(run))).collect();
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

/// How far the plan of a joint moves, rad.
fn asked(run: &Recording, joint: &str) -> Option<f64> {
    let pair: Pair = align(run.planned.track(joint)?, run.measured.track(joint)?)?;
    Some(motion(&pair.planned))
}

/// How far a joint moves by how far its plan does.
fn share(run: &Recording, joint: &str) -> Option<f64> {
    let pair: Pair = align(run.planned.track(joint)?, run.measured.track(joint)?)?;
    let asked_rad = motion(&pair.planned);
    (asked_rad > LEAST_RAD).then(|| motion(&pair.measured) / asked_rad)
}

/// Root mean square distance from the mean.
fn motion(values: &[f64]) -> f64 {
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt()
}
