//! The checks one by one.

use super::super::outcome::CAREFUL;
use super::{
    Check, Fastest, Finding, JointTrust, Left, Level, Outside, Overall, Reason, Replanned, Sharpest, Steep,
    TooFast,
};
use crate::{
    fit::{Character, JointFit, LEAST_SKILL, Step, TRAVELS_RAD},
    math::range,
    plan::{BETWEEN, Limit, Margin, Setup},
    remark::Code,
    series::{JointKind, Series, Track},
    units::DEGREE_RAD,
    workflow::{
        plan::MarginEntry,
        replan::{Commanded, Decision, JointCommand},
    },
};

/// A command begins and ends where its plan does up to this, rad.
const SAME_RAD: f64 = 1e-3 * DEGREE_RAD;

/// Speed, rad/s, and acceleration, rad/s², that are rest.
const REST: [f64; 2] = [1e-2 * DEGREE_RAD, 0.1 * DEGREE_RAD];

/// A command that leaves its plan by more, rad, or takes the tool off it by more, m, needs room that people may not leave.
const WIDE: (f64, f64) = (3.0 * DEGREE_RAD, 0.1);

/// A tool that is sent farther off its plan, m, is sent somewhere else.
const ELSEWHERE_M: f64 = 1.0;

/// Errors up to this times another are no larger.
const SAME_ERROR: f64 = 1.02;

/// More than this times what nine runs of ten stay below is another machine than the fitted one.
const OTHER_MACHINE: f64 = 2.0;

/// A run whose error is at most this share of the best before it was helped by its command.
const HELPED: f64 = 0.75;

pub(super) fn all(replanned: &Replanned) -> impl Iterator<Item = Check> {
    let command = replanned.command.as_ref().filter(|command| command.applied());
    let sent = command.map_or(&replanned.plan, |command| &command.series);
    let always =
        [ends(&replanned.plan, sent), rest(sent, command), limits(replanned, command), trust(replanned)];
    let others = [
        newest(replanned),
        super::supply::check(replanned).or_else(|| together(replanned)).or_else(|| too_fast(replanned)),
        promise(replanned),
        Some(outlook(replanned)),
        whole(replanned),
        leave(replanned, command),
        gain(replanned, command),
    ];
    always.into_iter().chain(others.into_iter().flatten())
}

/// Bad if a number is above its bound, or none.
fn within(value: f64, most: f64) -> Level {
    if value <= most { Level::Good } else { Level::Stop }
}

fn caution(if_so: bool) -> Level {
    if if_so { Level::Caution } else { Level::Good }
}

/// The largest over all tracks; what is not a number stays.
fn most(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |most, value| if most.is_nan() || value.abs() <= most { most } else { value.abs() })
}

fn ends(plan: &Series, sent: &Series) -> Check {
    let apart = |at: fn(&[f64]) -> Option<&f64>| {
        most(plan.tracks.iter().map(|track| {
            let of = |track: &Track| at(track.position()).copied();
            let both = of(track).zip(sent.track(track.name()).and_then(of));
            both.map_or(f64::NAN, |(planned, sent)| sent - planned)
        }))
    };
    let (start_rad, end_rad) = (apart(<[f64]>::first), apart(<[f64]>::last));
    let level = within(start_rad, SAME_RAD).max(within(end_rad, SAME_RAD));
    Check { level, finding: Finding::Ends { start_rad, end_rad } }
}

fn rest(sent: &Series, command: Option<&Commanded>) -> Check {
    let speed = |track: &Track| match (track.velocity(), track.t_s(), track.position()) {
        (Some(speed), ..) => speed.last().copied().unwrap_or(f64::NAN),
        (None, [.., t0, t1], [.., p0, p1]) => (p1 - p0) / (t1 - t0),
        _ => f64::NAN,
    };
    let speed_rad_s = most(sent.tracks.iter().map(speed));
    let last = |values: &Vec<f64>| values.last().copied().unwrap_or(f64::NAN);
    let acceleration_rad_s2 = command.map(|command| most(command.acceleration_rad_s2.iter().map(last)));
    let level = within(speed_rad_s, REST[0]).max(within(acceleration_rad_s2.unwrap_or(0.0), REST[1]));
    Check { level, finding: Finding::Rest { speed_rad_s, acceleration_rad_s2 } }
}

/// The curve that a controller makes of the points of a plan at its limits may lie beyond them by this share; more is broken.
/// Plan and correction may each take [`BETWEEN`] of it.
const BEYOND: f64 = 0.01;

/// Torques and forces of rods are those of the plan: a command has none.
fn limits(replanned: &Replanned, command: Option<&Commanded>) -> Check {
    let of_plan = replanned.evaluation.iter().flat_map(|evaluation| &evaluation.margins);
    let of_command = command.map_or(&[][..], |command| &command.margins);
    let loads = [Limit::Torque, Limit::RodForce];
    let mut all: Vec<Margin> = of_command.to_vec();
    all.extend(of_plan.filter(|margin| of_command.is_empty() || loads.contains(&margin.limit)));
    all.sort_by(|a, b| b.share.total_cmp(&a.share));
    let beyond =
        |by: f64| all.iter().filter(|margin| margin.share > 1.0 + by || margin.share.is_nan()).count();
    let (broken, between) = (beyond(BEYOND), beyond(2.0 * BETWEEN) - beyond(BEYOND));
    let mut kinds: Vec<Margin> = Vec::new();
    for margin in &all {
        if kinds.iter().all(|other| other.limit != margin.limit) {
            kinds.push(*margin);
        }
    }
    let known = |limit: &Limit| kinds.iter().any(|margin| margin.limit == *limit);
    let (names, setup) = replanned
        .request
        .as_ref()
        .map_or_else(Default::default, |request| (request.setup.joint_names(), Some(&request.setup)));
    let missing = Limit::OF_JOINT.into_iter().chain(Limit::OF_ARM).filter(|limit| !known(limit));
    let (unchecked, unlimited): (Vec<Limit>, Vec<Limit>) =
        missing.partition(|limit| setup.is_some_and(|setup| setup.is_limited(*limit)));
    let by_samples = command.zip(setup).filter(|_| unchecked.contains(&Limit::Acceleration));
    let steep = by_samples.and_then(|(command, setup)| steep(command, setup));
    let doubted = between > 0 || all.is_empty() || steep.is_some();
    let level = if broken > 0 { Level::Stop } else { caution(doubted) };
    let nearest = MarginEntry::all(&kinds, &names);
    let unknown = command.filter(|_| all.is_empty());
    let (fastest, sharpest) = (unknown.and_then(fastest), unknown.and_then(sharpest));
    let outside = unknown.map_or_else(Vec::new, |command| outside(replanned, command));
    let finding =
        Finding::Limits { broken, between, nearest, unlimited, unchecked, steep, fastest, sharpest, outside };
    Check { level, finding }
}

/// Accelerations by samples that are beyond a limit by more than this share are.
const ABOUT: f64 = 0.2;

/// The joint that is accelerated beyond its limit by most, by the samples of command and plan.
fn steep(command: &Commanded, setup: &Setup) -> Option<Steep> {
    let own = |(track, sent): (&Track, &Vec<f64>)| {
        let joint = setup.joint_names().iter().position(|name| name == track.name())?;
        let acceleration_rad_s2 = sent.iter().fold(0.0, |most: f64, one| most.max(one.abs()));
        let limit_rad_s2 = setup.joint_limits(joint)?[2][1];
        let (joint, kind) = (track.name().to_owned(), track.kind());
        Some(Steep { joint, kind, acceleration_rad_s2, limit_rad_s2 })
    };
    let ratio = |of: &Steep| of.acceleration_rad_s2 / of.limit_rad_s2;
    let all = command.series.tracks.iter().zip(&command.acceleration_rad_s2).filter_map(own);
    all.filter(|of| ratio(of) > 1.0 + ABOUT).max_by(|a, b| ratio(a).total_cmp(&ratio(b)))
}

/// A joint that is accelerated more than its plan by this factor is told where limits are unknown.
const SHARPER: f64 = 2.0;

fn sharpest(command: &Commanded) -> Option<Sharpest> {
    let joints = command.joints.iter().filter(|joint| joint.acceleration_ratio >= SHARPER);
    let joint = joints.max_by(|a, b| a.acceleration_ratio.total_cmp(&b.acceleration_ratio))?;
    Some(Sharpest { joint: joint.name.clone(), ratio: joint.acceleration_ratio })
}

/// Beyond the range of a plan by less than this share of it is told nowhere.
const OUTSIDE: f64 = 0.01;

fn outside(replanned: &Replanned, command: &Commanded) -> Vec<Outside> {
    let of = |joint: &JointCommand| {
        let planned = replanned.plan.track(&joint.name)?;
        let [low, high] = range(planned.position().iter().copied());
        let [least, most] = joint.range_rad;
        let (below, above) = (low - least, most - high);
        let (reaches_rad, beyond_rad) = if below > above { (least, below) } else { (most, above) };
        let (name, kind) = (joint.name.clone(), joint.kind);
        (beyond_rad > OUTSIDE * (high - low)).then_some(Outside {
            joint: name,
            kind,
            reaches_rad,
            beyond_rad,
        })
    };
    command.joints.iter().filter_map(of).collect()
}

/// A joint that is sent faster than its plan by this factor is told where limits are unknown.
const FASTER: f64 = 1.5;

fn fastest(command: &Commanded) -> Option<Fastest> {
    let joints = command.joints.iter().filter(|joint| joint.speed_ratio > FASTER);
    let joint = joints.max_by(|a, b| a.speed_ratio.total_cmp(&b.speed_ratio))?;
    let speed = command.series.track(&joint.name)?.velocity()?;
    let (name, kind) = (joint.name.clone(), joint.kind);
    let speed_rad_s = most(speed.iter().copied());
    Some(Fastest { joint: name, kind, speed_rad_s, ratio: joint.speed_ratio })
}

/// A newest run from which nothing is learnt: what went wrong there goes wrong again.
fn newest(replanned: &Replanned) -> Option<Check> {
    let (code, why) = replanned.newest_left_out.clone()?;
    let level = if code == Code::OtherTime { Level::Stop } else { Level::Caution };
    Some(Check { level, finding: Finding::Newest { why } })
}

/// A plan that asks for less than this share beyond what its joints share is not told.
const LITTLE: f64 = 0.03;

/// What a plan asks for beyond what its joints share; each alone then looks too slow for it.
fn together(replanned: &Replanned) -> Option<Check> {
    let limit = replanned.fit.shared.clone()?;
    let (asked, at_s) = limit.asked(&replanned.plan)?;
    let finding = Finding::Together { limit, asked, at_s };
    (asked > 1.0 + LITTLE).then_some(Check { level: Level::Caution, finding })
}

/// Speeds of a plan are looked at over so many of its steps: angles may be rounded.
const OVER_STEPS: usize = 10;

/// Of the joints whose plan is beyond the interval of their own speed limit the one that is so by most.
fn too_fast(replanned: &Replanned) -> Option<Check> {
    let of_joint = |fit: &JointFit| {
        let plan = replanned.plan.track(&fit.name)?;
        let later = plan.t_s().iter().zip(plan.position()).skip(OVER_STEPS);
        let speeds =
            later.zip(plan.t_s().iter().zip(plan.position())).map(|(b, a)| (b.1 - a.1) / (b.0 - a.0));
        let [least, most] = range(speeds);
        let sides = [(most, &fit.speed_limit_growing_rad_s), (-least, &fit.speed_limit_shrinking_rad_s)];
        let beyond = sides.into_iter().filter_map(|(planned_rad_s, limit)| {
            let limit_rad_s = [limit.value?, limit.interval.filter(|_| limit.identified)?[1]];
            let (joint, kind, also) = (fit.name.clone(), fit.kind, Vec::new());
            (planned_rad_s > limit_rad_s[1]).then_some(TooFast {
                joint,
                kind,
                planned_rad_s,
                limit_rad_s,
                also,
            })
        });
        beyond.max_by(|a, b| by_limit(a).total_cmp(&by_limit(b)))
    };
    let mut all: Vec<TooFast> = replanned.fit.joints.iter().filter_map(of_joint).collect();
    all.sort_by(|a, b| by_limit(b).total_cmp(&by_limit(a)));
    let also = all.iter().skip(1).map(|joint| joint.joint.clone()).collect();
    let finding = Finding::TooFast(TooFast { also, ..all.into_iter().next()? });
    Some(Check { level: Level::Caution, finding })
}

fn by_limit(joint: &TooFast) -> f64 {
    joint.planned_rad_s / joint.limit_rad_s[0]
}

fn trust(replanned: &Replanned) -> Check {
    let made = |name: &str| replanned.command.iter().flat_map(|c| &c.joints).find(|made| made.name == name);
    let one = |track: &Track| {
        let (fit, made) = (replanned.fit.joint(track.name()), made(track.name()));
        let found = made.and_then(|made| made.oscillation);
        let character = found.map(|found| found.character);
        let known = fit.is_some_and(|fit| fit.model_holds && fit.held_out_r2 >= LEAST_SKILL);
        let astray = made.is_some_and(|made| made.step == Step::Astray);
        let [lowest, highest] = range(track.position().iter().copied());
        // A joint that is held, and does not oscillate, need not be known.
        let held = fit.is_none() && highest - lowest < TRAVELS_RAD;
        let level = match character {
            Some(Character::Hunts) => Level::Stop,
            Some(Character::Rings) => Level::Caution,
            _ => caution(!(known || held) || astray),
        };
        JointTrust {
            joint: track.name().to_owned(),
            level,
            corrected: made.is_some_and(JointCommand::applied),
            held_out_r2: fit.map(|fit| fit.held_out_r2),
            model_holds: fit.is_some_and(|fit| fit.model_holds),
            astray,
            character,
            frequency_hz: found.filter(|f| f.character != Character::Calm).map(|f| f.frequency_hz),
        }
    };
    let joints: Vec<JointTrust> = replanned.plan.tracks.iter().map(one).collect();
    let level = joints.iter().map(|joint| joint.level).max().unwrap_or(Level::Stop);
    Check { level, finding: Finding::Trust { joints } }
}

/// `None` if the last log carries no promise, or nothing was measured.
fn promise(replanned: &Replanned) -> Option<Check> {
    let run = replanned.past.runs.last()?;
    let (promised, usual_rad) = (run.promised?, run.mean_peak_rad?);
    let measured_mean_peak_rad = run.mean_peak_as_it_came_rad.unwrap_or(usual_rad);
    let bound_rad = promised.mean_peak_margin_rad;
    let before = replanned.past.runs.iter().rev().skip(1).filter_map(|run| run.mean_peak_rad);
    let best_before_rad = before.fold(f64::INFINITY, f64::min);
    let level = match measured_mean_peak_rad {
        came if came <= bound_rad => Level::Good,
        // One start that came so in this run alone.
        _ if usual_rad <= bound_rad => Level::Caution,
        // What was promised of the machine before it changed is no reason against what was learnt since, nor is too much of a promise
        // against a command that served the machine well, or against one that is returned to.
        came if came <= OTHER_MACHINE * bound_rad || changed(replanned) || returns(replanned) => {
            Level::Caution
        }
        came if best_before_rad.is_finite() && came <= HELPED * best_before_rad => Level::Caution,
        _ => Level::Stop,
    };
    let finding = Finding::Promise { log: run.log.clone(), promised, measured_mean_peak_rad };
    Some(Check { level, finding })
}

/// Whether what is sent is the command of an earlier run, not of the newest.
fn returns(replanned: &Replanned) -> bool {
    matches!(replanned.past.decision, Decision::Keep { run, .. } if run + 1 < replanned.past.runs.len())
}

/// Whether the machine changed since the last command was made, as far as its runs tell, or changes again and again.
fn changed(replanned: &Replanned) -> bool {
    let said = replanned.remarks.as_slice().iter().filter(|remark| remark.code == Code::MachineChanged);
    match said.count() {
        0 => false,
        1 => replanned.past.runs.len() < 2,
        _ => true,
    }
}

fn outlook(replanned: &Replanned) -> Check {
    let (expected, last_mean_peak_rad) = (replanned.promise(), replanned.before.measured_mean_peak_rad);
    let worse = last_mean_peak_rad.is_some_and(|last_rad| expected.mean_peak_rad > SAME_ERROR * last_rad);
    Check { level: caution(worse), finding: Finding::Outlook { last_mean_peak_rad, expected } }
}

/// `None` unless the last run was corrected, and one was not, and where something came in it by chance.
fn whole(replanned: &Replanned) -> Option<Check> {
    let runs = &replanned.past.runs;
    let sure = replanned.command.iter().flat_map(|c| &c.joints).all(|joint| joint.by_chance.is_none());
    let overall = Overall::of(runs, runs.len().checked_sub(1)?).filter(|_| sure)?;
    let worse = overall.is_worse() || overall.is_worse_than_before() && !returns(replanned);
    Some(Check { level: caution(worse), finding: Finding::Whole { overall } })
}

/// `None` where the command is the plan.
fn leave(replanned: &Replanned, command: Option<&Commanded>) -> Option<Check> {
    let (plan, sent) = (&replanned.plan, &command?.series);
    let mut joints: Vec<Left> = Vec::new();
    for track in &plan.tracks {
        let Some(sent) = sent.track(track.name()) else { continue };
        let far = |(t_s, position): (&f64, &f64)| ((position - track.held_at(*t_s).position).abs(), *t_s);
        let farthest = sent.t_s().iter().zip(sent.position()).map(far).max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((distance_rad, t_s)) = farthest else { continue };
        let found = Left { joint: track.name().to_owned(), kind: track.kind(), distance_rad, t_s };
        match joints.iter_mut().find(|other| other.kind == found.kind) {
            Some(other) if other.distance_rad >= distance_rad => {}
            Some(other) => *other = found,
            None => joints.push(found),
        }
    }
    let tool_m = tool_m(replanned, sent);
    let most = |kind| if kind == JointKind::Slides { WIDE.1 } else { WIDE.0 };
    let wide = joints.iter().any(|left| left.distance_rad > most(left.kind))
        || tool_m.is_some_and(|tool_m| tool_m > WIDE.1);
    let mut joints = joints.into_iter();
    let finding = Finding::Leave { farthest: joints.next()?, also: joints.next(), tool_m };
    let elsewhere = tool_m.is_some_and(|tool_m| tool_m > ELSEWHERE_M);
    Some(Check { level: if elsewhere { Level::Stop } else { caution(wide) }, finding })
}

/// Largest distance of the tool from where the plan has it, m; `None` of one that lies on the joints' axes, and goes less than 0.1 mm.
fn tool_m(replanned: &Replanned, sent: &Series) -> Option<f64> {
    let setup = &replanned.request.as_ref()?.setup;
    let of = |series: &Series| -> Option<Vec<Track>> {
        setup.joint_names().iter().map(|name| series.track(name).cloned()).collect()
    };
    let sides = [of(&replanned.plan)?, of(sent)?];
    let t_s = sides[1].first()?.t_s();
    let place = |side: &[Track], t_s: f64| {
        let angle_rad: Vec<f64> = side.iter().map(|track| track.held_at(t_s).position).collect();
        setup.arm().chain.tool_pose(&angle_rad).translation.vector
    };
    let off_m = most(t_s.iter().map(|t_s| (place(&sides[0], *t_s) - place(&sides[1], *t_s)).norm()));
    (off_m.is_nan() || off_m > 1e-4).then_some(off_m)
}

/// `None` where nothing is corrected.
fn gain(replanned: &Replanned, command: Option<&Commanded>) -> Option<Check> {
    let past = &replanned.past;
    let first = |step: &Step| matches!(step, Step::Model | Step::First { .. });
    let reason = |reason, holds: bool| holds.then_some(reason);
    let is_first = command?.joints.iter().filter(|joint| joint.applied()).any(|joint| first(&joint.step));
    let sends = past.decision == Decision::Send;
    let corrected = past.runs.iter().any(|run| run.corrected);
    let reasons = [
        reason(Reason::FirstCommand, is_first && !corrected),
        reason(Reason::MachineChanged, sends && changed(replanned)),
        reason(Reason::BrokenPromise, sends && past.trust < 1.0),
    ];
    let reasons: Vec<Reason> = reasons.into_iter().flatten().collect();
    // A correction that is kept is sent whole.
    let gain = if sends { past.gain * past.trust } else { past.gain };
    let level = caution(gain > CAREFUL && !reasons.is_empty());
    Some(Check { level, finding: Finding::Gain { gain, reasons } })
}
