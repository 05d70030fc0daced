//! Rows in the order of their times.

use crate::{
    math::median,
    remark::{Code, Remarks},
};

/// Fewer rows than this that step back came late; more are on a clock that was set back.
pub(super) const FEWEST: usize = 8;

/// One row in so many is many.
const MANY: usize = 5;

/// Steps that are all within these of the one in the middle are even.
const EVEN: [f64; 2] = [0.7, 1.4];

/// The rows in the order of their times; `None` where they stand in it.
pub(super) fn in_order(stamp_ns: &[i64], of_day: bool, remarks: &mut Remarks) -> Option<Vec<usize>> {
    let mut rows: Vec<usize> = (0..stamp_ns.len()).collect();
    let backwards = runs_backwards(stamp_ns);
    if backwards {
        rows.reverse();
    }
    let stamps: Vec<i64> = rows.iter().map(|row| stamp_ns[*row]).collect();
    if let Some(oldest) = oldest_of_ring(&stamps) {
        let message = "the oldest row stands in the midst, as in a file that is written over from its beginning again; put in order";
        remarks.add(Code::Reordered, 1, message);
        rows.rotate_left(oldest);
        return Some(rows);
    }
    if let Some(order) = order(&stamps).filter(|_| !of_day) {
        let message = "rows in no order of their times; put in order";
        remarks.add(Code::Reordered, stamps.windows(2).filter(|w| w[1] < w[0]).count() as u64, message);
        return Some(order.into_iter().map(|place| rows[place]).collect());
    }
    backwards.then_some(rows)
}

/// Whether the newest row comes first, as databases are asked for them: nearly every row is earlier than the one before.
fn runs_backwards(stamp_ns: &[i64]) -> bool {
    let falls = stamp_ns.windows(2).filter(|w| w[1] < w[0]).count();
    let rises = stamp_ns.windows(2).filter(|w| w[1] > w[0]).count();
    falls >= FEWEST && rises <= falls / 100
}

/// The oldest row where one alone is earlier than the one before, and the first row comes one step after the last.
fn oldest_of_ring(stamp_ns: &[i64]) -> Option<usize> {
    let steps = || stamp_ns.windows(2).map(|w| w[1].saturating_sub(w[0]));
    let mut falls = steps().enumerate().filter(|(_, step)| *step < 0).map(|(before, _)| before + 1);
    let oldest = falls.next().filter(|_| falls.next().is_none())?;
    let usual = median(steps().map(|step| step as f64).collect());
    let step = stamp_ns.first()?.saturating_sub(*stamp_ns.last()?) as f64;
    let fits = (EVEN[0] * usual..=EVEN[1] * usual).contains(&step) && usual > 0.0;
    (fits && oldest.min(stamp_ns.len() - oldest) >= FEWEST).then_some(oldest)
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
    fn a_ring_that_is_written_over_begins_with_its_oldest_row() {
        let of = |first: i64, last: i64| {
            let stamps: Vec<i64> = (150..281).chain(first..last).map(|row| 50 * row).collect();
            in_order(&stamps, false, &mut Remarks::default())
        };
        assert_eq!(of(1, 150), Some((131..280).chain(0..131).collect()));
        // A clock that was set back, and two runs.
        assert_eq!((of(120, 260), of(0, 100)), (None, None));
    }

    #[test]
    fn the_newest_row_may_come_first() {
        let of = |step: i64| {
            let stamps: Vec<i64> = (0..20).map(|row| step * row).collect();
            in_order(&stamps, false, &mut Remarks::default())
        };
        assert_eq!((of(-20), of(20)), (Some((0..20).rev().collect()), None));
    }
}
