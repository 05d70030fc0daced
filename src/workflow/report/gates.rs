//! Limits on the metrics of a run, and what was found against them.

use serde::{Deserialize, Serialize};

use crate::{
    replay::{
        JOINT, JointReplay, Judged, Limit, Metric, Replay, Row, TOOL, TRANSITION, ToolReplay, Transition,
    },
    series::{JointKind, Pair},
};

/// Fewer samples beside a plan are no run that could keep a limit: of a recorder that failed.
const FEWEST: usize = 20;

/// The limits that a run must keep.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Gates {
    gates: Vec<Gate>,
    /// Whether a limit is kept by a run in which there is nothing to judge.
    empty_is_kept: bool,
}

/// A limit with its value.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Gate {
    limit: Row<Limit>,
    kind: JointKind,
    value: f64,
}

/// A limit and the worst that was found against it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct GateResult {
    /// Which limit.
    pub gate: Row<Limit>,
    /// Its unit: that of the joints judged, "rad" or "m", if it is a position, "m" at the tool, else "s".
    pub unit: String,
    /// The limit, in its unit.
    pub limit: f64,
    /// The worst value; `None` if there was nothing to judge, or a start was not answered.
    pub worst: Option<f64>,
    /// The joint it was found at, or the tool's link; `None` if there was nothing to judge.
    pub joint: Option<String>,
    /// When, s; for a mean over the run when the error peaked.
    pub time_s: Option<f64>,
    /// Whether the limit is kept; not if there was nothing to judge, unless that was allowed.
    pub kept: bool,
}

impl GateResult {
    /// Whether the joints judged turn or slide.
    pub fn kind(&self) -> JointKind {
        if self.unit == JointKind::Slides.unit() { JointKind::Slides } else { JointKind::Turns }
    }
}

/// Where a limited metric was found: value, joint, time.
type Found<'a> = (Option<f64>, &'a str, Option<f64>);

impl Gates {
    /// With a limit more, in SI units; a limit on positions judges the joints of one kind.
    pub fn with(mut self, limit: &'static Limit, kind: JointKind, value: f64) -> Self {
        self.gates.push(Gate { limit: Row(limit), kind, value });
        self
    }

    /// Where there is nothing to judge, limits are kept: a run without a start keeps those on starts.
    pub fn with_empty_kept(self, empty_is_kept: bool) -> Self {
        Self { empty_is_kept, ..self }
    }

    /// Judges every limit; without a tool there is none to judge, and of joints with hardly a sample there is nothing.
    pub(super) fn judge(
        &self,
        replay: &Replay,
        tool: Option<&ToolReplay>,
        pairs: &[Pair],
    ) -> Vec<GateResult> {
        let few: Vec<&str> =
            pairs.iter().filter(|pair| pair.matched < FEWEST).map(|pair| pair.name.as_str()).collect();
        let tool = tool.filter(|_| few.len() < pairs.len());
        let one = |gate: &Gate| {
            let transitions = of(TRANSITION, gate).map(|metric| {
                let all = replay.transitions.iter().filter(|t| !few.contains(&t.joint.as_str()));
                found(metric, gate, all.map(|t: &Transition| (t, t.joint.as_str(), t.joint_kind)))
            });
            let joints = || {
                let all = replay.joints.iter().filter(|joint| !few.contains(&joint.name.as_str()));
                let all = all.map(|j: &JointReplay| (j, j.name.as_str(), j.kind));
                of(JOINT, gate).map(|metric| found(metric, gate, all))
            };
            let tools = || {
                let all = tool.into_iter().map(|tool| (tool, tool.tool.as_str(), JointKind::Slides));
                of(TOOL, gate).map(|metric| found(metric, gate, all))
            };
            let all = transitions.or_else(joints).or_else(tools).unwrap_or_default();
            worst(gate, all, self.empty_is_kept)
        };
        let all: Vec<GateResult> = self.gates.iter().map(one).collect();
        // Of limits on joints that turn and on those that slide, what an arm has none of breaks none.
        let judged = |key: &str| all.iter().any(|other| other.gate.key == key && other.joint.is_some());
        let has = |kind: JointKind| replay.joints.iter().any(|joint| joint.kind == kind);
        let of_both = self.gates.iter().zip(&all);
        let of_both =
            of_both.filter(|(gate, own)| has(gate.kind) || own.joint.is_some() || !judged(own.gate.key));
        of_both.map(|(_, own)| own.clone()).collect()
    }
}

/// The metric that a limit is on, with what it judges.
fn of<T>(table: &'static [Metric<T>], gate: &Gate) -> Option<(&'static Metric<T>, &'static Judged<T>)> {
    table.iter().find_map(|metric| {
        let judged = metric.limit.as_ref().filter(|judged| judged.limit.key == gate.limit.key)?;
        Some((metric, judged))
    })
}

fn found<'a, T: 'a>(
    (metric, judged): (&Metric<T>, &Judged<T>),
    gate: &Gate,
    all: impl Iterator<Item = (&'a T, &'a str, JointKind)>,
) -> Vec<Found<'a>> {
    all.filter(|(_, _, kind)| !metric.dimension.is_of_joint() || *kind == gate.kind)
        .filter(|(one, _, _)| (judged.counts)(one))
        .map(|(one, joint, _)| (metric.number(one), joint, (judged.at_s)(one)))
        .collect()
}

/// The worst of what was found; what could not be measured is worse than any number.
fn worst(gate: &Gate, found: Vec<Found<'_>>, empty_is_kept: bool) -> GateResult {
    let of = |value: Option<f64>| value.unwrap_or(f64::INFINITY);
    let worst = found.into_iter().max_by(|a, b| of(a.0).total_cmp(&of(b.0)));
    GateResult {
        gate: gate.limit,
        unit: gate.limit.dimension.unit(gate.kind).to_owned(),
        limit: gate.value,
        worst: worst.and_then(|(value, _, _)| value),
        joint: worst.map(|(_, joint, _)| joint.to_owned()),
        time_s: worst.and_then(|(_, _, time_s)| time_s),
        kept: worst.map_or(empty_is_kept, |(value, _, _)| of(value) <= gate.value),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        replay::{Rules, replay},
        series::{Track, align},
    };

    fn gate(key: &str, value: f64) -> Gate {
        Gate { limit: Row::find(key).unwrap(), kind: JointKind::Turns, value }
    }

    #[test]
    fn a_start_that_was_never_answered_breaks_every_limit_on_delay() {
        let found = vec![(Some(0.1), "a", Some(1.0)), (None, "b", Some(2.0))];
        let result = worst(&gate("onset-delay", 10.0), found, false);
        assert_eq!((result.kept, result.worst, result.joint.as_deref()), (false, None, Some("b")));
    }

    /// A joint that follows 12 degrees in 3 s from 4 s on, having crept before, or does not.
    fn replayed(follows: bool) -> Replay {
        let ramp = |t: f64| 0.07 * (t - 4.0).clamp(0.0, 3.0);
        let creep = |t: f64| 0.005 * (t - 1.0).clamp(0.0, 3.0);
        let came = |t: f64| if follows { creep(t) + ramp(t) } else { 0.0 };
        let pair = align(&Track::sampled("a", 1000, ramp), &Track::sampled("a", 1000, came));
        replay(&[pair.unwrap()], &Rules::default())
    }

    #[test]
    fn a_limit_with_nothing_to_judge_is_not_kept_unless_that_is_allowed() {
        let limits = Gates { gates: vec![gate("onset-delay", 0.3)], empty_is_kept: false };
        let judged = |limits: &Gates, follows: bool| limits.judge(&replayed(follows), None, &[]).remove(0);
        // A joint that crept before has no dead time.
        let crept = judged(&limits, true);
        assert_eq!((crept.kept, crept.worst, crept.joint), (false, None, None));
        let allowed = limits.with_empty_kept(true);
        assert!(judged(&allowed, true).kept);
        let never = judged(&allowed, false);
        assert_eq!((never.kept, never.joint.as_deref()), (false, Some("a")));
    }

    #[test]
    fn the_limit_itself_is_kept() {
        assert!(worst(&gate("rms", 0.1), vec![(Some(0.1), "a", None)], false).kept);
    }

    #[test]
    fn a_limit_in_metres_judges_no_joint_that_turns() {
        let in_metres = Gate { kind: JointKind::Slides, ..gate("rms", 0.0) };
        let limits = Gates { gates: vec![in_metres], empty_is_kept: true };
        let judged = limits.judge(&replayed(false), None, &[]).remove(0);
        assert_eq!((judged.unit.as_str(), judged.kept, judged.joint), ("m", true, None));
    }
}
