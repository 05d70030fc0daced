//! What a reader sees first: verdict, worst transition, where the error arises, what to do next.

use maud::{Markup, html};

use super::{
    tables::{lag_words, mostly_lag, verdicts, worst_sentence},
    tool_page::tool_card,
};
use crate::{
    render::{
        kit::{
            Sentence, argument, clean, command, counted, ms,
            page::{
                card, next_steps,
                strip::{Row, bars},
                verdict,
            },
            probability,
        },
        metric::{on_paper, position},
    },
    replay::Verdict,
    series::JointKind,
    workflow::report::{
        Report,
        advice::{Advice, advice},
    },
};

pub(super) fn summary(report: &Report) -> Markup {
    let kept: Vec<bool> = report.gates.iter().map(|gate| gate.kept).collect();
    let lines: Vec<String> = verdicts(report).iter().map(Sentence::to_string).collect();
    let (limit, enough) = match report.replay.kind() {
        JointKind::Turns => ("--max-transition-peak-deg", "0.5"),
        JointKind::Slides => ("--max-transition-peak-mm", "5"),
    };
    let steps: Vec<Sentence> =
        advice(report).iter().map(|step| words(step, limit)).map(Sentence::Advice).collect();
    html! {
        div class="cards" {
            (verdict(&kept, &lines, &format!("{limit} {enough}")))
            (tool_card(&report.tool))
            (worst(report))
            (place_of_error(report))
            (whole_run(report))
        }
        (next_steps(&steps))
    }
}

fn worst(report: &Report) -> Markup {
    let Some(worst) = report.replay.worst_first().into_iter().next() else {
        let body = html! { p { "No planned start from rest was found." } };
        return card("", "Worst transition", "None", &body);
    };
    let [from, to] = [worst.planned_onset_s - 0.5, worst.window_s[1] + 0.5];
    let body = html! {
        p { (clean(&worst_sentence(worst))) }
        button type="button" data-from=(format!("{from:.3}")) data-to=(format!("{to:.3}")) data-joint=(clean(&worst.joint)) {
            "Show it"
        }
    };
    let headline =
        format!("{}: {} of {}", position(worst.joint_kind, worst.peak_error), worst.kind.name(), worst.joint);
    card("", "Worst transition", &headline, &body)
}

/// Events that the test needs to tell, nearly.
const NEEDED: usize = 6;

fn place_of_error(report: &Report) -> Markup {
    let Some(c) = &report.replay.whole_run.concentration else {
        let body = html! { p { "No plan moves, or some joints turn and some slide." } };
        return card("", "Where the error arises", "Cannot be told", &body);
    };
    let lag = lag_words(&report.replay);
    let events = c.test.map_or(0, |test| test.inside_count);
    let undecided = if events < NEEDED {
        format!("Not enough starts to tell ({events}; {NEEDED} are needed)")
    } else {
        "No clear difference".to_owned()
    };
    let headline = match c.verdict {
        _ if mostly_lag(&report.replay).is_some() => "Mostly lag",
        Verdict::Transitions => "In the transitions",
        Verdict::Elsewhere => "Outside the transitions",
        Verdict::Undecided => &undecided,
    };
    let body = html! {
        (concentration_bars(report))
        @if let Some(lag) = lag { p { (lag) } }
        p {
            (format!(
                "{:.0} % of the squared error in {:.0} % of the time{}",
                100.0 * c.squared_error_share_inside,
                100.0 * c.time_share_inside,
                c.test.map_or(String::new(), |test| format!(" (p = {})", probability(test.p_value)))
            ))
        }
    };
    card("", "Where the error arises", headline, &body)
}

/// Root mean square errors inside and outside.
pub(super) fn concentration_bars(report: &Report) -> Markup {
    let Some(c) = &report.replay.whole_run.concentration else { return html! {} };
    let kind = report.replay.kind();
    let row = |name: &str, error: f64, strong| Row {
        name: name.to_owned(),
        value: on_paper(kind, error),
        interval: None,
        text: position(kind, error),
        strong,
    };
    let mut rows = vec![row("inside", c.rms_inside, true), row("elsewhere", c.rms_outside, false)];
    rows.extend(c.rms_outside_moving.map(|error| row("elsewhere, moving", error, false)));
    bars(&rows)
}

fn whole_run(report: &Report) -> Markup {
    let whole = &report.replay.whole_run;
    let kind = report.replay.kind();
    let headline =
        whole.tracking_error.map_or("-".to_owned(), |error| format!("{} rms", position(kind, error.rms)));
    let body = html! {
        @if let Some(error) = whole.tracking_error {
            p { (format!("peak {} at {:.2} s; 95 % of the time below {}", position(kind, error.peak), error.peak_time_s, position(kind, error.p95))) }
        }
        @if let Some(path) = whole.path_error {
            p { (format!("distance to the planned path, whatever the time, norm over joints: rms {}, peak {}; rms {} with time", position(kind, path.rms), position(kind, path.peak), position(kind, path.timed_rms))) }
        }
        @if !report.remarks.is_empty() {
            p { a href="#remarks" { (counted(report.remarks.as_slice().len(), "remark") + " on the data") } }
        }
    };
    card("", "Whole run, all joints", &headline, &body)
}

/// `replan` of this log with its plan kept.
fn replan(log: Option<&str>) -> String {
    let log = log.filter(|log| !log.is_empty()).map_or("LOG".to_owned(), argument);
    command(&["replan", &log, "--keep-plan", "-o", "NEXT"])
}

fn half_late(delay_s: Option<f64>) -> String {
    delay_s.map_or(String::new(), |s| format!(" (half of all timed starts are more than {} ms late)", ms(s)))
}

/// `limit`: an option that sets one for the kind of the joints.
fn words(step: &Advice, limit: &str) -> String {
    match step {
        Advice::ClearDoubts(kinds) => format!(
            "Clear the doubts about the data first: {} below.",
            counted(*kinds, "remark")
        ),
        Advice::FreeJoint { joint, unanswered, starts } => format!(
            "Find out why {joint} leaves {unanswered} of {} unanswered: enable signals, brakes, a dead band wider than \
             the command, a sensor that stands still.",
            counted(*starts, "planned start")
        ),
        Advice::ShiftCommand { joint, lag_s, log, fits } => format!(
            "The error is mostly lag, {joint} first ({} ms): speed feed-forward, or sending the command that much earlier, does \
             most, and work on starts little.{}",
            ms(*lag_s),
            if *fits {
                format!(" {} makes such a command from this log.", replan(log.as_deref()))
            } else {
                String::new()
            }
        ),
        Advice::EaseStarts { joint, delay_s, fits: false, .. } => {
            format!("Work on starts from rest, {joint} first{}.", half_late(*delay_s))
        }
        Advice::EaseStarts { joint, delay_s, log, gentler, .. } => format!(
            "Work on starts from rest, {joint} first{}: {} makes a command from this log \
             that compensates dead band and lag{}",
            half_late(*delay_s),
            replan(log.as_deref()),
            if *gentler {
                "; without --keep-plan, a gentler plan too."
            } else {
                ". The log does not hold the task of its plan: a gentler plan needs that too (--task)."
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
        Advice::SetLimits => {
            format!("Say what is good enough: limits ({limit} and others) make the verdict and the exit code.")
        }
        Advice::Compare => {
            "After any change, run the same task again: hydrotrace compare BEFORE AFTER tells whether it helped.".to_owned()
        }
    }
}
