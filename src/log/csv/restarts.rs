//! Times that go back and stay back: a recorder that was started again, and whose rows are of another run.

/// Fewer values of a signal that step back came late; more are of another run.
const FEWEST: usize = 8;

/// Row and signal of a value.
type Place = (usize, usize);

/// The run that each value is of, for values of several signals in the order of the rows: its signal, and its time. All are
/// of one where times go back all the time.
pub(super) fn runs<T: Copy + Ord>(values: &[(usize, T)]) -> Vec<usize> {
    let signals = values.iter().map(|(signal, _)| signal + 1).max().unwrap_or(0);
    let mut own: Vec<Vec<usize>> = vec![Vec::new(); signals];
    for (at, (signal, _)) in values.iter().enumerate() {
        own[*signal].push(at);
    }
    let (mut runs, mut restarts) = (vec![0; values.len()], 0);
    for places in own {
        let (mut run, mut latest) = (0, None);
        for (k, &at) in places.iter().enumerate() {
            let stays = |next: &[usize]| next.iter().all(|one| Some(values[*one].1) < latest);
            if places.get(k..k + FEWEST).is_some_and(stays) {
                (run, latest) = (run + 1, None);
                restarts += 1;
            }
            latest = latest.max(Some(values[at].1));
            runs[at] = run;
        }
    }
    if restarts * FEWEST > values.len() { vec![0; values.len()] } else { runs }
}

/// Values by row and signal, where each run has rows of its own, and the row that each of these was; `None` of one run.
pub(super) fn apart(values: &[Place]) -> Option<(Vec<Place>, Vec<usize>)> {
    let runs = runs(&values.iter().map(|(row, signal)| (*signal, *row)).collect::<Vec<_>>());
    let keys: Vec<(usize, usize)> = runs.into_iter().zip(values.iter().map(|(row, _)| *row)).collect();
    let mut rows = keys.clone();
    rows.sort_unstable();
    rows.dedup();
    let place = |key: &(usize, usize)| rows.binary_search(key).ok();
    let placed = keys.iter().zip(values).map(|(key, (_, signal))| Some((place(key)?, *signal)));
    let placed: Vec<Place> = placed.collect::<Option<_>>()?;
    (rows.last()?.0 > 0).then(|| (placed, rows.into_iter().map(|(_, row)| row).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_signal_begins_a_run_where_its_time_goes_back_for_good() {
        let two = |times: Vec<i32>| -> Vec<(usize, i32)> {
            times.into_iter().flat_map(|time| [(0, time), (1, time + 1)]).collect()
        };
        let again = runs(&two((0..20).chain(0..20).chain(5..30).collect()));
        let count = |run: usize| again.iter().filter(|one| **one == run).count();
        assert_eq!([count(0), count(1), count(2)], [40, 40, 50]);
        assert!(again.is_sorted());
        // Values that came late, and signals one after the other, are of one run.
        let late = (0..20).chain([3, 4]).chain(20..40).collect();
        assert!(runs(&two(late)).iter().all(|run| *run == 0));
        let blocks: Vec<(usize, i32)> = (0..2).flat_map(|of| (0..20).map(move |time| (of, time))).collect();
        assert!(runs(&blocks).iter().all(|run| *run == 0));
        assert!(runs(&two((0..40).rev().collect())).iter().all(|run| *run == 0));
        assert!(runs::<i32>(&[]).is_empty());
    }

    #[test]
    fn each_run_has_rows_of_its_own() {
        let once: Vec<(usize, usize)> = (0..20).flat_map(|row| [(row, 0), (row, 1)]).collect();
        assert_eq!(apart(&once), None);
        let (placed, rows) = apart(&[&once[..], &once[..]].concat()).unwrap();
        assert_eq!((placed[0], placed[41], placed[79]), ((0, 0), (20, 1), (39, 1)));
        assert_eq!((rows.len(), rows[25]), (40, 5));
    }
}
