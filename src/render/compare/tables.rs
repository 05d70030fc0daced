//! A comparison as headings, sentences and tables, worst first.

use super::{arrow, short::in_short, unit, word};
use crate::{
    render::{
        kit::{
            Block, Document, Fact, Id, NONE, Section, Sentence, Table, counted, deg, fact, ms, optional,
            percent, probability, signed,
        },
        transition::{direction, kind, late},
    },
    units::degrees_from_radians,
    workflow::compare::{Comparison, Figures, Measure, Run, Scope, Side, Summary, TransitionPair},
};

/// Everything a person reads of a comparison; `most` is how many pairs to list.
pub fn document(comparison: &Comparison, most: usize) -> Document {
    let names = |runs: &[Run]| runs.iter().map(|run| run.log.clone()).collect::<Vec<_>>().join(", ");
    let title = format!("{} -> {}", names(&comparison.before), names(&comparison.after));
    let mut document = Document { facts: run_facts(comparison), ..Document::titled(title) }
        .with(Section::new(Id::SUMMARY, "In short", in_short(comparison)));
    let measures = [Measure::PeakError, Measure::RmsError, Measure::OnsetDelay];
    document.sections.extend(pairs(comparison, most));
    document.sections.extend(measures.into_iter().filter_map(|measure| summary(comparison, measure)));
    let whole_run = [figures_table(&comparison.whole_run)];
    document.sections.push(Section::new(Id::OTHER, "Whole run, before -> after", whole_run));
    document.sections.extend(unpaired(comparison));
    document.remarked(&comparison.remarks).with(Section::new(
        Id::METHOD,
        "How",
        [Block::Facts(how(comparison))],
    ))
}

fn run_facts(comparison: &Comparison) -> Vec<Fact> {
    let of_run = |side: &str, run: &Run| {
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
        fact(side, text)
    };
    let before = comparison.before.iter().map(|run| of_run("before", run));
    before.chain(comparison.after.iter().map(|run| of_run("after", run))).collect()
}

fn pairs(comparison: &Comparison, most: usize) -> Option<Section> {
    let mut worst: Vec<&TransitionPair> = comparison.pairs.iter().collect();
    let growth = |pair: &TransitionPair| pair.peak_error_rad.difference.unwrap_or(f64::NEG_INFINITY);
    worst.sort_by(|a, b| growth(b).total_cmp(&growth(a)));
    let rows = worst.iter().take(most).map(|pair| {
        let (peak, rms, delay) = (&pair.peak_error_rad, &pair.rms_error_rad, &pair.onset_delay_s);
        vec![
            pair.joint.clone(),
            kind(pair.kind).to_owned(),
            direction(pair.direction).to_owned(),
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
    let numbers = [
        "at s", "after", "peak deg", "after", "change", "ratio", "rms deg", "after", "change", "late ms",
        "after", "change",
    ];
    let table = Table::new(&["joint", "kind", "dir"], &numbers, rows);
    let more = (worst.len() > most).then(|| {
        Sentence::note(format!("and {} more that did better (--all lists them)", worst.len() - most))
    });
    (!worst.is_empty()).then(|| {
        Section::new(Id::TRANSITIONS, "Transitions, worst change of peak first", [table]).with_all(more)
    })
}

fn summary(comparison: &Comparison, measure: Measure) -> Option<Section> {
    let of = comparison.summaries.iter().filter(|s| s.measure == measure);
    let rows: Vec<Vec<String>> = of.filter(|s| s.pairs > 0).map(summary_row).collect();
    let (title, before) = match measure {
        Measure::PeakError => ("Peak error at transitions", "before deg"),
        Measure::RmsError => ("Rms error at transitions", "before deg"),
        Measure::OnsetDelay => ("Start delay, where answered before and after", "before ms"),
    };
    let numbers = [
        before, "after", "change", "95 %", "median", "%", "p", "verdict", "pairs", "events", "smaller",
        "larger",
    ];
    let some = !rows.is_empty();
    some.then(|| Section::new(Id::OTHER, title, [Table::new(&["transitions"], &numbers, rows)]))
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

fn figures_table(figures: &[Figures]) -> Table {
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
    let numbers = [
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
    Table::new(&["joint"], &numbers, rows)
}

fn unpaired(comparison: &Comparison) -> Option<Section> {
    let several = comparison.before.len().max(comparison.after.len()) > 1;
    let rows = comparison.unpaired.iter().map(|u| {
        let side = if u.side == Side::Before { "before" } else { "after" };
        vec![
            if several { format!("{side} {}", u.run) } else { side.to_owned() },
            u.joint.clone(),
            kind(u.kind).to_owned(),
            direction(u.direction).to_owned(),
            format!("{:.2}", u.planned_onset_s),
            deg(u.peak_error_rad),
        ]
    });
    let table = Table::new(&["only", "joint", "kind", "dir"], &["at s", "peak deg"], rows);
    let some = !comparison.unpaired.is_empty();
    some.then(|| Section::new(Id::OTHER, "Transitions without a counterpart, left out", [table]))
}

fn how(comparison: &Comparison) -> Vec<Fact> {
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
             both logs hold it, or by order where another plan starts a joint equally often in the same directions",
        ),
        fact("change", "after minus before, over each pair; negative is better"),
        fact(
            "events",
            format!("starts of any joints within {} s count as one in interval and test", rules.same_event_s),
        ),
        fact("95 %", "Student's t of the mean change, robust to events; three events at least"),
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
