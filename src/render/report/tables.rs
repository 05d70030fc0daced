//! The report as headings, sentences and tables, worst first.

use super::method::method;
use crate::{
    render::{
        kit::{
            Document, Fact, Id, NONE, Section, Sentence, Table, counted, deg, fact, ms, optional,
            probability, share as percents, spark,
        },
        transition::{direction, kind, late},
    },
    replay::{Answer, JointReplay, Profiles, Replay, Transition, Verdict},
    workflow::report::{Gate, GateResult, Report},
};

/// Everything a person reads of a report; `most` is how many transitions to list.
pub fn document(name: &str, report: &Report, most: usize) -> Document {
    let mut document = Document { facts: source_facts(report), ..Document::titled(name) }.with(Section::new(
        Id::SUMMARY,
        "In short",
        in_short(report),
    ));
    document.sections.extend(transitions(&report.replay, most));
    let mut document = document.with(joints(&report.replay, &report.profiles)).remarked(&report.remarks);
    document.sections.extend(method(report));
    document
}

/// Recorder and header on clocks that have nothing to do with each other (simulated time), s.
const A_CLOCK_APART_S: f64 = 3600.0;

fn source_facts(report: &Report) -> Vec<Fact> {
    let source = &report.source;
    let samples = report.alignment.iter().map(|a| a.matched).max().unwrap_or(0);
    let interval_s = report.replay.joints.iter().map(|j| j.sample_interval_s).fold(0.0, f64::max);
    let rate = if interval_s > 0.0 { format!(" at {:.0} Hz", 1.0 / interval_s) } else { String::new() };
    let delay = source
        .recorder_delay_s
        .filter(|[median_s, most_s]| *most_s >= 1e-3 && median_s.abs() < A_CLOCK_APART_S);
    let delay = delay.map_or(String::new(), |[median_s, most_s]| {
        format!("; the recorder was {} ms behind it, at most {} ms", ms(median_s), ms(most_s))
    });
    vec![
        fact(
            "run",
            format!(
                "{:.2} s, {}, {samples} samples{rate}",
                source.duration_s,
                counted(report.alignment.len(), "joint")
            ),
        ),
        fact("planned", format!("{}  {}", source.planned_topic, source.planned_field)),
        fact("measured", format!("{}  {}", source.measured_topic, source.measured_field)),
        fact("clock", format!("{} stamps{delay}", source.time_base.name())),
    ]
}

fn in_short(report: &Report) -> Vec<Sentence> {
    let mut lines: Vec<Sentence> = findings(report).into_iter().map(Sentence::Finding).collect();
    lines.extend(verdicts(report));
    lines
}

fn findings(report: &Report) -> Vec<String> {
    let replay = &report.replay;
    let mut lines = Vec::new();
    match by_peak(replay).first() {
        Some(worst) => lines.push(format!("Worst {}: {}", kind(worst.kind), worst_sentence(worst))),
        None if replay.joints.iter().all(|j| !j.plan_moves) => {
            lines.push("No joint is asked to move: there is no transition to judge.".to_owned());
        }
        None => lines.push("No planned start from rest was found.".to_owned()),
    }
    lines.extend(mostly_lag(replay).map(|lag| format!("The error is mostly lag: {lag}.")));
    if let Some(c) = &replay.whole_run.concentration {
        let place = match (mostly_lag(replay), c.verdict) {
            (Some(_), _) => "Transitions hold it because the joints move there",
            (None, Verdict::Transitions) => "The error lives in the transitions",
            (None, Verdict::Elsewhere) => "The error lives outside the transitions",
            (None, Verdict::Undecided) => "Whether the error lives in the transitions is open",
        };
        let test = c.test.map_or("too few stretches to test".to_owned(), |t| {
            format!(
                "p = {}, {} transition events against {} other stretches",
                probability(t.p_value),
                t.inside_count,
                t.outside_count
            )
        });
        let moving = c
            .rms_outside_moving_rad
            .map_or("rest".to_owned(), |rms_rad| format!("{} while moving", deg(rms_rad)));
        lines.push(format!(
            "{place}: rms {} deg inside, {} deg elsewhere ({moving}); {:.0} % of the squared error in {:.0} % of the time ({test}).",
            deg(c.rms_inside_rad),
            deg(c.rms_outside_rad),
            100.0 * c.squared_error_share_inside,
            100.0 * c.time_share_inside,
        ));
    }
    if mostly_lag(replay).is_none() && replay.whole_run.concentration.is_some() {
        lines.push(match lag_words(replay) {
            Some(lag) => format!("The part that is lag: {lag}."),
            None => "How much of it is lag cannot be told: no joint shows one.".to_owned(),
        });
    }
    if let Some(path) = &replay.whole_run.path_error {
        lines.push(format!(
            "Path error, which ignores time, as the norm over all joints: rms {} deg, where the same norm with time is {} deg; \
             peak {} deg ({} instants, single run).",
            deg(path.rms_rad),
            deg(path.timed_rms_rad),
            deg(path.peak_rad),
            path.samples
        ));
    }
    for joint in &replay.joints {
        match (joint.plan_moves, joint.moves) {
            (false, false) if joint.unplanned_starts > 0 => lines.push(format!(
                "{} is not asked to move and is only shaken: {} of less than {} deg, unasked.",
                joint.name,
                counted(joint.unplanned_starts, "start"),
                deg(replay.rules.moves_travel_rad)
            )),
            (false, false) => lines.push(format!("{} does not move and is not asked to.", joint.name)),
            (true, false) => {
                lines.push(format!(
                    "{} is asked to move and does not ({}).",
                    joint.name,
                    counted(joint.starts, "planned start")
                ));
            }
            (false, true) => lines.push(format!("{} moves although its plan rests.", joint.name)),
            (true, true) => {}
        }
    }
    lines
}

/// What the lag explains of a run whose error is mostly that.
pub(super) fn mostly_lag(replay: &Replay) -> Option<String> {
    replay.whole_run.lag_share.filter(|lag| lag.mostly)?;
    lag_words(replay)
}

/// How much of the squared error lags at the planned speeds explain; `None` where no joint has one.
pub(super) fn lag_words(replay: &Replay) -> Option<String> {
    let share = replay.whole_run.lag_share?;
    let lags = replay.joints.iter().filter(|joint| joint.plan_moves).filter_map(|joint| joint.lag_s);
    let [least, most] = crate::math::range(lags);
    let (least, most) = (ms(least), ms(most));
    let lag = if least == most { format!("{least} ms") } else { format!("{least} to {most} ms by joint") };
    Some(format!(
        "{lag} at the planned speed {} {} of the squared error ({}{}; mostly lag from {:.0} % on)",
        if least == most { "explains" } else { "explain" },
        percents(share.share),
        share.interval.map_or(String::new(), |[a, b]| format!("95 % {:.0}..{}, ", 100.0 * a, percents(b))),
        counted(share.events, "event"),
        100.0 * replay.rules.mostly_lag_share,
    ))
}

pub(super) fn worst_sentence(worst: &Transition) -> String {
    let lateness = match worst.onset_delay_s {
        Some(delay_s) if delay_s >= 0.0 => format!("leaves {} ms after its plan", ms(delay_s)),
        Some(delay_s) => format!("leaves {} ms before its plan", ms(-delay_s)),
        None => match worst.answer {
            Answer::Creeps => "creeps or is under way when its plan starts".to_owned(),
            Answer::Unclear => "has too small a planned motion to tell when it answers".to_owned(),
            Answer::Timed | Answer::Never => "never answers its plan".to_owned(),
        },
    };
    format!(
        "{} at {:.2} s {lateness}; its error peaks at {} deg, {} ms after the planned start.",
        worst.joint,
        worst.planned_onset_s,
        deg(worst.peak_error_rad),
        ms(worst.time_to_peak_s)
    )
}

pub(super) fn by_peak(replay: &Replay) -> Vec<&Transition> {
    let mut worst: Vec<&Transition> = replay.transitions.iter().collect();
    worst.sort_by(|a, b| b.peak_error_rad.total_cmp(&a.peak_error_rad));
    worst
}

fn transitions(replay: &Replay, most: usize) -> Option<Section> {
    let all = by_peak(replay);
    let rows = all.iter().take(most).map(|t| {
        let interval =
            t.onset_delay_interval_s.map_or(NONE.to_owned(), |[a, b]| format!("{}..{}", ms(a), ms(b)));
        vec![
            t.joint.clone(),
            kind(t.kind).to_owned(),
            direction(t.direction).to_owned(),
            format!("{:.2}", t.planned_onset_s),
            late(t.onset_delay_s, t.answer),
            interval,
            deg(t.peak_error_rad),
            ms(t.time_to_peak_s),
            deg(t.rms_error_rad),
            optional(t.breakaway_error_rad, deg),
            deg(t.overshoot_rad),
            optional(t.settling_time_s, ms),
        ]
    });
    let numbers =
        ["at s", "late ms", "95 %", "peak deg", "after ms", "rms deg", "break deg", "over deg", "settled ms"];
    let table = Table::new(&["joint", "kind", "dir"], &numbers, rows);
    let more = (all.len() > most).then(|| {
        Sentence::note(format!("and {} more with smaller peaks (--all lists them)", all.len() - most))
    });
    (!all.is_empty())
        .then(|| Section::new(Id::TRANSITIONS, "Transitions, worst first", [table]).with_all(more))
}

fn joints(replay: &Replay, profiles: &Profiles) -> Section {
    let rows = replay.joints.iter().enumerate().map(|(k, j)| {
        let error = &j.tracking_error;
        vec![
            j.name.clone(),
            profiles.peaks_rad.get(k).map_or(String::new(), |peaks| spark(peaks, profiles.most_rad)),
            deg(error.rms_rad),
            deg(error.mean_abs_rad),
            deg(error.p95_rad),
            deg(error.peak_rad),
            format!("{:.2}", error.peak_time_s),
            deg(error.bias_rad),
            optional(j.standstill_error.map(|e| e.rms_rad), deg),
            lag(j),
            optional(j.lag_correlation, |c| format!("{c:.3}")),
            j.lag_share.map_or(NONE.to_owned(), |lag| percents(lag.share)),
            (j.starts - j.reversals).to_string(),
            j.reversals.to_string(),
            j.unmatched_starts.to_string(),
            j.untimed_starts.to_string(),
            j.unplanned_starts.to_string(),
        ]
    });
    let numbers = [
        "rms deg",
        "mean",
        "p95",
        "peak",
        "at s",
        "bias",
        "at rest",
        "lag ms",
        "corr",
        "by lag",
        "starts",
        "rev",
        "no answer",
        "untimed",
        "unasked",
    ];
    Section::new(Id::JOINTS, "Joints", [Table::new(&["joint", "error over the run"], &numbers, rows)])
}

pub(super) fn lag(joint: &JointReplay) -> String {
    match (joint.lag_s, joint.lag_interval_s) {
        (Some(lag_s), Some([a, b])) => format!("{} ({}..{})", ms(lag_s), ms(a), ms(b)),
        (lag_s, _) => optional(lag_s, ms),
    }
}

/// One for each limit that was set.
pub fn verdicts(report: &Report) -> Vec<Sentence> {
    report.gates.iter().map(verdict).collect()
}

fn verdict(result: &GateResult) -> Sentence {
    let (name, unit, show): (_, _, fn(f64) -> String) = match result.gate {
        Gate::TransitionPeak => ("transition peak", "deg", deg),
        Gate::Rms => ("rms error", "deg", deg),
        Gate::Peak => ("peak error", "deg", deg),
        Gate::StandstillRms => ("rms error at standstill", "deg", deg),
        Gate::OnsetDelay => ("start delay", "ms", ms),
        Gate::Lag => ("lag", "ms", ms),
    };
    let limit = format!("{} {unit} allowed", show(result.limit));
    let sentence =
        |found: String| Sentence::Verdict { limit: format!("Limit on {name}"), kept: result.kept, found };
    let Some(joint) = &result.joint else { return sentence(format!("nothing to measure, {limit}.")) };
    let time = result.time_s.map_or(String::new(), |t| format!(" at {t:.2} s"));
    let missing =
        if result.gate == Gate::Lag { "no lag in the range looked at" } else { "a start without an answer" };
    let worst = result.worst.map_or(missing.to_owned(), |w| format!("{} {unit}", show(w)));
    sentence(format!("{joint}{time} has {worst}, {limit}."))
}
