//! Times that are no ms: no joint goes as fast as it would have.

use super::{Quantity, Role, run::CsvRun, time::is_dated};
use crate::{
    math::{median, quantile},
    units::{DEGREE_RAD, seconds_since},
};

/// Joints of machines are slower, rad/s or m/s.
const FASTEST: f64 = 30.0;
/// A speed is that over so many rows, and most that a joint has, but for such a share of lost readings and turns that wrap.
/// Numbers beyond this are no rad, rad.
const ROWS: usize = 10;
const MOST: f64 = 0.9;
const NO_RAD: f64 = 7.0;
/// Rows are no farther apart, if their times are of seconds that were taken as ms.
const LONGEST_S: f64 = 0.01;

/// What is said of a time of a column taken as s, where as ms a measured joint would be faster than any.
pub(super) fn in_seconds(run: &CsvRun, column: &str) -> Option<String> {
    let stamp_ns = run.stamp_ns();
    let t_s: Vec<f64> =
        stamp_ns.iter().map(|ns| seconds_since(*stamp_ns.first().unwrap_or(ns), *ns)).collect();
    let steps: Vec<f64> = t_s.windows(2).map(|two| two[1] - two[0]).filter(|step_s| *step_s > 0.0).collect();
    if stamp_ns.first().is_none_or(|first| is_dated(*first)) || steps.is_empty() || median(steps) > LONGEST_S
    {
        return None;
    }
    let speed = |q: &[f64]| {
        let over = t_s.windows(ROWS + 1).zip(q.windows(ROWS + 1));
        let speeds = over.map(|(t_s, q)| (q[ROWS] - q[0]).abs() / (t_s[ROWS] - t_s[0]));
        let is_rad = q.iter().filter(|q| q.is_finite()).all(|q| q.abs() <= NO_RAD);
        let unit = if is_rad { 1.0 } else { DEGREE_RAD };
        unit * quantile(speeds.filter(|speed| speed.is_finite()).collect(), MOST)
    };
    let measured = run.by_joint(Role::Measured, Quantity::Position)?;
    let fastest = measured.into_iter().flatten().map(speed).fold(0.0, f64::max);
    (fastest > FASTEST).then(|| {
        format!(
            "time column {column:?} says no unit and is taken as s: as ms, a joint would go {fastest:.0} rad or m a second; else say \
             --time-unit, or --rate HZ if it counts rows"
        )
    })
}

/// Whether a time that was taken as ms rises by 1 in every row.
pub(super) fn counts_rows(run: &CsvRun) -> bool {
    run.stamp_ns().windows(2).all(|two| two[1] - two[0] == 1_000_000)
}

#[cfg(test)]
mod tests {
    use super::super::{CsvOptions, read_csv_bytes};

    /// How long a table lasts that swings once in so many rows, s, and what is said of it.
    fn read(rows: f64, time: impl Fn(f64) -> f64) -> (f64, String) {
        let row = |k: u32| {
            let k = f64::from(k);
            format!("{},{:.4},{:.4}\n", time(k), (k / rows).sin(), ((k - 1.0) / rows).sin())
        };
        let table: String = (0..600).map(row).collect();
        let table = format!("t,j1_target_rad,j1_actual_rad\n{table}");
        let run = read_csv_bytes("a.csv", table.as_bytes(), &CsvOptions::default()).unwrap();
        let said = run.remarks.as_slice().iter().map(|remark| remark.message.clone()).collect();
        ((run.stamp_ns()[599] - run.stamp_ns()[0]) as f64 / 1e9, said)
    }

    #[test]
    fn steps_that_would_make_a_joint_faster_than_any_are_of_seconds() {
        let (lasts_s, said) = read(10.0, |k| 0.5 * k);
        assert!((lasts_s - 299.5).abs() < 0.01 && said.contains("is taken as s"), "{lasts_s} {said}");
        let (lasts_s, said) = read(200.0, |k| 0.5 * k);
        assert!((lasts_s - 0.2995).abs() < 1e-3 && said.contains("taken as ms"), "{lasts_s} {said}");
        let (lasts_s, said) = read(60.0, |k| (0.1 * k).floor());
        assert!((lasts_s - 59.9).abs() < 0.01, "{lasts_s} {said}");
        assert!(said.contains("is taken as s") && said.contains("10 rows"), "{said}");
        let table: String = (0..600)
            .fold(String::new(), |rows, k| format!("{rows}{k},{0:.4},{0:.4}\n", (0.1 * f64::from(k)).sin()));
        let table = format!("t,j1_target_rad,j1_actual_rad\n{table}");
        let error =
            read_csv_bytes("a.csv", table.as_bytes(), &CsvOptions::default()).unwrap_err().to_string();
        assert!(error.contains("counts time in steps of 1") && error.contains("--rate HZ"), "{error}");
        let (_, said) = read(6000.0, |k| (0.1 * k).floor());
        assert!(said.contains("taken as ms") && said.contains("10 rows"), "{said}");
    }
}
