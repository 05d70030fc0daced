//! A machine that runs what the log of a plan says, and what comes of it.

use std::path::Path;

use hydrotrace::{
    plant::{Parameters, Record},
    series::{Series, SignalError, Track},
    workflow::simulate::log::prepare,
};

use super::{
    LearningError, Score,
    score::{self, HELD_S},
};

/// A preset with a seed.
pub(super) struct Machine<'a> {
    pub(super) name: &'a str,
    pub(super) seed: u64,
}

/// What came of a run.
pub(super) struct Ran {
    /// Its log, as `simulate` writes it.
    pub(super) log: Vec<u8>,
    pub(super) score: Score,
    /// Where the joints should be, what was sent, what was measured.
    pub(super) plan: Series,
    pub(super) sent: Series,
    pub(super) measured: Series,
}

impl Machine<'_> {
    /// Runs what a log holds, or a command in its place, and watches the joints for ten seconds more than the log does.
    pub(super) fn runs(&self, path: &Path, run: u64, command: Option<Series>) -> Result<Ran, LearningError> {
        let mut prepared = prepare(path, Parameters::preset(self.name)?, self.seed + run)?;
        if let Some(command) = command {
            prepared.inputs.command = command;
        }
        let (plan, sent) = (prepared.inputs.plan.clone(), prepared.inputs.command.clone());
        prepared.inputs.command = held(&sent)?;
        let mut run = prepared.run()?;
        let score = Score::of(&plan, &run.outputs.record)?;
        let end_s = sent.span_s().map_or(0.0, |[_, end_s]| end_s);
        let count = run.outputs.record.t_s.partition_point(|t_s| *t_s <= end_s);
        truncate(&mut run.outputs.record, count);
        let log = run.log()?;
        let measured = score::series(&run.outputs.record, false)?;
        Ok(Ran { log, score, plan, sent, measured })
    }
}

fn truncate(record: &mut Record, count: usize) {
    for column in [&mut record.t_s, &mut record.supply_pa, &mut record.payload_kg] {
        column.truncate(count);
    }
    for joint in &mut record.joints {
        for column in [
            &mut joint.measured_rad, &mut joint.measured_rad_s, &mut joint.true_rad, &mut joint.true_rad_s,
            &mut joint.cap_pressure_pa, &mut joint.rod_pressure_pa, &mut joint.valve_command,
            &mut joint.spool,
        ] {
            column.truncate(count);
        }
    }
}

/// What is sent, its last angle held for some time.
fn held(sent: &Series) -> Result<Series, SignalError> {
    let one = |track: &Track| {
        let last = track.t_s().last().copied().unwrap_or_default();
        let state = track.held_at(last);
        let t_s: Vec<f64> = track.t_s().iter().copied().chain([last + 0.01, last + HELD_S]).collect();
        let angle = track.position().iter().copied().chain([state.position; 2]).collect();
        let speed = track.velocity().unwrap_or_default().iter().copied().chain([0.0; 2]).collect();
        Track::new(track.name(), t_s, angle, &[])?.with_velocity(speed)
    };
    Ok(Series { tracks: sent.tracks.iter().map(one).collect::<Result<_, _>>()? })
}
