//! As comma-separated values.

use crate::workflow::contest::Curve;

/// Convergence, one row for each algorithm and checkpoint.
pub fn contest_csv(curves: &[Curve]) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    // Writing to memory does not fail.
    let _ = writer.write_record([
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
    ]);
    for curve in curves {
        for point in &curve.points {
            let mut row = vec![
                curve.task.clone(),
                curve.entrant.name.to_owned(),
                curve.seeds.to_string(),
                point.evaluations.to_string(),
            ];
            row.extend(
                point.hypervolume.iter().chain(&point.of_all).chain([&curve.reference]).map(f64::to_string),
            );
            let _ = writer.write_record(row);
        }
    }
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}
