//! `fleet gate`: limits on what joints may drift by.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{
    drift::{Drift, drift},
    failure::FleetFailure,
    history::{By, Filter},
    joint_trend::JointTrend,
};
use crate::{document::PROGRAM, remark::Remarks};

/// What the format is called.
const FORMAT: &str = "hydrotrace.fleet-gate.v1";

/// A limit on the growth of a metric.
#[derive(Debug, Clone, PartialEq)]
pub struct Gate {
    /// The metric.
    pub metric: By,
    /// The unit of the joints that it judges, and so that of the limit: "s", "rad" or "m".
    pub unit: String,
    /// Growth a day, at most, in that unit.
    pub most_per_day: f64,
}

/// What the limits were held against.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Gated {
    /// Always "hydrotrace.fleet-gate.v1".
    pub format: String,
    /// Name and version of the program that wrote it.
    pub program: String,
    /// The limits, each with the worst trend found against it.
    pub gates: Vec<GateResult>,
    /// Whether every limit is kept; if not, the exit code is 4.
    pub gates_kept: bool,
    /// Machines, joints and metrics with too few runs of one plan to be judged.
    #[serde(default)]
    pub too_few: usize,
    /// Runs of one plan that a joint takes to be judged among so many.
    #[serde(default)]
    pub fewest_runs: usize,
    /// Doubts about the data.
    pub remarks: Remarks,
}

/// A limit and what was found against it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct GateResult {
    /// The metric.
    pub metric: By,
    /// Its unit.
    pub unit: String,
    /// Growth a day, at most.
    pub most_per_day: f64,
    /// Joints whose trend was judged.
    pub judged: usize,
    /// Joints that break the limit: they grow faster, and their trend or step is found (q below the false-discovery rate).
    pub broken_by: usize,
    /// The fastest growth among the joints that break the limit, else among all; null if there was nothing to judge.
    pub worst: Option<JointTrend>,
    /// By how much a day all machines change alike, where that is taken off the growth of each: the most of the joints judged. More than
    /// the limit breaks it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shared_per_day: Option<f64>,
    /// The other joints that break the limit, the fastest first: machine, and joint with its direction.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub also: Vec<String>,
    /// Whether the limit is kept; not if there was nothing to judge, unless that was allowed.
    pub kept: bool,
}

/// Judges the limits.
///
/// # Errors
///
/// [`FleetFailure`] if there is no dataset, or no such machine in it.
pub fn gate(
    root: &Path,
    filter: &Filter,
    gates: &[Gate],
    empty_is_kept: bool,
) -> Result<Gated, FleetFailure> {
    // What is judged beside it makes every finding less sure.
    let by: Vec<By> = By::ALL.into_iter().filter(|by| gates.iter().any(|gate| gate.metric == *by)).collect();
    let found = drift(root, filter, &by)?;
    let gates: Vec<GateResult> = gates.iter().map(|gate| judged(gate, &found, empty_is_kept)).collect();
    Ok(Gated {
        format: FORMAT.to_owned(),
        program: PROGRAM.to_owned(),
        gates_kept: gates.iter().all(|gate| gate.kept),
        gates,
        too_few: found.too_few + found.trends.iter().filter(|trend| !is_judged(trend, &found)).count(),
        fewest_runs: found.fewest_runs,
        remarks: found.remarks,
    })
}

/// Whether a trend could be found: of fewer runs none could, however fast it grows.
fn is_judged(trend: &JointTrend, found: &Drift) -> bool {
    trend.found || trend.runs >= found.fewest_runs
}

fn judged(gate: &Gate, found: &Drift, empty_is_kept: bool) -> GateResult {
    let own = || {
        let of_gate = |trend: &&JointTrend| trend.metric == gate.metric && trend.unit == gate.unit;
        found.trends.iter().filter(of_gate).filter(|trend| is_judged(trend, found))
    };
    // What all share, it does, too.
    let whole = |trend: &JointTrend| trend.growth_per_day() + trend.shared_per_day.unwrap_or(0.0).max(0.0);
    let breaks = |trend: &&JointTrend| trend.found && whole(trend) > gate.most_per_day;
    let fastest = |a: &&JointTrend, b: &&JointTrend| a.growth_per_day().total_cmp(&b.growth_per_day());
    let (judged, broken_by) = (own().count(), own().filter(breaks).count());
    let mut breaking: Vec<&JointTrend> = own().filter(breaks).collect();
    breaking.sort_by(|a, b| fastest(b, a));
    let worst = breaking.first().copied().or_else(|| own().max_by(fastest));
    let shared_per_day = own().filter_map(|trend| trend.shared_per_day).reduce(f64::max);
    let all_grow = shared_per_day.is_some_and(|growth| growth > gate.most_per_day);
    let also =
        breaking.iter().skip(1).map(|trend| format!("{} {}", trend.machine, trend.joint_and_direction()));
    GateResult {
        also: also.collect(),
        shared_per_day,
        metric: gate.metric,
        unit: gate.unit.clone(),
        most_per_day: gate.most_per_day,
        judged,
        broken_by,
        worst: worst.cloned(),
        kept: broken_by == 0 && !all_grow && (judged > 0 || empty_is_kept),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(slopes: &[(f64, bool)]) -> Drift {
        let trend = |(slope, found): &(f64, bool)| JointTrend {
            machine: "M".into(),
            joint: format!("j{slope}"),
            metric: By::Delay,
            unit: "s".into(),
            slope_per_day: *slope,
            found: *found,
            runs: 10,
            ..JointTrend::default()
        };
        Drift {
            format: String::new(),
            program: String::new(),
            runs: 10,
            machines: 1,
            false_discovery_rate: 0.05,
            trends: slopes.iter().map(trend).collect(),
            alike: Vec::new(),
            maps: Vec::new(),
            too_few: 0,
            fewest_runs: 5,
            remarks: Remarks::default(),
        }
    }

    fn limit() -> Gate {
        Gate { metric: By::Delay, unit: "s".into(), most_per_day: 0.01 }
    }

    #[test]
    fn only_a_trend_that_is_found_breaks_a_limit() {
        let of = |slopes: &[(f64, bool)]| judged(&limit(), &found(slopes), false);
        let unsure = of(&[(0.03, false), (0.002, true)]);
        assert!(unsure.kept && unsure.judged == 2);
        let broken = of(&[(0.03, false), (0.02, true), (-0.5, true)]);
        assert_eq!((broken.kept, broken.broken_by), (false, 1));
        assert_eq!(broken.worst.unwrap().joint, "j0.02");
        assert!(of(&[(0.01, true)]).kept);
    }

    #[test]
    fn a_limit_with_nothing_to_judge_is_not_kept_unless_that_is_allowed() {
        assert!(!judged(&limit(), &found(&[]), false).kept);
        assert!(judged(&limit(), &found(&[]), true).kept);
        // Ten runs prove nothing among so many trends.
        let many = Drift { fewest_runs: 11, ..found(&[(0.03, false)]) };
        assert!(!judged(&limit(), &many, false).kept && is_judged(&found(&[(0.03, true)]).trends[0], &many));
    }
}
