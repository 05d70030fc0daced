//! The dead band of a valve from its signal and the motion that comes of it.

use super::Estimated;
use crate::{
    math::median,
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

/// Deviation of the logarithm by which the result misses on simulated machines.
const DISCREPANCY: f64 = 0.12;

/// Share of the full signal at which a joint begins to move, for growing and for shrinking angles:
/// where the line through slow speeds against earlier signals meets no speed.
///
/// `None` where a direction has too little slow motion.
pub(super) fn dead_band(valve: &Signal, measured: &Track) -> Option<[Estimated; 2]> {
    let (t_s, segments) = (measured.t_s(), measured.segments());
    let fits = local_quadratic(t_s, measured.position(), segments, WINDOW_S, 7);
    let one = |way: f64| -> Option<Estimated> {
        let slow = |fit: &LocalFit| {
            let speed = way * fit.velocity;
            speed > SLOW_RAD_S[0] && speed < SLOW_RAD_S[1] && fit.acceleration.abs() < EVEN_RAD_S2
        };
        let moving: Vec<(f64, f64)> = t_s
            .iter()
            .zip(&fits)
            .filter(|(_, fit)| slow(fit))
            .map(|(&t_s, fit)| (t_s, way * fit.velocity))
            .collect();
        let mut best: Option<(f64, f64)> = None;
        for step in 0..DELAYS {
            let delay_s = f64::from(step) * DELAY_STEP_S;
            let signals: Vec<(f64, f64)> = moving
                .iter()
                .filter_map(|(t_s, speed)| Some((*speed, way * valve.at(t_s - delay_s)?)))
                .collect();
            let Some((start, spread)) = line(&signals) else { continue };
            if best.is_none_or(|(_, least)| spread < least) {
                best = Some((start, spread));
            }
        }
        let (start, spread) = best.filter(|(start, _)| *start > 0.0)?;
        let deviation = DISCREPANCY.hypot(spread / start / 3.0);
        let reach = (1.96 * deviation).exp();
        Some(Estimated {
            value: Some(start),
            interval: Some([start / reach, start * reach]),
            identified: deviation < 0.3,
            ..Estimated::default()
        })
    };
    Some([one(1.0)?, one(-1.0)?])
}

/// Signal at no speed on the line through (speed, signal), and the median distance from the line.
fn line(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    if points.len() < SAMPLES {
        return None;
    }
    let count = points.len() as f64;
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    let (xx, xy) = (mean(&|p| (p.0 - x).powi(2)), mean(&|p| (p.0 - x) * (p.1 - y)));
    let slope = xy / xx;
    let start = y - slope * x;
    let spread = median(points.iter().map(|p| (p.1 - start - slope * p.0).abs()).collect());
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
        let found = dead_band(&valve, &measured).unwrap().map(|side| side.value.unwrap());
        assert!((found[0] - 0.1).abs() < 0.004 && (found[1] - 0.06).abs() < 0.004, "{found:?}");
    }
}
