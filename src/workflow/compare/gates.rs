//! Limits on a change.

use serde::{Deserialize, Serialize};

use super::{
    change::Changes,
    figures::Figures,
    pair::TransitionPair,
    summary::{Scope, Summary, overall},
};
use crate::{
    replay::{Keyed, Metric, PEAK_ERROR, Row, ToolReplay},
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
    /// An error of joints of this kind, in their unit, at most.
    Growth(JointKind),
    /// After over before, at most.
    Ratio,
    /// A distance after, at most.
    Distance,
}

/// What is judged.
struct Found<'a> {
    peaks: Vec<&'a Summary>,
    pairs: &'a [TransitionPair],
    figures: &'a [Figures],
    tool: Option<&'a Changes<Metric<ToolReplay>>>,
}

/// The number found; where, for a transition; and whether it is of no reduction.
#[derive(Default)]
struct Worst {
    value: f64,
    pair: Option<(String, f64)>,
    no_reduction: bool,
}

const fn gate(
    key: &'static str,
    name: &'static str,
    form: Form,
    find: fn(&Found<'_>) -> Option<Worst>,
) -> Gate {
    Gate { key, name, form, find }
}

/// One row a limit.
static GATES: &[Gate] = &[
    gate("peak-reduction", "reduction of the mean transition peak", Form::Reduction, |found| {
        let reduction = |peak: &&Summary| match (peak.relative_change, peak.mean_difference) {
            (Some(change), _) => Some(-change),
            // Nothing to reduce.
            (None, Some(difference)) if difference <= 0.0 => Some(0.0),
            _ => None,
        };
        let all: Option<Vec<f64>> = found.peaks.iter().map(reduction).collect();
        Some(Worst { value: all?.into_iter().reduce(f64::min)?, ..Worst::default() })
    }),
    gate("p", "p of a reduction of transition peaks", Form::Probability, |found| {
        let some = found.peaks.iter().all(|peak| peak.pairs > 0);
        let value = found.peaks.iter().filter(|_| some).map(|peak| peak.p_value).reduce(f64::max)?;
        let grows = |peak: &&Summary| peak.mean_difference.is_none_or(|difference| difference >= 0.0);
        Some(Worst { value, no_reduction: found.peaks.iter().any(grows), ..Worst::default() })
    }),
    gate("transition-growth", "growth of a transition's peak", Form::Growth(JointKind::Turns), |found| {
        growth(found, JointKind::Turns)
    }),
    gate(
        "transition-growth-sliding",
        "growth of a transition's peak, joints that slide",
        Form::Growth(JointKind::Slides),
        |found| growth(found, JointKind::Slides),
    ),
    gate("rms-ratio", "rms error after over before", Form::Ratio, |found| ratio(found, "rms")),
    gate("peak-ratio", "peak error after over before", Form::Ratio, |found| ratio(found, "peak")),
    gate("tool-error", "worst error of the tool after", Form::Distance, |found| after(found, "worst_m")),
    gate("end-error", "error of the tool at rest at the end after", Form::Distance, |found| {
        after(found, "end_m")
    }),
];

fn growth(found: &Found<'_>, kind: JointKind) -> Option<Worst> {
    let of_kind = found.pairs.iter().filter(|pair| pair.joint_kind == kind);
    let grown = of_kind.filter_map(|pair| Some((pair.changes.get(PEAK_ERROR).difference?, pair)));
    let (value, worst) = grown.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let pair = Some((worst.joint.clone(), worst.planned_onset_before_s));
    Some(Worst { value, pair, no_reduction: false })
}

fn ratio(found: &Found<'_>, key: &str) -> Option<Worst> {
    // All joints together, or, where they have no unit in common, the worse of those that turn and those that slide.
    let of = |scope: Scope| {
        found.figures.iter().find(|figures| figures.scope == scope).and_then(|f| f.changes.get(key).ratio)
    };
    let of_kinds = || Some(of(Scope::Turning)?.max(of(Scope::Sliding)?));
    let value = of(Scope::All).or_else(of_kinds)?;
    Some(Worst { value, ..Worst::default() })
}

fn after(found: &Found<'_>, key: &str) -> Option<Worst> {
    Some(Worst { value: found.tool?.get(key).after?, ..Worst::default() })
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
pub struct Gates {
    gates: Vec<(Row<Gate>, f64)>,
    /// Whether a limit is kept by runs of which nothing can be compared.
    empty_is_kept: bool,
}

/// A limit and what was found against it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct GateResult {
    /// Which limit.
    pub gate: Row<Gate>,
    /// The limit, in SI units.
    pub limit: f64,
    /// What was found; `None` if nothing could be compared.
    pub found: Option<f64>,
    /// The joint it was found at, for the growth of a transition.
    pub joint: Option<String>,
    /// When its plan starts before, s.
    pub time_s: Option<f64>,
    /// Whether the limit is kept; not if nothing could be compared, unless that was allowed.
    pub kept: bool,
}

impl Gates {
    /// With a limit more, by its key, in SI units; a key of no limit adds none.
    pub fn with(mut self, key: &str, value: Option<f64>) -> Self {
        self.gates.extend(Row::find(key).zip(value));
        self
    }

    /// Where nothing can be compared, limits are kept.
    pub fn with_empty_kept(self, empty_is_kept: bool) -> Self {
        Self { empty_is_kept, ..self }
    }

    /// Judges every limit.
    pub(super) fn judge(
        &self,
        pairs: &[TransitionPair],
        summaries: &[Summary],
        (figures, tool): (&[Figures], Option<&Changes<Metric<ToolReplay>>>),
    ) -> Vec<GateResult> {
        let found = Found { peaks: overall(summaries, PEAK_ERROR), pairs, figures, tool };
        let judge = |&(gate, limit): &(Row<Gate>, f64)| {
            let worst = (gate.find)(&found);
            let kept = worst.as_ref().map_or(self.empty_is_kept, |worst| match gate.form {
                Form::Reduction => worst.value >= limit,
                Form::Probability | Form::Growth(_) | Form::Ratio | Form::Distance => {
                    worst.value <= limit && !worst.no_reduction
                }
            });
            let pair = worst.as_ref().and_then(|worst| worst.pair.as_ref());
            let (joint, time_s) = (pair.map(|(joint, _)| joint.clone()), pair.map(|(_, at_s)| *at_s));
            GateResult { gate, limit, found: worst.as_ref().map(|worst| worst.value), joint, time_s, kept }
        };
        self.gates.iter().map(judge).collect()
    }
}
