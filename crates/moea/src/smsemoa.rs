//! SMS-EMOA: survival by contribution to the hypervolume.
//!
//! # References
//!
//! Beume, Naujoks and Emmerich 2007, doi 10.1016/j.ejor.2006.08.008. Differences: a generation breeds as many
//! children as there are members, not one, and the front that overflows loses its members one by one; the
//! reference point is fixed at eleven times the range of the feasible members, so that units do not matter and the
//! ends of the front stay. Both as in pymoo 0.6.2 for a population without given ranges.

use super::{
    Population,
    indicator::Points,
    random::Random,
    sorting::Sorting,
    survival::{Feasibility, Ranking, Survival},
};

/// Every objective of the reference point, in ranges of the feasible members from their best.
const REFERENCE: f64 = 11.0;

/// Fronts first; the front that overflows loses the member that adds least to its hypervolume, again and again.
///
/// The cost grows with each objective as that of [`contributions`](super::indicator::contributions): a millisecond a
/// generation of 92 on DTLZ2 for three, a fifth of a second for six, three seconds for seven.
#[derive(Debug, Clone, Default)]
pub struct LeastContribution {
    sorting: Sorting,
    feasibility: Feasibility,
    points: Vec<f64>,
    order: Vec<usize>,
    /// Contribution of each member of the front when it was last measured.
    value: Vec<f64>,
    /// Members that were gone at that time; `usize::MAX` for a member that is gone itself.
    measured: Vec<usize>,
}

impl LeastContribution {
    /// Objectives of the front that overflows, `[n][m]`, in ranges of the feasible members.
    fn normalise(&mut self, merged: &Population) {
        let m = merged.objectives();
        self.points.clear();
        self.points.extend(self.order.iter().flat_map(|&i| merged.f(i)));
        for k in 0..m {
            let of = || self.feasibility.feasible.iter().map(|&i| merged.f(i)[k]);
            let ideal = of().fold(f64::INFINITY, f64::min);
            let range = of().fold(f64::NEG_INFINITY, f64::max) - ideal;
            let range = if range > 0.0 { range } else { 1.0 };
            for f in self.points.iter_mut().skip(k).step_by(m) {
                *f = (*f - ideal) / range;
            }
        }
    }

    /// Leaves `keep` members of the front in `order`.
    fn reduce(&mut self, merged: &Population, keep: usize) {
        self.normalise(merged);
        let reference = vec![REFERENCE; merged.objectives()];
        let points = Points { set: &self.points, reference: &reference };
        let (value, measured) = (&mut self.value, &mut self.measured);
        value.clear();
        value.extend(super::indicator::contributions(points.set, points.reference));
        // Without objectives there are no contributions.
        value.resize(self.order.len(), 0.0);
        measured.clear();
        measured.resize(self.order.len(), 0);
        for gone in 0..self.order.len().saturating_sub(keep) {
            // Without others a contribution only grows, so that the least of old ones is a bound of all: most
            // members need not be measured again.
            loop {
                let left = (0..measured.len()).filter(|&i| measured[i] != usize::MAX);
                let Some(least) = left.min_by(|&a, &b| value[a].total_cmp(&value[b])) else { return };
                if measured[least] == gone {
                    measured[least] = usize::MAX;
                    break;
                }
                value[least] = points.contribution(least, |i| measured[i] != usize::MAX);
                measured[least] = gone;
            }
        }
        let mut measured = measured.iter();
        self.order.retain(|_| measured.next().is_some_and(|&measured| measured != usize::MAX));
    }
}

impl Survival for LeastContribution {
    fn select(
        &mut self,
        merged: &Population,
        keep: usize,
        _: &mut Random,
        chosen: &mut Vec<usize>,
        ranking: &mut Ranking,
    ) {
        chosen.clear();
        ranking.clear();
        self.feasibility.split(merged);
        self.sorting.sort(merged, &self.feasibility.feasible);
        let mut rank = 0;
        while chosen.len() < keep && rank < self.sorting.count() {
            self.order.clear();
            self.order.extend_from_slice(self.sorting.front(rank));
            self.order.sort_unstable();
            let room = keep - chosen.len();
            if self.order.len() > room {
                self.reduce(merged, room);
            }
            chosen.extend_from_slice(&self.order);
            ranking.rank.resize(chosen.len(), u32::try_from(rank).unwrap_or(u32::MAX));
            rank += 1;
        }
        chosen.extend(self.feasibility.infeasible.iter().take(keep - chosen.len()));
        ranking.rank.resize(chosen.len(), u32::MAX);
    }
}
