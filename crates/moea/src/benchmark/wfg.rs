//! WFG1 to WFG9.
//!
//! # References
//!
//! Huband, Hingston, Barone and While 2006, doi 10.1109/TEVC.2005.861417; the names of
//! transformations and shapes are theirs.

use std::f64::consts::{FRAC_PI_2, PI};

/// Objectives of the problem `number` at `z`, variable i (from 1) in 0 to 2i, the first `k` of
/// them positions. `y` is scratch memory.
pub(super) fn evaluate(number: u8, k: usize, z: &[f64], f: &mut [f64], y: &mut Vec<f64>) {
    y.clear();
    y.extend(z.iter().enumerate().map(|(i, z)| unit(z / (2.0 * (i as f64 + 1.0)))));
    match number {
        1 => {
            shift_linear(y, k);
            for v in &mut y[k..] {
                *v = b_flat(*v, 0.8, 0.75, 0.85);
            }
            for v in y.iter_mut() {
                *v = unit(v.powf(0.02));
            }
            reduce(y, k, f, |group, first| {
                r_sum(group.iter().enumerate().map(|(i, &v)| (v, 2.0 * (first + i) as f64 + 2.0)))
            });
        }
        2 | 3 => {
            shift_linear(y, k);
            let pairs = (y.len() - k) / 2;
            for i in 0..pairs {
                y[k + i] = r_nonsep_pair(y[k + 2 * i], y[k + 2 * i + 1]);
            }
            y.truncate(k + pairs);
            reduce(y, k, f, |group, _| mean(group));
        }
        4 => {
            for v in y.iter_mut() {
                *v = s_multi(*v, 30.0, 10.0, 0.35);
            }
            reduce(y, k, f, |group, _| mean(group));
        }
        5 => {
            for v in y.iter_mut() {
                *v = s_decept(*v, 0.35, 0.001, 0.05);
            }
            reduce(y, k, f, |group, _| mean(group));
        }
        6 => {
            shift_linear(y, k);
            reduce(y, k, f, |group, _| r_nonsep(group));
        }
        7 => {
            let mut rest = Rest::new(y);
            for v in &mut y[..k] {
                *v = b_param(*v, rest.mean_after(*v));
            }
            shift_linear(y, k);
            reduce(y, k, f, |group, _| mean(group));
        }
        8 => {
            let mut sum = 0.0;
            for (i, v) in y.iter_mut().enumerate() {
                let before = *v;
                if i >= k {
                    *v = b_param(before, sum / i as f64);
                }
                sum += before;
            }
            shift_linear(y, k);
            reduce(y, k, f, |group, _| mean(group));
        }
        _ => {
            let mut rest = Rest::new(y);
            let last = y.len() - 1;
            for v in &mut y[..last] {
                *v = b_param(*v, rest.mean_after(*v));
            }
            for (i, v) in y.iter_mut().enumerate() {
                *v = if i < k { s_decept(*v, 0.35, 0.001, 0.05) } else { s_multi(*v, 30.0, 95.0, 0.35) };
            }
            reduce(y, k, f, |group, _| r_nonsep(group));
        }
    }
    y.clear();
    y.extend_from_slice(f);
    shape(number, y, f);
}

/// Sum of the values after each one, as they stood before any was changed.
struct Rest {
    sum: f64,
    count: usize,
}

impl Rest {
    fn new(y: &[f64]) -> Self {
        Self { sum: y.iter().sum(), count: y.len() }
    }

    fn mean_after(&mut self, value: f64) -> f64 {
        self.sum -= value;
        self.count -= 1;
        self.sum / self.count as f64
    }
}

/// Leaves the m underlying parameters in `f`: one of each group of positions, one of the
/// distances.
fn reduce(y: &[f64], k: usize, f: &mut [f64], of: impl Fn(&[f64], usize) -> f64) {
    let m = f.len();
    let size = k / (m - 1);
    for group in 0..m - 1 {
        f[group] = unit(of(&y[group * size..(group + 1) * size], group * size));
    }
    f[m - 1] = unit(of(&y[k..], k));
}

/// Turns underlying parameters `t` into objectives, both `[m]`.
pub(super) fn shape(number: u8, t: &[f64], f: &mut [f64]) {
    let m = f.len();
    let distance = t[m - 1];
    let mut product = 1.0;
    // Shapes go from the last objective, of one parameter, to the first, of all.
    for (j, &t) in t[..m - 1].iter().enumerate() {
        // In WFG3 all positions but the first degenerate.
        let x = if number == 3 && j > 0 { distance * (t - 0.5) + 0.5 } else { t };
        let (sin, cos) = (x * FRAC_PI_2).sin_cos();
        let (own, onward) = match number {
            1 if j == 0 => (1.0 - x - (10.0 * PI * x + FRAC_PI_2).cos() / (10.0 * PI), 1.0 - cos),
            2 if j == 0 => (1.0 - x * (5.0 * x * PI).cos().powi(2), 1.0 - cos),
            1 | 2 => (1.0 - sin, 1.0 - cos),
            3 => (1.0 - x, x),
            _ => (cos, sin),
        };
        f[m - 1 - j] = product * own;
        product *= onward;
    }
    f[0] = product;
    for (j, f) in f.iter_mut().enumerate() {
        *f = distance + 2.0 * (j as f64 + 1.0) * unit(*f);
    }
}

fn unit(v: f64) -> f64 {
    v.clamp(0.0, 1.0)
}

fn shift_linear(y: &mut [f64], k: usize) {
    for v in &mut y[k..] {
        *v = unit((*v - 0.35).abs() / ((0.35 - *v).floor() + 0.35).abs());
    }
}

fn b_flat(y: f64, a: f64, b: f64, c: f64) -> f64 {
    let below = (y - b).floor().min(0.0) * (a * (b - y) / b);
    let above = (c - y).floor().min(0.0) * ((1.0 - a) * (y - c) / (1.0 - c));
    unit(a + below - above)
}

fn b_param(y: f64, u: f64) -> f64 {
    let (a, b, c) = (0.98 / 49.98, 0.02, 50.0);
    let v = a - (1.0 - 2.0 * u) * ((0.5 - u).floor() + a).abs();
    unit(y.powf(b + (c - b) * v))
}

fn s_decept(y: f64, a: f64, b: f64, c: f64) -> f64 {
    let left = (y - a + b).floor() * (1.0 - c + (a - b) / b) / (a - b);
    let right = (a + b - y).floor() * (1.0 - c + (1.0 - a - b) / b) / (1.0 - a - b);
    unit(1.0 + ((y - a).abs() - b) * (left + right + 1.0 / b))
}

fn s_multi(y: f64, a: f64, b: f64, c: f64) -> f64 {
    let far = (y - c).abs() / (2.0 * ((c - y).floor() + c));
    unit((1.0 + ((4.0 * a + 2.0) * PI * (0.5 - far)).cos() + 4.0 * b * far * far) / (b + 2.0))
}

fn r_sum(weighted: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (sum, weights) = weighted.fold((0.0, 0.0), |(sum, weights), (v, w)| (sum + v * w, weights + w));
    sum / weights
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn r_nonsep_pair(a: f64, b: f64) -> f64 {
    unit((a + b + 2.0 * (a - b).abs()) / 3.0)
}

/// `r_nonsep` with as many terms as there are values.
fn r_nonsep(values: &[f64]) -> f64 {
    let n = values.len();
    let mut sum = 0.0;
    for j in 0..n {
        sum += values[j];
        for step in 0..n - 1 {
            sum += (values[j] - values[(1 + j + step) % n]).abs();
        }
    }
    let half = n.div_ceil(2) as f64;
    sum / (half * (1.0 + 2.0 * n as f64 - 2.0 * half))
}
