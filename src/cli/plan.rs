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
    plan::Progress,
    render::{
        kit::Document,
        next,
        plan::{
            self as words, broken_lines, ceiling_lines, judged_document, judged_json, judged_page,
            motion_figures,
        },
    },
    workflow::{
        carried::plan_log::PlanLog,
        plan::{Course, Gauge, Judged, Options, Order, PlanFailure, Planned, run as search},
    },
};

pub(super) fn run(args: &PlanArgs, out: &mut impl Write, err: &mut impl Write) -> Result<Outcome, CliError> {
    spare_inputs(args.output.as_deref(), std::slice::from_ref(&args.task))?;
    spare_terminal(args.wants_html(), text_file(args.page()))?;
    spare_stdout(args.log())?;
    figures::check(&args.figures)?;
    let order = Order::read(&args.task)?;
    match args.times.as_ref().or(order.task.times_s.as_ref()) {
        Some(times_s) => judge(args, &order, times_s, out, err),
        None => plan(args, &order, out, err),
    }
}

fn judge(
    args: &PlanArgs,
    order: &Order,
    times_s: &[f64],
    out: &mut impl Write,
    err: &mut impl Write,
) -> Result<Outcome, CliError> {
    let title = &order.task.title;
    let judged = Judged::of(&order.setup, times_s).map_err(PlanFailure::from)?;
    let joints = order.setup.joint_names();
    let document = judged_json(title, &joints, &judged, true);
    write_log(args, order, &judged, &document, &BTreeMap::new())?;
    let course = course(order, &judged)?;
    let rendered = if args.wants_json() {
        document
    } else if args.wants_html() {
        judged_page(title, &joints, &judged, &course)
    } else {
        shown(&written(args, judged_document(title, &joints, &judged)), None)
    };
    figures::figures(&args.figures, err, || motion_figures(&joints, &course))?;
    deliver(&rendered, text_file(args.page()), out)?;
    Ok(if judged.broken().is_empty() { Outcome::Clean } else { Outcome::GateFailed })
}

fn plan(
    args: &PlanArgs,
    order: &Order,
    out: &mut impl Write,
    err: &mut impl Write,
) -> Result<Outcome, CliError> {
    let Found { planned, document, algorithm, options } = found(args, order, out)?;
    let (title, bounds) = (&order.task.title, &order.task.bounds);
    let course = course(order, &planned.chosen)?;
    let rendered = if args.wants_json() {
        document
    } else if args.wants_html() {
        words::page(title, algorithm, &options, bounds, &planned, &course)
    } else {
        shown(&written(args, words::document(title, algorithm, &options, bounds, &planned)), None)
    };
    figures::figures(&args.figures, err, || words::figures(title, &planned, &course))?;
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
    document: String,
    algorithm: &'static str,
    options: Options,
}

/// Searches with a progress bar and writes the chosen plan.
pub(super) fn found(args: &PlanArgs, order: &Order, out: &mut impl Write) -> Result<Found, CliError> {
    let (title, options) = (&order.task.title, args.options());
    let algorithm = Contender::named(&args.search.algorithm).map_or("", |contender| contender.title);
    let mut watch = Watch::new(args, &options);
    let planned = match search(order, &options, |progress| watch.see(progress)) {
        Ok(planned) => planned,
        Err(failure) => {
            watch.bar.finish_and_clear();
            return Err(explained(args, order, failure, out)?);
        }
    };
    watch.bar.finish_and_clear();
    let document = words::json(title, algorithm, &options, &planned);
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
    write_log(args, order, &planned.chosen, &document, &provenance)?;
    Ok(Found { planned, document, algorithm, options })
}

fn course(order: &Order, judged: &Judged) -> Result<Course, CliError> {
    Ok(Course::of(&order.setup, judged).map_err(PlanFailure::from)?)
}

/// What a failure means in the task's own terms; as JSON, where that is asked for.
fn explained(
    args: &PlanArgs,
    order: &Order,
    failure: PlanFailure,
    out: &mut impl Write,
) -> Result<CliError, CliError> {
    let joints = order.setup.joint_names();
    let (judged, lines) = match &failure {
        PlanFailure::Infeasible(nearest) => {
            (nearest, broken_lines(&joints, order.task.interval_s[1], nearest))
        }
        PlanFailure::Ceilings { nearest, share } => {
            (nearest, ceiling_lines(&order.task.bounds, &joints, nearest, *share))
        }
        _ => return Ok(failure.into()),
    };
    if args.wants_json() {
        deliver(&judged_json(&order.task.title, &joints, judged, false), None, out)?;
    }
    Ok(CliError::NoPlan { failure: failure.to_string(), lines })
}

fn write_log(
    args: &PlanArgs,
    order: &Order,
    judged: &Judged,
    document: &str,
    provenance: &BTreeMap<String, String>,
) -> Result<(), CliError> {
    let Some(path) = args.log() else { return Ok(()) };
    let motion = order.setup.motion(&judged.times_s).map_err(PlanFailure::from)?;
    let log = PlanLog {
        setup: &order.setup,
        task: &order.text,
        document,
        provenance,
        motion: &motion,
        rate_hz: args.rate,
    };
    let bytes = log.bytes()?;
    write_atomically(path, |file| Ok(file.write_all(&bytes)?))
}

/// Shows progress on a terminal and ends the search when its time is up.
struct Watch {
    bar: ProgressBar,
    gauge: Option<Gauge>,
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
        Self { bar, gauge: None, start: Instant::now(), args_time: args.search.time_budget }
    }

    fn see(&mut self, progress: &Progress<'_>) -> ControlFlow<()> {
        self.bar.set_position(progress.evaluations);
        if !self.bar.is_hidden() {
            let population = progress.population;
            let front = population.front();
            let objectives = || front.iter().map(|&i| population.f(i)).map(|f| [f[0], f[1], f[2]]);
            if !front.is_empty() {
                let gauge = *self.gauge.get_or_insert_with(|| Gauge::of(objectives()));
                self.bar.set_message(format!("hypervolume {:.4}", gauge.measure(objectives())));
            }
        }
        match self.args_time {
            Some(most) if self.start.elapsed() >= most => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    }
}
