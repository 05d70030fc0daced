//! A comparison as headings, sentences and tables, worst first.

use super::{arrow, optional, percent, probability, short::in_short, signed, unit, word};
use crate::{
    render::{
        NONE, Part, Sheet, counted, deg, ms,
        tables::{kind, late, remark_parts},
    },
    units::degrees_from_radians,
    workflow::compare::{Comparison, Figures, Measure, Run, Scope, Side, Summary, TransitionPair},
};

/// Everything a person reads of a comparison; `most` is how many pairs to list.
pub fn compare_parts(comparison: &Comparison, most: usize) -> Vec<Part> {
    let names = |runs: &[Run]| runs.iter().map(|run| run.log.clone()).collect::<Vec<_>>().join(", ");
    let mut parts = vec![
        Part::Title(format!("{} -> {}", names(&comparison.before), names(&comparison.after))),
        Part::Facts(run_facts(comparison)),
        Part::Heading("In short".into()),
    ];
    parts.extend(in_short(comparison).into_iter().map(Part::Line));
    pair_parts(comparison, most, &mut parts);
    for measure in [Measure::PeakError, Measure::RmsError, Measure::OnsetDelay] {
        summary_parts(comparison, measure, &mut parts);
    }
    parts.push(Part::Heading("Whole run, before -> after".into()));
    parts.push(figures_sheet(&comparison.whole_run));
    unpaired_parts(comparison, &mut parts);
    remark_parts(&comparison.remarks, &mut parts);
    parts.push(Part::Heading("How".into()));
    parts.push(Part::Facts(how(comparison)));
    parts
}

pub(in crate::render) fn run_facts(comparison: &Comparison) -> Vec<(String, String)> {
    let fact = |side: &str, run: &Run| {
        let plan = run.plan_duration_s.map_or(String::new(), |s| format!(", plan {s:.2} s"));
        let source = &run.source;
        let text = format!(
            "{}: {:.2} s{plan}, {}; planned {} {}, measured {} {}",
            run.log,
            source.duration_s,
            counted(run.transitions, "transition"),
            source.planned_topic,
            source.planned_field,
            source.measured_topic,
            source.measured_field,
        );
        (side.to_owned(), text)
    };
    let before = comparison.before.iter().map(|run| fact("before", run));
    before.chain(comparison.after.iter().map(|run| fact("after", run))).collect()
}

fn direction(direction: i8) -> String {
    if direction < 0 { "-" } else { "+" }.to_owned()
}

fn pair_parts(comparison: &Comparison, most: usize, parts: &mut Vec<Part>) {
    let mut worst: Vec<&TransitionPair> = comparison.pairs.iter().collect();
    if worst.is_empty() {
        return;
    }
    let growth = |pair: &TransitionPair| pair.peak_error_rad.difference.unwrap_or(f64::NEG_INFINITY);
    worst.sort_by(|a, b| growth(b).total_cmp(&growth(a)));
    let rows = worst.iter().take(most).map(|pair| {
        let (peak, rms, delay) = (&pair.peak_error_rad, &pair.rms_error_rad, &pair.onset_delay_s);
        vec![
            pair.joint.clone(),
            kind(pair.kind).to_owned(),
            direction(pair.direction),
            format!("{:.2}", pair.planned_onset_before_s),
            format!("{:.2}", pair.planned_onset_after_s),
            optional(peak.before, deg),
            optional(peak.after, deg),
            optional(peak.difference, |d| signed(d, deg)),
            optional(peak.ratio, |ratio| format!("{ratio:.2}")),
            optional(rms.before, deg),
            optional(rms.after, deg),
            optional(rms.difference, |d| signed(d, deg)),
            late(delay.before, pair.answer_before),
            late(delay.after, pair.answer_after),
            optional(delay.difference, |d| signed(d, ms)),
        ]
    });
    let head = vec![
        "joint", "kind", "dir", "at s", "after", "peak deg", "after", "change", "ratio", "rms deg", "after",
        "change", "late ms", "after", "change",
    ];
    parts.push(Part::Heading("Transitions, worst change of peak first".into()));
    parts.push(Part::Sheet(Sheet { head, left: 3, rows: rows.collect() }));
    if worst.len() > most {
        parts.push(Part::Line(format!("and {} more that did better (--all lists them)", worst.len() - most)));
    }
}

fn summary_parts(comparison: &Comparison, measure: Measure, parts: &mut Vec<Part>) {
    let of = comparison.summaries.iter().filter(|s| s.measure == measure);
    let rows: Vec<Vec<String>> = of.filter(|s| s.pairs > 0).map(summary_row).collect();
    if rows.is_empty() {
        return;
    }
    let (title, before) = match measure {
        Measure::PeakError => ("Peak error at transitions", "before deg"),
        Measure::RmsError => ("Rms error at transitions", "before deg"),
        Measure::OnsetDelay => ("Start delay, where answered before and after", "before ms"),
    };
    let head = vec![
        "transitions",
        before,
        "after",
        "change",
        "95 %",
        "median",
        "%",
        "p",
        "verdict",
        "pairs",
        "events",
        "smaller",
        "larger",
    ];
    parts.push(Part::Heading(title.into()));
    parts.push(Part::Sheet(Sheet { head, left: 1, rows }));
}

fn summary_row(summary: &Summary) -> Vec<String> {
    let (show, _) = unit(summary.measure);
    let scope = match &summary.scope {
        Scope::All => "all".to_owned(),
        Scope::Starts => "from rest".to_owned(),
        Scope::Joint(joint) => joint.clone(),
    };
    vec![
        scope,
        optional(summary.mean_before, show),
        optional(summary.mean_after, show),
        optional(summary.mean_difference, |d| signed(d, show)),
        summary
            .interval_95
            .map_or(NONE.to_owned(), |[low, high]| format!("{}..{}", signed(low, show), signed(high, show))),
        optional(summary.median_difference, |d| signed(d, show)),
        optional(summary.relative_change, percent),
        probability(summary.p_value),
        word(summary.verdict).to_owned(),
        summary.pairs.to_string(),
        summary.events.to_string(),
        summary.smaller.to_string(),
        summary.larger.to_string(),
    ]
}

fn figures_sheet(figures: &[Figures]) -> Part {
    let tenth = |rad: f64| format!("{:.1}", degrees_from_radians(rad));
    let rows = figures.iter().map(|f| {
        vec![
            f.joint.clone().unwrap_or("all".to_owned()),
            arrow(&f.rms_rad, deg),
            optional(f.rms_rad.ratio, |ratio| format!("{ratio:.2}")),
            arrow(&f.p95_rad, deg),
            arrow(&f.peak_rad, deg),
            arrow(&f.standstill_rms_rad, deg),
            arrow(&f.path_rms_rad, deg),
            arrow(&f.lag_s, ms),
            arrow(&f.peak_speed_rad_s, tenth),
            arrow(&f.peak_acceleration_rad_s2, tenth),
        ]
    });
    let head = vec![
        "joint",
        "rms deg",
        "ratio",
        "p95 deg",
        "peak deg",
        "at rest deg",
        "path deg",
        "lag ms",
        "speed deg/s",
        "accel deg/s2",
    ];
    Part::Sheet(Sheet { head, left: 1, rows: rows.collect() })
}

fn unpaired_parts(comparison: &Comparison, parts: &mut Vec<Part>) {
    if comparison.unpaired.is_empty() {
        return;
    }
    let several = comparison.before.len().max(comparison.after.len()) > 1;
    let rows = comparison.unpaired.iter().map(|u| {
        let side = if u.side == Side::Before { "before" } else { "after" };
        vec![
            if several { format!("{side} {}", u.run) } else { side.to_owned() },
            u.joint.clone(),
            kind(u.kind).to_owned(),
            direction(u.direction),
            format!("{:.2}", u.planned_onset_s),
            deg(u.peak_error_rad),
        ]
    });
    let head = vec!["only", "joint", "kind", "dir", "at s", "peak deg"];
    parts.push(Part::Heading("Transitions without a counterpart, left out".into()));
    parts.push(Part::Sheet(Sheet { head, left: 4, rows: rows.collect() }));
}

fn how(comparison: &Comparison) -> Vec<(String, String)> {
    let fact = |name: &str, value: String| (name.to_owned(), value);
    let rules = &comparison.rules;
    let exact = comparison.summaries.iter().all(|s| s.p_is_exact);
    let runs = comparison.before.len().min(comparison.after.len());
    let luck = if runs > 1 {
        "values are means over the runs of a side, which evens out what differs from run to run; p and interval go by \
         the spread over transitions, so that more runs give no more events"
            .to_owned()
    } else {
        "p and interval go by the spread over the transitions of these runs; what differs from run to run (oil, \
         load) is evened out by repeats (--more-before, --more-after)"
            .to_owned()
    };
    vec![
        fact(
            "pairs",
            "same joint, kind and direction; by time since the first planned start, by the key points of the task where \
             both logs hold it, or by order where another plan starts a joint equally often in the same directions"
                .to_owned(),
        ),
        fact("change", "after minus before, over each pair; negative is better".to_owned()),
        fact(
            "events",
            format!("starts of any joints within {} s count as one in interval and test", rules.same_event_s),
        ),
        fact("95 %", "Student's t of the mean change, robust to events; three events at least".to_owned()),
        fact(
            "p",
            format!(
                "Wilcoxon signed-rank, two-sided, {}; a verdict below {}, which takes six events at least; not \
                 corrected for the number of rows",
                if exact { "exact" } else { "exact up to 25 events, normal approximation above" },
                rules.significance
            ),
        ),
        fact("luck", luck),
    ]
}
