//! The report as headings, sentences and tables, worst first.

use super::{
    method::method,
    resting::{at_rest, one_way, unanswered},
    steps::told,
    together::Together,
    tool, why,
};
use crate::{
    math::range,
    remark::Code,
    render::{
        fit::supply,
        kit::{Column, Document, Fact, Id, Section, Sentence, counted, fact, ms, spark, starts_of},
        metric::{Units, position, weighed, with_unit},
        promise,
        source::{clock, measured, planned},
    },
    replay::{
        Answer, Dimension, JOINT, JointReplay, ONSET_DELAY_LIMIT, Profiles, Replay, Swing, TRANSITION,
        Transition,
    },
    workflow::report::{Backward, Fault, GateResult, Report, Saturated, Travel},
};

/// Everything a person reads of a report; `most` is how many transitions to list.
pub(crate) fn document(name: &str, report: &Report, most: usize) -> Document {
    let mut document = Document { facts: source_facts(report), ..Document::titled(name) }.with(Section::new(
        Id::SUMMARY,
        "In short",
        in_short(report),
    ));
    document.sections.extend(tool::section(report, most));
    document.sections.extend(transitions(&report.replay, most));
    document.sections.extend(why::section(report, most));
    let mut document = document.with(joints(&report.replay, &report.profiles)).remarked(&report.remarks);
    document.sections.extend(method(report));
    document
}

/// Recorder and header on clocks that have nothing to do with each other (simulated time), s.
const A_CLOCK_APART_S: f64 = 3600.0;

fn source_facts(report: &Report) -> Vec<Fact> {
    let source = &report.source;
    let matched = || report.alignment.iter().map(|a| a.matched);
    let samples = match (matched().min().unwrap_or(0), matched().max().unwrap_or(0)) {
        (least, most) if 2 * least < most => format!("{least} to {most}"),
        (_, most) => most.to_string(),
    };
    let rate = rate(report);
    // A table has no recorder beside the one that stamped it.
    let delay = source
        .recorder_delay_s
        .filter(|[median_s, most_s]| *most_s >= 1e-3 && median_s.abs() < A_CLOCK_APART_S)
        .filter(|_| source.origin.is_none());
    let delay = delay.map_or(String::new(), |[median_s, most_s]| {
        format!("; the recorder was {} ms behind it, at most {} ms", ms(median_s), ms(most_s))
    });
    let taken_off = source.measured_delay_s.map_or(String::new(), |delay_s| {
        format!("; {} ms taken off those of the measurement, as given", ms(delay_s))
    });
    let (duration_s, joints) = (source.duration_s, counted(report.alignment.len(), "joint"));
    vec![
        fact("run", format!("{duration_s:.2} s, {joints}, {samples} samples{rate}")),
        fact("planned", planned(source, "  ")),
        fact("measured", measured(source, "  ")),
        fact("clock", format!("{}{delay}{taken_off}", clock(source))),
    ]
}

/// The sampling rate, or the range of those of the joints where it differs.
pub(super) fn rate(report: &Report) -> String {
    let hz = || report.replay.joints.iter().map(|j| 1.0 / j.sample_interval_s).filter(|hz| hz.is_finite());
    let [least, most] = range(hz());
    match (hz().count(), 1.5 * least < most) {
        (0, _) => String::new(),
        (_, true) => format!(" at {least:.0} to {most:.0} Hz"),
        (_, false) => format!(" at {least:.0} Hz"),
    }
}

fn in_short(report: &Report) -> Vec<Sentence> {
    let tool = tool::sentence(&report.tool);
    let mut lines: Vec<Sentence> = tool.into_iter().chain(findings(report)).map(Sentence::Finding).collect();
    lines.extend(verdicts(report));
    lines
}

fn findings(report: &Report) -> Vec<String> {
    let replay = &report.replay;
    let mut lines: Vec<String> =
        report.several_runs().map(|why| format!("Two runs? {why}.")).into_iter().collect();
    lines.extend(report.fault.iter().map(|fault| told(fault).join(". ")));
    match report.worst() {
        Some(worst) => lines.push(format!("Worst {}: {}", worst.kind.name(), worst_sentence(worst))),
        None if replay.joints.iter().any(|joint| report.travel(joint).small) => {
            lines.push("No joint has a plan that moves far or fast enough to tell its starts.".to_owned());
        }
        None if replay.joints.iter().all(|j| !j.plan_moves) => {
            lines.push("No joint has a plan that moves: there is no transition to judge.".to_owned());
        }
        None if report.fault.is_some() => {}
        None => lines.push("No planned start from rest was found.".to_owned()),
    }
    lines.extend(replay.joints.iter().filter_map(|joint| unanswered(replay, joint)));
    let kinds = replay.joints.iter().map(|joint| joint.kind);
    lines.extend(report.promised.and_then(|held| promise::sentence(&held, kinds, "")));
    lines.extend(Together::all(replay).iter().flat_map(Together::findings));
    lines.extend(report.supply.as_ref().map(supply));
    lines.extend(replay.joints.iter().filter_map(|joint| stray(report, joint)));
    lines.extend(replay.joints.iter().filter_map(|joint| one_way(replay, joint)));
    lines.extend(report.backward().iter().map(sinks));
    let saturated = report.saturated();
    lines.extend(saturated.iter().map(saturates));
    // What comes to its end later is off until then.
    let others = replay.joints.iter().filter(|joint| !saturated.iter().any(|one| one.joint == joint.name));
    lines.extend(others.flat_map(|joint| at_rest(replay, joint)));
    lines.extend(swings(report));
    lines
}

/// A joint that first goes the other way.
fn sinks(Backward { joint, kind, count: [count, starts], most, at_s, swings }: &Backward) -> String {
    let why = match swings {
        None => "That is no dead band: the load sinks before it is held (counterbalance or load-holding valve, leak, trapped pressure)."
            .to_owned(),
        Some(deviation) => format!(
            "It moves so while its plan rests, too (standard deviation {}): its loop swings slowly, or it does not come to rest, and the \
             delays of its starts are those of that motion.",
            position(*kind, *deviation)
        ),
    };
    format!(
        "{joint} goes against its plan before it starts, in {count} of {}: by {} at most, where it is to start at {at_s:.2} s. {why}",
        counted(*starts, "timed start"),
        position(*kind, *most)
    )
}

/// A joint that goes no faster.
pub(super) fn saturates(
    Saturated { joint, kind, direction, speed, asked, count: [count, motions] }: &Saturated,
) -> String {
    let shown = |speed: f64| with_unit(Dimension::Speed, *kind, speed);
    format!(
        "{joint} goes no faster in {} than {}, where its plan asks for {} (at that speed in {count} of {} that ask for more): a limit of valve, pump or \
         drive, and neither lag nor dead band. A plan within it is what helps.",
        if *direction > 0 { '+' } else { '-' },
        shown(*speed),
        shown(*asked),
        counted(*motions, "motion")
    )
}

/// Joints that swing though their plans do not.
fn swings(report: &Report) -> Vec<String> {
    let of = |swing: &&Swing| {
        let by = position(swing.kind, swing.amplitude);
        format!("{} at {:.2} Hz by {by}", swing.joint, swing.frequency_hz)
    };
    let all = report.swings();
    let said = |at_rest: bool, when: &str| {
        let found: Vec<String> =
            all.iter().filter(|swing| swing.at_rest == at_rest).map(|swing| of(&swing)).collect();
        (!found.is_empty())
            .then(|| format!("Swings that the plan does not ask for, {when}: {}.", found.join(", ")))
    };
    [said(false, "over the run"), said(true, "while it rests")].into_iter().flatten().collect()
}

/// A joint that moves without its plan, or does not move or answer as its plan does; `None` if both move.
pub(super) fn stray(report: &Report, joint: &JointReplay) -> Option<String> {
    let name = &joint.name;
    let Travel { planned, measured, rests, small } = report.travel(joint);
    let both = || {
        let [measured, planned] = [measured, planned].map(|travel| position(joint.kind, travel));
        format!("{name} moves by {measured} in all, its plan by {planned}")
    };
    let starts = starts_of(joint.starts, joint.reversals);
    if small {
        let sizes = report.replay.rules.sizes(joint.kind);
        return Some(format!(
            "{name} goes {} and its plan {}, too slow or too short to tell starts: they are looked for from {} and {} a second on.",
            position(joint.kind, measured),
            position(joint.kind, planned),
            position(joint.kind, sizes.min_travel),
            position(joint.kind, sizes.start_speed)
        ));
    }
    match (joint.plan_moves, joint.moves) {
        (true, true) => None,
        (false, true) => Some(format!(
            "{name} moves although its plan rests: it is {} off at most, at {:.1} s, and half of that first at {:.1} s.",
            position(joint.kind, joint.tracking_error.peak),
            joint.tracking_error.peak_time_s,
            joint.tracking_error.half_peak_time_s
        )),
        (false, false) if joint.unplanned_starts > 0 => Some(format!(
            "The plan of {name} rests; the joint is shaken by the others: {} of less than {}, unplanned.",
            counted(joint.unplanned_starts, "start"),
            position(joint.kind, report.replay.rules.sizes(joint.kind).moves_travel)
        )),
        (false, false) if rests => Some(format!("{name} does not move, and neither does its plan.")),
        (true, false) if rests && joint.starts > 0 => {
            // Otherwise said before all.
            matches!(report.fault, Some(Fault::Stopped { .. }))
                .then(|| format!("{name} does not move although its plan does ({starts})."))
        }
        _ if joint.starts > 0 => Some(format!("{}: no answer to its plan can be told ({starts}).", both())),
        _ => Some(format!("{}: no start of either can be told.", both())),
    }
}

/// The interval of a delay that it hardly tells.
pub(super) fn wide(start: &Transition) -> String {
    const WIDE: (f64, f64) = (0.1, 0.5);
    let interval = start.onset_delay_interval_s.zip(start.onset_delay_s);
    let told = interval.filter(|([low, high], delay)| high - low > WIDE.0 + WIDE.1 * delay.abs());
    told.map_or(String::new(), |([low, high], _)| format!(" (95 %: {} to {})", ms(low), ms(high)))
}

pub(super) fn worst_sentence(worst: &Transition) -> String {
    let lateness = match worst.onset_delay_s {
        Some(delay_s) if ms(delay_s) == "0" => format!("leaves with its plan{}", wide(worst)),
        Some(delay_s) if delay_s >= 0.0 => format!("leaves {} ms after its plan{}", ms(delay_s), wide(worst)),
        Some(delay_s) => format!("leaves {} ms before its plan{}", ms(-delay_s), wide(worst)),
        None => match worst.answer {
            Answer::Creeps => "creeps or already moves when its plan starts".to_owned(),
            Answer::Unclear => "has a start that cannot be timed: its planned motion is too small, or its samples are too far apart".to_owned(),
            Answer::Timed | Answer::Never => "does not follow its plan".to_owned(),
        },
    };
    format!(
        "{} at {:.2} s {lateness}; its error peaks at {}, {} ms after the planned start.",
        worst.joint,
        worst.planned_onset_s,
        position(worst.joint_kind, worst.peak_error),
        ms(worst.time_to_peak_s)
    )
}

fn transitions(replay: &Replay, most: usize) -> Option<Section> {
    let all = replay.worst_first();
    let units = Units::of(replay.joints.iter().map(|joint| joint.kind));
    let table = units.table(TRANSITION, all.iter().take(most).map(|t| (*t, t.joint_kind)));
    let more = (all.len() > most).then(|| {
        Sentence::note(format!("and {} more with smaller peaks (--all lists them)", all.len() - most))
    });
    let mixed = weighed(&replay.rules, replay.joints.iter().map(|joint| joint.kind));
    (!all.is_empty()).then(|| {
        Section::new(Id::TRANSITIONS, "Transitions, worst first", [table]).with_all(more).with_all(mixed)
    })
}

fn joints(replay: &Replay, profiles: &Profiles) -> Section {
    let units = Units::of(replay.joints.iter().map(|joint| joint.kind));
    let mut table = units.table(JOINT, replay.joints.iter().map(|joint| (joint, joint.kind)));
    let course = Column::words("error over the run").meaning("Largest error in each part of the run.");
    table.columns.insert(1, course);
    for (k, row) in table.rows.iter_mut().enumerate() {
        let line = profiles.peaks.get(k).map_or(String::new(), |peaks| spark(peaks, profiles.most));
        row.insert(1, line);
    }
    Section::new(Id::JOINTS, "Joints", [table])
}

pub(super) fn lag(joint: &JointReplay) -> String {
    let interval = joint.lag_interval_s.map_or(String::new(), |[a, b]| format!(" ({}..{})", ms(a), ms(b)));
    joint.lag_s.map_or("-".to_owned(), |lag_s| ms(lag_s) + &interval)
}

/// One for each limit that was set.
pub(crate) fn verdicts(report: &Report) -> Vec<Sentence> {
    let joints = &report.replay.joints;
    let undated: usize = joints.iter().map(|joint| joint.undated_starts).sum();
    let starts = joints.iter().map(|joint| joint.starts).sum();
    let unseen = report.remarks.as_slice().iter().any(|remark| remark.code == Code::UnpairedJoint);
    report.gates.iter().map(|result| verdict(result, [undated, starts], unseen)).collect()
}

/// `unseen`: whether joints were left out because plan or measurement of them is missing.
fn verdict(result: &GateResult, [undated, starts]: [usize; 2], unseen: bool) -> Sentence {
    let (gate, kind) = (result.gate, result.kind());
    // What has no time is not judged.
    let part = if gate.key == ONSET_DELAY_LIMIT && undated > 0 {
        format!("; {undated} of {} have no time and are not judged", counted(starts, "start"))
    } else {
        String::new()
    };
    let part = if unseen { part + "; joints that were left out are not judged" } else { part };
    let limit = with_unit(gate.dimension, kind, result.limit);
    let allowed = format!("{limit} allowed{part}");
    let sentence = |found: String| {
        let (limit, found) = (format!("Limit on {}", gate.name), format!("{found}, {allowed}."));
        Sentence::Verdict { limit, kept: result.kept, found }
    };
    let Some(joint) = &result.joint else { return sentence("nothing to judge".to_owned()) };
    let time = result.time_s.map_or(String::new(), |t| format!(" at {t:.2} s"));
    let worst = result.worst.map_or(gate.missing.to_owned(), |w| with_unit(gate.dimension, kind, w));
    let worst = if worst == limit && !result.kept { format!("a little more than {worst}") } else { worst };
    sentence(format!("{joint}{time} has {worst}"))
}
