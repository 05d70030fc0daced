//! Whether differences are more than chance: by the scatter of runs, or over the transitions of a few.

use serde::{Deserialize, Serialize};

use crate::{
    math::{difference, half_interval, pooled_difference, signed_rank},
    replay::Rules,
};

/// What the test says at [`Rules::significance`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Smaller after.
    Smaller,
    /// Larger after.
    Larger,
    /// The ranks say the one, the mean the other: most changed one way, a few by much the other way.
    Mixed,
    /// Chance explains the change.
    NotShown,
    /// No value changed.
    Equal,
    /// Too few events for any outcome to count.
    TooFew,
}

/// What a test of a mean difference says.
pub(super) struct Tested {
    pub(super) interval_95: Option<[f64; 2]>,
    /// Runs before and after; `None` by events.
    pub(super) by_runs: Option<[usize; 2]>,
    pub(super) p_value: f64,
    pub(super) p_is_exact: bool,
    pub(super) verdict: Verdict,
}

/// By Welch's test of the means of the runs, before and after; of fewer than three on a side by their common scatter; `None` for fewer
/// than four in all.
pub(super) fn by_runs([before, after]: &[Vec<f64>; 2], rules: &Rules) -> Option<Tested> {
    let found = difference(before, after, (0.0, 0.0, 0.0)).or_else(|| pooled_difference(before, after))?;
    let verdict = match (found.p < rules.significance, found.value < 0.0) {
        (false, _) => Verdict::NotShown,
        (true, true) => Verdict::Smaller,
        (true, false) => Verdict::Larger,
    };
    let (interval_95, by_runs) = (Some(found.interval), Some([before.len(), after.len()]));
    Some(Tested { interval_95, by_runs, p_value: found.p, p_is_exact: false, verdict })
}

/// Differences in groups, each of which begins within a time of the one before it, from instants, s, in order: of a
/// move of many joints the last may begin later than one event lasts.
pub(super) fn events(changes: &[(f64, f64)], same_event_s: f64) -> Vec<Vec<f64>> {
    let together = changes.chunk_by(|a, b| b.0 - a.0 <= same_event_s);
    together.map(|event| event.iter().map(|(_, change)| *change).collect()).collect()
}

/// By the signed ranks of the mean differences of events.
pub(super) fn by_events(events: &[Vec<f64>], mean_difference: Option<f64>, rules: &Rules) -> Tested {
    let of_events: Vec<f64> =
        events.iter().map(|event| event.iter().sum::<f64>() / event.len() as f64).collect();
    let test = signed_rank(&of_events);
    let changed = test.positive + test.negative;
    let middle = (changed * (changed + 1)) as f64 / 4.0;
    // The smallest p that n signs can give is 2 / 2^n.
    let too_few = 0.5_f64.powi(i32::try_from(events.len()).unwrap_or(i32::MAX) - 1) >= rules.significance;
    let verdict = match (changed, test.p < rules.significance) {
        (0, _) if !events.is_empty() => Verdict::Equal,
        _ if too_few => Verdict::TooFew,
        (_, false) => Verdict::NotShown,
        (_, true) => match (test.rank_sum < middle, mean_difference) {
            (true, Some(mean)) if mean > 0.0 => Verdict::Mixed,
            (false, Some(mean)) if mean < 0.0 => Verdict::Mixed,
            (true, _) => Verdict::Smaller,
            (false, _) => Verdict::Larger,
        },
    };
    let both = mean_difference.zip(half_interval(events));
    let interval_95 = both.map(|(mean, half)| [mean - half, mean + half]);
    Tested { interval_95, by_runs: None, p_value: test.p, p_is_exact: test.exact, verdict }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn where_most_became_smaller_and_one_much_larger_neither_is_said() {
        let events = |last: f64| -> Vec<Vec<f64>> {
            (1..=11).map(|k| vec![-0.01 * f64::from(k)]).chain([vec![last]]).collect()
        };
        let mean = |events: &[Vec<f64>]| events.iter().map(|event| event[0]).sum::<f64>() / 12.0;
        let verdict = |last: f64| {
            let events = events(last);
            by_events(&events, Some(mean(&events)), &Rules::default()).verdict
        };
        assert_eq!([verdict(-0.1), verdict(6.0)], [Verdict::Smaller, Verdict::Mixed]);
    }
}
