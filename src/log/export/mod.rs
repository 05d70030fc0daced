//! A run as a table that other programs read.

mod csv;
#[cfg(feature = "parquet")]
mod parquet;

use thiserror::Error;

use super::{csv::AngleUnit, read::recording::Recording};
use crate::{
    atomic_file::AtomicError,
    math::{median, range},
    series::{JointKind, Track, align},
    units::{DEGREE_RAD, nanoseconds, seconds_since},
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
/// `J_measured_rad_s`, `J_command_rad` and `J_error_rad`, as far as there are such; `deg` if asked
/// for. For joints that slide `m` stands in place of `rad`, `mm` in place of `deg`. Plan and
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

/// Runs that follow one another without a gap stand so far apart, s, and so many steps: more than a reader takes for one run.
const APART_S: f64 = 2.0;
const APART_STEPS: f64 = 20.0;

/// Where a run begins without a gap, as where the clock of the log went back, s, and how far it is to stand from the one before.
fn seams_s(recording: &Recording) -> Vec<[f64; 2]> {
    let mut seams_s: Vec<[f64; 2]> = Vec::new();
    for track in recording.measured.tracks.iter().chain(&recording.planned.tracks) {
        let t_s = track.t_s();
        let step_s = median(t_s.windows(2).map(|two| two[1] - two[0]).collect());
        for segment in track.segments().iter().skip(1) {
            let [before_s, from_s] = [t_s[segment.start - 1], t_s[segment.start]];
            if from_s - before_s > 2.0 * step_s {
                continue;
            }
            let apart_s = APART_S.max(APART_STEPS * step_s);
            // Signals of one run begin within a step of the slowest.
            match seams_s.iter_mut().find(|[seam_s, _]| (*seam_s - from_s).abs() < 0.5 * APART_S) {
                Some(seam) => *seam = [seam[0].min(from_s), seam[1].max(apart_s)],
                None => seams_s.push([from_s, apart_s]),
            }
        }
    }
    seams_s
}

impl RunTable {
    /// Lays out the joints that both plan, or command if there is no plan, and measurement have; all of
    /// one side if there is no other.
    pub fn new(recording: &Recording, unit: AngleUnit) -> Self {
        let epoch_ns = recording.source.epoch_ns;
        let seams_s = seams_s(recording);
        let stamp_ns = |t_s: &f64| {
            let apart_s: f64 =
                seams_s.iter().filter(|[seam_s, _]| seam_s <= t_s).map(|[_, apart_s]| apart_s).sum();
            epoch_ns.saturating_add(nanoseconds(t_s + apart_s))
        };
        let unit_of = |kind| match (kind, unit) {
            (JointKind::Turns, AngleUnit::Radians) => ("rad", 1.0),
            (JointKind::Turns, AngleUnit::Degrees) => ("deg", 1.0 / DEGREE_RAD),
            (JointKind::Slides, AngleUnit::Radians) => ("m", 1.0),
            (JointKind::Slides, AngleUnit::Degrees) => ("mm", 1000.0),
        };
        let command = recording.command.as_ref().map(|command| &command.series);
        let speeds = recording.planned.tracks.iter().any(|track| track.velocity().is_some());
        let mut all: Vec<Samples> = Vec::new();
        for joint in joints(recording) {
            let mut add = |kind: JointKind, what: &str, per: &str, t_s: &[f64], values: &[f64]| {
                let (unit, factor) = unit_of(kind);
                all.push(Samples {
                    name: format!("{joint}_{what}_{unit}{per}"),
                    stamp_ns: t_s.iter().map(stamp_ns).collect(),
                    values: values.iter().map(|value| value * factor).collect(),
                });
            };
            let (planned, measured) = (recording.planned.track(joint), recording.measured.track(joint));
            let command = command.and_then(|command| command.track(joint));
            for (what, track) in [("planned", planned), ("measured", measured), ("command", command)] {
                let Some(track) = track else { continue };
                add(track.kind(), what, "", track.t_s(), track.position());
                // No speeds are read of a joint that stands; a controller that takes speeds takes those of all joints.
                let still = || (what == "planned" && speeds && stands(track)).then(|| vec![0.0; track.len()]);
                if let Some(velocity) = track.velocity().map(<[f64]>::to_vec).or_else(still) {
                    add(track.kind(), what, "_s", track.t_s(), &velocity);
                }
            }
            if let Some(pair) = planned.zip(measured).and_then(|(planned, measured)| align(planned, measured))
            {
                let error: Vec<f64> = pair.planned.iter().zip(&pair.measured).map(|(r, y)| r - y).collect();
                add(pair.kind, "error", "", &pair.t_s, &error);
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

/// Whether a joint stays where it is, but for rounding.
fn stands(track: &Track) -> bool {
    const ROUNDED: f64 = 1e-9;
    let [least, most] = range(track.position().iter().copied());
    most - least < ROUNDED
}

/// Names of the joints of a table.
fn joints(recording: &Recording) -> Vec<&str> {
    let Recording { planned, measured, command, .. } = recording;
    let asked = match command {
        Some(command) if planned.tracks.is_empty() => &command.series,
        _ => planned,
    };
    let (one, other) = if asked.tracks.is_empty() { (measured, asked) } else { (asked, measured) };
    let names = one.tracks.iter().map(Track::name);
    names.filter(|joint| other.tracks.is_empty() || other.track(joint).is_some()).collect()
}
