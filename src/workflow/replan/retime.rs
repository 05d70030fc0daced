//! A timing of the key points with less start error: NSGA-III-FO on the objectives of a plan and the predicted peak
//! errors of all starts and reversals together.

use std::ops::ControlFlow;

use crate::{
    fit::{Fit, Model, STEP_S, StartErrorPredictor},
    moea,
    plan::{Evaluator, Machine, PlanError, Search, Setup, Timing, TimingProblem, search},
    spline::{Motion, Quantity, Samples},
    task::{Ceilings, Objective, Objectives},
};

/// Share of the evaluations that predict errors too; each takes as long as a hundred others.
const PREDICTED: f64 = 0.15;

/// Plans kept of the second search.
const KEPT: usize = 200;

/// Result of a search for timings.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Timings {
    /// Least predicted start error first; empty if no plan keeps the limits.
    pub front: Vec<Timing>,
    /// Evaluations made.
    pub evaluations: u64,
}

/// Searches plans that keep their limits and, of time, jerk and power, what `ceilings` say.
///
/// `start` is a timing to begin with, such as that of the last run.
///
/// # Errors
///
/// [`PlanError`] for settings that no search has.
pub(super) fn retimed(
    setup: &Setup,
    fit: &Fit,
    start: Option<&[f64]>,
    ceilings: Ceilings,
    (evaluations, seed): (u64, u64),
    mut observer: impl FnMut(u64) -> ControlFlow<()>,
) -> Result<Timings, PlanError> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of a budget")]
    let second = (evaluations as f64 * PREDICTED) as u64;
    let first = Search { budget: moea::Budget::Evaluations(evaluations - second), seed, ..Search::default() };
    let found = search(setup, &first, |progress| observer(progress.evaluations))?;
    let mut initial: Vec<Vec<f64>> = start.map(<[f64]>::to_vec).into_iter().collect();
    let within = found.front.iter().filter(|timing| timing.objectives.within(&ceilings));
    let within: Vec<Vec<f64>> = within.map(|timing| timing.interval_s.clone()).collect();
    let step = (within.len() / (KEPT / 4)).max(1);
    initial.extend(within.into_iter().step_by(step));
    let problem = TimingProblem::on(setup, FittedMachine::of(setup, fit), ceilings);
    let settings = moea::Settings {
        budget: moea::Budget::Evaluations(second),
        archive: KEPT,
        seed,
        initial,
        ..moea::Settings::default()
    };
    let outcome =
        moea::optimise(&problem, &settings, |progress| observer(found.evaluations + progress.evaluations))?;
    let kept = outcome.archive.unwrap_or(outcome.population);
    let mut evaluator = Evaluator::new(setup);
    let mut front: Vec<Timing> = (0..kept.len())
        .filter(|&i| kept.is_feasible(i) && setup.keeps(kept.x(i), &mut evaluator))
        .map(|i| Timing {
            interval_s: kept.x(i).to_vec(),
            objectives: Objectives::from_slice(kept.f(i)),
            violation: kept.violation(i),
        })
        .collect();
    let error_rad = |timing: &Timing| timing.objectives[Objective::StartError];
    front.sort_by(|a, b| error_rad(a).total_cmp(&error_rad(b)));
    Ok(Timings { front, evaluations: found.evaluations + outcome.evaluations })
}

/// The joints of a setup as a fit knows them.
struct FittedMachine {
    /// By joint of the setup; none of one that was not fitted.
    models: Vec<Option<Model>>,
}

impl FittedMachine {
    fn of(setup: &Setup, fit: &Fit) -> Self {
        let model = |name: &String| fit.joint(name).map(|joint| joint.model);
        Self { models: setup.joint_names().iter().map(model).collect() }
    }
}

/// Memory of one thread.
#[derive(Default)]
struct Memory {
    samples: Samples,
    t_s: Vec<f64>,
    planned: Vec<(f64, f64)>,
    predictor: StartErrorPredictor,
}

/// Until the joints have settled, s.
const SETTLED_S: f64 = 2.0;

impl Machine for FittedMachine {
    type Memory = Memory;

    fn start_error_rad(&self, motion: &Motion, memory: &mut Memory) -> f64 {
        let Memory { samples, t_s, planned, predictor } = memory;
        let end_s = motion.duration_s() + SETTLED_S;
        t_s.clear();
        t_s.extend((0_u32..).map(|k| f64::from(k) * STEP_S).take_while(|t_s| *t_s < end_s));
        motion.sample(t_s, Quantity::Velocity, samples);
        let mut sum_rad = 0.0;
        for (joint, model) in self.models.iter().enumerate() {
            let Some(model) = model else { continue };
            let position = samples.of(Quantity::Position, joint);
            let speed = samples.of(Quantity::Velocity, joint);
            planned.clear();
            planned.extend(position.iter().copied().zip(speed.iter().copied()));
            sum_rad += predictor.starts(model, planned).iter().map(|start| start.peak_error_rad).sum::<f64>();
        }
        sum_rad
    }
}
