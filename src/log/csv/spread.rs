//! Rows with one stamp, spread over the step to the next.

/// Stamps, each with its rows.
pub(super) fn runs(stamp_ns: &[i64]) -> Vec<(i64, usize)> {
    stamp_ns.chunk_by(|a, b| a == b).map(|run| (run[0], run.len())).collect()
}

/// Share of the rows of a stamp that may be more or less of it; one row always may.
pub(super) const UNEVEN: f64 = 0.1;

/// For each row whether its stamp, unless it is the first or the last, has about as many rows as others.
pub(super) fn complete(stamp_ns: &[i64], rows: usize) -> Vec<bool> {
    let runs = runs(stamp_ns);
    let last = runs.len().saturating_sub(1);
    let whole = |(run, (_, own)): (usize, &(i64, usize))| {
        let enough = run == 0 || run == last || *own as f64 >= (1.0 - UNEVEN) * rows as f64 - 1.0;
        std::iter::repeat_n(enough, *own)
    };
    runs.iter().enumerate().flat_map(whole).collect()
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
