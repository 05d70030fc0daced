//! What came of a run, by the plant's truth.

use hydrotrace::{
    plant::Record,
    replay::{Replay, Rules, replay},
    series::{Pair, Series, SignalError, Track, align, local_quadratic},
    units::degrees_from_radians,
};
use serde::Serialize;

/// How long the last command is held before the last look, s.
pub(super) const HELD_S: f64 = 10.0;

/// Errors of one run, noise-free.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Score {
    /// Mean peak of starts and reversals, deg.
    pub mean_peak_deg: f64,
    /// The same of the angles that the encoder gives, as a report has it, deg.
    pub measured_mean_peak_deg: f64,
    /// The largest of them, deg.
    pub worst_peak_deg: f64,
    /// Root mean square error of the whole run, deg.
    pub rms_deg: f64,
    /// Largest acceleration, by joint, deg/s².
    pub acceleration_deg_s2: Vec<f64>,
    /// Largest error ten seconds after the end, deg.
    pub end_error_deg: f64,
}

/// Angles without noise, or as the encoder gives them.
pub(super) fn series(record: &Record, truth: bool) -> Result<Series, SignalError> {
    let track = |joint: &hydrotrace::plant::JointRecord| {
        let angle_rad = if truth { &joint.true_rad } else { &joint.measured_rad };
        Track::new(&joint.name, record.t_s.clone(), angle_rad.clone(), &[])
    };
    Ok(Series { tracks: record.joints.iter().map(track).collect::<Result<_, _>>()? })
}

impl Score {
    pub(super) fn of(plan: &Series, record: &Record) -> Result<Self, SignalError> {
        let truth = series(record, true)?;
        let [_, end_s] = plan.span_s().unwrap_or_default();
        let pairs: Vec<_> =
            truth.tracks.iter().filter_map(|track| align(plan.track(track.name())?, track)).collect();
        let found = replay(&pairs, &Rules::default());
        let measured = series(record, false)?;
        let measured_pairs: Vec<_> =
            measured.tracks.iter().filter_map(|track| align(plan.track(track.name())?, track)).collect();
        let peaks = |found: &Replay| -> Vec<f64> {
            found.transitions.iter().map(|t| degrees_from_radians(t.peak_error)).collect()
        };
        let mean = |peaks: &[f64]| peaks.iter().sum::<f64>() / peaks.len().max(1) as f64;
        let true_deg = peaks(&found);
        let peak_of = |pair: &Pair| {
            let fits = local_quadratic(&pair.t_s, &pair.measured, &pair.segments, 0.15, 9);
            fits.iter().map(|fit| degrees_from_radians(fit.acceleration.abs())).fold(0.0, f64::max)
        };
        let held = |track: &Track| {
            let planned = plan.track(track.name()).map_or(f64::NAN, |plan| plan.held_at(end_s).position);
            degrees_from_radians((planned - track.held_at(f64::INFINITY).position).abs())
        };
        Ok(Self {
            mean_peak_deg: mean(&true_deg),
            measured_mean_peak_deg: mean(&peaks(&replay(&measured_pairs, &Rules::default()))),
            worst_peak_deg: true_deg.iter().copied().fold(0.0, f64::max),
            rms_deg: found.whole_run.tracking_error.as_ref().map_or(0.0, |e| degrees_from_radians(e.rms)),
            acceleration_deg_s2: measured_pairs.iter().map(peak_of).collect(),
            end_error_deg: truth.tracks.iter().map(held).fold(0.0, f64::max),
        })
    }

    /// Largest ratio of accelerations, joint by joint, to another run.
    pub fn acceleration_ratio(&self, other: &Self) -> f64 {
        let pairs = self.acceleration_deg_s2.iter().zip(&other.acceleration_deg_s2);
        pairs.map(|(now, then)| now / then).fold(0.0, f64::max)
    }
}
