//! How the front of a search grew.

use serde::{Deserialize, Serialize};

use crate::plan::{Progress, Reference};

/// Where a search was.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Step {
    /// Evaluations made.
    pub evaluations: u64,
    /// Share of the box of the final front that was dominated by then.
    pub hypervolume: f64,
}

/// Fronts kept at most.
const MOST: usize = 64;

/// Fronts on the way, evenly spaced in generations however long the search.
#[derive(Debug, Default)]
pub(super) struct Growth {
    fronts: Vec<(u64, Vec<Vec<f64>>)>,
    seen: u64,
    stride: u64,
}

impl Growth {
    pub(super) fn see(&mut self, progress: &Progress<'_>) {
        self.stride = self.stride.max(1);
        let due = self.seen.is_multiple_of(self.stride);
        self.seen += 1;
        if !due {
            return;
        }
        let population = progress.population;
        let front = population.front().into_iter().filter(|&i| population.violation(i) <= 0.0);
        let front = front.map(|i| population.f(i).to_vec()).collect();
        self.fronts.push((progress.evaluations, front));
        if self.fronts.len() > MOST {
            let mut place = 0_usize;
            self.fronts.retain(|_| {
                place += 1;
                place % 2 == 1
            });
            self.stride = self.stride.saturating_mul(2);
        }
    }

    /// By the box of the final front, which ends it. A population may forget what was found before it;
    /// what counts is the most until then.
    pub(super) fn steps(&self, reference: Reference, evaluations: u64, hypervolume: f64) -> Vec<Step> {
        let mut most: f64 = 0.0;
        let step = |(evaluations, front): &(u64, Vec<Vec<f64>>)| {
            most = most.max(reference.measure(front.iter().map(Vec::as_slice)));
            Step { evaluations: *evaluations, hypervolume: most }
        };
        let before = self.fronts.iter().filter(|(then, _)| *then < evaluations);
        before.map(step).chain([Step { evaluations, hypervolume }]).collect()
    }
}
