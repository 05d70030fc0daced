//! Each joint's error over the run, coarse enough for one line of text.

use std::ops::RangeInclusive;

use crate::series::Pair;

/// Stretches of equal duration that a run is cut into.
pub const STRETCHES: usize = 18;

/// Largest errors of every joint in equal stretches of the run, joints on one time axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Profiles {
    /// Largest |planned - measured| by joint and stretch, rad; `None` where nothing was measured.
    pub peaks: Vec<[Option<f64>; STRETCHES]>,
    /// The largest of all, rad.
    pub most: f64,
}

impl Profiles {
    /// Of joints in their order.
    pub fn of(pairs: &[Pair]) -> Self {
        let span_s = span_s(pairs);
        let peaks: Vec<_> = pairs.iter().map(|pair| peaks(pair, &span_s)).collect();
        let most = peaks.iter().flatten().flatten().fold(0.0, |most: f64, peak| most.max(*peak));
        Self { peaks, most }
    }
}

/// First and last sample of all joints, s.
fn span_s(pairs: &[Pair]) -> RangeInclusive<f64> {
    let ends = pairs.iter().flat_map(|pair| [pair.t_s.first(), pair.t_s.last()]);
    let [start_s, end_s] = crate::math::range(ends.flatten().copied());
    start_s..=end_s
}

fn peaks(pair: &Pair, span_s: &RangeInclusive<f64>) -> [Option<f64>; STRETCHES] {
    let mut peaks = [None; STRETCHES];
    let whole_s = span_s.end() - span_s.start();
    let angles = pair.planned.iter().zip(&pair.measured);
    for (t_s, (planned, measured)) in pair.t_s.iter().zip(angles) {
        let share = if whole_s > 0.0 { (t_s - span_s.start()) / whole_s } else { 0.0 };
        // The last sample belongs to the last stretch.
        let place = crate::math::whole(share * STRETCHES as f64).min(STRETCHES - 1);
        let error = (planned - measured).abs();
        if let Some(peak) = peaks.get_mut(place) {
            *peak = Some(peak.map_or(error, |most: f64| most.max(error)));
        }
    }
    peaks
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::series::{Track, align};

    fn pair(t_s: &[f64], error: &[f64]) -> Pair {
        let track = |q: Vec<f64>| Track::new("a", t_s, q, &[]).unwrap();
        align(&track(vec![0.0; error.len()]), &track(error.iter().map(|e| -e).collect())).unwrap()
    }

    #[test]
    fn one_sample_that_is_off_is_seen_and_where_nothing_was_measured_nothing_is() {
        let t_s: Vec<f64> = (0..=1800).map(|k| f64::from(k) * 0.01).collect();
        let mut error = vec![0.001; t_s.len()];
        error[1234] = -0.5;
        let late = pair(&[9.0, 17.5], &[0.1, 0.2]);
        let profiles = Profiles::of(&[pair(&t_s, &error), late]);
        assert!((profiles.most - 0.5).abs() < 1e-12);
        for (place, peak) in profiles.peaks[0].iter().enumerate() {
            assert_eq!(*peak, Some(if place == 12 { 0.5 } else { 0.001 }));
        }
        let seen: Vec<usize> = (0..STRETCHES).filter(|k| profiles.peaks[1][*k].is_some()).collect();
        assert_eq!(seen, [9, 17]);
    }

    #[test]
    fn a_single_instant_and_no_joint_at_all_are_runs_too() {
        assert_eq!(Profiles::of(&[]), Profiles { peaks: Vec::new(), most: 0.0 });
        assert_eq!(Profiles::of(&[pair(&[3.0], &[0.1])]).peaks[0][0], Some(0.1));
    }
}
