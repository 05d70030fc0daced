//! MW1 to MW4: constraints that leave parts of the region.
//!
//! # References
//!
//! Ma and Wang 2019, doi 10.1109/TEVC.2019.2896967.

use std::f64::consts::{PI, SQRT_2};

/// Variables of each of the problems.
pub(super) const VARIABLES: usize = 15;
/// Evenly spaced first objectives at which the front is looked for, for each point of it that is wanted.
const FINE: usize = 20;
/// Distances beyond the unconstrained front at which a feasible point is looked for, and the step between them.
const STEPS: u32 = 1000;
const STEP: f64 = 1e-3;

/// Objectives of the problem `number` at `x`, and the total by which its constraints are violated.
pub(super) fn evaluate(number: u8, x: &[f64], f: &mut [f64]) -> f64 {
    let m = f.len();
    let g = match number {
        1 | 4 => dents(x, m),
        2 => waves(x, m),
        _ => chain(x, m),
    };
    shape(number, x, g, f);
    violation(number, f)
}

/// Variables from the m-th on, each with its number less one.
fn distances(x: &[f64], m: usize) -> impl Iterator<Item = (f64, f64)> {
    x.iter().enumerate().skip(m - 1).map(|(i, &x)| (x, i as f64))
}

fn dents(x: &[f64], m: usize) -> f64 {
    let n = x.len() as f64;
    let power = n - m as f64;
    let dent = |(x, i): (f64, f64)| 1.0 - (-10.0 * (x.powf(power) - 0.5 - i / (2.0 * n)).powi(2)).exp();
    1.0 + distances(x, m).map(dent).sum::<f64>()
}

fn waves(x: &[f64], m: usize) -> f64 {
    let n = x.len() as f64;
    let wave = |(x, i): (f64, f64)| {
        let z = 1.0 - (-10.0 * (x - i / n).powi(2)).exp();
        1.5 + 0.1 / n * z * z - 1.5 * (2.0 * PI * z).cos()
    };
    1.0 + distances(x, m).map(wave).sum::<f64>()
}

fn chain(x: &[f64], m: usize) -> f64 {
    let links = x.windows(2).skip(m - 2);
    1.0 + links.map(|x| 2.0 * (x[1] + (x[0] - 0.5).powi(2) - 1.0).powi(2)).sum::<f64>()
}

/// Objectives at a position, `g` from 1 being the distance.
fn shape(number: u8, position: &[f64], g: f64, f: &mut [f64]) {
    if number == 4 {
        let m = f.len();
        let mut product = g;
        for k in 0..m - 1 {
            f[m - 1 - k] = product * position[k];
            product *= 1.0 - position[k];
        }
        f[0] = product;
        return;
    }
    let slope = if number == 1 { 0.85 } else { 1.0 };
    (f[0], f[1]) = (position[0], g - slope * position[0]);
}

fn violation(number: u8, f: &[f64]) -> f64 {
    let (sum, last) = (f.iter().sum::<f64>(), f[f.len() - 1]);
    let wave = |size: f64, waves: f64, power: i32, along: f64| size * (waves * PI * along).sin().powi(power);
    let along = SQRT_2 * (last - f[0]);
    match number {
        1 => (sum - 1.0 - wave(0.5, 2.0, 8, along)).max(0.0),
        2 => (sum - 1.0 - wave(0.5, 3.0, 8, along)).max(0.0),
        3 => {
            let above = (sum - 1.05 - wave(0.45, 0.75, 6, along)).max(0.0);
            above + (0.85 + wave(0.3, 0.75, 2, along) - sum).max(0.0)
        }
        _ => (sum - 1.0 - wave(0.4, 2.5, 8, last - (sum - last))).max(0.0),
    }
}

/// Points of the front of MW1 to MW3, many for each of `count`: at each first objective the least feasible second one,
/// where it is less than all before.
pub(super) fn curve(number: u8, count: usize) -> Vec<f64> {
    let at = |first: f64, step: f64| {
        let mut f = [0.0; 2];
        shape(number, &[first], 1.0 + step, &mut f);
        (violation(number, &f) <= 0.0).then_some(f)
    };
    let (mut flat, mut least) = (Vec::new(), f64::INFINITY);
    let fine = FINE * count.max(2);
    for first in (0..=fine).map(|i| i as f64 / fine as f64) {
        let mut steps = (0..=STEPS).map(|k| f64::from(k) * STEP);
        let Some(mut feasible) = steps.find(|&step| at(first, step).is_some()) else { continue };
        let mut infeasible = (feasible - STEP).max(0.0);
        for _ in 0..30 {
            let half = 0.5 * (feasible + infeasible);
            *(if at(first, half).is_some() { &mut feasible } else { &mut infeasible }) = half;
        }
        if let Some(f) = at(first, feasible).filter(|f| f[1] < least && f[1] >= 0.0) {
            least = f[1];
            flat.extend(f);
        }
    }
    flat
}
