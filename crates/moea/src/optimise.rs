//! Optimises a problem by the algorithm of the settings, or by one of the caller's.

use std::ops::ControlFlow;

use super::{
    Algorithm, MoeaError, Outcome, Problem, Progress, Settings,
    agemoea2::Geodesic,
    evaluate::Evaluation,
    focus::Focused,
    genetic::{Breeding, Genetic, Method},
    mating::{Mating, Uniform},
    moead::Decomposition,
    msops2::{NearMate, Targets},
    nsga2::{Crowding, Tournament},
    nsga3::Niching,
    settings::{Checked, check},
    smsemoa::LeastContribution,
    state::State,
    survival::Survival,
    unsga3::NicheTournament,
    variables::Variables,
};

/// Observes nothing.
pub fn silent(_: &Progress<'_>) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Minimises all objectives of a problem at once.
///
/// Equal settings give an equal outcome, bit for bit, on any number of cores. The observer may
/// end the run by [`ControlFlow::Break`].
///
/// # Errors
///
/// [`MoeaError`] when the settings do not fit the problem.
pub fn optimise<P: Problem>(
    problem: &P,
    settings: &Settings,
    observer: impl FnMut(&Progress<'_>) -> ControlFlow<()>,
) -> Result<Outcome, MoeaError> {
    let checked = check(Variables::of(problem), problem.objectives(), settings)?;
    let method = method(&checked, settings);
    Ok(run(problem, State::new(&checked, settings, method), observer))
}

/// Minimises as [`optimise`] does, with a mating and a survival of the caller's in place of the
/// algorithm of the settings.
///
/// # Errors
///
/// [`MoeaError`] when the settings do not fit the problem.
pub fn optimise_with<P: Problem>(
    problem: &P,
    settings: &Settings,
    mating: impl Mating + 'static,
    survival: impl Survival + 'static,
    observer: impl FnMut(&Progress<'_>) -> ControlFlow<()>,
) -> Result<Outcome, MoeaError> {
    let (checked, method) =
        method_of(Variables::of(problem), problem.objectives(), settings, mating, survival)?;
    Ok(run(problem, State::new(&checked, settings, method), observer))
}

fn run<P: Problem>(
    problem: &P,
    mut state: State,
    mut observer: impl FnMut(&Progress<'_>) -> ControlFlow<()>,
) -> Outcome {
    let mut evaluation = Evaluation::new(problem);
    while !state.is_over {
        evaluation.evaluate(problem, &mut state.pending, &mut state.population);
        if state.advance() && observer(&state.progress()).is_break() {
            break;
        }
    }
    state.into_outcome()
}

/// A mating and a survival of the caller's as a method.
pub(super) fn method_of(
    variables: Variables,
    objectives: usize,
    settings: &Settings,
    mating: impl Mating + 'static,
    survival: impl Survival + 'static,
) -> Result<(Checked, Box<dyn Method>), MoeaError> {
    // As many members as wanted: nobody knows whether the caller's survival has directions.
    let settings = Settings { algorithm: Algorithm::Nsga2, ..settings.clone() };
    let checked = check(variables, objectives, &settings)?;
    let breeding = Breeding::new(settings.operators, checked.mutation_rate, checked.space.clone());
    let method = Genetic::new(Box::new(mating), Box::new(survival), breeding);
    Ok((checked, Box::new(method)))
}

/// The algorithm of the settings.
pub(super) fn method(checked: &Checked, settings: &Settings) -> Box<dyn Method> {
    let (m, directions) = (checked.objectives, &checked.directions);
    let breeding = Breeding::new(settings.operators, checked.mutation_rate, checked.space.clone());
    let niching = || Box::new(Niching::of(directions, m));
    match settings.algorithm {
        Algorithm::Nsga3 => Box::new(Genetic::new(Box::<Uniform>::default(), niching(), breeding)),
        Algorithm::UNsga3 => Box::new(Genetic::new(Box::<NicheTournament>::default(), niching(), breeding)),
        Algorithm::Nsga3Fo { focus, adaptive_rates } => {
            let mating = Focused::new(focus, adaptive_rates, directions, m);
            let survival = if focus.fills_by_crowding() {
                Box::new(Niching::of(directions, m).with_crowding())
            } else {
                niching()
            };
            Box::new(Genetic::new(Box::new(mating), survival, breeding))
        }
        Algorithm::Nsga2 => {
            Box::new(Genetic::new(Box::<Tournament>::default(), Box::<Crowding>::default(), breeding))
        }
        Algorithm::Moead { normalized } => Box::new(Decomposition::new(directions, m, normalized, breeding)),
        Algorithm::Msops2 => {
            Box::new(Genetic::new(Box::<NearMate>::default(), Box::<Targets>::default(), breeding))
        }
        Algorithm::SmsEmoa => {
            Box::new(Genetic::new(Box::<Uniform>::default(), Box::<LeastContribution>::default(), breeding))
        }
        Algorithm::AgeMoea2 => {
            Box::new(Genetic::new(Box::<Tournament>::default(), Box::<Geodesic>::default(), breeding))
        }
    }
}
