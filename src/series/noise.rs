//! How much of a position signal is the sensor rather than the joint.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::math::{SIGMA_PER_MAD, dot, mad, median, whole};

/// Noise and step size of one position signal, in its unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Noise {
    /// Standard deviation of white noise on the position, at least that of rounding.
    pub sigma: f64,
    /// Step of the encoder where the signal shows one.
    pub lsb: Option<f64>,
}

/// Steps below this are rounding of numbers, not steps of a sensor, in rad or m. Single precision
/// near pi rounds to 2.4e-7.
const DUST: f64 = 2.5e-7;
/// More samples than this add no precision; longer signals are thinned evenly.
const ENOUGH: usize = 200_000;

/// Estimates noise from second differences over evenly spaced triples, which a smooth motion
/// leaves near zero, and the encoder's step from the smallest common change.
///
/// Arrays are `[n]`; nothing is differenced across the cuts between `segments`.
pub fn noise(t_s: &[f64], position: &[f64], segments: &[Range<usize>]) -> Noise {
    let lsb = lsb(position, segments);
    let floor = lsb.map_or(0.0, |lsb| lsb / 12.0_f64.sqrt());
    Noise { sigma: white(t_s, position, segments).max(floor), lsb }
}

/// Standard deviation of white noise alone: a plan at one speed has equal changes, which are no steps of a sensor.
pub(crate) fn white(t_s: &[f64], position: &[f64], segments: &[Range<usize>]) -> f64 {
    let curvature = second_differences(t_s, position, segments);
    if curvature.is_empty() { 0.0 } else { SIGMA_PER_MAD * mad(&curvature) / 6.0_f64.sqrt() }
}

/// Fewest samples of a window, and fewest windows, that tell how noise looks over it.
const FEWEST: usize = 5;
const WINDOWS: usize = 50;

/// Noise as a speed that is fitted over `window_s` sees it: the standard deviation of white noise that leaves as much of a cubic in
/// windows of this length, s, with samples that are usually so far apart, s, of which a smooth motion leaves next to nothing. More than [`white`] where neighbouring samples are
/// alike, as behind a filter; and its standard error as a share of it. `None` of too few windows of evenly spaced samples.
pub(crate) fn over_window(
    t_s: &[f64],
    position: &[f64],
    segments: &[Range<usize>],
    (window_s, usual_s): (f64, f64),
) -> Option<(f64, f64)> {
    /// Of a robust standard deviation of one normal number, as a share of it.
    const ERROR: f64 = 1.17;
    let cubic = cubic(whole((window_s / usual_s).clamp(0.0, 1e4).round()) + 1)?;
    let even = |at: usize| {
        let span_s = t_s[at + cubic.len() - 1] - t_s[at];
        (span_s / usual_s / (cubic.len() - 1) as f64 - 1.0).abs() <= 0.1
    };
    let stride = cubic.len() * (t_s.len() / ENOUGH + 1);
    let starts =
        segments.iter().flat_map(|s| (s.start..(s.end + 1).saturating_sub(cubic.len())).step_by(stride));
    let left: Vec<f64> = starts.filter(|at| even(*at)).map(|at| dot(&cubic, &position[at..])).collect();
    (left.len() >= WINDOWS).then(|| (SIGMA_PER_MAD * mad(&left), ERROR / (left.len() as f64).sqrt()))
}

/// The cubic over evenly spaced samples that holds nothing of a parabola, of norm 1; `None` of fewer than five.
fn cubic(count: usize) -> Option<Vec<f64>> {
    let at = |k: usize| 2.0 * k as f64 - (count.max(1) - 1) as f64;
    let [second, fourth] = [2, 4].map(|power| (0..count).map(|k| at(k).powi(power)).sum::<f64>());
    // What is odd holds nothing of what is even.
    let odd = (0..count).map(|k| at(k).powi(3) - fourth / second * at(k));
    let norm = odd.clone().map(|x| x * x).sum::<f64>().sqrt();
    (count >= FEWEST).then(|| odd.map(|x| x / norm).collect())
}

/// Whether a signal is one of a sensor: hardly a value repeats the one before, and its second differences change their sign
/// as white noise has it (73 %), which a smooth motion does not.
pub(crate) fn is_sensed(position: &[f64], segments: &[Range<usize>]) -> bool {
    let changes =
        |s: &Range<usize>| -> Vec<f64> { position[s.clone()].windows(2).map(|x| x[1] - x[0]).collect() };
    let (mut steps, mut still, mut bends, mut turns) = (0_u64, 0_u64, 0_u64, 0_u64);
    for changes in segments.iter().map(changes) {
        steps += changes.len() as u64;
        still += changes.iter().filter(|change| change.abs() <= 0.0).count() as u64;
        let bent: Vec<f64> = changes.windows(2).map(|x| x[1] - x[0]).collect();
        bends += bent.len() as u64;
        turns += bent.windows(2).filter(|x| x[0] * x[1] < 0.0).count() as u64;
    }
    50 * still < steps && 10 * turns > 6 * bends
}

fn second_differences(t_s: &[f64], x: &[f64], segments: &[Range<usize>]) -> Vec<f64> {
    let stride = t_s.len() / ENOUGH + 1;
    let centres = || segments.iter().flat_map(|s| (s.start + 1..s.end.saturating_sub(1)).step_by(stride));
    let usual_s = median(centres().map(|i| t_s[i] - t_s[i - 1]).collect());
    let even = |span_s: f64| (span_s - usual_s).abs() <= 0.2 * usual_s;
    let regular = |&i: &usize| even(t_s[i] - t_s[i - 1]) && even(t_s[i + 1] - t_s[i]);
    centres().filter(regular).map(|i| x[i + 1] - 2.0 * x[i] + x[i - 1]).collect()
}

fn lsb(x: &[f64], segments: &[Range<usize>]) -> Option<f64> {
    let stride = x.len() / ENOUGH + 1;
    let pairs = segments.iter().flat_map(|s| (s.start + 1..s.end).step_by(stride));
    let steps: Vec<f64> = pairs.map(|i| (x[i] - x[i - 1]).abs()).collect();
    let mut moved: Vec<f64> = steps.iter().copied().filter(|&step| step > DUST).collect();
    if moved.len() < 20 {
        return None;
    }
    moved.sort_unstable_by(f64::total_cmp);
    let lsb = moved[moved.len() / 20];
    // A step many times larger is a multiple of anything.
    let small: Vec<f64> = moved.iter().map(|step| step / lsb).filter(|&ratio| ratio < 20.5).collect();
    let multiples = small.iter().filter(|ratio| (*ratio - ratio.round()).abs() < 0.1).count();
    let (multiples, held) =
        (multiples as f64 / small.len() as f64, 1.0 - moved.len() as f64 / steps.len() as f64);
    (small.len() >= 20 && (multiples > 0.9 || (held > 0.5 && multiples > 0.5))).then_some(lsb)
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, Normal};

    use super::*;
    use crate::rng::{Stream, stream};

    const SIGMA_RAD: f64 = 2e-4;

    fn swing(lsb: f64) -> (Vec<f64>, Vec<f64>) {
        let mut rng = stream(1, Stream::SensorNoise);
        let white = Normal::new(0.0, SIGMA_RAD).unwrap();
        let t_s: Vec<f64> = (0..4000).map(|k| f64::from(k) * 0.01).collect();
        let round = |x: f64| if lsb > 0.0 { (x / lsb).round() * lsb } else { x };
        let x = t_s.iter().map(|t| round((0.5 * t).sin() + white.sample(&mut rng))).collect();
        (t_s, x)
    }

    #[test]
    fn noise_on_a_swing_is_found_to_a_twentieth() {
        let (t_s, x) = swing(0.0);
        let found = noise(&t_s, &x, std::slice::from_ref(&(0..4000)));
        assert!((found.sigma / SIGMA_RAD - 1.0).abs() < 0.05, "{found:?}");
        assert_eq!(found.lsb, None);
    }

    #[test]
    fn a_coarse_encoder_shows_its_step_and_counts_as_noise() {
        let (t_s, x) = swing(1e-3);
        let found = noise(&t_s, &x, std::slice::from_ref(&(0..4000)));
        assert!((found.lsb.unwrap() / 1e-3 - 1.0).abs() < 1e-6, "{found:?}");
        assert!(found.sigma >= 1e-3 / 12.0_f64.sqrt());
    }

    #[test]
    fn behind_a_filter_a_window_sees_the_noise_that_went_into_it() {
        let whole = std::slice::from_ref(&(0..3980));
        let (t_s, x) = swing(0.0);
        let (t_s, white_x) = (&t_s[..3980], &x[..3980]);
        let filtered: Vec<f64> = x.windows(10).take(3980).map(|ten| ten.iter().sum::<f64>() / 10.0).collect();
        let of = |x: &[f64]| over_window(t_s, x, whole, (0.3, 0.01)).unwrap().0 / SIGMA_RAD;
        let [plain, behind] = [of(white_x), of(&filtered)];
        assert!((plain - 1.0).abs() < 0.15, "{plain}");
        assert!((0.5..1.1).contains(&behind), "{behind}");
        assert!(white(t_s, &filtered, whole) < 0.3 * SIGMA_RAD);
        let few = std::slice::from_ref(&(0..40));
        assert_eq!(over_window(&t_s[..40], &x[..40], few, (0.3, 0.01)), None);
    }

    #[test]
    fn a_jump_at_a_cut_is_no_noise() {
        let t_s: Vec<f64> = (0..40).map(f64::from).collect();
        let x: Vec<f64> = (0..40).map(|k| if k < 20 { 0.0 } else { 9.0 }).collect();
        assert_eq!(noise(&t_s, &x, &[0..20, 20..40]), Noise { sigma: 0.0, lsb: None });
    }
}
