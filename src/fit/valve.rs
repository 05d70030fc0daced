//! The dead band of a valve from its signal and the motion that comes of it.

use super::Estimated;
use crate::{
    math::{jackknife, median},
    series::{LocalFit, Signal, Track, local_quadratic},
    units::DEGREE_RAD,
};

/// Half window of the measured speed, s.
const WINDOW_S: f64 = 0.12;

/// Speeds at which the signal is little more than the dead band, rad/s.
const SLOW_RAD_S: [f64; 2] = [0.2 * DEGREE_RAD, 3.0 * DEGREE_RAD];

/// Accelerations above this are those of starts and stops, whose speed lags, rad/s².
const EVEN_RAD_S2: f64 = 6.0 * DEGREE_RAD;

/// Delays of the motion behind the signal that are tried, steps of this, s.
const DELAY_STEP_S: f64 = 0.02;

/// Number of delays tried.
const DELAYS: u32 = 35;

/// Fewest samples for a direction.
const SAMPLES: usize = 60;

/// Speeds and earlier signals of a slow motion.
type Motion = Vec<(f64, f64)>;

/// Slow motion after a longer pause is another motion, s.
const APART_S: f64 = 0.5;

/// Half a 95 % interval by its standard deviation.
const NORMAL: f64 = 1.96;

/// A number that is known no better has no interval: deviation of its logarithm.
const TOO_VAGUE: f64 = 2.0;

/// Rounds in which the weights of points settle, and the distance by the median one from which they fall.
const ROUNDS: usize = 10;
const FAR: f64 = 2.0;

/// Deviation of the logarithm by which the result misses on simulated machines.
const DISCREPANCY: f64 = 0.12;

/// Share of the full signal at which a joint begins to move, for growing and for shrinking angles:
/// where the line through slow speeds against earlier signals of all logs meets no speed.
///
/// A direction that has too little slow motion has no value; `None` where both have none.
pub(super) fn dead_band(logs: &[(&Signal, &Track)]) -> Option<[Estimated; 2]> {
    let fits: Vec<Vec<LocalFit>> = logs
        .iter()
        .map(|(_, track)| local_quadratic(track.t_s(), track.position(), track.segments(), WINDOW_S, 7))
        .collect();
    let one = |way: f64| -> Option<Estimated> {
        let slow = |fit: &LocalFit| {
            let speed = way * fit.velocity;
            speed > SLOW_RAD_S[0] && speed < SLOW_RAD_S[1] && fit.acceleration.abs() < EVEN_RAD_S2
        };
        // Instants and speeds of each slow motion, with the signal of its log.
        let mut motions: Vec<(&Signal, Motion)> = Vec::new();
        for ((valve, measured), fits) in logs.iter().zip(&fits) {
            let moving = measured.t_s().iter().zip(fits).filter(|(_, fit)| slow(fit));
            let moving: Vec<(f64, f64)> = moving.map(|(&t_s, fit)| (t_s, way * fit.velocity)).collect();
            let apart = moving.chunk_by(|a, b| b.0 - a.0 < APART_S);
            motions.extend(apart.map(|motion| (*valve, motion.to_vec())));
        }
        let mut best: Option<(f64, f64, Vec<Motion>)> = None;
        for step in 0..DELAYS {
            let delay_s = f64::from(step) * DELAY_STEP_S;
            let signals = |(valve, motion): &(&Signal, Motion)| -> Motion {
                let signal = |(t_s, speed): &(f64, f64)| Some((*speed, way * valve.at(t_s - delay_s)?));
                motion.iter().filter_map(signal).collect()
            };
            let signals: Vec<Motion> = motions.iter().map(signals).collect();
            let Some((start, spread)) = line(&signals.concat(), SAMPLES) else { continue };
            if best.as_ref().is_none_or(|(_, least, _)| spread < *least) {
                best = Some((start, spread, signals));
            }
        }
        let (start, _, signals) = best.filter(|(start, ..)| *start > 0.0)?;
        let deviation = DISCREPANCY.hypot(scatter(&signals) / start);
        let reach = (NORMAL * deviation).exp();
        Some(Estimated {
            value: Some(start),
            interval: (deviation < TOO_VAGUE).then_some([start / reach, start * reach]),
            identified: deviation < 0.3,
            ..Estimated::default()
        })
    };
    let both = [one(1.0), one(-1.0)];
    both.iter().any(Option::is_some).then(|| both.map(Option::unwrap_or_default))
}

/// Standard deviation of the line's start by leaving out each motion, whose samples tell of one another; infinite of too few.
fn scatter(motions: &[Motion]) -> f64 {
    let without = |out: usize| {
        let rest = motions.iter().enumerate().filter(|(k, _)| *k != out);
        Some(line(&rest.flat_map(|(_, motion)| motion.iter().copied()).collect::<Vec<_>>(), SAMPLES / 3)?.0)
    };
    let starts: Option<Vec<f64>> = (0..motions.len()).map(without).collect();
    starts.and_then(|starts| jackknife(&starts)).map_or(f64::INFINITY, |half| half / NORMAL)
}

/// Signal at no speed on the line through (speed, signal), and the median distance from the line, to which what lies far off counts
/// little; `None` of fewer points.
fn line(points: &[(f64, f64)], fewest: usize) -> Option<(f64, f64)> {
    if points.len() < fewest {
        return None;
    }
    let mut weights = vec![1.0; points.len()];
    let (mut start, mut spread) = (f64::NAN, f64::NAN);
    for _ in 0..ROUNDS {
        let count = weights.iter().sum::<f64>();
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| {
            points.iter().zip(&weights).map(|(point, weight)| weight * of(point)).sum::<f64>() / count
        };
        let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
        let (xx, xy) = (mean(&|p| (p.0 - x).powi(2)), mean(&|p| (p.0 - x) * (p.1 - y)));
        let slope = xy / xx;
        start = y - slope * x;
        let off: Vec<f64> = points.iter().map(|p| (p.1 - start - slope * p.0).abs()).collect();
        spread = median(off.clone());
        for (weight, off) in weights.iter_mut().zip(off) {
            *weight = (FAR * spread.max(f64::MIN_POSITIVE) / off.max(f64::MIN_POSITIVE)).min(1.0).powi(2);
        }
    }
    (start.is_finite() && spread.is_finite()).then_some((start, spread))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::series::Quantity;

    #[test]
    fn a_valve_that_opens_late_on_one_side_is_found_out() {
        let t_s: Vec<f64> = (0..3000).map(|k| f64::from(k) * 0.01).collect();
        let signal: Vec<f64> = t_s.iter().map(|t| 0.2 * (0.5 * t).sin()).collect();
        let mut angle = 0.0;
        let position: Vec<f64> = (0..t_s.len())
            .map(|k| {
                let late = signal[k.saturating_sub(20)];
                angle += 0.01 * 0.3 * ((late - 0.1).max(0.0) + (late + 0.06).min(0.0));
                angle
            })
            .collect();
        let valve = Signal::new("a", Quantity::Share, t_s.clone(), signal, &[]).unwrap();
        let measured = Track::new("a", t_s, position, &[]).unwrap();
        let found = dead_band(&[(&valve, &measured)]).unwrap().map(|side| side.value.unwrap());
        assert!((found[0] - 0.1).abs() < 0.004 && (found[1] - 0.06).abs() < 0.004, "{found:?}");
    }
}
