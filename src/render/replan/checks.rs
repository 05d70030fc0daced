//! "Safe to send?" in words.

use std::iter;

use crate::{
    fit::{Character, LEAST_SKILL, SharedLimit, Supply},
    render::{
        fit::{litres, shared, supply},
        kit::{Block, Check, Id, Mark, Section, Sentence, counted, mm, optional, share},
        metric::{Units, position},
    },
    workflow::replan::{self, Checks, Finding, JointTrust, Left, Level, Reason, TooFast, Verdict},
};

use super::limits;

pub(super) const ID: Id = Id("checks");

/// The verdict and every check; `units` says how means over the joints are told.
pub(super) fn section(checks: &Checks, units: Units) -> Section {
    Section::new(ID, "Safe to send?", [Block::from(Sentence::finding(verdict(checks))), list(checks, units)])
}

pub(super) fn list(checks: &Checks, units: Units) -> Block {
    let one = |check: &replan::Check| Check {
        mark: mark(check.level),
        name: name(&check.finding),
        found: words(check.level, &check.finding, units),
    };
    Block::Checks(checks.list.iter().map(one).collect())
}

pub(super) fn verdict(checks: &Checks) -> String {
    let why = |level: Level| {
        checks.at(level).map(|check| short(level, &check.finding)).collect::<Vec<_>>().join("; ")
    };
    match checks.verdict {
        Verdict::Send if growth(checks) > WORTH_SENDING => format!(
            "It may be sent, all {} checks are good; but {} error is expected than last time.",
            checks.list.len(),
            if growth(checks) > 1.0 { "more" } else { "hardly less" }
        ),
        Verdict::Send => format!("Yes, send it: all {} checks are good.", checks.list.len()),
        Verdict::HalfFirst => format!("Send half of the correction first: {}.", why(Level::Caution)),
        Verdict::CheckFirst => format!("Look first: {}.", why(Level::Caution)),
        Verdict::DoNotSend => format!("Do not send it: {}.", why(Level::Stop)),
    }
}

/// Less is no reason to send another command.
const WORTH_SENDING: f64 = 0.98;

/// The error that is expected by the last one.
fn growth(checks: &Checks) -> f64 {
    let of = |check: &replan::Check| match check.finding {
        Finding::Outlook { last_mean_peak_rad: Some(last_rad), expected } => {
            Some(expected.mean_peak_rad / last_rad)
        }
        _ => None,
    };
    checks.list.iter().find_map(of).unwrap_or_default()
}

/// What speaks against sending, in a few words.
fn short(level: Level, finding: &Finding) -> String {
    match finding {
        Finding::Ends { .. } => "it does not begin and end where the plan does".to_owned(),
        Finding::Rest { .. } => "it does not end at rest".to_owned(),
        Finding::Limits { broken, .. } if level == Level::Stop => {
            format!("{} broken", counted(*broken, "limit"))
        }
        Finding::Limits { nearest, .. } if nearest.is_empty() => "the limits are unknown".to_owned(),
        Finding::Limits { steep: Some(of), .. } => {
            format!("{} goes beyond its limit of acceleration", of.joint)
        }
        Finding::Limits { .. } => "a controller's curve goes a little beyond a limit".to_owned(),
        Finding::Trust { joints } => {
            let doubtful =
                joints.iter().filter(|joint| joint.level == level).map(|joint| joint.joint.as_str());
            let what = if level == Level::Stop { "oscillating by themselves" } else { "not known well" };
            format!("joints {what} ({})", doubtful.collect::<Vec<_>>().join(", "))
        }
        Finding::Newest { .. } => "the newest run went wrong".to_owned(),
        Finding::TooFast(of) => format!("the plan of {} is faster than the joint", of.joint),
        Finding::Together { .. } => "the plan asks for more than what its joints share".to_owned(),
        Finding::Supply { .. } => "the pump gives less than the plan asks for".to_owned(),
        Finding::Promise { .. } => "more error came than was promised".to_owned(),
        Finding::Outlook { .. } => "a larger error is expected".to_owned(),
        Finding::Whole { .. } => {
            "the last correction left more error over the whole run than none".to_owned()
        }
        Finding::Leave { .. } => "it leaves the plan far".to_owned(),
        Finding::Gain { reasons, .. } => because(reasons),
    }
}

pub(super) fn mark(level: Level) -> Mark {
    match level {
        Level::Good => Mark::Good,
        Level::Caution => Mark::Caution,
        Level::Stop => Mark::Bad,
    }
}

fn name(finding: &Finding) -> &'static str {
    match finding {
        Finding::Ends { .. } => "Both ends",
        Finding::Rest { .. } => "Rest at end",
        Finding::Limits { .. } => "Limits",
        Finding::Newest { .. } => "Newest run",
        Finding::TooFast(_) => "Too fast",
        Finding::Together { .. } => "Together",
        Finding::Supply { .. } => "Supply",
        Finding::Trust { .. } => "Model",
        Finding::Promise { .. } => "Last promise",
        Finding::Outlook { .. } => "Next error",
        Finding::Whole { .. } => "Whole run",
        Finding::Leave { .. } => "Off the plan",
        Finding::Gain { .. } => "Size of step",
    }
}

fn newest(why: &str) -> String {
    format!(
        "Nothing is learnt from {why}. Mend that first: what went wrong there goes wrong with this command, too."
    )
}

fn together(limit: &SharedLimit, asked: f64, at_s: f64) -> String {
    format!(
        "{} The plan asks for {asked:.2} times what they share, most at {at_s:.1} s: no command mends that, more time or fewer joints at \
         once do. The error that is expected next does not count it, and more comes.",
        shared(limit)
    )
}

fn starved(found: &Supply, asked_m3_s: Option<f64>) -> String {
    let asks =
        asked_m3_s.map_or(String::new(), |asked| format!(" The plan asks for up to {}.", litres(asked)));
    format!(
        "{}{asks} No command mends that; more time does, or fewer joints at once where several move. The error that is expected next does not count it.",
        supply(found)
    )
}

fn words(level: Level, finding: &Finding, units: Units) -> String {
    let shown = |rad: f64| units.mean(rad);
    let good = level == Level::Good;
    match finding {
        Finding::Ends { .. } if good => "It begins and ends where the plan does.".to_owned(),
        Finding::Ends { start_rad, end_rad } => format!(
            "It begins {} and ends {} away from the plan: the controller would jump.",
            shown(*start_rad),
            shown(*end_rad)
        ),
        Finding::Rest { speed_rad_s, acceleration_rad_s2 } => {
            let start = if good { "It ends at rest" } else { "It does not end at rest" };
            let acceleration =
                acceleration_rad_s2.map_or(String::new(), |a| format!(", acceleration {}/s2", shown(a)));
            format!("{start}: speed {}/s{acceleration}.", shown(*speed_rad_s))
        }
        Finding::Limits { .. } => limits::words(finding),
        Finding::TooFast(TooFast { joint, kind, planned_rad_s, limit_rad_s: [own, most], also }) => format!(
            "The plan of {joint} goes up to {}/s, and the joint was found to make {}/s, {}/s at most, in the runs of the fit{}: no command \
             mends that, a slower plan does, or, where joints share a pump or a supply, fewer of them at once.",
            position(*kind, *planned_rad_s),
            position(*kind, *own),
            position(*kind, *most),
            if also.is_empty() { String::new() } else { format!("; the same holds for {}", also.join(", ")) }
        ),
        Finding::Newest { why } => newest(why),
        Finding::Together { limit, asked, at_s } => together(limit, *asked, *at_s),
        Finding::Supply { supply: found, asked_m3_s } => starved(found, *asked_m3_s),
        Finding::Trust { joints } => trust(joints),
        Finding::Promise { log, promised, measured_mean_peak_rad } => format!(
            "{log} promised a mean peak error of {}, in nine runs of ten below {}; {} came{}.",
            shown(promised.mean_peak_rad),
            shown(promised.mean_peak_margin_rad),
            shown(*measured_mean_peak_rad),
            match level {
                Level::Good => "",
                Level::Caution => ", which is more",
                Level::Stop => ": find out what changed on the machine",
            }
        ),
        Finding::Outlook { last_mean_peak_rad: Some(last_rad), expected } if units.mixed() => format!(
            "Mean peak error of starts: {:.0} % of the last is expected, in nine runs of ten less than {:.0} %, over joints that turn and joints \
             that slide; each kind stands under EXPECTED.",
            100.0 * expected.mean_peak_rad / last_rad,
            100.0 * expected.mean_peak_margin_rad / last_rad
        ),
        Finding::Outlook { last_mean_peak_rad, expected } => format!(
            "Mean peak error of starts: {} last, {} expected, in nine runs of ten below {}.",
            optional(*last_mean_peak_rad, shown),
            shown(expected.mean_peak_rad),
            shown(expected.mean_peak_margin_rad)
        ),
        Finding::Whole { overall } => format!(
            "Error with rests and stops, rms over all joints and p95 of the worst joint: {} and {} in the last run; {} and {} with the \
             plan as it is{}{}.",
            shown(overall.rms_rad),
            shown(overall.p95_rad),
            shown(overall.plain_rms_rad),
            shown(overall.plain_p95_rad),
            overall.before_rad.map_or_else(String::new, |[rms_rad, p95_rad]| format!(
                ", {} and {} with the best correction before it",
                shown(rms_rad),
                shown(p95_rad)
            )),
            match (good, overall.is_worse()) {
                (true, _) => "",
                (false, true) => ": the correction gains at starts and loses more elsewhere",
                (false, false) =>
                    ": the last correction left more than that one, at rests, stops or in between",
            }
        ),
        Finding::Leave { farthest, also, tool_m } => leaves(level, (farthest, also.as_ref()), *tool_m),
        Finding::Gain { gain, reasons } => {
            let sent = share(*gain);
            match (level, reasons.is_empty()) {
                (Level::Good, true) => {
                    format!(
                        "{sent} of the correction is sent; none before it is known to have broken its promise."
                    )
                }
                (Level::Good, false) => format!("{sent} of the correction is sent: the careful step."),
                _ => format!(
                    "{sent} of the correction is sent, but {}: half of it (--gain 0.5) is wiser.",
                    because(reasons)
                ),
            }
        }
    }
}

fn because(reasons: &[Reason]) -> String {
    let one = |reason: &Reason| match reason {
        Reason::FirstCommand => "no correction of this plan was sent before",
        Reason::MachineChanged => "the machine has changed since the last command was made",
        Reason::BrokenPromise => "the last correction did not keep its promise",
    };
    reasons.iter().map(one).collect::<Vec<_>>().join(", and ")
}

/// How far joints, of each kind one, and the tool leave the plan.
fn leaves(level: Level, (farthest, also): (&Left, Option<&Left>), tool_m: Option<f64>) -> String {
    let tool = tool_m.map_or(String::new(), |m| format!(", up to {} mm at the tool", mm(m)));
    let advice = match level {
        Level::Stop => "send less of it (--gain 0.5), or a slower plan",
        Level::Good | Level::Caution => "keep that room free",
    };
    let one = |left: &Left| {
        format!("{} ({} at {:.1} s)", position(left.kind, left.distance_rad), left.joint, left.t_s)
    };
    let far: Vec<String> = iter::once(farthest).chain(also).map(one).collect();
    format!("It leaves the plan by up to {}{tool}: {advice}.", far.join(" and "))
}

fn trust(joints: &[JointTrust]) -> String {
    let of = |character: Character| -> Vec<String> {
        let own = joints.iter().filter(|joint| joint.character == Some(character));
        own.map(|joint| {
            format!("{} ({} Hz)", joint.joint, optional(joint.frequency_hz, |hz| format!("{hz:.2}")))
        })
        .collect()
    };
    let (hunting, ringing) = (of(Character::Hunts).join(", "), of(Character::Rings).join(", "));
    let mut found = Vec::new();
    if !hunting.is_empty() {
        found.push(format!(
            "Oscillating by themselves: {hunting}; mend their controllers, less gain or less integral action, or, of one \
             that does so one way alone, its counterbalance valve."
        ));
    }
    if !ringing.is_empty() {
        found.push(format!("Ringing: {ringing}; their corrections are slow and mild."));
    }
    let calm = joints.iter().filter(|joint| matches!(joint.character, None | Some(Character::Calm)));
    let some = joints.iter().any(|joint| joint.corrected);
    found.extend(
        calm.filter(|joint| joint.level != Level::Good && !joint.astray).map(|joint| doubt(joint, some)),
    );
    let astray = joints.iter().filter(|joint| joint.astray).map(|joint| joint.joint.as_str());
    let astray: Vec<&str> = astray.collect();
    if !astray.is_empty() {
        found.push(format!(
            "Not following the plan, their error is more than half of their motion: {}; they are not corrected: are sign, \
             zero, unit and name right, and do they move at all?",
            astray.join(", ")
        ));
    }
    if !hunting.is_empty() && joints.iter().all(|joint| !joint.corrected) {
        found.push(
            "Nothing is corrected: a correction may throw such a loop into a larger oscillation.".to_owned(),
        );
    }
    let skill = |joint: &JointTrust| Some(format!("{} {:.2}", joint.joint, joint.held_out_r2?));
    let skills: Vec<String> = joints.iter().filter_map(skill).collect();
    found.push(format!("Held-out R2: {} ({LEAST_SKILL} is needed).", skills.join(", ")));
    found.join(" ")
}

/// Of a joint that neither rings nor hunts; `some` are corrected.
fn doubt(joint: &JointTrust, some: bool) -> String {
    let name = &joint.joint;
    let sent = if joint.corrected || !some { "" } else { ", so it is not corrected" };
    match joint.held_out_r2 {
        None => format!("{name} was not fitted{sent}."),
        Some(r2) if r2 < LEAST_SKILL => format!("{name} is predicted badly{sent}."),
        Some(_) => format!("The model does not hold for {name}{sent}."),
    }
}
