//! Runs that say nothing of their machine: given twice, stopped in motion, or with a joint that stood though it answers in others, as of a
//! valve without current.

use std::{borrow::Borrow, collections::BTreeMap};

use crate::{
    log::Recording,
    math::deviation,
    remark::Code,
    replay::{Rules, replay},
    series::{Broken, Series, Track, align},
    units::DEGREE_RAD,
    workflow::carried::Carried,
};

/// A joint that moves by a smaller share of its plan stands, one that moves by more than the other answers.
const STANDS: f64 = 0.03;
const ANSWERS: f64 = 0.5;
/// Plans whose motions differ by less, as a share, may be one.
const ALIKE: f64 = 0.05;
/// Plans that move less are not judged, nor motions of one, rad: root mean square about the mean.
const LEAST_RAD: f64 = 0.5 * DEGREE_RAD;
const LEAST_OF_MOTION_RAD: f64 = DEGREE_RAD;

/// Why runs are left out, by their places.
pub(in crate::workflow) type LeftOut = BTreeMap<usize, (Code, String)>;

/// Runs that were given before, and are not left out there.
pub(in crate::workflow) fn twice(observed: &[impl Borrow<Recording>], names: &[String], left: &mut LeftOut) {
    let observed: Vec<&Recording> = observed.iter().map(Borrow::borrow).collect();
    let same = |a: &Recording, b: &Recording| a.measured == b.measured && a.planned == b.planned;
    for k in 0..observed.len() {
        let stays = |before: &usize| !left.contains_key(before);
        if let Some(before) = (0..k).filter(stays).find(|before| same(observed[k], observed[*before])) {
            let why = format!("it is the same recording as {}, which is given before", names[before]);
            left.entry(k).or_insert((Code::SameRun, why));
        }
    }
}

/// Runs that were stopped in motion.
pub(in crate::workflow) fn stopped(observed: &[impl Borrow<Recording>]) -> LeftOut {
    let of = |(k, run): (usize, &Recording)| {
        let broken = Carried::of(run).broken(run).filter(|broken| matches!(broken, Broken::Halted { .. }))?;
        Some((k, (Code::Stopped, format!("its plan {broken}: it was stopped"))))
    };
    observed.iter().map(Borrow::borrow).enumerate().filter_map(of).collect()
}

/// Runs in which a joint stood, or through one motion, that answers in another one, and, of those before the newest, in the newest.
/// `runs`: what was planned and measured.
pub(in crate::workflow) fn dead(runs: &[[&Series; 2]]) -> LeftOut {
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
