//! Another timing of the key points that the machine follows better: NSGA-III-FO on time, jerk, power
//! and the predicted error of all starts and reversals together.

use std::ops::ControlFlow;

use crate::{
    fit::{Fit, Model, STEP_S, StartErrorPredictor},
    moea::{self, Bounds, Problem},
    plan::{Evaluator, PlanError, Search, Setup, excess, search},
    spline::{Motion, Quantity, Samples},
};

/// Share of the evaluations that predict errors too; each takes as long as a hundred others.
const PREDICTED: f64 = 0.15;

/// Plans kept of the second search.
const KEPT: usize = 200;

/// A timing and what is expected of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Retimed {
    /// Times of movement between key points, s.
    pub interval_s: Vec<f64>,
    /// Time, s, jerk, rad/s³, power, W, and sum of the modelled peaks of all transitions, rad.
    pub objectives: [f64; 4],
}

/// What a search for timings found.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Timings {
    /// None better than another in everything, easiest to follow first; empty if no plan keeps the
    /// limits.
    pub front: Vec<Retimed>,
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
    ceilings: [f64; 3],
    (evaluations, seed): (u64, u64),
    mut observer: impl FnMut(u64) -> ControlFlow<()>,
) -> Result<Timings, PlanError> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of a budget")]
    let second = (evaluations as f64 * PREDICTED) as u64;
    let first = Search { budget: moea::Budget::Evaluations(evaluations - second), seed, ..Search::default() };
    let found = search(setup, &first, |progress| observer(progress.evaluations))?;
    let fits = |f: &[f64; 3]| f.iter().zip(ceilings).all(|(f, ceiling)| *f <= ceiling);
    let mut initial: Vec<Vec<f64>> = start.map(<[f64]>::to_vec).into_iter().collect();
    let within = found.front.iter().filter(|timing| fits(&timing.objectives.as_array()));
    let within: Vec<Vec<f64>> = within.map(|timing| timing.interval_s.clone()).collect();
    let step = (within.len() / (KEPT / 4)).max(1);
    initial.extend(within.into_iter().step_by(step));
    let problem = Followed::new(setup, fit, ceilings);
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
    let mut front: Vec<Retimed> = (0..kept.len())
        .filter(|&i| kept.is_feasible(i) && setup.keeps(kept.x(i), &mut evaluator))
        .map(|i| {
            let f = kept.f(i);
            Retimed { interval_s: kept.x(i).to_vec(), objectives: [f[0], f[1], f[2], f[3]] }
        })
        .collect();
    front.sort_by(|a, b| a.objectives[3].total_cmp(&b.objectives[3]));
    Ok(Timings { front, evaluations: found.evaluations + outcome.evaluations })
}

/// A setup on its machine.
struct Followed<'a> {
    setup: &'a Setup,
    /// By joint of the setup.
    models: Vec<Option<Model>>,
    template: Motion,
    ceilings: [f64; 3],
}

impl<'a> Followed<'a> {
    fn new(setup: &'a Setup, fit: &Fit, ceilings: [f64; 3]) -> Self {
        let models =
            setup.joint_names().iter().map(|name| fit.joint(name).map(|joint| joint.model)).collect();
        let template = setup.template().clone();
        Self { setup, models, template, ceilings }
    }
}

/// Memory of one thread.
struct Workspace {
    evaluator: Evaluator,
    motion: Motion,
    samples: Samples,
    t_s: Vec<f64>,
    planned: Vec<(f64, f64)>,
    follower: StartErrorPredictor,
}

impl Problem for Followed<'_> {
    type Workspace = Option<Box<Workspace>>;

    fn bounds(&self) -> Vec<Bounds> {
        Problem::bounds(self.setup)
    }

    fn objectives(&self) -> usize {
        4
    }

    fn evaluate(&self, x: &[f64], objectives: &mut [f64], workspace: &mut Self::Workspace) -> f64 {
        let room = workspace.get_or_insert_with(|| {
            Box::new(Workspace {
                evaluator: Evaluator::new(self.setup),
                motion: self.template.clone(),
                samples: Samples::default(),
                t_s: Vec::new(),
                planned: Vec::new(),
                follower: StartErrorPredictor::default(),
            })
        });
        let Some(found) = room.evaluator.evaluate(self.setup, x) else { return f64::INFINITY };
        let costs = found.as_array();
        objectives[..3].copy_from_slice(&costs);
        objectives[3] = 0.0;
        let over: f64 = costs.iter().zip(self.ceilings).map(|(f, ceiling)| excess(f / ceiling)).sum();
        let violation = room.evaluator.violation() + over;
        // Of a plan that cannot be run nothing is predicted.
        if violation > 0.0 || room.motion.retime(&self.setup.times_s(x)).is_err() {
            return violation.max(f64::MIN_POSITIVE);
        }
        objectives[3] = room.sum_of_peaks_rad(&self.models);
        0.0
    }
}

impl Workspace {
    /// Sum of the modelled peaks of all transitions, rad.
    fn sum_of_peaks_rad(&mut self, models: &[Option<Model>]) -> f64 {
        let duration_s = self.motion.duration_s();
        self.t_s.clear();
        let mut t_s = 0.0;
        // Until the joints have settled.
        while t_s < duration_s + 2.0 {
            self.t_s.push(t_s);
            t_s = self.t_s.len() as f64 * STEP_S;
        }
        self.motion.sample(&self.t_s, Quantity::Velocity, &mut self.samples);
        let mut sum_rad = 0.0;
        for (joint, model) in models.iter().enumerate() {
            let Some(model) = model else { continue };
            let position = self.samples.of(Quantity::Position, joint);
            let speed = self.samples.of(Quantity::Velocity, joint);
            self.planned.clear();
            self.planned.extend(position.iter().copied().zip(speed.iter().copied()));
            sum_rad +=
                self.follower.starts(model, &self.planned).iter().map(|s| s.peak_error_rad).sum::<f64>();
        }
        sum_rad
    }
}
