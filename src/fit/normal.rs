//! Normal equations of a joint's runs.

use multiversion::multiversion;
use nalgebra::{DMatrix, DVector};

use super::parameters::SHARED;

/// Numbers of a row: shared parameters, the integral and the residual, in whole vectors.
pub(super) const WIDTH: usize = (SHARED + 2).next_multiple_of(LANES);

/// Numbers that a processor adds at once.
const LANES: usize = 8;

/// Rows that are taken in at once.
const ROWS: usize = 4;

/// Slopes of a residual by the shared parameters that move and by the integral of its run, then the residual itself.
pub(super) type Row = [f64; WIDTH];

/// Weighted normal equations of the data, in scales; integrals, which move their run alone, are eliminated one by one.
#[derive(Debug, Clone)]
pub(super) struct Normal {
    /// Of the shared parameters that move.
    shared: DMatrix<f64>,
    slope: DVector<f64>,
    /// Run by run: the products of its integral with the shared parameters, its own square, its slope.
    runs: Vec<(DVector<f64>, f64, f64)>,
}

impl Normal {
    /// Of no data and so many shared parameters.
    pub(super) fn of(size: usize) -> Self {
        Self { shared: DMatrix::zeros(size, size), slope: DVector::zeros(size), runs: Vec::new() }
    }

    /// Takes in a run.
    pub(super) fn add(&mut self, rows: &[Row]) {
        let own = self.slope.len();
        let sums = products(rows);
        let sum = |i: usize, k: usize| sums[i.min(k)][i.max(k)];
        for i in 0..own {
            self.slope[i] += sum(i, own + 1);
            for k in 0..own {
                self.shared[(i, k)] += sum(i, k);
            }
        }
        self.runs.push((DVector::from_fn(own, |i, _| sum(i, own)), sum(own, own), sum(own, own + 1)));
    }

    /// With the priors, for data whose cost is divided by their inefficiency.
    pub(super) fn with_priors(mut self, inefficiency: f64, x: &[f64], free: &[usize]) -> Self {
        self.shared /= inefficiency;
        self.slope /= inefficiency;
        for (k, &i) in free.iter().enumerate() {
            self.shared[(k, k)] += 1.0;
            self.slope[k] += x[i];
        }
        for ((cross, square, slope), x) in self.runs.iter_mut().zip(x.iter().skip(SHARED)) {
            *cross /= inefficiency;
            *square = *square / inefficiency + 1.0;
            *slope = *slope / inefficiency + x;
        }
        self
    }

    /// The shared parameters' part once the integrals are eliminated, each diagonal lifted by `damping`.
    fn reduced(&self, damping: f64) -> (DMatrix<f64>, DVector<f64>) {
        let (mut shared, mut slope) = (self.shared.clone(), self.slope.clone());
        for k in 0..slope.len() {
            shared[(k, k)] += damping * self.shared[(k, k)];
        }
        for (cross, square, own) in &self.runs {
            let lifted = (1.0 + damping) * square;
            shared.ger(-1.0 / lifted, cross, cross, 1.0);
            slope.axpy(-own / lifted, cross, 1.0);
        }
        (shared, slope)
    }

    /// The step of all parameters that move: the shared ones, then the integrals.
    pub(super) fn step(&self, damping: f64) -> Option<Vec<f64>> {
        let (shared, slope) = self.reduced(damping);
        let step = shared.cholesky()?.solve(&slope);
        let own = self
            .runs
            .iter()
            .map(|(cross, square, own)| (own - cross.dot(&step)) / ((1.0 + damping) * square));
        let step: Vec<f64> = step.iter().copied().chain(own).collect();
        step.iter().all(|s| s.is_finite()).then_some(step)
    }

    /// Covariance of the shared parameters with data and priors.
    pub(super) fn covariance(self, inefficiency: f64, x: &[f64], free: &[usize]) -> DMatrix<f64> {
        let (information, _) = self.with_priors(inefficiency, x, free).reduced(0.0);
        // Information of at least the priors has an inverse.
        let size = information.nrows();
        information.cholesky().map_or_else(|| DMatrix::identity(size, size), |cholesky| cholesky.inverse())
    }
}

/// Sums of the products of two columns each, on and above the diagonal. Widths of vectors differ in speed, not in results.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn products(rows: &[Row]) -> [Row; WIDTH] {
    let mut sums = [[0.0; WIDTH]; WIDTH];
    let mut add = |rows: [&Row; ROWS]| {
        for (i, sums) in sums.iter_mut().enumerate() {
            let own = rows.map(|row| row[i]);
            for k in i / LANES * LANES..WIDTH {
                sums[k] +=
                    (own[0] * rows[0][k] + own[1] * rows[1][k]) + (own[2] * rows[2][k] + own[3] * rows[3][k]);
            }
        }
    };
    let nothing = [0.0; WIDTH];
    for four in rows.chunks(ROWS) {
        add(std::array::from_fn(|k| four.get(k).unwrap_or(&nothing)));
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_those_of_columns() {
        let rows: Vec<Row> =
            (0..11).map(|r| std::array::from_fn(|k| ((7 * r + 5 * k) % 13) as f64 - 6.0)).collect();
        let sums = products(&rows);
        for i in 0..WIDTH {
            for k in i..WIDTH {
                let sum: f64 = rows.iter().map(|row| row[i] * row[k]).sum();
                assert!((sums[i][k] - sum).abs() < 1e-9, "{i} {k}");
            }
        }
    }
}
