//! The log of a run as a fit needs it: what was sent, what was measured, and the valves and pressures
//! where they were logged.

use std::path::PathBuf;

use thiserror::Error;

use crate::{
    fit::Observation,
    log::{Input, LogError, LogFiles, ReadOptions, Recording, SignalRole},
    remark::Code,
    series::{Track, even_instants},
};

/// Why a run cannot be fitted.
#[derive(Debug, Error)]
#[error("{} cannot be fitted", path.display())]
pub struct ObserveFailure {
    /// Its log.
    pub path: PathBuf,
    /// Why.
    pub source: LogError,
}

/// Reads one run, wherever its files are, in one pass.
///
/// # Errors
///
/// [`ObserveFailure`] if there are no planned and measured joints, or a topic that the caller named is
/// not there.
pub fn observe(inputs: Vec<Input>, read: &ReadOptions) -> Result<Recording, ObserveFailure> {
    let path = inputs.first().map(|input| input.name().to_owned()).unwrap_or_default();
    let read = read.clone().wanting(&SignalRole::OF_DRIVES);
    let recording = LogFiles::with(inputs, &read).and_then(|files| files.scan()?.read(&read));
    let recording = recording.and_then(of_joints);
    let mut recording = recording.map_err(|source| ObserveFailure { path, source })?;
    on_even_instants(&mut recording);
    Ok(recording)
}

/// An error of a log of poses, whose places are no joints.
fn of_joints(recording: Recording) -> Result<Recording, LogError> {
    let places = recording.planned.tracks.iter().all(|track| ["x", "y", "z"].contains(&track.name()));
    if recording.poses.is_some() && places {
        return Err(LogError::PosesAlone { topic: recording.source.measured_topic });
    }
    Ok(recording)
}

/// Brings rows that were stamped late by chance onto the instants at which they were made, as their plan tells.
fn on_even_instants(recording: &mut Recording) {
    let Recording { planned, measured, command, remarks, .. } = recording;
    let Some(stamped) = planned.tracks.first().map(|track| track.t_s().to_vec()) else { return };
    let plans: Vec<&Track> = planned.tracks.iter().filter(|track| track.t_s() == stamped).collect();
    let Some((instants, off_s)) = even_instants(&plans) else { return };
    let sent = command.iter_mut().flat_map(|command| &mut command.series.tracks);
    let all = planned.tracks.iter_mut().chain(&mut measured.tracks).chain(sent);
    let mut count = 0;
    for track in all.filter(|track| track.t_s() == stamped) {
        if let Ok(made) = track.clone().at_instants(&instants) {
            (*track, count) = (made, count + 1);
        }
    }
    let message = format!(
        "signals whose rows are stamped by chance up to some ms late ({:.1} ms, root mean square), as their plan tells, which is smooth from \
         row to row: taken at even steps",
        1e3 * off_s
    );
    remarks.add(Code::UnusableStamp, count, message);
}

/// The same for a fit: the command if the log has one, else the plan.
pub fn observation(recording: &Recording) -> Observation<'_> {
    Observation {
        sent: recording.command.as_ref().map_or(&recording.planned, |command| &command.series),
        measured: &recording.measured,
        valve: recording.signals.get(&SignalRole::Valve).map_or(&[], Vec::as_slice),
    }
}
