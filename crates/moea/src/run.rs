//! A run step by step: members are asked for and their values told.

use std::{cell::Cell, fmt};

use super::{
    MoeaError, Outcome, Progress, Record, Settings, Variables,
    evaluate::{self, Scales},
    genetic::Method,
    mating::Mating,
    optimise::{method, method_of},
    record::Told,
    settings::{Checked, check},
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
    /// None before the first values are told.
    scales: Option<Scales>,
    /// Whether somebody asked since values were told.
    asked: Cell<bool>,
}

impl fmt::Debug for Run {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Progress { generation, evaluations, .. } = self.progress();
        write!(
            f,
            "Run {{ generation: {generation}, evaluations: {evaluations}, is_over: {} }}",
            self.is_over()
        )
    }
}

impl Run {
    fn of(checked: &Checked, settings: &Settings, method: Box<dyn Method>) -> Self {
        let state = State::new(checked, settings, method);
        Self { state, record: Record::default(), scales: None, asked: Cell::new(false) }
    }

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
        Ok(Self::of(&checked, settings, method))
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
        Ok(Self::of(&checked, settings, method))
    }

    /// Takes up a run of [`Self::new`] where its record ends. An observer that looks back, as a
    /// [`Tolerance`](super::Tolerance) does, is shown what was by [`Self::replay_watched`].
    ///
    /// # Errors
    ///
    /// [`MoeaError`] when the settings do not fit, [`MoeaError::Record`] when the record is of a run
    /// with others, [`MoeaError::Damaged`] when its values are not those that were told.
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

    /// Tells a new run what the record of an equal one holds. After an error the run is of no use.
    ///
    /// # Errors
    ///
    /// [`MoeaError::Record`] when the record holds other members than this run asks for, those after the last
    /// values too, or when this run was told values before; [`MoeaError::Damaged`] when its values are not those that
    /// were told.
    pub fn replay(&mut self, record: &Record) -> Result<(), MoeaError> {
        self.replay_watched(record, |_| {})
    }

    /// As [`Self::replay`], and shows every generation that ends to `watch`, as [`optimise`](super::optimise()) shows
    /// it to an observer: a [`Tolerance`](super::Tolerance) that has watched them ends the run where it would have
    /// ended in one go.
    ///
    /// ```
    /// use moea::{Run, Settings, Tolerance};
    ///
    /// let (bounds, settings) = ([(-10.0, 10.0)], Settings::default());
    /// let evaluate = |x: &[f64]| [x[0].powi(2), (x[0] - 2.0).powi(2)];
    /// let mut run = Run::new(&bounds, 2, &settings)?;
    /// let step = |run: &mut Run| {
    ///     let objectives: Vec<f64> = run.ask().into_iter().flat_map(evaluate).collect();
    ///     run.tell(&objectives, &vec![0.0; objectives.len() / 2])
    /// };
    /// for _ in 0..10 {
    ///     step(&mut run)?;
    /// }
    /// let record = run.record().clone();
    ///
    /// let mut tolerance = Tolerance::new(1e-3, 20);
    /// let mut run = Run::new(&bounds, 2, &settings)?;
    /// run.replay_watched(&record, |progress| {
    ///     let _ = tolerance.watch(progress);
    /// })?;
    /// while !run.is_over() {
    ///     step(&mut run)?;
    ///     if tolerance.watch(&run.progress()).is_break() {
    ///         break;
    ///     }
    /// }
    /// # Ok::<(), moea::MoeaError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`Self::replay`].
    pub fn replay_watched(
        &mut self,
        record: &Record,
        mut watch: impl FnMut(&Progress<'_>),
    ) -> Result<(), MoeaError> {
        let is_new = self.record.batches().is_empty();
        for batch in record.batches() {
            if !batch.is_sound() {
                return Err(MoeaError::Damaged { evaluation: self.progress().evaluations });
            }
            let told = batch.values(&self.state.pending).filter(|_| is_new && !self.is_over());
            let told = told.ok_or_else(|| self.other_record())?;
            let generation = self.progress().generation;
            self.asked.set(true);
            self.take(&told)?;
            if self.progress().generation > generation {
                watch(&self.progress());
            }
        }
        if is_new && self.record.goes_on_as(record) { Ok(()) } else { Err(self.other_record()) }
    }

    fn other_record(&self) -> MoeaError {
        MoeaError::Record { evaluation: self.progress().evaluations }
    }

    /// Variables of the members to evaluate next, `[variables]` each; the same until they are told,
    /// none when the run is over.
    pub fn ask(&self) -> Vec<&[f64]> {
        self.asked.set(true);
        (0..self.state.pending.len()).map(|i| self.state.pending.x(i)).collect()
    }

    /// Tells objectives, `[n][objectives]` in one slice, and total violations of constraints, `[n]`, of
    /// the members asked for, in their order. Values that are no numbers make a member the worst there is.
    ///
    /// # Errors
    ///
    /// [`MoeaError::Told`] for another number of values, [`MoeaError::NotAsked`] for values told again,
    /// [`MoeaError::ToldEach`] if constraints were told one by one before; then nothing has changed.
    pub fn tell(&mut self, objectives: &[f64], violations: &[f64]) -> Result<(), MoeaError> {
        self.take(&Told { f: objectives.to_vec(), violations: violations.to_vec(), each: Vec::new() })
    }

    /// As [`Self::tell`], with the violations of single constraints, `[n][constraints]` in one slice, each in a unit of
    /// its own, as [`Problem::violations`](super::Problem::violations) writes them: what is not above 0 is kept.
    ///
    /// # Errors
    ///
    /// As [`Self::tell`]; [`MoeaError::ToldEach`] for another number of constraints than before.
    pub fn tell_each(&mut self, objectives: &[f64], violations: &[f64]) -> Result<(), MoeaError> {
        let totals = vec![0.0; self.state.pending.len()];
        self.take(&Told { f: objectives.to_vec(), violations: totals, each: violations.to_vec() })
    }

    fn take(&mut self, told: &Told) -> Result<(), MoeaError> {
        let (members, m) = (self.state.pending.len(), self.state.pending.objectives());
        if told.f.len() != members * m || told.violations.len() != members {
            let (objectives, violations) = (told.f.len(), told.violations.len());
            return Err(MoeaError::Told { objectives, violations, members, wanted: members * m });
        }
        let constraints = self.scales.as_ref().map(Scales::constraints);
        let c = told.each.len() / members.max(1);
        if told.each.len() != members * c || constraints.is_some_and(|before| members > 0 && before != c) {
            return Err(MoeaError::ToldEach { violations: told.each.len(), members, constraints });
        }
        if members == 0 {
            return Ok(());
        }
        if !self.asked.take() {
            return Err(MoeaError::NotAsked { evaluations: self.progress().evaluations });
        }
        self.record.push(&self.state.pending, told);
        let (_, f, totals) = self.state.pending.evaluation_parts();
        f.copy_from_slice(&told.f);
        for ((f, own), &told) in f.chunks_exact_mut(m).zip(totals.iter_mut()).zip(&told.violations) {
            *own = evaluate::checked(told, f);
        }
        let State { pending, population, .. } = &mut self.state;
        self.scales.get_or_insert_with(|| Scales::new(c)).add_each(&told.each, pending, population);
        self.state.advance();
        self.record.ask_next(&self.state.pending);
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
