//! Evaluates members on all cores, with a result that does not depend on how many there are.

use rayon::prelude::*;

use super::{Population, Problem};

/// Beyond this an objective counts as not evaluated, so that differences and squares of
/// objectives stay finite.
const LARGEST: f64 = 1e100;

/// Evaluates members from `first` on; draws nothing at random, and writes by index.
pub(super) fn evaluate<P: Problem>(
    problem: &P,
    population: &mut Population,
    first: usize,
    workspaces: &mut Vec<P::Workspace>,
) {
    let (d, m) = (population.variables().max(1), population.objectives().max(1));
    let (x, f, violation) = population.evaluation_parts();
    let (x, f, violation) = (&x[first * d..], &mut f[first * m..], &mut violation[first..]);
    let n = violation.len();
    let pieces = if problem.is_cheap() { 1 } else { (4 * rayon::current_num_threads()).clamp(1, n.max(1)) };
    while workspaces.len() < pieces {
        workspaces.push(P::Workspace::default());
    }
    let run = |x: &[f64], f: &mut [f64], violation: &mut [f64], workspace: &mut P::Workspace| {
        for ((x, f), violation) in x.chunks_exact(d).zip(f.chunks_exact_mut(m)).zip(violation) {
            *violation = checked(problem.evaluate(x, f, workspace), f);
        }
    };
    if pieces == 1 {
        if let Some(workspace) = workspaces.first_mut() {
            run(x, f, violation, workspace);
        }
        return;
    }
    let piece = n.div_ceil(pieces);
    x.par_chunks(piece * d)
        .zip(f.par_chunks_mut(piece * m))
        .zip(violation.par_chunks_mut(piece))
        .zip(workspaces.par_iter_mut())
        .for_each(|(((x, f), violation), workspace)| run(x, f, violation, workspace));
}

/// The violation, infinite if anything is not a number of reasonable size. Zeros lose their
/// sign, so that the order of objectives is the order of their bits.
fn checked(violation: f64, f: &mut [f64]) -> f64 {
    let mut sound = violation.abs() <= LARGEST;
    for value in f {
        *value += 0.0;
        sound &= value.abs() <= LARGEST;
    }
    if sound { violation.max(0.0) } else { f64::INFINITY }
}
