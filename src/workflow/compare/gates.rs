//! Limits on a change.

use serde::Serialize;

use super::{Change, Figures, Measure, Scope, Summary, TransitionPair};

/// What a change must keep; `None` is no limit.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Gates {
    /// Reduction of the mean transition peak, as a share of that before.
    pub min_peak_reduction: Option<f64>,
    /// Two-sided p of the change in transition peaks, which must be a reduction.
    pub max_p: Option<f64>,
    /// Growth of any transition's peak, rad.
    pub max_transition_growth_rad: Option<f64>,
    /// Root mean square error over the run and all joints, after over before.
    pub max_rms_ratio: Option<f64>,
    /// Peak error over the run and all joints, after over before.
    pub max_peak_ratio: Option<f64>,
}

/// A quantity that can be limited.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Gate {
    /// Reduction of the mean transition peak, a share.
    PeakReduction,
    /// Two-sided p of a reduction of transition peaks.
    P,
    /// Growth of a transition's peak, rad.
    TransitionGrowth,
    /// Ratio of root mean square errors.
    RmsRatio,
    /// Ratio of peak errors.
    PeakRatio,
}

/// A limit and what was found against it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct GateResult {
    /// Which limit.
    pub gate: Gate,
    /// The limit, in SI units.
    pub limit: f64,
    /// What was found; `None` where nothing could be compared, which keeps no limit.
    pub found: Option<f64>,
    /// The joint it was found at, for the growth of a transition.
    pub joint: Option<String>,
    /// When its plan starts before, s.
    pub time_s: Option<f64>,
    /// Whether the limit is kept.
    pub kept: bool,
}

/// Judges every limit that is set.
pub(super) fn gates(
    limits: &Gates,
    pairs: &[TransitionPair],
    summaries: &[Summary],
    figures: &[Figures],
) -> Vec<GateResult> {
    let peak = summaries.iter().find(|s| s.measure == Measure::PeakError && s.scope == Scope::All);
    let reduction = peak.and_then(|peak| match (peak.relative_change, peak.mean_difference) {
        (Some(change), _) => Some(-change),
        // Nothing to reduce.
        (None, Some(difference)) if difference <= 0.0 => Some(0.0),
        _ => None,
    });
    let of = |change: fn(&Figures) -> Change| figures.first().and_then(|all| change(all).ratio);
    let result = |gate, limit, found: Option<f64>, kept: bool| GateResult {
        gate,
        limit,
        found,
        joint: None,
        time_s: None,
        kept: kept && found.is_some(),
    };
    let at_most =
        |gate, limit: f64, found: Option<f64>| result(gate, limit, found, found.is_some_and(|f| f <= limit));
    let p = peak.filter(|peak| peak.pairs > 0);
    let reduced = p.and_then(|peak| peak.mean_difference).is_some_and(|difference| difference < 0.0);
    let results = [
        limits.min_peak_reduction.map(|limit| {
            result(Gate::PeakReduction, limit, reduction, reduction.is_some_and(|r| r >= limit))
        }),
        limits.max_p.map(|limit| {
            let kept = reduced && p.is_some_and(|peak| peak.p_value <= limit);
            result(Gate::P, limit, p.map(|peak| peak.p_value), kept)
        }),
        limits.max_transition_growth_rad.map(|limit| {
            let growth = |pair: &TransitionPair| pair.peak_error.difference.unwrap_or(f64::NEG_INFINITY);
            let worst = pairs.iter().max_by(|a, b| growth(a).total_cmp(&growth(b)));
            GateResult {
                joint: worst.map(|pair| pair.joint.clone()),
                time_s: worst.map(|pair| pair.planned_onset_before_s),
                ..at_most(Gate::TransitionGrowth, limit, worst.map(growth))
            }
        }),
        limits.max_rms_ratio.map(|limit| at_most(Gate::RmsRatio, limit, of(|all| all.rms))),
        limits.max_peak_ratio.map(|limit| at_most(Gate::PeakRatio, limit, of(|all| all.peak))),
    ];
    results.into_iter().flatten().collect()
}
