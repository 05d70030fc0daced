//! How good a population is on a problem with a known front.

use super::{
    Population,
    benchmark::Benchmark,
    indicator::{hypervolume, igd, igd_plus},
};

/// Quality of one population.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quality {
    /// Inverted generational distance, smaller is better.
    pub igd: f64,
    /// IGD+, smaller is better.
    pub igd_plus: f64,
    /// Hypervolume, larger is better: objectives are divided by 1.1 times the largest on the
    /// front, and the reference point is (1, ..., 1). The whole box counts as 1.
    pub hypervolume: f64,
}

/// What a population is measured against.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    front: Vec<f64>,
    nadir: Vec<f64>,
}

/// How far beyond the front the hypervolume's reference point lies.
const BEYOND: f64 = 1.1;

impl Reference {
    /// Measures against a front, `[n][objectives]` in one slice.
    pub fn new(front: Vec<f64>, objectives: usize) -> Self {
        let m = objectives.max(1);
        let nadir =
            (0..m).map(|k| front.iter().skip(k).step_by(m).fold(0.0_f64, |most, &f| most.max(f))).collect();
        Self { front, nadir }
    }

    /// Measures against at most about `count` points of the true front.
    pub fn of(problem: &Benchmark, count: usize) -> Self {
        Self { front: problem.front(count), nadir: problem.nadir() }
    }

    /// Number of points that distances are measured to.
    pub fn points(&self) -> usize {
        self.front.len() / self.nadir.len().max(1)
    }

    /// The hypervolume's reference point in the problem's own objectives, `[objectives]`.
    pub fn reference_point(&self) -> Vec<f64> {
        self.nadir.iter().map(|nadir| BEYOND * nadir).collect()
    }

    /// Quality of the feasible members of a population.
    pub fn measure(&self, population: &Population) -> Quality {
        let m = self.nadir.len();
        let set: Vec<f64> = (0..population.len())
            .filter(|&i| population.is_feasible(i))
            .flat_map(|i| population.f(i).iter().copied())
            .collect();
        let scaled: Vec<f64> = set
            .chunks_exact(m)
            .flat_map(|f| f.iter().zip(&self.nadir).map(|(f, nadir)| f / (BEYOND * nadir)))
            .collect();
        Quality {
            igd: igd(&set, &self.front, m),
            igd_plus: igd_plus(&set, &self.front, m),
            hypervolume: hypervolume(&scaled, &vec![1.0; m]),
        }
    }
}
