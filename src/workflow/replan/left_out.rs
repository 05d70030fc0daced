//! Runs from which nothing is learnt: given twice, broken off, held back by an override, or with a joint that stood though it answers
//! in others, as of a valve without current, which says nothing of its machine.

use std::collections::BTreeMap;

use super::{Inputs, out_of_time::out_of_time};
use crate::{
    log::Recording,
    math::deviation,
    remark::{Code, Remarks},
    series::{Broken, Series, align, bridged},
    units::DEGREE_RAD,
    workflow::{
        carried::Carried,
        names::told_apart,
        same_plan::{ahead_s, cut},
    },
};

/// A joint that moves by a smaller share of its plan stands, one that moves by more than the other answers.
const STANDS: f64 = 0.03;
const ANSWERS: f64 = 0.5;
/// What is sent later than its plan by more was held back, s: corrections run ahead.
const BEHIND_S: f64 = 0.5;
/// Joints that lead their plan by more were sent their command early, s: no correction asks for that.
const EARLY_S: f64 = 0.25;
/// Plans whose motions differ by less, as a share, may be one.
const ALIKE: f64 = 0.05;
/// Plans that move less are not judged, rad: root mean square about the mean.
const LEAST_RAD: f64 = 0.5 * DEGREE_RAD;

/// What is said of the runs that are left out.
pub(super) struct Useless {
    pub(super) doubts: Remarks,
    /// Of the newest run, where it is one.
    pub(super) newest: Option<(Code, String)>,
}

/// Why runs are left out, by their places.
type LeftOut = BTreeMap<usize, (Code, String)>;

/// Without the runs from which nothing is learnt, and what is said of them. One run is left.
pub(super) fn without_useless(
    inputs: &Inputs,
    observed: Vec<Recording>,
) -> (Inputs, Vec<Recording>, Useless) {
    let names = told_apart(&inputs.logs);
    let mut left = stopped(&observed);
    twice(&observed, &names, &mut left);
    unlike_others(&observed, &mut left, held_back);
    unlike_others(&observed, &mut left, early);
    unlike_others(&observed, &mut left, out_of_time);
    let stay: Vec<usize> = (0..observed.len()).filter(|k| !left.contains_key(k)).collect();
    let dead = dead(&stay.iter().map(|k| &observed[*k]).collect::<Vec<_>>());
    left.extend(dead.into_iter().map(|(place, why)| (stay[place], why)));
    let mut doubts = Remarks::default();
    for (place, (code, why)) in &left {
        doubts.add(*code, 1, format!("{}: {why}; nothing is learnt from this run", names[*place]));
    }
    let newest = observed.len().checked_sub(1).and_then(|newest| Some((newest, left.get(&newest)?)));
    let newest = newest.filter(|(_, (code, _))| *code != Code::SameRun);
    let newest = newest.map(|(place, (code, why))| (*code, format!("{}: {why}", names[place])));
    let stays = |k: &usize| !left.contains_key(k);
    let logs = inputs.logs.iter().enumerate().filter(|(k, _)| stays(k)).map(|(_, path)| path.clone());
    let inputs = Inputs { logs: logs.collect(), ..inputs.clone() };
    let observed = observed.into_iter().enumerate().filter(|(k, _)| stays(k)).map(|(_, run)| run);
    (inputs, observed.collect(), Useless { doubts, newest })
}

/// Runs that were given before, and are not left out there.
fn twice(observed: &[Recording], names: &[String], left: &mut LeftOut) {
    let same = |a: &Recording, b: &Recording| a.measured == b.measured && a.planned == b.planned;
    for k in 0..observed.len() {
        let stays = |before: &usize| !left.contains_key(before);
        if let Some(before) = (0..k).filter(stays).find(|before| same(&observed[k], &observed[*before])) {
            let why = format!("it is the same recording as {}, which is given before", names[before]);
            left.entry(k).or_insert((Code::SameRun, why));
        }
    }
}

/// Runs but the newest that were stopped in motion.
fn stopped(observed: &[Recording]) -> LeftOut {
    let of = |(k, run): (usize, &Recording)| {
        let broken = Carried::of(run).broken(run).filter(|broken| matches!(broken, Broken::Halted { .. }))?;
        Some((k, (Code::Stopped, format!("its plan {broken}: it was stopped"))))
    };
    let others = observed.split_last().map_or(&[][..], |(_, others)| others);
    others.iter().enumerate().filter_map(of).collect()
}

/// Runs of which something is to be said, where there are others of which it is not.
fn unlike_others(
    observed: &[Recording],
    left: &mut LeftOut,
    why: impl Fn(&Recording) -> Option<(Code, String)>,
) {
    let stay: Vec<usize> = (0..observed.len()).filter(|k| !left.contains_key(k)).collect();
    let found: Vec<(usize, (Code, String))> =
        stay.iter().filter_map(|k| Some((*k, why(&observed[*k])?))).collect();
    if found.len() < stay.len() {
        left.extend(found);
    }
}

/// What was sent came after its plan.
fn held_back(run: &Recording) -> Option<(Code, String)> {
    let by_s = -ahead_of_plan_s(run, &run.command.as_ref()?.series)?;
    let why = || {
        format!(
            "what was sent came after its plan, by {by_s:.1} s in the mean of its motion: an override or a pause held it back"
        )
    };
    (by_s > BEHIND_S).then(|| (Code::Paused, why()))
}

/// Joints led their plan by far, and what was sent by more: it came too early.
fn early(run: &Recording) -> Option<(Code, String)> {
    let sent_s = ahead_of_plan_s(run, &run.command.as_ref()?.series)?;
    let by_s = ahead_of_plan_s(run, &run.measured)?;
    let why = || {
        format!(
            "its joints led their plan by {by_s:.1} s in the mean of its motion: what was sent came before its time"
        )
    };
    (by_s > EARLY_S && sent_s > by_s).then(|| (Code::OtherTime, why()))
}

/// How far joints of a run are ahead of their plan, s.
fn ahead_of_plan_s(run: &Recording, series: &Series) -> Option<f64> {
    let [from_s, to_s] = run.planned.span_s()?;
    let of = |series: &Series| cut(&*bridged(series).ok()?, from_s, to_s).ok();
    Some(ahead_s(&of(series)?, &of(&run.planned)?))
}

/// Runs in which a joint stood that answers in another one, and, of those before the newest, in the newest.
fn dead(observed: &[&Recording]) -> LeftOut {
    let mut found = LeftOut::new();
    let Some(newest) = observed.last() else { return found };
    for track in &newest.planned.tracks {
        let shares: Vec<Option<f64>> = observed.iter().map(|run| share(run, newest, track.name())).collect();
        let answers = |share: &Option<f64>| share.is_some_and(|share| share > ANSWERS);
        let stands = |share: &Option<f64>| share.is_some_and(|share| share < STANDS);
        let (last, answering) = (shares.last(), shares.iter().filter(|share| answers(share)).count());
        let why = || {
            let why = format!("{} hardly moves in it although it does in other runs", track.name());
            (Code::FrozenSensor, why)
        };
        if last.is_some_and(stands) && answering > 0 {
            found.entry(observed.len() - 1).or_insert_with(why);
        }
        let known = last.is_some_and(answers) && answering > 1 || last.is_some_and(stands) && answering > 0;
        if known {
            for k in (0..shares.len()).filter(|k| stands(&shares[*k])) {
                found.entry(k).or_insert_with(why);
            }
        }
    }
    found
}

/// How far a joint moves by how far its plan does, in a run of the same plan as another one's.
fn share(run: &Recording, newest: &Recording, joint: &str) -> Option<f64> {
    let [asked_rad, moved_rad] = motions_rad(run, joint)?;
    let [newest_rad, _] = motions_rad(newest, joint)?;
    let same = (asked_rad - newest_rad).abs() < ALIKE * newest_rad;
    (same && asked_rad > LEAST_RAD).then_some(moved_rad / asked_rad)
}

/// How far the plan of a joint moves and how far the joint, rad.
fn motions_rad(run: &Recording, joint: &str) -> Option<[f64; 2]> {
    let pair = align(run.planned.track(joint)?, run.measured.track(joint)?)?;
    Some([&pair.planned, &pair.measured].map(|angles| deviation(angles)))
}
