//! One quantity before and after.

use serde::Serialize;

/// A quantity before and after, in its SI unit; `None` where it could not be measured.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Change {
    /// Mean over the runs before.
    pub before: Option<f64>,
    /// Mean over the runs after.
    pub after: Option<f64>,
    /// After minus before.
    pub difference: Option<f64>,
    /// After over before; 1 where both are zero, `None` where only the one before is.
    pub ratio: Option<f64>,
}

impl Change {
    /// From both values.
    pub fn new(before: Option<f64>, after: Option<f64>) -> Self {
        let both = before.zip(after);
        let ratio = both.and_then(|(before, after)| match (before.abs() > 0.0, after.abs() > 0.0) {
            (true, _) => Some(after / before),
            (false, false) => Some(1.0),
            (false, true) => None,
        });
        Self { before, after, difference: both.map(|(before, after)| after - before), ratio }
    }

    /// From the values of the runs on each side.
    pub(super) fn of_runs(before: &[Option<f64>], after: &[Option<f64>]) -> Self {
        Self::new(mean(before), mean(after))
    }
}

/// The mean, if every value is there.
fn mean(values: &[Option<f64>]) -> Option<f64> {
    let all: Vec<f64> = values.iter().copied().collect::<Option<_>>()?;
    (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64)
}
