//! One measured or commanded quantity over time, checked once so that nothing downstream checks it again.

use std::{ops::Range, sync::Arc};

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::{
    math::{linear, usual_step},
    units::Degrees,
};

/// The quantity of the values of a [`Signal`], and so their unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Position of a joint that turns, rad.
    Angle,
    /// Position of a joint that slides, m.
    Length,
    /// Share of the full signal, as to a valve: -1 to 1.
    Share,
    /// Pressure, Pa.
    Pressure,
    /// Effort of a joint that turns, N m.
    Torque,
    /// Effort of a joint that slides, N.
    Force,
    /// Position x, y, z, m, and unit quaternion x, y, z, w of a frame; zeros where its orientation is not known.
    Pose,
}

impl Quantity {
    /// The unit in text; of the position for a pose.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Angle => "rad",
            Self::Length | Self::Pose => "m",
            Self::Share => "1",
            Self::Pressure => "Pa",
            Self::Torque => "N m",
            Self::Force => "N",
        }
    }

    /// Number of values in a sample.
    pub const fn components(self) -> usize {
        match self {
            Self::Pose => 7,
            _ => 1,
        }
    }
}

/// How a joint moves, and so the units of its position, velocity and effort.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum JointKind {
    /// About an axis: rad.
    #[default]
    Turns,
    /// Along an axis: m.
    Slides,
}

impl JointKind {
    /// The quantity of its position.
    pub const fn quantity(self) -> Quantity {
        match self {
            Self::Turns => Quantity::Angle,
            Self::Slides => Quantity::Length,
        }
    }

    /// Whether it is one that turns.
    pub fn turns(&self) -> bool {
        *self == Self::Turns
    }

    /// The unit of its position in text.
    pub const fn unit(self) -> &'static str {
        self.quantity().unit()
    }

    /// The kind in whose unit means over joints are told: of lengths if all of these slide.
    pub fn common(kinds: impl IntoIterator<Item = Self>) -> Self {
        let mut kinds = kinds.into_iter().peekable();
        let slides = kinds.peek().is_some() && kinds.all(|kind| kind == Self::Slides);
        if slides { Self::Slides } else { Self::Turns }
    }

    /// A position, or a difference of two, as people read it in messages.
    pub fn says(self, value: f64) -> String {
        match self {
            Self::Turns => Degrees(value).to_string(),
            Self::Slides => format!("{:.1} mm", 1e3 * value),
        }
    }
}

/// Values of one [`Quantity`] at strictly increasing instants, all finite, at least one.
///
/// `segments` cut the samples where time is not continuous (a gap, a clock jump): nothing is
/// interpolated and no derivative is taken across a cut.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    name: String,
    quantity: Quantity,
    t_s: Arc<[f64]>,
    /// `[components, samples]`.
    values: Vec<f64>,
    segments: Vec<Range<usize>>,
}

/// Why samples do not make a [`Signal`] or a [`Track`](super::Track).
#[derive(Debug, Clone, Error, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message says what each field is")]
pub enum SignalError {
    #[error("no samples")]
    Empty,
    #[error("{times} time stamps but {values} values of {array}")]
    LengthMismatch { array: &'static str, times: usize, values: usize },
    #[error("{array} {index} is not finite: {value}")]
    NotFinite { array: &'static str, index: usize, value: f64 },
    /// Time stands still or runs backwards.
    #[error("time does not increase at sample {index}: {previous_s} s then {next_s} s")]
    NotIncreasing { index: usize, previous_s: f64, next_s: f64 },
    #[error("cut {cut} is not between the previous one and the {samples} samples")]
    BadCut { cut: usize, samples: usize },
    /// Too much to be held in samples of equal steps.
    #[error("{span_s} s are longer than a run can be, {most_s} s: is a stamp wrong?")]
    TooLong { span_s: f64, most_s: f64 },
}

/// Instants that were checked, for signals that share them: finite, strictly increasing, at least one.
#[derive(Debug, Clone)]
pub(crate) struct Instants {
    t_s: Arc<[f64]>,
    segments: Vec<Range<usize>>,
}

impl Instants {
    /// As [`Signal::new`].
    pub(crate) fn new(t_s: impl Into<Arc<[f64]>>, cuts: &[usize]) -> Result<Self, SignalError> {
        let t_s = t_s.into();
        if t_s.is_empty() {
            return Err(SignalError::Empty);
        }
        check_values("time", &t_s, t_s.len())?;
        let stands = |pair: &[f64]| pair[1] <= pair[0];
        if t_s.windows(2).fold(false, |any, pair| any | stands(pair))
            && let Some(at) = t_s.windows(2).position(stands)
        {
            return Err(SignalError::NotIncreasing {
                index: at + 1,
                previous_s: t_s[at],
                next_s: t_s[at + 1],
            });
        }
        let mut segments = Vec::with_capacity(cuts.len() + 1);
        let mut start = 0;
        for &cut in cuts {
            if cut <= start || cut >= t_s.len() {
                return Err(SignalError::BadCut { cut, samples: t_s.len() });
            }
            segments.push(start..cut);
            start = cut;
        }
        segments.push(start..t_s.len());
        Ok(Self { t_s, segments })
    }
}

/// Where an instant lies among the samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    /// At this sample.
    At(usize),
    /// Between this sample and the next one of the same segment.
    After(usize),
}

impl Signal {
    /// Names samples and cuts them into segments.
    ///
    /// `values` are `[components, samples]`; `cuts` are the indices of the first sample of every
    /// segment but the first, ascending.
    ///
    /// # Errors
    ///
    /// [`SignalError`], naming the first sample that is not finite or not later than the one before.
    pub fn new(
        name: impl Into<String>,
        quantity: Quantity,
        t_s: impl Into<Arc<[f64]>>,
        values: Vec<f64>,
        cuts: &[usize],
    ) -> Result<Self, SignalError> {
        Self::on(&Instants::new(t_s, cuts)?, name, quantity, values)
    }

    /// As [`Signal::new`], of values at instants that were checked.
    pub(crate) fn on(
        instants: &Instants,
        name: impl Into<String>,
        quantity: Quantity,
        values: Vec<f64>,
    ) -> Result<Self, SignalError> {
        check_values("value", &values, instants.t_s.len() * quantity.components())?;
        let Instants { t_s, segments } = instants.clone();
        Ok(Self { name: name.into(), quantity, t_s, values, segments })
    }

    /// Name of the joint or frame.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The quantity of the values.
    pub const fn quantity(&self) -> Quantity {
        self.quantity
    }

    /// Other stamps, as many and as ordered.
    pub(super) fn restamp(&mut self, t_s: Arc<[f64]>) {
        debug_assert_eq!(t_s.len(), self.t_s.len());
        self.t_s = t_s;
    }

    /// The stamps, for another signal at the same times.
    pub(super) fn shared_t_s(&self) -> Arc<[f64]> {
        self.t_s.clone()
    }

    /// Stamps, s since the start of the log, strictly increasing.
    pub fn t_s(&self) -> &[f64] {
        &self.t_s
    }

    /// Values of the first component, which is the only one of all quantities but poses.
    pub fn values(&self) -> &[f64] {
        self.component(0).unwrap_or_default()
    }

    /// Values of a component; `None` if the quantity has fewer.
    pub fn component(&self, index: usize) -> Option<&[f64]> {
        let start = index.checked_mul(self.t_s.len())?;
        self.values.get(start..start.checked_add(self.t_s.len())?)
    }

    /// Continuous stretches of samples; together they are all samples.
    pub fn segments(&self) -> &[Range<usize>] {
        &self.segments
    }

    /// Number of samples, at least one.
    #[expect(clippy::len_without_is_empty, reason = "a signal is never empty")]
    pub fn len(&self) -> usize {
        self.t_s.len()
    }

    /// Usual time between neighbouring samples, s; 0 for a single sample.
    pub fn sample_interval_s(&self) -> f64 {
        usual_step(&self.t_s.windows(2).map(|w| w[1] - w[0]).collect::<Vec<_>>())
    }

    /// The first component at a time inside a segment, by a line between samples; `None` between
    /// segments and outside.
    pub fn at(&self, t_s: f64) -> Option<f64> {
        let (t, x) = (&self.t_s, self.values());
        Some(match self.place(&mut 0, t_s)? {
            Place::At(i) => x[i],
            Place::After(i) => linear(x[i], x[i + 1], t[i + 1] - t[i], t_s - t[i]).position,
        })
    }

    /// Where a time lies; `None` between segments and outside. For a caller that walks forward in
    /// time: `cursor` is left at the last sample not after `t_s` and makes the next look-up cheap.
    pub(super) fn place(&self, cursor: &mut usize, t_s: f64) -> Option<Place> {
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
            return Some(Place::At(i));
        }
        let ends = above == t.len() || self.segments.binary_search_by_key(&above, |s| s.start).is_ok();
        (!ends).then_some(Place::After(i))
    }
}

/// Checks that an array is finite and as long as the samples need it.
pub(super) fn check_values(array: &'static str, values: &[f64], samples: usize) -> Result<(), SignalError> {
    if values.len() != samples {
        return Err(SignalError::LengthMismatch { array, times: samples, values: values.len() });
    }
    if all_finite(values) {
        return Ok(());
    }
    match values.iter().position(|v| !v.is_finite()) {
        Some(index) => Err(SignalError::NotFinite { array, index, value: values[index] }),
        None => Ok(()),
    }
}

/// Whether all values are finite, without a branch on any: nearly always they are.
pub(crate) fn all_finite(values: &[f64]) -> bool {
    values.iter().fold(true, |all, value| all & value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_repeated_time_stamp_is_refused_and_located() {
        let err = Signal::new("a", Quantity::Pressure, vec![0.0, 0.1, 0.1], vec![0.0; 3], &[]).unwrap_err();
        assert_eq!(err.to_string(), "time does not increase at sample 2: 0.1 s then 0.1 s");
    }

    #[test]
    fn a_nan_is_refused_even_where_time_is_sound() {
        let err = Signal::new("a", Quantity::Share, vec![0.0, 0.1], vec![0.0, f64::NAN], &[]).unwrap_err();
        assert!(matches!(err, SignalError::NotFinite { index: 1, .. }));
    }

    #[test]
    fn the_components_of_a_pose_are_arrays_of_their_own() {
        let values = (0..14).map(f64::from).collect();
        let pose = Signal::new("tool", Quantity::Pose, vec![0.0, 1.0], values, &[]).unwrap();
        assert_eq!(pose.component(6), Some(&[12.0, 13.0][..]));
        assert_eq!((pose.component(7), pose.at(0.5)), (None, Some(0.5)));
    }
}
