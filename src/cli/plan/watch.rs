//! Progress of a search.

use std::{
    ops::ControlFlow,
    time::{Duration, Instant},
};

use indicatif::ProgressBar;

use super::Args;
use crate::{
    cli::console::progress,
    moea::Budget,
    plan::{Progress, Reference},
    workflow::plan::Options,
};

/// Shows progress on a terminal and ends the search when its time is up.
pub(super) struct Watch {
    pub(super) bar: ProgressBar,
    reference: Option<Reference>,
    start: Instant,
    time_budget: Option<Duration>,
}

impl Watch {
    pub(super) fn new(args: &Args, options: &Options) -> Self {
        let steps = match options.search.budget {
            Budget::Evaluations(evaluations) => Some(evaluations),
            Budget::Generations(_) | Budget::Observer => None,
        };
        let bar = progress(steps, "{bar:30} {pos} evaluations, {msg}");
        Self { bar, reference: None, start: Instant::now(), time_budget: args.search.time_budget }
    }

    pub(super) fn see(&mut self, progress: &Progress<'_>) -> ControlFlow<()> {
        self.bar.set_position(progress.evaluations);
        if !self.bar.is_hidden() {
            let population = progress.population;
            let front = population.front();
            let objectives = || front.iter().map(|&i| population.f(i));
            if !front.is_empty() {
                let reference = *self.reference.get_or_insert_with(|| Reference::of(objectives()));
                self.bar.set_message(format!("hypervolume {:.4}", reference.measure(objectives())));
            }
        }
        match self.time_budget {
            Some(most) if self.start.elapsed() >= most => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    }
}
