//! `plan`: searches with a progress bar, or evaluates given times; writes the log.

mod args;
mod watch;

use std::{collections::BTreeMap, slice::from_ref};

pub(super) use args::Free;

use super::{
    CliError, Outcome, Run,
    console::{Console, Form, Target, spare_for_log, write_file},
};
use crate::{
    moea::NamedAlgorithm,
    plan::PlanEvaluation,
    render::{
        kit::Document,
        next,
        plan::{
            self as words, Courses, broken_lines, ceiling_lines, judged_document, judged_page, motion_figures,
        },
    },
    workflow::{
        carried::{
            Carried,
            plan_log::{PlanLog, Planned as Steps},
        },
        plan::{Course, Options, PlanDocument, PlanFailure, PlanRequest, Planned, Shaping, run},
    },
};

pub(super) use args::Args;
use watch::Watch;

impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        spare_for_log(self.log(), from_ref(&self.task))?;
        let target = Target::new(self.form(), self.page())?;
        self.figures.check()?;
        let request = PlanRequest::read(&self.task)?;
        if self.shape.pieces.is_some() && self.shape.shape == Free::Timing {
            return Err(CliError::Usage("--pieces are of a free shape: add --shape free".to_owned()));
        }
        if self.times.is_none() && request.task.times_s.is_some() && self.seeks() {
            let text = "the task gives times_s, so that plan is judged and none is sought: leave times_s out of it, or \
                        --near, --degrees, --choose, --weights and --shape out of the command";
            return Err(CliError::Usage(text.to_owned()));
        }
        match self.times.as_ref().or(request.task.times_s.as_ref()) {
            Some(times_s) => self.evaluate(&request, times_s, &target, console),
            None => self.search(&request, &target, console),
        }
    }
}

/// A finished search and its document.
pub(super) struct Found {
    pub(super) planned: Planned,
    document: PlanDocument,
    algorithm: &'static str,
    options: Options,
}

impl Args {
    /// Whether an option says how to seek a plan.
    fn seeks(&self) -> bool {
        let choice = &self.choice;
        let rules = choice.choose.is_some() || choice.weights.is_some();
        choice.near.is_some() || choice.degrees || rules || self.shape.shape == Free::Free
    }

    fn evaluate(
        &self,
        request: &PlanRequest,
        times_s: &[f64],
        target: &Target<'_>,
        console: &mut Console<'_>,
    ) -> Result<Outcome, CliError> {
        let title = &request.task.title;
        let evaluation = PlanEvaluation::of(&request.setup, times_s).map_err(PlanFailure::from)?;
        let joints = request.setup.joint_names();
        let above = request.above(&evaluation);
        let keeps = above.is_empty() && evaluation.broken().is_empty();
        let document = PlanDocument::evaluated(title, &joints, &evaluation, keeps);
        self.write_log(request, &document, BTreeMap::new())?;
        let course = Course::of(request, &evaluation)?;
        let remarks = request.doubts(&evaluation).map_err(PlanFailure::from)?;
        let result = match target.form {
            Form::Json => document.json(),
            Form::Html => {
                judged_page(title, &joints, (&course, &above), request.setup.arm().chain.tool_name())
            }
            _ => {
                let judged = judged_document(title, &joints, &evaluation, &above);
                target.text(&self.noted(request, judged, !evaluation.broken().is_empty()).remarked(&remarks))
            }
        };
        self.figures.write(console, target, || motion_figures(&joints, &course))?;
        let outcome = console.finish(target, &result, &remarks, &[])?;
        Ok(if evaluation.broken().is_empty() { outcome } else { Outcome::LimitBroken })
    }

    fn search(
        &self,
        request: &PlanRequest,
        target: &Target<'_>,
        console: &mut Console<'_>,
    ) -> Result<Outcome, CliError> {
        let Found { planned, document, algorithm, options } = self.found(request, console)?;
        let (title, ceilings) = (&request.task.title, &request.task.ceilings);
        let course = Course::of(request, &planned.chosen)?;
        let result = match target.form {
            Form::Json => document.json(),
            Form::Html => {
                let of_front = Course::of_front(request, &planned)?;
                let tool = request.setup.arm().chain.tool_name();
                let courses = Courses {
                    chosen: &course,
                    of_front: &of_front,
                    tool,
                    ceilings,
                    of_sample_arm: request.is_of_sample_arm(),
                    task: &self.task,
                };
                words::page(&document, &options, ceilings, &planned, &courses)
            }
            _ => target.text(&self.noted(
                request,
                words::document(title, algorithm, &options, ceilings, &planned),
                false,
            )),
        };
        self.figures.write(console, target, || words::figures(&document, &course))?;
        console.finish(target, &result, &planned.remarks, &[])
    }

    /// Searches with a progress bar and writes the chosen plan.
    pub(super) fn found(&self, request: &PlanRequest, console: &mut Console<'_>) -> Result<Found, CliError> {
        let (title, options) = (&request.task.title, self.options());
        let algorithm = NamedAlgorithm::find(&self.search.algorithm).map_or("", |named| named.title);
        let mut watch = Watch::new(self, &options);
        let planned = run(request, &options, |progress| watch.see(progress));
        watch.bar.finish_and_clear();
        let planned = match planned {
            Ok(planned) => planned,
            Err(failure) => return Err(self.explained(request, failure, console)?),
        };
        let document = PlanDocument::searched(title, algorithm, &options, &planned);
        let provenance = [
            ("algorithm", algorithm.to_owned()),
            ("seeded", options.search.seeded.to_string()),
            ("seed", options.search.seed.to_string()),
            ("evaluations", planned.evaluations.to_string()),
            ("generations", planned.generations.to_string()),
        ];
        let provenance = BTreeMap::from(provenance.map(|(key, value)| (key.to_owned(), value)));
        self.write_log(request, &document, provenance)?;
        Ok(Found { planned, document, algorithm, options })
    }

    /// The document, with where the log is if there is one.
    fn noted(&self, request: &PlanRequest, document: Document, breaks: bool) -> Document {
        match self.log() {
            Some(log) if breaks => document.with_above_remarks(next::broken_written(log)),
            Some(log) => document.with_above_remarks(next::plan_written(log, request.is_of_sample_arm())),
            None => document,
        }
    }

    /// The failure in the task's own terms; with `--json` its nearest plan is printed.
    fn explained(
        &self,
        request: &PlanRequest,
        failure: PlanFailure,
        console: &mut Console<'_>,
    ) -> Result<CliError, CliError> {
        let joints = request.setup.joint_names();
        let (evaluation, mut lines) = match &failure {
            PlanFailure::Infeasible { nearest, stopping_s, longest_s } => {
                let mut lines = broken_lines((&request.task, &joints), *longest_s, nearest);
                lines.extend(stopping_s.map(|stopping_s| {
                    format!("a plan of {stopping_s:.2} s that stops at every key point keeps them: give each dwell_s = 0")
                }));
                (nearest, lines)
            }
            PlanFailure::Ceilings { nearest } => {
                let longest_s = request.task.interval_s[1];
                (nearest, ceiling_lines(&request.task.ceilings, &joints, (longest_s, nearest)))
            }
            _ => return Ok(failure.into()),
        };
        // What swings or weighs too much does so in any shape, unless some plan is known that keeps it.
        let hopeful = match &failure {
            PlanFailure::Infeasible { nearest, stopping_s, longest_s } => {
                stopping_s.is_some() || longest_s.is_some() || nearest.slower().is_some()
            }
            _ => true,
        };
        if self.options().shape != Shaping::Timing {
            lines.push("no free shape was found that keeps them, either".to_owned());
        } else if hopeful {
            lines.push(
                "with --shape free the curve between the key points is sought, too: it may keep them"
                    .to_owned(),
            );
        }
        if self.form() == Form::Json {
            let document = PlanDocument::evaluated(&request.task.title, &joints, evaluation, false);
            console.print(&document.json())?;
        }
        Ok(CliError::failed(format!("{failure}; what comes nearest:\n  {}", lines.join("\n  "))))
    }

    fn write_log(
        &self,
        request: &PlanRequest,
        document: &PlanDocument,
        provenance: BTreeMap<String, String>,
    ) -> Result<(), CliError> {
        let Some(path) = self.log() else { return Ok(()) };
        let entry = &document.chosen.entry;
        let motion = request.setup.motion_through(&entry.times_s, &entry.via).map_err(PlanFailure::from)?;
        let log = PlanLog {
            plan: Steps::Motion(&motion, &document.joints),
            command: None,
            arm: Some(&request.setup.arm().chain),
            trajectory: None,
            carried: &Carried::default().with_plan(&request.files, document).with_provenance(provenance),
            rate_hz: self.rate,
            points_hz: request.setup.points_hz(&motion),
        };
        write_file(path, &log.bytes()?)
    }
}
