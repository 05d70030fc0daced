//! A log as a fit needs it: what was sent, what came of it, and the valves where they were logged.

use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::{
    fit::Observation,
    log::{LogError, ReadOptions, Recording, Selector, Topics, read_plan, read_recording},
    series::{Series, SignalError, Track},
};

/// What to read of a run's log.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Wanted {
    /// Plan and measurement, where the log alone does not tell.
    pub read: ReadOptions,
    /// Where the command is; `None`: the topic that our logs have it in, if there is one.
    pub command: Option<Selector>,
    /// Where the signals to the valves are; `None`: the field that our logs have them in.
    pub valve: Option<Selector>,
}

/// Why a run cannot be fitted.
#[derive(Debug, Error)]
#[error("{} cannot be fitted", path.display())]
pub struct ObserveFailure {
    /// Its log.
    pub path: PathBuf,
    /// Why.
    pub source: ObserveError,
}

/// What a log lacks.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ObserveError {
    /// Plan and measurement, or a named topic.
    #[error(transparent)]
    Log(#[from] LogError),
    /// Times of a command that make no track beside those of the plan.
    #[error("the times of the command do not fit those of the plan")]
    Track(#[from] SignalError),
}

/// A run.
#[derive(Debug, Clone, PartialEq)]
pub struct Observed {
    /// Plan and measurement.
    pub recording: Recording,
    /// What was sent, where the log says it beside the plan.
    pub command: Option<Series>,
    /// Signals to the valves in place of positions.
    pub valve: Option<Series>,
    /// Pressures, where the log has those of both sides of the cylinders.
    pub pressures: Option<Pressures>,
}

/// Pressures in place of positions, Pa.
#[derive(Debug, Clone, PartialEq)]
pub struct Pressures {
    /// On the side without a rod.
    pub cap_pa: Series,
    /// On the side of the rod.
    pub rod_pa: Series,
    /// Before the valves.
    pub supply_pa: Option<Series>,
}

/// Field of the signals to the valves in our logs.
const VALVE: &str = "valve_command";

/// Reads one run: a file or a bag directory.
///
/// # Errors
///
/// [`ObserveFailure`] if there are no planned and measured joints, or a topic that the caller named is
/// not there.
pub fn observe(path: &Path, wanted: &Wanted) -> Result<Observed, ObserveFailure> {
    let named = |source| ObserveFailure { path: path.to_owned(), source };
    let paths = [path.to_owned()];
    let recording = read_recording(&paths, &wanted.read).map_err(|error| named(error.into()))?;
    let beside =
        |asked: Option<&Selector>, ours: Selector, angle: bool| -> Result<Option<Series>, ObserveError> {
            let topic = asked.cloned().unwrap_or(ours);
            let options = ReadOptions {
                planned: vec![topic],
                planned_is_no_angle: !angle,
                planned_in_degrees: angle && wanted.read.planned_in_degrees,
                time_base: Some(recording.source.time_base),
                ..wanted.read.clone()
            };
            match read_plan(&paths, &options) {
                Ok(found) => Ok(Some(on_origin(&found, recording.source.epoch_ns)?)),
                // A log of another origin has no such topic.
                Err(_) if asked.is_none() => Ok(None),
                Err(error) => Err(error.into()),
            }
        };
    let topics = Topics::default();
    let ours = Selector { topic: topics.command.clone(), field: None };
    let command = beside(wanted.command.as_ref(), ours, true);
    let interface = |name: &str| Selector { topic: topics.interfaces.clone(), field: Some(name.to_owned()) };
    let valve = beside(wanted.valve.as_ref(), interface(VALVE), false);
    let (command, valve) = (command.map_err(named)?, valve.map_err(named)?);
    let pressure = |name: &str| beside(None, interface(name), false).map_err(named);
    let (cap, rod) = (pressure("cap_pressure_pa")?, pressure("rod_pressure_pa")?);
    let pressures = match (cap, rod) {
        (Some(cap_pa), Some(rod_pa)) => {
            Some(Pressures { cap_pa, rod_pa, supply_pa: pressure("supply_pressure_pa")? })
        }
        _ => None,
    };
    Ok(Observed { recording, command, valve, pressures })
}

impl Observed {
    /// The same for a fit.
    pub fn observation(&self) -> Observation<'_> {
        Observation {
            sent: self.command.as_ref().unwrap_or(&self.recording.planned),
            measured: &self.recording.measured,
            valve: self.valve.as_ref(),
        }
    }
}

/// What was read as a plan, on another origin of time.
#[expect(clippy::cast_precision_loss, reason = "a log lasts less than months")]
pub(in crate::workflow) fn on_origin(found: &Recording, epoch_ns: i64) -> Result<Series, SignalError> {
    let by_s = found.source.epoch_ns.saturating_sub(epoch_ns) as f64 / crate::units::NS_PER_S;
    let shift = |track: &Track| {
        let t_s: Vec<f64> = track.t_s().iter().map(|t_s| t_s + by_s).collect();
        let cuts: Vec<usize> = track.segments().iter().skip(1).map(|segment| segment.start).collect();
        let moved = Track::new(track.name(), t_s, track.position().to_vec(), &cuts)?;
        match track.velocity() {
            Some(speed) => moved.with_velocity(speed.to_vec()),
            None => Ok(moved),
        }
    };
    Ok(Series { tracks: found.planned.tracks.iter().map(shift).collect::<Result<_, _>>()? })
}
