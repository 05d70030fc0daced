//! What to do after a comparison: a sentence for each step, and what to type.

use std::path::PathBuf;

use crate::{
    render::kit::{Sentence, argument, command, counted, reading},
    workflow::compare::{Comparison, Idle, Verdict},
};

/// The steps; lines name the logs of both sides as the caller did and read them with the same options.
pub(super) fn steps(
    comparison: &Comparison,
    [before, after]: [&[PathBuf]; 2],
    read: &[String],
) -> Vec<(Sentence, Option<String>)> {
    let named = |logs: &[PathBuf], k: usize| logs.get(k).map(argument);
    let newest = after.last().map(argument).unwrap_or_default();
    let report = || command(&["report", &newest]);
    let again = |more: &[&str]| {
        let sides = [named(before, 0), named(after, 0)].into_iter().flatten();
        let mut words: Vec<String> = std::iter::once("compare".to_owned()).chain(sides).collect();
        for (option, logs) in [("--more-before", before), ("--more-after", after)] {
            words.extend(logs.iter().skip(1).flat_map(|log| [option.to_owned(), argument(log)]));
        }
        words.extend(more.iter().map(|word| (*word).to_owned()));
        command(&words.iter().map(String::as_str).collect::<Vec<_>>())
    };
    let mut steps: Vec<(String, Option<String>)> = Vec::new();
    if !comparison.remarks.is_empty() {
        let kinds = counted(comparison.remarks.as_slice().len(), "remark");
        steps.push((format!("Clear the doubts about the data first: {kinds} below."), None));
    }
    steps.push(match (comparison.idle(), comparison.verdict) {
        (Some(Idle::SameRun), _) => {
            ("Give the logs of two runs: one before the change, one after it.".to_owned(), None)
        }
        (Some(Idle::NoPair), _) => {
            ("Give two runs of one plan. What the run after holds, this shows:".to_owned(), Some(report()))
        }
        (None, Verdict::Smaller) => {
            ("Keep the change. What error is left, and what to do about it:".to_owned(), Some(report()))
        }
        (None, Verdict::Larger) => (
            "Take the change back, or find out what else differs. Where the error arises now:".to_owned(),
            Some(report()),
        ),
        (None, Verdict::Mixed) => {
            let few = "Look at the few transitions that changed most against the others, in the table below. Where the error arises after the change:";
            (few.to_owned(), Some(report()))
        }
        (None, Verdict::NotShown | Verdict::Equal | Verdict::TooFew) => (
            "See whether it was worth it: where the error arises after the change:".to_owned(),
            Some(report()),
        ),
    });
    let by_runs = comparison.summaries.iter().any(|summary| summary.by_runs.is_some());
    if comparison.idle().is_none() && !by_runs {
        let more = "Run the task again, before and after: three runs a side tell what differs from run to run, such as oil and load:";
        let line = again(&["--more-before", "RUN_BEFORE", "--more-after", "RUN_AFTER"]);
        steps.push((more.to_owned(), Some(line)));
    }
    if comparison.idle().is_none() && comparison.gates.is_empty() {
        let limits = "Say what is good enough: limits (--min-peak-reduction-percent and others) make the verdict and the exit code:";
        steps.push((limits.to_owned(), Some(again(&["--min-peak-reduction-percent", "20"]))));
    }
    let line = |line: Option<String>| line.map(|line| reading(&line, read));
    steps.into_iter().map(|(step, typed)| (Sentence::Advice(step), line(typed))).collect()
}
