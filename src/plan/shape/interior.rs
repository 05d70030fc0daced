//! The quadratic programme of one step, by a primal-dual interior-point method (Mehrotra 1992, doi:10.1137/0802028)
//! on the bordered blocks of [`super::factor`].

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::{factor::Bordered, row::Row};
use crate::math::dot;

/// Price of breaking the linearised limits, against weights of the merit that sum to one.
pub(super) const PRICE: f64 = 20.0;

/// Regularisation of the equations' multipliers.
const PROXIMAL: f64 = 1e-8;
const ITERATIONS: usize = 60;
const ENOUGH: f64 = 1e-9;
/// Steps shorter than this are not worth a correction.
const STUCK: f64 = 0.1;
/// Share of the way to the nearest bound that a step goes.
const WAY: f64 = 0.995;

/// A bound on the border's unknowns: the sum of coefficients times them is at most that.
pub(super) struct Edge {
    pub(super) entries: Vec<(usize, f64)>,
    pub(super) most: f64,
}

/// A value that depends on every unknown: it and its slopes times them are at most t.
pub(super) struct Ceiling {
    pub(super) slope: Vec<f64>,
    pub(super) value: f64,
}

/// What solves a programme, and its multipliers.
pub(super) struct Solved {
    /// t last.
    pub(super) x: Vec<f64>,
    pub(super) limits: Vec<f64>,
    pub(super) ceilings: Vec<f64>,
}

/// Lessens 1/2 x'Hx + g'x + PRICE t with `sign value + sign row x <= 1 + t` for limits, `row x = -value` for passes,
/// edges, ceilings, and t >= 0. The border is the intervals and, last, t.
pub(super) struct Programme<'a> {
    /// H, without what bounds add to it.
    pub(super) hessian: &'a Bordered,
    /// g.
    pub(super) gradient: &'a [f64],
    /// Limits with the sign of the side that is bounded.
    pub(super) limits: &'a [(&'a Row, f64)],
    pub(super) passes: &'a [Row],
    pub(super) edges: &'a [Edge],
    pub(super) ceilings: Vec<&'a Ceiling>,
}

impl Programme<'_> {
    /// As near to the least as rounding lets it come.
    pub(super) fn solve(&self) -> Solved {
        let n = self.hessian.unknowns();
        let (m, e) = (self.limits.len() + self.edges.len() + self.ceilings.len() + 1, self.passes.len());
        let mut state = State { x: vec![0.0; n], s: vec![0.0; m], z: vec![0.0; m], nu: vec![0.0; e] };
        // t starts where every limit holds.
        let worst = self.limits.iter().fold(0.0, |most: f64, (row, sign)| most.max(sign * row.value - 1.0));
        let worst = self.ceilings.iter().fold(worst, |most, ceiling| most.max(ceiling.value));
        state.x[n - 1] = worst + 0.1;
        let broken = self.broken(&state.x);
        state.s.iter_mut().zip(&broken).for_each(|(s, broken)| *s = (-broken).max(1e-2));
        // Equal products, and multipliers that together are the price: t neither runs away nor is held.
        let product = PRICE / state.s.iter().map(|s| 1.0 / s).sum::<f64>();
        state.z.iter_mut().zip(&state.s).for_each(|(z, s)| *z = product / s);
        let mut system = self.hessian.clone();
        for _ in 0..ITERATIONS {
            let residual = self.residual(&state);
            let gap = state.gap();
            let dual = residual.dual.iter().fold(0.0, |most: f64, r| most.max(r.abs()));
            let primal =
                residual.bound.iter().chain(&residual.pass).fold(0.0, |most: f64, r| most.max(r.abs()));
            if gap < ENOUGH && dual < 1e-6 && primal < 1e-9 {
                break;
            }
            if !gap.is_finite() || !dual.is_finite() {
                break;
            }
            self.assemble(&mut system, &state);
            system.factor();
            let system = &Squared::of(&system, &self.ceilings, &state.z, &state.s);
            let centre: Vec<f64> = state.s.iter().zip(&state.z).map(|(s, z)| s * z).collect();
            let predicted = self.direction(system, &state, &residual, &centre);
            let reach = predicted.reach(&state, 1.0);
            let after: f64 = (state.s.iter().zip(&state.z).zip(predicted.s.iter().zip(&predicted.z)))
                .map(|((s, z), (ds, dz))| (s + reach * ds) * (z + reach * dz))
                .sum::<f64>()
                / m as f64;
            let sigma = (after / gap).clamp(0.0, 1.0).powi(3);
            let corrected: Vec<f64> = (centre.iter().zip(predicted.s.iter().zip(&predicted.z)))
                .map(|(centre, (ds, dz))| centre + ds * dz - sigma * gap)
                .collect();
            let mut step = self.direction(system, &state, &residual, &corrected);
            if step.reach(&state, WAY) < STUCK {
                // A correction far from the path may lead about in circles; back to the path first.
                let central: Vec<f64> = centre.iter().map(|centre| centre - 0.5 * gap).collect();
                step = self.direction(system, &state, &residual, &central);
            }
            let reach = step.reach(&state, WAY);
            state.add(&step, reach);
        }
        let ceilings = state.z[m - 1 - self.ceilings.len()..m - 1].to_vec();
        state.z.truncate(self.limits.len());
        Solved { x: state.x, limits: state.z, ceilings }
    }

    /// Rows times x less their bounds.
    fn broken(&self, x: &[f64]) -> Vec<f64> {
        let t = x[x.len() - 1];
        let border = self.hessian.border_start();
        let limits = self.limits.iter().map(|(row, sign)| sign * (row.value + self.dot(row, x)) - 1.0 - t);
        let edges = self
            .edges
            .iter()
            .map(|edge| edge.entries.iter().map(|(i, a)| a * x[border + i]).sum::<f64>() - edge.most);
        let ceilings = self.ceilings.iter().map(|ceiling| ceiling.value + dot(&ceiling.slope, x) - t);
        limits.chain(edges).chain(ceilings).chain([-t]).collect()
    }

    fn dot(&self, row: &Row, x: &[f64]) -> f64 {
        self.hessian.entries(row).map(|(i, a)| a * x[i]).sum()
    }

    fn residual(&self, state: &State) -> Residual {
        let mut dual = self.hessian.times(&state.x);
        dual.iter_mut().zip(self.gradient).for_each(|(to, g)| *to += g);
        self.add_transposed(&state.z, &mut dual);
        for (row, nu) in self.passes.iter().zip(&state.nu) {
            self.hessian.add(row, *nu, &mut dual);
        }
        let last = dual.len() - 1;
        dual[last] += PRICE;
        let bound = self.broken(&state.x).iter().zip(&state.s).map(|(broken, s)| broken + s).collect();
        let pass = self.passes.iter().map(|row| row.value + self.dot(row, &state.x)).collect();
        Residual { dual, bound, pass }
    }

    /// Adds the transposed rows of the bounds times `z`.
    fn add_transposed(&self, z: &[f64], to: &mut [f64]) {
        let (border, last) = (self.hessian.border_start(), to.len() - 1);
        let (limits, rest) = z.split_at(self.limits.len());
        let (edges, rest) = rest.split_at(self.edges.len());
        for ((row, sign), z) in self.limits.iter().zip(limits) {
            self.hessian.add(row, sign * z, to);
            to[last] -= z;
        }
        for (edge, z) in self.edges.iter().zip(edges) {
            for (i, a) in &edge.entries {
                to[border + i] += z * a;
            }
        }
        for (ceiling, z) in self.ceilings.iter().zip(rest) {
            to.iter_mut().zip(&ceiling.slope).for_each(|(to, a)| *to += z * a);
            to[last] -= z;
        }
        to[last] -= z[z.len() - 1];
    }

    fn assemble(&self, system: &mut Bordered, state: &State) {
        system.copy_from(self.hessian);
        let weights: Vec<f64> = state.z.iter().zip(&state.s).map(|(z, s)| z / s).collect();
        for ((row, sign), weight) in self.limits.iter().zip(&weights) {
            system.add_square(row, *weight, -sign);
        }
        for row in self.passes {
            system.add_square(row, 1.0 / PROXIMAL, 0.0);
        }
        for (edge, weight) in self.edges.iter().zip(&weights[self.limits.len()..]) {
            system.add_edge(&edge.entries, *weight);
        }
        system.add_last(weights[weights.len() - 1]);
    }

    /// Newton's direction towards products `s z` less by `less`.
    fn direction(&self, system: &Squared<'_>, state: &State, residual: &Residual, less: &[f64]) -> State {
        let inner: Vec<f64> = (state.z.iter().zip(&residual.bound).zip(less.iter().zip(&state.s)))
            .map(|((z, bound), (less, s))| (z * bound - less) / s)
            .collect();
        let mut x = residual.dual.clone();
        self.add_transposed(&inner, &mut x);
        for (row, pass) in self.passes.iter().zip(&residual.pass) {
            self.hessian.add(row, pass / PROXIMAL, &mut x);
        }
        for x in &mut x {
            *x = -*x;
        }
        system.solve(&mut x);
        let t = x[x.len() - 1];
        let border = self.hessian.border_start();
        let limits = self.limits.iter().map(|(row, sign)| sign * self.dot(row, &x) - t);
        let edges =
            self.edges.iter().map(|edge| edge.entries.iter().map(|(i, a)| a * x[border + i]).sum::<f64>());
        let ceilings = self.ceilings.iter().map(|ceiling| dot(&ceiling.slope, &x) - t);
        let s: Vec<f64> = (limits.chain(edges).chain(ceilings).chain([-t]).zip(&residual.bound))
            .map(|(moved, bound)| -bound - moved)
            .collect();
        let z = (s.iter().zip(less))
            .zip(state.z.iter().zip(&state.s))
            .map(|((ds, less), (z, s))| -(less + z * ds) / s)
            .collect();
        let nu = (self.passes.iter().zip(&residual.pass))
            .map(|(row, pass)| (self.dot(row, &x) + pass) / PROXIMAL)
            .collect();
        State { x, s, z, nu }
    }
}

/// A factored system to which squares of a few dense rows are added (Woodbury).
struct Squared<'a> {
    system: &'a Bordered,
    /// Rows, t's coefficient last, and the system's solutions for them.
    rows: Vec<[Vec<f64>; 2]>,
    small: Option<Cholesky<f64, Dyn>>,
}

impl<'a> Squared<'a> {
    /// Rows of ceilings by the weights that their slacks and multipliers, before those of t, give them.
    fn of(system: &'a Bordered, ceilings: &[&Ceiling], z: &[f64], s: &[f64]) -> Self {
        let rows: Vec<[Vec<f64>; 2]> = ceilings
            .iter()
            .map(|ceiling| {
                let mut row = ceiling.slope.clone();
                let last = row.len() - 1;
                row[last] -= 1.0;
                let mut solved = row.clone();
                system.solve(&mut solved);
                [row, solved]
            })
            .collect();
        let first = z.len() - 1 - rows.len();
        let small = DMatrix::from_fn(rows.len(), rows.len(), |i, j| {
            dot(&rows[i][0], &rows[j][1]) + if i == j { s[first + i] / z[first + i] } else { 0.0 }
        });
        Self { system, rows, small: Cholesky::new(small) }
    }

    fn solve(&self, x: &mut [f64]) {
        self.system.solve(x);
        let along = DVector::from_iterator(self.rows.len(), self.rows.iter().map(|[row, _]| dot(row, x)));
        let Some(by) = self.small.as_ref().map(|small| small.solve(&along)) else { return };
        for ([_, solved], by) in self.rows.iter().zip(&by) {
            x.iter_mut().zip(solved).for_each(|(x, a)| *x -= by * a);
        }
    }
}

/// Unknowns, slacks, multipliers of bounds and of passes; or a direction of them.
struct State {
    x: Vec<f64>,
    s: Vec<f64>,
    z: Vec<f64>,
    nu: Vec<f64>,
}

struct Residual {
    dual: Vec<f64>,
    bound: Vec<f64>,
    pass: Vec<f64>,
}

impl State {
    /// Mean product of slack and multiplier.
    fn gap(&self) -> f64 {
        self.s.iter().zip(&self.z).map(|(s, z)| s * z).sum::<f64>() / self.s.len() as f64
    }

    /// The longest step that keeps slacks and multipliers positive, as direction; at most 1.
    fn reach(&self, from: &Self, way: f64) -> f64 {
        let longest = |values: &[f64], steps: &[f64]| {
            let limits = values.iter().zip(steps).filter(|(_, step)| **step < 0.0);
            limits.fold(1.0, |most: f64, (value, step)| most.min(-way * value / step))
        };
        longest(&from.s, &self.s).min(longest(&from.z, &self.z))
    }

    fn add(&mut self, step: &Self, by: f64) {
        let add = |to: &mut [f64], from: &[f64]| {
            to.iter_mut().zip(from).for_each(|(to, from)| *to += by * from);
        };
        add(&mut self.x, &step.x);
        add(&mut self.s, &step.s);
        add(&mut self.z, &step.z);
        add(&mut self.nu, &step.nu);
    }
}

#[cfg(test)]
mod tests {
    use super::{super::factor::Unknowns, *};
    use crate::spline::WINDOW;

    fn row(control: f64, interval: f64, value: f64) -> Row {
        let mut row = Row {
            segment: 0,
            first: 0,
            joint: 0,
            control: [0.0; 8],
            others: Vec::new(),
            first_interval: 0,
            interval: [0.0; WINDOW],
            value,
        };
        (row.control[0], row.interval[0]) = (control, interval);
        row
    }

    /// Least of 1/2 |x - (2, 1)|².
    fn towards(
        limits: &[(&Row, f64)],
        passes: &[Row],
        edges: &[Edge],
        ceilings: &[Ceiling],
    ) -> (Vec<f64>, Vec<f64>) {
        let mut hessian =
            Bordered::new(&Unknowns { joints: 1, free: vec![1], window: 1, border: 2, joined: false });
        hessian.add_square(&row(1.0, 0.0, 0.0), 1.0, 0.0);
        hessian.add_square(&row(0.0, 1.0, 0.0), 1.0, 0.0);
        hessian.lift(0.0, 1e-9);
        let ceilings = ceilings.iter().collect();
        let solved =
            Programme { hessian: &hessian, gradient: &[-2.0, -1.0, 0.0], limits, passes, edges, ceilings }
                .solve();
        (solved.x, solved.limits.into_iter().chain(solved.ceilings).collect())
    }

    fn near(found: &[f64], want: [f64; 2]) {
        assert!(
            found.iter().zip(want).all(|(found, want)| (found - want).abs() < 1e-5),
            "{found:?} {want:?}"
        );
    }

    #[test]
    fn a_programme_stops_at_limits_edges_and_passes() {
        near(&towards(&[], &[], &[], &[]).0, [2.0, 1.0]);
        let (x, multipliers) = towards(&[(&row(1.0, 0.0, 0.0), 1.0)], &[], &[], &[]);
        near(&x, [1.0, 1.0]);
        assert!((multipliers[0] - 1.0).abs() < 1e-4, "{multipliers:?}");
        near(&towards(&[(&row(-1.0, 0.0, -0.5), -1.0)], &[], &[], &[]).0, [0.5, 1.0]);
        near(&towards(&[], &[], &[Edge { entries: vec![(0, 1.0)], most: 0.25 }], &[]).0, [2.0, 0.25]);
        near(&towards(&[], &[row(1.0, 1.0, -1.0)], &[], &[]).0, [1.0, 0.0]);
        // x + y <= 1 and x - y <= 0.5.
        let ceiling = |y: f64, value: f64| Ceiling { slope: vec![1.0, y, 0.0], value };
        near(&towards(&[], &[], &[], &[ceiling(1.0, -1.0)]).0, [1.0, 0.0]);
        let (x, multipliers) = towards(&[], &[], &[], &[ceiling(1.0, -1.0), ceiling(-1.0, -0.5)]);
        near(&x, [0.75, 0.25]);
        assert!(
            (multipliers[0] - 1.0).abs() < 1e-4 && (multipliers[1] - 0.25).abs() < 1e-4,
            "{multipliers:?}"
        );
    }

    #[test]
    fn limits_that_contradict_each_other_are_broken_as_little_as_possible() {
        // x <= -1 and x >= 1.
        let (x, _) = towards(&[(&row(1.0, 0.0, 2.0), 1.0), (&row(1.0, 0.0, -2.0), -1.0)], &[], &[], &[]);
        near(&x, [0.0, 1.0]);
        assert!((x[2] - 1.0).abs() < 1e-4, "{x:?}");
    }
}
