//! Whether transitions changed, by how much, and whether chance explains it.

use serde::{Deserialize, Serialize};

use super::{
    pair::{Paired, TransitionPair},
    tested::{Verdict, by_events, by_runs, events},
};
use crate::{
    math::{false_discovery, median},
    replay::{Keyed, Kind, Metric, ONSET_DELAY, PEAK_ERROR, Row, Rules, Transition},
    series::JointKind,
};

/// Which transitions.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Scope {
    /// All.
    All,
    /// Starts from rest of all joints, without reversals.
    Starts,
    /// All of joints that turn, of an arm that has joints of both kinds.
    Turning,
    /// All of joints that slide, likewise.
    Sliding,
    /// All of one joint.
    Joint(String),
}

/// One metric over paired transitions; differences are after minus before.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Summary {
    /// Key of the metric.
    pub measure: Row<Metric<Transition>>,
    /// Of which transitions.
    pub scope: Scope,
    /// Pairs with a value on both sides.
    pub pairs: usize,
    /// Groups of pairs that begin within [`Rules::same_event_s`] of one another, over all joints: they share
    /// pump and moment, so they count once in interval and test.
    pub events: usize,
    /// Mean before; `None` without pairs, like the values that follow.
    pub mean_before: Option<f64>,
    /// Mean after.
    pub mean_after: Option<f64>,
    /// Mean difference.
    pub mean_difference: Option<f64>,
    /// Median difference.
    pub median_difference: Option<f64>,
    /// 95 % interval of the mean difference: by runs (Welch's t) or by transitions (Student's t, robust to events; needs
    /// three events).
    pub interval_95: Option<[f64; 2]>,
    /// Mean difference as a share of the mean before; `None` where that is not positive.
    pub relative_change: Option<f64>,
    /// Pairs with a smaller value after.
    pub smaller: usize,
    /// Pairs with a larger value after.
    pub larger: usize,
    /// Runs before and after, where each side has three at least: interval and p then go by the scatter of the runs' means,
    /// which holds what differs from run to run. `None`: by the scatter over the transitions of these runs.
    #[serde(default)]
    pub by_runs: Option<[usize; 2]>,
    /// Two-sided p of Welch's test of the runs' means, or of the Wilcoxon signed-rank test on the mean differences of events.
    pub p_value: f64,
    /// Whether p is exact, or from the normal approximation.
    pub p_is_exact: bool,
    /// What the test says.
    pub verdict: Verdict,
}

/// In a pair of runs few starts of a joint are too easily alike: its delay changed where the mean is so many times half its interval.
const CLEARLY: f64 = 4.0;

impl Summary {
    /// Whether the interval of the mean leaves out zero; that of delays in a pair of runs clearly.
    fn leaves_out_zero(&self) -> bool {
        let times = if self.by_runs.is_some() || self.measure.key != ONSET_DELAY { 1.0 } else { CLEARLY };
        self.interval_95.is_some_and(|[low, high]| (low + high).abs() > times * (high - low))
    }

    /// The least p that so many events can have: that of all of one sign.
    pub fn least_p(&self) -> f64 {
        0.5_f64.powi(i32::try_from(self.events.saturating_sub(1)).unwrap_or(i32::MAX))
    }
}

/// Peak errors and start delays of joints that clearly changed, in order of metric: by runs at a false discovery rate of
/// [`Rules::significance`] over all of these, in a pair of runs where the interval leaves out zero.
pub(super) fn clear_joints<'a>(summaries: &'a [Summary], rules: &Rules) -> Vec<&'a Summary> {
    let is_one = |s: &&Summary| {
        matches!(s.scope, Scope::Joint(_)) && [PEAK_ERROR, ONSET_DELAY].contains(&s.measure.key)
    };
    let looked_at: Vec<&Summary> = summaries.iter().filter(is_one).collect();
    let q = false_discovery(&looked_at.iter().map(|summary| summary.p_value).collect::<Vec<_>>());
    let clear = |(summary, q): &(&Summary, f64)| {
        summary.leaves_out_zero() && (summary.by_runs.is_none() || *q < rules.significance)
    };
    looked_at.into_iter().zip(q).filter(clear).map(|(summary, _)| summary).collect()
}

/// Every metric over all transitions, over starts from rest if there are reversals too, and by joint.
pub(super) fn summaries(paired: &[Paired<'_>], joints: &[String], rules: &Rules) -> Vec<Summary> {
    let pairs = || paired.iter().map(|paired| &paired.pair);
    let mixed = pairs().any(|p| p.kind == Kind::Start) && pairs().any(|p| p.kind == Kind::Reversal);
    let both =
        [JointKind::Turns, JointKind::Slides].iter().all(|kind| pairs().any(|p| p.joint_kind == *kind));
    let of_kinds = [both.then_some(Scope::Turning), both.then_some(Scope::Sliding)];
    let scopes = [Some(Scope::All), mixed.then_some(Scope::Starts)];
    let scopes = scopes.into_iter().chain(of_kinds).flatten().chain(joints.iter().cloned().map(Scope::Joint));
    let metrics = Metric::<Transition>::rows();
    let of = |scope: Scope| metrics.iter().map(move |metric| summary(paired, metric, scope.clone(), rules));
    scopes.flat_map(of).collect()
}

fn summary(
    paired: &[Paired<'_>],
    metric: &'static Metric<Transition>,
    scope: Scope,
    rules: &Rules,
) -> Summary {
    let within = |pair: &TransitionPair| match &scope {
        Scope::All => true,
        Scope::Starts => pair.kind == Kind::Start,
        Scope::Turning => pair.joint_kind == JointKind::Turns,
        Scope::Sliding => pair.joint_kind == JointKind::Slides,
        Scope::Joint(joint) => pair.joint == *joint,
    };
    let inside: Vec<&Paired<'_>> = paired.iter().filter(|paired| within(&paired.pair)).collect();
    // Positions of joints that turn and of joints that slide have no common mean.
    let alike = inside.windows(2).all(|two| two[0].pair.joint_kind == two[1].pair.joint_kind);
    let comparable = alike || !metric.dimension.is_of_joint();
    // When, before, after; with the values of the runs.
    let mut found: Vec<([f64; 3], &Paired<'_>)> = inside
        .into_iter()
        .filter(|_| comparable)
        .filter_map(|paired| {
            let (pair, change) = (&paired.pair, paired.pair.changes.get(metric.key));
            // Of both runs alike, so that the same events are found whichever comes first.
            let at_s = 0.5 * (pair.planned_onset_before_s + pair.planned_onset_after_s);
            Some(([at_s, change.before?, change.after?], paired))
        })
        .collect();
    found.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
    let runs = [0, 1].map(|side| of_runs(&found, metric, side));
    let found: Vec<[f64; 3]> = found.into_iter().map(|(values, _)| values).collect();
    let mean =
        |values: &[f64]| (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64);
    let of = |side: usize| mean(&found.iter().map(|values| values[side]).collect::<Vec<_>>());
    let changes: Vec<(f64, f64)> =
        found.iter().map(|[at_s, before, after]| (*at_s, after - before)).collect();
    let differences: Vec<f64> = changes.iter().map(|change| change.1).collect();
    let mean_difference = mean(&differences);
    let events = events(&changes, rules.same_event_s);
    let tested = by_runs(&runs, rules).filter(|_| differences.iter().any(|d| d.abs() > 0.0));
    let tested = tested.unwrap_or_else(|| by_events(&events, mean_difference, rules));
    Summary {
        measure: Row(metric),
        scope,
        pairs: found.len(),
        events: events.len(),
        mean_before: of(1),
        mean_after: of(2),
        mean_difference,
        median_difference: mean_difference.map(|_| median(differences.clone())),
        interval_95: tested.interval_95,
        relative_change: mean_difference.zip(of(1).filter(|mean| *mean > 0.0)).map(|(d, before)| d / before),
        smaller: differences.iter().filter(|d| **d < 0.0).count(),
        larger: differences.iter().filter(|d| **d > 0.0).count(),
        by_runs: tested.by_runs,
        p_value: tested.p_value,
        p_is_exact: tested.p_is_exact,
        verdict: tested.verdict,
    }
}

/// The mean of a metric over transitions in each run of a side.
fn of_runs(found: &[([f64; 3], &Paired<'_>)], metric: &Metric<Transition>, side: usize) -> Vec<f64> {
    let of = |paired: &Paired<'_>, run: usize| {
        paired.runs[side].get(run).and_then(|transition| metric.number(transition))
    };
    let runs = found.first().map_or(0, |(_, paired)| paired.runs[side].len());
    let sum = |run: usize| found.iter().filter_map(|(_, paired)| of(paired, run)).sum::<f64>();
    (0..runs).map(|run| sum(run) / found.len() as f64).collect()
}

/// Those of a metric over all transitions: one, or one of joints that turn and one of joints that slide.
pub(super) fn overall<'a>(summaries: &'a [Summary], key: &str) -> Vec<&'a Summary> {
    let of = |scopes: &[Scope]| {
        summaries.iter().filter(|s| s.measure.key == key && scopes.contains(&s.scope)).collect::<Vec<_>>()
    };
    let of_kinds = of(&[Scope::Turning, Scope::Sliding]);
    if of_kinds.is_empty() { of(&[Scope::All]) } else { of_kinds }
}

/// What several say together: the worst of them, where less is known the less good.
pub(super) fn worst(summaries: &[&Summary]) -> Verdict {
    const ORDER: [Verdict; 6] = [
        Verdict::Larger,
        Verdict::Mixed,
        Verdict::TooFew,
        Verdict::NotShown,
        Verdict::Equal,
        Verdict::Smaller,
    ];
    let said = |verdict: &&Verdict| summaries.iter().any(|summary| summary.verdict == **verdict);
    ORDER.iter().find(said).copied().unwrap_or(Verdict::TooFew)
}
