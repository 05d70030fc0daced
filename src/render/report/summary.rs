//! What a reader sees first: verdict, worst transition, where the error arises, what to do next.

use maud::{Markup, html};

use super::{
    first::{lanes, worst_start},
    resting::unanswered,
    steps::{steps, told},
    tables::{verdicts, worst_sentence},
    together::Together,
    tool_page::tool_card,
    why,
};
use crate::{
    render::{
        kit::{
            Sentence, clean, counted,
            page::{
                Plots, Shows, card, next_steps,
                strip::{Row, bars},
                verdict,
            },
            probability, some_of,
        },
        metric::{on_paper, position},
    },
    replay::{JointReplay, Verdict},
    workflow::report::{Fault, Report},
};

pub(super) fn summary(report: &Report, read: &[String], plots: &mut Plots) -> Markup {
    let kept: Vec<bool> = report.gates.iter().map(|gate| gate.kept).collect();
    let lines: Vec<String> = verdicts(report).iter().map(Sentence::to_string).collect();
    html! {
        div class="cards" {
            @if let Some(why) = report.several_runs() {
                (card("bad", "What was given", "Two runs?", &html! { p { (clean(why)) "." } }))
            }
            (verdict(&kept, &lines))
            (never(report))
            @if let Some(fault) = &report.fault {
                @let [what, more] = told(fault);
                (card("bad", "What happened", &what, &html! { p { (clean(&more)) } }))
            }
            (tool_card(&report.tool))
            (worst(report))
            @for all in Together::all(&report.replay) { (place_of_error(&all)) }
            @for all in Together::all(&report.replay) { (whole_run(report, &all)) }
        }
        (next_steps(&steps(report, read)))
        (lanes(report))
        @if let Some(chart) = worst_start(report) { (plots.place(chart)) }
    }
}

/// Joints that leave starts unanswered, the worst first: those that never move are told otherwise.
fn never(report: &Report) -> Markup {
    let dead = match &report.fault {
        Some(Fault::Dead { joints, .. }) => joints.as_slice(),
        Some(Fault::Stopped { .. }) => return html! {},
        None => &[],
    };
    let replay = &report.replay;
    let mut joints: Vec<&JointReplay> =
        replay.joints.iter().filter(|joint| !dead.contains(&joint.name)).collect();
    joints.sort_by_key(|joint| std::cmp::Reverse(joint.unanswered_starts));
    let Some(worst) = joints.first().filter(|joint| joint.unanswered_starts > 0) else { return html! {} };
    let headline =
        format!("{}: {} never answered", worst.name, some_of(worst.unanswered_starts, worst.starts, "start"));
    let lines: Vec<String> = joints.iter().filter_map(|joint| unanswered(replay, joint)).collect();
    card("bad", "Starts", &headline, &html! { @for line in lines { p { (clean(&line)) } } })
}

fn worst(report: &Report) -> Markup {
    let Some(worst) = report.worst() else {
        let body = html! { p { "No planned start from rest was found." } };
        return card("", "Worst transition", "None", &body);
    };
    let shows = Shows::around(&worst.joint, worst.window_s);
    let body = html! {
        p { (clean(&worst_sentence(worst))) }
        @if let Some(why) = why::of(report, &worst.id).map(why::phrase) { p { "Why: " (clean(&why)) } }
        button type="button" data-from=(shows.from) data-to=(shows.to) data-joint=(shows.joint) {
            "Show it"
        }
    };
    let headline =
        format!("{}: {} of {}", position(worst.joint_kind, worst.peak_error), worst.kind.name(), worst.joint);
    let label = if report.fault.is_some() { "Worst of the other transitions" } else { "Worst transition" };
    card("", label, &headline, &body)
}

/// Events that the test needs to tell, nearly.
const NEEDED: usize = 6;

fn place_of_error(all: &Together) -> Markup {
    let name = titled("Where the error arises", all);
    let Some(c) = &all.run.concentration else {
        return card("", &name, "Cannot be told", &html! { p { "No plan moves." } });
    };
    let lag = all.lag_words();
    let events = c.test.map_or(0, |test| test.inside_count);
    let undecided = if events < NEEDED {
        format!("Not enough starts to tell ({events}; {NEEDED} are needed)")
    } else {
        "No clear difference".to_owned()
    };
    let mostly = format!("Mostly {}", all.shift());
    let why = all.why_undecided(c);
    let headline = match c.verdict {
        _ if all.mostly_lag().is_some() => &mostly,
        Verdict::Transitions => "In the transitions",
        Verdict::Elsewhere => "Outside the transitions",
        Verdict::Undecided => &undecided,
    };
    let body = html! {
        (concentration_bars(all))
        @if let Some(lag) = lag { p { (lag) } }
        p {
            (format!(
                "{:.0} % of the squared error in {:.0} % of the time",
                100.0 * c.squared_error_share_inside,
                100.0 * c.time_share_inside,
            ))
            @match (why, c.test) {
                (Some(why), _) => { "; " (why) }
                (None, Some(test)) => { " (" span class="whole" { "p = " (probability(test.p_value)) } ")" }
                (None, None) => {}
            }
        }
    };
    card("", &name, headline, &body)
}

/// Root mean square errors inside and outside.
pub(super) fn concentration_bars(all: &Together) -> Markup {
    let (Some(c), kind) = (&all.run.concentration, all.kind) else { return html! {} };
    let row = |name: &str, error: f64, strong| {
        let (value, text) = (on_paper(kind, error), position(kind, error));
        Row { name: name.to_owned(), value, interval: None, text, strong }
    };
    let mut rows = vec![row("inside", c.rms_inside, true), row("elsewhere", c.rms_outside, false)];
    rows.extend(c.rms_outside_moving.map(|error| row("elsewhere, moving", error, false)));
    bars(&rows)
}

/// A heading, with the joints that are meant.
pub(super) fn titled(heading: &str, all: &Together) -> String {
    if all.name().is_empty() { heading.to_owned() } else { format!("{heading}, {}", all.name()) }
}

fn whole_run(report: &Report, all: &Together) -> Markup {
    let (whole, kind) = (all.run, all.kind);
    let headline =
        whole.tracking_error.map_or("-".to_owned(), |error| format!("{} rms", position(kind, error.rms)));
    let body = html! {
        @if let Some(error) = whole.tracking_error {
            p { (format!("peak {} at {:.2} s; 95 % of the time below {}", position(kind, error.peak), error.peak_time_s, position(kind, error.p95))) }
        }
        @if let Some(path) = whole.path_error {
            p { (format!("distance to the planned path, at any time within {:.0} s, norm over joints: rms {}, peak {}; rms {} with time", report.replay.rules.path_window_s, position(kind, path.rms), position(kind, path.peak), position(kind, path.timed_rms))) }
        }
        @if !report.remarks.is_empty() {
            p { a href="#remarks" { (counted(report.remarks.as_slice().len(), "remark") + " on the data") } }
        }
    };
    let name = match all.name() {
        "" => "Whole run, all joints".to_owned(),
        _ => titled("Whole run", all),
    };
    card("", &name, &headline, &body)
}
