//! Points of the true fronts.

use std::{collections::BTreeSet, f64::consts::PI};

use super::{Benchmark, Family, mw, wfg};
use crate::{Random, das_dennis, direction_count};

/// Most points of any front.
const MOST: usize = 1_000_000;
/// Least and most points of a front before it is thinned, and how many there are for each that is kept.
const CANDIDATES: (usize, usize) = (20_000, 200_000);
const CHOICE: usize = 20;
/// Most numbers that they consist of.
const NUMBERS: usize = 4_000_000;
/// Halvings of the ratio of the cells that are too fine and those that are not.
const ROUNDS: usize = 14;
/// Points of a grid over the first parameter.
const FINE: u32 = 100_000;

/// The directions with at most `count` points, `[n][m]`.
fn directions(m: usize, count: usize) -> Vec<f64> {
    let mut p = 1;
    while m > 1 && direction_count(m, p + 1).is_some_and(|h| h <= count) {
        p += 1;
    }
    das_dennis(m, p).unwrap_or_default()
}

/// At most about `count` points of the front, spread over it, `[n][m]`.
pub(super) fn points(problem: &Benchmark, count: usize) -> Vec<f64> {
    let (m, count) = (problem.objectives, count.clamp(1, MOST));
    match (problem.family, problem.number) {
        (Family::Dtlz, 1) => scaled(directions(m, count), m, |z, _| 0.5 / z.iter().sum::<f64>()),
        (Family::Dtlz, 2..=4) => scaled(directions(m, count), m, |z, _| 1.0 / length(z)),
        (Family::Dtlz, 5 | 6) => arc(m, count),
        (Family::Dtlz, _) => disconnected(m, count),
        (Family::Mw, 4) => scaled(directions(m, count), m, |z, _| 1.0 / z.iter().sum::<f64>()),
        (Family::Mw, _) => thinned(&mw::curve(problem.number, count), m, count),
        (Family::Wfg, 1 | 2) => {
            // Corners alone are as many as objectives.
            let count = count.max(2 * m);
            thinned(&candidates(problem, count), m, count)
        }
        (Family::Wfg, 3) => line(m, count),
        (Family::Wfg, _) => scaled(directions(m, count), m, |z, k| 2.0 * (k as f64 + 1.0) / length(z)),
    }
}

fn length(z: &[f64]) -> f64 {
    z.iter().map(|z| z * z).sum::<f64>().sqrt()
}

fn scaled(mut flat: Vec<f64>, m: usize, factor: impl Fn(&[f64], usize) -> f64) -> Vec<f64> {
    let mut factors = vec![0.0; m];
    for z in flat.chunks_exact_mut(m) {
        for (k, entry) in factors.iter_mut().enumerate() {
            *entry = factor(z, k);
        }
        z.iter_mut().zip(&factors).for_each(|(z, factor)| *z *= factor);
    }
    flat
}

/// DTLZ5 and 6: a quarter circle, its cosine shared by all objectives but the last.
fn arc(m: usize, count: usize) -> Vec<f64> {
    let mut flat = Vec::with_capacity(count * m);
    for i in 0..count {
        let angle = 0.5 * PI * i as f64 / (count.max(2) - 1) as f64;
        let mut product = angle.cos();
        let mut point = vec![0.0; m];
        point[m - 1] = angle.sin();
        for k in (1..m - 1).rev() {
            product *= 0.5_f64.sqrt();
            point[k] = product;
        }
        point[0] = product;
        flat.extend(point);
    }
    flat
}

/// DTLZ7: each position lies in one of two stretches.
fn disconnected(m: usize, count: usize) -> Vec<f64> {
    const STRETCHES: [f64; 4] =
        [0.0, 0.251_411_836_095_147_3, 0.631_626_530_700_032_4, 0.859_400_856_644_676_9];
    let first = STRETCHES[1] / (STRETCHES[1] + STRETCHES[3] - STRETCHES[2]);
    let mut flat = Vec::new();
    each_of_grid(m - 1, count as f64, |u| {
        let mut sum = 0.0;
        for &u in u {
            let x = if u <= first {
                u / first * STRETCHES[1]
            } else {
                STRETCHES[2] + (u - first) / (1.0 - first) * (STRETCHES[3] - STRETCHES[2])
            };
            sum += x / 2.0 * (1.0 + (3.0 * PI * x).sin());
            flat.push(x);
        }
        flat.push(2.0 * (m as f64 - sum));
    });
    flat
}

/// WFG3: the line on which only the first parameter moves.
fn line(m: usize, count: usize) -> Vec<f64> {
    let mut flat = Vec::with_capacity(count * m);
    let (mut t, mut f) = (vec![0.5; m], vec![0.0; m]);
    t[m - 1] = 0.0;
    for i in 0..count {
        t[0] = i as f64 / (count.max(2) - 1) as f64;
        wfg::shape(3, &t, &mut f);
        flat.extend_from_slice(&f);
    }
    flat
}

/// All combinations of evenly spaced numbers in 0 to 1, at most about `most` of them, and half as many at least. Where
/// there are many more corners than that, only those with no, one, or all axes up to one at their upper ends.
fn each_of_grid(axes: usize, most: f64, mut take: impl FnMut(&[f64])) {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive root")]
    let least = (most.powf(1.0 / axes.max(1) as f64).floor() as usize).max(2);
    let mut steps = vec![least; axes];
    let points = |steps: &[usize]| steps.iter().map(|steps| *steps as f64).product::<f64>();
    for axis in 0..axes {
        let all = points(&steps);
        if all < 0.5 * most && all * (least as f64 + 1.0) <= most * least as f64 {
            steps[axis] += 1;
        }
    }
    let mut at = vec![0usize; axes];
    let mut u = vec![0.0; axes];
    if 2_f64.powf(axes as f64) > 4.0 * most {
        take(&u);
        for single in [true, false] {
            for axis in 0..axes {
                u[axis] = 1.0;
                take(&u);
                if single {
                    u[axis] = 0.0;
                }
            }
        }
        return;
    }
    loop {
        for ((u, &at), steps) in u.iter_mut().zip(&at).zip(&steps) {
            *u = at as f64 / (steps - 1) as f64;
        }
        take(&u);
        let Some(axis) = (0..axes).find(|&axis| at[axis] + 1 < steps[axis]) else { return };
        at[..axis].fill(0);
        at[axis] += 1;
    }
}

/// Points of the front of WFG1 or WFG2, its corners first: a grid, and random ones where few steps of a grid fit.
///
/// Of equal other parameters the first one trades the last objective for all others. Its values that lower the last
/// objective below that of all smaller ones are the front, whatever the others are.
fn candidates(problem: &Benchmark, count: usize) -> Vec<f64> {
    let m = problem.objectives;
    let mut firsts = Vec::new();
    let mut lowest = f64::INFINITY;
    for i in 0..=FINE {
        let (at, mut of) = (f64::from(i) / f64::from(FINE), [0.0; 2]);
        wfg::shape(problem.number, &[at, 0.0], &mut of);
        if of[1] < lowest {
            lowest = of[1];
            firsts.push(at);
        }
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index")]
    let first = |u: f64| firsts[(u * (firsts.len() - 1) as f64).round() as usize];
    let (mut t, mut f, mut flat) = (vec![0.0; m], vec![0.0; m], Vec::new());
    let mut take = |u: &[f64]| {
        t[..m - 1].copy_from_slice(u);
        t[0] = first(u[0]);
        wfg::shape(problem.number, &t, &mut f);
        flat.extend_from_slice(&f);
    };
    each_of_grid(m - 1, 2.0, &mut take);
    let wanted = count.saturating_mul(CHOICE).clamp(CANDIDATES.0, CANDIDATES.1).min(NUMBERS / m);
    each_of_grid(m - 1, wanted as f64, &mut take);
    if m > 4 {
        let (mut rng, mut u) = (Random::of_survival(0), vec![0.0; m - 1]);
        for _ in 0..wanted {
            u.fill_with(|| rng.unit());
            take(&u);
        }
    }
    flat
}

/// At most `count` of the points, nearly as many if they differ: the first in each cell of the finest grid over the
/// range of the front that has no more.
fn thinned(flat: &[f64], m: usize, count: usize) -> Vec<f64> {
    let range = |k: usize| {
        let values = || flat.iter().skip(k).step_by(m).copied();
        (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max))
    };
    let ranges: Vec<(f64, f64)> = (0..m).map(range).collect();
    let one_a_cell = |cells: f64| {
        let (mut taken, mut kept) = (BTreeSet::new(), Vec::new());
        for point in flat.chunks_exact(m) {
            #[expect(clippy::cast_possible_truncation, reason = "0 to the number of cells")]
            let cell: Vec<i64> = point
                .iter()
                .zip(&ranges)
                .map(|(p, (low, high))| ((p - low) / (high - low).max(f64::MIN_POSITIVE) * cells) as i64)
                .collect();
            if taken.insert(cell) {
                kept.extend_from_slice(point);
                if kept.len() > count * m {
                    return None;
                }
            }
        }
        Some(kept)
    };
    // The finest of all only drops what is repeated.
    let (mut coarse, mut fine) = (0.5_f64, 1e9_f64);
    let mut best = one_a_cell(coarse).unwrap_or_default();
    for _ in 0..ROUNDS {
        let middle = (coarse * fine).sqrt();
        match one_a_cell(middle) {
            Some(kept) => {
                coarse = middle;
                if kept.len() > best.len() {
                    best = kept;
                }
            }
            None => fine = middle,
        }
    }
    best
}
