//! A comparison as headings, sentences and tables, worst first.

use super::{arrow, kind, scope, short::in_short, word};
use crate::{
    render::{
        kit::{
            Block, Column, Document, Fact, Id, NONE, Section, Sentence, Table, counted, fact, optional,
            percent, probability, signed,
        },
        metric::{Units, number, position, unit, weighed},
        source::{measured, planned},
    },
    replay::{Answer, Dimension, Keyed, Metric, PEAK_ERROR, ToolReplay, Transition},
    series::JointKind,
    workflow::compare::{Change, Comparison, Figures, Form, Gate, Run, Side, Summary, TransitionPair},
};

/// Everything a person reads of a comparison; `most` is how many pairs to list.
pub(crate) fn document(comparison: &Comparison, most: usize) -> Document {
    let names = |runs: &[Run]| runs.iter().map(|run| run.log.clone()).collect::<Vec<_>>().join(", ");
    let title = format!("{} -> {}", names(&comparison.before), names(&comparison.after));
    let mut document = Document { facts: run_facts(comparison), ..Document::titled(title) }
        .with(Section::new(Id::SUMMARY, "In short", in_short(comparison)));
    let metrics = Metric::<Transition>::rows();
    document.sections.extend(pairs(comparison, most));
    document.sections.extend(metrics.into_iter().filter_map(|metric| summary(comparison, metric)));
    let whole_run = [figures_table(&comparison.whole_run)];
    document.sections.push(Section::new(Id::OTHER, "Whole run, before -> after", whole_run));
    document.sections.extend(tool(comparison));
    document.sections.extend(unpaired(comparison));
    let method = Section::new(Id::METHOD, "How", [Block::Facts(how(comparison))]);
    document.remarked(&comparison.remarks).with(method)
}

fn run_facts(comparison: &Comparison) -> Vec<Fact> {
    let of_run = |side: &str, run: &Run| {
        let plan = run.plan_duration_s.map_or(String::new(), |s| format!(", plan {s:.2} s"));
        let source = &run.source;
        let within = |[from_s, to_s]: [f64; 2]| format!(" ({from_s:.2} to {to_s:.2} s compared)");
        let compared = run.stretch_s.map_or(String::new(), within);
        let text = format!(
            "{}: {:.2} s{compared}{plan}, {}; planned {}, measured {}",
            run.log,
            source.duration_s,
            counted(run.transitions, "transition"),
            planned(source, " "),
            measured(source, " "),
        );
        fact(side, text)
    };
    let before = comparison.before.iter().map(|run| of_run("before", run));
    before.chain(comparison.after.iter().map(|run| of_run("after", run))).collect()
}

fn pairs(comparison: &Comparison, most: usize) -> Option<Section> {
    let mut worst: Vec<&TransitionPair> = comparison.pairs.iter().collect();
    let growth = |pair: &TransitionPair| {
        let change = pair.changes.get(PEAK_ERROR).difference.unwrap_or(f64::NEG_INFINITY);
        comparison.rules.bands(pair.joint_kind, change)
    };
    worst.sort_by(|a, b| growth(b).total_cmp(&growth(a)));
    let units = Units::of(worst.iter().map(|pair| pair.joint_kind));
    let mut columns: Vec<Column> = ["joint", "kind", "dir"].map(Column::words).into();
    columns.extend([Column::numbers("at s"), Column::numbers("after").going_on()]);
    for metric in Metric::<Transition>::rows() {
        let heading = units.heading(metric.heading, metric.dimension);
        columns.push(Column::numbers(heading).meaning(metric.explanation));
        columns.extend(["after", "change"].map(|heading| Column::numbers(heading).going_on()));
    }
    let rows = worst.iter().take(most).map(|pair| {
        let mut row = vec![
            pair.joint.clone(),
            pair.kind.name().to_owned(),
            number(Dimension::Sign, pair.joint_kind, f64::from(pair.direction)),
            format!("{:.2}", pair.planned_onset_before_s),
            format!("{:.2}", pair.planned_onset_after_s),
        ];
        for (metric, change) in pair.changes.iter() {
            let show = |value: f64| units.cell(metric.dimension, pair.joint_kind, value);
            // What a single start without this number says instead.
            let or = |value: Option<f64>, answer: Answer| {
                let start = Transition { answer, ..Transition::default() };
                value.map_or_else(|| (metric.missing)(&start).to_owned(), show)
            };
            row.push(or(change.before, pair.answer_before));
            row.push(or(change.after, pair.answer_after));
            row.push(optional(change.difference, |d| signed(d, show)));
        }
        row
    });
    let table = Table::of(columns, rows.collect::<Vec<_>>());
    let more = worst.len().checked_sub(most).filter(|more| *more > 0).map(|more| {
        Sentence::note(format!("and {more} more whose peak grew by less, or fell (--all lists them)"))
    });
    let mixed = weighed(&comparison.rules, worst.iter().map(|pair| pair.joint_kind));
    (!worst.is_empty()).then(|| {
        let title = "Transitions, worst change of peak first";
        Section::new(Id::TRANSITIONS, title, [table]).with_all(more.into_iter().chain(mixed))
    })
}

fn summary(comparison: &Comparison, metric: &Metric<Transition>) -> Option<Section> {
    let of: Vec<&Summary> =
        comparison.summaries.iter().filter(|s| s.measure.key == metric.key && s.pairs > 0).collect();
    let units = Units::of(of.iter().map(|summary| kind(comparison, &summary.scope)));
    let before = units.heading("before", metric.dimension);
    let first = [Column::words("transitions"), Column::numbers(before).meaning(metric.explanation)];
    let others =
        ["after", "change", "95 %", "median", "%", "p", "verdict", "pairs", "events", "smaller", "larger"];
    let goes_on = |heading| ["after", "change", "95 %"].contains(&heading);
    let other = |heading: &'static str| Column { goes_on: goes_on(heading), ..Column::numbers(heading) };
    let columns = first.into_iter().chain(others.map(other));
    let rows: Vec<Vec<String>> = of.iter().map(|summary| summary_row(comparison, summary, units)).collect();
    let some = !rows.is_empty();
    let title = format!("Change of the {} at transitions", metric.name);
    some.then(|| Section::new(Id::OTHER, title, [Table::of(columns, rows)]))
}

fn summary_row(comparison: &Comparison, summary: &Summary, units: Units) -> Vec<String> {
    let kind = kind(comparison, &summary.scope);
    let show = |value: f64| units.cell(summary.measure.dimension, kind, value);
    let signed = |value: f64| signed(value, show);
    vec![
        scope(&summary.scope),
        optional(summary.mean_before, show),
        optional(summary.mean_after, show),
        optional(summary.mean_difference, signed),
        summary
            .interval_95
            .map_or(NONE.to_owned(), |[low, high]| format!("{}..{}", signed(low), signed(high))),
        optional(summary.median_difference, signed),
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
    let units = Units::of(figures.iter().map(|f| f.kind));
    let metrics = figures.first().into_iter().flat_map(|f| f.changes.iter()).flat_map(|(metric, _)| {
        let heading = if metric.heading.is_empty() { metric.name } else { metric.heading };
        let column = Column::numbers(units.heading(heading, metric.dimension)).meaning(metric.explanation);
        let ratio = || Column::numbers("ratio").meaning("After divided by before.").going_on();
        std::iter::once(column).chain(has_ratio(metric.key).then(ratio))
    });
    let rows = figures.iter().map(|f| {
        let cells = f.changes.iter().flat_map(|(metric, change)| {
            let ratio = || optional(change.ratio, |ratio| format!("{ratio:.2}"));
            std::iter::once(arrow(change, metric.dimension, f.kind, units))
                .chain(has_ratio(metric.key).then(ratio))
        });
        std::iter::once(scope(&f.scope)).chain(cells).collect()
    });
    Table::of(std::iter::once(Column::words("joint")).chain(metrics), rows)
}

fn tool(comparison: &Comparison) -> Option<Section> {
    let kind = JointKind::Slides;
    let units = Units::of(std::iter::once(kind));
    let row = |(metric, change): (&Metric<ToolReplay>, &Change)| {
        let name = format!("{} {}", metric.name, unit(metric.dimension, kind));
        let show = |value| units.optional(metric.dimension, kind, value);
        vec![name, show(change.before), show(change.after)]
    };
    let rows: Vec<Vec<String>> = comparison.tool.as_ref()?.iter().map(row).collect();
    Some(Section::new(Id::OTHER, "At the tool", [Table::new(&[""], &["before", "after"], rows)]))
}

/// Whether the ratio of a metric has a column: a limit can be set on it.
fn has_ratio(key: &str) -> bool {
    let limited = |gate: &&Gate| gate.form == Form::Ratio && gate.key.strip_suffix("-ratio") == Some(key);
    Gate::rows().iter().any(limited)
}

fn unpaired(comparison: &Comparison) -> Option<Section> {
    let several = comparison.before.len().max(comparison.after.len()) > 1;
    let rows = comparison.unpaired.iter().map(|u| {
        let side = if u.side == Side::Before { "before" } else { "after" };
        vec![
            if several { format!("{side} {}", u.run) } else { side.to_owned() },
            u.joint.clone(),
            u.kind.name().to_owned(),
            number(Dimension::Sign, u.joint_kind, f64::from(u.direction)),
            format!("{:.2}", u.planned_onset_s),
            position(u.joint_kind, u.peak_error),
        ]
    });
    let table = Table::new(&["only", "joint", "kind", "dir"], &["at s", "peak"], rows);
    let some = !comparison.unpaired.is_empty();
    some.then(|| Section::new(Id::OTHER, "Transitions without a counterpart, left out", [table]))
}

fn how(comparison: &Comparison) -> Vec<Fact> {
    let [interval, p, chance] = tests(comparison);
    let events = format!(
        "starts of any joints, each within {} s of the one before, count as one in interval and test",
        comparison.rules.same_event_s
    );
    vec![
        fact(
            "pairs",
            "same joint, kind and direction; by time since the first planned start, by the key points of the task where \
             both logs hold it, or by order where another plan starts a joint equally often in the same directions",
        ),
        fact(
            "compared",
            "what every run holds of the plan and of the rests before and after it: a recorder that runs on or stops \
             early is no change",
        ),
        fact("change", "after minus before, over each pair; negative is better"),
        fact("events", events),
        fact("95 %", interval),
        fact("p", p),
        fact("chance", chance),
    ]
}

/// What interval, p and chance are of: runs, where there are enough, or events.
fn tests(comparison: &Comparison) -> [String; 3] {
    if comparison.summaries.iter().any(|summary| summary.by_runs.is_some()) {
        return [
            "Welch's t of the means of the runs; Student's t over events where a run lacks a number",
            "Welch's t-test of the means of the runs, two-sided; not corrected for the number of rows",
            "p and interval go by the scatter of the means of the runs of a side, which holds what differs from run to run; the \
             starts are those of this plan",
        ]
        .map(str::to_owned);
    }
    let exact = comparison.summaries.iter().all(|summary| summary.p_is_exact);
    let p = format!(
        "Wilcoxon signed-rank, two-sided, {}; a verdict below {}, which takes six events at least; not corrected for the number \
         of rows",
        if exact { "exact" } else { "exact up to 25 events, normal approximation above" },
        comparison.rules.significance
    );
    let interval = "Student's t of the mean change, robust to events; three events at least".to_owned();
    let chance = "p and interval go by the spread over the transitions of these runs; what differs from run to run (oil, load) is \
                  not in them: three runs a side tell (--more-before, --more-after)";
    [interval, p, chance.to_owned()]
}
