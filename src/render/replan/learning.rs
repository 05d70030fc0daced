//! What was learnt from run to run, and the command that follows.

use super::{OF_COMMAND, joint_name};
use crate::{
    fit::{Character, Step},
    plan::Margin,
    render::{
        kit::{Id, NONE, Section, Sentence, Table, counted, deg, optional},
        plan,
    },
    workflow::replan::{Decision, JointCommand, PastRun, Replanned},
};

/// A limit used more than this is near.
const NEAR: f64 = 0.9;

/// What to do, where that is not just to send the command.
pub(super) fn verdict(replanned: &Replanned) -> Option<String> {
    let hunting: Vec<String> = (replanned.command.iter().flat_map(|command| &command.joints))
        .filter_map(|joint| Some((joint, joint.oscillation?)))
        .filter(|(_, found)| found.character == Character::Hunts)
        .map(|(joint, found)| format!("{} at {:.2} Hz", joint.name, found.frequency_hz))
        .collect();
    if let Some(command) = replanned.command.as_ref().filter(|command| command.joints.iter().all(untouched)) {
        return (command.hunting > 0).then(|| {
            format!(
                "Nothing is corrected: {} oscillate by themselves ({}), and a correction may throw such a loop into a \
                 larger oscillation. Mend the controllers first: less gain, or less integral action.",
                counted(command.hunting, "joint"),
                hunting.join(", ")
            )
        });
    }
    match &replanned.past.decision {
        Decision::Send => None,
        Decision::Keep { run, best_rad, last_rad } => {
            let name = replanned.past.runs.get(*run).map_or("the best run", |run| run.log.as_str());
            Some(format!(
                "Keep the command of {name}: its mean peak is {} deg, the last run has {} deg, which is less than a tenth \
                 better than the best run before it. What is left comes differently from run to run.",
                deg(*best_rad),
                deg(*last_rad)
            ))
        }
    }
}

fn untouched(joint: &JointCommand) -> bool {
    !joint.applied()
}

/// Runs of the plan so far, promised beside measured.
pub(super) fn runs(replanned: &Replanned) -> Option<Section> {
    let runs = &replanned.past.runs;
    if runs.len() < 2 && runs.iter().all(|run| run.promised.is_none()) {
        return None;
    }
    let row = |run: &PastRun| {
        vec![
            run.log.clone(),
            if run.corrected { "corrected" } else { "the plan" }.to_owned(),
            optional(run.promised.map(|promised| promised.mean_peak_rad), deg),
            optional(run.promised.map(|promised| promised.mean_peak_margin_rad), deg),
            optional(run.mean_peak_rad, deg),
        ]
    };
    let numbers = ["promised deg", "90 % below deg", "measured deg"];
    Some(
        Section::new(
            Id::OTHER,
            "Runs of this plan",
            [Table::new(&["run", "sent"], &numbers, runs.iter().map(row))],
        )
        .with(Sentence::note(
            "Mean peak error of starts and reversals: what its command promised, and what came.",
        ))
        .with_all(distrust(replanned).map(Sentence::Finding)),
    )
}

/// What a broken promise costs.
fn distrust(replanned: &Replanned) -> Option<String> {
    let (trust, last) = (replanned.past.trust, replanned.past.runs.last()?);
    (trust < 1.0).then(|| {
        format!(
            "{} came above what nine runs of ten should stay below: {:.0} % of the usual step is taken.",
            last.log,
            100.0 * trust
        )
    })
}

/// The command joint by joint.
pub(super) fn command(replanned: &Replanned) -> Option<Section> {
    let command = replanned.command.as_ref()?;
    let numbers = [
        "held-out R2",
        "cut-off Hz",
        "correction deg",
        "rms error deg",
        "spread deg",
        "speed ratio",
        "acceleration ratio",
    ];
    let rows = command.joints.iter().map(|joint| row(replanned, joint));
    let section = Section::new(Id::OTHER, "Command", [Table::new(&["joint", "by"], &numbers, rows)])
        .with(Sentence::note(
            "By: what the correction is made from. Rms error: measured in the last run, below 1.5 Hz; spread: the part of it that \
             differs between the last two runs for no reason that the model knows. Ratios: peak speed and acceleration \
             of the command over those of the plan.",
        ))
        .with_all(rings(&command.joints).map(Sentence::Finding))
        .with_all(cut_off(&command.joints).map(Sentence::Advice));
    Some(section.with(Sentence::finding(nearest(replanned, &command.margins))))
}

fn row(replanned: &Replanned, joint: &JointCommand) -> Vec<String> {
    let skill = replanned.fit.joint(&joint.name).map(|fit| format!("{:.2}", fit.held_out_r2));
    let run = |from: usize| {
        replanned.past.runs.get(from).map_or_else(|| format!("run {}", from + 1), |run| run.log.clone())
    };
    let by = match joint.step {
        Step::Model => "model".to_owned(),
        Step::First { model_weight } => format!("{:.0} % model, else data", 100.0 * model_weight),
        Step::Later { from, gain } => format!("{} + {:.2} error", run(from), gain),
        Step::Kept { from } => format!("{} again", run(from)),
        Step::None => "not corrected".to_owned(),
    };
    vec![
        joint.name.clone(),
        by,
        skill.unwrap_or_else(|| NONE.to_owned()),
        if joint.applied() { format!("{:.2}", joint.cut_off_hz) } else { NONE.to_owned() },
        deg(joint.peak_correction_rad),
        optional(joint.rms_error_rad.last().copied(), deg),
        optional(joint.spread_rad, deg),
        format!("{:.2}", joint.speed_ratio),
        format!("{:.2}", joint.acceleration_ratio),
    ]
}

/// Joints that ring, with their frequency.
fn rings(joints: &[JointCommand]) -> Option<String> {
    let of = |joint: &JointCommand| {
        let found = joint.oscillation.filter(|found| found.character != Character::Calm)?;
        let word = if found.character == Character::Hunts { "hunts" } else { "rings" };
        Some(format!("{} {word} at {:.2} Hz", joint.name, found.frequency_hz))
    };
    let all: Vec<String> = joints.iter().filter_map(of).collect();
    (!all.is_empty()).then(|| {
        format!(
            "{}: the model does not explain that, so the correction is slower and milder.",
            all.join(", ")
        )
    })
}

/// Which corrections would have been larger.
fn cut_off(joints: &[JointCommand]) -> Option<String> {
    let all: Vec<&JointCommand> =
        joints.iter().filter(|joint| joint.peak_correction_rad > 0.98 * joint.most_correction_rad).collect();
    let most = all.iter().map(|joint| joint.peak_correction_rad).reduce(f64::max)?;
    let names: Vec<&str> = all.iter().map(|joint| joint.name.as_str()).collect();
    Some(format!(
        "The correction is limited to {} deg on {}; a larger --max-correction-deg would remove more of the error.",
        deg(most),
        names.join(", ")
    ))
}

fn nearest(replanned: &Replanned, margins: &[Margin]) -> String {
    let mut own: Vec<&Margin> = margins
        .iter()
        .filter(|margin| OF_COMMAND.contains(&margin.limit) || margin.joint.is_none())
        .collect();
    own.sort_by(|a, b| b.share.total_cmp(&a.share));
    let Some(worst) = own.first() else {
        return "Without a task the limits of the arm are unknown: check the command against yours before you send it.".into();
    };
    let near = own.iter().filter(|margin| margin.share > NEAR).count();
    let joint = joint_name(replanned, worst.joint).map_or(String::new(), |name| format!("{name} "));
    format!(
        "Limits were checked on the command: the nearest is {joint}{}, {} of {} allowed, at {:.2} s{}.",
        plan::name(worst.limit),
        plan::shown(worst.limit, worst.value.abs()),
        plan::shown(worst.limit, worst.allowed),
        worst.t_s,
        if near > 1 { format!("; {near} are used to 90 % or more") } else { String::new() }
    )
}
