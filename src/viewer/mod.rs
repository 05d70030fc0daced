//! Shows runs in Rerun; no other module uses that crate.

mod arm;
mod blueprint;
mod board;
mod color;
mod front;
mod live;
mod plain;
mod process;
mod scene;
mod stream;

use std::{io, path::PathBuf, time::Duration};

use rerun::{RecordingStream, RecordingStreamBuilder, RecordingStreamError, SerializationError};
use thiserror::Error;

pub(crate) use plain::write_blueprint;

use crate::{
    atomic_file::{AtomicError, write_by_name},
    workflow::view::Scene,
};

#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Target {
    Save(PathBuf),
    Spawn,
    /// A viewer that already listens at an address.
    Connect(String),
    Web,
}

#[derive(Debug, Error)]
#[non_exhaustive]
pub(crate) enum ViewError {
    #[error("the viewer cannot be reached or written to")]
    Rerun(#[from] RecordingStreamError),
    #[error("the viewer does not take the data")]
    Values(#[from] SerializationError),
    #[error("the blueprint cannot be encoded")]
    Blueprint(#[source] Box<dyn std::error::Error + Send + Sync>),
    #[error(
        "Rerun draws no messages of the types in this log; `hydrotrace view` shows it, and `hydrotrace export LOG -o \
         run.csv` with `hydrotrace import run.csv -o run.mcap` makes a log that Rerun draws"
    )]
    Undrawn,
    #[error("cannot write the blueprint")]
    Write(#[source] io::Error),
    #[error(transparent)]
    File(#[from] AtomicError),
    #[error(
        "no viewer takes the data at {place} ({reason}); start one there with `rerun`, or leave --connect out"
    )]
    Unheard { place: String, reason: String },
    #[error("there is no program rerun on the PATH; this brings it: pip install rerun-sdk==0.36.3")]
    NoProgram,
    #[error("cannot run the program rerun")]
    Program(#[source] io::Error),
    #[error("the program rerun {0}; what it says is above")]
    Silent(String),
    #[error("cannot read {}", path.display())]
    Mesh { path: PathBuf, source: io::Error },
}

/// Time that a viewer has for its first answer.
const PATIENCE: Duration = Duration::from_secs(15);

/// Shows runs, at once or in real time at a given speed. Announces the address of a viewer for browsers, and waits
/// until it ends.
pub(crate) fn show(
    scenes: &[Scene],
    target: &Target,
    speed: Option<f64>,
    announce: &mut dyn FnMut(&str) -> io::Result<()>,
) -> Result<(), ViewError> {
    match target {
        Target::Save(path) => write_by_name(path, |partial| {
            send(&builder(scenes).save(partial)?, scenes, speed, &path.to_string_lossy())
        }),
        Target::Connect(url) => connect(url, scenes, speed),
        Target::Spawn => connect(&process::window()?, scenes, speed),
        Target::Web => {
            let mut page = process::page()?;
            // The page shows what is there and what comes, so it need not be waited for.
            let shown = announce(&page.address).map_err(ViewError::Program);
            match shown.and_then(|()| connect(&page.url, scenes, speed)) {
                Ok(()) => page.wait(),
                Err(error) => {
                    page.end();
                    Err(error)
                }
            }
        }
    }
}

fn builder(scenes: &[Scene]) -> RecordingStreamBuilder {
    // A name of its own, or a viewer would join what is shown now to what was shown before.
    let names: Vec<&str> = scenes.iter().map(|scene| scene.name.as_str()).collect();
    RecordingStreamBuilder::new(board::APPLICATION)
        .recording_id(names.join("+"))
        .recording_name(names.join(" and "))
}

fn connect(url: &str, scenes: &[Scene], speed: Option<f64>) -> Result<(), ViewError> {
    send(&builder(scenes).connect_grpc_opts(url)?, scenes, speed, url)
}

fn send(rec: &RecordingStream, scenes: &[Scene], speed: Option<f64>, place: &str) -> Result<(), ViewError> {
    let unheard = |reason: String| ViewError::Unheard { place: place.to_owned(), reason };
    rec.set_log_tick_enabled(false);
    rec.set_log_time_enabled(false);
    rec.log_static("/", &rerun::ViewCoordinates::RIGHT_HAND_Z_UP())?;
    // A viewer that is not there is tried again for ever; the first message tells.
    rec.flush_with_timeout(PATIENCE).map_err(|error| unheard(error.to_string()))?;
    blueprint::of(scenes, speed.is_some()).send(rec)?;
    front::send(rec, scenes)?;
    let mut streams = Vec::new();
    for (index, scene) in scenes.iter().enumerate() {
        streams.extend(scene::send_static(rec, scene, (index, scenes.len()))?);
    }
    match speed {
        Some(speed) => live::play(rec, &streams, speed)?,
        None => streams.iter().try_for_each(|stream| stream.send(rec, 0..stream.len()))?,
    }
    rec.flush_blocking().map_err(|error| unheard(error.to_string()))
}
