//! As comma-separated values.

use crate::{
    render::kit::csv,
    workflow::moea::{Curve, Front},
};

const CURVE_HEAD: [&str; 14] = [
    "problem",
    "objectives",
    "algorithm",
    "seeds",
    "evaluations",
    "igd_q1",
    "igd_median",
    "igd_q3",
    "igd_plus_q1",
    "igd_plus_median",
    "igd_plus_q3",
    "hypervolume_q1",
    "hypervolume_median",
    "hypervolume_q3",
];

/// Convergence, one row for each algorithm and checkpoint.
pub fn curves_csv(curves: &[Curve]) -> String {
    let rows = curves.iter().flat_map(|curve| {
        curve.points.iter().map(|point| {
            let mut row = vec![
                curve.problem.clone(),
                curve.objectives.to_string(),
                curve.contender.name.to_owned(),
                curve.seeds.to_string(),
                point.evaluations.to_string(),
            ];
            let values = [point.igd, point.igd_plus, point.hypervolume];
            row.extend(values.iter().flatten().map(f64::to_string));
            row
        })
    });
    csv(CURVE_HEAD, rows)
}

/// One row for each member of a front, columns `f1` to `fM`.
pub fn front_csv(front: &Front) -> String {
    let head: Vec<String> = (1..=front.objectives).map(|k| format!("f{k}")).collect();
    let members = front.points.chunks_exact(front.objectives.max(1));
    csv(head.iter().map(String::as_str), members.map(|f| f.iter().map(f64::to_string).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_front_has_a_row_a_member_and_a_column_an_objective() {
        let front = Front {
            problem: "DTLZ2".to_owned(),
            algorithm: "nsga3",
            evaluations: 100,
            seed: 1,
            objectives: 2,
            points: vec![0.25, 1.0, 0.5, 1e-9],
        };
        assert_eq!(front_csv(&front), "f1,f2\n0.25,1\n0.5,0.000000001\n");
    }
}
