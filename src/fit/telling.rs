//! Which runs of long logs to look at first.

use super::{model::steps_in, run::Run};

/// Which runs tell enough: all, or of long logs some that are spread evenly, and those that reached or were asked
/// for most.
pub(super) fn telling(runs: &[Run], enough_s: f64) -> Vec<usize> {
    let enough = steps_in(enough_s);
    let total: usize = runs.iter().map(|run| run.sent.len()).sum();
    if total <= enough {
        return (0..runs.len()).collect();
    }
    let mut chosen = vec![false; runs.len()];
    for i in 0..8 {
        let most = |run: &usize| [runs[*run].asked, runs[*run].reached][i / 4][i % 4];
        let best = (0..runs.len()).max_by(|a, b| most(a).total_cmp(&most(b)).then(b.cmp(a)));
        chosen[best.unwrap_or_default()] = true;
    }
    let (mut before, mut taken) = (0, 0);
    for (run, chosen) in runs.iter().zip(&mut chosen) {
        // So much of each part of the log that the whole is enough.
        *chosen |= taken * total < before * enough || before == 0;
        before += run.sent.len();
        taken += if *chosen { run.sent.len() } else { 0 };
    }
    (0..runs.len()).filter(|run| chosen[*run]).collect()
}

pub(super) fn of<T: Clone>(places: &[usize], all: &[T]) -> Vec<T> {
    places.iter().map(|place| all[*place].clone()).collect()
}
