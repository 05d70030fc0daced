//! AGE-MOEA-II: survival on the estimated surface of the front.
//!
//! # References
//!
//! Panichella 2022, doi 10.1145/3512290.3528732.
//!
//! Differences to the paper: those of [`geometry`](super::geometry). To pymoo 0.6.2: the distances of a member are divided by its own distance to the ideal, as
//! in the author's program, where pymoo divides by that of its neighbours; of later fronts those nearest
//! to the ideal survive, as in the paper, where pymoo leaves the front that overflows without scores.

use super::{
    Population,
    geometry::Shape,
    random::Random,
    sorting::Sorting,
    survival::{Feasibility, Ranking, Survival},
};

/// Distances to the ideal and to others below this count as this, in normalised objectives.
const NEAR: f64 = 1e-8;

/// Fronts first; of the first front its corners, then those farthest from the two nearest already taken,
/// along the surface that fits the front; of later ones those nearest to the ideal point.
///
/// O(n²) for a first front of n members.
#[derive(Debug, Clone, Default)]
pub struct Geodesic {
    sorting: Sorting,
    feasibility: Feasibility,
    shape: Shape,
    /// By member of the merged population.
    score: Vec<f64>,
    order: Vec<usize>,
}

impl Geodesic {
    /// Fits the shape to the first front, and scores its members.
    fn score_first(&mut self, merged: &Population) {
        let m = merged.objectives();
        if m == 0 {
            return;
        }
        let mut front = self.sorting.front(0).to_vec();
        front.sort_unstable();
        let mut points: Vec<f64> = front.iter().flat_map(|&i| merged.f(i)).copied().collect();
        let mut taken = self.shape.fit(&points, m);
        let mut lengths = Vec::with_capacity(front.len());
        for point in points.chunks_exact_mut(m) {
            self.shape.apply(point);
            let length = self.shape.distance(point);
            lengths.push(if length < NEAR { 1.0 } else { length });
            self.shape.project(point);
        }
        for &place in &taken {
            self.score[front[place]] = f64::INFINITY;
        }
        let mut open: Vec<usize> = (0..front.len()).filter(|place| !taken.contains(place)).collect();
        // Distances to the two nearest that are taken.
        let mut nearest = vec![[f64::INFINITY; 2]; front.len()];
        while !open.is_empty() {
            for new in taken.drain(..) {
                for &place in &open {
                    let apart =
                        self.shape.apart(&points[new * m..][..m], &points[place * m..][..m]).max(NEAR)
                            / lengths[place];
                    let [first, second] = &mut nearest[place];
                    if apart < *first {
                        (*first, *second) = (apart, *first);
                    } else if apart < *second {
                        *second = apart;
                    }
                }
            }
            let value = |at: usize| nearest[open[at]].iter().filter(|d| d.is_finite()).sum::<f64>();
            let best = (1..open.len()).fold(0, |best, at| if value(at) > value(best) { at } else { best });
            let score = value(best);
            let place = open.remove(best);
            self.score[front[place]] = score;
            taken.push(place);
        }
    }

    /// Scores the members of a later front by their distance to the ideal point.
    fn score_later(&mut self, merged: &Population, rank: usize) {
        let mut point = Vec::with_capacity(merged.objectives());
        for &i in self.sorting.front(rank) {
            point.clear();
            point.extend_from_slice(merged.f(i));
            self.shape.apply(&mut point);
            self.score[i] = 1.0 / self.shape.distance(&point).max(NEAR);
        }
    }
}

impl Survival for Geodesic {
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
        self.score.clear();
        self.score.resize(merged.len(), 0.0);
        let mut rank = 0;
        while chosen.len() < keep && rank < self.sorting.count() {
            if rank == 0 {
                self.score_first(merged);
            } else {
                self.score_later(merged, rank);
            }
            self.order.clear();
            self.order.extend_from_slice(self.sorting.front(rank));
            let score = &self.score;
            self.order.sort_unstable_by(|&a, &b| score[b].total_cmp(&score[a]).then(a.cmp(&b)));
            chosen.extend(self.order.iter().take(keep - chosen.len()));
            ranking.rank.resize(chosen.len(), u32::try_from(rank).unwrap_or(u32::MAX));
            rank += 1;
        }
        chosen.extend(self.feasibility.infeasible.iter().take(keep - chosen.len()));
        ranking.rank.resize(chosen.len(), u32::MAX);
        ranking.crowding.extend(chosen.iter().map(|&i| self.score[i]));
    }
}
