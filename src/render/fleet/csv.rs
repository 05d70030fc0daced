//! The answers of a fleet as comma-separated values, in SI units.

use crate::{
    render::kit::csv,
    workflow::fleet::{Drift, Effect, Worst},
};

fn optional(value: Option<f64>) -> String {
    value.map_or(String::new(), |value| value.to_string())
}

/// How a metric is called in documents.
fn key(by: crate::workflow::fleet::By) -> String {
    super::name(by).replace(' ', "_")
}

pub(crate) fn worst_csv(worst: &Worst) -> String {
    let headings = [
        "machine", "joint", "metric", "unit", "median", "p95", "largest", "above_fleet", "starts", "runs",
        "at", "log",
    ];
    let rows = worst.joints.iter().map(|joint| {
        vec![
            joint.machine.clone(),
            joint.joint.clone(),
            key(worst.by),
            joint.unit.clone(),
            joint.median.to_string(),
            joint.p95.to_string(),
            joint.largest.to_string(),
            optional(joint.above_fleet),
            joint.starts.to_string(),
            joint.runs.to_string(),
            joint.at.clone().unwrap_or_default(),
            joint.log.clone(),
        ]
    });
    csv(headings, rows)
}

pub(crate) fn drift_csv(drift: &Drift) -> String {
    let headings = [
        "machine", "joint", "metric", "unit", "slope_per_day", "slope_low", "slope_high", "p_value",
        "q_value", "found", "stands_out", "since", "level", "starts", "runs", "days", "is_step",
        "step_after", "step_by", "step_change", "step_low", "step_high", "step_q_value", "direction",
    ];
    let rows = drift.trends.iter().map(|trend| {
        let step = trend.step.as_ref();
        vec![
            trend.machine.clone(),
            trend.joint.clone(),
            key(trend.metric),
            trend.unit.clone(),
            trend.slope_per_day.to_string(),
            trend.interval_95[0].to_string(),
            trend.interval_95[1].to_string(),
            trend.p_value.to_string(),
            trend.q_value.to_string(),
            trend.found.to_string(),
            optional(trend.stands_out),
            trend.since.clone().unwrap_or_default(),
            trend.level.to_string(),
            trend.starts.to_string(),
            trend.runs.to_string(),
            trend.days.to_string(),
            trend.is_step.to_string(),
            step.and_then(|step| step.after.clone()).unwrap_or_default(),
            step.and_then(|step| step.by.clone()).unwrap_or_default(),
            optional(step.map(|step| step.change)),
            optional(step.map(|step| step.interval_95[0])),
            optional(step.map(|step| step.interval_95[1])),
            optional(step.map(|step| step.q_value)),
            trend.direction.map_or_else(String::new, |direction| direction.to_string()),
        ]
    });
    csv(headings, rows)
}

pub(crate) fn effect_csv(effect: &Effect) -> String {
    let headings = [
        "machine", "at", "joint", "metric", "unit", "before", "change", "change_low", "change_high",
        "usual_change", "rank", "machines", "p_value", "q_value", "found", "starts",
    ];
    let rows = effect.effects.iter().map(|one| {
        vec![
            effect.machine.clone(),
            effect.at.clone(),
            one.joint.clone(),
            key(one.metric),
            one.unit.clone(),
            one.before.to_string(),
            one.change.to_string(),
            one.interval_95[0].to_string(),
            one.interval_95[1].to_string(),
            optional(one.usual_change),
            one.rank.to_string(),
            one.of.to_string(),
            one.p_value.to_string(),
            one.q_value.to_string(),
            one.found.to_string(),
            one.starts.to_string(),
        ]
    });
    csv(headings, rows)
}
