//! A run step by step: members are asked for and their values told.

use super::{
    MoeaError, Outcome, Progress, Record, Settings, Variables, evaluate,
    mating::Mating,
    optimise::{method, method_of},
    settings::check,
    state::State,
    survival::Survival,
};

/// A run whose members are evaluated by the caller, wherever and however long that takes.
///
/// Same settings and values give the [`Outcome`] of [`optimise`](super::optimise()), bit for bit.
///
/// ```
/// use moea::{Record, Run, Settings};
///
/// let (bounds, settings) = ([(-10.0, 10.0)], Settings::default());
/// let mut run = Run::new(&bounds, 2, &settings)?;
/// let evaluate = |x: &[f64]| [x[0].powi(2), (x[0] - 2.0).powi(2)];
/// for _ in 0..10 {
///     let objectives: Vec<f64> = run.ask().into_iter().flat_map(evaluate).collect();
///     let violations = vec![0.0; run.ask().len()];
///     run.tell(&objectives, &violations)?;
/// }
///
/// // A record of what was told takes the run up again, in another process too.
/// let record: Record = run.record().clone();
/// let mut run = Run::resume(&bounds, 2, &settings, &record)?;
/// while !run.is_over() {
///     let objectives: Vec<f64> = run.ask().into_iter().flat_map(evaluate).collect();
///     let violations = vec![0.0; run.ask().len()];
///     run.tell(&objectives, &violations)?;
/// }
/// assert_eq!(run.into_outcome().evaluations, 20_000);
/// # Ok::<(), moea::MoeaError>(())
/// ```
pub struct Run {
    state: State,
    record: Record,
}

impl Run {
    /// A run of the algorithm of the settings on variables: bounds alone, `[variables]`, if all are real, else
    /// [`Variables`].
    ///
    /// # Errors
    ///
    /// [`MoeaError`] when the settings do not fit.
    pub fn new(
        variables: impl Into<Variables>,
        objectives: usize,
        settings: &Settings,
    ) -> Result<Self, MoeaError> {
        let checked = check(variables.into(), objectives, settings)?;
        let method = method(&checked, settings);
        Ok(Self { state: State::new(&checked, settings, method), record: Record::default() })
    }

    /// A run with a mating and a survival of the caller's, as [`optimise_with`](super::optimise_with).
    ///
    /// # Errors
    ///
    /// [`MoeaError`] when the settings do not fit.
    pub fn with(
        variables: impl Into<Variables>,
        objectives: usize,
        settings: &Settings,
        mating: impl Mating + 'static,
        survival: impl Survival + 'static,
    ) -> Result<Self, MoeaError> {
        let (checked, method) = method_of(variables.into(), objectives, settings, mating, survival)?;
        Ok(Self { state: State::new(&checked, settings, method), record: Record::default() })
    }

    /// Takes up a run of [`Self::new`] where its record ends.
    ///
    /// # Errors
    ///
    /// [`MoeaError`] when the settings do not fit, [`MoeaError::Record`] when the record is of a run
    /// with others.
    pub fn resume(
        variables: impl Into<Variables>,
        objectives: usize,
        settings: &Settings,
        record: &Record,
    ) -> Result<Self, MoeaError> {
        let mut run = Self::new(variables, objectives, settings)?;
        run.replay(record)?;
        Ok(run)
    }

    /// Tells a new run what the record of an equal one holds.
    ///
    /// # Errors
    ///
    /// [`MoeaError::Record`] when the record holds other members than this run asks for.
    pub fn replay(&mut self, record: &Record) -> Result<(), MoeaError> {
        for batch in record.batches() {
            let other = MoeaError::Record { evaluation: self.progress().evaluations };
            let asked = &self.state.pending;
            let Some((f, violations)) = batch.values(asked).filter(|_| !self.is_over()) else {
                return Err(other);
            };
            self.tell(&f, &violations)?;
        }
        Ok(())
    }

    /// Variables of the members to evaluate next, `[variables]` each; the same until they are told,
    /// none when the run is over.
    pub fn ask(&self) -> Vec<&[f64]> {
        (0..self.state.pending.len()).map(|i| self.state.pending.x(i)).collect()
    }

    /// Tells objectives, `[n][objectives]` in one slice, and total violations of constraints, `[n]`, of
    /// the members asked for, in their order. Values that are no numbers make a member the worst there is.
    ///
    /// # Errors
    ///
    /// [`MoeaError::Told`] for another number of values; then nothing has changed.
    pub fn tell(&mut self, objectives: &[f64], violations: &[f64]) -> Result<(), MoeaError> {
        let (members, m) = (self.state.pending.len(), self.state.pending.objectives());
        if objectives.len() != members * m || violations.len() != members {
            let (objectives, violations) = (objectives.len(), violations.len());
            return Err(MoeaError::Told { objectives, violations, members, wanted: members * m });
        }
        if members == 0 {
            return Ok(());
        }
        self.record.push(&self.state.pending, objectives, violations);
        let (_, f, violation) = self.state.pending.evaluation_parts();
        f.copy_from_slice(objectives);
        for ((f, own), &told) in f.chunks_exact_mut(m).zip(violation).zip(violations) {
            *own = evaluate::checked(told, f);
        }
        self.state.advance();
        Ok(())
    }

    /// Whether the budget is used up. Without a budget never.
    pub fn is_over(&self) -> bool {
        self.state.is_over
    }

    /// Population and archive so far; the population is empty until the first members are told.
    pub fn progress(&self) -> Progress<'_> {
        self.state.progress()
    }

    /// All that was told so far.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// What the run has found so far.
    pub fn into_outcome(self) -> Outcome {
        self.state.into_outcome()
    }
}
