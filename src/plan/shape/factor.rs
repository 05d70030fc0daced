//! Symmetric positive definite systems of independent bands that share a border: the control points of a segment are a
//! band, of every joint its own where nothing joins them; the intervals are the border.

use super::row::Row;
use crate::math::dot;

/// Pivots below this share of their diagonal are raised to it.
const LEAST_PIVOT: f64 = 1e-14;

/// Which unknowns there are: free control points of each joint in each segment, and the border.
#[derive(Debug, Clone)]
pub(super) struct Unknowns {
    pub(super) joints: usize,
    /// Free control points of a joint by segment.
    pub(super) free: Vec<usize>,
    /// Consecutive control points that a value depends on.
    pub(super) window: usize,
    pub(super) border: usize,
    /// Whether values depend on several joints.
    pub(super) joined: bool,
}

/// Lower bands of the blocks, the rows that couple them with the border, and the border's own lower triangle;
/// after [`Bordered::factor`] the factors.
#[derive(Debug, Clone)]
pub(super) struct Bordered {
    /// Joints that share a block.
    group: usize,
    joints: usize,
    sizes: Vec<usize>,
    starts: Vec<usize>,
    /// Entries of a band's row, the diagonal last.
    width: usize,
    border: usize,
    /// By block, `[row][entry]`.
    own: Vec<Vec<f64>>,
    /// By block, `[row][border]`.
    couple: Vec<Vec<f64>>,
    /// `[border][border]`.
    pub(super) corner: Vec<f64>,
}

impl Bordered {
    pub(super) fn new(unknowns: &Unknowns) -> Self {
        let Unknowns { joints, ref free, window, border, joined } = *unknowns;
        let group = if joined { joints } else { 1 };
        let sizes: Vec<usize> =
            free.iter().flat_map(|free| std::iter::repeat_n(free * group, joints / group.max(1))).collect();
        let width = window * group;
        let starts = sizes.iter().scan(0, |sum, size| {
            let start = *sum;
            *sum += size;
            Some(start)
        });
        Self {
            group,
            joints,
            starts: starts.collect(),
            width,
            border,
            own: sizes.iter().map(|n| vec![0.0; n * width]).collect(),
            couple: sizes.iter().map(|n| vec![0.0; n * border]).collect(),
            corner: vec![0.0; border * border],
            sizes,
        }
    }

    /// Number of unknowns, those of the border last.
    pub(super) fn unknowns(&self) -> usize {
        self.sizes.iter().sum::<usize>() + self.border
    }

    /// Index of the border's first unknown.
    pub(super) fn border_start(&self) -> usize {
        self.unknowns() - self.border
    }

    /// The block of a joint in a segment, and the joint's place among those that share it.
    fn block(&self, segment: usize, joint: usize) -> (usize, usize) {
        if self.group > 1 { (segment, joint) } else { (segment * self.joints + joint, 0) }
    }

    /// Index of the unknown that is a free control point of a joint in a segment.
    pub(super) fn index(&self, segment: usize, joint: usize, control: usize) -> usize {
        let (block, member) = self.block(segment, joint);
        self.starts[block] + control * self.group + member
    }

    /// A row's coefficients with the indices of their unknowns.
    pub(super) fn entries<'a>(&'a self, row: &'a Row) -> impl Iterator<Item = (usize, f64)> + 'a {
        let border = self.border_start() + row.first_interval;
        let reach = self.reach(row);
        let own = row.parts().flat_map(move |(joint, control)| {
            let (block, member) = self.block(row.segment, joint);
            let first = self.starts[block] + row.first * self.group + member;
            let count = (self.sizes[block] / self.group - row.first).min(control.len());
            control[..count].iter().enumerate().map(move |(k, a)| (first + k * self.group, *a))
        });
        own.chain(row.interval[..reach].iter().enumerate().map(move |(k, a)| (border + k, *a)))
    }

    /// Intervals of a row that there are.
    fn reach(&self, row: &Row) -> usize {
        row.interval.len().min(self.border - 1 - row.first_interval)
    }

    /// Adds a multiple of a row to a vector of all unknowns.
    pub(super) fn add(&self, row: &Row, by: f64, to: &mut [f64]) {
        for (i, a) in self.entries(row) {
            to[i] += by * a;
        }
    }

    /// Adds to the diagonals: of the blocks by that share of their largest entry and as much, of the border as much.
    pub(super) fn lift(&mut self, own: f64, border: f64) {
        for band in &mut self.own {
            let most =
                band.chunks_exact(self.width).fold(0.0, |most: f64, row| most.max(row[self.width - 1]));
            for row in band.chunks_exact_mut(self.width) {
                row[self.width - 1] += own * (most + 1.0);
            }
        }
        for i in 0..self.border {
            self.corner[i * self.border + i] += border;
        }
    }

    /// Adds a multiple of a row's square; the border's last unknown has that coefficient in it.
    pub(super) fn add_square(&mut self, row: &Row, weight: f64, last: f64) {
        let (b, width, group, reach) = (self.border, self.width, self.group, self.reach(row));
        for (joint, control) in row.parts() {
            let (block, member) = self.block(row.segment, joint);
            let count = (self.sizes[block] / group - row.first).min(control.len());
            let (own, couple) = (&mut self.own[block], &mut self.couple[block]);
            for (i, a) in control[..count].iter().enumerate() {
                let (line, a) = ((row.first + i) * group + member, weight * a);
                for (other, beside) in row.parts() {
                    let other = if group > 1 { other } else { 0 };
                    // Of the lower triangle: this control point of joints up to this one, and those before it.
                    let upto = if other <= member { i + 1 } else { i };
                    for (k, c) in beside[..upto].iter().enumerate() {
                        let column = (row.first + k) * group + other;
                        own[line * width + column + width - 1 - line] += a * c;
                    }
                }
                let border = &mut couple[line * b + row.first_interval..][..reach];
                border.iter_mut().zip(&row.interval).for_each(|(to, c)| *to += a * c);
                couple[line * b + b - 1] += a * last;
            }
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
        let mut add = |i: usize, j: usize, value: f64| {
            y[i] += value * x[j];
            if i != j {
                y[j] += value * x[i];
            }
        };
        for ((start, own), couple) in self.starts.iter().zip(&self.own).zip(&self.couple) {
            for (i, row) in own.chunks_exact(self.width).enumerate() {
                let from = first(i, self.width);
                for (j, value) in (from..=i).zip(&row[from + self.width - 1 - i..]) {
                    add(start + i, start + j, *value);
                }
            }
            for (i, row) in couple.chunks_exact(b).enumerate() {
                row.iter().enumerate().for_each(|(j, value)| add(border + j, start + i, *value));
            }
        }
        for i in 0..b {
            (0..=i).for_each(|j| add(border + i, border + j, self.corner[i * b + j]));
        }
        y
    }

    pub(super) fn copy_from(&mut self, other: &Self) {
        let copy = |to: &mut [Vec<f64>], from: &[Vec<f64>]| {
            to.iter_mut().zip(from).for_each(|(to, from)| to.copy_from_slice(from));
        };
        copy(&mut self.own, &other.own);
        copy(&mut self.couple, &other.couple);
        self.corner.copy_from_slice(&other.corner);
    }

    /// Cholesky's factors in place.
    pub(super) fn factor(&mut self) {
        let (b, width) = (self.border, self.width);
        for (own, couple) in self.own.iter_mut().zip(&mut self.couple) {
            banded(own, width);
            for row in 0..own.len() / width {
                let from = first(row, width);
                let (done, rest) = couple.split_at_mut(row * b);
                let current = &mut rest[..b];
                let band = &own[row * width + from + width - 1 - row..][..row - from];
                for (factor, above) in band.iter().zip(done[from * b..].chunks_exact(b)) {
                    if *factor != 0.0 {
                        current.iter_mut().zip(above).for_each(|(to, from)| *to -= factor * from);
                    }
                }
                let reciprocal = 1.0 / own[row * width + width - 1];
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
        let (b, width) = (self.border, self.width);
        let (inner, outer) = x.split_at_mut(self.unknowns() - b);
        for (block, start) in self.starts.iter().enumerate() {
            let part = &mut inner[*start..][..self.sizes[block]];
            forward(&self.own[block], width, part);
            for (value, row) in part.iter().zip(self.couple[block].chunks_exact(b)) {
                outer.iter_mut().zip(row).for_each(|(to, weight)| *to -= value * weight);
            }
        }
        solve_dense(&self.corner, outer);
        for (block, start) in self.starts.iter().enumerate() {
            let part = &mut inner[*start..][..self.sizes[block]];
            for (value, row) in part.iter_mut().zip(self.couple[block].chunks_exact(b)) {
                *value -= row.iter().zip(&*outer).map(|(weight, x)| weight * x).sum::<f64>();
            }
            backward(&self.own[block], width, part);
        }
    }
}

/// The first column of a row in a band.
fn first(row: usize, width: usize) -> usize {
    (row + 1).saturating_sub(width)
}

/// A pivot's root, of a diagonal less a sum.
fn pivot(diagonal: f64, sum: f64) -> f64 {
    (diagonal - sum).max(LEAST_PIVOT * diagonal.abs()).max(f64::MIN_POSITIVE).sqrt()
}

fn banded(a: &mut [f64], width: usize) {
    for row in 0..a.len() / width {
        let (above, rest) = a.split_at_mut(row * width);
        let own = &mut rest[..width];
        let from = first(row, width);
        for column in from..row {
            let other = &above[column * width..][..width];
            // Columns that both rows have; the second row's window starts no later.
            let begin = from.max(first(column, width));
            let here = begin + width - 1 - row;
            let there = begin + width - 1 - column;
            let sum = dot(&own[here..][..column - begin], &other[there..][..column - begin]);
            let at = column + width - 1 - row;
            own[at] = (own[at] - sum) / other[width - 1];
        }
        let before = &own[from + width - 1 - row..width - 1];
        own[width - 1] = pivot(own[width - 1], dot(before, before));
    }
}

fn forward(lower: &[f64], width: usize, x: &mut [f64]) {
    for (row, own) in lower.chunks_exact(width).enumerate() {
        let from = first(row, width);
        let sum = dot(&own[from + width - 1 - row..width - 1], &x[from..row]);
        x[row] = (x[row] - sum) / own[width - 1];
    }
}

fn backward(lower: &[f64], width: usize, x: &mut [f64]) {
    for (row, own) in lower.chunks_exact(width).enumerate().rev() {
        let from = first(row, width);
        x[row] /= own[width - 1];
        let value = x[row];
        for (x, a) in x[from..row].iter_mut().zip(&own[from + width - 1 - row..]) {
            *x -= a * value;
        }
    }
}

fn cholesky(a: &mut [f64], n: usize) {
    for row in 0..n {
        let (above, rest) = a.split_at_mut(row * n);
        let own = &mut rest[..n];
        for column in 0..row {
            let other = &above[column * n..][..n];
            own[column] = (own[column] - dot(&own[..column], &other[..column])) / other[column];
        }
        own[row] = pivot(own[row], dot(&own[..row], &own[..row]));
    }
}

fn solve_dense(lower: &[f64], x: &mut [f64]) {
    let n = x.len();
    for row in 0..n {
        x[row] = (x[row] - dot(&lower[row * n..][..row], &x[..row])) / lower[row * n + row];
    }
    for row in (0..n).rev() {
        x[row] /= lower[row * n + row];
        let value = x[row];
        x[..row].iter_mut().zip(&lower[row * n..]).for_each(|(x, a)| *x -= a * value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::WINDOW;

    /// Rows of one joint and of all, in two segments of which one has no free control points.
    #[test]
    fn a_bordered_system_of_squares_is_solved_whether_joints_are_joined_or_not() {
        for joined in [false, true] {
            let unknowns = Unknowns { joints: 3, free: vec![5, 0, 4], window: 4, border: 3, joined };
            let mut system = Bordered::new(&unknowns);
            let n = system.unknowns();
            assert_eq!(n, 30);
            let mut full = vec![0.0; n * n];
            let value = |seed: usize| ((seed * 37 + 11) % 17) as f64 * 0.13 - 1.0;
            for seed in 0..60 {
                let segment = if seed % 2 == 0 { 0 } else { 2 };
                let mut control = [[0.0; 8]; 3];
                for (joint, control) in control.iter_mut().enumerate() {
                    control[..4]
                        .iter_mut()
                        .enumerate()
                        .for_each(|(k, c)| *c = value(seed * 12 + joint * 4 + k));
                }
                let mut interval = [0.0; WINDOW];
                (interval[0], interval[1]) = (value(seed + 500), value(seed + 700));
                let others = if joined { vec![(0, control[0]), (2, control[2])] } else { Vec::new() };
                let (joint, first) = (if joined { 1 } else { seed % 3 }, seed % 3);
                let control = control[joint];
                let row =
                    Row { segment, joint, first, control, others, first_interval: 0, interval, value: 0.0 };
                let (weight, last) = (0.5 + value(seed).abs(), value(seed + 900));
                system.add_square(&row, weight, last);
                let mut dense = vec![0.0; n];
                system.add(&row, 1.0, &mut dense);
                dense[n - 1] += last;
                for (i, a) in dense.iter().enumerate() {
                    dense.iter().enumerate().for_each(|(j, b)| full[i * n + j] += weight * a * b);
                }
            }
            system.lift(0.0, 0.7);
            (n - 3..n).for_each(|i| full[i * n + i] += 0.7);
            system.lift(0.01, 0.0);
            let want: Vec<f64> = (0..n).map(|i| i as f64 - 2.5).collect();
            let times = system.times(&want);
            let lifted =
                |i: usize| times[i] - full[i * n..][..n].iter().zip(&want).map(|(a, x)| a * x).sum::<f64>();
            assert!((n - 3..n).all(|i| lifted(i).abs() < 1e-9));
            let mut x = times.clone();
            let whole = system.clone();
            system.factor();
            system.solve(&mut x);
            assert!(x.iter().zip(&want).all(|(x, want)| (x - want).abs() < 1e-9), "{x:?}");
            assert!((0..n - 3).all(|i| lifted(i) / want[i] > 0.01), "{:?}", whole.times(&want));
        }
    }
}
