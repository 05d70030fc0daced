//! Smoothing on a regular grid.

/// Half window, samples.
const HALF: usize = 15;

/// Smooths by a local quadratic over 31 samples (Savitzky and Golay 1964, doi:10.1021/ac60214a047);
/// both ends are continued at their value.
pub(super) fn smooth(values: &[f64], out: &mut Vec<f64>) {
    out.clear();
    let (Some(&first), Some(&last)) = (values.first(), values.last()) else { return };
    let half = HALF as f64;
    // Even moments of the window -m..=m: the weights of the value at its middle are a parabola.
    let count = 2.0 * half + 1.0;
    let second = half * (half + 1.0) * count / 3.0;
    let fourth = second * (3.0 * half * half + 3.0 * half - 1.0) / 5.0;
    let determinant = count * fourth - second * second;
    let weight: [f64; HALF + 1] = std::array::from_fn(|i| {
        let square = (i * i) as f64;
        (fourth - second * square) / determinant
    });
    let at = |k: usize, back: usize, ahead: usize| {
        if back > k { first } else { values.get(k + ahead - back).copied().unwrap_or(last) }
    };
    for (k, value) in values.iter().enumerate() {
        let sides = (1..=HALF).map(|i| weight[i] * (at(k, i, 0) + at(k, 0, i)));
        out.push(weight[0] * value + sides.sum::<f64>());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_stays_one_and_noise_shrinks() {
        let parabola: Vec<f64> =
            (0..100).map(|k| 1.0 + 0.1 * f64::from(k) - 0.02 * f64::from(k * k)).collect();
        let mut out = Vec::new();
        smooth(&parabola, &mut out);
        for (found, expected) in out.iter().zip(&parabola).take(85).skip(15) {
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
        let noise: Vec<f64> = (0..100).map(|k| if k % 2 == 0 { 1.0 } else { -1.0 }).collect();
        smooth(&noise, &mut out);
        assert!(out.iter().take(85).skip(15).all(|x| x.abs() < 0.1));
    }
}
