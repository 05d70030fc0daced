//! Survival of NSGA-III.
//!
//! # References
//!
//! Deb and Jain 2014, doi 10.1109/TEVC.2013.2281535; constraints after Jain and Deb 2014,
//! doi 10.1109/TEVC.2013.2281534.

use super::{
    MoeaError, Population,
    crowding::CrowdingDistance,
    direction::own,
    normalize::Normalizer,
    random::Random,
    sorting::Sorting,
    survival::{Feasibility, Ranking, Survival},
};

/// Reference directions at unit length, objective by objective, so that projections on all of
/// them are formed at once.
#[derive(Debug, Clone)]
struct Rays {
    m: usize,
    count: usize,
    /// `[m][count]`.
    by_objective: Vec<f64>,
    dot: Vec<f64>,
}

impl Rays {
    fn new(directions: &[f64], m: usize) -> Self {
        let count = directions.len() / m;
        let mut by_objective = vec![0.0; m * count];
        for (j, direction) in directions.chunks_exact(m).enumerate() {
            // By a power of two first, which changes no digit: no square is infinite, nor all of them 0.
            let unit = power_of_two(direction.iter().copied().fold(0.0, f64::max));
            let length = direction.iter().map(|z| (z / unit) * (z / unit)).sum::<f64>().sqrt();
            for k in 0..m {
                by_objective[k * count + j] = direction[k] / unit / length;
            }
        }
        Self { m, count, by_objective, dot: vec![0.0; count] }
    }

    /// The direction nearest in angle to a point with no negative coordinate, and the distance
    /// to it; the first of several.
    fn nearest(&mut self, point: &[f64]) -> (usize, f64) {
        self.dot.fill(0.0);
        for (row, &value) in self.by_objective.chunks_exact(self.count).zip(point) {
            for (dot, &z) in self.dot.iter_mut().zip(row) {
                *dot += value * z;
            }
        }
        let (mut best, mut longest) = (0, f64::NEG_INFINITY);
        for (j, &dot) in self.dot.iter().enumerate() {
            if dot > longest {
                (best, longest) = (j, dot);
            }
        }
        let longest = if longest.is_finite() { longest } else { 0.0 };
        let aside = (0..self.m)
            .map(|k| (point[k] - longest * self.by_objective[k * self.count + best]).powi(2))
            .sum::<f64>();
        (best, aside.sqrt())
    }
}

/// The largest power of two that is not above `value`, 2^-1022 at least.
fn power_of_two(value: f64) -> f64 {
    f64::from_bits(value.to_bits() & f64::INFINITY.to_bits()).max(f64::MIN_POSITIVE)
}

/// Survival of NSGA-III for fixed reference directions.
#[derive(Debug, Clone)]
pub struct Niching {
    rays: Rays,
    normalizer: Normalizer,
    sorting: Sorting,
    feasibility: Feasibility,
    /// Members that may survive: fronts up to the one that overflows.
    candidates: Vec<usize>,
    rank: Vec<u32>,
    normalised: Vec<f64>,
    direction: Vec<usize>,
    distance: Vec<f64>,
    plane: Vec<f64>,
    crowd: Vec<usize>,
    tied: Vec<usize>,
    /// Members of the overflowing front by direction.
    waiting: Vec<Vec<usize>>,
    /// Distances for [`Self::filled_by_crowding`].
    crowding: Option<CrowdingDistance>,
}

/// Share of the places above which surplus ones are filled by crowding.
const SURPLUS: f64 = 0.1;

impl Niching {
    /// For reference directions, `[count][m]` in one slice and of any length, of a problem with `m` objectives. Of a population with
    /// another number of objectives the first members survive.
    ///
    /// # Errors
    ///
    /// [`MoeaError::NoObjectives`]; [`MoeaError::DirectionCount`] and [`MoeaError::Direction`] for directions that are
    /// none.
    pub fn new(directions: &[f64], m: usize) -> Result<Self, MoeaError> {
        if m == 0 {
            return Err(MoeaError::NoObjectives);
        }
        own(m, directions.chunks(m)).map(|_| Self::of(directions, m))
    }

    /// As [`Self::new`], for directions that have been checked.
    pub(super) fn of(directions: &[f64], m: usize) -> Self {
        let rays = Rays::new(directions, m);
        let count = rays.count;
        Self {
            rays,
            normalizer: Normalizer::new(m),
            sorting: Sorting::default(),
            feasibility: Feasibility::default(),
            candidates: Vec::new(),
            rank: Vec::new(),
            normalised: vec![0.0; m],
            direction: Vec::new(),
            distance: Vec::new(),
            plane: Vec::new(),
            crowd: vec![0; count],
            tied: Vec::with_capacity(count),
            waiting: vec![Vec::new(); count],
            crowding: None,
        }
    }

    /// As [`Self::new`], but once every direction that has candidates has a member, and more than a
    /// tenth of the places is still open, the least crowded of the overflowing front get them, not
    /// random ones. Where a front meets few of the directions, most places are of this kind.
    ///
    /// # Errors
    ///
    /// As [`Self::new`].
    pub fn filled_by_crowding(directions: &[f64], m: usize) -> Result<Self, MoeaError> {
        Self::new(directions, m).map(Self::with_crowding)
    }

    pub(super) fn with_crowding(self) -> Self {
        Self { crowding: Some(CrowdingDistance::default()), ..self }
    }

    /// Directions, distances to them and to the reference plane of all candidates.
    fn associate(&mut self, merged: &Population) {
        self.direction.clear();
        self.distance.clear();
        self.plane.clear();
        let root = (self.normalised.len() as f64).sqrt();
        for &i in &self.candidates {
            self.normalizer.apply(merged.f(i), &mut self.normalised);
            let (direction, distance) = self.rays.nearest(&self.normalised);
            self.direction.push(direction);
            self.distance.push(distance);
            self.plane.push((self.normalised.iter().sum::<f64>() - 1.0) / root);
        }
    }

    /// Fills `chosen` (places among the candidates) from those at `sure..`, one niche at a time.
    fn fill(
        &mut self,
        merged: &Population,
        (sure, keep): (usize, usize),
        rng: &mut Random,
        chosen: &mut Vec<usize>,
    ) {
        self.crowd.fill(0);
        for &direction in &self.direction[..sure] {
            self.crowd[direction] += 1;
        }
        for waiting in &mut self.waiting {
            waiting.clear();
        }
        for place in sure..self.candidates.len() {
            self.waiting[self.direction[place]].push(place);
        }
        let mut open: usize = self.waiting.iter().filter(|w| !w.is_empty()).count();
        chosen.extend(0..sure);
        while chosen.len() < keep && open > 0 {
            let least = (0..self.crowd.len())
                .filter(|&j| !self.waiting[j].is_empty())
                .map(|j| self.crowd[j])
                .min()
                .unwrap_or(0);
            if least > 0
                && (keep - chosen.len()) as f64 > SURPLUS * keep as f64
                && let Some(crowding) = &mut self.crowding
            {
                crowding.measure(merged, &self.candidates[sure..]);
                self.tied.clear();
                self.tied.extend(self.waiting.iter().flatten());
                crowding.sort(&mut self.tied, |place| self.candidates[place]);
                chosen.extend(self.tied.iter().take(keep - chosen.len()));
                return;
            }
            self.tied.clear();
            self.tied.extend(
                (0..self.crowd.len()).filter(|&j| self.crowd[j] == least && !self.waiting[j].is_empty()),
            );
            // All niches that are least crowded get one member, in random order, before any
            // gets a second: the same as drawing them one by one.
            for taken in 0..self.tied.len().min(keep - chosen.len()) {
                let other = taken + rng.below(self.tied.len() - taken);
                self.tied.swap(taken, other);
                let j = self.tied[taken];
                let waiting = &mut self.waiting[j];
                let pick = if least == 0 {
                    let mut nearest = 0;
                    for (at, &place) in waiting.iter().enumerate() {
                        if self.distance[place] < self.distance[waiting[nearest]] {
                            nearest = at;
                        }
                    }
                    nearest
                } else {
                    rng.below(waiting.len())
                };
                chosen.push(waiting.swap_remove(pick));
                self.crowd[j] += 1;
                if waiting.is_empty() {
                    open -= 1;
                }
            }
        }
    }
}

impl Survival for Niching {
    fn select(
        &mut self,
        merged: &Population,
        keep: usize,
        rng: &mut Random,
        chosen: &mut Vec<usize>,
        ranking: &mut Ranking,
    ) {
        chosen.clear();
        ranking.clear();
        if merged.objectives() != self.normalised.len() {
            chosen.extend(0..keep.min(merged.len()));
            return;
        }
        self.feasibility.split(merged);
        let feasible = &self.feasibility.feasible;
        self.sorting.sort(merged, feasible);
        self.normalizer.update(merged, feasible, self.sorting.front(0));
        self.candidates.clear();
        self.rank.clear();
        let (mut sure, mut rank) = (0, 0);
        while self.candidates.len() < keep && rank < self.sorting.count() {
            sure = self.candidates.len();
            self.candidates.extend_from_slice(self.sorting.front(rank));
            self.rank.resize(self.candidates.len(), u32::try_from(rank).unwrap_or(u32::MAX));
            rank += 1;
        }
        self.associate(merged);
        if let Some(crowding) = &mut self.crowding {
            crowding.reset(merged.len());
        }
        if self.candidates.len() <= keep {
            chosen.extend(0..self.candidates.len());
        } else {
            self.fill(merged, (sure, keep), rng, chosen);
        }
        ranking.rank.extend(chosen.iter().map(|&place| self.rank[place]));
        ranking.direction.extend(chosen.iter().map(|&place| self.direction[place]));
        ranking.aside.extend(chosen.iter().map(|&place| self.distance[place]));
        ranking.plane.extend(chosen.iter().map(|&place| self.plane[place]));
        for place in chosen.iter_mut() {
            *place = self.candidates[*place];
        }
        if let Some(crowding) = &mut self.crowding {
            // Fronts stand one after the other.
            let mut start = 0;
            for front in ranking.rank.chunk_by(|a, b| a == b) {
                crowding.measure(merged, &chosen[start..start + front.len()]);
                start += front.len();
            }
            ranking.crowding.extend(chosen.iter().map(|&i| crowding.of(i)));
        }
        let missing = keep.saturating_sub(chosen.len());
        chosen.extend(self.feasibility.infeasible.iter().take(missing));
        ranking.rank.resize(chosen.len(), u32::MAX);
        ranking.crowding.resize(if self.crowding.is_some() { chosen.len() } else { 0 }, 0.0);
        ranking.direction.resize(chosen.len(), usize::MAX);
        ranking.aside.resize(chosen.len(), f64::INFINITY);
        ranking.plane.resize(chosen.len(), f64::INFINITY);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{das_dennis, random::Stream};

    /// Survivors by growing first objective, and the next random number.
    fn survivors(mut niching: Niching, f: &[f64], keep: usize) -> (Vec<f64>, f64) {
        let (mut chosen, mut ranking) = (Vec::new(), Ranking::default());
        let mut rng = Random::new(3, Stream::Survival);
        niching.select(&Population::from_objectives(f, 3), keep, &mut rng, &mut chosen, &mut ranking);
        assert_eq!((chosen.len(), ranking.rank.len()), (keep, keep));
        let mut first: Vec<f64> = chosen.iter().map(|&i| f[3 * i]).collect();
        first.sort_unstable_by(f64::total_cmp);
        (first, rng.unit())
    }

    #[test]
    fn surplus_places_go_to_the_least_crowded_and_to_the_ends() {
        // A line from (0, 0, 1) to (1, 1, 0), three quarters of it in its first tenth; few directions.
        let crowded = (0..60).map(|i| f64::from(i) / 600.0);
        let at = crowded.chain((1..=20).map(|i| 0.1 + 0.045 * f64::from(i)));
        let line: Vec<f64> = at.flat_map(|t| [t, t, 1.0 - t]).collect();
        let directions = das_dennis(3, 2).unwrap();
        let (random, _) = survivors(Niching::new(&directions, 3).unwrap(), &line, 40);
        let (spread, _) = survivors(Niching::filled_by_crowding(&directions, 3).unwrap(), &line, 40);
        let sparse = |kept: &[f64]| kept.iter().filter(|&&t| t > 0.1).count();
        assert_eq!(sparse(&spread), 20);
        assert!(sparse(&random) < 20, "{random:?}");
        assert!(spread[0] < 1e-12 && spread[39] > 1.0 - 1e-12, "{spread:?}");
    }

    #[test]
    fn the_length_of_a_direction_does_not_matter() {
        let line: Vec<f64> = (0..=20).map(f64::from).flat_map(|i| [i / 20.0, 1.0 - i / 20.0, 0.0]).collect();
        for make in [Niching::new, Niching::filled_by_crowding] {
            let kept = |length: f64| {
                let directions = [1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0].map(|z| z * length);
                survivors(make(&directions, 3).unwrap(), &line, 3).0
            };
            for length in [1.0, 3.0, 1e150, 1e160, 1e308, 1e-150, 1e-170, 1e-320] {
                assert_eq!(kept(length), [0.0, 0.5, 1.0], "{length:e}");
            }
        }
    }

    #[test]
    fn a_tenth_of_the_places_or_less_is_filled_at_random() {
        let directions = das_dennis(3, 12).unwrap();
        let front = [directions.clone(), das_dennis(3, 23).unwrap()].concat();
        // 91 niches have a member each; 10 places of 101 are a tenth, 11 of 102 are more.
        for (keep, equal) in [(101, true), (102, false)] {
            let random = survivors(Niching::new(&directions, 3).unwrap(), &front, keep);
            let spread = survivors(Niching::filled_by_crowding(&directions, 3).unwrap(), &front, keep);
            assert_eq!(spread == random, equal, "{keep}");
        }
    }
}
