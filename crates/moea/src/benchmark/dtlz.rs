//! DTLZ1 to DTLZ7.
//!
//! # References
//!
//! Deb, Thiele, Laumanns and Zitzler 2005, doi 10.1007/1-84628-137-7_6.

use std::f64::consts::{FRAC_PI_2, PI};

/// Objectives of the problem `number` at `x`; the last `x.len() - m + 1` variables measure the
/// distance to the front.
pub(super) fn evaluate(number: u8, x: &[f64], f: &mut [f64]) {
    let m = f.len();
    let (position, distance) = x.split_at(m - 1);
    match number {
        1 => {
            let scale = 0.5 * (1.0 + rastrigin(distance));
            linear(position, scale, f);
        }
        2 => sphere(position, 1.0 + offset(distance), f, |x| x * FRAC_PI_2),
        3 => sphere(position, 1.0 + rastrigin(distance), f, |x| x * FRAC_PI_2),
        4 => sphere(position, 1.0 + offset(distance), f, |x| x.powi(100) * FRAC_PI_2),
        5 => curve(position, offset(distance), f),
        6 => curve(position, distance.iter().map(|x| x.powf(0.1)).sum(), f),
        _ => disconnected(position, distance, f),
    }
}

fn offset(distance: &[f64]) -> f64 {
    distance.iter().map(|x| (x - 0.5) * (x - 0.5)).sum()
}

fn rastrigin(distance: &[f64]) -> f64 {
    let waves: f64 = distance.iter().map(|x| (x - 0.5).powi(2) - (20.0 * PI * (x - 0.5)).cos()).sum();
    100.0 * (distance.len() as f64 + waves)
}

fn linear(position: &[f64], scale: f64, f: &mut [f64]) {
    let m = f.len();
    let mut product = scale;
    for (k, &x) in position.iter().enumerate() {
        f[m - 1 - k] = product * (1.0 - x);
        product *= x;
    }
    f[0] = product;
}

fn sphere(position: &[f64], radius: f64, f: &mut [f64], angle: impl Fn(f64) -> f64) {
    let m = f.len();
    let mut product = radius;
    for (k, &x) in position.iter().enumerate() {
        let (sin, cos) = angle(x).sin_cos();
        f[m - 1 - k] = product * sin;
        product *= cos;
    }
    f[0] = product;
}

/// DTLZ5 and 6: all angles but the first depend on the distance.
fn curve(position: &[f64], g: f64, f: &mut [f64]) {
    let m = f.len();
    let mut product = 1.0 + g;
    for (k, &x) in position.iter().enumerate() {
        let angle = if k == 0 { x * FRAC_PI_2 } else { PI / (4.0 * (1.0 + g)) * (1.0 + 2.0 * g * x) };
        let (sin, cos) = angle.sin_cos();
        f[m - 1 - k] = product * sin;
        product *= cos;
    }
    f[0] = product;
}

fn disconnected(position: &[f64], distance: &[f64], f: &mut [f64]) {
    let g = 1.0 + 9.0 * distance.iter().sum::<f64>() / distance.len() as f64;
    let m = f.len();
    f[..m - 1].copy_from_slice(position);
    let sum: f64 = position.iter().map(|x| x / (1.0 + g) * (1.0 + (3.0 * PI * x).sin())).sum();
    f[m - 1] = (1.0 + g) * (m as f64 - sum);
}
