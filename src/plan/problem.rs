//! A setup as a problem for evolutionary algorithms: one variable an interval, three objectives.

use super::{Evaluator, Setup};
use crate::moea::{Bounds, Problem};

impl Problem for Setup {
    type Workspace = Option<Evaluator>;

    fn bounds(&self) -> Vec<Bounds> {
        vec![(self.interval_s[0], self.interval_s[1]); self.interval_count()]
    }

    fn objectives(&self) -> usize {
        3
    }

    fn evaluate(&self, x: &[f64], objectives: &mut [f64], workspace: &mut Self::Workspace) -> f64 {
        let evaluator = workspace.get_or_insert_with(|| Evaluator::new(self));
        match evaluator.evaluate(self, x) {
            Some(found) => {
                objectives.copy_from_slice(&found.as_array());
                evaluator.violation()
            }
            None => f64::INFINITY,
        }
    }
}
