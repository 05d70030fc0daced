//! A run as a table that other programs read.

mod csv;
#[cfg(feature = "parquet")]
mod parquet;

use thiserror::Error;

use super::{AngleUnit, Recording};
use crate::{
    atomic_file::AtomicError,
    series::{Track, align},
    units::{DEGREE_RAD, NS_PER_S, seconds_since},
};

/// Why a table was not written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The output takes no more.
    #[error("cannot write the table")]
    Output(#[from] std::io::Error),
    /// The Parquet library said no.
    #[cfg(feature = "parquet")]
    #[error("cannot write the Parquet file")]
    Parquet(#[from] ::parquet::errors::ParquetError),
    /// The file cannot be put in place.
    #[error(transparent)]
    Atomic(#[from] AtomicError),
}

/// A run as a table: a row for every instant at which anything was sampled.
///
/// Columns: `stamp_ns` (since 1970), `time_s` (since the start of the run), and for each joint
/// `J_planned_rad`, `J_planned_rad_s` where the plan gives speeds, `J_measured_rad`,
/// `J_measured_rad_s`, `J_command_rad` and `J_error_rad`, as far as there are such. Plan and
/// measurement stand as they were sampled, each at its own instants, so that
/// [`read_csv`](super::read_csv) gives the same run back; the error is planned minus measured at
/// measured instants, the plan interpolated as a report does.
#[derive(Debug, Clone, PartialEq)]
pub struct RunTable {
    stamp_ns: Vec<i64>,
    time_s: Vec<f64>,
    names: Vec<String>,
    /// `[columns][rows]`; NaN where there is no sample.
    cells: Vec<Vec<f64>>,
}

/// Instants, ns since 1970, and values of one column.
struct Samples {
    name: String,
    stamp_ns: Vec<i64>,
    values: Vec<f64>,
}

impl RunTable {
    /// Lays out the joints that both plan, or command where there is no plan, and measurement have; all of
    /// one side if there is no other. `command` is a recording whose plan is what was sent.
    pub fn new(recording: &Recording, command: Option<&Recording>, unit: AngleUnit) -> Self {
        let epoch_ns = recording.source.epoch_ns;
        let (suffix, per_rad) = match unit {
            AngleUnit::Radians => ("rad", 1.0),
            AngleUnit::Degrees => ("deg", 1.0 / DEGREE_RAD),
        };
        let mut all: Vec<Samples> = Vec::new();
        for joint in joints(recording, command) {
            let mut add = |what: &str, epoch_ns: i64, t_s: &[f64], values: &[f64]| {
                all.push(Samples {
                    name: format!("{joint}_{what}").replace("{unit}", suffix),
                    stamp_ns: t_s.iter().map(|&t_s| stamp_ns(epoch_ns, t_s)).collect(),
                    values: values.iter().map(|value| value * per_rad).collect(),
                });
            };
            let mut side = |what: &str, epoch_ns: i64, track: Option<&Track>| {
                let Some(track) = track else { return };
                add(&format!("{what}_{{unit}}"), epoch_ns, track.t_s(), track.position());
                if let Some(speed_rad_s) = track.velocity() {
                    add(&format!("{what}_{{unit}}_s"), epoch_ns, track.t_s(), speed_rad_s);
                }
            };
            let (planned, measured) = (recording.planned.track(joint), recording.measured.track(joint));
            side("planned", epoch_ns, planned);
            side("measured", epoch_ns, measured);
            if let Some(sent) = command {
                side("command", sent.source.epoch_ns, sent.planned.track(joint));
            }
            if let Some(pair) = planned.zip(measured).and_then(|(planned, measured)| align(planned, measured))
            {
                let error_rad: Vec<f64> =
                    pair.planned.iter().zip(&pair.measured).map(|(r, y)| r - y).collect();
                add("error_{unit}", epoch_ns, &pair.t_s, &error_rad);
            }
        }
        Self::merge(epoch_ns, all)
    }

    fn merge(epoch_ns: i64, all: Vec<Samples>) -> Self {
        let mut rows: Vec<i64> = Vec::new();
        for (k, samples) in all.iter().enumerate() {
            if k == 0 || all[k - 1].stamp_ns != samples.stamp_ns {
                rows.extend(&samples.stamp_ns);
            }
        }
        rows.sort_unstable();
        rows.dedup();
        let mut names = Vec::with_capacity(all.len());
        let mut cells = Vec::with_capacity(all.len());
        for samples in all {
            let mut column = vec![f64::NAN; rows.len()];
            let mut row = 0;
            for (ns, value) in samples.stamp_ns.iter().zip(samples.values) {
                while rows.get(row).is_some_and(|at| at < ns) {
                    row += 1;
                }
                if let Some(cell) = column.get_mut(row) {
                    *cell = value;
                }
            }
            names.push(samples.name);
            cells.push(column);
        }
        let time_s = rows.iter().map(|&ns| seconds_since(epoch_ns, ns)).collect();
        Self { stamp_ns: rows, time_s, names, cells }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.stamp_ns.len()
    }

    /// Names of the columns, in order.
    pub fn column_names(&self) -> impl Iterator<Item = &str> {
        ["stamp_ns", "time_s"].into_iter().chain(self.names.iter().map(String::as_str))
    }
}

/// Names of the joints of a table.
fn joints<'a>(recording: &'a Recording, command: Option<&'a Recording>) -> Vec<&'a str> {
    let sent = command.map_or(&[][..], |sent| &sent.planned.tracks);
    let (planned, measured) = (&recording.planned.tracks[..], &recording.measured.tracks[..]);
    let asked = if planned.is_empty() { sent } else { planned };
    let names = |tracks: &'a [Track]| tracks.iter().map(Track::name);
    match (asked.is_empty(), measured.is_empty()) {
        (true, _) => names(measured).collect(),
        (false, true) => names(asked).collect(),
        (false, false) => names(asked).filter(|joint| recording.measured.track(joint).is_some()).collect(),
    }
}

#[expect(clippy::cast_possible_truncation, reason = "saturates far beyond any log")]
fn stamp_ns(epoch_ns: i64, t_s: f64) -> i64 {
    epoch_ns.saturating_add((t_s * NS_PER_S).round() as i64)
}
