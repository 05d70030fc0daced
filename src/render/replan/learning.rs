//! What was learnt from run to run, and the command that follows.

use crate::{
    fit::{AFTER_S, Step},
    render::{
        kit::{Column, Id, NONE, Section, Sentence, Table, argument, counted, optional},
        metric::{Units, position, unit},
    },
    replay::Dimension,
    series::{
        JointKind::{self, Slides, Turns},
        Track,
    },
    workflow::replan::{Checks, Decision, Finding, JointCommand, KeepReason, PastRun, Replanned},
};

/// Less of what comes after a plan hides an overshoot, s.
const LEAST_AFTER_S: f64 = 1.0;

/// How means over the joints are told.
pub(super) fn units(replanned: &Replanned) -> Units {
    Units::of(replanned.plan.tracks.iter().map(Track::kind))
}

/// What to keep, where nothing more is to be gained, and why.
pub(super) fn kept(replanned: &Replanned) -> Option<String> {
    let Decision::Keep { run, because, best_rad, last_rad } = &replanned.past.decision else { return None };
    let shown = |rad: f64| units(replanned).mean(rad);
    let (best, last) = (shown(*best_rad), shown(*last_rad));
    let kept = match replanned.past.runs.get(*run) {
        Some(run) if run.corrected => format!("Keep the command of {}: its mean peak is {best}", run.log),
        Some(run) => {
            format!("Send the plan as it is, without a correction: its mean peak was {best} in {}", run.log)
        }
        None => format!("Keep what was sent in the best run: its mean peak is {best}"),
    };
    let is_lost = matches!(because, KeepReason::GainedLittle) && grown(&replanned.past.runs, *last_rad);
    let why = match because {
        KeepReason::GainedLittle if last_rad > best_rad => {
            let of_last = replanned.past.runs.last().and_then(|run| run.mean_peak_rad);
            let is_last = of_last.is_some_and(|rad| (rad - last_rad).abs() < 1e-12);
            let what = if is_last { "the last run has" } else { "the last other correction had" };
            format!(", {what} {last}, which is no better.")
        }
        KeepReason::GainedLittle if is_lost => {
            ", more than the best run before it had: what is sent comes to more now than it did then."
                .to_owned()
        }
        KeepReason::GainedLittle => ", which is no better than the best run before it by a tenth.".to_owned(),
        KeepReason::Settled => {
            ". Less than a tenth of that is expected to be gained by another correction.".to_owned()
        }
        KeepReason::Failed { corrections } => {
            format!("; {} gained nothing.", counted(*corrections, "correction"))
        }
        KeepReason::ExpectedWorse { expected_rad } => {
            format!("; another correction is expected to give {}.", shown(*expected_rad))
        }
        KeepReason::Undone { before_rad } => return Some(undone(replanned, &shown(*before_rad), &last)),
    };
    let joints = replanned.command.iter().flat_map(|command| &command.joints);
    let other = joints.filter(|joint| matches!(joint.step, Step::Kept { from, .. } if from != *run));
    let other: Vec<&str> = other.map(|joint| joint.name.as_str()).collect();
    let but = if other.is_empty() {
        String::new()
    } else {
        format!(" Not for {}: it had more error over the whole run there than before.", other.join(", "))
    };
    let then = match replanned.past.runs.last().filter(|_| is_lost) {
        Some(run) => format!(
            " If the machine has drifted since, a correction learnt from the newest run alone may do better, `hydrotrace replan {} \
             --keep-plan -o anew.mcap`.",
            argument(&run.path)
        ),
        None => repeats(replanned).unwrap_or_default().to_owned(),
    };
    Some(kept + &why + &but + &then)
}

/// What to do where all that a command gained was undone in the newest run.
fn undone(replanned: &Replanned, before: &str, now: &str) -> String {
    let log = replanned.past.runs.last().map_or("the last run", |run| &run.log);
    format!(
        "Look at the machine, then send the command of {log} again: it gave a mean peak of {before} before and {now} there, about as \
         much as no correction. A pump, a load, a valve or a hand can do that once, and one such run teaches nothing; if the next \
         one is alike, give both, and another command is learnt from them."
    )
}

/// Whether a run had clearly less than that.
fn grown(runs: &[PastRun], mean_peak_rad: f64) -> bool {
    runs.iter().filter_map(|run| run.mean_peak_rad).any(|rad| 1.1 * rad < mean_peak_rad)
}

/// Share of an error from which on its spread from run to run is most of it.
const MOSTLY: f64 = 0.7;

/// Whether what is left comes again; `None` where fewer than two runs tell.
fn repeats(replanned: &Replanned) -> Option<&'static str> {
    let joints = replanned.command.as_ref()?.joints.iter();
    let both = joints.filter_map(|joint| Some((joint.spread_rad?, *joint.rms_error_rad.last()?)));
    let (mut spread, mut error) = (0.0, 0.0);
    for (of_spread, of_error) in both {
        spread += of_spread * of_spread;
        error += of_error * of_error;
    }
    let Decision::Keep { because, .. } = &replanned.past.decision else { return None };
    let failed = matches!(because, KeepReason::Failed { .. });
    let surprised = replanned.past.runs.last().is_some_and(|run| {
        run.promised
            .zip(run.mean_peak_rad)
            .is_some_and(|(promised, came)| came > promised.mean_peak_margin_rad)
    });
    let of_none = matches!(because, KeepReason::ExpectedWorse { .. } | KeepReason::Settled);
    let told = error > 0.0 && !surprised && !of_none;
    told.then_some(match (spread >= MOSTLY * MOSTLY * error, failed) {
        (true, _) => " What is left comes differently from run to run.",
        (false, false) => " What is left comes again in every run, and the last correction hardly lessened it.",
        (false, true) => {
            " What is left comes again in every run, and no correction lifts it: where a limit of speed or flow, or a pump that \
             joints share, holds them back, a slower plan or fewer joints at once help."
        }
    })
}

/// Runs of the plan so far, promised beside measured.
pub(super) fn runs(replanned: &Replanned) -> Option<Section> {
    let runs = &replanned.past.runs;
    if runs.len() < 2 && runs.iter().all(|run| run.promised.is_none()) {
        return None;
    }
    let units = units(replanned);
    let shown = |rad: f64| units.mean_number(rad);
    let row = |run: &PastRun| {
        vec![
            run.log.clone(),
            if run.corrected { "corrected" } else { "the plan" }.to_owned(),
            optional(run.promised.map(|promised| promised.mean_peak_rad), shown),
            optional(run.promised.map(|promised| promised.mean_peak_margin_rad), shown),
            match run.mean_peak_as_it_came_rad {
                Some(came_rad) => format!("{} ({})", optional(run.mean_peak_rad, shown), shown(came_rad)),
                None => optional(run.mean_peak_rad, shown),
            },
        ]
    };
    let alone = runs.iter().any(|run| run.mean_peak_as_it_came_rad.is_some()).then(|| {
        Sentence::note("In brackets with a start that came so in that run alone, and counts as the next largest of its joint.")
    });
    let columns =
        ["promised", "90 % below", "measured"].map(|heading| Column::numbers(units.mean_heading(heading)));
    let columns = ["run", "sent"].map(Column::words).into_iter().chain(columns);
    Some(
        Section::new(
            Id::OTHER,
            "Runs of this plan",
            [Table::of(columns.collect::<Vec<_>>(), runs.iter().map(row))],
        )
        .with(Sentence::note(
            "Mean peak error of starts and reversals: what its command promised, and what came.",
        ))
        .with_all(alone)
        .with_all(distrust(replanned).map(Sentence::Finding)),
    )
}

/// What a broken promise costs.
fn distrust(replanned: &Replanned) -> Option<String> {
    let (trust, last) = (replanned.past.trust, replanned.past.runs.last()?);
    let sends = replanned.past.decision == Decision::Send;
    (sends && trust < 1.0).then(|| {
        format!(
            "{} came above what nine runs of ten should stay below, or the machine changes from run to run: {:.0} % of the usual \
             step is taken.",
            last.log,
            100.0 * trust
        )
    })
}

pub(super) fn command(replanned: &Replanned) -> Option<Section> {
    let command = replanned.command.as_ref()?;
    let units = Units::of(command.joints.iter().map(|joint| joint.kind));
    let [correction, rms, spread] =
        ["correction", "rms error", "spread"].map(|heading| units.heading(heading, Dimension::Position));
    let fixed = ["held-out R2", "cut-off Hz", "speed ratio", "acceleration ratio"].map(str::to_owned);
    let [skill, cut_off_hz, speed, acceleration] = fixed;
    let numbers = [skill, cut_off_hz, correction, rms, spread, speed, acceleration].map(Column::numbers);
    let columns: Vec<Column> = ["joint", "by"].map(Column::words).into_iter().chain(numbers).collect();
    let rows = command.joints.iter().map(|joint| row(replanned, joint, units));
    Some(Section::new(Id::OTHER, "Command", [Table::of(columns, rows)])
        .with(Sentence::note(
            "By: what the correction is made from. Rms error: measured in the last run, below 1.5 Hz; spread: the part of it that \
             differs between the last run and the one before, or one in which the same was sent, for no reason that the model \
             knows. Ratios: peak speed and acceleration \
             of the command over those of the plan.",
        ))
        .with_all(
            [Turns, Slides].into_iter().filter_map(|kind| cut_off(replanned, &command.joints, kind)).map(Sentence::Advice),
        )
        .with_all(stamped(replanned, &command.joints).map(|text| Sentence::note(text.to_owned())))
        .with_all(ends_early(replanned).map(Sentence::note))
        .with_all(others(replanned).map(Sentence::note)))
}

/// Logs that no run of this plan is in.
fn others(replanned: &Replanned) -> Option<String> {
    let others = &replanned.past.others;
    let said = match others.len() {
        0 => return None,
        1 => "holds another plan: it tells",
        _ => "hold other plans: they tell",
    };
    Some(format!("{} {said} of the machine, and of no error of this plan.", others.join(", ")))
}

/// What no log shows: an overshoot after the plan.
fn ends_early(replanned: &Replanned) -> Option<String> {
    let shortest = replanned.past.runs.iter().min_by(|a, b| a.after_s.total_cmp(&b.after_s))?;
    (shortest.after_s < LEAST_AFTER_S).then(|| {
        format!(
            "{} ends {:.1} s after the last motion of its plan: what comes later, such as an overshoot, is judged in no run. Let the \
             arm rest and the recorder run on for {AFTER_S:.0} s.",
            shortest.log, shortest.after_s
        )
    })
}

/// What a first correction hangs on that no log of one clock tells.
fn stamped(replanned: &Replanned, joints: &[JointCommand]) -> Option<&'static str> {
    let first = |joint: &JointCommand| joint.applied() && matches!(joint.step, Step::First { .. });
    (!replanned.delay_known && joints.iter().any(first)).then_some(
        "A recorder that stamps the measurement late looks like a lag of that size, and the command would come as much too \
         early: if it does, give --measured-delay-ms.",
    )
}

fn row(replanned: &Replanned, joint: &JointCommand, units: Units) -> Vec<String> {
    let skill = replanned.fit.joint(&joint.name).map(|fit| format!("{:.2}", fit.held_out_r2));
    let run = |from: usize| {
        replanned.past.runs.get(from).map_or_else(|| format!("run {}", from + 1), |run| run.log.clone())
    };
    let by = match joint.step {
        Step::Model => "model".to_owned(),
        Step::First { model_weight } => format!("{:.0} % model, else data", 100.0 * model_weight),
        Step::Later { from, gain } => format!("{} + {:.2} error", run(from), gain),
        Step::Rest { from, share } => format!("{} + {:.2} of its rest", run(from), share),
        Step::Kept { .. } if !joint.applied() => "the plan".to_owned(),
        Step::Kept { from, but: None } => format!("{} again", run(from)),
        Step::Kept { from, but: Some(less) } => format!("{} again, {} in part", run(from), run(less)),
        Step::Astray => "does not follow".to_owned(),
        Step::None => "not corrected".to_owned(),
    };
    let shown = |rad: Option<f64>| units.optional(Dimension::Position, joint.kind, rad);
    vec![
        joint.name.clone(),
        by,
        skill.unwrap_or_else(|| NONE.to_owned()),
        if joint.applied() { format!("{:.2}", joint.cut_off_hz) } else { NONE.to_owned() },
        shown(Some(joint.peak_correction_rad)),
        shown(joint.rms_error_rad.last().copied()),
        shown(joint.spread_rad),
        format!("{:.2}", joint.speed_ratio),
        format!("{:.2}", joint.acceleration_ratio),
    ]
}

/// Which corrections of joints of a kind would have been larger, but of those that more does not help.
fn cut_off(replanned: &Replanned, joints: &[JointCommand], kind: JointKind) -> Option<String> {
    let is_slow = |joint: &JointCommand| {
        let checks = Checks::of(replanned).list;
        checks.iter().any(|check| matches!(&check.finding, Finding::TooFast(of) if of.joint == joint.name))
    };
    let cut = |joint: &&JointCommand| {
        let full = joint.peak_correction_rad > 0.98 * joint.most_correction_rad;
        joint.kind == kind && full && joint.stalled_rad <= 0.0 && !is_slow(joint)
    };
    let all: Vec<&JointCommand> = joints.iter().filter(cut).collect();
    let most = all.iter().map(|joint| joint.peak_correction_rad).reduce(f64::max)?;
    let names: Vec<&str> = all.iter().map(|joint| joint.name.as_str()).collect();
    Some(format!(
        "The correction is limited to {} on {}; a larger --max-correction-{} may remove more of the error.",
        position(kind, most),
        names.join(", "),
        unit(Dimension::Position, kind)
    ))
}
