//! The document of a plan: what `plan` and `replan` say, what their logs carry, what pages and viewer show of a log.

use std::collections::BTreeMap;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{OfDegree, Options, Planned, Step};
use crate::{
    document::{PROGRAM, pretty, unbounded},
    plan::{Limit, Margin, PlanEvaluation, Rule, Via},
    remark::Remark,
    series::JointKind,
    task::{Objective, Objectives},
};

const FORMAT: &str = "hydrotrace.plan.v1";

/// Plans of a task. Angles are radians, positions of joints that slide metres, times seconds, f1 is the duration, f2 the root mean square
/// jerk and f3 the root mean square power, both summed over joints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PlanDocument {
    /// Always "hydrotrace.plan.v1".
    pub format: String,
    /// Name and version of the program that wrote it.
    #[serde(default)]
    pub program: String,
    /// Title of the task.
    pub title: String,
    /// Names of the joints, base first.
    #[serde(default)]
    pub joints: Vec<String>,
    /// Those of them that slide: of these read m for rad, N for N m; left out where all turn.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sliding_joints: Vec<String>,
    /// Whether the chosen plan keeps all limits and ceilings.
    #[serde(default)]
    pub feasible: bool,
    /// Evolutionary algorithm; null where a plan was only evaluated.
    pub algorithm: Option<String>,
    /// Whether the search started from descents.
    pub seeded: Option<bool>,
    /// Seed of the random numbers.
    pub seed: Option<u64>,
    /// Evaluations made.
    #[serde(default)]
    pub evaluations: u64,
    /// Generations of the evolution.
    pub generations: Option<u64>,
    /// Whether more evaluations would find a faster plan than the fastest; null without descents.
    #[serde(rename = "hasty", default, with = "inverted")]
    #[cfg_attr(test, schemars(with = "Option<bool>"))]
    pub fastest_converged: Option<bool>,
    /// Share of the box between the best of each objective and 1.1 times the front's range that the
    /// front dominates.
    pub hypervolume: Option<f64>,
    /// The same on the way, in the box of the final front; left out where nothing was searched.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub convergence: Vec<Step>,
    /// Plans on the Pareto front, fastest first.
    pub front: Vec<PlanEntry>,
    /// Indices into the front of the plan that is best in each objective: A, B, C.
    pub best: Option<Vec<usize>>,
    /// The smoothest plans within round times, exact, where they were asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub near: Vec<PlanEntry>,
    /// Plans by splines of other degrees, chosen by the same rule, where they were asked for; a degree without a plan is
    /// left out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub degrees: Vec<DegreeEntry>,
    /// The plan to run; of an infeasible task the nearest to being one.
    pub chosen: ChosenPlan,
    /// Doubts about the task; any makes the exit code 3.
    #[serde(default)]
    pub remarks: Vec<Remark>,
}

/// A plan by a spline of another degree than the task's.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct DegreeEntry {
    /// Degree of the spline: 5, 6 or 7.
    pub degree: u8,
    /// By what share it is better than the chosen plan by the rule; negative if it is worse.
    pub better_by_rule: f64,
    /// The plan.
    #[serde(flatten)]
    pub plan: PlanEntry,
}

/// One plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PlanEntry {
    /// Arrival at each key point, s, dwells counted.
    #[serde(default)]
    pub times_s: Vec<f64>,
    /// Free points that it passes between the key points and that give it its shape; left out of a timing alone. Key
    /// points and these are the points of the spline, whose knots and control points follow from them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub via: Vec<Via>,
    /// Its objectives.
    #[serde(flatten)]
    pub objectives: Objectives,
    /// Sum of what it exceeds limits by, as shares of them.
    #[serde(default)]
    pub violation: f64,
}

/// The plan to run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ChosenPlan {
    /// The plan.
    #[serde(flatten)]
    pub entry: PlanEntry,
    /// How it was chosen; null where it was given.
    #[cfg_attr(test, schemars(with = "Option<String>"))]
    pub rule: Option<Rule>,
    /// Weights of f1, f2 and f3, where the rule is by weights.
    pub weights: Option<Vec<f64>>,
    /// Plans of the front that keep to the ceilings.
    pub within_ceilings: Option<usize>,
    /// The longest time considered, s: twice the fastest plan's, where neither rule nor ceilings say one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub horizon_s: Option<f64>,
    /// By what share 1 % more time would lessen each other objective, by times alone; empty where it was given.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub bought_by_1_percent_of_time: BTreeMap<String, f64>,
    /// The plan of the same rule by times alone; left out where the shape is not free, or no times alone keep all limits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub timing_alone: Option<PlanEntry>,
    /// Root mean square jerk by joint, rad/s³; m/s³ of a joint that slides.
    #[serde(default)]
    pub joint_rms_jerk_rad_s3: Vec<f64>,
    /// Root mean square power by joint, W.
    #[serde(default)]
    pub joint_rms_power_w: Vec<f64>,
    /// Work that the joints do and take up, J.
    #[serde(default)]
    pub energy_j: f64,
    /// Every limit, and where the plan comes nearest to it.
    #[serde(default)]
    pub margins: Vec<MarginEntry>,
}

/// A limit and where a plan or a command comes nearest to it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct MarginEntry {
    /// The quantity.
    pub limit: Limit,
    /// The joint; null for a limit of the arm as a whole.
    pub joint: Option<String>,
    /// How the joint moves; left out if it turns, or of the arm as a whole.
    #[serde(default, skip_serializing_if = "JointKind::turns")]
    pub kind: JointKind,
    /// Its value there: rad, rad/s, rad/s², rad/s³, N m, m/s, N or m³/s, of a joint that slides m for rad and N for N m; null where it has no bound.
    #[serde(with = "unbounded")]
    #[cfg_attr(test, schemars(with = "Option<f64>"))]
    pub value: f64,
    /// Largest value allowed in that direction.
    pub allowed: f64,
    /// Share of what is allowed; above 1 the limit is broken; null where it has no bound.
    #[serde(with = "unbounded")]
    #[cfg_attr(test, schemars(with = "Option<f64>"))]
    pub share: f64,
    /// When, s.
    pub t_s: f64,
}

impl MarginEntry {
    /// Margins of an arm with these joints, base first.
    pub fn all(margins: &[Margin], joints: &[String]) -> Vec<Self> {
        let one = |margin: &Margin| Self {
            limit: margin.limit,
            joint: margin.joint.and_then(|joint| joints.get(joint)).cloned(),
            kind: margin.kind,
            value: margin.value,
            allowed: margin.allowed,
            share: margin.share,
            t_s: margin.t_s,
        };
        margins.iter().map(one).collect()
    }
}

impl PlanEntry {
    fn of(evaluation: &PlanEvaluation) -> Self {
        Self {
            times_s: evaluation.times_s.clone(),
            via: evaluation.via.clone(),
            objectives: evaluation.objectives,
            violation: evaluation.violation,
        }
    }
}

impl DegreeEntry {
    fn of(found: &OfDegree) -> Option<Self> {
        let (plan, better) = found.chosen.as_ref()?;
        Some(Self { degree: found.degree, better_by_rule: *better, plan: PlanEntry::of(plan) })
    }
}

impl PlanDocument {
    /// Of one plan that was given, or of the nearest to one of an infeasible task.
    pub fn evaluated(title: &str, joints: &[String], evaluation: &PlanEvaluation, feasible: bool) -> Self {
        let entry = PlanEntry::of(evaluation);
        let kinds = joints.iter().zip(&evaluation.joint_kinds);
        let sliding = kinds.filter(|(_, kind)| **kind == JointKind::Slides);
        Self {
            format: FORMAT.to_owned(),
            program: PROGRAM.to_owned(),
            title: title.to_owned(),
            joints: joints.to_vec(),
            sliding_joints: sliding.map(|(joint, _)| joint.clone()).collect(),
            feasible,
            algorithm: None,
            seeded: None,
            seed: None,
            evaluations: 1,
            generations: None,
            fastest_converged: None,
            hypervolume: None,
            convergence: Vec::new(),
            front: if feasible { vec![entry.clone()] } else { Vec::new() },
            best: None,
            near: Vec::new(),
            degrees: Vec::new(),
            chosen: ChosenPlan {
                entry,
                rule: None,
                weights: None,
                within_ceilings: None,
                horizon_s: None,
                bought_by_1_percent_of_time: BTreeMap::new(),
                timing_alone: None,
                joint_rms_jerk_rad_s3: evaluation.rms_jerk_rad_s3.clone(),
                joint_rms_power_w: evaluation.rms_power_w.clone(),
                energy_j: evaluation.energy_j,
                margins: MarginEntry::all(&evaluation.margins, joints),
            },
            remarks: Vec::new(),
        }
    }

    /// Of a search.
    pub fn searched(title: &str, algorithm: &str, options: &Options, planned: &Planned) -> Self {
        let choice = &planned.choice;
        let alone = Self::evaluated(title, &planned.joints, &planned.chosen, true);
        let plans = planned.front.iter().zip(&planned.times_s);
        let bought = planned.bought.iter().map(|(k, share)| (k.row().key.to_owned(), *share));
        let entry = |(plan, times_s): (&crate::plan::Timing, &Vec<f64>)| PlanEntry {
            times_s: times_s.clone(),
            via: Vec::new(),
            objectives: plan.objectives,
            violation: plan.violation,
        };
        Self {
            algorithm: Some(algorithm.to_owned()),
            seeded: Some(options.search.seeded),
            seed: Some(options.search.seed),
            evaluations: planned.evaluations,
            generations: Some(planned.generations),
            fastest_converged: planned.fastest_converged,
            hypervolume: Some(planned.hypervolume),
            convergence: planned.convergence.clone(),
            front: plans.map(entry).collect(),
            best: Some(planned.ends.clone()),
            near: planned.near.iter().map(|(_, plan)| PlanEntry::of(plan)).collect(),
            degrees: planned.degrees.iter().filter_map(DegreeEntry::of).collect(),
            chosen: ChosenPlan {
                rule: Some(choice.rule),
                weights: choice.weights.map(|weights| weights.plan().to_vec()),
                within_ceilings: Some(choice.within),
                horizon_s: choice.horizon_s,
                bought_by_1_percent_of_time: bought.collect(),
                timing_alone: planned
                    .shaped
                    .as_ref()
                    .and_then(|shaped| shaped.timing.as_ref())
                    .map(PlanEntry::of),
                ..alone.chosen
            },
            remarks: planned.remarks.as_slice().to_vec(),
            ..alone
        }
    }

    /// The document as text.
    pub fn json(&self) -> String {
        pretty(self)
    }

    /// Reads a document; `None` if it is not one of ours.
    ///
    /// # Errors
    ///
    /// Within, if it is one of ours and broken.
    pub fn read(bytes: &[u8]) -> Option<Result<Self, serde_json::Error>> {
        #[derive(Deserialize)]
        struct Head {
            format: String,
        }
        let head: Head = serde_json::from_slice(bytes).ok()?;
        (head.format == FORMAT).then(|| serde_json::from_slice(bytes))
    }

    /// The best plan in each objective, with its letter.
    pub fn best(&self) -> impl Iterator<Item = (char, &Objectives)> {
        let places = self.best.iter().flatten().zip(Objective::OF_PLAN);
        places
            .filter_map(|(&place, objective)| Some((objective.letter(), &self.front.get(place)?.objectives)))
    }
}

/// The document says whether the fastest plan was still getting faster.
mod inverted {
    use super::{Deserialize, Deserializer, Serialize, Serializer};

    #[expect(clippy::ref_option, clippy::trivially_copy_pass_by_ref, reason = "serde's form")]
    pub(super) fn serialize<S: Serializer>(
        converged: &Option<bool>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        converged.map(|converged| !converged).serialize(serializer)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<bool>, D::Error> {
        Ok(Option::<bool>::deserialize(deserializer)?.map(|hasty| !hasty))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workflow::plan::PlanRequest;

    #[test]
    fn a_document_reads_back_as_it_was_written() {
        let request = PlanRequest::sample().unwrap();
        let evaluation =
            PlanEvaluation::of(&request.setup, &[0.0, 5.31, 11.47, 16.36, 26.27, 38.72]).unwrap();
        let mut written = PlanDocument::evaluated("t", &request.setup.joint_names(), &evaluation, true);
        written.fastest_converged = Some(true);
        written.best = Some(vec![0, 0, 9]);
        let read = PlanDocument::read(written.json().as_bytes()).unwrap().unwrap();
        assert_eq!(read, written);
        assert!(written.json().contains("\"hasty\": false"));
        assert_eq!(read.best().map(|(letter, _)| letter).collect::<Vec<_>>(), ['A', 'B']);
    }

    #[test]
    fn broken_documents_are_told_from_foreign_ones_and_old_ones_may_lack_keys() {
        let plan = r#"{"duration_s": 2, "rms_jerk_rad_s3": 3, "rms_power_w": 4}"#;
        let text = |best: &str| {
            format!(
                r#"{{"format": "{FORMAT}", "title": "t", "front": [{plan}], "best": {best}, "chosen": {plan}}}"#
            )
        };
        let read = |text: &str| PlanDocument::read(text.as_bytes());
        let found = read(&text("[0, 0, 0]")).unwrap().unwrap();
        assert_eq!(found.front[0].objectives.plan(), [2.0, 3.0, 4.0]);
        assert_eq!(found.best().count(), 3);
        assert!(read(&text("\"x\"")).unwrap().is_err());
        assert!(read("{\"plan\": 1}").is_none() && read("no json").is_none());
    }
}
