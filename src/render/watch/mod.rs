//! The words of `watch`.

mod page;

pub(crate) use page::index;

use super::{
    kit::{Document, Id, NONE, Section, Sentence, counted, late, ms, optional},
    metric::position,
};
use crate::{
    text::harmless,
    workflow::watch::{Run, RunJoint, Verdict, Watched},
};

/// A log that was reported, in a line, whatever is in its name.
pub(crate) fn line(run: &Run) -> String {
    said(run).chars().map(harmless).chain(['\n']).collect()
}

fn said(run: &Run) -> String {
    let name = match &run.machine {
        Some(machine) => format!("{machine} {}", run.name()),
        None => run.name().to_owned(),
    };
    let Some(page) = &run.page else {
        return format!("{name}: FAILED: {}", run.error.as_deref().unwrap_or_default().replace('\n', " "));
    };
    let remarks =
        if run.remarks > 0 { format!(", {}", counted(run.remarks, "remark")) } else { String::new() };
    format!("{}  {name}: {}, {}{remarks}  {page}", began(run), found(run), verdict(run.verdict))
}

fn began(run: &Run) -> String {
    run.started_at.as_deref().map_or(NONE.to_owned(), |at| at.trim_end_matches('Z').replace('T', " "))
}

/// Where it was off, and how late.
fn found(run: &Run) -> String {
    let Some(worst) = run.worst() else { return "no joint".to_owned() };
    let late =
        run.latest().and_then(|joint| Some(format!("; {} {}", joint.joint, late(joint.largest_delay_s?))));
    let late = late.unwrap_or_default();
    let never = match run.unanswered_starts {
        0 => String::new(),
        some => format!(", {} never answered", counted(some, "start")),
    };
    format!("{} {} off{late}{never}", worst.joint, peak(worst))
}

fn peak(joint: &RunJoint) -> String {
    position(joint.kind, joint.peak)
}

fn delay(delay_s: Option<f64>) -> String {
    optional(delay_s, |delay_s| format!("{} ms", ms(delay_s)))
}

fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Kept => "kept",
        Verdict::NotKept => "NOT KEPT",
        Verdict::NoLimits => "no limits set",
        Verdict::Failed => "failed",
    }
}

/// What is waited for, on a terminal.
pub(crate) fn waiting(reported: usize, open: usize) -> String {
    let open = if open > 0 { format!(", {open} not whole yet") } else { String::new() };
    format!("{} reported{open}; Ctrl-C ends", counted(reported, "log"))
}

/// Where a browser finds the index.
pub(crate) fn served(address: &str) -> String {
    format!("{address} shows the index")
}

/// That sources cannot be looked at.
pub(crate) fn trouble(why: &str) -> String {
    format!("looked in vain, and again soon: {why}")
}

pub(crate) fn watched(watched: &Watched) -> Document {
    let not_kept = match watched.not_kept {
        0 => String::new(),
        some => format!(", {some} of them over a limit"),
    };
    let open = match watched.open {
        0 => String::new(),
        some => format!(", {} not whole yet", counted(some, "log")),
    };
    let text = format!(
        "{} reported now{not_kept}{open}; {} shows all.",
        counted(watched.reported, "log"),
        watched.index.display()
    );
    Document::default()
        .with(Section::plain(Id::SUMMARY, [Sentence::finding(text)]))
        .remarked(&watched.remarks)
}
