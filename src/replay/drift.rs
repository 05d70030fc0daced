//! How fast a joint moves while its plan rests: a load that sinks, a cylinder that leaks, a loop that does not hold.

use std::ops::Range;

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
/// A drift that goes on is in the later halves of rests this much of what it is in the first, at least.
const SLOWS: f64 = 0.5;

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
    /// Whether it is more than scatter and in all moves the joint by more than the band of settling. Joints are many:
    /// it must be larger than its whole interval is wide.
    pub fn counts(&self, sizes: &Sizes) -> bool {
        let sure = self.interval.is_some_and(|[low, high]| self.speed.abs() > high - low);
        sure && (self.speed * self.duration_s).abs() >= sizes.settle_band
    }
}

/// The drift of a joint whose plan rests in some samples; `None` where no rest is long enough. A joint that comes to rest slows
/// down: where it does, its drift is that of the later halves of the rests.
pub(super) fn rest_drift(pair: &Pair, rest: &[bool]) -> Option<RestDrift> {
    let rests: Vec<Vec<Part>> = pair.segments.iter().flat_map(|s| rests(pair, rest, s.clone())).collect();
    let halves = |of: fn(&[Part]) -> &[Part]| -> Vec<Vec<Part>> {
        rests.iter().filter(|parts| parts.len() > 1).map(|parts| of(parts).to_vec()).collect()
    };
    let first = halves(|parts| &parts[..parts.len() / 2]).concat();
    let later = halves(|parts| &parts[parts.len().div_ceil(2)..]);
    let slows = !first.is_empty() && mean(&later.concat()).abs() < SLOWS * mean(&first).abs();
    let rests = if slows { later } else { rests };
    let parts = rests.concat();
    let speed = mean(&parts);
    let half = half_interval(&parts.iter().map(|part| vec![part.speed]).collect::<Vec<_>>());
    // A swing may begin each part alike; what drifts is elsewhere in the next one.
    let between = between(&rests).unwrap_or(speed);
    let interval = half.map(|half| [between.min(speed - half), between.max(speed + half)]);
    let duration_s = parts.iter().map(|part| part.lasts_s).sum();
    (!parts.is_empty()).then_some(RestDrift { speed, interval, duration_s })
}

/// What a joint does while its plan rests, of one part of a rest.
#[derive(Debug, Clone, Copy)]
struct Part {
    speed: f64,
    lasts_s: f64,
    /// Mean of the joint less its plan, and of its instants, s.
    off: f64,
    at_s: f64,
}

/// The speed from the first to the last part of the rests that have several.
fn between(rests: &[Vec<Part>]) -> Option<f64> {
    let ends =
        rests.iter().filter(|parts| parts.len() > 1).filter_map(|parts| parts.first().zip(parts.last()));
    let (way, time_s) = ends.fold((0.0, 0.0), |(way, time_s), (first, last)| {
        (way + last.off - first.off, time_s + last.at_s - first.at_s)
    });
    (time_s > 0.0).then(|| way / time_s)
}

fn mean(parts: &[Part]) -> f64 {
    parts.iter().map(|part| part.speed).sum::<f64>() / parts.len() as f64
}

/// The parts of each rest within a segment.
fn rests(pair: &Pair, rest: &[bool], segment: Range<usize>) -> Vec<Vec<Part>> {
    let mut rests = vec![Vec::new()];
    let mut from = segment.start;
    while from < segment.end {
        let until_s = pair.t_s[from] + PART_S;
        let own = rest[from..segment.end].iter().zip(&pair.t_s[from..]);
        let part = from..from + own.take_while(|(rests, t_s)| **rests && **t_s < until_s).count();
        if part.is_empty() {
            rests.push(Vec::new());
        }
        from = part.end.max(from + 1);
        let t_s = &pair.t_s[part.clone()];
        let lasts_s = t_s.last().map_or(0.0, |last_s| last_s - t_s[0]);
        if lasts_s >= 0.5 * PART_S && part.len() >= FEWEST {
            let [came, asked] = [&pair.measured, &pair.planned].map(|x| line(t_s, &x[part.clone()]).slope);
            let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len() as f64;
            let off = mean(&pair.measured[part.clone()]) - mean(&pair.planned[part.clone()]);
            let own = Part { speed: came - asked, lasts_s, off, at_s: mean(t_s) };
            if let Some(parts) = rests.last_mut() {
                parts.push(own);
            }
        }
    }
    rests
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
        let alike = |t: f64| 0.5 + 5e-3 * (std::f64::consts::TAU * t).sin();
        assert_eq!(drift(|_| 0.5, alike), None, "a joint that swings as often as parts begin");
        let comes = |t: f64| 0.5 - 0.02 * (-t / 6.0).exp();
        assert_eq!(drift(|_| 0.5, comes), None, "a joint that comes to rest");
    }
}
