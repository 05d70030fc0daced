//! Times between key points as a problem for evolutionary algorithms: one variable an interval, any objectives.

use super::{Evaluator, Setup, excess};
use crate::{
    moea::{Bounds, Problem},
    spline::Motion,
    task::{Ceilings, Objective},
};

/// Predicts what a machine makes of a motion.
pub trait Machine: Sync {
    /// Memory of one thread.
    type Memory: Default + Send;

    /// Sum of the predicted peak errors of all starts and reversals, rad.
    fn start_error_rad(&self, motion: &Motion, memory: &mut Self::Memory) -> f64;
}

/// No machine is known: nothing is predicted.
#[derive(Debug, Clone, Copy)]
pub struct NoMachine;

impl Machine for NoMachine {
    type Memory = ();

    fn start_error_rad(&self, _: &Motion, (): &mut ()) -> f64 {
        f64::INFINITY
    }
}

/// A setup with the objectives to minimise.
#[derive(Debug)]
pub struct TimingProblem<'a, M = NoMachine> {
    setup: &'a Setup,
    objectives: &'static [Objective],
    ceilings: Ceilings,
    machine: M,
}

impl<'a> TimingProblem<'a> {
    /// The objectives of a plan, without ceilings.
    pub fn of(setup: &'a Setup) -> Self {
        Self { setup, objectives: Objective::OF_PLAN, ceilings: Ceilings::NONE, machine: NoMachine }
    }
}

impl<'a, M: Machine> TimingProblem<'a, M> {
    /// All objectives, those of a plan held to ceilings.
    pub fn on(setup: &'a Setup, machine: M, ceilings: Ceilings) -> Self {
        Self { setup, objectives: &Objective::ALL, ceilings, machine }
    }
}

impl<M: Machine> Problem for TimingProblem<'_, M> {
    type Workspace = Option<Box<(Evaluator, M::Memory)>>;

    fn bounds(&self) -> Vec<Bounds> {
        let [shortest_s, longest_s] = self.setup.interval_s;
        vec![(shortest_s, longest_s); self.setup.interval_count()]
    }

    fn objectives(&self) -> usize {
        self.objectives.len()
    }

    fn evaluate(&self, x: &[f64], objectives: &mut [f64], workspace: &mut Self::Workspace) -> f64 {
        let (evaluator, memory) = &mut **workspace
            .get_or_insert_with(|| Box::new((Evaluator::new(self.setup), M::Memory::default())));
        let Some(mut found) = evaluator.evaluate(self.setup, x) else { return f64::INFINITY };
        let over: f64 =
            found.plan().iter().zip(self.ceilings.plan()).map(|(f, ceiling)| excess(f / ceiling)).sum();
        let violation = evaluator.violation() + over;
        // A prediction takes as long as a hundred evaluations: only plans that keep their limits get one.
        found[Objective::StartError] = if self.objectives.contains(&Objective::StartError) && violation <= 0.0
        {
            self.machine.start_error_rad(&evaluator.motion, memory)
        } else {
            0.0
        };
        objectives.iter_mut().zip(self.objectives).for_each(|(to, objective)| *to = found[*objective]);
        violation
    }
}
