//! A comparison in three lines, and its limits in one each.

use super::{kind, together, together_name};
use crate::{
    remark::Code,
    render::{
        kit::{Sentence, counted, mm, optional, percent, probability, signed},
        metric::{position, with_unit},
        promise,
    },
    replay::{Answer, ONSET_DELAY, PEAK_ERROR},
    series::JointKind,
    workflow::compare::{
        Change, Comparison, Figures, Form, GateResult, Idle, Run, Scope, Summary, TransitionPair, Verdict,
    },
};

/// Verdict, whole run, plans; then joints that call for a word, and limits.
pub(super) fn in_short(comparison: &Comparison) -> Vec<Sentence> {
    let (mut lines, idle) = (Vec::new(), comparison.idle());
    let peaks = comparison.overall(PEAK_ERROR);
    // Of one run in two forms the last digits differ by the writing.
    let tells =
        |peak: &&&Summary| peak.pairs > 0 && (idle != Some(Idle::SameRun) || peak.verdict == Verdict::Equal);
    let some = peaks.iter().filter(tells);
    lines.extend(some.map(|peak| verdict(peak, kind(comparison, &peak.scope))));
    if idle == Some(Idle::SameRun) {
        lines.insert(0, "Both sides are one and the same run: their difference says nothing.".to_owned());
    } else if lines.is_empty() {
        let what = if idle == Some(Idle::NoPair) { "Not comparable: no" } else { "No" };
        lines.push(format!("{what} transition is found in every run."));
    }
    lines.extend(joints(comparison, &peaks));
    lines.extend(of_few_runs(&peaks));
    lines.extend(measured_otherwise(comparison, &peaks));
    lines.extend(answers(comparison));
    lines.extend(at_the_tool(comparison).map(|changes| format!("At the tool: {changes}.")));
    let compares = idle != Some(Idle::NoPair);
    lines.extend(together(comparison).filter(|_| compares).filter_map(whole_run));
    lines.extend(against(comparison));
    lines.extend(rest_farther(comparison));
    lines.push(plans(comparison));
    lines.extend(comparison.after.iter().filter_map(|run| {
        let of = if comparison.after.len() > 1 { format!(" of {}", run.log) } else { String::new() };
        promise::sentence(run.promised.as_ref()?, comparison.pairs.iter().map(|pair| pair.joint_kind), &of)
    }));
    lines.into_iter().map(Sentence::Finding).chain(verdicts(comparison)).collect()
}

/// How many starts are answered on one side only: they have no delay that could be compared.
fn answers(comparison: &Comparison) -> Vec<String> {
    let never = |before: bool, after: bool| {
        let of = |pair: &&TransitionPair| {
            (pair.answer_before == Answer::Never) == before && (pair.answer_after == Answer::Never) == after
        };
        comparison.pairs.iter().filter(of).count()
    };
    let said = |count: usize, what: &str| {
        let starts = counted(count, "start");
        (count > 0).then(|| format!("{starts}: the joint {what}; such delays stand in no row."))
    };
    let lost = said(never(false, true), "followed before, and no longer does");
    let gained = said(never(true, false), "did not follow before, and does now");
    lost.into_iter().chain(gained).collect()
}

/// Joints whose own interval leaves out zero, where not all do what is said of all.
fn joints(comparison: &Comparison, peaks: &[&Summary]) -> Option<String> {
    let by_runs = peaks.iter().any(|peak| peak.by_runs.is_some());
    let clear = comparison.clear_joints();
    let said = |summary: &Summary| {
        let [low, high] = summary.interval_95?;
        let Scope::Joint(joint) = &summary.scope else { return None };
        let (dimension, kind) = (summary.measure.dimension, kind(comparison, &summary.scope));
        let shown = |value: f64| signed(value, |value| with_unit(dimension, kind, value));
        let text = format!("{joint} {} ({} to {})", shown(summary.mean_difference?), shown(low), shown(high));
        Some((if high < 0.0 { Verdict::Smaller } else { Verdict::Larger }, text))
    };
    let of = |key: &str| -> Vec<(Verdict, String)> {
        let own = clear.iter().copied().filter(|summary| summary.measure.key == key);
        own.filter_map(said).collect()
    };
    let (of_peaks, of_delays) = (of(PEAK_ERROR), of(ONSET_DELAY));
    let alike = |verdict: &Verdict| peaks.iter().all(|peak| peak.verdict == *verdict);
    let unlike = |found: &[(Verdict, String)]| found.iter().any(|(verdict, _)| !alike(verdict));
    let some = by_runs && !of_peaks.is_empty() && of_peaks.len() < comparison.joints.len();
    let tested = by_runs || !alike(&Verdict::TooFew);
    // Peaks that do what all do are said once.
    let of_peaks = if by_runs || tested && unlike(&of_peaks) { of_peaks } else { Vec::new() };
    let of_delay = if by_runs { unlike(&of_delays) } else { !of_delays.is_empty() };
    let differ = some || unlike(&of_peaks) || of_delay;
    let named = [("peak error ", of_peaks), ("start delay ", of_delays)].map(|(what, found)| {
        let each: Vec<String> = found.into_iter().map(|(_, text)| text).collect();
        (!each.is_empty()).then(|| what.to_owned() + &each.join(", "))
    });
    let named: Vec<String> = named.into_iter().flatten().collect();
    (differ && comparison.joints.len() > 1)
        .then(|| format!("By joint, where the interval clearly leaves out zero: {}.", named.join("; ")))
}

/// What a test of a run or two a side does not tell.
fn of_few_runs(peaks: &[&Summary]) -> Option<String> {
    let shown = |peak: &&&Summary| {
        matches!(peak.verdict, Verdict::Smaller | Verdict::Larger) && peak.by_runs.is_none()
    };
    peaks.iter().find(shown).map(|_| {
        "This is of the starts of these runs: it may come from what differs from run to run, such as oil and load, which interval and \
         p do not count. Three runs a side tell it apart (--more-before, --more-after)."
            .to_owned()
    })
}

/// What changed may be how it was measured.
fn measured_otherwise(comparison: &Comparison, peaks: &[&Summary]) -> Option<String> {
    let otherwise =
        comparison.remarks.as_slice().iter().find(|remark| remark.code == Code::MeasuredOtherwise)?;
    let shown = peaks.iter().any(|peak| matches!(peak.verdict, Verdict::Smaller | Verdict::Larger));
    shown.then(|| format!("That may be of the measurement, not of the machine: {}.", otherwise.message))
}

fn verdict(peak: &Summary, kind: JointKind) -> String {
    let of = match peak.scope {
        Scope::Turning => " of joints that turn",
        Scope::Sliding => " of joints that slide",
        _ => "",
    };
    let what = format!("peak error at transitions{of}");
    let shown = |error: f64| position(kind, error);
    let numbers = format!(
        "mean {} -> {}, {}{}{}",
        optional(peak.mean_before, shown),
        optional(peak.mean_after, shown),
        optional(peak.mean_difference, |d| signed(d, shown)),
        peak.relative_change.map_or(String::new(), |share| format!(" ({} %)", percent(share))),
        peak.interval_95.map_or(String::new(), |[low, high]| {
            format!(", 95 % interval {} to {}", signed(low, shown), signed(high, shown))
        }),
    );
    let over = match peak.by_runs {
        Some([before, after]) => format!("by {before} runs before and {after} after"),
        None => format!("in {}", counted(peak.events, "event")),
    };
    let counts = format!(
        "p = {}, {} {over}, {} smaller and {} larger",
        probability(peak.p_value),
        counted(peak.pairs, "pair"),
        peak.smaller,
        peak.larger
    );
    match peak.verdict {
        Verdict::Smaller => format!("The {what} became smaller: {numbers}; {counts}."),
        Verdict::Larger => format!("The {what} became larger: {numbers}; {counts}."),
        Verdict::Mixed => {
            let (most, few) =
                if peak.smaller > peak.larger { ("smaller", "larger") } else { ("larger", "smaller") };
            format!(
                "The {what} became {most} at most transitions, and so much {few} at a few that the mean says the opposite: {numbers}; {counts}."
            )
        }
        Verdict::NotShown if peak.interval_95.is_some_and(|[low, high]| low > 0.0 || high < 0.0) => format!(
            "Whether the {what} changed is open, its interval says so and the test by ranks does not: {numbers}; {counts}."
        ),
        Verdict::NotShown if peak.by_runs.is_some() => {
            format!(
                "No change of the {what} is shown, what differs from run to run could explain it: {numbers}; {counts}."
            )
        }
        Verdict::NotShown => {
            format!("No change of the {what} is shown, chance could explain it: {numbers}; {counts}.")
        }
        Verdict::Equal => {
            format!("The {what} is the same in {}; p = 1.", counted(peak.pairs, "pair"))
        }
        Verdict::TooFew => format!(
            "Not enough starts to tell whether the peak error{of} changed ({}; the smallest possible p is {}): {numbers}; {counts}.",
            counted(peak.events, "event"),
            probability(peak.least_p())
        ),
    }
}

fn whole_run(all: &Figures) -> Option<String> {
    let shown = ["rms", "peak", "standstill_rms", "path_rms"];
    let figures =
        all.changes.iter().filter(|(metric, _)| shown.contains(&metric.key)).map(|(metric, change)| {
            let share = change.ratio.map_or(String::new(), |ratio| format!(" ({} %)", percent(ratio - 1.0)));
            let show = |value: f64| with_unit(metric.dimension, all.kind, value);
            let both = change.before.zip(change.after);
            both.map(|(before, after)| format!("{} {} -> {}{share}", metric.name, show(before), show(after)))
        });
    let figures: Vec<String> = figures.flatten().collect();
    (!figures.is_empty())
        .then(|| format!("Whole run, {}: {}.", together_name(&all.scope), figures.join(", ")))
}

/// Joints that a mean over all of them hides.
fn against(comparison: &Comparison) -> Option<String> {
    let found: Vec<String> = comparison.against().iter().map(changed).collect();
    (!found.is_empty())
        .then(|| format!("Worse while others became better, by rms error: {}.", found.join(", ")))
}

/// Joints that rest elsewhere.
fn rest_farther(comparison: &Comparison) -> Option<String> {
    let found: Vec<String> = comparison.rest_farther().iter().map(changed).collect();
    (!found.is_empty()).then(|| {
        format!(
            "Farther from the plan where it rests, by rms error: {}; a zero, a load or a stop has changed, or a motion comes to its end later.",
            found.join(", ")
        )
    })
}

fn changed((own, change): &(&Figures, Change)) -> String {
    let [before, after] =
        [change.before, change.after].map(|value| optional(value, |v| position(own.kind, v)));
    let share = change.ratio.map_or(String::new(), |ratio| format!(" ({} %)", percent(ratio - 1.0)));
    format!("{} {before} -> {after}{share}", own.joint.as_deref().unwrap_or_default())
}

/// How far the tool was off, before and after.
pub(crate) fn at_the_tool(comparison: &Comparison) -> Option<String> {
    let tool = comparison.tool.as_ref()?;
    let arrow = |(name, key): (&str, &str)| {
        let change = tool.get(key);
        Some(format!("{} -> {} mm {name}", mm(change.before?), mm(change.after?)))
    };
    let shown = [("at worst", "worst_m"), ("rms", "rms_m"), ("at rest at the end", "end_m")];
    Some(shown.into_iter().filter_map(arrow).collect::<Vec<_>>().join(", "))
}

pub(super) fn plans(comparison: &Comparison) -> String {
    let duration = |runs: &[Run]| runs.first().and_then(|run| run.plan_duration_s);
    let most = |of: fn(&Run) -> Option<f64>| {
        comparison.after.iter().map(of).reduce(|a, b| Some(a?.max(b?))).flatten()
    };
    let of_both = most(|run| run.plan_difference_m);
    let kind = if of_both.is_some() { JointKind::Turns } else { kind(comparison, &Scope::All) };
    let lengths = of_both.map_or(String::new(), |m| format!(" and {}", position(JointKind::Slides, m)));
    let apart = most(|run| run.plan_difference)
        .map_or("they share too little time to compare them".to_owned(), |most| {
            format!("at equal times they differ by at most {}{lengths}", position(kind, most))
        });
    let long = match (duration(&comparison.before), duration(&comparison.after)) {
        (Some(before), Some(after)) => format!("{before:.2} s before, {after:.2} s after"),
        _ => "duration unknown".to_owned(),
    };
    let some_joints = comparison.remarks.as_slice().iter().any(|remark| remark.code == Code::UnpairedJoint);
    let left = match comparison.unpaired.len() {
        0 if some_joints => "every transition of joints that all runs have is paired".to_owned(),
        0 => "every transition is paired".to_owned(),
        1 => "1 transition has no counterpart".to_owned(),
        n => format!("{n} transitions have no counterpart"),
    };
    let which = if comparison.same_plan { "The same plan" } else { "Different plans" };
    // Runs of one side of which some have another plan than the first run before.
    let mixed = [&comparison.before, &comparison.after].map(|runs| {
        let others = runs.iter().filter(|run| !run.same_plan).collect::<Vec<&Run>>();
        if others.len() < runs.len() { others } else { Vec::new() }
    });
    let mixed: Vec<String> = mixed
        .into_iter()
        .flatten()
        .map(|run| match run.plan_duration_s {
            Some(long_s) => format!("{} ({long_s:.2} s)", run.log),
            None => run.log.clone(),
        })
        .collect();
    let mixed = if mixed.is_empty() {
        String::new()
    } else {
        format!(" Another plan than the other runs of their side have {}: means mix both.", mixed.join(", "))
    };
    let part = if comparison.same_plan {
        ""
    } else {
        " A change is of plan and machine together: a slower plan has smaller errors by itself."
    };
    format!("{which} ({long}): {apart}; {left}.{part}{mixed}")
}

/// One for each limit that was set.
pub(crate) fn verdicts(comparison: &Comparison) -> Vec<Sentence> {
    comparison.gates.iter().map(gate).collect()
}

fn gate(result: &GateResult) -> Sentence {
    let show = |value: f64| match result.gate.form {
        Form::Reduction => format!("{:.1} %", 100.0 * value),
        Form::Probability => probability(value),
        Form::Growth(kind) => position(kind, value),
        Form::Distance => position(JointKind::Slides, value),
        Form::Ratio => format!("{value:.3}"),
    };
    let side = if result.gate.form == Form::Reduction { "at least" } else { "at most" };
    let behind = match (&result.joint, result.time_s, result.gate.form) {
        (Some(joint), Some(at_s), _) => format!(", {joint} at {at_s:.2} s"),
        (.., Form::Probability) if !result.kept && result.found.is_some_and(|p| p <= result.limit) => {
            ", and no reduction".to_owned()
        }
        _ => String::new(),
    };
    let found = result.found.map_or("nothing to judge".to_owned(), |found| match result.gate.form {
        Form::Growth(_) => signed(found, show) + &behind,
        _ => show(found) + &behind,
    });
    Sentence::Verdict {
        limit: format!("Limit on {}", result.gate.name),
        kept: result.kept,
        found: format!("{found}; {} {side}.", show(result.limit)),
    }
}
