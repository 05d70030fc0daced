//! A run in eight lines: where, how far off, how late, and what to type next.

use super::{
    method::method,
    resting::at_rest,
    steps::{LEARNT, fitted, named, replanned, told, without, words},
    tables::{self, rate, saturates, stray, verdicts},
    together::Together,
    tool, why,
};
use crate::{
    math::median,
    render::{
        fit::supply,
        kit::{
            Block, Document, Fact, Id, Section, Sentence, argument, command, counted, fact, late, mm, ms,
            starts_of,
        },
        metric::position,
        next::as_one,
    },
    replay::{JointReplay, Replay, Transition},
    workflow::report::{
        Report, Uncorrectable,
        advice::{Advice, advice},
    },
};

/// A start that is later than most by this factor and this time, s, is named.
const FAR_LATER: f64 = 2.0;
const SOON_S: f64 = 0.2;

/// What a reader wants to know first; how the numbers are made too, if that is to be explained.
pub(crate) fn answer(report: &Report, explain: bool) -> Document {
    let replay = &report.replay;
    let run = format!(
        "{:.1} s, {}{}",
        report.source.duration_s,
        counted(report.alignment.len(), "joint"),
        rate(report)
    );
    let mut facts = vec![fact("run", run)];
    facts.extend(at_tool(report));
    facts.extend(report.fault.as_ref().map(|fault| fact("fault", told(fault).join(". "))));
    facts.extend(worst(report));
    facts.extend(why(report));
    facts.extend(starts(replay));
    // What joints do while they are starved is the supply's.
    let starved = report.supply.as_ref().map(|found| fact("supply", supply(found)));
    facts.extend(starved.or_else(|| astray(report)));
    facts.extend(whole(replay));
    facts.extend(verdicts(report).iter().map(|verdict| fact("limit", verdict.to_string())));
    facts.extend(doubts(report));
    let (aim, lines) = next(report);
    let next =
        Section::plain(Id::NEXT, [Sentence::advice(aim)]).with_all(lines.into_iter().map(Block::Command));
    let mut document = Document { facts, ..Document::titled(report.logs.join(", ")) }.with(next);
    document.sections.extend(method(report).filter(|_| explain));
    document
}

fn at_tool(report: &Report) -> Option<Fact> {
    let Some(found) = report.tool.found() else {
        let why = report.tool.why_not()?;
        return Some(fact("tool", format!("not known: {why}")));
    };
    let worst = &found.worst;
    let end = found
        .end()
        .map_or(String::new(), |end| format!(", {} mm at rest at the end", mm(end.deviation.error_m)));
    let cause = tool::main_cause(&worst.deviation).map_or(String::new(), |cause| format!("; {cause}"));
    Some(fact("tool", format!("{} mm off at {:.1} s{end}{cause}", mm(worst.deviation.error_m), worst.time_s)))
}

fn worst(report: &Report) -> Option<Fact> {
    let none = || report.replay.transitions.is_empty().then(|| fact("starts", "no planned start from rest"));
    let Some(worst) = report.worst() else { return none() };
    let leaves = match worst.onset_delay_s {
        Some(delay_s) => format!("leaves {}{}", late(delay_s), tables::wide(worst)),
        None => "has no start that can be timed".to_owned(),
    };
    let off = position(worst.joint_kind, worst.peak_error);
    let told =
        format!("{} {leaves} at {:.1} s; its error peaks at {off}", worst.joint, worst.planned_onset_s);
    Some(fact("worst", told))
}

fn why(report: &Report) -> Option<Fact> {
    if let Err(reason) = report.why.as_ref()? {
        return Some(fact("why", format!("not told: {reason}")));
    }
    let start = why::of(report, &report.worst()?.id)?;
    Some(fact("why", why::phrase(start)))
}

fn starts(replay: &Replay) -> Option<Fact> {
    let delays: Vec<f64> = replay.transitions.iter().filter_map(|t: &Transition| t.onset_delay_s).collect();
    let all = replay.transitions.len();
    if all == 0 {
        return None;
    }
    let never: usize = replay.joints.iter().map(|joint| joint.unanswered_starts).sum();
    let never = if never == 0 { String::new() } else { format!("; {never} never answered") };
    let half = match delays.as_slice() {
        [] => String::new(),
        _ => format!(", half of them more than {}", late(median(delays.clone()))),
    };
    let latest = latest(replay, median(delays.clone()));
    Some(fact("starts", format!("{} of {all} timed{half}{latest}{never}", delays.len())))
}

/// The latest start, where it is not the one with the largest error and later by far than most.
fn latest(replay: &Replay, usual_s: f64) -> String {
    let timed = replay.transitions.iter().filter_map(|t| Some((t.onset_delay_s?, t)));
    let Some((delay_s, start)) = timed.max_by(|a, b| a.0.total_cmp(&b.0)) else { return String::new() };
    let worst = replay.worst_first().first().map(|worst| worst.id.clone());
    if worst.is_some_and(|id| id == start.id) || delay_s < FAR_LATER * usual_s.max(0.0) + SOON_S {
        return String::new();
    }
    format!("; {} at {:.1} s by {} ms", start.joint, start.planned_onset_s, ms(delay_s))
}

/// Joints of which only one moves, itself or its plan, and those that do not rest with it.
fn astray(report: &Report) -> Option<Fact> {
    let replay = &report.replay;
    let said =
        |joint: &JointReplay| if joint.plan_moves == joint.moves { None } else { stray(report, joint) };
    let astray = replay.joints.iter().filter_map(said);
    let saturated = report.saturated();
    let slow = |joint: &JointReplay| saturated.iter().any(|one| one.joint == joint.name);
    let others = replay.joints.iter().filter(|joint| said(joint).is_none() && !slow(joint));
    let resting = others.flat_map(|joint| at_rest(replay, joint));
    let found: Vec<String> = astray.chain(saturated.iter().map(saturates)).chain(resting).collect();
    let more = match found.len() {
        0 | 1 => String::new(),
        all => format!(" And {} more.", counted(all - 1, "such joint")),
    };
    Some(fact("joint", format!("{}{more}", found.first()?)))
}

fn whole(replay: &Replay) -> Option<Fact> {
    let of = |all: &Together| {
        let error = all.run.tracking_error?;
        let lag = all.mostly_lag().map_or(String::new(), |_| format!("; mostly {}", all.shift()));
        let name = if all.name().is_empty() { String::new() } else { format!(" of {}", all.name()) };
        Some(format!(
            "{} RMS{name} over the run, {} at most{lag}",
            position(all.kind, error.rms),
            position(all.kind, error.peak)
        ))
    };
    let found: Vec<String> = Together::all(replay).iter().filter_map(of).collect();
    (!found.is_empty()).then(|| fact("error", found.join("; ")))
}

/// How many doubts about the data there are, and the first.
fn doubts(report: &Report) -> Option<Fact> {
    let remarks = report.remarks.as_slice();
    let first = report.remarks.gravest()?;
    let more = match remarks.len() - 1 {
        0 => String::new(),
        more => format!(" (and {more} more: `report` lists them)"),
    };
    Some(fact("doubt", format!("{} x{}: {}{more}", first.code.name(), first.count, first.message)))
}

/// The most urgent step as commands, and what they are for.
fn next(report: &Report) -> (String, Vec<String>) {
    let names = named(report);
    let (joined, log) = as_one(&report.paths);
    let of_one = |line: String| joined.iter().cloned().chain([line]).collect();
    let reported = || vec![command(&["report", &names])];
    let steps = advice(report);
    let urgent = steps.iter().find(|step| !matches!(step, Advice::SetLimits | Advice::Compare));
    match urgent {
        Some(Advice::SeeTo(fault)) => (
            format!("{}: see to that first. What the run shows:", told(fault)[0]),
            vec![without(fault, report)],
        ),
        Some(step @ Advice::LeaveIt { .. }) => (words(step, "", false), reported()),
        Some(Advice::ClearDoubts(_)) => {
            ("To see the doubts about the data, which come first:".to_owned(), reported())
        }
        Some(Advice::FreeJoint { joint, unanswered, starts, reversals }) => (
            format!(
                "{joint} leaves {unanswered} of {} unanswered. To see which:",
                starts_of(*starts, *reversals)
            ),
            reported(),
        ),
        Some(Advice::EaseStarts { fits: true, .. } | Advice::ShiftCommand { fits: true, .. })
            if report.holds_task =>
        {
            let learns = report.promised.is_some();
            let made = "To make a command that compensates what this run shows, at half strength first";
            (format!("{}:", if learns { LEARNT } else { made }), of_one(replanned(&log, learns)))
        }
        Some(
            Advice::EaseStarts { fits: true, .. }
            | Advice::ShiftCommand { fits: true, .. }
            | Advice::NotCorrected { why: Uncorrectable::Identifies, fits: true },
        ) => ("To learn lag, dead band and limits of the machine from it:".to_owned(), of_one(fitted(&log))),
        Some(Advice::RecordStarts) => (
            "To see what the log holds:".to_owned(),
            vec![command(&["info", &report.paths.first().map(argument).unwrap_or_default()])],
        ),
        _ => ("To see every start and joint:".to_owned(), reported()),
    }
}
