//! Plans as one JSON document.

use serde::Serialize;

use crate::{
    document,
    plan::{Margin, Objectives, PlanEvaluation, Rule},
    remark::Remark,
    workflow::plan::{Options, Planned, Step},
};

/// Plans of a task. Angles are radians, times seconds, f1 is the duration, f2 the root mean square
/// jerk and f3 the root mean square power, both summed over joints.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(super) struct Document<'a> {
    /// Always "hydrotrace.plan.v1".
    format: &'static str,
    /// Name and version of the program that wrote it.
    program: &'static str,
    /// Title of the task.
    title: &'a str,
    /// Names of the joints, base first.
    joints: &'a [String],
    /// Whether a plan keeps all limits and ceilings; if not, the exit code is 1.
    feasible: bool,
    /// Evolutionary algorithm; null where a plan was only evaluated.
    algorithm: Option<&'a str>,
    /// Whether the search started from descents.
    seeded: Option<bool>,
    /// Seed of the random numbers.
    seed: Option<u64>,
    /// Evaluations made.
    evaluations: u64,
    /// Generations of the evolution.
    generations: Option<u64>,
    /// Whether more evaluations would find a faster plan than the fastest; null without descents.
    hasty: Option<bool>,
    /// Share of the box between the best of each objective and 1.1 times the front's range that the
    /// front dominates.
    hypervolume: Option<f64>,
    /// The same on the way, in the box of the final front; left out where nothing was searched.
    #[serde(skip_serializing_if = "Option::is_none")]
    convergence: Option<&'a [Step]>,
    /// Plans of which none is better than another in everything, fastest first.
    front: Vec<Entry<'a>>,
    /// Indices into the front of the fastest plan (A), the smoothest (B), that of least power (C).
    best: Option<[usize; 3]>,
    /// The plan to run; of an infeasible task the nearest to being one.
    chosen: Whole<'a>,
    /// Doubts about the task; any makes the exit code 3.
    remarks: &'a [Remark],
}

/// One plan.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Entry<'a> {
    /// Arrival at each key point, s, dwells counted.
    times_s: &'a [f64],
    /// f1, s.
    duration_s: f64,
    /// f2, rad/s³.
    rms_jerk_rad_s3: f64,
    /// f3, W.
    rms_power_w: f64,
    /// Sum of what it exceeds limits by, as shares of them.
    violation: f64,
}

/// One plan with all that can be said of it.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Whole<'a> {
    #[serde(flatten)]
    entry: Entry<'a>,
    /// How it was chosen; null where it was given.
    rule: Option<Rule>,
    /// Weights of f1, f2 and f3, where the rule is by weights.
    weights: Option<[f64; 3]>,
    /// Plans of the front that keep to the ceilings.
    within_ceilings: Option<usize>,
    /// Root mean square jerk by joint, rad/s³.
    joint_rms_jerk_rad_s3: &'a [f64],
    /// Root mean square power by joint, W.
    joint_rms_power_w: &'a [f64],
    /// Work that the joints do and take up, J.
    energy_j: f64,
    /// Every limit, and where the plan comes nearest to it.
    margins: Vec<Nearest<'a>>,
}

/// A limit and where a plan comes nearest to it.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Nearest<'a> {
    /// The quantity.
    limit: String,
    /// The joint; null for a limit of the arm as a whole.
    joint: Option<&'a str>,
    /// Its value there: rad, rad/s, rad/s², rad/s³, N m, m/s, N or m³/s.
    value: f64,
    /// What is allowed in that direction.
    allowed: f64,
    /// Share of what is allowed; above 1 the limit is broken.
    share: f64,
    /// When, s.
    t_s: f64,
}

fn entry(times_s: &[f64], objectives: Objectives, violation: f64) -> Entry<'_> {
    let Objectives { duration_s, rms_jerk_rad_s3, rms_power_w } = objectives;
    Entry { times_s, duration_s, rms_jerk_rad_s3, rms_power_w, violation }
}

fn whole<'a>(evaluation: &'a PlanEvaluation, joints: &'a [String]) -> Whole<'a> {
    let nearest = |margin: &Margin| Nearest {
        limit: super::name(margin.limit).replace(' ', "_"),
        joint: margin.joint.and_then(|joint| joints.get(joint)).map(String::as_str),
        value: margin.value,
        allowed: margin.allowed,
        share: margin.share,
        t_s: margin.t_s,
    };
    Whole {
        entry: entry(&evaluation.times_s, evaluation.objectives, evaluation.violation),
        rule: None,
        weights: None,
        within_ceilings: None,
        joint_rms_jerk_rad_s3: &evaluation.rms_jerk_rad_s3,
        joint_rms_power_w: &evaluation.rms_power_w,
        energy_j: evaluation.energy_j,
        margins: evaluation.margins.iter().map(nearest).collect(),
    }
}

/// What was planned, as JSON.
pub fn plan_json(title: &str, algorithm: &str, options: &Options, planned: &Planned) -> String {
    let plans = planned.front.iter().zip(&planned.times_s);
    let choice = &planned.choice;
    document::pretty(&Document {
        format: "hydrotrace.plan.v1",
        program: document::PROGRAM,
        title,
        joints: &planned.joints,
        feasible: true,
        algorithm: Some(algorithm),
        seeded: Some(options.search.seeded),
        seed: Some(options.search.seed),
        evaluations: planned.evaluations,
        generations: Some(planned.generations),
        hasty: planned.fastest_converged.map(|converged| !converged),
        hypervolume: Some(planned.hypervolume),
        convergence: Some(&planned.convergence),
        front: plans.map(|(plan, times_s)| entry(times_s, plan.objectives, plan.violation)).collect(),
        best: Some(planned.ends),
        chosen: Whole {
            rule: Some(choice.rule),
            weights: choice.weights.map(|w| [w.duration, w.rms_jerk, w.rms_power]),
            within_ceilings: Some(choice.within),
            ..whole(&planned.chosen, &planned.joints)
        },
        remarks: planned.remarks.as_slice(),
    })
}

/// One plan that was given, or the nearest to one of an infeasible task, as JSON.
pub fn judged_json(title: &str, joints: &[String], evaluation: &PlanEvaluation, feasible: bool) -> String {
    document::pretty(&Document {
        format: "hydrotrace.plan.v1",
        program: document::PROGRAM,
        title,
        joints,
        feasible,
        algorithm: None,
        seeded: None,
        seed: None,
        evaluations: 1,
        generations: None,
        hasty: None,
        hypervolume: None,
        convergence: None,
        front: if feasible {
            vec![entry(&evaluation.times_s, evaluation.objectives, evaluation.violation)]
        } else {
            Vec::new()
        },
        best: None,
        chosen: whole(evaluation, joints),
        remarks: &[],
    })
}

#[cfg(test)]
mod tests {
    use super::Document;

    #[test]
    fn the_committed_schema_is_that_of_the_plan() {
        crate::schema::is_committed::<Document<'_>>("plan.v1.schema.json", "hydrotrace plan, version 1");
    }
}
