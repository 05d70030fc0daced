//! The stretch of the plan that every run holds: a recorder that ran on at rest, or one that stopped early, is no change.

use std::collections::BTreeMap;

use super::{CompareFailure, Inputs, pairing::matched};
use crate::{
    log::TimeRange,
    replay::{Replay, Transition},
    series::Pair,
    workflow::report::{self, Report},
};

/// Rests whose lengths differ by no more are alike, s.
const ALIKE_S: f64 = 0.5;
/// So much more rest is kept than the run with the least has, so that no sample decides what is a start, s.
const MARGIN_S: f64 = 0.05;

/// Onsets of one plan as close as this are one, s.
const SAME_S: f64 = 0.1;

/// What of a run is compared.
#[derive(Debug, Clone, Default)]
pub(super) struct Extent {
    /// From the first planned start of the whole run to its last planned stop, s.
    pub(super) plan_duration_s: Option<f64>,
    /// From when to when, of any joint; `None` for all of it.
    pub(super) stretch_s: Option<[f64; 2]>,
    /// Transitions of the run that lie outside.
    pub(super) beyond: Vec<Transition>,
}

/// By joint, from when to when it is compared, s; empty for all of a run.
type Stretches = BTreeMap<String, [f64; 2]>;

/// Cuts each run to what all of them hold of the plan, from the rest before its first start to the rest after its last
/// stop; each joint by itself, for a sensor may fail before the others.
pub(super) fn cut_alike(
    inputs: &Inputs,
    joints: &[String],
    reports: &mut [&mut Report],
) -> Result<Vec<Extent>, CompareFailure> {
    let stretches = common(joints, &reports.iter().map(|report| &**report).collect::<Vec<_>>());
    let each = reports.iter_mut().zip(stretches);
    each.map(|(report, stretches_s)| {
        let plan_duration_s = plan_duration_s(&report.replay, joints);
        let outer = stretches_s.values().copied().reduce(around);
        let beyond = outer.map_or(Ok(Vec::new()), |outer| cut(report, (outer, stretches_s), inputs))?;
        Ok(Extent { plan_duration_s, stretch_s: outer, beyond })
    })
    .collect()
}

/// Replays stretches of a run in place of all of it; the transitions beyond.
fn cut(
    report: &mut Report,
    ([from_s, to_s], stretches_s): ([f64; 2], Stretches),
    inputs: &Inputs,
) -> Result<Vec<Transition>, CompareFailure> {
    let mut read = inputs.read.clone();
    read.range = TimeRange::of_seconds(Some(from_s), Some(to_s));
    let (logs, rules) = (report.paths.clone(), inputs.rules.clone());
    let again = report::Inputs { logs, read, rules, stretches_s, ..report::Inputs::default() };
    let failed =
        |source| CompareFailure::Run { path: report.paths.first().cloned().unwrap_or_default(), source };
    let part = report::run(&again).map_err(failed)?;
    let whole = std::mem::replace(&mut report.replay, part.replay);
    (report.pairs, report.tool) = (part.pairs, part.tool);
    // What begins as the stretch ends is no start there.
    let within = |start: &Transition| {
        let same = |other: &Transition| {
            other.joint == start.joint && (other.planned_onset_s - start.planned_onset_s).abs() < SAME_S
        };
        report.replay.transitions.iter().any(same)
    };
    Ok(whole.transitions.into_iter().filter(|start| !within(start)).collect())
}

/// Where the plan begins and ends in a run, and where the samples of a joint do, s.
struct Span {
    /// Whether it is the plan of the first run.
    same_plan: bool,
    plan_s: [f64; 2],
    joint_s: [f64; 2],
}

/// For each run the stretches to compare, of all its joints if any has more than in the other runs.
fn common(joints: &[String], reports: &[&Report]) -> Vec<Stretches> {
    let none = || vec![Stretches::new(); reports.len()];
    let Some(plans) = plans(joints, reports) else { return none() };
    let mut stretches = none();
    for joint in joints {
        let span = |(report, (same_plan, plan_s)): (&&Report, &(bool, [f64; 2]))| {
            Some(Span { same_plan: *same_plan, plan_s: *plan_s, joint_s: joint_s(report, joint)? })
        };
        let spans: Option<Vec<Span>> = reports.iter().zip(&plans).map(span).collect();
        for (of_run, stretch_s) in stretches.iter_mut().zip(spans.iter().flat_map(|spans| of_spans(spans))) {
            of_run.extend(stretch_s.map(|stretch_s| (joint.clone(), stretch_s)));
        }
    }
    // What the reading cuts off for one joint may not be cut off from another.
    for (of_run, report) in stretches.iter_mut().zip(reports).filter(|(of_run, _)| !of_run.is_empty()) {
        for joint in joints {
            if let Some(all_s) = joint_s(report, joint) {
                of_run.entry(joint.clone()).or_insert(all_s);
            }
        }
    }
    // Runs that share nothing are compared as they are.
    let holds = |stretches_s: &Stretches| stretches_s.values().all(|[from_s, to_s]| from_s < to_s);
    if stretches.iter().all(holds) { stretches } else { none() }
}

/// Whether each run is of the first one's plan, and where its plan begins and ends in it, s: of one plan the run with the
/// most tells, for another may hold no start of it. `None` if that is known of no run.
fn plans(joints: &[String], reports: &[&Report]) -> Option<Vec<(bool, [f64; 2])>> {
    let first = reports.first()?;
    let offset_s = |(k, report): (usize, &&Report)| match k {
        0 => Some(0.0),
        _ => matched(first, report, joints).plans.filter(|plans| plans.same).map(|plans| plans.offset_s),
    };
    let offsets_s: Vec<Option<f64>> = reports.iter().enumerate().map(offset_s).collect();
    let on_first = |(report, offset_s): (&&Report, &Option<f64>)| {
        offset_s.and_then(|offset_s| Some(plan_s(report, joints)?.map(|at_s| at_s - offset_s)))
    };
    let of_first = reports.iter().zip(&offsets_s).filter_map(on_first);
    let of_first = of_first.reduce(around);
    let each = reports.iter().zip(&offsets_s).map(|(report, offset_s)| match offset_s {
        Some(offset_s) => Some((true, of_first?.map(|at_s| at_s + offset_s))),
        None => Some((false, plan_s(report, joints)?)),
    });
    each.collect()
}

fn of_spans(spans: &[Span]) -> Vec<Option<[f64; 2]>> {
    let rest_s = |span: &Span| [span.plan_s[0] - span.joint_s[0], span.joint_s[1] - span.plan_s[1]];
    let least = spans.iter().map(rest_s);
    let least = least.fold([f64::INFINITY; 2], |all, one| [all[0].min(one[0]), all[1].min(one[1])]);
    let stretch = |span: &Span| {
        // Of another plan nothing but rests is cut.
        let least = if span.same_plan { least } else { least.map(|s| s.max(0.0)) };
        let margin = |rest_s: f64| if rest_s > 0.0 { MARGIN_S } else { 0.0 };
        // In motion every run is cut to the same instant.
        let alike = |rest_s: f64| if rest_s > 0.0 { ALIKE_S } else { MARGIN_S };
        let cut_s =
            [span.plan_s[0] - least[0] - margin(least[0]), span.plan_s[1] + least[1] + margin(least[1])];
        let more =
            cut_s[0] - span.joint_s[0] > alike(least[0]) || span.joint_s[1] - cut_s[1] > alike(least[1]);
        more.then(|| [cut_s[0].max(span.joint_s[0]), cut_s[1].min(span.joint_s[1])])
    };
    spans.iter().map(stretch).collect()
}

/// From the end of the first rest of the plan of a run to the begin of its last one, s.
fn plan_s(report: &Report, joints: &[String]) -> Option<[f64; 2]> {
    let Ends { starts_s: [first_s, last_s], stop_s } = ends(&report.replay, joints)?;
    let own = report.pairs.iter().filter(|pair| joints.contains(&pair.name));
    let moves_s = own.filter_map(|pair| moves_s(pair, report.replay.rules.sizes(pair.kind).displacement));
    Some(moves_s.fold([first_s, stop_s.map_or(last_s, |stop_s| stop_s.max(last_s))], around))
}

/// From the first to the last sample at which a plan is away from where it begins and from where it ends, s.
fn moves_s(pair: &Pair, least: f64) -> Option<[f64; 2]> {
    let [first, last] = [pair.planned.first()?, pair.planned.last()?];
    let from = pair.planned.iter().position(|position| (position - first).abs() > least)?;
    let to = pair.planned.iter().rposition(|position| (position - last).abs() > least)?;
    Some([*pair.t_s.get(from)?, *pair.t_s.get(to)?])
}

fn around(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// From when to when a joint of a run is known, s.
fn joint_s(report: &Report, joint: &str) -> Option<[f64; 2]> {
    let pair = report.pairs.iter().find(|pair| pair.name == joint)?;
    Some([*pair.t_s.first()?, *pair.t_s.last()?])
}

/// From the first planned start to the last planned stop, s.
fn plan_duration_s(replay: &Replay, joints: &[String]) -> Option<f64> {
    let Ends { starts_s: [first_s, _], stop_s } = ends(replay, joints)?;
    Some(stop_s? - first_s).filter(|span_s| *span_s > 0.0)
}

/// The first and the last planned start of some joints, and their last planned stop, s.
struct Ends {
    starts_s: [f64; 2],
    stop_s: Option<f64>,
}

fn ends(replay: &Replay, joints: &[String]) -> Option<Ends> {
    let within = |joint: &String| joints.contains(joint);
    let starts = replay.transitions.iter().filter(|t| within(&t.joint)).map(|t| t.planned_onset_s);
    let stops = replay.stops.iter().filter(|s| within(&s.joint)).filter_map(|s| s.planned_s);
    let starts_s = [starts.clone().reduce(f64::min)?, starts.reduce(f64::max)?];
    Some(Ends { starts_s, stop_s: stops.reduce(f64::max) })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn span(same_plan: bool, plan_s: [f64; 2], joint_s: [f64; 2]) -> Span {
        Span { same_plan, plan_s, joint_s }
    }

    #[test]
    fn runs_are_cut_to_what_all_of_them_hold() {
        let near = |found: &Option<[f64; 2]>, expected: [f64; 2]| {
            let found = found.unwrap();
            assert!((0..2).all(|k| (found[k] - expected[k]).abs() < 1e-9), "{found:?} {expected:?}");
        };
        let whole = || span(true, [2.0, 20.0], [0.0, 25.0]);
        // The recorder ran on, and began earlier on a clock of its own.
        let found = of_spans(&[whole(), span(true, [9.0, 27.0], [0.0, 90.0])]);
        assert_eq!(found[0], None);
        near(&found[1], [6.95, 32.05]);
        // It stopped in the middle of the plan, or before its first start.
        for end_s in [14.3, 1.5] {
            let found = of_spans(&[whole(), span(true, [2.0, 20.0], [0.0, end_s])]);
            near(&found[0], [0.0, end_s]);
            assert_eq!(found[1], None);
        }
        // It began in motion.
        let found = of_spans(&[whole(), span(true, [-0.3, 17.7], [0.0, 22.7])]);
        near(&found[0], [2.3, 25.0]);
        assert_eq!(found[1], None);
        // Another plan, which takes longer: the rests are made equal.
        let found = of_spans(&[whole(), span(false, [2.0, 24.0], [0.0, 40.0])]);
        assert_eq!(found[0], None);
        near(&found[1], [0.0, 29.05]);
    }
}
