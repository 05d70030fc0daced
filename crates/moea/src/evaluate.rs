//! Evaluates members on all cores, with a result that does not depend on how many there are.

use rayon::prelude::*;

use super::{Population, Problem};

/// Beyond this an objective counts as not evaluated, so that differences and squares of
/// objectives stay finite.
const LARGEST: f64 = 1e100;

/// Share of a scale that is kept from one generation to the next.
const KEPT: f64 = 0.8;

/// What is kept from one evaluation of members to the next.
pub(super) struct Evaluation<P: Problem> {
    workspaces: Vec<P::Workspace>,
    /// Violations of the members evaluated last, `[n][constraints]`.
    each: Vec<f64>,
    scales: Scales,
}

/// What a violation of each constraint is divided by: the upper quartile of the violations above 0 of this generation,
/// or four fifths of the scale before, whichever is larger.
///
/// The few that violate a constraint by far more than the rest do not set it. It grows at once where children violate
/// by more than a first population that nearly keeps a constraint, as one found by another run does; and it falls with
/// a constraint that is violated by less and less, which would count for nothing beside the others.
pub(super) struct Scales {
    /// `[constraints]`; 0 until somebody violated it.
    of: Vec<f64>,
    /// Violations since quartiles were last taken, `[n][constraints]`.
    gathered: Vec<f64>,
    /// Members that quartiles are taken of: half of the first generation. Algorithms that evaluate children one at a time
    /// have no generation at once.
    enough: usize,
}

impl<P: Problem> Evaluation<P> {
    pub(super) fn new(problem: &P) -> Self {
        Self { workspaces: Vec::new(), each: Vec::new(), scales: Scales::new(problem.constraints()) }
    }

    /// Evaluates all members that are pending; draws nothing at random, and writes by index. Totals of the population
    /// stay comparable to theirs.
    pub(super) fn evaluate(&mut self, problem: &P, pending: &mut Population, population: &mut Population) {
        let (d, m, n) = (pending.variables().max(1), pending.objectives().max(1), pending.len());
        let c = self.scales.constraints();
        let width = c.max(1);
        let (x, f, violation) = pending.evaluation_parts();
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
        self.scales.add_each(&self.each, pending, population);
    }
}

impl Scales {
    /// For so many constraints.
    pub(super) fn new(constraints: usize) -> Self {
        Self { of: vec![0.0; constraints], gathered: Vec::new(), enough: 0 }
    }

    /// Number of constraints.
    pub(super) fn constraints(&self) -> usize {
        self.of.len()
    }

    /// Adds the violations of single constraints of the members just evaluated, `[n][constraints]`, to their totals,
    /// each by its scale. Where scales change, totals of the population follow: all are in the same scales.
    pub(super) fn add_each(&mut self, each: &[f64], pending: &mut Population, population: &mut Population) {
        if self.of.is_empty() {
            return;
        }
        let changed = self.learn(each);
        pending.divide_totals(each, self.of.len());
        pending.retotal(|parts| self.total(parts));
        if changed {
            population.retotal(|parts| self.total(parts));
        }
    }

    /// Learns from further violations, `[n][constraints]`; returns whether a scale has changed.
    fn learn(&mut self, each: &[f64]) -> bool {
        let c = self.of.len();
        self.gathered.extend_from_slice(each);
        let gathered = self.gathered.len() / c;
        if self.enough == 0 {
            self.enough = gathered.div_ceil(2);
        }
        let is_enough = gathered >= self.enough;
        let mut changed = false;
        for (j, scale) in self.of.iter_mut().enumerate() {
            if is_enough || *scale <= 0.0 {
                let of = self.gathered.iter().skip(j).step_by(c);
                let quartile = upper_quartile(of.copied().filter(|v| *v > 0.0 && *v <= LARGEST).collect());
                if let Some(quartile) = quartile {
                    *scale = quartile.max(KEPT * *scale);
                    changed = true;
                }
            }
        }
        if is_enough {
            self.gathered.clear();
        }
        changed
    }

    /// The total of a member: what `evaluate` returned, and the violations of its constraints by their scales.
    fn total(&self, (base, each): (f64, &[f64])) -> f64 {
        if !each.iter().all(|v| v.abs() <= LARGEST) {
            return f64::INFINITY;
        }
        // What is above 0 has been learnt from, so that its scale is above 0; and it stays above 0 when divided.
        let shares = each.iter().zip(&self.of).filter(|(v, _)| **v > 0.0);
        let sum: f64 = shares.map(|(v, scale)| (v / scale).max(f64::MIN_POSITIVE)).sum();
        base + sum.min(LARGEST)
    }
}

/// The value that a quarter of them is not below; none of none.
fn upper_quartile(mut values: Vec<f64>) -> Option<f64> {
    let at = values.len() * 3 / 4;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(at, f64::total_cmp).1)
}

/// The violation, infinite if anything is not a number of reasonable size. Zeros lose their
/// sign, so that the order of objectives is the order of their bits; what is no number becomes infinite, so that equal members
/// are equal.
pub(super) fn checked(violation: f64, f: &mut [f64]) -> f64 {
    let mut sound = violation.abs() <= LARGEST;
    for value in f {
        *value = if value.is_nan() { f64::INFINITY } else { *value + 0.0 };
        sound &= value.abs() <= LARGEST;
    }
    if sound { violation.max(0.0) } else { f64::INFINITY }
}
