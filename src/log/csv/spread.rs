//! Rows with one stamp, spread over the step to the next.

/// Stamps, each with its rows.
pub(super) fn runs(stamp_ns: &[i64]) -> Vec<(i64, usize)> {
    stamp_ns.chunk_by(|a, b| a == b).map(|run| (run[0], run.len())).collect()
}

/// Spreads rows with one stamp over the step to the next; the first ones of a file that begins within a step are its last.
pub(super) fn spread(stamp_ns: &mut [i64], rows: usize, step_ns: i64) {
    let mut from = 0;
    for (run, (ns, count)) in runs(stamp_ns).into_iter().enumerate() {
        let before = if run == 0 { rows.saturating_sub(count) } else { 0 };
        let each_ns = step_ns / i64::try_from(rows.max(count)).unwrap_or(i64::MAX);
        for (place, stamp) in (before..).zip(&mut stamp_ns[from..from + count]) {
            *stamp = ns.saturating_add(each_ns.saturating_mul(i64::try_from(place).unwrap_or(i64::MAX)));
        }
        from += count;
    }
}
