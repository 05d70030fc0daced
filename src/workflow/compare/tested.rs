//! Whether differences are more than chance: by the scatter of runs, or over the transitions of a few.

use serde::{Deserialize, Serialize};

use crate::{
    math::{difference, half_interval, signed_rank},
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

/// By Welch's test of the means of the runs, before and after; `None` for fewer than three a side.
pub(super) fn by_runs([before, after]: &[Vec<f64>; 2], rules: &Rules) -> Option<Tested> {
    let found = difference(before, after, (0.0, 0.0, 0.0))?;
    let verdict = match (found.p < rules.significance, found.value < 0.0) {
        (false, _) => Verdict::NotShown,
        (true, true) => Verdict::Smaller,
        (true, false) => Verdict::Larger,
    };
    let (interval_95, by_runs) = (Some(found.interval), Some([before.len(), after.len()]));
    Some(Tested { interval_95, by_runs, p_value: found.p, p_is_exact: false, verdict })
}

/// Differences in groups that begin within a time of one another, from instants, s, in order.
pub(super) fn events(changes: &[(f64, f64)], same_event_s: f64) -> Vec<Vec<f64>> {
    let mut events: Vec<Vec<f64>> = Vec::new();
    // One after the other: of a move of many joints the last may begin later than one event lasts.
    let mut last_s = f64::NEG_INFINITY;
    for (at_s, change) in changes {
        if let Some(event) = events.last_mut().filter(|_| at_s - last_s <= same_event_s) {
            event.push(*change);
        } else {
            events.push(vec![*change]);
        }
        last_s = *at_s;
    }
    events
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
        (_, true) if test.rank_sum < middle => Verdict::Smaller,
        (_, true) => Verdict::Larger,
    };
    let both = mean_difference.zip(half_interval(events));
    let interval_95 = both.map(|(mean, half)| [mean - half, mean + half]);
    Tested { interval_95, by_runs: None, p_value: test.p, p_is_exact: test.exact, verdict }
}
