//! Planned and measured poses of a frame at the same instants.

use std::ops::Range;

use super::{
    Signal,
    signal::{Place, Quantity},
};

/// Position x, y, z, m, and unit quaternion x, y, z, w; zeros in its place where the orientation is not known.
pub type PoseSample = [f64; 7];

/// Planned and measured poses of one frame. All arrays are `[n]`, n >= 1; times strictly increase; `segments` cover
/// `0..n` and are cut where either side was, and where a measured pose has no plan.
#[derive(Debug, Clone, PartialEq)]
pub struct PosePair {
    /// The measured frame.
    pub name: String,
    /// Measured stamps, s since the start of the log.
    pub t_s: Vec<f64>,
    /// Plan at these stamps.
    pub planned: Vec<PoseSample>,
    /// Measurement.
    pub measured: Vec<PoseSample>,
    /// Continuous stretches.
    pub segments: Vec<Range<usize>>,
}

impl PosePair {
    /// Interpolates planned poses onto the stamps of measured ones; `None` if they never overlap in time, or one of both
    /// is no [`Quantity::Pose`].
    pub fn of(planned: &Signal, measured: &Signal) -> Option<Self> {
        if [planned, measured].iter().any(|side| side.quantity() != Quantity::Pose) {
            return None;
        }
        let (t_s, name) = (Vec::new(), measured.name().to_owned());
        let mut pair = Self { name, t_s, planned: Vec::new(), measured: Vec::new(), segments: Vec::new() };
        let mut cursor = 0;
        for segment in measured.segments() {
            let (mut start, mut plan_segment) = (pair.t_s.len(), None);
            for i in segment.clone() {
                let at_s = measured.t_s()[i];
                let found = planned.place(&mut cursor, at_s);
                let inside = found.map(|_| planned.segments().partition_point(|own| own.end <= cursor));
                if inside != plan_segment && pair.t_s.len() > start {
                    pair.segments.push(start..pair.t_s.len());
                    start = pair.t_s.len();
                }
                plan_segment = inside;
                if let Some(place) = found {
                    pair.t_s.push(at_s);
                    pair.planned.push(at(planned, place, at_s));
                    pair.measured.push(sample(measured, i));
                }
            }
            if pair.t_s.len() > start {
                pair.segments.push(start..pair.t_s.len());
            }
        }
        (!pair.t_s.is_empty()).then_some(pair)
    }

    /// Whether the orientation is known on both sides, which it is of all instants or of none.
    pub fn is_oriented(&self) -> bool {
        [&self.planned, &self.measured].iter().all(|side| side.first().is_some_and(|q| q[3..] != [0.0; 4]))
    }
}

fn sample(signal: &Signal, i: usize) -> PoseSample {
    std::array::from_fn(|k| signal.component(k).and_then(|own| own.get(i)).copied().unwrap_or(0.0))
}

/// Between samples the position is on a line; the quaternion, too, and made a unit again.
fn at(signal: &Signal, place: Place, at_s: f64) -> PoseSample {
    let i = match place {
        Place::At(i) => return sample(signal, i),
        Place::After(i) => i,
    };
    let (t_s, from, mut to) = (signal.t_s(), sample(signal, i), sample(signal, i + 1));
    let share = (at_s - t_s[i]) / (t_s[i + 1] - t_s[i]);
    if (3..7).map(|k| from[k] * to[k]).sum::<f64>() < 0.0 {
        to[3..].iter_mut().for_each(|value| *value = -*value);
    }
    let mut found: PoseSample = std::array::from_fn(|k| from[k] + share * (to[k] - from[k]));
    let norm = found[3..].iter().map(|value| value * value).sum::<f64>().sqrt();
    found[3..].iter_mut().for_each(|value| *value /= norm.max(f64::MIN_POSITIVE));
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn signal(t_s: Vec<f64>, poses: &[PoseSample]) -> Signal {
        let values = (0..7).flat_map(|k| poses.iter().map(move |pose| pose[k])).collect();
        Signal::new("tool", Quantity::Pose, t_s, values, &[]).unwrap()
    }

    #[test]
    fn a_pose_between_two_is_half_way_and_of_either_sign() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let planned = signal(
            vec![0.0, 1.0],
            &[[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], [2.0, 0.0, 0.0, 0.0, 0.0, -half, -half]],
        );
        let measured = signal(vec![0.5, 2.0], &[[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]; 2]);
        let pair = PosePair::of(&planned, &measured).unwrap();
        assert_eq!(pair.t_s, [0.5]);
        assert_eq!((pair.segments.len(), pair.segments[0].clone()), (1, 0..1));
        let [x, .., z, w] = pair.planned[0];
        let eighth = std::f64::consts::FRAC_PI_8;
        assert!(
            (x - 1.0).abs() < 1e-12 && (z - eighth.sin()).abs() < 1e-12 && (w - eighth.cos()).abs() < 1e-12
        );
    }
}
