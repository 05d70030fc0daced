//! Curves and fronts as comma-separated values.

use super::{Curve, Form, Front};

/// Convergence, one row for each algorithm and checkpoint.
pub fn curves_csv(form: &Form, curves: &[Curve]) -> String {
    let head = [form.subject, "objectives", "algorithm", "seeds", "evaluations"].map(str::to_owned);
    let quartiles = form
        .measures
        .iter()
        .flat_map(|measure| ["q1", "median", "q3"].map(|quartile| format!("{}_{quartile}", measure.key)));
    let mut rows = vec![head.into_iter().chain(quartiles).collect()];
    for curve in curves {
        rows.extend(curve.points.iter().map(|(evaluations, values)| {
            let mut row = vec![
                curve.subject.clone(),
                curve.objectives.to_string(),
                curve.entrant.name.to_owned(),
                curve.seeds.to_string(),
                evaluations.to_string(),
            ];
            row.extend(values.iter().flatten().map(f64::to_string));
            row
        }));
    }
    csv(rows)
}

/// One row for each member of a front, columns `f1` to `fM`.
pub fn front_csv(front: &Front) -> String {
    let head = (1..=front.objectives).map(|k| format!("f{k}")).collect();
    let members = front.points.chunks_exact(front.objectives.max(1));
    csv(std::iter::once(head).chain(members.map(|f| f.iter().map(f64::to_string).collect())))
}

fn csv(rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        // Writing to memory does not fail.
        let _ = writer.write_record(row);
    }
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_front_has_a_row_a_member_and_a_column_an_objective() {
        let front = Front { name: String::new(), objectives: 2, points: vec![0.25, 1.0, 0.5, 1e-9] };
        assert_eq!(front_csv(&front), "f1,f2\n0.25,1\n0.5,0.000000001\n");
    }
}
