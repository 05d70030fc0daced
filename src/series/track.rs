//! The position of one joint over time.

use std::{ops::Range, sync::Arc};

use super::signal::{Instants, JointKind, Place, Signal, SignalError, check_values};
use crate::math::{State, cubic, linear, median};

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

    /// The kind in whose unit means over its joints are told.
    pub fn common_kind(&self) -> JointKind {
        JointKind::common(self.tracks.iter().map(Track::kind))
    }

    /// First and last sample of all joints, s; `None` without a joint.
    pub fn span_s(&self) -> Option<[f64; 2]> {
        span_s(&self.tracks)
    }

    /// Makes every sample so much earlier, s; joints that shared their stamps still do.
    pub fn earlier(&mut self, by_s: f64) {
        if by_s == 0.0 {
            return;
        }
        let mut last: Option<[Arc<[f64]>; 2]> = None;
        for track in &mut self.tracks {
            let old = track.signal.shared_t_s();
            let [_, new] = match last.take() {
                Some(last) if Arc::ptr_eq(&last[0], &old) => last,
                _ => [old.clone(), old.iter().map(|t_s| t_s - by_s).collect()],
            };
            track.signal.restamp(new.clone());
            last = Some([old, new]);
        }
    }
}

/// The position of one joint, a [`Signal`] in rad or m, and its velocity where the source gives one.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    kind: JointKind,
    signal: Signal,
    velocity: Option<Vec<f64>>,
}

/// First and last sample of some joints, s.
pub(super) fn span_s<'a>(tracks: impl IntoIterator<Item = &'a Track>) -> Option<[f64; 2]> {
    let ends = tracks.into_iter().filter_map(|track| Some([*track.t_s().first()?, *track.t_s().last()?]));
    ends.reduce(|[a, b], [from, to]| [a.min(from), b.max(to)])
}

impl Track {
    /// The track of a joint that turns; `cuts` as in [`Signal::new`].
    ///
    /// # Errors
    ///
    /// [`SignalError`], naming the first sample that is not finite or not later than the one before.
    pub fn new(
        name: impl Into<String>,
        t_s: impl Into<Arc<[f64]>>,
        angle_rad: Vec<f64>,
        cuts: &[usize],
    ) -> Result<Self, SignalError> {
        Self::of(JointKind::Turns, name, t_s, angle_rad, cuts)
    }

    /// The track of a joint of either kind; positions in the unit of the kind.
    ///
    /// # Errors
    ///
    /// As [`Track::new`].
    pub fn of(
        kind: JointKind,
        name: impl Into<String>,
        t_s: impl Into<Arc<[f64]>>,
        position: Vec<f64>,
        cuts: &[usize],
    ) -> Result<Self, SignalError> {
        Self::on(&Instants::new(t_s, cuts)?, kind, name, position)
    }

    /// As [`Track::of`], of positions at instants that were checked.
    pub(crate) fn on(
        instants: &Instants,
        kind: JointKind,
        name: impl Into<String>,
        position: Vec<f64>,
    ) -> Result<Self, SignalError> {
        Ok(Self { kind, signal: Signal::on(instants, name, kind.quantity(), position)?, velocity: None })
    }

    /// The same samples at other instants, as many.
    ///
    /// # Errors
    ///
    /// [`SignalError::LengthMismatch`].
    pub(crate) fn at_instants(self, instants: &Instants) -> Result<Self, SignalError> {
        let made = Self::on(instants, self.kind, self.name(), self.position().to_vec())?;
        Ok(Self { velocity: self.velocity, ..made })
    }

    /// Adds the velocity that the source gives, in the joint's unit per second.
    ///
    /// # Errors
    ///
    /// [`SignalError`] if the array is not finite or not as long as the positions.
    pub fn with_velocity(mut self, velocity: Vec<f64>) -> Result<Self, SignalError> {
        check_values("velocity", &velocity, self.len())?;
        self.velocity = Some(velocity);
        Ok(self)
    }

    /// Adds the velocity that the source gives, unless it is not finite, not as long as the positions, or not their
    /// slope.
    pub(crate) fn with_velocity_that_agrees(self, velocity: Vec<f64>) -> Self {
        let cuts: Vec<usize> = self.segments().iter().skip(1).map(|segment| segment.start).collect();
        let sound = check_values("velocity", &velocity, self.len()).is_ok()
            && velocity_agrees(self.t_s(), self.position(), &velocity, &cuts);
        Self { velocity: sound.then_some(velocity), ..self }
    }

    /// Whether the joint turns or slides.
    pub const fn kind(&self) -> JointKind {
        self.kind
    }

    /// Whether the joint turns, so that its positions are angles.
    pub const fn turns(&self) -> bool {
        matches!(self.kind, JointKind::Turns)
    }

    /// The position as a signal.
    pub const fn signal(&self) -> &Signal {
        &self.signal
    }

    /// The joint's name.
    pub fn name(&self) -> &str {
        self.signal.name()
    }

    /// Stamps, s since the start of the log, strictly increasing.
    pub fn t_s(&self) -> &[f64] {
        self.signal.t_s()
    }

    /// Positions, in the joint's unit: rad or m.
    pub fn position(&self) -> &[f64] {
        self.signal.values()
    }

    /// Velocities that the source gave, in the joint's unit per second.
    pub fn velocity(&self) -> Option<&[f64]> {
        self.velocity.as_deref()
    }

    /// Continuous stretches of samples; together they are all samples.
    pub fn segments(&self) -> &[Range<usize>] {
        self.signal.segments()
    }

    /// Number of samples, at least one.
    #[expect(clippy::len_without_is_empty, reason = "a track is never empty")]
    pub fn len(&self) -> usize {
        self.signal.len()
    }

    /// Median time between neighbouring samples, s; 0 for a single sample.
    pub fn sample_interval_s(&self) -> f64 {
        self.signal.sample_interval_s()
    }

    /// The state at a time inside a segment; `None` between segments and outside.
    ///
    /// Cubic where the source gave velocities, linear otherwise, as the ROS 2 joint trajectory
    /// controller interpolates.
    pub fn at(&self, t_s: f64) -> Option<State> {
        self.at_after(&mut 0, t_s)
    }

    /// The state at any time: as [`Track::at`], and elsewhere at rest at the last sample before (at
    /// the first one before the track starts).
    pub fn held_at(&self, t_s: f64) -> State {
        self.held_after(&mut 0, t_s)
    }

    /// Mean speed from so long before an instant to so long after it; none beyond the ends.
    pub(crate) fn mean_speed(&self, t_s: f64, half_s: f64) -> f64 {
        let [before, after] = [-half_s, half_s].map(|by_s| self.held_at(t_s + by_s).position);
        (after - before) / (2.0 * half_s)
    }

    /// As [`Track::held_at`], for a caller that walks forward in time: `cursor` makes the next look-up cheap.
    pub(crate) fn held_after(&self, cursor: &mut usize, t_s: f64) -> State {
        self.at_after(cursor, t_s).unwrap_or_else(|| {
            let position = self.position().get(*cursor).copied().unwrap_or_default();
            State { position, velocity: 0.0, acceleration: 0.0 }
        })
    }

    /// As [`Track::at`], for a caller that walks forward in time: `cursor` is left at the last
    /// sample not after `t_s` and makes the next look-up cheap.
    pub(crate) fn at_after(&self, cursor: &mut usize, t_s: f64) -> Option<State> {
        let i = match self.signal.place(cursor, t_s)? {
            Place::At(i) => return Some(self.knot(i)),
            Place::After(i) => i,
        };
        let (t, x) = (self.t_s(), self.position());
        let (span_s, at_s) = (t[i + 1] - t[i], t_s - t[i]);
        Some(match &self.velocity {
            Some(_) => cubic(self.knot(i), self.knot(i + 1), span_s, at_s),
            None => linear(x[i], x[i + 1], span_s, at_s),
        })
    }

    /// The joint in another kind, by a map from a position to that of the other kind and its slope. Samples without one
    /// are left out; `None` if none is left.
    pub fn mapped(&self, kind: JointKind, map: impl Fn(f64) -> Option<(f64, f64)>) -> Option<Self> {
        self.imaged(kind, self.position().iter().map(|&position| map(position)).collect())
    }

    /// Some of the samples, by their places; `None` where none is left.
    pub(crate) fn keeping(&self, keeps: impl Fn(usize) -> bool) -> Option<Self> {
        let image = |(k, position): (usize, &f64)| keeps(k).then_some((*position, 1.0));
        self.imaged(self.kind, self.position().iter().enumerate().map(image).collect())
    }

    fn imaged(&self, kind: JointKind, images: Vec<Option<(f64, f64)>>) -> Option<Self> {
        let kept: Vec<usize> = (0..images.len()).filter(|&i| images[i].is_some()).collect();
        let mut cuts: Vec<usize> =
            self.segments().iter().map(|s| kept.partition_point(|&i| i < s.start)).collect();
        let t_s: Arc<[f64]> = if kept.len() == self.len() {
            self.signal.shared_t_s()
        } else {
            let t_s: Arc<[f64]> = kept.iter().map(|&i| self.t_s()[i]).collect();
            cuts.extend(split_at_gaps(&t_s));
            t_s
        };
        cuts.retain(|cut| (1..t_s.len()).contains(cut));
        cuts.sort_unstable();
        cuts.dedup();
        let (position, slope): (Vec<f64>, Vec<f64>) = images.into_iter().flatten().unzip();
        let track = Self::of(kind, self.name(), t_s, position, &cuts).ok()?;
        let Some(velocity) = &self.velocity else { return Some(track) };
        // A sum with zero has no sign where it is zero.
        let velocity = kept.iter().zip(slope).map(|(&i, slope)| slope * velocity[i] + 0.0).collect();
        track.clone().with_velocity(velocity).ok().or(Some(track))
    }

    /// The samples of a range; `None` where there are none.
    pub(crate) fn part(&self, range: Range<usize>) -> Option<Self> {
        let starts = self.segments().iter().map(|segment| segment.start);
        let cuts: Vec<usize> = starts
            .filter(|cut| range.start < *cut && *cut < range.end)
            .map(|cut| cut - range.start)
            .collect();
        let [t_s, position] = [self.t_s(), self.position()].map(|all| all.get(range.clone()));
        let part = Self::of(self.kind, self.name(), t_s?, position?.to_vec(), &cuts).ok()?;
        let velocity = self.velocity.as_ref().and_then(|all| all.get(range).map(<[f64]>::to_vec));
        Some(Self { velocity, ..part })
    }

    /// Which segment sample `i` lies in.
    pub(super) fn segment_of(&self, i: usize) -> usize {
        self.segments().partition_point(|s| s.start <= i)
    }

    /// Sample `i`; velocity 0 if the source gives none.
    fn knot(&self, i: usize) -> State {
        let velocity = self.velocity.as_ref().map_or(0.0, |v| v[i]);
        State { position: self.position()[i], velocity, acceleration: 0.0 }
    }
}

/// Whether sampled velocities are the slope of sampled positions: some controllers fill the
/// field with zeros or with something else. Trapezoid steps must explain nine tenths of the
/// motion. `cuts` as in [`Track::new`].
pub fn velocity_agrees(t_s: &[f64], position: &[f64], velocity: &[f64], cuts: &[usize]) -> bool {
    let samples = t_s.len().min(position.len()).min(velocity.len());
    let (mut start, mut sums) = (0, [0.0; 2]);
    for end in cuts.iter().copied().filter(|cut| *cut < samples).chain([samples]) {
        let stretch = start..end.max(start);
        let of = unexplained_and_motion(
            &t_s[stretch.clone()],
            &position[stretch.clone()],
            &velocity[stretch.clone()],
        );
        sums = [sums[0] + of[0], sums[1] + of[1]];
        start = stretch.end;
    }
    sums[0] <= 0.1 * sums[1]
}

/// How far steps differ from those that velocities make, and how far all go: sums in lanes, so that the compiler takes
/// several samples at once.
fn unexplained_and_motion(t_s: &[f64], position: &[f64], velocity: &[f64]) -> [f64; 2] {
    const LANES: usize = 8;
    let mut sums = [[0.0; LANES]; 2];
    let mut add = |lane: usize, [t_s, position, velocity]: [[f64; 2]; 3]| {
        let step = position[1] - position[0];
        let expected = 0.5 * (velocity[1] + velocity[0]) * (t_s[1] - t_s[0]);
        sums[0][lane] += (step - expected).abs();
        sums[1][lane] += step.abs().max(expected.abs());
    };
    let all = [t_s, position, velocity];
    let before = all.map(|values| values.as_chunks::<LANES>().0);
    let after = all.map(|values| values.get(1..).unwrap_or_default().as_chunks::<LANES>().0);
    let whole = after[0].len();
    for chunk in 0..whole {
        let (before, after) = (before.map(|chunks| &chunks[chunk]), after.map(|chunks| &chunks[chunk]));
        for lane in 0..LANES {
            add(lane, [0, 1, 2].map(|of| [before[of][lane], after[of][lane]]));
        }
    }
    for i in whole * LANES + 1..t_s.len() {
        add(0, all.map(|values| [values[i - 1], values[i]]));
    }
    sums.map(|lanes| lanes.iter().sum())
}

/// The shortest silence that is one, s.
const LEAST_GAP_S: f64 = 0.5;

/// Cuts at silences longer than ten sample intervals and half a second.
///
/// Returns the indices of the first sample after each.
pub fn split_at_gaps(t_s: &[f64]) -> Vec<usize> {
    if t_s.len() < 3 {
        return Vec::new();
    }
    // Counted, so that the compiler takes several at once.
    if t_s.windows(2).filter(|w| w[1] - w[0] > LEAST_GAP_S).count() == 0 {
        return Vec::new();
    }
    let usual_s = median(t_s.windows(2).map(|w| w[1] - w[0]).collect());
    let longest_s = (10.0 * usual_s).max(LEAST_GAP_S);
    (1..t_s.len()).filter(|&i| t_s[i] - t_s[i - 1] > longest_s).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

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
