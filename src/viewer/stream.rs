//! Values over time, one entity a stream, sent whole or in pieces.

use std::ops::Range;

use rerun::{RecordingStream, Scalars, StateChange, TextLog, TextLogLevel, TimeColumn, Transform3D};

use super::ViewError;
use crate::{
    arm::{Pose, quaternion_xyzw},
    units::nanoseconds,
};

/// The timeline of all streams: time since the start of the log.
pub(super) const TIMELINE: &str = "time";
/// Rows of one piece; bounds the copies in memory.
const PIECE: usize = 4096;

/// A name as part of an entity's path.
pub(super) fn part(name: &str) -> String {
    rerun::EntityPathPart::new(name).escaped_string()
}

/// One entity's values over time.
pub(super) struct Stream {
    pub(super) path: String,
    /// Ascending, s.
    pub(super) t_s: Vec<f64>,
    pub(super) values: Values,
}

/// One value an instant.
pub(super) enum Values {
    /// The value of a curve.
    Scalars(Vec<f64>),
    /// The pose of a link.
    Poses(Vec<Pose>),
    /// The state of a lane.
    States(Vec<&'static str>),
    /// A message, and whether it is a warning.
    Texts(Vec<(String, bool)>),
}

impl Stream {
    pub(super) fn len(&self) -> usize {
        self.t_s.len()
    }

    /// Sends some of its rows.
    pub(super) fn send(&self, rec: &RecordingStream, rows: Range<usize>) -> Result<(), ViewError> {
        let mut start = rows.start;
        while start < rows.end {
            let end = rows.end.min(start + PIECE);
            self.send_piece(rec, start..end)?;
            start = end;
        }
        Ok(())
    }

    fn send_piece(&self, rec: &RecordingStream, rows: Range<usize>) -> Result<(), ViewError> {
        let Some(t_s) = self.t_s.get(rows.clone()) else { return Ok(()) };
        let time = TimeColumn::new_duration_nanos(TIMELINE, t_s.iter().map(|t_s| nanoseconds(*t_s)));
        let path = self.path.as_str();
        match &self.values {
            Values::Scalars(values) => {
                let values = values.get(rows).unwrap_or_default().iter().copied();
                rec.send_columns(path, [time], Scalars::new(values).columns_of_unit_batches()?)?;
            }
            Values::Poses(poses) => {
                let poses = poses.get(rows).unwrap_or_default();
                let places = poses.iter().map(|pose| single(pose.translation.vector.into()));
                let turns =
                    poses.iter().map(|pose| rerun::Quaternion::from_xyzw(single(quaternion_xyzw(pose))));
                let columns = Transform3D::new().with_many_translation(places).with_many_quaternion(turns);
                rec.send_columns(path, [time], columns.columns_of_unit_batches()?)?;
            }
            Values::States(states) => {
                for (t_s, state) in t_s.iter().zip(states.get(rows).unwrap_or_default()) {
                    rec.set_duration_secs(TIMELINE, t_s.max(0.0));
                    rec.log(path, &StateChange::single(*state))?;
                }
            }
            Values::Texts(texts) => {
                for (t_s, (text, warning)) in t_s.iter().zip(texts.get(rows).unwrap_or_default()) {
                    rec.set_duration_secs(TIMELINE, t_s.max(0.0));
                    let level = if *warning { TextLogLevel::WARN } else { TextLogLevel::INFO };
                    rec.log(path, &TextLog::new(text.as_str()).with_level(level))?;
                }
            }
        }
        Ok(())
    }
}

/// Rerun draws in single precision.
#[expect(clippy::cast_possible_truncation, reason = "that is the point")]
pub(super) fn single<const N: usize>(values: [f64; N]) -> [f32; N] {
    values.map(|value| value as f32)
}
