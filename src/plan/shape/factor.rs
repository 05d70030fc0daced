//! Symmetric positive definite systems of independent blocks that share a border: each joint's control points in
//! each segment are a block, the intervals are the border.

use std::ops::Range;

use super::model::Row;

/// Pivots below this share of their diagonal are raised to it.
const LEAST_PIVOT: f64 = 1e-14;

/// Lower triangles of the blocks, the rows that couple them with the border, and the border's own lower triangle;
/// after [`Bordered::factor`] the factors.
#[derive(Debug, Clone)]
pub(super) struct Bordered {
    sizes: Vec<usize>,
    starts: Vec<usize>,
    border: usize,
    /// By block, `[row][column]`.
    pub(super) own: Vec<Vec<f64>>,
    /// By block, `[row][border]`.
    pub(super) couple: Vec<Vec<f64>>,
    /// `[border][border]`.
    pub(super) corner: Vec<f64>,
}

impl Bordered {
    pub(super) fn new(sizes: &[usize], border: usize) -> Self {
        let starts = sizes.iter().scan(0, |sum, size| {
            let start = *sum;
            *sum += size;
            Some(start)
        });
        Self {
            sizes: sizes.to_vec(),
            starts: starts.collect(),
            border,
            own: sizes.iter().map(|n| vec![0.0; n * n]).collect(),
            couple: sizes.iter().map(|n| vec![0.0; n * border]).collect(),
            corner: vec![0.0; border * border],
        }
    }

    /// Number of unknowns, those of the border last.
    pub(super) fn unknowns(&self) -> usize {
        self.sizes.iter().sum::<usize>() + self.border
    }

    /// Index of a block's first unknown.
    pub(super) fn start(&self, block: usize) -> usize {
        self.starts[block]
    }

    /// Index of the border's first unknown.
    pub(super) fn border_start(&self) -> usize {
        self.unknowns() - self.border
    }

    /// Unknowns of a row's control points and intervals.
    pub(super) fn places(&self, row: &Row) -> (Range<usize>, Range<usize>) {
        let first = self.starts[row.block] + row.first;
        let end = self.starts[row.block] + self.sizes[row.block];
        let (interval, last) = (self.border_start() + row.first_interval, self.unknowns() - 1);
        let interval_end = (interval + row.interval.len()).min(last);
        (first..(first + row.control.len()).min(end), interval..interval_end)
    }

    /// Adds a multiple of a row to a vector of all unknowns.
    pub(super) fn add(&self, row: &Row, by: f64, to: &mut [f64]) {
        let (control, interval) = self.places(row);
        to[control].iter_mut().zip(&row.control).for_each(|(to, a)| *to += by * a);
        to[interval].iter_mut().zip(&row.interval).for_each(|(to, a)| *to += by * a);
    }

    /// Adds to the diagonals: of the blocks by that share of their largest entry and as much, of the border as much.
    pub(super) fn lift(&mut self, own: f64, border: f64) {
        for (block, &n) in self.own.iter_mut().zip(&self.sizes) {
            let most = (0..n).fold(0.0, |most: f64, i| most.max(block[i * n + i]));
            (0..n).for_each(|i| block[i * n + i] += own * (most + 1.0));
        }
        for i in 0..self.border {
            self.corner[i * self.border + i] += border;
        }
    }

    /// Adds a multiple of a row's square; the border's last unknown has that coefficient in it.
    pub(super) fn add_square(&mut self, row: &Row, weight: f64, last: f64) {
        let (n, b) = (self.sizes[row.block], self.border);
        let width = row.control.len().min(n - row.first);
        let reach = row.interval.len().min(b - 1 - row.first_interval);
        let (own, couple) = (&mut self.own[row.block], &mut self.couple[row.block]);
        for (i, a) in row.control.iter().enumerate().take(width) {
            let (line, a) = (row.first + i, weight * a);
            let lower = &mut own[line * n + row.first..][..=i];
            lower.iter_mut().zip(&row.control).for_each(|(to, c)| *to += a * c);
            let border = &mut couple[line * b + row.first_interval..][..reach];
            border.iter_mut().zip(&row.interval).for_each(|(to, c)| *to += a * c);
            couple[line * b + b - 1] += a * last;
        }
        for (i, a) in row.interval.iter().enumerate().take(reach) {
            let (line, a) = (row.first_interval + i, weight * a);
            let lower = &mut self.corner[line * b + row.first_interval..][..=i];
            lower.iter_mut().zip(&row.interval).for_each(|(to, c)| *to += a * c);
            self.corner[(b - 1) * b + line] += a * last;
        }
        self.corner[b * b - 1] += weight * last * last;
    }

    /// Adds a multiple of the square of a row of the border's unknowns, which ascend.
    pub(super) fn add_edge(&mut self, entries: &[(usize, f64)], weight: f64) {
        for (k, (i, a)) in entries.iter().enumerate() {
            for (j, c) in &entries[..=k] {
                self.corner[i * self.border + j] += weight * a * c;
            }
        }
    }

    /// Adds to the diagonal of the last unknown.
    pub(super) fn add_last(&mut self, weight: f64) {
        let last = self.border * self.border - 1;
        self.corner[last] += weight;
    }

    /// The matrix times a vector, before [`Bordered::factor`].
    pub(super) fn times(&self, x: &[f64]) -> Vec<f64> {
        let (b, border) = (self.border, self.border_start());
        let mut y = vec![0.0; x.len()];
        let mut symmetric = |a: &[f64], n: usize, start: usize| {
            for i in 0..n {
                for j in 0..=i {
                    let value = a[i * n + j];
                    y[start + i] += value * x[start + j];
                    if i != j {
                        y[start + j] += value * x[start + i];
                    }
                }
            }
        };
        for (block, &n) in self.sizes.iter().enumerate() {
            symmetric(&self.own[block], n, self.starts[block]);
        }
        symmetric(&self.corner, b, border);
        for (block, &n) in self.sizes.iter().enumerate() {
            for (i, row) in self.couple[block].chunks_exact(b.max(1)).enumerate().take(n) {
                for (j, value) in row.iter().enumerate() {
                    y[self.starts[block] + i] += value * x[border + j];
                    y[border + j] += value * x[self.starts[block] + i];
                }
            }
        }
        y
    }

    pub(super) fn copy_from(&mut self, other: &Self) {
        for (to, from) in self.own.iter_mut().zip(&other.own) {
            to.copy_from_slice(from);
        }
        for (to, from) in self.couple.iter_mut().zip(&other.couple) {
            to.copy_from_slice(from);
        }
        self.corner.copy_from_slice(&other.corner);
    }

    /// Cholesky's factors in place.
    pub(super) fn factor(&mut self) {
        let b = self.border;
        for ((n, own), couple) in self.sizes.iter().zip(&mut self.own).zip(&mut self.couple) {
            let n = *n;
            cholesky(own, n);
            for row in 0..n {
                let (done, rest) = couple.split_at_mut(row * b);
                let current = &mut rest[..b];
                for (k, above) in done.chunks_exact(b).enumerate() {
                    let factor = own[row * n + k];
                    if factor != 0.0 {
                        current.iter_mut().zip(above).for_each(|(to, from)| *to -= factor * from);
                    }
                }
                let reciprocal = 1.0 / own[row * n + row];
                for value in &mut *current {
                    *value *= reciprocal;
                }
                for i in 0..b {
                    let factor = current[i];
                    if factor != 0.0 {
                        let corner = &mut self.corner[i * b..=i * b + i];
                        corner.iter_mut().zip(&*current).for_each(|(to, from)| *to -= factor * from);
                    }
                }
            }
        }
        cholesky(&mut self.corner, b);
    }

    /// Solves in place, after [`Bordered::factor`].
    pub(super) fn solve(&self, x: &mut [f64]) {
        let b = self.border;
        let (inner, outer) = x.split_at_mut(self.unknowns() - b);
        for (block, &n) in self.sizes.iter().enumerate() {
            let part = &mut inner[self.starts[block]..][..n];
            forward(&self.own[block], part);
            for (value, row) in part.iter().zip(self.couple[block].chunks_exact(b)) {
                outer.iter_mut().zip(row).for_each(|(to, weight)| *to -= value * weight);
            }
        }
        forward(&self.corner, outer);
        backward(&self.corner, outer);
        for (block, &n) in self.sizes.iter().enumerate() {
            let part = &mut inner[self.starts[block]..][..n];
            for (value, row) in part.iter_mut().zip(self.couple[block].chunks_exact(b)) {
                *value -= row.iter().zip(&*outer).map(|(weight, x)| weight * x).sum::<f64>();
            }
            backward(&self.own[block], part);
        }
    }
}

fn cholesky(a: &mut [f64], n: usize) {
    for row in 0..n {
        let (above, rest) = a.split_at_mut(row * n);
        let own = &mut rest[..n];
        for column in 0..row {
            let other = &above[column * n..][..n];
            let sum: f64 = own[..column].iter().zip(&other[..column]).map(|(a, b)| a * b).sum();
            own[column] = (own[column] - sum) / other[column];
        }
        let diagonal = own[row];
        let sum: f64 = own[..row].iter().map(|a| a * a).sum();
        own[row] = (diagonal - sum).max(LEAST_PIVOT * diagonal.abs()).max(f64::MIN_POSITIVE).sqrt();
    }
}

fn forward(lower: &[f64], x: &mut [f64]) {
    let n = x.len();
    for row in 0..n {
        let (done, rest) = x.split_at_mut(row);
        let sum: f64 = lower[row * n..][..row].iter().zip(&*done).map(|(a, x)| a * x).sum();
        rest[0] = (rest[0] - sum) / lower[row * n + row];
    }
}

fn backward(lower: &[f64], x: &mut [f64]) {
    let n = x.len();
    for row in (0..n).rev() {
        x[row] /= lower[row * n + row];
        let value = x[row];
        for (k, x) in x.iter_mut().enumerate().take(row) {
            *x -= lower[row * n + k] * value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bordered_system_is_solved() {
        let (sizes, border) = ([3, 0, 2], 2);
        let mut system = Bordered::new(&sizes, border);
        let n = system.unknowns();
        // A full matrix of that form, diagonally dominant.
        let mut full = vec![0.0; n * n];
        let block_of = |i: usize| {
            if i < 3 {
                0
            } else if i < 5 {
                2
            } else {
                9
            }
        };
        for i in 0..n {
            for j in 0..=i {
                let joined = block_of(i) == block_of(j) || block_of(i) == 9;
                let value = if i == j {
                    5.0 + i as f64
                } else if joined {
                    ((i * 7 + j * 3) % 5) as f64 * 0.3 - 0.5
                } else {
                    0.0
                };
                (full[i * n + j], full[j * n + i]) = (value, value);
                match (block_of(i), block_of(j)) {
                    (9, 9) => system.corner[(i - 5) * border + j - 5] = value,
                    (9, block) => {
                        let start = system.start(block);
                        system.couple[block][(j - start) * 2 + i - 5] = value;
                    }
                    (block, other) if block == other => {
                        let start = system.start(block);
                        system.own[block][(i - start) * sizes[block] + j - start] = value;
                    }
                    _ => {}
                }
            }
        }
        let want: Vec<f64> = (0..n).map(|i| i as f64 - 2.5).collect();
        let mut x: Vec<f64> =
            full.chunks_exact(n).map(|row| row.iter().zip(&want).map(|(a, x)| a * x).sum()).collect();
        system.factor();
        system.solve(&mut x);
        assert!(x.iter().zip(&want).all(|(x, want)| (x - want).abs() < 1e-12), "{x:?}");
    }
}
