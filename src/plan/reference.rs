//! The box that hypervolumes of fronts are measured in.

use crate::moea::indicator::hypervolume;

/// How far beyond the range of a front the hypervolume's reference point lies.
pub const BEYOND: f64 = 1.1;

/// A box that hypervolumes are measured in, fixed by the first front seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reference {
    ideal: [f64; 3],
    range: [f64; 3],
}

impl Reference {
    /// From the best of each objective to [`BEYOND`] times the range of these objectives.
    pub fn of(front: impl Iterator<Item = [f64; 3]>) -> Self {
        let (mut ideal, mut worst) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for f in front {
            for k in 0..3 {
                ideal[k] = ideal[k].min(f[k]);
                worst[k] = worst[k].max(f[k]);
            }
        }
        Self { ideal, range: std::array::from_fn(|k| (worst[k] - ideal[k]).max(f64::MIN_POSITIVE)) }
    }

    /// The corner of the best.
    pub fn ideal(&self) -> [f64; 3] {
        self.ideal
    }

    /// The corner that hypervolumes are measured from.
    pub fn reference_point(&self) -> [f64; 3] {
        std::array::from_fn(|k| self.ideal[k] + BEYOND * self.range[k])
    }

    /// Share of the box that a front dominates.
    pub fn measure(&self, front: impl Iterator<Item = [f64; 3]>) -> f64 {
        let scaled: Vec<f64> = front
            .flat_map(|f| (0..3).map(move |k| (f[k] - self.ideal[k]) / self.range[k] / BEYOND))
            .collect();
        hypervolume(&scaled, &[1.0; 3])
    }
}
