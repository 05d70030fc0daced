//! How fast a joint moves while its plan rests: a load that sinks, a cylinder that leaks, a loop that does not hold.

use serde::{Deserialize, Serialize};

use super::Sizes;
use crate::{
    math::{half_interval, line},
    series::Pair,
};

/// A rest is looked at in parts of this length, s; one of less than half of it tells nothing.
const PART_S: f64 = 2.0;
/// Fewest samples of a part.
const FEWEST: usize = 8;

/// Mean speed while the plan rests, beyond that of a plan that moves too slowly to be seen to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct RestDrift {
    /// Mean over parts of the rests, in the joint's unit a second.
    pub speed: f64,
    /// Its 95 % interval, from the spread over parts; needs three of them.
    pub interval: Option<[f64; 2]>,
    /// Time at rest that was looked at, s.
    pub duration_s: f64,
}

impl RestDrift {
    /// Whether it is more than scatter and in all moves the joint by more than the band of settling. Joints are many, and tails
    /// of settling are no scatter: it must be larger than its whole interval is wide.
    pub fn counts(&self, sizes: &Sizes) -> bool {
        let sure = self.interval.is_some_and(|[low, high]| self.speed.abs() > high - low);
        sure && (self.speed * self.duration_s).abs() >= sizes.settle_band
    }
}

/// The drift of a joint whose plan rests in some samples; `None` where no rest is long enough.
pub(super) fn rest_drift(pair: &Pair, rest: &[bool]) -> Option<RestDrift> {
    let mut parts: Vec<Vec<f64>> = Vec::new();
    let mut duration_s = 0.0;
    for segment in &pair.segments {
        let mut from = segment.start;
        while from < segment.end {
            let until_s = pair.t_s[from] + PART_S;
            let own = rest[from..segment.end].iter().zip(&pair.t_s[from..]);
            let part = from..from + own.take_while(|(rests, t_s)| **rests && **t_s < until_s).count();
            from = part.end.max(from + 1);
            let lasts_s = pair.t_s[part.clone()].last().map_or(0.0, |last_s| last_s - pair.t_s[part.start]);
            let t_s = &pair.t_s[part.clone()];
            if lasts_s >= 0.5 * PART_S && part.len() >= FEWEST {
                let [came, asked] =
                    [&pair.measured, &pair.planned].map(|x| line(t_s, &x[part.clone()]).slope);
                parts.push(vec![came - asked]);
                duration_s += lasts_s;
            }
        }
    }
    let speed = parts.iter().flatten().sum::<f64>() / parts.len() as f64;
    let half = half_interval(&parts);
    let interval = half.map(|half| [speed - half, speed + half]);
    (!parts.is_empty()).then_some(RestDrift { speed, interval, duration_s })
}

#[cfg(test)]
mod tests {
    use crate::{
        replay::{Rules, replay},
        series::{Track, align},
    };

    /// What is told of a joint that goes so where its plan does.
    fn drift(plan: impl Fn(f64) -> f64, course: impl Fn(f64) -> f64) -> Option<f64> {
        let noise = |t: f64| 2e-5 * (1e3 * t * t).sin();
        let pair = align(
            &Track::sampled("lift", 12_000, plan),
            &Track::sampled("lift", 12_000, |t| course(t) + noise(t)),
        );
        let rules = Rules::default();
        let joint = replay(&[pair?], &rules).joints.into_iter().next()?;
        joint.rest_drift.filter(|drift| drift.counts(rules.sizes(joint.kind))).map(|drift| drift.speed)
    }

    #[test]
    fn a_load_that_sinks_drifts_and_slow_plans_and_swings_do_not() {
        let sinks = drift(|_| 0.5, |t| 0.5 - 1e-3 * t).unwrap();
        assert!((sinks + 1e-3).abs() < 1e-5, "{sinks}");
        let slow = |t: f64| 1e-3 * t.clamp(20.0, 90.0);
        assert_eq!(drift(slow, |t| slow(t - 4.0)), None, "a slow plan");
        let swings = |t: f64| 0.5 + 3e-3 * (std::f64::consts::TAU * 0.4 * t).sin();
        assert_eq!(drift(|_| 0.5, swings), None, "a joint that swings");
    }
}
