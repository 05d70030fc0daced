//! Levenberg-Marquardt over all runs of a joint, with Huber's weights and priors.

use nalgebra::{DMatrix, DVector};

use super::{
    model::Model,
    parameters::{DEAD_TIME, LIMITS, Priors, SHARED, STICTION},
    robust::{cost, inefficiency, scale, weight},
    run::{Run, Sample},
    simulate::simulate,
};
use crate::units::DEGREE_RAD;

/// Step of the central differences, prior deviations.
const DIFFERENCE: f64 = 2e-3;

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
    /// Limits that the model has.
    pub(super) seen: [bool; 4],
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

impl Workspace {
    /// Measured less predicted angle at the samples of a run that count, rad.
    fn residuals(&mut self, model: &Model, run: &Run, integral_rad_s: f64, part: Part, out: &mut Vec<f64>) {
        self.simulate(model, run, integral_rad_s);
        for sample in run.samples.iter().filter(|sample| part.has(sample)) {
            out.push(sample.measured_rad - self.at(sample));
        }
    }

    pub(super) fn simulate(&mut self, model: &Model, run: &Run, integral_rad_s: f64) {
        let start = super::simulate::Start { integral_rad_s, ..run.start };
        simulate(model, &run.sent, start, &mut self.wanted, &mut self.angle_rad);
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
        self.priors.model(x, self.seen)
    }

    /// All residuals, rad, run by run.
    pub(super) fn residuals(&self, x: &[f64], workspace: &mut Workspace, out: &mut Vec<f64>) {
        out.clear();
        let model = self.model(x);
        for (run, &integral) in self.runs.iter().zip(x.iter().skip(SHARED)) {
            workspace.residuals(&model, run, Priors::integral_rad_s(integral), self.part, out);
        }
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

    /// Indices of the parameters that move.
    pub(super) fn free(&self) -> Vec<usize> {
        let fixed = |i: usize| (LIMITS..SHARED).contains(&i) && !self.seen[i - LIMITS];
        (0..SHARED + self.runs.len()).filter(|&i| !fixed(i)).collect()
    }

    /// Slopes of the residuals in scales, `[sample, free parameter]`.
    pub(super) fn slopes(
        &self,
        x: &[f64],
        free: &[usize],
        scale_rad: f64,
        workspace: &mut Workspace,
    ) -> DMatrix<f64> {
        let counts: Vec<usize> = self
            .runs
            .iter()
            .map(|run| run.samples.iter().filter(|sample| self.part.has(sample)).count())
            .collect();
        let mut slopes = DMatrix::zeros(counts.iter().sum(), free.len());
        let (mut ahead, mut behind, mut x) = (Vec::new(), Vec::new(), x.to_vec());
        // No log of angles tells stiction from dead band: it stays as known beforehand, no better.
        for (column, &i) in free.iter().enumerate().filter(|(_, i)| **i != STICTION) {
            let (kept, mut first) = (x[i], 0);
            let own = i.checked_sub(SHARED);
            ahead.clear();
            behind.clear();
            for (r, run) in self.runs.iter().enumerate() {
                // The integral of a run moves that run alone.
                if own.is_some_and(|own| own != r) {
                    continue;
                }
                for (step, out) in [(DIFFERENCE, &mut ahead), (-DIFFERENCE, &mut behind)] {
                    x[i] = kept + step;
                    let integral = Priors::integral_rad_s(x.get(SHARED + r).copied().unwrap_or_default());
                    workspace.residuals(&self.model(&x), run, integral, self.part, out);
                }
            }
            x[i] = kept;
            if let Some(own) = own {
                first = counts.iter().take(own).sum();
            }
            let share = 1.0 / (2.0 * DIFFERENCE * scale_rad);
            for (row, (a, b)) in ahead.iter().zip(&behind).enumerate() {
                slopes[(first + row, column)] = (a - b) * share;
            }
        }
        slopes
    }

    /// From `x` downhill for at most so many rounds.
    pub(super) fn descend(&self, mut x: Vec<f64>, rounds: usize, workspace: &mut Workspace) -> Estimate {
        let free = self.free();
        let (mut residuals, mut trial) = (Vec::new(), Vec::new());
        self.residuals(&x, workspace, &mut residuals);
        let mut damping = 1e-2;
        let mut still = 0;
        for _ in 0..rounds {
            let scale_rad = scale(residuals.iter().copied(), FINEST_RAD);
            let before = self.cost(&x, &residuals, scale_rad);
            let (mut normal, mut slope) = self.normal(&x, &free, &residuals, scale_rad, workspace);
            normal /= self.inefficiency;
            slope /= self.inefficiency;
            for (k, &i) in free.iter().enumerate() {
                normal[(k, k)] += 1.0;
                slope[k] += x[i];
            }
            let mut better = before;
            for _ in 0..6 {
                let mut damped = normal.clone();
                for k in 0..free.len() {
                    damped[(k, k)] += damping * normal[(k, k)];
                }
                let step = damped.cholesky().map(|cholesky| cholesky.solve(&slope));
                if let Some(step) = step.filter(|step| step.iter().all(|s| s.is_finite())) {
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
    fn moved(&self, x: &[f64], free: &[usize], step: &DVector<f64>) -> Vec<f64> {
        let excess = |(&i, s): (&usize, &f64)| s.abs() / self.priors.of(i).longest_step();
        let shrink = free.iter().zip(step.iter()).map(excess).fold(1.0, f64::max);
        let mut moved = x.to_vec();
        for (&i, s) in free.iter().zip(step.iter()) {
            moved[i] -= s / shrink;
        }
        moved
    }

    /// Weighted normal matrix and slope of the data, in scales.
    pub(super) fn normal(
        &self,
        x: &[f64],
        free: &[usize],
        residuals_rad: &[f64],
        scale_rad: f64,
        workspace: &mut Workspace,
    ) -> (DMatrix<f64>, DVector<f64>) {
        let mut slopes = self.slopes(x, free, scale_rad, workspace);
        let roots: Vec<f64> = residuals_rad.iter().map(|r| weight(r / scale_rad).sqrt()).collect();
        for mut column in slopes.column_iter_mut() {
            for (slope, root) in column.iter_mut().zip(&roots) {
                *slope *= root;
            }
        }
        let weighted = DVector::from_iterator(
            roots.len(),
            residuals_rad.iter().zip(&roots).map(|(r, w)| r / scale_rad * w),
        );
        (slopes.tr_mul(&slopes), slopes.tr_mul(&weighted))
    }

    /// The best of descents from several dead times.
    pub(super) fn search(&self, dead_times_s: &[f64], x: &[f64], workspace: &mut Workspace) -> Estimate {
        let from = |dead_time_s: f64| {
            let mut x = x.to_vec();
            x[DEAD_TIME] = self.priors.of(DEAD_TIME).place(dead_time_s);
            x
        };
        let mut best: Option<(f64, Estimate)> = None;
        let mut residuals = Vec::new();
        let mut common_rad = None;
        for &dead_time_s in dead_times_s {
            let found = self.descend(from(dead_time_s), 8, workspace);
            // Costs compare at one scale only.
            let scale_rad = *common_rad.get_or_insert(found.scale_rad);
            self.residuals(&found.x, workspace, &mut residuals);
            let cost = self.cost(&found.x, &residuals, scale_rad);
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, found));
            }
        }
        let x = best.map_or_else(|| x.to_vec(), |(_, found)| found.x);
        self.descend(x, 30, workspace)
    }
}
