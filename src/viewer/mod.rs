//! What `view` found, in Rerun: the only part of the crate that sees it.

mod arm;
mod blueprint;
mod color;
mod live;
mod scene;
mod stream;

use std::{io, path::PathBuf, process::Command, time::Duration};

use rerun::{
    RecordingStream, RecordingStreamBuilder, RecordingStreamError, SerializationError, SpawnOptions,
};
use thiserror::Error;

use crate::workflow::view::Scene;

/// Where to show.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Target {
    /// A file.
    Save(PathBuf),
    /// A viewer that is started.
    Spawn,
    /// A viewer that listens at an address.
    Connect(String),
    /// A viewer for browsers that is started.
    Web,
}

/// Why nothing is shown.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ViewError {
    /// Rerun does not take it.
    #[error("the viewer cannot be reached or written to")]
    Rerun(#[from] RecordingStreamError),
    /// Rerun does not take the values.
    #[error("the viewer does not take the data")]
    Values(#[from] SerializationError),
    /// Not everything arrived.
    #[error("not everything reached the viewer: {0}")]
    Flush(String),
    /// The program `rerun` cannot be run.
    #[error("cannot run the program rerun; pip install rerun-sdk==0.36.3 brings it")]
    Program(#[source] io::Error),
}

/// How long a viewer may take to answer at first.
const PATIENCE: Duration = Duration::from_secs(15);

/// Shows runs; with a speed as they happened, so many times as fast, else at once.
///
/// # Errors
///
/// [`ViewError`] if the viewer cannot be started, reached or written to.
pub fn show(scenes: &[Scene], target: &Target, speed: Option<f64>) -> Result<(), ViewError> {
    // A name of its own, or a viewer would join what is shown now to what was shown before.
    let names: Vec<&str> = scenes.iter().map(|scene| scene.name.as_str()).collect();
    let builder = RecordingStreamBuilder::new("hydrotrace")
        .recording_id(names.join("+"))
        .recording_name(names.join(" and "))
        .with_blueprint(blueprint::of(scenes, speed.is_some()));
    match target {
        Target::Save(path) => send(&builder.save(path)?, scenes, speed),
        Target::Connect(url) => send(&builder.connect_grpc_opts(url.as_str())?, scenes, speed),
        Target::Spawn => send(&builder.spawn_opts(&SpawnOptions::default())?, scenes, speed),
        Target::Web => {
            let path = std::env::temp_dir().join(format!("hydrotrace-{}.rrd", std::process::id()));
            send(&builder.save(&path)?, scenes, None)?;
            let status = Command::new("rerun").arg("--serve-web").arg(&path).status();
            // The viewer has ended; what it showed can go.
            let _ = std::fs::remove_file(&path);
            status.map(|_| ()).map_err(ViewError::Program)
        }
    }
}

fn send(rec: &RecordingStream, scenes: &[Scene], speed: Option<f64>) -> Result<(), ViewError> {
    rec.set_log_tick_enabled(false);
    rec.set_log_time_enabled(false);
    rec.log_static("/", &rerun::ViewCoordinates::RIGHT_HAND_Z_UP())?;
    // A viewer that is not there is tried again for ever; the first message tells.
    rec.flush_with_timeout(PATIENCE).map_err(|error| ViewError::Flush(error.to_string()))?;
    let mut streams = Vec::new();
    for (index, scene) in scenes.iter().enumerate() {
        streams.extend(scene::send_static(rec, scene, (index, scenes.len()))?);
    }
    match speed {
        Some(speed) => live::play(rec, &streams, speed)?,
        None => streams.iter().try_for_each(|stream| stream.send(rec, 0..stream.len()))?,
    }
    rec.flush_blocking().map_err(|error| ViewError::Flush(error.to_string()))
}
