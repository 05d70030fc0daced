//! `plan`: from a task to a front of plans and the one to run.

use std::ops::ControlFlow;

mod convergence;
mod course;
mod degrees;
mod document;
mod doubts;
mod failure;
mod request;
mod shaped;

use crate::{
    plan::{
        Choice, NoShape, PlanEvaluation, Progress, Reference, Rule, Search, Timing, bought, ends, near,
        search,
    },
    remark::Remarks,
    task::{Ceilings, Objective, Objectives, Task, Weights},
};
use convergence::Growth;
pub use convergence::Step;
pub use course::Course;
pub use degrees::OfDegree;
use degrees::degrees;
pub use document::{ChosenPlan, MarginEntry, PlanDocument, PlanEntry};
pub use failure::PlanFailure;
pub use request::{PlanRequest, SAMPLE_TASK, TaskFiles};
use shaped::{Made, chosen, without_front};
pub use shaped::{Shaped, Shaping};

/// How to plan.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Options {
    /// How to search.
    pub search: Search,
    /// How to choose; by default the task's weights, or the plan nearest to the ideal.
    pub rule: Option<Rule>,
    /// Weights in place of the task's.
    pub weights: Option<Weights>,
    /// What is sought beside the times.
    pub shape: Shaping,
    /// Where the front is to be exact too: around that time, s.
    pub near_s: Option<f64>,
    /// Whether splines of the other degrees are tried too.
    pub degrees: bool,
}

/// Findings of `plan`.
#[derive(Debug, Clone, PartialEq)]
pub struct Planned {
    /// Names of the joints, base first.
    pub joints: Vec<String>,
    /// Plans on the Pareto front, fastest first; none where only a free shape keeps all limits.
    pub front: Vec<Timing>,
    /// Their arrivals at the key points, s.
    pub times_s: Vec<Vec<f64>>,
    /// Indices of the plan that is best in each objective: A, B and C.
    pub ends: Vec<usize>,
    /// A, B and C, evaluated.
    pub best: Vec<PlanEvaluation>,
    /// The plan to run.
    pub chosen: PlanEvaluation,
    /// Why it.
    pub choice: Choice,
    /// By what share 1 % more time would lessen each other objective of it, by times alone.
    pub bought: Vec<(Objective, f64)>,
    /// The smoothest plans within round times around the one asked for, with these times, s.
    pub near: Vec<(f64, PlanEvaluation)>,
    /// Shortest and longest interval between key points that the task allows, s.
    pub interval_s: [f64; 2],
    /// Degree of the task's splines.
    pub degree: u8,
    /// Plans by splines of the other degrees, where they were asked for.
    pub degrees: Vec<OfDegree>,
    /// What its free shape gained, if one was sought and found.
    pub shaped: Option<Shaped>,
    /// Why it has none, where one was sought.
    pub no_shape: Option<NoShape>,
    /// Evaluations made, those of the choice too.
    pub evaluations: u64,
    /// Generations of the evolution.
    pub generations: u64,
    /// Whether the descent to the fastest plan ended because nothing was left to gain; `None` without descents.
    pub fastest_converged: Option<bool>,
    /// Share of the box between the best of each objective and `BEYOND` times the range of the front
    /// that the front dominates.
    pub hypervolume: f64,
    /// The same on the way, in the box of the final front.
    pub convergence: Vec<Step>,
    /// Doubts about the task.
    pub remarks: Remarks,
}

/// A chosen plan that is so much faster than all of the front, as a share, is the fastest of it.
const FASTER: f64 = 0.005;

/// Puts a chosen plan before a front that it is clearly faster than, in place of those that it is better than in everything.
fn ahead(front: &mut Vec<Timing>, chosen: &Timing) {
    let took_s = |timing: &Timing| timing.objectives[Objective::Duration];
    if chosen.violation > 0.0
        || front.first().is_none_or(|first| took_s(chosen) >= (1.0 - FASTER) * took_s(first))
    {
        return;
    }
    front.retain(|timing| !chosen.objectives.within(&timing.objectives));
    front.insert(0, chosen.clone());
}

/// Searches and chooses.
///
/// # Errors
///
/// [`PlanFailure`] if no plan keeps all limits, or none the ceilings, with what comes nearest.
///
/// ```
/// use std::{ops::ControlFlow, path::Path};
/// use hydrotrace::workflow::plan::{Options, PlanRequest, run};
///
/// let request = PlanRequest::read(Path::new("sample-logs/tasks/task-1.toml"))?;
/// let mut options = Options::default();
/// options.search.budget = hydrotrace::moea::Budget::Evaluations(500);
/// let planned = run(&request, &options, |_| ControlFlow::Continue(()))?;
/// assert!(planned.chosen.margins.iter().all(|margin| margin.share < 1.0 + 1e-6));
/// # Ok::<(), hydrotrace::workflow::plan::PlanFailure>(())
/// ```
pub fn run(
    request: &PlanRequest,
    options: &Options,
    mut observer: impl FnMut(&Progress<'_>) -> ControlFlow<()>,
) -> Result<Planned, PlanFailure> {
    let PlanRequest { task, setup, .. } = request;
    let mut growth = Growth::default();
    let mut found = search(setup, &options.search, |progress| {
        growth.see(progress);
        let (phase, evaluations) = (progress.phase, progress.evaluations);
        ::log::debug!("{phase:?}: generation {}, {evaluations} evaluations", progress.generation);
        observer(progress)
    })?;
    ::log::info!(
        "{} plans found in {} evaluations, {} generations",
        found.front.len(),
        found.evaluations,
        found.generations
    );
    let evaluation = |timing: &Timing| PlanEvaluation::of(setup, &setup.times_s(&timing.interval_s));
    let weights = options.weights.or(task.weights);
    let rule = options.rule.unwrap_or(if weights.is_some() { Rule::Weights } else { Rule::Ideal });
    let (choice, own) = if found.front.is_empty() {
        without_front(request, found.nearest, options.shape)?
    } else {
        chosen(setup, task, options.shape, (&found.front, (rule, weights)))?
    };
    ahead(&mut found.front, &choice.timing);
    let ends = ends(&found.front).unwrap_or_default();
    let mut remarks = request.of_key_points();
    let fastest_s = found.front.first().map(|timing| timing.objectives[Objective::Duration]);
    if let Some(fastest_s) = fastest_s.filter(|_| own.shaped.is_none()) {
        remarks.extend(request.slower_than_stops(fastest_s));
    }
    let objectives = || found.front.iter().map(|timing| timing.objectives.plan());
    let largest = |k| found.front.iter().map(|timing| timing.objectives[k]).fold(0.0, f64::max);
    task.ceilings.remark_inactive(&Objectives::ZERO.map_plan(largest), &mut remarks);
    let reference = Reference::of(objectives());
    let hypervolume = reference.measure(objectives());
    let best = ends.iter().map(|&end| evaluation(&found.front[end])).collect::<Result<_, _>>()?;
    // A free shape may be faster than any plan of the front.
    let smoothest = |held: &Ceilings| {
        let task = Task { ceilings: *held, ..task.clone() };
        let by = (&*found.front, (Rule::Best(Objective::RmsJerk), None));
        // A free shape that was found can be slower, whatever a descent from other times comes to.
        let slower = || {
            let more_s = held[Objective::Duration] - own.plan.objectives[Objective::Duration];
            let by = 1.0 + more_s / own.plan.moving_s(setup);
            let plan = own.plan.paced(setup, by).filter(|_| own.shaped.is_some() && by >= 1.0)?;
            (plan.broken().is_empty() && plan.objectives.within(held)).then_some(plan)
        };
        let found = chosen(setup, &task, options.shape, by).ok().map(|found| found.1.plan);
        let jerk = |plan: &PlanEvaluation| plan.objectives[Objective::RmsJerk];
        found.into_iter().chain(slower()).min_by(|a, b| jerk(a).total_cmp(&jerk(b)))
    };
    let took_s = |plan: &PlanEvaluation| plan.objectives[Objective::Duration];
    let near = options.near_s.map(|near_s| near(&task.ceilings, near_s, smoothest, took_s));
    let Made { plan: chosen, shaped, no_shape } = own;
    remarks.extend(request.doubts(&chosen)?);
    let of_degrees = if options.degrees { degrees(request, options, (&choice, &chosen)) } else { Vec::new() };
    Ok(Planned {
        degree: task.degree,
        degrees: of_degrees,
        joints: setup.joint_names(),
        times_s: found.front.iter().map(|timing| setup.times_s(&timing.interval_s)).collect(),
        ends,
        best,
        chosen,
        no_shape,
        evaluations: found.evaluations + choice.evaluations,
        generations: found.generations,
        fastest_converged: found.fastest_converged,
        hypervolume,
        bought: if shaped.is_none() { bought(setup, &choice.timing) } else { Vec::new() },
        shaped,
        near: near.unwrap_or_default(),
        interval_s: task.interval_s,
        convergence: growth.steps(reference, found.evaluations, hypervolume),
        choice,
        front: found.front,
        remarks,
    })
}
