//! Levenberg-Marquardt over all runs of a joint, with Huber's weights and priors.

use nalgebra::{DMatrix, DVector};

use super::{
    model::Model,
    model::STEP_S,
    parameters::{Priors, SHARED, STICTION, Shown},
    robust::{cost, inefficiency, scale, weight},
    run::{ASKED_OVER_S, Run, Sample, steps_in},
    simulate::{LANES, Start, simulate, simulate_lanes},
};
use crate::units::DEGREE_RAD;

/// Step of the differences, prior deviations.
const DIFFERENCE: f64 = 1e-3;

/// Residuals are never told apart more finely, rad: resolution of an encoder of 16 bits.
const FINEST_RAD: f64 = 0.002 * DEGREE_RAD;

/// A round that gains less than this in the cost, a logarithm of likelihood, is one of the last.
const GAIN: f64 = 0.02;

/// Which samples count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    All,
    /// All but those of one fold.
    Without(usize),
}

impl Part {
    pub(super) fn has(self, sample: &Sample) -> bool {
        match self {
            Self::All => true,
            Self::Without(fold) => sample.fold != fold,
        }
    }
}

/// The runs of one joint and what to fit to them.
#[derive(Debug, Clone)]
pub(super) struct Problem<'a> {
    pub(super) runs: &'a [Run],
    pub(super) priors: &'a Priors,
    /// What the model has.
    pub(super) shown: Shown,
    pub(super) part: Part,
    /// Statistical inefficiency: correlated residuals per effective sample; divides their cost.
    pub(super) inefficiency: f64,
}

/// Where an estimate has come to.
#[derive(Debug, Clone)]
pub(super) struct Estimate {
    /// Shared parameters, then the integral of each run.
    pub(super) x: Vec<f64>,
    /// Robust scale of the residuals, rad.
    pub(super) scale_rad: f64,
}

/// Workspace that all simulations of a problem share.
#[derive(Debug, Default)]
pub(super) struct Workspace {
    wanted: Vec<f64>,
    angle_rad: Vec<f64>,
}

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
    /// With the priors, for data whose cost is divided by their inefficiency.
    fn with_priors(mut self, inefficiency: f64, x: &[f64], free: &[usize]) -> Self {
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
    fn step(&self, damping: f64) -> Option<Vec<f64>> {
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

impl Workspace {
    /// Measured less predicted angle at the samples of a run that count, rad.
    fn residuals(&mut self, model: &Model, run: &Run, integral_rad_s: f64, part: Part, out: &mut Vec<f64>) {
        self.simulate(model, run, integral_rad_s);
        for sample in run.samples.iter().filter(|sample| part.has(sample)) {
            out.push(sample.measured_rad - self.at(sample));
        }
    }

    pub(super) fn simulate(&mut self, model: &Model, run: &Run, integral_rad_s: f64) {
        let start = Start { integral_rad_s, ..run.start };
        simulate(model, &run.sent, start, &mut self.wanted, &mut self.angle_rad);
    }

    /// Fastest growing and shrinking of the angle in the run simulated last, rad/s, over a tenth of a second.
    pub(super) fn fastest(&self) -> [f64; 2] {
        let steps = steps_in(ASKED_OVER_S).max(1);
        let later = self.angle_rad.get(steps..).unwrap_or_default();
        let speeds = later.iter().zip(&self.angle_rad).map(|(b, a)| (b - a) / (steps as f64 * STEP_S));
        speeds.fold([0.0; 2], |[up, down], speed| [up.max(speed), down.max(-speed)])
    }

    /// Predicted angle at a sample of the run simulated last, rad.
    pub(super) fn at(&self, sample: &Sample) -> f64 {
        match self.angle_rad.get(sample.step..sample.step + 2) {
            Some(&[a, b]) => a + sample.part * (b - a),
            _ => f64::NAN,
        }
    }
}

impl Problem<'_> {
    pub(super) fn model(&self, x: &[f64]) -> Model {
        self.priors.model(x, self.shown)
    }

    /// All residuals, rad, run by run.
    pub(super) fn residuals(&self, x: &[f64], workspace: &mut Workspace, out: &mut Vec<f64>) {
        out.clear();
        let model = self.model(x);
        for (run, &integral) in self.runs.iter().zip(x.iter().skip(SHARED)) {
            workspace.residuals(&model, run, Priors::integral_rad_s(integral), self.part, out);
        }
    }

    /// Measured less predicted angle of the longest run, rad, every step of the model.
    pub(super) fn longest_left_rad(&self, x: &[f64], workspace: &mut Workspace) -> Vec<f64> {
        let longest = self.runs.iter().zip(x.iter().skip(SHARED)).max_by_key(|(run, _)| run.sent.len());
        let Some((run, &integral)) = longest else { return Vec::new() };
        workspace.simulate(&self.model(x), run, Priors::integral_rad_s(integral));
        let left = run.samples.iter().map(|sample| (sample.step, sample.measured_rad - workspace.at(sample)));
        let mut left_rad = Vec::with_capacity(run.sent.len());
        // A step without a sample keeps the value before.
        left.for_each(|(step, left)| left_rad.resize(step + 1 - run.samples[0].step, left));
        left_rad
    }

    /// As [`inefficiency`] of the residuals.
    pub(super) fn measured_inefficiency(&self, x: &[f64], workspace: &mut Workspace) -> f64 {
        let mut residuals = Vec::new();
        self.residuals(x, workspace, &mut residuals);
        inefficiency(&residuals)
    }

    /// Cost of residuals at a scale, with the priors' part.
    pub(super) fn cost(&self, x: &[f64], residuals_rad: &[f64], scale_rad: f64) -> f64 {
        let data: f64 = residuals_rad.iter().map(|r| cost(r / scale_rad)).sum();
        let total = data / self.inefficiency + 0.5 * x.iter().map(|x| x * x).sum::<f64>();
        if total.is_nan() { f64::INFINITY } else { total }
    }

    /// The same of the residuals at `x`.
    pub(super) fn cost_at(&self, x: &[f64], scale_rad: f64, workspace: &mut Workspace) -> f64 {
        let mut residuals = Vec::new();
        self.residuals(x, workspace, &mut residuals);
        self.cost(x, &residuals, scale_rad)
    }

    /// Indices of the shared parameters that move.
    pub(super) fn free(&self) -> Vec<usize> {
        (0..SHARED).filter(|&i| self.shown.has(i)).collect()
    }

    /// Slopes of a run's residuals in scales, a column a parameter: those of `free`, then its integral. `residuals_rad` are those at `x`.
    fn slopes(
        &self,
        x: &[f64],
        free: &[usize],
        r: usize,
        residuals_rad: &[f64],
        scale_rad: f64,
        workspace: &mut Workspace,
    ) -> DMatrix<f64> {
        let run = &self.runs[r];
        let counted = || run.samples.iter().filter(|sample| self.part.has(sample));
        let mut slopes = DMatrix::zeros(counted().count(), free.len() + 1);
        // No log of angles tells stiction from dead band: it stays as known beforehand, no better.
        let moving = free.iter().copied().enumerate().filter(|(_, i)| *i != STICTION);
        let columns: Vec<(usize, usize)> = moving.chain([(free.len(), SHARED)]).collect();
        let own: [f64; SHARED + 1] = std::array::from_fn(|i| x[if i < SHARED { i } else { SHARED + r }]);
        let share = 1.0 / (DIFFERENCE * scale_rad);
        for group in columns.chunks(LANES) {
            let lane = |lane: usize| {
                let mut x = own;
                x[group[lane.min(group.len() - 1)].1] += DIFFERENCE;
                let integral_rad_s = Priors::integral_rad_s(x[SHARED]);
                (self.model(&x), Start { integral_rad_s, ..run.start })
            };
            let lanes: [(Model, Start); LANES] = std::array::from_fn(lane);
            let Workspace { wanted, angle_rad } = workspace;
            let (models, starts) =
                (lanes.each_ref().map(|lane| &lane.0), lanes.each_ref().map(|lane| lane.1));
            simulate_lanes(models, &run.sent, starts, wanted, angle_rad);
            for ((row, sample), residual_rad) in counted().enumerate().zip(residuals_rad) {
                let Some(at) = angle_rad.get(LANES * sample.step..LANES * (sample.step + 2)) else {
                    continue;
                };
                let before_rad = sample.measured_rad - residual_rad;
                for (place, (column, _)) in group.iter().enumerate() {
                    let (here, next) = (at[place], at[LANES + place]);
                    slopes[(row, *column)] = (before_rad - here - sample.part * (next - here)) * share;
                }
            }
        }
        slopes
    }

    /// From `x` downhill for at most so many rounds.
    pub(super) fn descend(&self, mut x: Vec<f64>, rounds: usize, workspace: &mut Workspace) -> Estimate {
        let free = self.free();
        let (mut residuals, mut trial) = (Vec::new(), Vec::new());
        self.residuals(&x, workspace, &mut residuals);
        let mut damping = if self.part == Part::All { 1e-2 } else { 1e-4 };
        let mut still = 0;
        for _ in 0..rounds {
            let scale_rad = scale(residuals.iter().copied(), FINEST_RAD);
            let before = self.cost(&x, &residuals, scale_rad);
            let normal = self.normal(&x, &free, &residuals, scale_rad, workspace);
            let normal = normal.with_priors(self.inefficiency, &x, &free);
            let mut better = before;
            for _ in 0..6 {
                if let Some(step) = normal.step(damping) {
                    let moved = self.moved(&x, &free, &step);
                    self.residuals(&moved, workspace, &mut trial);
                    let cost = self.cost(&moved, &trial, scale_rad);
                    if cost < before {
                        x = moved;
                        std::mem::swap(&mut residuals, &mut trial);
                        better = cost;
                        damping = (damping * 0.2_f64).max(1e-7);
                        break;
                    }
                }
                damping *= 8.0;
            }
            still = if before - better > GAIN { 0 } else { still + 1 };
            if still >= 2 || damping > 1e7 {
                break;
            }
        }
        let scale_rad = scale(residuals.iter().copied(), FINEST_RAD);
        Estimate { x, scale_rad }
    }

    /// `x` less a step, no longer than each parameter may go at once.
    fn moved(&self, x: &[f64], free: &[usize], step: &[f64]) -> Vec<f64> {
        let moving = || free.iter().copied().chain(SHARED..x.len()).zip(step);
        let excess = |(i, s): (usize, &f64)| s.abs() / self.priors.of(i).longest_step();
        let shrink = moving().map(excess).fold(1.0, f64::max);
        let mut moved = x.to_vec();
        for (i, s) in moving() {
            moved[i] -= s / shrink;
        }
        moved
    }

    /// Weighted normal equations of the data, in scales.
    pub(super) fn normal(
        &self,
        x: &[f64],
        free: &[usize],
        residuals_rad: &[f64],
        scale_rad: f64,
        workspace: &mut Workspace,
    ) -> Normal {
        let own = free.len();
        let mut normal =
            Normal { shared: DMatrix::zeros(own, own), slope: DVector::zeros(own), runs: Vec::new() };
        let mut first = 0;
        for r in 0..self.runs.len() {
            let mut slopes = self.slopes(x, free, r, &residuals_rad[first..], scale_rad, workspace);
            let residuals = DVector::from_column_slice(&residuals_rad[first..first + slopes.nrows()]);
            first += slopes.nrows();
            let roots = residuals.map(|r| weight(r / scale_rad).sqrt());
            for mut column in slopes.column_iter_mut() {
                column.component_mul_assign(&roots);
            }
            let slope = slopes.tr_mul(&(residuals / scale_rad).component_mul(&roots));
            let square = slopes.tr_mul(&slopes);
            normal.shared += square.view((0, 0), (own, own));
            normal.slope += slope.rows(0, own);
            normal.runs.push((
                square.view((0, own), (own, 1)).column(0).into_owned(),
                square[(own, own)],
                slope[own],
            ));
        }
        normal
    }

    /// The best of short descents from several places, once it has come down.
    pub(super) fn search(
        &self,
        from: impl IntoIterator<Item = Vec<f64>>,
        workspace: &mut Workspace,
    ) -> Estimate {
        let mut best: Option<(f64, Estimate)> = None;
        let mut common_rad = None;
        for x in from {
            let found = self.descend(x, 8, workspace);
            // Costs compare at one scale only.
            let scale_rad = *common_rad.get_or_insert(found.scale_rad);
            let cost = self.cost_at(&found.x, scale_rad, workspace);
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, found));
            }
        }
        let x = best.map_or_else(|| vec![0.0; SHARED + self.runs.len()], |(_, found)| found.x);
        self.descend(x, 30, workspace)
    }
}
