//! What to do next: a sentence for each step, and what to type.

use crate::{
    render::{
        kit::{Sentence, argument, command, counted, late, ms, reading, starts_of},
        metric::position,
        next::as_one,
    },
    series::JointKind,
    workflow::report::{
        Fault, Leaves, Report, Uncorrectable,
        advice::{Advice, advice},
    },
};

/// The steps, the most urgent first; lines name the log as the caller did and read it with the same options.
pub(super) fn steps(report: &Report, read: &[String]) -> Vec<(Sentence, Option<String>)> {
    let worst = report.worst().map_or(report.replay.kind(), |worst| worst.joint_kind);
    let limit = match worst {
        JointKind::Turns => ["--max-transition-peak-deg", "0.5"],
        JointKind::Slides => ["--max-transition-peak-mm", "5"],
    };
    let learns = report.promised.is_some();
    // Files are joined once, before the first line that needs them so.
    let mut joins = true;
    let mut line = |step: &Advice| {
        let lines = lines(step, report, limit, learns);
        let from = usize::from(lines.len() > 1 && !joins);
        joins &= lines.len() < 2;
        let lines: Vec<String> = lines[from..].iter().map(|line| reading(line, read)).collect();
        (!lines.is_empty()).then(|| lines.join(" && "))
    };
    let said = |step: &Advice| Sentence::Advice(words(step, limit[0], learns));
    advice(report).iter().map(|step| (said(step), line(step))).collect()
}

/// What to type for a step, if that does it.
fn lines(step: &Advice, report: &Report, limit: [&str; 2], learns: bool) -> Vec<String> {
    let (joined, log) = as_one(&report.paths);
    let line = match step {
        Advice::ShiftCommand { fits: true, .. } | Advice::EaseStarts { fits: true, .. } => {
            replanned(&log, learns)
        }
        Advice::SetLimits => return vec![command(&["report", &named(report), limit[0], limit[1]])],
        Advice::SeeTo(fault @ Fault::Stopped { .. }) => return vec![without(fault, report)],
        Advice::NotCorrected { why: Uncorrectable::Wraps { joint, .. }, .. } => {
            return vec![command(&["report", &named(report), "--continuous", &argument(joint)])];
        }
        Advice::NotCorrected { fits: true, .. } => fitted(&log),
        Advice::Compare => command(&["compare", &log, "NEXT_RUN"]),
        _ => return Vec::new(),
    };
    joined.into_iter().chain([line]).collect()
}

pub(super) fn named(report: &Report) -> String {
    report.paths.iter().map(argument).collect::<Vec<_>>().join(" ")
}

/// What shows the run, without the time in which the machine stood.
pub(super) fn without(fault: &Fault, report: &Report) -> String {
    let logs = named(report);
    match report.leaves_s(fault) {
        Some(Leaves::To(s)) => command(&["report", &logs, "--to", &format!("{s:.1}")]),
        Some(Leaves::From(s)) => command(&["report", &logs, "--from", &format!("{s:.1}")]),
        None => command(&["report", &logs]),
    }
}

/// What happened, in a few words, and more of it.
pub(super) fn told(fault: &Fault) -> [String; 2] {
    match fault {
        Fault::Stopped { from_s: None, to_s } => [
            format!("The machine stood until {:.1} s", to_s.unwrap_or_default()),
            "Its plan went on: it was not ready (pump or drive off, not enabled). Figures of the whole run count the error of that time."
                .to_owned(),
        ],
        Fault::Stopped { from_s: Some(from_s), to_s: None } => [
            format!("The machine stopped at {from_s:.1} s"),
            "Its plan went on. Figures of the whole run count the error from then on.".to_owned(),
        ],
        Fault::Stopped { from_s: Some(from_s), to_s: Some(to_s) } => [
            format!("The machine stood from {from_s:.1} to {to_s:.1} s"),
            "Its plan went on. Figures of the whole run count the error of that time.".to_owned(),
        ],
        Fault::Dead { joints, starts, .. } => {
            let (who, does, whose) = match joints.as_slice() {
                [one] => (one.clone(), "does", "Its plan does"),
                many => (listed(many), "do", "Their plans do"),
            };
            let starts = counted(*starts, "planned start");
            [format!("{who} {does} not move"), format!("{whose}: {starts}, none answered.")]
        }
    }
}

/// The first of many names, and how many more there are.
fn listed(names: &[String]) -> String {
    const MOST: usize = 4;
    let more = names.len().saturating_sub(MOST);
    let more = if more == 0 { String::new() } else { format!(" and {more} more") };
    names[..names.len().min(MOST)].join(", ") + &more
}

/// What makes a command that compensates what these logs show; `learns` says that one was sent already.
pub(super) fn replanned(logs: &str, learns: bool) -> String {
    let careful: &[&str] = if learns { &[] } else { &["--gain", "0.5"] };
    command(&[&["replan", logs, "--keep-plan"], careful, &["-o", "next.mcap"]].concat())
}

/// What learns the machine from a run.
pub(super) fn fitted(log: &str) -> String {
    command(&["fit", log, "-o", "limits.toml"])
}

/// What that does where a command was sent already.
pub(super) const LEARNT: &str =
    "The next command is learnt from this run; put the logs of the runs before it first";

fn not_corrected(why: &Uncorrectable, fits: bool) -> String {
    match why {
        Uncorrectable::Identifies => format!(
            "The plan is an identification run: its strokes show what the machine cannot follow, and no command corrects that.{}",
            if fits { " Lag, dead band and limits of the machine are learnt from it by:" } else { "" }
        ),
        Uncorrectable::Wraps { joint, at_s } => format!(
            "The plan of {joint} goes from one end of its turn to the other at {at_s:.2} s: if the joint turns on and its angles \
             wrap, say so:"
        ),
        Uncorrectable::Steps { joint, size, at_s } => format!(
            "No command is made from this log: the plan of {joint} steps by {size} at {at_s:.2} s, which no joint follows. Give it \
             ramps that it can follow.{}",
            if fits { " How fast it goes is learnt from this log by:" } else { "" }
        ),
    }
}

fn half_late(delay_s: Option<f64>) -> String {
    delay_s.map_or(String::new(), |s| format!(" (half of all timed starts are more than {})", late(s)))
}

/// `limit`: an option that sets one for the kind of the joints; `learns`: a command was sent already.
pub(super) fn words(step: &Advice, limit: &str, learns: bool) -> String {
    match step {
        Advice::ClearDoubts(kinds) => format!(
            "Clear the doubts about the data first: {} below.",
            counted(*kinds, "remark")
        ),
        Advice::SeeTo(fault @ Fault::Stopped { from_s, .. }) => {
            let (why, rest) = match from_s {
                Some(_) => ("emergency stop, fault of the controller, hold", "Up to then it did"),
                None => ("pump or drive off, not enabled", "From then on it did"),
            };
            format!("{}: find out why ({why}). No command is made from such a run. {rest}:", told(fault)[0])
        }
        Advice::SeeTo(fault @ Fault::Dead { .. }) => format!(
            "{}: look at enable signal, valve, brake and sensor before any command is made from this run.",
            told(fault)[0]
        ),
        Advice::LeaveIt { noise, error, kind } => format!(
            "Nothing is to be corrected: of an error of {} RMS at most, {} is noise of the measurement.",
            position(*kind, *error),
            position(*kind, *noise)
        ),
        Advice::NotCorrected { why, fits } => not_corrected(why, *fits),
        Advice::NoCommand(why) => format!("No command can be made from this log: {why}."),
        Advice::FreeJoint { joint, unanswered, starts, reversals } => format!(
            "Find out why {joint} leaves {unanswered} of {} unanswered: enable signals, brakes, a dead band wider than \
             the command, a sensor that stands still.",
            starts_of(*starts, *reversals)
        ),
        Advice::ShiftCommand { joint, lag_s, fits } => format!(
            "The error is mostly lag, {joint} first ({} ms): speed feed-forward, or sending the command that much earlier, does \
             most, and work on starts little.{}",
            ms(*lag_s),
            if *fits { " Such a command is made from this log by:" } else { "" }
        ),
        Advice::EaseStarts { joint, delay_s, fits: false, .. } => {
            format!("Work on starts from rest, {joint} first{}.", half_late(*delay_s))
        }
        Advice::EaseStarts { joint, delay_s, .. } if learns => {
            format!("Work on starts from rest, {joint} first{}. {LEARNT}:", half_late(*delay_s))
        }
        Advice::EaseStarts { joint, delay_s, gentler, .. } => format!(
            "Work on starts from rest, {joint} first{}. A command that compensates dead band and lag, at half strength first, {}:",
            half_late(*delay_s),
            if *gentler {
                "is made from this log by this line; without --keep-plan, a gentler plan too"
            } else {
                "is made from this log by this line; a gentler plan needs the task too, which the log does not hold (--task)"
            },
        ),
        Advice::ShortenLag { joint, lag_s } => format!(
            "Shorten the lag: {joint} follows {} ms behind throughout; speed feed-forward or a higher gain does most.",
            ms(*lag_s)
        ),
        Advice::LookOutside { joint, time_s } => format!(
            "Look at {joint} at {time_s:.2} s: the error is largest there, outside the transitions, and no lag explains it."
        ),
        Advice::RecordStarts => {
            "Record a run in which joints leave rest by plan, with the plan in the log: there is no transition to judge."
                .to_owned()
        }
        Advice::RecordWhole(broken) => format!(
            "Record from rest to rest: the plan {broken}, so that no command can be made from this log."
        ),
        Advice::SetLimits => {
            format!("Say what is good enough: limits ({limit} and others) make the verdict and the exit code:")
        }
        Advice::Compare => {
            "After any change, run the same task again and ask whether it helped:".to_owned()
        }
    }
}
