//! Tells signals to valves, and set speeds, from set positions: the joint's speed goes with them, and its position does not.

use crate::{math::range, units::seconds_since};

/// Steps that rows are compared in, s; so many at most, from the first on, and fewer tell nothing.
const STEP_S: f64 = 0.05;
const MOST: usize = 20_000;
const LEAST: usize = 200;

/// A speed is taken over so many steps to either side.
const HALF: usize = 2;

/// A joint answers its valve within so many steps.
const LATEST: usize = 10;

/// Correlation of the speed with what was sent, from which on it goes with it.
const WITH_SPEED: f64 = 0.7;
/// Correlation of the position with what was sent, from which on it may be a set position.
const WITH_POSITION: f64 = 0.5;
/// A set position may be followed so many steps late; a speed goes with what was sent only if its correlation is larger than
/// that of a late position by so much.
const LATEST_POSITION: usize = 40;
const CLEARER: f64 = 0.05;

/// A joint that travels so many times as far as what was sent to it, and is never within this share of its travel of that, was sent
/// no positions.
const FARTHER: f64 = 8.0;
const NEAR: f64 = 0.25;

/// How far a joint travelled, where that and its distance from what was sent say that these are no positions. All `[rows]`.
pub(super) fn is_elsewhere(sent: &[f64], came: &[f64]) -> Option<f64> {
    let span = |values: &[f64]| {
        let known = values.iter().filter(|value| value.is_finite());
        let [low, high] = range(known.copied());
        high - low
    };
    let (travel, span) = (span(came), span(sent));
    let apart = sent.iter().zip(came).map(|(sent, came)| (sent - came).abs());
    let nearest = apart.filter(|apart| apart.is_finite()).fold(f64::INFINITY, f64::min);
    (travel > 0.0 && travel > FARTHER * span && nearest.is_finite() && nearest > NEAR * travel)
        .then_some(travel)
}

/// How the motion of a joint correlates with what was sent to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Goes {
    /// Its speed, at the best delay.
    pub(super) speed: f64,
    /// Its position.
    pub(super) position: f64,
}

/// `Some` where a joint's speed goes with what was sent, and its position does not. All `[rows]`; rows without a number
/// keep the one before.
pub(super) fn moves_the_speed(stamp_ns: &[i64], sent: &[f64], came: &[f64]) -> Option<Goes> {
    let (sent, came) = (in_steps(stamp_ns, sent), in_steps(stamp_ns, came));
    if sent.len() < LEAST || came.len() != sent.len() {
        return None;
    }
    let speed: Vec<f64> = came.windows(2 * HALF + 1).map(|w| w[2 * HALF] - w[0]).collect();
    let position = correlation(&sent, &came)?;
    let delayed = |by: usize| correlation(&sent[HALF..sent.len() - HALF - by], &speed[by..]);
    let best = (0..=LATEST).filter_map(delayed).max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    let late = (1..=LATEST_POSITION).filter_map(|by| correlation(&sent[..sent.len() - by], &came[by..]));
    let followed = late.map(f64::abs).fold(position.abs(), f64::max);
    let is = best.abs() >= WITH_SPEED.max(followed + CLEARER) && position.abs() < WITH_POSITION;
    is.then_some(Goes { speed: best, position })
}

/// The numbers of rows at even steps; from the first row that has one.
fn in_steps(stamp_ns: &[i64], values: &[f64]) -> Vec<f64> {
    let Some(&first_ns) = stamp_ns.first() else { return Vec::new() };
    let mut steps = Vec::new();
    let mut held = values.iter().copied().find(|value| value.is_finite()).unwrap_or(f64::NAN);
    for (&ns, &value) in stamp_ns.iter().zip(values) {
        while steps.len() < MOST && seconds_since(first_ns, ns) > STEP_S * steps.len() as f64 {
            steps.push(held);
        }
        if value.is_finite() {
            held = value;
        }
    }
    steps
}

/// `None` where one of both stands still.
fn correlation(a: &[f64], b: &[f64]) -> Option<f64> {
    let n = a.len().min(b.len()) as f64;
    let mean = |values: &[f64]| values.iter().take(a.len().min(b.len())).sum::<f64>() / n;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let (mut squares_a, mut squares_b, mut products) = (0.0, 0.0, 0.0);
    for (a, b) in a.iter().zip(b) {
        let (a, b) = (a - mean_a, b - mean_b);
        (squares_a, squares_b, products) = (squares_a + a * a, squares_b + b * b, products + a * b);
    }
    Some(products / (squares_a * squares_b).sqrt()).filter(|r| r.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of 60 s at 20 Hz of what was sent and where a joint was.
    fn goes(sent: impl Fn(f64) -> f64, came: impl Fn(f64) -> f64) -> Option<Goes> {
        let t_s: Vec<f64> = (0..1200).map(|k| 0.05 * f64::from(k)).collect();
        let stamp_ns: Vec<i64> = (0..1200).map(|k| k * 50_000_000).collect();
        let of = |value: &dyn Fn(f64) -> f64| t_s.iter().map(|t_s| value(*t_s)).collect::<Vec<f64>>();
        moves_the_speed(&stamp_ns, &of(&sent), &of(&came))
    }

    #[test]
    fn what_hardly_changes_far_from_a_joint_that_travels_is_no_set_position() {
        let travels: Vec<f64> = (0..150).map(|k| 48.0 + 0.3 * f64::from(k)).collect();
        let duty: Vec<f64> = (0..150).map(|k| if k > 40 { 4.9 } else { 8.9 }).collect();
        assert!(is_elsewhere(&duty, &travels).is_some());
        // A joint that sinks from its set value, one that hunts about it, and one that stands.
        assert_eq!(is_elsewhere(&[48.0; 150], &travels), None);
        let hunts: Vec<f64> = (0..150).map(|k| 8.9 + f64::from(k % 3) - 1.0).collect();
        assert_eq!(is_elsewhere(&[8.9; 150], &hunts), None);
        assert_eq!(is_elsewhere(&duty, &[48.0; 150]), None);
    }

    #[test]
    fn a_valve_moves_the_speed_and_a_set_position_the_position() {
        let wave = |t: f64| 20.0 * (0.7 * t).sin() + 9.0 * (1.9 * t).cos();
        let slope = |t: f64| 14.0 * (0.7 * t).cos() - 17.1 * (1.9 * t).sin();
        for (name, valve) in [
            ("percent", (&|t: f64| 3.0 * slope(t)) as &dyn Fn(f64) -> f64),
            ("duty about a middle", &|t| 7.5 + 0.02 * slope(t)),
            ("the other way round, 0.2 s early", &|t| -0.1 * slope(t + 0.2)),
        ] {
            let found = goes(valve, wave).unwrap();
            assert!(found.speed.abs() > 0.9 && found.position.abs() < 0.2, "{name}: {found:?}");
        }
        for (name, set) in [
            ("itself", (&|t: f64| wave(t)) as &dyn Fn(f64) -> f64),
            ("0.4 s before", &|t| wave(t + 0.4)),
            ("in another unit", &|t| 0.0175 * wave(t)),
            ("of another joint", &|t| (2.9 * t).sin()),
            ("nothing", &|_| 0.0),
        ] {
            assert_eq!(goes(set, wave), None, "{name}");
        }
        // A sine that is followed a quarter of its period late.
        assert_eq!(goes(|t| 9.0 * (2.0 * t).sin(), |t| -9.0 * (2.0 * t).cos()), None);
    }
}
