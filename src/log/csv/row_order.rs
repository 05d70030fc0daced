//! Rows in the order of their times, each once.

use std::collections::BTreeMap;

use super::read::Column;
use crate::{
    math::median,
    remark::{Code, Remarks},
};

/// Fewer rows than this that step back came late; more are on a clock that was set back.
pub(super) const FEWEST: usize = 8;

/// One row in so many is many.
const MANY: usize = 5;

/// Steps that are all within these of the one in the middle are even.
const EVEN: [f64; 2] = [0.5, 1.5];

/// Share of rows with the time of the row before that repeat all of it, where rows were written twice.
const WRITTEN_TWICE: f64 = 0.99;

/// Puts rows in the order of their times where they have none, and leaves out those that were written twice.
pub(super) fn put(
    stamp_ns: &mut Vec<i64>,
    columns: &mut BTreeMap<usize, Column>,
    of_day: bool,
    remarks: &mut Remarks,
) {
    if runs_backwards(stamp_ns) {
        stamp_ns.reverse();
        for column in columns.values_mut() {
            column.values.reverse();
        }
    }
    let repeats = repeats(stamp_ns, columns);
    if repeats.iter().any(|repeats| *repeats) {
        let rows: Vec<usize> = (0..stamp_ns.len()).filter(|row| !repeats[*row]).collect();
        let left_out = (stamp_ns.len() - rows.len()) as u64;
        take(&rows, stamp_ns, columns);
        let message = "rows that repeat the row before, time and all: they were written twice; left out";
        remarks.add(Code::DuplicateStamp, left_out, message);
    }
    if let Some(order) = order(stamp_ns).filter(|_| !of_day) {
        let message = "rows in no order of their times; put in order";
        remarks.add(Code::Reordered, stamp_ns.windows(2).filter(|w| w[1] < w[0]).count() as u64, message);
        take(&order, stamp_ns, columns);
    }
}

fn take(rows: &[usize], stamp_ns: &mut Vec<i64>, columns: &mut BTreeMap<usize, Column>) {
    *stamp_ns = rows.iter().map(|row| stamp_ns[*row]).collect();
    for column in columns.values_mut() {
        column.values = rows.iter().map(|row| column.values[*row]).collect();
        column.numbers = column.values.iter().filter(|value| value.is_finite()).count() as u64;
    }
}

/// Which rows were written twice: nearly all that have the time of the row before repeat its numbers, too. Those of a clock that is
/// coarser than the rows do not.
fn repeats(stamp_ns: &[i64], columns: &BTreeMap<usize, Column>) -> Vec<bool> {
    let again = |row: usize| row > 0 && stamp_ns[row] == stamp_ns[row - 1];
    let same = |row: usize| {
        again(row) && columns.values().all(|one| one.values[row].to_bits() == one.values[row - 1].to_bits())
    };
    let (mut all, mut repeats) = (0_usize, vec![false; stamp_ns.len()]);
    for (row, repeats) in repeats.iter_mut().enumerate() {
        all += usize::from(again(row));
        *repeats = same(row);
    }
    let count = repeats.iter().filter(|repeats| **repeats).count();
    if count < FEWEST || (count as f64) < WRITTEN_TWICE * all as f64 {
        return vec![false; stamp_ns.len()];
    }
    repeats
}

/// Whether the newest row comes first, as databases are asked for them: nearly every row is earlier than the one before.
fn runs_backwards(stamp_ns: &[i64]) -> bool {
    let falls = stamp_ns.windows(2).filter(|w| w[1] < w[0]).count();
    let rises = stamp_ns.windows(2).filter(|w| w[1] > w[0]).count();
    falls >= FEWEST && rises <= falls / 100
}

/// The order of rows by time where many are earlier than the one before and each has a time of its own, as what a database gives
/// that was asked for no order, or where rows are evenly apart in order; `None` where few are, which came late, or are of another
/// run.
fn order(stamp_ns: &[i64]) -> Option<Vec<usize>> {
    let falls = stamp_ns.windows(2).filter(|w| w[1] < w[0]).count();
    if falls < FEWEST {
        return None;
    }
    let mut order: Vec<usize> = (0..stamp_ns.len()).collect();
    order.sort_by_key(|row| stamp_ns[*row]);
    let steps = || order.windows(2).map(|w| stamp_ns[w[1]].saturating_sub(stamp_ns[w[0]]));
    let usual = median(steps().map(|step| step as f64).collect());
    let even = || steps().all(|step| (EVEN[0] * usual..=EVEN[1] * usual).contains(&(step as f64)));
    (steps().all(|step| step > 0) && (MANY * falls >= stamp_ns.len() || even())).then_some(order)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_in_part_out_of_order_are_sorted_where_that_makes_them_even() {
        let mut stamps: Vec<i64> = (0..500).map(|row| 20 * row).collect();
        stamps[200..240].reverse();
        let sorted = order(&stamps).expect("even in order");
        assert!(sorted.windows(2).all(|two| stamps[two[0]] < stamps[two[1]]));
        // A clock that was set back ten times, by half a row more each.
        let back: Vec<i64> = (0..500).map(|row| 20 * row - 110 * (row / 50)).collect();
        assert_eq!(order(&back), None);
    }

    #[test]
    fn rows_that_were_written_twice_count_once_and_those_of_a_coarse_clock_all() {
        let read = |rows: &dyn Fn(usize) -> (i64, f64)| {
            let (mut stamps, values): (Vec<i64>, Vec<f64>) = (0..200).map(rows).unzip();
            let mut columns = BTreeMap::from([(0, Column::of(values))]);
            let mut remarks = Remarks::default();
            put(&mut stamps, &mut columns, false, &mut remarks);
            (stamps.len(), columns[&0].values.len(), remarks.as_slice().len())
        };
        assert_eq!(read(&|row| ((row as i64 / 2) * 20, (row / 2) as f64)), (100, 100, 1));
        assert_eq!(read(&|row| ((row as i64 / 2) * 20, row as f64)), (200, 200, 0));
        assert_eq!(read(&|row| (row as i64 * 20, 1.0)), (200, 200, 0));
    }
}
