//! How good a population is on a problem with a known front.

use super::{
    Population,
    benchmark::Benchmark,
    direction::MOST_OBJECTIVES,
    indicator::{hypervolume, igd, igd_plus},
};

/// Quality of one population.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quality {
    /// Inverted generational distance, smaller is better.
    pub igd: f64,
    /// IGD+, smaller is better.
    pub igd_plus: f64,
    /// Hypervolume, larger is better, as a share of the box from the least values on the front (0 of a
    /// [`Benchmark`]) to its [`Reference::reference_point`]. What lies beyond the box on the better side adds to it.
    pub hypervolume: f64,
}

/// What a population is measured against.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    front: Vec<f64>,
    /// Where the box begins, and what the front's extent is, `[objectives]` each.
    ideal: Vec<f64>,
    extent: Vec<f64>,
}

/// How far beyond the front the hypervolume's reference point lies.
const BEYOND: f64 = 1.1;

impl Reference {
    /// Measures against a front, `[n][objectives]` in one slice. A front without extent in an objective counts as if it
    /// had an extent of 1 there. Of a slice of another
    /// width distances are NaN.
    pub fn new(front: Vec<f64>, objectives: usize) -> Self {
        let m = objectives.clamp(1, MOST_OBJECTIVES);
        let of = |k: usize| front.iter().skip(k).step_by(m).copied().filter(|f| f.is_finite());
        let least = |k: usize| of(k).reduce(f64::min).unwrap_or(0.0);
        let ideal: Vec<f64> = (0..m).map(least).collect();
        let extent = (0..m).map(|k| of(k).fold(0.0_f64, |extent, f| extent.max(f - ideal[k])));
        let extent = extent.map(|extent| if extent > 0.0 { extent } else { 1.0 }).collect();
        Self { front, ideal, extent }
    }

    /// Measures against about `count` points of [`Benchmark::front`], which is a part of the true front where
    /// [`Benchmark::has_whole_front`] is false.
    pub fn of(problem: &Benchmark, count: usize) -> Self {
        let extent = problem.nadir();
        Self { front: problem.front(count), ideal: vec![0.0; extent.len()], extent }
    }

    /// Number of points that distances are measured to.
    pub fn points(&self) -> usize {
        self.front.len() / self.extent.len()
    }

    /// The hypervolume's reference point in the problem's own objectives, `[objectives]`: 1.1 extents of the front
    /// from its least values.
    pub fn reference_point(&self) -> Vec<f64> {
        self.ideal.iter().zip(&self.extent).map(|(ideal, extent)| ideal + BEYOND * extent).collect()
    }

    /// Quality of the feasible members of a population; of none if it has another number of objectives.
    pub fn measure(&self, population: &Population) -> Quality {
        let m = self.extent.len();
        let set: Vec<f64> = (0..population.len())
            .filter(|&i| population.is_feasible(i) && population.objectives() == m)
            .flat_map(|i| population.f(i).iter().copied())
            .collect();
        let scaled: Vec<f64> = set
            .chunks_exact(m)
            .flat_map(|f| (0..m).map(|k| (f[k] - self.ideal[k]) / (BEYOND * self.extent[k])))
            .collect();
        Quality {
            igd: igd(&set, &self.front, m),
            igd_plus: igd_plus(&set, &self.front, m),
            hypervolume: hypervolume(&scaled, &vec![1.0; m]),
        }
    }
}
