//! As comma-separated values.

use crate::{render::kit::csv, workflow::contest::Curve};

/// Convergence, one row for each algorithm and checkpoint.
pub fn contest_csv(curves: &[Curve]) -> String {
    let head = [
        "task",
        "algorithm",
        "seeds",
        "evaluations",
        "hypervolume_q1",
        "hypervolume_median",
        "hypervolume_q3",
        "of_all_q1",
        "of_all_median",
        "of_all_q3",
        "reference_hypervolume",
    ];
    let rows = curves.iter().flat_map(|curve| {
        curve.points.iter().map(|point| {
            let mut row = vec![
                curve.task.clone(),
                curve.entrant.name.to_owned(),
                curve.seeds.to_string(),
                point.evaluations.to_string(),
            ];
            let values = point.hypervolume.iter().chain(&point.of_all).chain([&curve.reference]);
            row.extend(values.map(f64::to_string));
            row
        })
    });
    csv(head, rows)
}
