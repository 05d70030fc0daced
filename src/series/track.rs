//! One joint's angle over time, checked once so that nothing downstream has to check again.

use std::{ops::Range, sync::Arc};

use thiserror::Error;

use crate::math::{State, cubic, linear, median, quintic};

/// The joints of one source, in the order in which the source names them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Series {
    /// One track a joint; names are distinct.
    pub tracks: Vec<Track>,
}

impl Series {
    /// The track of a joint.
    pub fn track(&self, name: &str) -> Option<&Track> {
        self.tracks.iter().find(|track| track.name() == name)
    }

    /// First and last sample of all joints, s; `None` without a joint.
    pub fn span_s(&self) -> Option<[f64; 2]> {
        span_s(&self.tracks)
    }
}

/// One joint's angle at strictly increasing instants, all finite, at least one.
///
/// `segments` cut the samples where time is not continuous (a gap, a clock jump): nothing is
/// interpolated and no derivative is taken across a cut.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    name: String,
    t_s: Arc<[f64]>,
    position_rad: Vec<f64>,
    velocity_rad_s: Option<Vec<f64>>,
    acceleration_rad_s2: Option<Vec<f64>>,
    segments: Vec<Range<usize>>,
}

/// Why samples do not make a [`Track`].
#[derive(Debug, Clone, Error, PartialEq)]
#[non_exhaustive]
pub enum TrackError {
    /// There is nothing to look at.
    #[error("no samples")]
    Empty,
    /// Arrays do not run in parallel.
    #[error("{times} time stamps but {values} values of {quantity}")]
    LengthMismatch {
        /// Which array.
        quantity: &'static str,
        /// Number of time stamps.
        times: usize,
        /// Number of values.
        values: usize,
    },
    /// A sample is NaN or infinite.
    #[error("{quantity} {index} is not finite: {value}")]
    NotFinite {
        /// Which array.
        quantity: &'static str,
        /// Index of the sample.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// Time stands still or runs backwards.
    #[error("time does not increase at sample {index}: {previous_s} s then {next_s} s")]
    NotIncreasing {
        /// Index of the later sample.
        index: usize,
        /// The earlier stamp, s.
        previous_s: f64,
        /// The later stamp, s.
        next_s: f64,
    },
    /// A cut lies outside the samples or out of order.
    #[error("cut {cut} is not between the previous one and the {samples} samples")]
    BadCut {
        /// Index of the first sample after the cut.
        cut: usize,
        /// Number of samples.
        samples: usize,
    },
}

/// First and last sample of some joints, s.
pub(super) fn span_s<'a>(tracks: impl IntoIterator<Item = &'a Track>) -> Option<[f64; 2]> {
    let ends = tracks.into_iter().filter_map(|track| Some([*track.t_s.first()?, *track.t_s.last()?]));
    ends.reduce(|[a, b], [from, to]| [a.min(from), b.max(to)])
}

impl Track {
    /// Names samples and cuts them into segments.
    ///
    /// `cuts` are the indices of the first sample of every segment but the first, ascending.
    ///
    /// # Errors
    ///
    /// [`TrackError`], naming the first sample that breaks the type's promise.
    pub fn new(
        name: impl Into<String>,
        t_s: impl Into<Arc<[f64]>>,
        position_rad: Vec<f64>,
        cuts: &[usize],
    ) -> Result<Self, TrackError> {
        let t_s = t_s.into();
        if t_s.is_empty() {
            return Err(TrackError::Empty);
        }
        check_values("time", &t_s, t_s.len())?;
        check_values("position", &position_rad, t_s.len())?;
        for (i, pair) in t_s.windows(2).enumerate() {
            if pair[1] <= pair[0] {
                return Err(TrackError::NotIncreasing { index: i + 1, previous_s: pair[0], next_s: pair[1] });
            }
        }
        let mut segments = Vec::with_capacity(cuts.len() + 1);
        let mut start = 0;
        for &cut in cuts {
            if cut <= start || cut >= t_s.len() {
                return Err(TrackError::BadCut { cut, samples: t_s.len() });
            }
            segments.push(start..cut);
            start = cut;
        }
        segments.push(start..t_s.len());
        Ok(Self {
            name: name.into(),
            t_s,
            position_rad,
            velocity_rad_s: None,
            acceleration_rad_s2: None,
            segments,
        })
    }

    /// Adds the velocity the source gives, rad/s.
    ///
    /// # Errors
    ///
    /// [`TrackError`] if the array is not finite or not as long as the positions.
    pub fn with_velocity(mut self, velocity_rad_s: Vec<f64>) -> Result<Self, TrackError> {
        check_values("velocity", &velocity_rad_s, self.len())?;
        self.velocity_rad_s = Some(velocity_rad_s);
        Ok(self)
    }

    /// Adds the acceleration the source gives, rad/s².
    ///
    /// # Errors
    ///
    /// [`TrackError`] if the array is not finite or not as long as the positions.
    pub fn with_acceleration(mut self, acceleration_rad_s2: Vec<f64>) -> Result<Self, TrackError> {
        check_values("acceleration", &acceleration_rad_s2, self.len())?;
        self.acceleration_rad_s2 = Some(acceleration_rad_s2);
        Ok(self)
    }

    /// The joint's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Stamps, s since the start of the log, strictly increasing.
    pub fn t_s(&self) -> &[f64] {
        &self.t_s
    }

    /// Angles, rad.
    pub fn position_rad(&self) -> &[f64] {
        &self.position_rad
    }

    /// Velocities the source gave, rad/s.
    pub fn velocity_rad_s(&self) -> Option<&[f64]> {
        self.velocity_rad_s.as_deref()
    }

    /// Accelerations the source gave, rad/s².
    pub fn acceleration_rad_s2(&self) -> Option<&[f64]> {
        self.acceleration_rad_s2.as_deref()
    }

    /// Continuous stretches of samples; together they are all samples.
    pub fn segments(&self) -> &[Range<usize>] {
        &self.segments
    }

    /// Number of samples, at least one.
    #[expect(clippy::len_without_is_empty, reason = "a track is never empty")]
    pub fn len(&self) -> usize {
        self.t_s.len()
    }

    /// Time between neighbouring samples, median, s; 0 for a single sample.
    pub fn sample_interval_s(&self) -> f64 {
        if self.len() < 2 { 0.0 } else { median(self.t_s.windows(2).map(|w| w[1] - w[0]).collect()) }
    }

    /// The state at a time inside a segment; `None` between segments and outside.
    ///
    /// Quintic where the source gave velocity and acceleration, cubic where it gave velocity,
    /// linear otherwise, as the ROS 2 joint trajectory controller interpolates.
    pub fn at(&self, t_s: f64) -> Option<State> {
        self.at_after(&mut 0, t_s)
    }

    /// The state at any time: as [`Track::at`], and at rest at the last sample before where the track
    /// says nothing (at the first one before its start).
    pub fn held_at(&self, t_s: f64) -> State {
        self.at(t_s).unwrap_or_else(|| {
            let before = self.t_s.partition_point(|&t| t <= t_s).saturating_sub(1);
            let position = self.position_rad.get(before).copied().unwrap_or_default();
            State { position, velocity: 0.0, acceleration: 0.0 }
        })
    }

    /// As [`Track::at`], for a caller that walks forward in time: `cursor` is left at the last
    /// sample not after `t_s` and makes the next look-up cheap.
    pub(super) fn at_after(&self, cursor: &mut usize, t_s: f64) -> Option<State> {
        let t = &self.t_s;
        if t.get(*cursor).is_none_or(|&start| start > t_s) {
            *cursor = 0;
        }
        // Neighbouring stamps are found at once; farther ones by bisection.
        let near = (*cursor + 1..t.len().min(*cursor + 4)).find(|&i| t[i] > t_s);
        let above = near.unwrap_or_else(|| *cursor + t[*cursor..].partition_point(|&t| t <= t_s));
        let i = above.checked_sub(1)?;
        *cursor = i;
        if t[i] > t_s {
            return None;
        }
        if t[i] >= t_s {
            return Some(self.knot(i));
        }
        if above == t.len() || self.segments.binary_search_by_key(&above, |s| s.start).is_ok() {
            return None;
        }
        let (span_s, at_s) = (t[above] - t[i], t_s - t[i]);
        Some(match (&self.velocity_rad_s, &self.acceleration_rad_s2) {
            (Some(_), Some(_)) => quintic(self.knot(i), self.knot(above), span_s, at_s),
            (Some(_), None) => cubic(self.knot(i), self.knot(above), span_s, at_s),
            (None, _) => linear(self.position_rad[i], self.position_rad[above], span_s, at_s),
        })
    }

    /// Which segment sample `i` lies in.
    pub(super) fn segment_of(&self, i: usize) -> usize {
        self.segments.partition_point(|s| s.start <= i)
    }

    /// Sample `i`; what the source does not give is zero.
    fn knot(&self, i: usize) -> State {
        let of = |values: &Option<Vec<f64>>| values.as_ref().map_or(0.0, |v| v[i]);
        State {
            position: self.position_rad[i],
            velocity: of(&self.velocity_rad_s),
            acceleration: of(&self.acceleration_rad_s2),
        }
    }
}

/// Whether sampled velocities are the slope of sampled positions: some controllers fill the
/// field with zeros or with something else. Trapezoid steps must explain nine tenths of the
/// motion. `cuts` as in [`Track::new`].
pub fn velocity_agrees(t_s: &[f64], position_rad: &[f64], velocity_rad_s: &[f64], cuts: &[usize]) -> bool {
    let (mut unexplained, mut motion) = (0.0, 0.0);
    for i in (1..t_s.len()).filter(|i| cuts.binary_search(i).is_err()) {
        let step = position_rad[i] - position_rad[i - 1];
        let expected = 0.5 * (velocity_rad_s[i] + velocity_rad_s[i - 1]) * (t_s[i] - t_s[i - 1]);
        unexplained += (step - expected).abs();
        motion += step.abs().max(expected.abs());
    }
    unexplained <= 0.1 * motion
}

/// Cuts at silences longer than ten sample intervals and half a second.
///
/// Returns the indices of the first sample after each.
pub fn split_at_gaps(t_s: &[f64]) -> Vec<usize> {
    if t_s.len() < 3 {
        return Vec::new();
    }
    let usual_s = median(t_s.windows(2).map(|w| w[1] - w[0]).collect());
    let longest_s = (10.0 * usual_s).max(0.5);
    (1..t_s.len()).filter(|&i| t_s[i] - t_s[i - 1] > longest_s).collect()
}

fn check_values(quantity: &'static str, values: &[f64], samples: usize) -> Result<(), TrackError> {
    if values.len() != samples {
        return Err(TrackError::LengthMismatch { quantity, times: samples, values: values.len() });
    }
    match values.iter().position(|v| !v.is_finite()) {
        Some(index) => Err(TrackError::NotFinite { quantity, index, value: values[index] }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_repeated_time_stamp_is_refused_and_located() {
        let err = Track::new("a", vec![0.0, 0.1, 0.1], vec![0.0; 3], &[]).unwrap_err();
        assert_eq!(err.to_string(), "time does not increase at sample 2: 0.1 s then 0.1 s");
    }

    #[test]
    fn a_nan_is_refused_even_where_time_is_sound() {
        let err = Track::new("a", vec![0.0, 0.1], vec![0.0, f64::NAN], &[]).unwrap_err();
        assert!(matches!(err, TrackError::NotFinite { index: 1, .. }));
    }

    #[test]
    fn nothing_is_interpolated_across_a_cut_or_beyond_the_ends() {
        let track = Track::new("a", vec![0.0, 1.0, 5.0, 6.0], vec![0.0, 1.0, 5.0, 6.0], &[2]).unwrap();
        assert_eq!(track.at(0.5).map(|s| s.position), Some(0.5));
        assert_eq!(track.at(3.0), None);
        assert_eq!(track.at(5.5).map(|s| s.position), Some(5.5));
        assert_eq!(track.at(-0.1), None);
        assert_eq!(track.at(6.1), None);
        assert_eq!(track.at(6.0).map(|s| s.position), Some(6.0));
    }

    #[test]
    fn where_a_track_says_nothing_it_holds_its_last_angle() {
        let track = Track::new("a", vec![0.0, 1.0, 5.0, 6.0], vec![0.0, 1.0, 5.0, 6.0], &[2]).unwrap();
        let track = track.with_velocity(vec![1.0; 4]).unwrap();
        let state = |position, velocity| State { position, velocity, acceleration: 0.0 };
        assert_eq!(track.held_at(-1.0), state(0.0, 0.0));
        assert_eq!((track.held_at(0.5).position, track.held_at(0.5).velocity), (0.5, 1.0));
        assert_eq!(track.held_at(3.0), state(1.0, 0.0));
        assert_eq!(track.held_at(7.0), state(6.0, 0.0));
    }

    #[test]
    fn given_velocities_bend_the_curve_between_samples() {
        let track = Track::new("a", vec![0.0, 1.0], vec![0.0, 1.0], &[]).unwrap();
        let track = track.with_velocity(vec![0.0, 0.0]).unwrap();
        assert_eq!(track.at(0.25).map(|s| s.position), Some(0.15625));
    }

    #[test]
    fn a_silence_of_half_a_second_in_a_fast_log_is_a_cut() {
        let mut t_s: Vec<f64> = (0..100).map(|k| f64::from(k) * 0.01).collect();
        t_s.extend((0..100).map(|k| 2.0 + f64::from(k) * 0.01));
        assert_eq!(split_at_gaps(&t_s), [100]);
    }

    #[test]
    fn velocities_that_are_not_the_slope_do_not_agree() {
        let t_s: Vec<f64> = (0..50).map(|k| f64::from(k) * 0.1).collect();
        let ramp: Vec<f64> = t_s.iter().map(|t| 2.0 * t).collect();
        assert!(velocity_agrees(&t_s, &ramp, &[2.0; 50], &[]));
        assert!(!velocity_agrees(&t_s, &ramp, &[0.0; 50], &[]));
    }
}
