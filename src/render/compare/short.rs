//! A comparison in three lines, and its limits in one each.

use crate::{
    render::kit::{Sentence, counted, deg, optional, percent, probability, signed},
    workflow::compare::{Change, Comparison, Gate, GateResult, Measure, Summary, Verdict},
};

/// Verdict, whole run, plans; then joints that call for a word, and limits.
pub(super) fn in_short(comparison: &Comparison) -> Vec<Sentence> {
    let mut lines = Vec::new();
    match comparison.overall(Measure::PeakError) {
        Some(peak) if peak.pairs > 0 => lines.push(verdict(peak)),
        _ => lines.push("No transition is found in every run: there is none to compare.".to_owned()),
    }
    lines.extend(whole_run(comparison));
    lines.push(plans(comparison));
    lines.into_iter().map(Sentence::Finding).chain(verdicts(comparison)).collect()
}

fn verdict(peak: &Summary) -> String {
    let numbers = format!(
        "{} -> {} deg in the mean, {} deg{}{}",
        optional(peak.mean_before, deg),
        optional(peak.mean_after, deg),
        optional(peak.mean_difference, |d| signed(d, deg)),
        peak.relative_change.map_or(String::new(), |share| format!(" ({} %)", percent(share))),
        peak.interval_95.map_or(String::new(), |[low, high]| {
            format!(", 95 % interval {}..{} deg", signed(low, deg), signed(high, deg))
        }),
    );
    let counts = format!(
        "p = {}, {} in {}, {} smaller and {} larger",
        probability(peak.p_value),
        counted(peak.pairs, "pair"),
        counted(peak.events, "event"),
        peak.smaller,
        peak.larger
    );
    match peak.verdict {
        Verdict::Smaller => format!("The peak error at transitions became smaller: {numbers}; {counts}."),
        Verdict::Larger => format!("The peak error at transitions became larger: {numbers}; {counts}."),
        Verdict::NotShown => {
            format!(
                "Whether the peak error at transitions changed is open, luck could explain it: {numbers}; {counts}."
            )
        }
        Verdict::Equal => {
            format!("The peak error at transitions is the same in {}; p = 1.", counted(peak.pairs, "pair"))
        }
        Verdict::TooFew => format!(
            "Whether the peak error at transitions changed cannot be told from {}, of which no p is below {}: {numbers}; \
             {counts}.",
            counted(peak.events, "event"),
            probability(peak.least_p())
        ),
    }
}

fn whole_run(comparison: &Comparison) -> Option<String> {
    let all = comparison.whole_run.first()?;
    let of = |name: &str, change: &Change| {
        let share = change.ratio.map_or(String::new(), |ratio| format!(" ({} %)", percent(ratio - 1.0)));
        let both = change.before.zip(change.after);
        both.map(|(before, after)| format!("{name} {} -> {} deg{share}", deg(before), deg(after)))
    };
    let figures = [
        of("rms", &all.rms_rad),
        of("peak", &all.peak_rad),
        of("at rest", &all.standstill_rms_rad),
        of("path", &all.path_rms_rad),
    ];
    let figures: Vec<String> = figures.into_iter().flatten().collect();
    (!figures.is_empty()).then(|| format!("Whole run, all joints: {}.", figures.join(", ")))
}

fn plans(comparison: &Comparison) -> String {
    let duration = |runs: &[crate::workflow::compare::Run]| runs.first().and_then(|run| run.plan_duration_s);
    let most = comparison.after.iter().map(|run| run.plan_difference_rad).reduce(|a, b| Some(a?.max(b?)));
    let apart = most.flatten().map_or("they share too little time to compare angles".to_owned(), |most| {
        format!("at equal times they differ by {} deg at most", deg(most))
    });
    let long = match (duration(&comparison.before), duration(&comparison.after)) {
        (Some(before), Some(after)) => format!("{before:.2} s before, {after:.2} s after"),
        _ => "duration unknown".to_owned(),
    };
    let left = match comparison.unpaired.len() {
        0 => "every transition is paired".to_owned(),
        1 => "1 transition has no counterpart".to_owned(),
        n => format!("{n} transitions have no counterpart"),
    };
    let which = if comparison.same_plan() { "The same plan" } else { "Different plans" };
    format!("{which} ({long}): {apart}; {left}.")
}

/// One for each limit that was set.
pub fn verdicts(comparison: &Comparison) -> Vec<Sentence> {
    comparison.gates.iter().map(gate).collect()
}

fn gate(result: &GateResult) -> Sentence {
    let percents = |share: f64| format!("{:.1} %", 100.0 * share);
    let ratio = |ratio: f64| format!("{ratio:.3}");
    let (name, limit, found) = match result.gate {
        Gate::PeakReduction => (
            "reduction of the mean transition peak",
            format!("{} at least", percents(result.limit)),
            result.found.map(percents),
        ),
        Gate::P => (
            "p of a reduction of transition peaks",
            format!("{} at most", probability(result.limit)),
            result.found.map(|p| {
                let no_reduction = !result.kept && p <= result.limit;
                format!("{}{}", probability(p), if no_reduction { ", and no reduction" } else { "" })
            }),
        ),
        Gate::TransitionGrowth => (
            "growth of a transition's peak",
            format!("{} deg at most", deg(result.limit)),
            result.found.map(|growth| {
                let joint = result.joint.as_deref().unwrap_or_default();
                let at = result.time_s.map_or(String::new(), |t| format!(" at {t:.2} s"));
                format!("{} deg, {joint}{at}", signed(growth, deg))
            }),
        ),
        Gate::RmsRatio => (
            "rms error after over before",
            format!("{} at most", ratio(result.limit)),
            result.found.map(ratio),
        ),
        Gate::PeakRatio => (
            "peak error after over before",
            format!("{} at most", ratio(result.limit)),
            result.found.map(ratio),
        ),
    };
    let found = found.unwrap_or("nothing to compare".to_owned());
    Sentence::Verdict {
        limit: format!("Limit on {name}"),
        kept: result.kept,
        found: format!("{found}; {limit}."),
    }
}
