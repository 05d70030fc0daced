//! `hydrotrace-bench`: runs one study, and writes what it found.

mod args;

use std::{
    error::Error,
    fs, io,
    io::Write,
    path::{Path, PathBuf},
    process::ExitCode,
};

use clap::Parser;
use hydrotrace::{
    atomic_file::{AtomicError, write_atomically},
    plant::Parameters,
    render::kit::{Document, markdown, text},
};
use hydrotrace_bench::{
    detector,
    learning::{self, Teacher},
    problems,
    study::{self, Form, Study, curve_svg, curves_csv, document, front_csv},
    tasks,
};
use indicatif::{ProgressBar, ProgressStyle};

use args::{Args, Format, StudyArgs};

fn main() -> ExitCode {
    match run(&Args::parse().study) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            let mut cause = error.source();
            while let Some(inner) = cause {
                eprintln!("  because: {inner}");
                cause = inner.source();
            }
            ExitCode::FAILURE
        }
    }
}

fn run(study: &StudyArgs) -> Result<(), Box<dyn Error>> {
    match study {
        StudyArgs::Detector(args) => {
            let bar = progress(detector::conditions().len() as u64, "conditions");
            let found = detector::run(args.seed, args.runs, || bar.inc(1));
            bar.finish_and_clear();
            show(&args.format, || found.json(), || found.document())
        }
        StudyArgs::Learning(args) => {
            let machines = if args.machine.is_empty() {
                Parameters::preset_names().map(str::to_owned).collect()
            } else {
                args.machine.clone()
            };
            let teacher = if args.proportional { Teacher::Proportional } else { Teacher::Learn };
            let seeds = (args.seed..args.seed + args.seeds).collect();
            let (jobs, runs) = (args.plan.clone(), args.runs);
            let inputs = learning::Inputs { machines, jobs, seeds, runs, teacher };
            let bar =
                progress((inputs.machines.len() * inputs.jobs.len() * inputs.seeds.len()) as u64, "cells");
            let found = learning::run(&inputs, || bar.inc(1))?;
            bar.finish_and_clear();
            if args.json {
                return Ok(write_out(&serde_json::to_string(&found)?)?);
            }
            write_out(&learning::table(&found))?;
            Ok(())
        }
        StudyArgs::Moea(args) => {
            let shared = args.shared.inputs("msops2", [5_000, 20_000, 50_000], args.front.is_some());
            make(&[&args.front, &args.shared.curves])?;
            let inputs = problems::inputs(&args.problems(), args.operators(), shared);
            let bar = progress(inputs.runs(), "runs");
            let found = study::run(&inputs, || bar.inc(1))?;
            bar.finish_and_clear();
            if let Some(folder) = &args.front {
                for front in &found.fronts {
                    write(folder, &format!("{}.csv", front.name), &front_csv(front))?;
                }
            }
            finish(&problems::FORM, &found, args.shared.curves.as_deref(), &args.shared.format)
        }
        StudyArgs::Plan(args) => {
            let shared = args.shared.inputs("nsga2", [1_000, 5_000, 20_000], false);
            let found = args.tasks().into_iter().map(tasks::find).collect::<Result<Vec<_>, _>>()?;
            make(&[&args.shared.curves])?;
            let bar = progress(found.len() as u64, "reference fronts");
            let inputs = tasks::inputs(found, args.reference, shared, || bar.inc(1))?;
            bar.finish_and_clear();
            let bar = progress(inputs.runs(), "searches");
            let found = tasks::run(&inputs, || bar.inc(1))?;
            bar.finish_and_clear();
            finish(&tasks::FORM, &found, args.shared.curves.as_deref(), &args.shared.format)
        }
    }
}

/// Makes folders to write to: before the work, so that a folder that cannot be made does not cost it.
fn make(folders: &[&Option<PathBuf>]) -> Result<(), AtomicError> {
    for path in folders.iter().copied().flatten() {
        let failed = |source| AtomicError::Io { action: "create the folder", path: path.clone(), source };
        fs::create_dir_all(path).map_err(failed)?;
    }
    Ok(())
}

/// Drawn on standard error, and not at all if that is no terminal.
fn progress(steps: u64, noun: &str) -> ProgressBar {
    let bar = ProgressBar::new(steps);
    let template = format!("{{bar:30}} {{pos}}/{{len}} {noun}, {{eta}} left");
    if let Ok(style) = ProgressStyle::with_template(&template) {
        bar.set_style(style);
    }
    bar
}

fn finish(form: &Form, found: &Study, curves: Option<&Path>, format: &Format) -> Result<(), Box<dyn Error>> {
    if let Some(folder) = curves {
        write(folder, "curves.csv", &curves_csv(form, &found.curves))?;
        for same in found.curves.chunk_by(|a, b| a.subject == b.subject) {
            let Some(first) = same.first() else { continue };
            write(folder, &format!("{}.svg", first.subject.to_lowercase()), &curve_svg(form, same))?;
        }
    }
    show(format, || found.json(), || document(form, found))
}

/// Writes the findings to standard output. A reader that goes away is no failure.
fn show(
    format: &Format,
    json: impl Fn() -> String,
    document: impl Fn() -> Document,
) -> Result<(), Box<dyn Error>> {
    let shown = match format {
        Format { json: true, .. } => json(),
        Format { markdown: true, .. } => markdown(&document()),
        Format { .. } => text(&document()),
    };
    Ok(write_out(&shown)?)
}

/// Writes to standard output. A reader that goes away is no failure.
fn write_out(text: &str) -> io::Result<()> {
    match io::stdout().write_all(text.as_bytes()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(error),
        _ => Ok(()),
    }
}

fn write(folder: &Path, name: &str, text: &str) -> Result<(), Box<dyn Error>> {
    write_atomically(&folder.join(name), |file| Ok::<(), Box<dyn Error>>(file.write_all(text.as_bytes())?))
}
