//! From the stamps of a log, which repeat, jump and come out of order, to time that only increases.
//!
//! A stamp says when a sample was taken, the recorder's clock when it arrived. A clock that is set
//! changes the difference of the two for good; a message that is late, or a stamp that is wrong,
//! changes it for a moment. Only the former moves what comes after it.

/// Stamps put in order: `t_ns` strictly increases, whatever the stamps did.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Clock {
    /// Time of each kept row, ns.
    pub t_ns: Vec<i64>,
    /// The kept rows, in order of time.
    pub rows: Vec<usize>,
    /// Indices into `rows` of the first row after each jump of the clock.
    pub cuts: Vec<usize>,
    /// What was added to the stamps after each jump, ns.
    pub offsets_ns: Vec<i64>,
    /// Rows dropped because they have no stamp (zero).
    pub unstamped: u64,
    /// Rows dropped because their stamp fits neither their neighbours nor the recorder's clock.
    pub misfits: u64,
    /// Rows dropped because they repeat the stamp of another.
    pub duplicates: u64,
    /// Rows that came late and were put in their place.
    pub reordered: u64,
    /// The longest jump, ns.
    pub longest_jump_ns: i64,
}

impl Clock {
    /// Keeps what lies between two places in time; both conditions change once, the first to true, the second to false.
    pub fn keep(&mut self, is_after_start: impl Fn(i64) -> bool, is_before_end: impl Fn(i64) -> bool) {
        let start = self.t_ns.partition_point(|&at_ns| !is_after_start(at_ns));
        let end = start + self.t_ns[start..].partition_point(|&at_ns| is_before_end(at_ns));
        self.t_ns = self.t_ns[start..end].to_vec();
        self.rows = self.rows[start..end].to_vec();
        self.cuts.retain(|cut| (start + 1..end).contains(cut));
        self.cuts.iter_mut().for_each(|cut| *cut -= start);
    }
}

/// A stamp this far ahead of its predecessor, while the recorder's clock says otherwise, is wrong
/// or follows a jump.
const LEAP_NS: i64 = 1_000_000_000;
/// Fewer rows than this on a clock of their own are wrong stamps, not a jump.
const FEWEST: usize = 8;
/// Rows whose median difference to the recorder's clock stands for a stretch.
const SPAN: usize = 200;
/// A change of that difference by less than this is transport, not a jump.
const STEADY_NS: i64 = 20_000_000;
/// A late row is older than its predecessors by at most this.
const LATE_NS: i64 = 2_000_000_000;
/// Marks a row whose stamp is wrong.
const WRONG: i64 = i64::MIN;
/// Offsets of two topics that differ by less than this are one jump of one clock.
const SAME_JUMP_NS: i64 = 250_000_000;

/// Before this no clock is set, ns since 1970: one that leaps from before it to after it was set in between.
const SET_NS: i64 = 1_000_000_000_000_000_000;
/// A stamp and the recorder's clock that step back by amounts that differ by less were set together.
const TOGETHER_NS: i64 = 1_000_000_000;

/// Orders rows by stamp; `log_ns` is when the recorder received them, `known_offsets_ns` the jumps
/// that another topic on the same clock showed.
///
/// The slices of stamps are `[n]`. Rows are taken in the order of the file, or of the recorder's
/// clock where that leaves fewer backward steps.
pub fn continuous_clock(stamp_ns: &[i64], log_ns: &[i64], known_offsets_ns: &[i64]) -> Clock {
    let n = stamp_ns.len().min(log_ns.len());
    if is_steady(&stamp_ns[..n]) {
        return Clock { t_ns: stamp_ns[..n].to_vec(), rows: (0..n).collect(), ..Clock::default() };
    }
    let mut order: Vec<usize> = (0..n).filter(|&i| stamp_ns[i] != 0).collect();
    let mut clock = Clock { unstamped: (n - order.len()) as u64, ..Clock::default() };
    let backward = |order: &[usize]| order.windows(2).filter(|w| stamp_ns[w[1]] < stamp_ns[w[0]]).count();
    let steps = backward(&order);
    let own = stamp_ns[..n] == log_ns[..n] || set_together(stamp_ns, log_ns);
    if steps > 0 && !own {
        let mut by_log = order.clone();
        by_log.sort_by_key(|&i| log_ns[i]);
        if backward(&by_log) < steps {
            order = by_log;
        }
    }
    let is_set = |a: usize, b: usize| stamp_ns[a] < SET_NS && stamp_ns[b] >= SET_NS;
    let sound = order.windows(2).all(|w| stamp_ns[w[0]] < stamp_ns[w[1]] && !(own && is_set(w[0], w[1])));
    if sound && runs(&order, stamp_ns, log_ns).nth(1).is_none() {
        // Nothing to judge: nearly every log.
        clock.t_ns = order.iter().map(|&i| stamp_ns[i]).collect();
        clock.rows = order;
        return clock;
    }
    let mut offset_ns = 0_i64;
    let mut epoch: Vec<(i64, usize)> = Vec::new();
    let mut last_ns: Option<i64> = None;
    for run in runs(&order, stamp_ns, log_ns) {
        let delay_ns = |i: &usize| stamp_ns[*i].saturating_sub(log_ns[*i]);
        let head = middle(run.iter().take(SPAN).map(delay_ns));
        let tail = epoch.iter().rev().take(SPAN).map(|(_, i)| delay_ns(i).saturating_add(offset_ns));
        let before = if epoch.is_empty() { head } else { middle(tail) };
        let shift_ns = if own {
            // Without a second clock only a step back over more than lateness is a jump.
            let step =
                last_ns.map_or(0, |last| stamp_ns[run[0]].saturating_add(offset_ns).saturating_sub(last));
            let was = epoch.last().is_some_and(|(_, before)| is_set(*before, run[0]));
            if step < -LATE_NS || was { step.saturating_sub(usual_step_ns(run, stamp_ns)) } else { 0 }
        } else {
            head.saturating_add(offset_ns).saturating_sub(before)
        };
        if shift_ns.saturating_abs() <= STEADY_NS || last_ns.is_none() {
            epoch.extend(run.iter().map(|&i| (stamp_ns[i].saturating_add(offset_ns), i)));
            last_ns = last_ns.max(run.last().map(|&i| stamp_ns[i].saturating_add(offset_ns)));
        } else if run.len() < FEWEST {
            clock.misfits += run.len() as u64;
        } else {
            let wanted = offset_ns.saturating_sub(shift_ns);
            let known =
                known_offsets_ns.iter().chain([&0]).find(|k| (**k - wanted).saturating_abs() < SAME_JUMP_NS);
            offset_ns = known.copied().unwrap_or(wanted);
            clock.longest_jump_ns = clock.longest_jump_ns.max(shift_ns.saturating_abs());
            close(&mut clock, std::mem::take(&mut epoch), log_ns);
            clock.cuts.push(clock.rows.len());
            clock.offsets_ns.push(offset_ns);
            epoch = run.iter().map(|&i| (stamp_ns[i].saturating_add(offset_ns), i)).collect();
            last_ns = run.last().map(|&i| stamp_ns[i].saturating_add(offset_ns));
        }
    }
    close(&mut clock, epoch, log_ns);
    clock.cuts.retain(|&cut| cut > 0 && cut < clock.rows.len());
    clock.cuts.dedup();
    clock
}

/// Whether the stamps and the recorder's clock, in the order of the file, step back together, or leap together to a time that a clock
/// has once it is set: the file alone then says what came after what.
fn set_together(stamp_ns: &[i64], log_ns: &[i64]) -> bool {
    let pairs = stamp_ns.windows(2).zip(log_ns.windows(2));
    let steps = pairs.map(|(stamp, log)| {
        let steps = [stamp, log].map(|w| w[1].saturating_sub(w[0]));
        let is_set = stamp[0] < SET_NS && stamp[1] >= SET_NS && stamp[0] != 0;
        (steps[0] < -LATE_NS || is_set) && (steps[0].saturating_sub(steps[1])).saturating_abs() < TOGETHER_NS
    });
    if !steps.fold(false, |any, together| any | together) {
        return false;
    }
    // Chunks that a recorder wrote in another order make one even row of samples once they are sorted; a clock that was set leaves a
    // hole, or times that it had before.
    let mut sorted = stamp_ns.to_vec();
    sorted.sort_unstable();
    let steps = || sorted.windows(2).map(|w| w[1] - w[0]);
    let usual = middle(steps());
    steps().any(|step| step > 10 * usual.max(1) && step > LATE_NS || step < usual / 10)
}

/// Whether each stamp is set, later than the one before, and by no leap: then there is nothing to put in order.
fn is_steady(stamp_ns: &[i64]) -> bool {
    let step =
        |w: &[i64]| (w[1] > w[0]) & (w[1].wrapping_sub(w[0]).cast_unsigned() <= LEAP_NS.cast_unsigned());
    stamp_ns.first().is_some_and(|first| *first > 0)
        && stamp_ns.windows(2).fold(true, |steady, pair| steady & step(pair))
}

/// Rows between places where stamps step back, or leap ahead of the recorder's clock.
fn runs<'a>(
    order: &'a [usize],
    stamp_ns: &'a [i64],
    log_ns: &'a [i64],
) -> impl Iterator<Item = &'a [usize]> + 'a {
    let logged = order.windows(2).any(|w| log_ns[w[1]] > log_ns[w[0]]);
    order.chunk_by(move |&a, &b| {
        let step = stamp_ns[b].saturating_sub(stamp_ns[a]);
        let passed = log_ns[b].saturating_sub(log_ns[a]);
        let was_set = stamp_ns[a] < SET_NS && stamp_ns[b] >= SET_NS;
        step >= 0 && !was_set && !(logged && step > LEAP_NS && passed < step / 2)
    })
}

fn middle(values: impl Iterator<Item = i64>) -> i64 {
    let mut values: Vec<i64> = values.collect();
    let half = values.len() / 2;
    if values.is_empty() { 0 } else { *values.select_nth_unstable(half).1 }
}

fn usual_step_ns(run: &[usize], stamp_ns: &[i64]) -> i64 {
    middle(run.windows(2).take(SPAN).map(|w| stamp_ns[w[1]].saturating_sub(stamp_ns[w[0]])))
}

/// Sorts the rows of a stretch on one clock, and drops those that repeat a stamp or whose stamp is
/// wrong: late rows that leave no hole elsewhere, and rows far ahead of the recorder's clock.
fn close(clock: &mut Clock, mut epoch: Vec<(i64, usize)>, log_ns: &[i64]) {
    let floor = clock.t_ns.last().copied();
    let sorted =
        epoch.windows(2).all(|w| w[0].0 < w[1].0) && floor.zip(epoch.first()).is_none_or(|(f, e)| f < e.0);
    if !sorted {
        let usual = middle(epoch.windows(2).map(|w| w[1].0.saturating_sub(w[0].0)).filter(|step| *step > 0));
        let mut late = std::collections::BTreeSet::new();
        let mut latest = i64::MIN;
        for k in 0..epoch.len() {
            let (t_ns, row) = epoch[k];
            if t_ns < latest {
                late.insert(row);
            }
            // A row ahead of the next one, and more so of the recorder's clock, is itself wrong.
            let next = epoch.get(k + 1).map_or(i64::MAX, |(t, _)| *t);
            if t_ns > next.saturating_add(3 * usual.max(1)) {
                let around = &epoch[k.saturating_sub(SPAN / 2)..epoch.len().min(k + SPAN / 2)];
                let level =
                    middle(around.iter().filter(|e| e.0 != WRONG).map(|(t, i)| t.saturating_sub(log_ns[*i])));
                if t_ns.saturating_sub(log_ns[row]).saturating_sub(level) > (t_ns - next) / 2 {
                    epoch[k].0 = WRONG;
                    continue;
                }
            }
            latest = latest.max(t_ns);
        }
        let before = epoch.len();
        epoch.retain(|(t_ns, _)| *t_ns != WRONG && floor.is_none_or(|floor| *t_ns > floor));
        clock.misfits += (before - epoch.len()) as u64;
        epoch.sort_by_key(|&(t_ns, _)| t_ns);
        let before = epoch.len();
        epoch.dedup_by_key(|&mut (t_ns, _)| t_ns);
        clock.duplicates += (before - epoch.len()) as u64;
        let stamps: Vec<i64> = epoch.iter().map(|(t, _)| *t).collect();
        let usual = middle(stamps.windows(2).map(|w| w[1].saturating_sub(w[0])));
        let mut k = 0_usize;
        epoch.retain(|(t_ns, row)| {
            k += 1;
            if !late.contains(row) {
                return true;
            }
            let gap_before = k.checked_sub(2).map_or(i64::MAX, |b| t_ns.saturating_sub(stamps[b]));
            let gap_after = stamps.get(k).map_or(i64::MAX, |after| after.saturating_sub(*t_ns));
            // A sample that came late is missed where it belongs.
            let hole = gap_before.saturating_add(gap_after) > usual + usual / 2;
            let fits = hole && gap_before.min(gap_after) > usual / 4 && gap_before.max(gap_after) < LATE_NS;
            clock.reordered += u64::from(fits);
            clock.misfits += u64::from(!fits);
            fits
        });
    }
    clock.t_ns.extend(epoch.iter().map(|&(t_ns, _)| t_ns));
    clock.rows.extend(epoch.iter().map(|&(_, row)| row));
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: i64 = 1_000_000;

    fn stamps(ms: impl IntoIterator<Item = i64>) -> Vec<i64> {
        ms.into_iter().map(|t| t * MS).collect()
    }

    /// 100 stamps at 50 Hz as `wrong` has them, received in order 4 ms after they were due.
    fn run(wrong: impl Fn(i64) -> i64) -> Clock {
        let due = |k: i64| 1000 + 20 * k;
        continuous_clock(&stamps((0..100).map(wrong)), &stamps((0..100).map(|k| due(k) + 9004)), &[])
    }

    #[test]
    fn steady_stamps_are_taken_as_they_are_and_leaps_are_not_steady() {
        let steady = stamps((1..100).map(|k| 10 * k));
        let clock = continuous_clock(&steady, &vec![5; 99], &[]);
        assert_eq!((clock.t_ns, clock.rows), (steady, (0..99).collect()));
        assert!(is_steady(&[1, 1 + LEAP_NS]));
        for other in
            [&[][..], &[0, 1], &[-1, 1], &[2, 2], &[3, 2], &[1, 2 + LEAP_NS], &[1, i64::MAX, i64::MIN]]
        {
            assert!(!is_steady(other), "{other:?}");
        }
    }

    #[test]
    fn a_late_row_is_put_in_its_place_and_a_repeated_one_dropped() {
        let clock = continuous_clock(&stamps([10, 30, 20, 40, 40, 50]), &stamps([1, 2, 3, 4, 5, 6]), &[]);
        assert_eq!(clock.rows, [0, 2, 1, 3, 5]);
        assert_eq!((clock.reordered, clock.duplicates, clock.cuts.len()), (1, 1, 0));
    }

    #[test]
    fn where_both_clocks_are_set_time_goes_on_in_the_order_of_the_file() {
        let due = |k: i64| 1_700_000_000_000 + 20 * k;
        for set in [
            |k: i64| if k < 50 { 0 } else { -3_600_000 },
            |k: i64| if k < 50 { -1_699_999_000_000 } else { 0 },
        ] {
            let stamp_ns = stamps((0..100).map(|k| due(k) + set(k)));
            let log_ns = stamps((0..100).map(|k| due(k) + set(k) + 3));
            for log_ns in [&log_ns, &stamp_ns] {
                let clock = continuous_clock(&stamp_ns, log_ns, &[]);
                let first = due(0) + set(0);
                assert_eq!(clock.t_ns, stamps((0..100).map(|k| first + 20 * k)));
                assert_eq!((clock.cuts.as_slice(), clock.rows), ([50].as_slice(), (0..100).collect()));
            }
        }
        // Chunks of 5 s in another order.
        let order = || (0..250).chain(500..750).chain(250..500);
        let clock = continuous_clock(&stamps(order().map(due)), &stamps(order().map(|k| due(k) + 3)), &[]);
        assert_eq!((clock.t_ns, clock.cuts.len()), (stamps((0..750).map(due)), 0));
    }

    #[test]
    fn after_a_jump_either_way_time_goes_on_by_the_recorders_clock() {
        for by in [-4000, -300, 4000] {
            let clock = run(|k| 1000 + 20 * k + if k < 50 { 0 } else { by });
            assert_eq!(clock.cuts, [50], "{by}");
            assert_eq!(clock.t_ns, stamps((0..100).map(|k| 1000 + 20 * k)), "{by}");
            assert_eq!((clock.misfits, clock.longest_jump_ns), (0, by.abs() * MS));
        }
    }

    #[test]
    fn a_clock_that_is_set_back_again_ends_where_it_began() {
        let clock = run(|k| 1000 + 20 * k + if (30..60).contains(&k) { -5000 } else { 0 });
        assert_eq!((clock.cuts, clock.offsets_ns), (vec![30, 60], vec![5000 * MS, 0]));
        assert_eq!(clock.t_ns, stamps((0..100).map(|k| 1000 + 20 * k)));
    }

    #[test]
    fn one_wrong_stamp_costs_itself_and_moves_nothing() {
        for by in [800, -2500, 100_000, -100_000, -330] {
            let clock = run(|k| 1000 + 20 * k + if k == 40 { by } else { 0 });
            let due: Vec<i64> = stamps((0..100).filter(|k| *k != 40).map(|k| 1000 + 20 * k));
            assert_eq!((clock.t_ns, clock.misfits, clock.cuts.len()), (due, 1, 0), "{by}");
        }
    }

    #[test]
    fn a_burst_that_comes_late_moves_nothing() {
        // Rows 40 to 45 arrive after row 55.
        let order: Vec<i64> = (0..40).chain(46..56).chain(40..46).chain(56..100).collect();
        let stamp = stamps(order.iter().map(|k| 1000 + 20 * k));
        let clock = continuous_clock(&stamp, &stamps((0..100).map(|k| 10_000 + 20 * k)), &[]);
        assert_eq!(clock.t_ns, stamps((0..100).map(|k| 1000 + 20 * k)));
        assert_eq!((clock.reordered, clock.misfits, clock.cuts.len()), (6, 0, 0));
    }

    #[test]
    fn two_topics_that_a_recorder_writes_in_batches_share_their_jump() {
        let due = |k: i64| 1000 + 10 * k;
        let stamp: Vec<i64> = stamps((0..800).map(|k| due(k) - if k < 400 { 0 } else { 100_000 }));
        let batched = |size: i64| stamps((0..800).map(|k| 500_000 + due(k - k % size + size)));
        let first = continuous_clock(&stamp, &batched(10), &[]);
        let second = continuous_clock(&stamp, &batched(17), &first.offsets_ns);
        assert_eq!(first.offsets_ns, second.offsets_ns);
        assert!((first.offsets_ns[0] - 100_000 * MS).abs() < 10 * MS, "{:?}", first.offsets_ns);
    }

    #[test]
    fn chunks_written_out_of_order_are_read_in_the_recorders_order() {
        let stamp = stamps([500, 510, 520, 530, 540, 100, 110, 120, 130, 140]);
        let log = stamps([501, 511, 521, 531, 541, 101, 111, 121, 131, 141]);
        let clock = continuous_clock(&stamp, &log, &[]);
        assert_eq!(clock.rows, [5, 6, 7, 8, 9, 0, 1, 2, 3, 4]);
        assert_eq!(clock.cuts.len(), 0);
    }

    #[test]
    fn rows_without_a_stamp_are_counted_and_left_out() {
        let clock = continuous_clock(&[0, 5, 0, 6], &[1, 2, 3, 4], &[]);
        assert_eq!((clock.rows, clock.unstamped), (vec![1, 3], 2));
    }
}
