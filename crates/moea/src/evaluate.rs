//! Evaluates members on all cores, with a result that does not depend on how many there are.

use rayon::prelude::*;

use super::{Population, Problem};

/// Beyond this an objective counts as not evaluated, so that differences and squares of
/// objectives stay finite.
const LARGEST: f64 = 1e100;

/// What is kept from one evaluation of members to the next.
pub(super) struct Evaluation<P: Problem> {
    workspaces: Vec<P::Workspace>,
    /// Violations of the members evaluated last, `[n][constraints]`.
    each: Vec<f64>,
    scales: Scales,
}

/// What a violation of each constraint is divided by, `[constraints]`; 0 until somebody violated it.
pub(super) struct Scales(pub(super) Vec<f64>);

impl<P: Problem> Evaluation<P> {
    pub(super) fn new(problem: &P) -> Self {
        Self { workspaces: Vec::new(), each: Vec::new(), scales: Scales(vec![0.0; problem.constraints()]) }
    }

    /// Evaluates all members; draws nothing at random, and writes by index.
    pub(super) fn evaluate(&mut self, problem: &P, population: &mut Population) {
        let (d, m, n) = (population.variables().max(1), population.objectives().max(1), population.len());
        let c = self.scales.0.len();
        let width = c.max(1);
        let (x, f, violation) = population.evaluation_parts();
        self.each.clear();
        self.each.resize(n * width, 0.0);
        let pieces =
            if problem.is_cheap() { 1 } else { (4 * rayon::current_num_threads()).clamp(1, n.max(1)) };
        self.workspaces.resize_with(pieces.max(self.workspaces.len()), P::Workspace::default);
        let run = |x: &[f64], f: &mut [f64], v: &mut [f64], each: &mut [f64], memory: &mut P::Workspace| {
            let members =
                x.chunks_exact(d).zip(f.chunks_exact_mut(m)).zip(v).zip(each.chunks_exact_mut(width));
            for (((x, f), violation), each) in members {
                *violation = problem.evaluate(x, f, memory);
                if c > 0 {
                    problem.violations(x, f, each, memory);
                }
                *violation = checked(*violation, f);
            }
        };
        if pieces == 1 {
            if let Some(memory) = self.workspaces.first_mut() {
                run(x, f, violation, &mut self.each, memory);
            }
        } else {
            let piece = n.div_ceil(pieces).max(1);
            x.par_chunks(piece * d)
                .zip(f.par_chunks_mut(piece * m))
                .zip(violation.par_chunks_mut(piece))
                .zip(self.each.par_chunks_mut(piece * width))
                .zip(self.workspaces.par_iter_mut())
                .for_each(|((((x, f), violation), each), memory)| run(x, f, violation, each, memory));
        }
        self.scales.add_each(&self.each, violation);
    }
}

impl Scales {
    /// Adds the violations of single constraints, `[n][constraints]`, to the totals, `[n]`, each by its scale.
    pub(super) fn add_each(&mut self, each: &[f64], total: &mut [f64]) {
        let c = self.0.len();
        if c == 0 {
            return;
        }
        for (j, scale) in self.0.iter_mut().enumerate().filter(|(_, scale)| **scale <= 0.0) {
            let sound = each.iter().skip(j).step_by(c).filter(|v| **v <= LARGEST);
            *scale = sound.fold(0.0, |largest, &v| v.max(largest));
        }
        for (total, each) in total.iter_mut().zip(each.chunks_exact(c)) {
            // A constraint without a scale has been violated by nobody.
            let shares = each.iter().zip(&self.0).filter(|(v, _)| **v > 0.0);
            let sum = shares.map(|(v, scale)| v / scale).sum::<f64>().min(LARGEST);
            let sound = each.iter().all(|v| v.abs() <= LARGEST);
            *total = if sound { *total + sum } else { f64::INFINITY };
        }
    }
}

/// The violation, infinite if anything is not a number of reasonable size. Zeros lose their
/// sign, so that the order of objectives is the order of their bits.
pub(super) fn checked(violation: f64, f: &mut [f64]) -> f64 {
    let mut sound = violation.abs() <= LARGEST;
    for value in f {
        *value += 0.0;
        sound &= value.abs() <= LARGEST;
    }
    if sound { violation.max(0.0) } else { f64::INFINITY }
}
