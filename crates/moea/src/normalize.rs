//! Normalisation of objectives by ideal point, extreme points and intercepts.
//!
//! Deb and Jain 2014, section IV-C, with every threshold relative, so that neither the scale
//! nor the origin of an objective matters.

use super::Population;

/// Off-axis weight of the scalarisation that finds extreme points.
const OFF_AXIS: f64 = 1e6;
/// Below this, in units of the front's range, an objective counts as at its ideal.
const NEAR_IDEAL: f64 = 1e-3;
/// A range never counts for less than this share of the worst value ever seen.
const LEAST_RANGE: f64 = 1e-6;

/// What is remembered of all feasible members seen so far.
#[derive(Debug, Clone)]
pub(super) struct Normalizer {
    m: usize,
    /// Best value ever seen of each objective.
    ideal: Vec<f64>,
    worst: Vec<f64>,
    /// Extreme points, `[m][m]`, not normalised.
    extreme: Vec<f64>,
    has_extreme: bool,
    /// What one unit of each normalised objective is worth.
    span: Vec<f64>,
    range: Vec<f64>,
    matrix: Vec<f64>,
    solution: Vec<f64>,
}

impl Normalizer {
    pub(super) fn new(m: usize) -> Self {
        Self {
            m,
            ideal: vec![f64::INFINITY; m],
            worst: vec![f64::NEG_INFINITY; m],
            extreme: vec![0.0; m * m],
            has_extreme: false,
            span: vec![1.0; m],
            range: vec![1.0; m],
            matrix: vec![0.0; m * m],
            solution: vec![0.0; m],
        }
    }

    /// Takes in the feasible members and the first front among them.
    pub(super) fn update(&mut self, population: &Population, feasible: &[usize], front: &[usize]) {
        if front.is_empty() {
            return;
        }
        let m = self.m;
        for &i in feasible {
            for (k, &value) in population.f(i).iter().enumerate() {
                self.ideal[k] = self.ideal[k].min(value);
                self.worst[k] = self.worst[k].max(value);
            }
        }
        for k in 0..m {
            let values = || front.iter().map(|&i| population.f(i)[k]);
            let range = values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min);
            let range = range.max(LEAST_RANGE * (self.worst[k] - self.ideal[k]));
            self.range[k] = if range > 0.0 { range } else { 1.0 };
        }
        self.find_extremes(population, front);
        if !self.intercepts() {
            self.fall_back(population, feasible, front);
        }
    }

    fn find_extremes(&mut self, population: &Population, front: &[usize]) {
        let m = self.m;
        for axis in 0..m {
            let achievement = |f: &[f64]| {
                (0..m).fold(f64::NEG_INFINITY, |most, k| {
                    let value = (f[k] - self.ideal[k]) / self.range[k];
                    let value = if value < NEAR_IDEAL { 0.0 } else { value };
                    most.max(if k == axis { value } else { OFF_AXIS * value })
                })
            };
            let own = axis * m..(axis + 1) * m;
            let remembered =
                if self.has_extreme { achievement(&self.extreme[own.clone()]) } else { f64::INFINITY };
            let mut best = (remembered, None);
            for &i in front {
                let value = achievement(population.f(i));
                if value < best.0 {
                    best = (value, Some(i));
                }
            }
            if let Some(i) = best.1 {
                self.extreme[own].copy_from_slice(population.f(i));
            }
        }
        self.has_extreme = true;
    }

    /// Intercepts of the plane through the extreme points; whether there are any.
    fn intercepts(&mut self) -> bool {
        let m = self.m;
        for (row, extreme) in self.matrix.chunks_exact_mut(m).zip(self.extreme.chunks_exact(m)) {
            for k in 0..m {
                row[k] = (extreme[k] - self.ideal[k]) / self.range[k];
            }
        }
        if !inverse_intercepts(&mut self.matrix, &mut self.solution) {
            return false;
        }
        for k in 0..m {
            let seen = self.worst[k] - self.ideal[k];
            self.span[k] = (self.range[k] / self.solution[k]).min(seen);
        }
        self.span.iter().zip(&self.range).all(|(&span, &range)| span > 1e-6 * range)
    }

    /// Worst of the front, or of the population where the front has next to no extent. That may
    /// be tiny beside what was seen before: only so can a population that lost an objective's
    /// extent (DTLZ4) find its way back, niche by niche.
    fn fall_back(&mut self, population: &Population, feasible: &[usize], front: &[usize]) {
        for k in 0..self.m {
            let worst = |of: &[usize]| of.iter().fold(f64::NEG_INFINITY, |w, &i| w.max(population.f(i)[k]));
            let least = LEAST_RANGE * (self.worst[k] - self.ideal[k]);
            let of_front = worst(front) - self.ideal[k];
            let span = if of_front > least { of_front } else { worst(feasible) - self.ideal[k] };
            self.span[k] = if span > 0.0 { span } else { 1.0 };
        }
    }

    /// Ranges that the objectives of feasible members were ever seen in, `[m]`.
    pub(super) fn seen(&self) -> impl Iterator<Item = f64> {
        self.worst.iter().zip(&self.ideal).map(|(worst, ideal)| worst - ideal)
    }

    /// What one unit of each normalised objective is worth, `[m]`.
    pub(super) fn span(&self) -> &[f64] {
        &self.span
    }

    /// Normalises objectives `f` into `out`, both `[m]`: 0 is the ideal, 1 the intercept.
    pub(super) fn apply(&self, f: &[f64], out: &mut [f64]) {
        for k in 0..self.m {
            out[k] = (f[k] - self.ideal[k]) / self.span[k];
        }
    }
}

/// Writes one over the intercepts of the plane through `m` points, `[m][m]` in one slice, in units of the
/// front's range, into `inverse`, `[m]`; false if there are none. Changes the points.
pub(super) fn inverse_intercepts(points: &mut [f64], inverse: &mut [f64]) -> bool {
    inverse.fill(1.0);
    // Negative ones and those that vanish beside the range are no intercepts.
    solve(points, inverse) && inverse.iter().all(|inverse| (1e-12..1e6).contains(inverse))
}

/// Solves `a x = b` in place by elimination with pivoting; false if `a` is singular.
fn solve(a: &mut [f64], b: &mut [f64]) -> bool {
    let m = b.len();
    for column in 0..m {
        let pivot = (column..m).max_by(|&i, &j| a[i * m + column].abs().total_cmp(&a[j * m + column].abs()));
        let Some(pivot) = pivot else { return false };
        if a[pivot * m + column].abs() < 1e-10 {
            return false;
        }
        if pivot != column {
            for k in 0..m {
                a.swap(pivot * m + k, column * m + k);
            }
            b.swap(pivot, column);
        }
        for row in column + 1..m {
            let factor = a[row * m + column] / a[column * m + column];
            for k in column..m {
                a[row * m + k] -= factor * a[column * m + k];
            }
            b[row] -= factor * b[column];
        }
    }
    for row in (0..m).rev() {
        let known: f64 = (row + 1..m).map(|k| a[row * m + k] * b[k]).sum();
        b[row] = (b[row] - known) / a[row * m + row];
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_gives_its_intercepts_and_a_singular_one_none() {
        let (mut a, mut b) = ([2.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.5], [1.0; 3]);
        assert!(solve(&mut a, &mut b));
        assert!(b.iter().zip([0.5, 0.25, 2.0]).all(|(got, want)| (got - want).abs() < 1e-15));
        assert!(!solve(&mut [1.0, 2.0, 2.0, 4.0], &mut [1.0; 2]));
    }
}
