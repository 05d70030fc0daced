//! Levenberg-Marquardt over all runs of a joint, with Huber's weights and priors.

use super::{
    model::STEP_S,
    model::{Model, steps_in},
    normal::{Normal, Row, WIDTH},
    parameters::{Priors, SHARED, STICTION, Shown},
    robust::{cost, inefficiency, scale, weight},
    run::{ASKED_OVER_S, Run, Sample},
    simulate::{LANES, Start, simulate, simulate_lanes},
};
use crate::{math::deviation, units::DEGREE_RAD};

/// Step of the differences, prior deviations.
const DIFFERENCE: f64 = 1e-3;

/// Residuals are never told apart more finely, rad: resolution of an encoder of 16 bits.
const FINEST_RAD: f64 = 0.002 * DEGREE_RAD;

/// Share of the squared tracking error below which what is left is of no part of the model.
const EXPLAINED: f64 = 3e-4;

/// Rounds of a descent without a part that was tried.
const ROUNDS_WITHOUT: usize = 38;

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

    /// Whether `with`, an estimate of a problem with one part more, costs less by more than `least` than an estimate of this one: `found`,
    /// and what a descent from there without the part comes to, for what a descent gains is not the part's own.
    pub(super) fn gains(
        &self,
        least: f64,
        more: &Self,
        with: &Estimate,
        found: &Estimate,
        workspace: &mut Workspace,
    ) -> bool {
        let most = more.cost_at(&with.x, found.scale_rad, workspace) + least;
        self.cost_at(&found.x, found.scale_rad, workspace) > most && {
            let without = self.descend(with.x.clone(), ROUNDS_WITHOUT, workspace);
            self.cost_at(&without.x, found.scale_rad, workspace) > most
        }
    }

    /// Whether hardly anything is left that another part of the model could explain.
    pub(super) fn explains(&self, x: &[f64], workspace: &mut Workspace) -> bool {
        self.leaves(x, workspace) < EXPLAINED
    }

    /// Share of the squared tracking error, sent less measured about its mean, that is left at `x`.
    pub(super) fn leaves(&self, x: &[f64], workspace: &mut Workspace) -> f64 {
        let mut residuals = Vec::new();
        self.residuals(x, workspace, &mut residuals);
        let squares = residuals.iter().map(|left| left * left).sum::<f64>();
        let error_rad = |run: &Run| -> Vec<f64> {
            let counted = run.samples.iter().filter(|sample| self.part.has(sample));
            counted.map(|sample| run.sent_rad(sample) - sample.measured_rad).collect()
        };
        let errors: Vec<f64> = self.runs.iter().flat_map(error_rad).collect();
        squares / (errors.len() as f64 * deviation(&errors).powi(2)).max(f64::MIN_POSITIVE)
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

    /// Residuals of a run and their slopes, in scales and weighted, a row a sample; `residuals_rad` are those at `x`.
    fn rows(
        &self,
        x: &[f64],
        free: &[usize],
        r: usize,
        residuals_rad: &[f64],
        scale_rad: f64,
        workspace: &mut Workspace,
    ) -> Vec<Row> {
        let run = &self.runs[r];
        let counted: Vec<&Sample> = run.samples.iter().filter(|sample| self.part.has(sample)).collect();
        let mut rows = vec![[0.0; WIDTH]; counted.len()];
        // No log of angles tells stiction from dead band: it stays as known beforehand, no better.
        let moving = free.iter().copied().enumerate().filter(|(_, i)| *i != STICTION);
        let columns: Vec<(usize, usize)> = moving.chain([(free.len(), SHARED)]).collect();
        let own: [f64; SHARED + 1] = std::array::from_fn(|i| x[if i < SHARED { i } else { SHARED + r }]);
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
            for ((row, sample), residual_rad) in rows.iter_mut().zip(&counted).zip(residuals_rad) {
                let Some(at) = angle_rad.get(LANES * sample.step..LANES * (sample.step + 2)) else {
                    continue;
                };
                let before_rad = sample.measured_rad - residual_rad;
                for (place, (column, _)) in group.iter().enumerate() {
                    let (here, next) = (at[place], at[LANES + place]);
                    row[*column] = (before_rad - here - sample.part * (next - here)) / DIFFERENCE;
                }
            }
        }
        for (row, residual_rad) in rows.iter_mut().zip(residuals_rad) {
            row[free.len() + 1] = *residual_rad;
            let share = weight(residual_rad / scale_rad).sqrt() / scale_rad;
            for value in row {
                *value *= share;
            }
        }
        rows
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
        let mut normal = Normal::of(free.len());
        let mut first = 0;
        for r in 0..self.runs.len() {
            let rows = self.rows(x, free, r, &residuals_rad[first..], scale_rad, workspace);
            first += rows.len();
            normal.add(&rows);
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
