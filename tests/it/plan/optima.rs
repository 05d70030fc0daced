//! Plans and the search for them against optima found with SciPy and Pinocchio.
//!
//! `tests/reference/plan-optima.json` is written by `plan_optima.py` beside it.

use std::{collections::BTreeMap, ops::ControlFlow, path::Path};

use hydrotrace::{
    arm::Arm,
    moea::Budget,
    plan::{Evaluator, Search, Setup, ends, search},
    task::{Objective, Task},
};
use serde::Deserialize;

#[derive(Deserialize)]
struct Plan {
    times_s: Vec<f64>,
    duration_s: f64,
    rms_jerk_rad_s3: f64,
    rms_power_w: f64,
    /// Largest share of every limit, over all joints.
    peak_share: BTreeMap<String, f64>,
    /// Another dwell than the task's.
    dwell_s: Option<f64>,
}

impl Plan {
    fn objectives(&self) -> [f64; 3] {
        [self.duration_s, self.rms_jerk_rad_s3, self.rms_power_w]
    }

    fn feasible(&self) -> bool {
        self.peak_share.values().all(|share| *share < 1.0 + 1e-5)
    }
}

#[derive(Deserialize)]
struct Independent {
    printed: BTreeMap<String, Plan>,
    optima: BTreeMap<String, Plan>,
    between: Vec<Plan>,
}

impl Independent {
    /// Plans that are the best of their kind.
    fn best(&self) -> impl Iterator<Item = &Plan> {
        self.optima.values().chain(&self.between)
    }

    fn end(&self, name: &str) -> [f64; 3] {
        self.optima[name].objectives()
    }
}

fn folder() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn reference() -> BTreeMap<String, Independent> {
    let text = std::fs::read_to_string(folder().join("tests/reference/plan-optima.json")).unwrap();
    let tasks: BTreeMap<String, Independent> = serde_json::from_str(&text).unwrap();
    assert_eq!(tasks.len(), 3);
    tasks
}

fn setup(task: &str, dwell_s: Option<f64>) -> Setup {
    let path = folder().join("sample-logs/tasks").join(format!("{task}.toml"));
    let mut task = Task::read(&path).unwrap();
    for dwell in task.points.iter_mut().filter_map(|point| point.dwell_s.as_mut()) {
        *dwell = dwell_s.unwrap_or(*dwell);
    }
    Setup::new(&task, Arm::sample().unwrap()).unwrap()
}

fn off(found: f64, expected: f64) -> f64 {
    (found - expected).abs() / expected
}

#[test]
fn plans_have_the_objectives_and_peaks_that_scipy_and_pinocchio_find() {
    for (task, optima) in reference() {
        for plan in optima.best().chain(optima.printed.values()) {
            let setup = setup(&task, plan.dwell_s);
            let mut evaluator = Evaluator::new(&setup);
            let interval_s = setup.intervals_s(&plan.times_s).unwrap();
            let found = evaluator.evaluate(&setup, &interval_s).unwrap();
            assert!(off(found[Objective::Duration], plan.duration_s) < 1e-12);
            assert!(off(found[Objective::RmsJerk], plan.rms_jerk_rad_s3) < 1e-9, "{task} {:?}", plan.times_s);
            // Eight nodes a piece integrate the power of a plan that swings far out only roughly.
            let power = if plan.feasible() { 1e-6 } else { 5e-4 };
            let found = off(found[Objective::RmsPower], plan.rms_power_w);
            assert!(found < power, "{task} {:?}: {found:.1e}", plan.times_s);
            if plan.feasible() {
                let violation = evaluator.violation();
                assert!(violation < 1e-3, "{task} {:?}: {violation:.1e}", plan.times_s);
            }
            let mut most: BTreeMap<String, f64> = BTreeMap::new();
            for margin in setup.margins(&setup.motion(&plan.times_s).unwrap(), &mut evaluator) {
                let name = serde_json::to_value(margin.limit).unwrap().as_str().unwrap().to_owned();
                let share = most.entry(name).or_default();
                *share = share.max(margin.share);
            }
            assert_eq!(most.len(), plan.peak_share.len());
            // Beyond a dead centre a cylinder's share has a pole; nothing can be said of its peak.
            for (limit, expected) in plan.peak_share.iter().filter(|(_, share)| **share < 2.0) {
                let found = off(most[limit], *expected);
                assert!(found < 1e-5, "{task} {:?} {limit}: {found:.1e}", plan.times_s);
            }
        }
    }
}

#[test]
fn a_search_of_20000_evaluations_reaches_the_independent_optima() {
    for (task, optima) in reference() {
        let settings = Search { budget: Budget::Evaluations(20_000), ..Search::default() };
        let found = search(&setup(&task, None), &settings, |_| ControlFlow::Continue(())).unwrap();
        let front: Vec<&[f64]> = found.front.iter().map(|plan| plan.objectives.plan()).collect();
        let best = ends(&found.front).unwrap();
        for (k, name) in ["fastest", "smoothest", "thriftiest"].into_iter().enumerate() {
            let ratio = front[best[k]][k] / optima.end(name)[k];
            assert!((0.995..1.005).contains(&ratio), "{task}: the {name} is {ratio} times the optimum");
        }
        for plan in optima.best() {
            let theirs = plan.objectives();
            let mut nearest = f64::INFINITY;
            for ours in &front {
                let dominates = (0..3).all(|k| theirs[k] <= ours[k]);
                let gain = (0..3).map(|k| 1.0 - theirs[k] / ours[k]).fold(0.0, f64::max);
                assert!(!dominates || gain < 0.01, "{task}: {ours:?} is dominated by {theirs:?}");
                nearest = nearest.min((0..3).map(|k| ours[k] / theirs[k]).fold(0.0, f64::max));
            }
            // 600 plans lie about so far apart.
            assert!(nearest < 1.07, "{task}: nothing comes nearer to {theirs:?} than {nearest} times");
        }
    }
}
