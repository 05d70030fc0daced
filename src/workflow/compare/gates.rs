//! Limits on a change.

use serde::{Deserialize, Serialize};

use super::{
    figures::Figures,
    pair::TransitionPair,
    summary::{Scope, Summary},
};
use crate::{
    replay::{Keyed, PEAK_ERROR, Row},
    series::JointKind,
};

/// A limit on a change.
#[derive(Debug)]
pub struct Gate {
    /// As in documents.
    pub key: &'static str,
    /// What is limited, in sentences.
    pub name: &'static str,
    /// What the number is.
    pub form: Form,
    find: fn(&Found<'_>) -> Option<Worst>,
}

/// What a limited number is, and the side of it that is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// A reduction as a share, at least.
    Reduction,
    /// The probability of a reduction by chance, at most.
    Probability,
    /// An error in the joint's unit, at most.
    Growth,
    /// After over before, at most.
    Ratio,
}

/// What is judged.
struct Found<'a> {
    peak: Option<&'a Summary>,
    pairs: &'a [TransitionPair],
    figures: Option<&'a Figures>,
}

/// The number found; where, for a transition; and whether it is of no reduction.
#[derive(Default)]
struct Worst {
    value: f64,
    pair: Option<(String, f64, JointKind)>,
    no_reduction: bool,
}

/// One row a limit.
static GATES: &[Gate] = &[
    Gate {
        key: "peak-reduction",
        name: "reduction of the mean transition peak",
        form: Form::Reduction,
        find: |found| {
            let peak = found.peak?;
            let value = match (peak.relative_change, peak.mean_difference) {
                (Some(change), _) => -change,
                // Nothing to reduce.
                (None, Some(difference)) if difference <= 0.0 => 0.0,
                _ => return None,
            };
            Some(Worst { value, ..Worst::default() })
        },
    },
    Gate {
        key: "p",
        name: "p of a reduction of transition peaks",
        form: Form::Probability,
        find: |found| {
            let peak = found.peak.filter(|peak| peak.pairs > 0)?;
            let no_reduction = peak.mean_difference.is_none_or(|difference| difference >= 0.0);
            Some(Worst { value: peak.p_value, no_reduction, ..Worst::default() })
        },
    },
    Gate {
        key: "transition-growth",
        name: "growth of a transition's peak",
        form: Form::Growth,
        find: |found| {
            let growth =
                |pair: &TransitionPair| pair.changes.get(PEAK_ERROR).difference.unwrap_or(f64::NEG_INFINITY);
            let worst = found.pairs.iter().max_by(|a, b| growth(a).total_cmp(&growth(b)))?;
            let pair = Some((worst.joint.clone(), worst.planned_onset_before_s, worst.joint_kind));
            Some(Worst { value: growth(worst), pair, no_reduction: false })
        },
    },
    Gate {
        key: "rms-ratio",
        name: "rms error after over before",
        form: Form::Ratio,
        find: |found| ratio(found, "rms"),
    },
    Gate {
        key: "peak-ratio",
        name: "peak error after over before",
        form: Form::Ratio,
        find: |found| ratio(found, "peak"),
    },
];

fn ratio(found: &Found<'_>, key: &str) -> Option<Worst> {
    Some(Worst { value: found.figures?.changes.get(key).ratio?, ..Worst::default() })
}

impl Keyed for Gate {
    fn key(&self) -> &'static str {
        self.key
    }

    fn rows() -> Vec<&'static Self> {
        GATES.iter().collect()
    }
}

/// The limits that a change must keep.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Gates(Vec<(Row<Gate>, f64)>);

/// A limit and what was found against it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct GateResult {
    /// Which limit.
    pub gate: Row<Gate>,
    /// The limit, in SI units.
    pub limit: f64,
    /// What was found; `None` if nothing could be compared, which keeps no limit.
    pub found: Option<f64>,
    /// The joint it was found at, for the growth of a transition.
    pub joint: Option<String>,
    /// When its plan starts before, s.
    pub time_s: Option<f64>,
    /// Whether the limit is kept.
    pub kept: bool,
}

impl Gates {
    /// With a limit more, by its key, in SI units; a key of no limit adds none.
    #[must_use]
    pub fn with(mut self, key: &str, value: Option<f64>) -> Self {
        self.0.extend(Row::find(key).zip(value));
        self
    }

    /// Judges every limit.
    pub(super) fn judge(
        &self,
        pairs: &[TransitionPair],
        summaries: &[Summary],
        figures: &[Figures],
    ) -> Vec<GateResult> {
        let peak = summaries.iter().find(|s| s.measure.key == PEAK_ERROR && s.scope == Scope::All);
        let found = Found { peak, pairs, figures: figures.first() };
        let judge = |&(gate, limit): &(Row<Gate>, f64)| {
            let worst = (gate.find)(&found);
            let kept = worst.as_ref().is_some_and(|worst| match gate.form {
                Form::Reduction => worst.value >= limit,
                Form::Probability | Form::Growth | Form::Ratio => worst.value <= limit && !worst.no_reduction,
            });
            let pair = worst.as_ref().and_then(|worst| worst.pair.as_ref());
            GateResult {
                gate,
                limit,
                found: worst.as_ref().map(|worst| worst.value),
                joint: pair.map(|(joint, _, _)| joint.clone()),
                time_s: pair.map(|(_, at_s, _)| *at_s),
                kept,
            }
        };
        self.0.iter().map(judge).collect()
    }
}
