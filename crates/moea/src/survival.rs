//! The contract of survival, and its findings on the survivors.

use super::Population;
use super::random::Random;

/// A survival's findings on each survivor for the mating that follows, `[n]` each; empty if the survival has none.
#[derive(Debug, Clone, Default)]
pub struct Ranking {
    /// Front of the member, 0 is best.
    pub rank: Vec<u32>,
    /// Crowding distance within the front.
    pub crowding: Vec<f64>,
    /// Reference direction the member is associated with.
    pub direction: Vec<usize>,
    /// Distance to that direction in normalised objectives.
    pub aside: Vec<f64>,
    /// Signed distance to the reference plane in normalised objectives.
    pub plane: Vec<f64>,
}

impl Ranking {
    /// Forgets the members before.
    pub fn clear(&mut self) {
        self.rank.clear();
        self.crowding.clear();
        self.direction.clear();
        self.aside.clear();
        self.plane.clear();
    }
}

/// Chooses the next population from parents and children.
///
/// ```
/// use moea::{Bounds, Population, Problem, Random, Ranking, Settings, Survival, Uniform, optimise_with, silent};
///
/// /// Keeps the members with the least sum of objectives.
/// struct LeastSum;
///
/// impl Survival for LeastSum {
///     fn select(
///         &mut self,
///         merged: &Population,
///         keep: usize,
///         _: &mut Random,
///         chosen: &mut Vec<usize>,
///         ranking: &mut Ranking,
///     ) {
///         ranking.clear();
///         chosen.clear();
///         chosen.extend(0..merged.len());
///         let sum = |i: usize| merged.violation(i) + merged.f(i).iter().sum::<f64>();
///         chosen.sort_by(|&a, &b| sum(a).total_cmp(&sum(b)));
///         chosen.truncate(keep);
///     }
/// }
///
/// # struct Schaffer;
/// # impl Problem for Schaffer {
/// #     type Workspace = ();
/// #     fn bounds(&self) -> Vec<Bounds> { vec![(-10.0, 10.0)] }
/// #     fn objectives(&self) -> usize { 2 }
/// #     fn evaluate(&self, x: &[f64], f: &mut [f64], _: &mut ()) -> f64 {
/// #         (f[0], f[1]) = (x[0].powi(2), (x[0] - 2.0).powi(2));
/// #         0.0
/// #     }
/// # }
/// let found = optimise_with(&Schaffer, &Settings::default(), Uniform::default(), LeastSum, silent)?;
/// assert!((found.population.x(0)[0] - 1.0).abs() < 1e-3);
/// # Ok::<(), moea::MoeaError>(())
/// ```
pub trait Survival: Send {
    /// Writes the indices of `keep` members (all, if fewer) of `merged` into `chosen`, and the
    /// findings on them into `ranking`, in the same order. Both hold those of the call before. An index that
    /// `merged` has not is left out.
    fn select(
        &mut self,
        merged: &Population,
        keep: usize,
        rng: &mut Random,
        chosen: &mut Vec<usize>,
        ranking: &mut Ranking,
    );
}

impl<S: Survival + ?Sized> Survival for Box<S> {
    fn select(
        &mut self,
        merged: &Population,
        keep: usize,
        rng: &mut Random,
        chosen: &mut Vec<usize>,
        ranking: &mut Ranking,
    ) {
        (**self).select(merged, keep, rng, chosen, ranking);
    }
}

/// Feasible members of a population, and the others by growing violation.
#[derive(Debug, Clone, Default)]
pub(super) struct Feasibility {
    pub(super) feasible: Vec<usize>,
    pub(super) infeasible: Vec<usize>,
}

impl Feasibility {
    pub(super) fn split(&mut self, population: &Population) {
        self.feasible.clear();
        self.infeasible.clear();
        for i in 0..population.len() {
            if population.is_feasible(i) {
                self.feasible.push(i);
            } else {
                self.infeasible.push(i);
            }
        }
        self.infeasible.sort_unstable_by(|&a, &b| {
            population.violation(a).total_cmp(&population.violation(b)).then(a.cmp(&b))
        });
    }
}
