//! The quadratic programme of one step, by a primal-dual interior-point method (Mehrotra 1992, doi:10.1137/0802028)
//! on the bordered blocks of [`super::factor`].

use super::{factor::Bordered, model::Row};

/// Price of breaking the linearised limits, against weights of the merit that sum to one.
pub(super) const PRICE: f64 = 20.0;

/// Regularisation of the equations' multipliers.
const PROXIMAL: f64 = 1e-8;
const ITERATIONS: usize = 60;
const ENOUGH: f64 = 1e-9;
/// Share of the way to the nearest bound that a step goes.
const WAY: f64 = 0.995;

/// A bound on the border's unknowns: the sum of coefficients times them is at most that.
pub(super) struct Edge {
    pub(super) entries: Vec<(usize, f64)>,
    pub(super) most: f64,
}

/// Lessens 1/2 x'Hx + g'x + PRICE t with `sign value + sign row x <= 1 + t` for limits, `row x = -value` for passes,
/// edges, and t >= 0. The border is the intervals and, last, t.
pub(super) struct Programme<'a> {
    /// H, without what bounds add to it.
    pub(super) hessian: &'a Bordered,
    /// g.
    pub(super) gradient: &'a [f64],
    /// Limits with the sign of the side that is bounded.
    pub(super) limits: &'a [(&'a Row, f64)],
    pub(super) passes: &'a [Row],
    pub(super) edges: &'a [Edge],
}

impl Programme<'_> {
    /// x, t last, and the multipliers of the limits; as near to the least as rounding lets it come.
    pub(super) fn solve(&self) -> (Vec<f64>, Vec<f64>) {
        let n = self.hessian.unknowns();
        let (m, e) = (self.limits.len() + self.edges.len() + 1, self.passes.len());
        let mut state = State { x: vec![0.0; n], s: vec![0.0; m], z: vec![0.0; m], nu: vec![0.0; e] };
        // t starts where every limit holds.
        let worst = self.limits.iter().fold(0.0, |most: f64, (row, sign)| most.max(sign * row.value - 1.0));
        state.x[n - 1] = worst + 0.1;
        let broken = self.broken(&state.x);
        for ((s, z), broken) in state.s.iter_mut().zip(&mut state.z).zip(&broken) {
            *s = (-broken).max(1e-2);
            *z = 1e-2 / *s;
        }
        let mut system = self.hessian.clone();
        for _ in 0..ITERATIONS {
            let residual = self.residual(&state);
            let gap = state.gap();
            let dual = residual.dual.iter().fold(0.0, |most: f64, r| most.max(r.abs()));
            let primal = residual.bound.iter().chain(&residual.pass).fold(0.0, |most: f64, r| most.max(r.abs()));
            if gap < ENOUGH && dual < 1e-6 && primal < 1e-9 {
                break;
            }
            if !gap.is_finite() || !dual.is_finite() {
                break;
            }
            self.assemble(&mut system, &state);
            system.factor();
            let centre: Vec<f64> = state.s.iter().zip(&state.z).map(|(s, z)| s * z).collect();
            let predicted = self.direction(&system, &state, &residual, &centre);
            let reach = predicted.reach(&state, 1.0);
            let after: f64 = (state.s.iter().zip(&state.z).zip(predicted.s.iter().zip(&predicted.z)))
                .map(|((s, z), (ds, dz))| (s + reach[0] * ds) * (z + reach[1] * dz))
                .sum::<f64>()
                / m as f64;
            let sigma = (after / gap).clamp(0.0, 1.0).powi(3);
            let corrected: Vec<f64> = (centre.iter().zip(predicted.s.iter().zip(&predicted.z)))
                .map(|(centre, (ds, dz))| centre + ds * dz - sigma * gap)
                .collect();
            let step = self.direction(&system, &state, &residual, &corrected);
            let [primal, dual] = step.reach(&state, WAY);
            let both = primal.min(dual);
            state.add(&step, both, both);
        }
        state.z.truncate(self.limits.len());
        (state.x, state.z)
    }

    /// Rows times x less their bounds.
    fn broken(&self, x: &[f64]) -> Vec<f64> {
        let t = x[x.len() - 1];
        let border = self.hessian.border_start();
        let limits = self.limits.iter().map(|(row, sign)| sign * (row.value + self.dot(row, x)) - 1.0 - t);
        let edges = self.edges.iter().map(|edge| {
            edge.entries.iter().map(|(i, a)| a * x[border + i]).sum::<f64>() - edge.most
        });
        limits.chain(edges).chain([-t]).collect()
    }

    fn dot(&self, row: &Row, x: &[f64]) -> f64 {
        let (control, interval) = self.hessian.places(row);
        let own = x[control].iter().zip(&row.control).map(|(x, a)| x * a).sum::<f64>();
        own + x[interval].iter().zip(&row.interval).map(|(x, a)| x * a).sum::<f64>()
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
        let (limits, edges) = z.split_at(self.limits.len());
        for ((row, sign), z) in self.limits.iter().zip(limits) {
            self.hessian.add(row, sign * z, to);
            to[last] -= z;
        }
        for (edge, z) in self.edges.iter().zip(edges) {
            for (i, a) in &edge.entries {
                to[border + i] += z * a;
            }
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
    fn direction(&self, system: &Bordered, state: &State, residual: &Residual, less: &[f64]) -> State {
        let inner: Vec<f64> = (state.z.iter().zip(&residual.bound).zip(less.iter().zip(&state.s)))
            .map(|((z, bound), (less, s))| (z * bound - less) / s)
            .collect();
        let mut x = residual.dual.clone();
        self.add_transposed(&inner, &mut x);
        for (row, pass) in self.passes.iter().zip(&residual.pass) {
            self.hessian.add(row, pass / PROXIMAL, &mut x);
        }
        x.iter_mut().for_each(|x| *x = -*x);
        system.solve(&mut x);
        let t = x[x.len() - 1];
        let border = self.hessian.border_start();
        let limits = self.limits.iter().map(|(row, sign)| sign * self.dot(row, &x) - t);
        let edges = self.edges.iter().map(|edge| edge.entries.iter().map(|(i, a)| a * x[border + i]).sum::<f64>());
        let s: Vec<f64> = (limits.chain(edges).chain([-t]).zip(&residual.bound)).map(|(moved, bound)| -bound - moved).collect();
        let z = (s.iter().zip(less)).zip(state.z.iter().zip(&state.s)).map(|((ds, less), (z, s))| -(less + z * ds) / s).collect();
        let nu = (self.passes.iter().zip(&residual.pass)).map(|(row, pass)| (self.dot(row, &x) + pass) / PROXIMAL).collect();
        State { x, s, z, nu }
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

    /// Longest steps that keep slacks and multipliers positive, as direction; at most 1.
    fn reach(&self, from: &Self, way: f64) -> [f64; 2] {
        let longest = |values: &[f64], steps: &[f64]| {
            let limits = values.iter().zip(steps).filter(|(_, step)| **step < 0.0);
            limits.fold(1.0, |most: f64, (value, step)| most.min(-way * value / step))
        };
        [longest(&from.s, &self.s), longest(&from.z, &self.z)]
    }

    fn add(&mut self, step: &Self, primal: f64, dual: f64) {
        let add = |to: &mut [f64], from: &[f64], by: f64| to.iter_mut().zip(from).for_each(|(to, from)| *to += by * from);
        add(&mut self.x, &step.x, primal);
        add(&mut self.s, &step.s, primal);
        add(&mut self.z, &step.z, dual);
        add(&mut self.nu, &step.nu, dual);
    }
}
