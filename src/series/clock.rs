//! From the stamps of a log, which repeat, jump and come out of order, to time that only increases.

/// Stamps put in order: `t_ns` strictly increases, whatever the stamps did.
///
/// Where the clock jumped backwards, time goes on by what the recorder's own clock says has
/// passed, and a cut marks the place.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Clock {
    /// Time of each kept row, ns.
    pub t_ns: Vec<i64>,
    /// The kept rows, in order of time.
    pub rows: Vec<usize>,
    /// Indices into `rows` of the first row after each backward jump.
    pub cuts: Vec<usize>,
    /// Rows dropped because they have no stamp (zero).
    pub unstamped: u64,
    /// Rows dropped because they repeat the stamp of another.
    pub duplicates: u64,
    /// Rows that came late and were put in their place.
    pub reordered: u64,
    /// The longest backward jump, ns.
    pub longest_jump_ns: i64,
}

/// A row that comes late by no more than this many rows, and this much time, is put in its
/// place; otherwise the clock has jumped.
const LATE_ROWS: usize = 3;
const LATE_NS: i64 = 1_000_000_000;

/// Orders rows by stamp; `log_ns` is when the recorder received them.
///
/// Both slices are `[n]`. Rows are taken in the order of the file, or of the recorder's clock
/// where that leaves fewer backward steps.
pub fn continuous_clock(stamp_ns: &[i64], log_ns: &[i64]) -> Clock {
    let n = stamp_ns.len().min(log_ns.len());
    let mut order: Vec<usize> = (0..n).filter(|&i| stamp_ns[i] != 0).collect();
    let mut clock = Clock { unstamped: (n - order.len()) as u64, ..Clock::default() };
    let backward = |order: &[usize]| order.windows(2).filter(|w| stamp_ns[w[1]] < stamp_ns[w[0]]).count();
    let steps = backward(&order);
    if steps > 0 && stamp_ns != log_ns {
        let mut by_log = order.clone();
        by_log.sort_by_key(|&i| log_ns[i]);
        if backward(&by_log) < steps {
            order = by_log;
        }
    }
    let mut offset_ns = 0_i64;
    let mut start = 0;
    let mut latest: Option<i64> = None;
    for (place, &row) in order.iter().enumerate() {
        let mut t_ns = stamp_ns[row].saturating_add(offset_ns);
        if let Some(latest_ns) = latest
            && t_ns < latest_ns
        {
            let ahead = &order[place + 1..order.len().min(place + 1 + LATE_ROWS)];
            let late = latest_ns.saturating_sub(t_ns) < LATE_NS
                && ahead.iter().any(|&i| stamp_ns[i].saturating_add(offset_ns) > latest_ns);
            if late {
                clock.reordered += 1;
            } else {
                let previous = order[place - 1];
                let passed_ns = log_ns[row].saturating_sub(log_ns[previous]).max(1);
                clock.longest_jump_ns = clock.longest_jump_ns.max(latest_ns.saturating_sub(t_ns));
                close(&mut clock, start);
                start = clock.rows.len();
                clock.cuts.push(start);
                let now_ns = latest_ns.saturating_add(passed_ns);
                offset_ns = offset_ns.saturating_add(now_ns.saturating_sub(t_ns));
                t_ns = now_ns;
            }
        }
        latest = Some(latest.map_or(t_ns, |latest_ns| latest_ns.max(t_ns)));
        clock.t_ns.push(t_ns);
        clock.rows.push(row);
    }
    close(&mut clock, start);
    clock.cuts.retain(|&cut| cut > 0 && cut < clock.rows.len());
    clock.cuts.dedup();
    clock
}

/// Sorts the rows since `start` and drops those that repeat a stamp.
fn close(clock: &mut Clock, start: usize) {
    let sorted = clock.t_ns[start..].windows(2).all(|w| w[0] < w[1]);
    if sorted {
        return;
    }
    let mut tail: Vec<(i64, usize)> =
        clock.t_ns[start..].iter().copied().zip(clock.rows[start..].iter().copied()).collect();
    tail.sort_by_key(|&(t_ns, _)| t_ns);
    let before = tail.len();
    tail.dedup_by_key(|&mut (t_ns, _)| t_ns);
    clock.duplicates += (before - tail.len()) as u64;
    clock.t_ns.truncate(start);
    clock.rows.truncate(start);
    clock.t_ns.extend(tail.iter().map(|&(t_ns, _)| t_ns));
    clock.rows.extend(tail.iter().map(|&(_, row)| row));
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: i64 = 1_000_000;

    fn stamps(ms: &[i64]) -> Vec<i64> {
        ms.iter().map(|t| t * MS).collect()
    }

    #[test]
    fn a_late_row_is_put_in_its_place_and_a_repeated_one_dropped() {
        let t = stamps(&[10, 30, 20, 40, 40, 50]);
        let clock = continuous_clock(&t, &stamps(&[1, 2, 3, 4, 5, 6]));
        assert_eq!(clock.rows, [0, 2, 1, 3, 5]);
        assert_eq!((clock.reordered, clock.duplicates, clock.cuts.len()), (1, 1, 0));
    }

    #[test]
    fn after_a_backward_jump_time_goes_on_by_the_recorders_clock() {
        let stamp = stamps(&[5000, 5020, 5040, 100, 120, 140, 160, 180]);
        let log = stamps(&[9000, 9020, 9040, 9060, 9080, 9100, 9120, 9140]);
        let clock = continuous_clock(&stamp, &log);
        assert_eq!(clock.cuts, [3]);
        assert_eq!(clock.t_ns, stamps(&[5000, 5020, 5040, 5060, 5080, 5100, 5120, 5140]));
        assert_eq!(clock.longest_jump_ns, 4940 * MS);
    }

    #[test]
    fn chunks_written_out_of_order_are_read_in_the_recorders_order() {
        let stamp = stamps(&[500, 510, 520, 530, 540, 100, 110, 120, 130, 140]);
        let log = stamps(&[501, 511, 521, 531, 541, 101, 111, 121, 131, 141]);
        let clock = continuous_clock(&stamp, &log);
        assert_eq!(clock.rows, [5, 6, 7, 8, 9, 0, 1, 2, 3, 4]);
        assert_eq!(clock.cuts.len(), 0);
    }

    #[test]
    fn rows_without_a_stamp_are_counted_and_left_out() {
        let clock = continuous_clock(&[0, 5, 0, 6], &[1, 2, 3, 4]);
        assert_eq!((clock.rows, clock.unstamped), (vec![1, 3], 2));
    }
}
