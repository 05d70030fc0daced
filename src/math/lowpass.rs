//! Low-pass without delay: a second-order Butterworth filter, forward and then backward.

use std::f64::consts::{PI, SQRT_2};

/// Smooths `values`, one every `step_s`, in place; the gain at `cut_off_hz` is one half.
///
/// Both ends are continued at their value, so a constant stays what it is. A cut-off at or above a quarter
/// of the sampling rate leaves the values as they are.
pub fn lowpass(values: &mut [f64], cut_off_hz: f64, step_s: f64) {
    let share = cut_off_hz * step_s;
    if !(share > 0.0 && share < 0.25) {
        return;
    }
    // Bilinear transform with the cut-off where it is asked for.
    let k = (PI * share).tan();
    let scale = 1.0 / (1.0 + SQRT_2 * k + k * k);
    let filter =
        Filter { b: k * k * scale, a: [2.0 * (k * k - 1.0) * scale, (1.0 - SQRT_2 * k + k * k) * scale] };
    filter.run(values.iter_mut());
    filter.run(values.iter_mut().rev());
}

/// y = b (x + 2 x' + x'') - a0 y' - a1 y''.
struct Filter {
    b: f64,
    a: [f64; 2],
}

impl Filter {
    fn run<'a>(&self, mut values: impl Iterator<Item = &'a mut f64>) {
        let Some(first) = values.next() else { return };
        let (mut x, mut y) = ([*first; 2], [*first; 2]);
        for value in values {
            let out = self.b * (*value + 2.0 * x[0] + x[1]) - self.a[0] * y[0] - self.a[1] * y[1];
            x = [*value, x[0]];
            y = [out, y[0]];
            *value = out;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_S: f64 = 0.01;

    fn gain(frequency_hz: f64) -> (f64, f64) {
        let wave = |k: usize| (2.0 * PI * frequency_hz * k as f64 * STEP_S).sin();
        let mut values: Vec<f64> = (0..8000).map(wave).collect();
        lowpass(&mut values, 0.5, STEP_S);
        let (mut along, mut across) = (0.0, 0.0);
        for (k, value) in values.iter().enumerate().take(6000).skip(2000) {
            let phase = 2.0 * PI * frequency_hz * k as f64 * STEP_S;
            along += value * phase.sin() / 2000.0;
            across += value * phase.cos() / 2000.0;
        }
        (along, across)
    }

    #[test]
    fn the_gain_is_that_of_a_squared_butterworth_filter_and_there_is_no_delay() {
        for frequency_hz in [0.1, 0.25, 0.5, 1.0, 2.0] {
            let (along, across) = gain(frequency_hz);
            let expected = 1.0 / (1.0 + (frequency_hz / 0.5_f64).powi(4));
            assert!((along - expected).abs() < 2e-3, "{frequency_hz}: {along} {expected}");
            assert!(across.abs() < 2e-3, "{frequency_hz}: {across}");
        }
    }

    #[test]
    fn a_constant_stays_and_nothing_happens_beyond_the_rate() {
        let mut constant = vec![0.3; 50];
        lowpass(&mut constant, 0.5, STEP_S);
        assert!(constant.iter().all(|x| (x - 0.3).abs() < 1e-12));
        let mut values = vec![0.0, 1.0, 0.0];
        lowpass(&mut values, 30.0, STEP_S);
        assert!((values[1] - 1.0).abs() < 1e-15);
        lowpass(&mut [], 0.5, STEP_S);
    }
}
