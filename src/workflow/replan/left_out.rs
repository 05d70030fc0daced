//! Runs from which nothing is learnt: given twice, broken off, held back by an override, or with a joint that stood though it answers
//! in others, as of a valve without current, which says nothing of its machine.

use std::collections::BTreeMap;

use super::{Inputs, out_of_time::out_of_time};
use crate::{
    log::Recording,
    math::deviation,
    remark::{Code, Remarks},
    replay::{Rules, replay},
    series::{Broken, Series, Track, align, bridged},
    units::DEGREE_RAD,
    workflow::{
        carried::Carried,
        names::told_apart,
        same_plan::{ahead, cut},
    },
};

/// A joint that moves by a smaller share of its plan stands, one that moves by more than the other answers.
const STANDS: f64 = 0.03;
const ANSWERS: f64 = 0.5;
/// What is sent later than its plan by more was held back, s: corrections run ahead.
const BEHIND_S: f64 = 0.5;
/// Joints that lead their plan by more were sent their command early, s: no correction asks for that.
const EARLY_S: f64 = 0.25;
/// The same that explains at least this share of their error: where corrections ask for what the machine has not, it is off anyhow.
const SHIFTED: f64 = 0.5;
/// Plans whose motions differ by less, as a share, may be one.
const ALIKE: f64 = 0.05;
/// Plans that move less are not judged, nor motions of one, rad: root mean square about the mean.
const LEAST_RAD: f64 = 0.5 * DEGREE_RAD;
const LEAST_OF_MOTION_RAD: f64 = DEGREE_RAD;

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
    let sides = |k: &usize| [&observed[*k].planned, &observed[*k].measured];
    let dead = dead(&stay.iter().map(sides).collect::<Vec<_>>());
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
    let by_s = -ahead_of_plan(run, &run.command.as_ref()?.series)?.0;
    let why = || {
        format!(
            "what was sent came after its plan, by {by_s:.1} s in the mean of its motion: an override or a pause held it back"
        )
    };
    (by_s > BEHIND_S).then(|| (Code::Paused, why()))
}

/// Joints led their plan by far, and what was sent by more: it came too early.
fn early(run: &Recording) -> Option<(Code, String)> {
    let (sent_s, _) = ahead_of_plan(run, &run.command.as_ref()?.series)?;
    let (by_s, share) = ahead_of_plan(run, &run.measured)?;
    let why = || {
        format!(
            "its joints led their plan by {by_s:.1} s in the mean of its motion: what was sent came before its time"
        )
    };
    (by_s > EARLY_S && sent_s > by_s && share > SHIFTED).then(|| (Code::OtherTime, why()))
}

/// How far joints of a run are ahead of their plan, s, and the share of their error that this explains.
fn ahead_of_plan(run: &Recording, series: &Series) -> Option<(f64, f64)> {
    let [from_s, to_s] = run.planned.span_s()?;
    let of = |series: &Series| cut(&*bridged(series).ok()?, from_s, to_s).ok();
    Some(ahead(&of(series)?, &of(&run.planned)?))
}

/// Runs in which a joint stood, or through one motion, that answers in another one, and, of those before the newest, in the newest.
/// `runs`: what was planned and measured.
fn dead(runs: &[[&Series; 2]]) -> LeftOut {
    let mut found: BTreeMap<usize, BTreeMap<&str, (usize, String)>> = BTreeMap::new();
    let Some((newest, _)) = runs.split_last() else { return LeftOut::new() };
    let mut moving = 0;
    for name in newest[0].tracks.iter().map(Track::name) {
        let all: Vec<Vec<Moved>> = runs.iter().map(|run| moved(*run, name)).collect();
        let Some(of_newest) = all.last() else { continue };
        moving += usize::from(of_newest.first().is_some_and(|whole| whole.asked_rad > LEAST_RAD));
        for place in 0..of_newest.len() {
            let shares: Vec<Option<f64>> = all.iter().map(|own| share(own, of_newest, place)).collect();
            for k in standing(&shares) {
                let when = match place {
                    0 => "in it".to_owned(),
                    _ => format!("through its motion from {:.1} s on", all[k][place].from_s),
                };
                let why = format!("{name} hardly moves {when} although it does in other runs");
                found.entry(k).or_default().entry(name).or_insert((place, why));
            }
        }
    }
    // Where more than half of the joints stand through a motion, the machine did.
    let one = |joints: &BTreeMap<&str, (usize, String)>| {
        joints.values().any(|(place, _)| *place == 0) || 2 * joints.len() <= moving
    };
    let told = found.into_iter().filter(|(_, joints)| one(joints));
    told.filter_map(|(k, joints)| Some((k, (Code::FrozenSensor, joints.into_values().next()?.1)))).collect()
}

/// Of runs in which a joint moves by these shares of its plan those in which it stands though it could move.
fn standing(shares: &[Option<f64>]) -> Vec<usize> {
    let answers = |share: &Option<f64>| share.is_some_and(|share| share > ANSWERS);
    let stands = |share: &Option<f64>| share.is_some_and(|share| share < STANDS);
    let (last, answering) = (shares.last(), shares.iter().filter(|share| answers(share)).count());
    let known = last.is_some_and(answers) && answering > 1 || last.is_some_and(stands) && answering > 0;
    (0..shares.len()).filter(|k| known && stands(&shares[*k])).collect()
}

/// How far the plan of a joint moves and how far the joint, rad, and where its motion begins, s.
struct Moved {
    asked_rad: f64,
    came_rad: f64,
    from_s: f64,
}

/// How far a joint moves by how far its plan does, in a run of the same plan as another one's, and in the same motion.
fn share(own: &[Moved], newest: &[Moved], place: usize) -> Option<f64> {
    // Motions are told apart by their order.
    let alike = place == 0 || own.len() == newest.len();
    let (own, newest) = (own.get(place).filter(|_| alike)?, newest.get(place)?);
    let same = (own.asked_rad - newest.asked_rad).abs() < ALIKE * newest.asked_rad;
    let least_rad = if place > 0 { LEAST_OF_MOTION_RAD } else { LEAST_RAD };
    (same && own.asked_rad > least_rad).then_some(own.came_rad / own.asked_rad)
}

/// Of a whole run first, then of each motion of the joint.
fn moved(sides: [&Series; 2], joint: &str) -> Vec<Moved> {
    let [Some(planned), Some(measured)] = sides.map(|side| side.track(joint)) else { return Vec::new() };
    let Some(pair) = align(planned, measured) else { return Vec::new() };
    let of = |[from_s, to_s]: [f64; 2]| {
        let [from, to] = [from_s, to_s].map(|at_s| pair.t_s.partition_point(|t_s| *t_s < at_s));
        let [asked_rad, came_rad] =
            [&pair.planned, &pair.measured].map(|angles| deviation(&angles[from..to]));
        Moved { asked_rad, came_rad, from_s }
    };
    let starts = replay(std::slice::from_ref(&pair), &Rules::default()).transitions;
    let windows = starts.iter().map(|start| start.window_s);
    std::iter::once([f64::NEG_INFINITY, f64::INFINITY]).chain(windows).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_through_which_a_joint_stands_is_told_where_it_moves_in_another_run() {
        let of = |shares: &[f64]| standing(&shares.iter().map(|share| Some(*share)).collect::<Vec<_>>());
        assert_eq!(of(&[0.98, 1.0, 0.01]), [2], "in the newest");
        assert_eq!(of(&[0.98, 0.01, 1.0]), [1], "in one before");
        assert_eq!(of(&[0.01, 1.0]), Vec::<usize>::new(), "a correction may have moved it");
        assert_eq!(of(&[0.01, 0.01]), Vec::<usize>::new(), "in all");
        assert_eq!(of(&[0.98, 0.4, 0.9]), Vec::<usize>::new(), "it only lags");
        let run = |came: &dyn Fn(f64) -> f64| {
            let ramp = |t: f64, from_s: f64| (t - from_s).clamp(0.0, 2.0) * 0.1;
            let both = |came: &dyn Fn(f64) -> f64| {
                let of = |name: &str, came: &dyn Fn(f64) -> f64| {
                    Track::sampled(name, 1400, |t| ramp(t, 2.0) + came(ramp(t, 7.0)))
                };
                Series { tracks: vec![of("boom", came), of("stick", &|q| q), of("slew", &|q| q)] }
            };
            let (planned, measured) = (both(&|q| q), both(came));
            [planned, measured]
        };
        let (sound, stuck) = (run(&|q| q), run(&|_| 0.0));
        let found = dead(&[sound.each_ref(), stuck.each_ref()]);
        let [(1, (Code::FrozenSensor, why))] = &found.into_iter().collect::<Vec<_>>()[..] else { panic!() };
        assert!(why.contains("boom hardly moves through its motion from 7.0 s on"), "{why}");
    }
}
