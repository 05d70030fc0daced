//! Levels of rows and columns of a table in which much is missing: starts by runs, machines by days.

use super::{mad, mean, median};

/// The robust scatter of a row's steps, to which neither a trend nor a jump adds; NaN: no value. `None` for fewer than
/// three steps.
pub fn step_scatter(row: impl Iterator<Item = f64>) -> Option<f64> {
    let known: Vec<f64> = row.filter(|value| value.is_finite()).collect();
    let steps: Vec<f64> = known.windows(2).map(|two| two[1] - two[0]).collect();
    (steps.len() >= 3).then(|| mad(&steps))
}

/// A row quieter than this share of the usual scatter says no more than one just so quiet.
const LEAST_SCATTER: f64 = 0.2;

/// How much each row says: one over the square of its scatter. Those of unknown scatter are taken to be as is usual.
pub fn row_weights(scatters: &[Option<f64>]) -> Vec<f64> {
    let usual = median(scatters.iter().flatten().copied().collect());
    if usual.is_nan() || usual <= 0.0 {
        return vec![1.0; scatters.len()];
    }
    scatters.iter().map(|scatter| scatter.unwrap_or(usual).max(LEAST_SCATTER * usual).powi(-2)).collect()
}

/// The value that half of the weight lies below; with equal weights the median. NaN for no values.
pub fn weighted_median(mut values: Vec<(f64, f64)>) -> f64 {
    values.retain(|(value, weight)| value.is_finite() && *weight > 0.0);
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = values.iter().map(|(_, weight)| weight).sum();
    let mut below = 0.0;
    for (k, (value, weight)) in values.iter().enumerate() {
        below += weight;
        let beyond = below - 0.5 * total;
        if beyond.abs() <= 1e-9 * total {
            return values.get(k + 1).map_or(*value, |(next, _)| 0.5 * (value + next));
        }
        if beyond > 0.0 {
            return *value;
        }
    }
    f64::NAN
}

/// Values by row and column as the sum of a row's and a column's own level, both medians (Tukey's median polish), that of
/// a column weighted by what each row says; gives the levels of the columns, whose median is zero. NaN: no value. A
/// column without values has none.
pub fn column_levels(rows: &[Vec<f64>], weights: &[f64], columns: usize) -> Vec<f64> {
    const SWEEPS: usize = 20;
    let known = |values: Vec<f64>| values.into_iter().filter(|value| value.is_finite()).collect::<Vec<f64>>();
    let mut levels = begun(rows, weights, columns);
    for _ in 0..SWEEPS {
        let of_rows: Vec<f64> = rows
            .iter()
            .map(|row| median(known(row.iter().zip(&levels).map(|(value, level)| value - level).collect())))
            .collect();
        let next = |column: usize| {
            let rest = rows.iter().zip(&of_rows).zip(weights);
            weighted_median(
                rest.filter_map(|((row, own), weight)| Some((row.get(column)? - own, *weight))).collect(),
            )
        };
        levels = (0..columns).map(next).collect();
        let centre = median(known(levels.clone()));
        for level in &mut levels {
            *level -= centre;
        }
    }
    levels
}

/// Levels to begin with: what rows differ by is told by the columns that they share. Rows that share none with others, of plans of
/// which a run follows one, are shifted as a group, by the columns next to theirs; each has its middle elsewhere.
fn begun(rows: &[Vec<f64>], weights: &[f64], columns: usize) -> Vec<f64> {
    const SWEEPS: usize = 3;
    let table = Table { rows, weights, groups: groups(rows, columns) };
    let mut own: Vec<f64> =
        rows.iter().map(|row| median(row.iter().copied().filter(|v| v.is_finite()).collect())).collect();
    for _ in 0..SWEEPS {
        for (row, values) in rows.iter().enumerate() {
            let in_group = |other| other != row && table.groups[other] == table.groups[row];
            let off = values.iter().enumerate().map(|(at, value)| value - table.level(at, &own, in_group));
            let off: Vec<f64> = off.filter(|off| off.is_finite()).collect();
            if !off.is_empty() {
                own[row] = median(off);
            }
        }
        for group in 0..rows.len() {
            let off: Vec<f64> = (0..columns).filter_map(|at| table.off_neighbours(at, group, &own)).collect();
            let shift = if off.is_empty() { 0.0 } else { median(off) };
            own.iter_mut()
                .zip(&table.groups)
                .filter(|(_, of)| **of == group)
                .for_each(|(own, _)| *own += shift);
        }
    }
    let level = |at| table.level(at, &own, |_| true);
    (0..columns).map(level).map(|level| if level.is_finite() { level } else { 0.0 }).collect()
}

struct Table<'a> {
    rows: &'a [Vec<f64>],
    weights: &'a [f64],
    /// The group of each row.
    groups: Vec<usize>,
}

impl Table<'_> {
    /// The level of a column by some rows with levels of their own; NaN where none has a value there.
    fn level(&self, at: usize, own: &[f64], counts: impl Fn(usize) -> bool) -> f64 {
        let rows = (0..self.rows.len()).filter(|row| counts(*row));
        let value = |row: usize| Some((self.rows[row].get(at)? - own[row], self.weights[row]));
        weighted_median(rows.filter_map(value).collect())
    }

    /// How far a group is above the others in the nearest columns to one of its own, of either side the mean.
    fn off_neighbours(&self, at: usize, group: usize, own: &[f64]) -> Option<f64> {
        const NEAR: usize = 2;
        let level = self.level(at, own, |row| self.groups[row] == group);
        let others = |at| self.level(at, own, |row| self.groups[row] != group);
        let beside = |by: usize| {
            let both = [at.checked_sub(by), Some(at + by)].into_iter().flatten().map(others);
            let known: Vec<f64> = both.filter(|level| level.is_finite()).collect();
            (!known.is_empty()).then(|| mean(&known))
        };
        level.is_finite().then(|| Some(level - (1..=NEAR).find_map(beside)?))?
    }
}

/// The least row that each row shares a column with, by others or directly.
fn groups(rows: &[Vec<f64>], columns: usize) -> Vec<usize> {
    let mut groups: Vec<usize> = (0..rows.len()).collect();
    for at in 0..columns {
        let here: Vec<usize> =
            (0..rows.len()).filter(|row| rows[*row].get(at).is_some_and(|v| v.is_finite())).collect();
        let joined: Vec<usize> = here.iter().map(|row| groups[*row]).collect();
        if let Some(&least) = joined.iter().min() {
            for group in groups.iter_mut().filter(|group| joined.contains(group)) {
                *group = least;
            }
        }
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-9, "{found} instead of {expected}");
    }

    #[test]
    fn rows_that_share_no_column_are_on_one_level_by_their_neighbours() {
        // Three rows in turn, the last one mostly after the level rises by 2.
        let of = |column: usize| if column < 20 { [0, 1][column % 2] } else { [0, 2, 1][column % 3] };
        let value = |column: usize| [1.0, 5.0, 9.0][of(column)] + if column < 24 { 0.0 } else { 2.0 };
        let rows: Vec<Vec<f64>> = (0..3)
            .map(|row| (0..48).map(|at| if of(at) == row { value(at) } else { f64::NAN }).collect())
            .collect();
        let levels = column_levels(&rows, &[1.0; 3], 48);
        let step = |at: usize| levels[at] - levels[0];
        assert!(
            (0..24).all(|at| step(at).abs() < 1e-9) && (24..48).all(|at| (step(at) - 2.0).abs() < 1e-9),
            "{levels:?}"
        );
    }

    #[test]
    fn levels_of_columns_do_not_depend_on_which_rows_lack_a_value() {
        let rows: Vec<Vec<f64>> =
            (0..6).map(|r| (0..5).map(|c| 10.0 * f64::from(r) + f64::from(c)).collect()).collect();
        let mut some = rows.clone();
        // The row with the largest values is there early only.
        some[5][3] = f64::NAN;
        some[5][4] = f64::NAN;
        for table in [rows, some] {
            assert_eq!(column_levels(&table, &weights(&table), 5), [-2.0, -1.0, 0.0, 1.0, 2.0]);
        }
        assert!(column_levels(&[vec![1.0, f64::NAN]], &[1.0], 2)[1].is_nan());
    }

    fn weights(rows: &[Vec<f64>]) -> Vec<f64> {
        let scatters: Vec<Option<f64>> = rows.iter().map(|row| step_scatter(row.iter().copied())).collect();
        row_weights(&scatters)
    }

    #[test]
    fn a_quiet_row_says_more_than_noisy_ones() {
        let noise = [0.4, -0.9, 1.0, -0.2, -1.1, 0.8, 0.1, -0.7];
        let row = |scale: f64, shift: usize| -> Vec<f64> {
            (0..8).map(|k| 0.1 * k as f64 + scale * noise[(k + shift) % 8]).collect()
        };
        let rows = [row(0.01, 0), row(1.0, 1), row(1.0, 3), row(1.0, 6)];
        let levels = column_levels(&rows, &weights(&rows), 8);
        for (k, level) in levels.iter().enumerate() {
            assert!((level - (0.1 * k as f64 - 0.35)).abs() < 0.1, "{levels:?}");
        }
        close(weighted_median(vec![(3.0, 1.0), (1.0, 1.0), (2.0, 1.0), (4.0, 1.0)]), 2.5);
        close(weighted_median(vec![(1.0, 1.0), (2.0, 5.0), (f64::NAN, 9.0), (9.0, 1.0)]), 2.0);
        assert!(weighted_median(Vec::new()).is_nan());
        assert_eq!(weights(&[vec![1.0; 6], vec![2.0; 6]]), [1.0, 1.0]);
        let unknown = row_weights(&[Some(1.0), None, Some(1.0), Some(0.01)]);
        assert!(
            unknown
                .iter()
                .zip([1.0, 1.0, 1.0, 25.0])
                .all(|(found, expected)| (found - expected).abs() < 1e-9)
        );
    }

    #[test]
    fn a_step_between_plans_that_share_no_run_is_no_difference_of_plans() {
        // Two plans of two starts each, the first mostly before the level falls by 2, the second mostly after.
        let of = |column: usize| usize::from(if column < 8 { column % 4 == 3 } else { column % 4 != 3 });
        let value = |row: usize, column: usize| row as f64 + if column < 8 { 2.0 } else { 0.0 };
        let rows: Vec<Vec<f64>> = (0..4)
            .map(|row| (0..16).map(|at| if of(at) == row / 2 { value(row, at) } else { f64::NAN }).collect())
            .collect();
        let levels = column_levels(&rows, &[1.0; 4], 16);
        for (at, level) in levels.iter().enumerate() {
            close(level - levels[0], if at < 8 { 0.0 } else { -2.0 });
        }
    }
}
