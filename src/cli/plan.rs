//! `plan`: searches with a progress bar, or judges times; writes the log.

use std::{collections::BTreeMap, io::Write, ops::ControlFlow, time::Instant};

use indicatif::ProgressBar;

use super::{
    CliError, Outcome,
    args::PlanArgs,
    figures,
    output::{deliver, progress, say_remarks, shown, spare_inputs, spare_stdout, spare_terminal, text_file},
};
use crate::{
    atomic_file::write_atomically,
    moea::{Budget, Contender},
    plan::{PlanEvaluation, Progress, Reference, SampledMotion},
    render::{
        kit::Document,
        next,
        plan::{self as words, broken_lines, ceiling_lines, judged_document, judged_page, motion_figures},
    },
    workflow::{
        carried::{
            Carried,
            plan_log::{PlanLog, Planned as Steps},
        },
        plan::{Options, PlanDocument, PlanFailure, PlanRequest, Planned, run as search},
    },
};

pub(super) fn run(args: &PlanArgs, out: &mut impl Write, err: &mut impl Write) -> Result<Outcome, CliError> {
    spare_inputs(args.output.as_deref(), std::slice::from_ref(&args.task))?;
    spare_terminal(args.wants_html(), text_file(args.page()))?;
    spare_stdout(args.log())?;
    figures::check(&args.figures)?;
    let request = PlanRequest::read(&args.task)?;
    match args.times.as_ref().or(request.task.times_s.as_ref()) {
        Some(times_s) => judge(args, &request, times_s, out, err),
        None => plan(args, &request, out, err),
    }
}

fn judge(
    args: &PlanArgs,
    request: &PlanRequest,
    times_s: &[f64],
    out: &mut impl Write,
    err: &mut impl Write,
) -> Result<Outcome, CliError> {
    let title = &request.task.title;
    let evaluation = PlanEvaluation::of(&request.setup, times_s).map_err(PlanFailure::from)?;
    let joints = request.setup.joint_names();
    let document = PlanDocument::evaluated(title, &joints, &evaluation, true);
    write_log(args, request, &document, BTreeMap::new())?;
    let course = course(request, &evaluation)?;
    let rendered = if args.wants_json() {
        document.json()
    } else if args.wants_html() {
        judged_page(title, &joints, &evaluation, &course)
    } else {
        shown(&written(args, judged_document(title, &joints, &evaluation)), None)
    };
    figures::figures(&args.figures, err, || motion_figures(&joints, &course))?;
    deliver(&rendered, text_file(args.page()), out)?;
    Ok(if evaluation.broken().is_empty() { Outcome::Clean } else { Outcome::GateFailed })
}

fn plan(
    args: &PlanArgs,
    request: &PlanRequest,
    out: &mut impl Write,
    err: &mut impl Write,
) -> Result<Outcome, CliError> {
    let Found { planned, document, algorithm, options } = found(args, request, out)?;
    let (title, ceilings) = (&request.task.title, &request.task.ceilings);
    let course = course(request, &planned.chosen)?;
    let rendered = if args.wants_json() {
        document.json()
    } else if args.wants_html() {
        words::page(&document, &options, ceilings, &planned, &course)
    } else {
        shown(&written(args, words::document(title, algorithm, &options, ceilings, &planned)), None)
    };
    figures::figures(&args.figures, err, || words::figures(&document, &course))?;
    deliver(&rendered, text_file(args.page()), out)?;
    if args.wants_json() || args.wants_html() {
        say_remarks(&planned.remarks, err);
    }
    Ok(if planned.remarks.is_empty() { Outcome::Clean } else { Outcome::Remarks })
}

/// Says where the log is, if there is one.
fn written(args: &PlanArgs, document: Document) -> Document {
    match args.log() {
        Some(log) => document.with_above_remarks(next::plan_written(log)),
        None => document,
    }
}

/// What a search found, as it was written.
pub(super) struct Found {
    pub(super) planned: Planned,
    document: PlanDocument,
    algorithm: &'static str,
    options: Options,
}

/// Searches with a progress bar and writes the chosen plan.
pub(super) fn found(args: &PlanArgs, request: &PlanRequest, out: &mut impl Write) -> Result<Found, CliError> {
    let (title, options) = (&request.task.title, args.options());
    let algorithm = Contender::named(&args.search.algorithm).map_or("", |contender| contender.title);
    let mut watch = Watch::new(args, &options);
    let planned = match search(request, &options, |progress| watch.see(progress)) {
        Ok(planned) => planned,
        Err(failure) => {
            watch.bar.finish_and_clear();
            return Err(explained(args, request, failure, out)?);
        }
    };
    watch.bar.finish_and_clear();
    let document = PlanDocument::searched(title, algorithm, &options, &planned);
    let provenance = BTreeMap::from(
        [
            ("algorithm", algorithm.to_owned()),
            ("seeded", options.search.seeded.to_string()),
            ("seed", options.search.seed.to_string()),
            ("evaluations", planned.evaluations.to_string()),
            ("generations", planned.generations.to_string()),
        ]
        .map(|(key, value)| (key.to_owned(), value)),
    );
    write_log(args, request, &document, provenance)?;
    Ok(Found { planned, document, algorithm, options })
}

fn course(request: &PlanRequest, evaluation: &PlanEvaluation) -> Result<SampledMotion, CliError> {
    Ok(SampledMotion::of(&request.setup, evaluation).map_err(PlanFailure::from)?)
}

/// What a failure means in the task's own terms; as JSON, where that is asked for.
fn explained(
    args: &PlanArgs,
    request: &PlanRequest,
    failure: PlanFailure,
    out: &mut impl Write,
) -> Result<CliError, CliError> {
    let joints = request.setup.joint_names();
    let (evaluation, lines) = match &failure {
        PlanFailure::Infeasible(nearest) => {
            (nearest, broken_lines(&joints, request.task.interval_s[1], nearest))
        }
        PlanFailure::Ceilings { nearest } => {
            (nearest, ceiling_lines(&request.task.ceilings, &joints, nearest))
        }
        _ => return Ok(failure.into()),
    };
    if args.wants_json() {
        let document = PlanDocument::evaluated(&request.task.title, &joints, evaluation, false);
        deliver(&document.json(), None, out)?;
    }
    Ok(CliError::NoPlan { failure: failure.to_string(), lines })
}

fn write_log(
    args: &PlanArgs,
    request: &PlanRequest,
    document: &PlanDocument,
    provenance: BTreeMap<String, String>,
) -> Result<(), CliError> {
    let Some(path) = args.log() else { return Ok(()) };
    let motion = request.setup.motion(&document.chosen.entry.times_s).map_err(PlanFailure::from)?;
    let log = PlanLog {
        plan: Steps::Motion(&motion, &document.joints),
        command: None,
        arm: Some(&request.setup.arm().chain),
        trajectory: None,
        carried: &Carried::default().with_plan(&request.text, document).with_provenance(provenance),
        rate_hz: args.rate,
    };
    let bytes = log.bytes()?;
    write_atomically(path, |file| Ok(file.write_all(&bytes)?))
}

/// Shows progress on a terminal and ends the search when its time is up.
struct Watch {
    bar: ProgressBar,
    reference: Option<Reference>,
    start: Instant,
    args_time: Option<std::time::Duration>,
}

impl Watch {
    fn new(args: &PlanArgs, options: &Options) -> Self {
        let steps = match options.search.budget {
            Budget::Evaluations(evaluations) => Some(evaluations),
            Budget::Generations(_) | Budget::Observer => None,
        };
        let bar = progress(steps, "{bar:30} {pos} evaluations, {msg}");
        Self { bar, reference: None, start: Instant::now(), args_time: args.search.time_budget }
    }

    fn see(&mut self, progress: &Progress<'_>) -> ControlFlow<()> {
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
        match self.args_time {
            Some(most) if self.start.elapsed() >= most => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    }
}
