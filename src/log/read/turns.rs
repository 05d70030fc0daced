//! Full turns of joints without end stops, which a sensor counts or not: they are no motion and no error.

use std::{
    f64::consts::{PI, TAU},
    ops::Range,
};

use crate::{
    arm::{names_a_cylinder, names_a_slide},
    math::{median, range},
    remark::{Code, Remarks},
    series::{Series, Track},
    text::shell_word,
};

/// Instants at which the sides are compared, evenly spread over the measurement.
const INSTANTS: usize = 1000;

/// Samples that are farther apart do not tell a full turn from a motion, s.
const LONGEST_S: f64 = 0.25;

/// An angle that steps by full turns spans about one; what spans more than so many is a length, or counts.
const MOST_TURNS: f64 = 3.0;

/// Whether a joint's angle steps by full turns, as far as its name and span say that it may.
fn steps(track: &Track) -> bool {
    let [lowest, highest] = range(track.position().iter().copied());
    let may = highest - lowest < MOST_TURNS * TAU
        && !names_a_cylinder(track.name())
        && !names_a_slide(track.name());
    track.turns() && may && track.sample_interval_s() < LONGEST_S && turns(track) > 0
}

/// Undoes full turns of joints declared continuous, and of those that step by one in plan and measurement alike, which no joint does
/// that has end stops; within plan and measurement and between them. Returns all of these.
pub(super) fn unwrap_sides(
    sides: &mut [(&str, &mut Series); 2],
    continuous: &[String],
    remarks: &mut Remarks,
) -> Vec<String> {
    let [(_, planned), (_, measured)] = sides;
    let alike =
        planned.tracks.iter().filter(|plan| steps(plan) && measured.track(plan.name()).is_some_and(steps));
    let alike = alike.map(|plan| plan.name().to_owned()).filter(|name| !continuous.contains(name));
    let alike: Vec<String> = alike.collect();
    let message = format!(
        "joints whose angle steps by a full turn in plan and measurement alike: {}; taken for joints without end stops, as --continuous {} says",
        alike.join(", "),
        shell_word(&alike.join(","))
    );
    remarks.add(Code::Wrapped, alike.len() as u64, message);
    let continuous = [continuous, &alike].concat();
    unwrap_turns(planned, &continuous, remarks);
    unwrap_beside(planned, measured, &continuous, remarks);
    continuous
}

/// Undoes full turns of joints declared continuous, within a side and between it and the plan.
pub(super) fn unwrap_beside(
    planned: &Series,
    series: &mut Series,
    continuous: &[String],
    remarks: &mut Remarks,
) {
    unwrap_turns(series, continuous, remarks);
    bring_to_turn(planned, series, continuous);
}

/// Undoes full turns of joints declared continuous; remarks on them elsewhere.
fn unwrap_turns(series: &mut Series, continuous: &[String], remarks: &mut Remarks) {
    for track in series.tracks.iter_mut().filter(|track| track.turns()) {
        let turns = turns(track);
        if turns == 0 {
            continue;
        }
        let name = track.name().to_owned();
        if continuous.contains(&name) {
            if let Some(unwrapped) = unwrapped(track) {
                *track = unwrapped;
            }
        } else {
            remarks.add(
                Code::Wrapped,
                turns,
                format!(
                    "steps of a full turn in {name}; if the joint has no end stops, say --continuous {name}"
                ),
            );
        }
    }
}

/// Moves joints declared continuous by whole turns to where the plan has them, each stretch between gaps by itself: in
/// a gap turns are lost.
fn bring_to_turn(planned: &Series, series: &mut Series, continuous: &[String]) {
    for track in series.tracks.iter_mut().filter(|track| track.turns()) {
        let Some(plan) = planned.track(track.name()).filter(|plan| plan.turns()) else { continue };
        if !continuous.iter().any(|name| name == track.name()) {
            continue;
        }
        let turns: Vec<Option<f64>> =
            track.segments().iter().map(|segment| turns_apart(plan, track, segment.clone())).collect();
        if turns.iter().flatten().all(|turns| *turns == 0.0) {
            continue;
        }
        // A stretch of which the plan knows nothing goes on where the one before it was.
        let mut by = turns.iter().flatten().next().copied().unwrap_or(0.0);
        let mut position = track.position().to_vec();
        for (segment, turns) in track.segments().iter().zip(turns) {
            by = turns.unwrap_or(by);
            position[segment.clone()].iter_mut().for_each(|q| *q -= by * TAU);
        }
        *track = with_positions(track, position).unwrap_or_else(|| track.clone());
    }
}

/// Whole turns from the plan to a stretch of a track, in the median; `None` where the plan knows nothing of it.
fn turns_apart(plan: &Track, track: &Track, stretch: Range<usize>) -> Option<f64> {
    let step = stretch.len().div_ceil(INSTANTS).max(1);
    let samples = track.t_s()[stretch.clone()].iter().zip(&track.position()[stretch]).step_by(step);
    let apart: Vec<f64> = samples.filter_map(|(t_s, q)| Some(q - plan.at(*t_s)?.position)).collect();
    (!apart.is_empty()).then(|| (median(apart) / TAU).round())
}

fn with_positions(track: &Track, position: Vec<f64>) -> Option<Track> {
    let cuts: Vec<usize> = track.segments().iter().skip(1).map(|s| s.start).collect();
    Track::new(track.name(), track.t_s(), position, &cuts).ok()
}

/// Number of steps between neighbouring samples of about a full turn.
pub(super) fn turns(track: &Track) -> u64 {
    let steps = track.position().windows(2).map(|w| (w[1] - w[0]).abs());
    // Without a branch on any step, so that the compiler takes several at once.
    steps.map(|step| u64::from((step > PI) & ((step - TAU).abs() < 1.0))).sum()
}

fn unwrapped(track: &Track) -> Option<Track> {
    let mut turns_rad = 0.0;
    let mut previous: Option<f64> = None;
    let position = track.position().iter().map(|&q| {
        if let Some(before) = previous {
            turns_rad -= TAU * ((q - before) / TAU).round();
        }
        previous = Some(q);
        q + turns_rad
    });
    with_positions(track, position.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(position: impl Fn(f64) -> f64) -> Series {
        Series::sampled("a", 500, position)
    }

    #[test]
    fn a_full_turn_is_undone_only_for_a_joint_declared_continuous() {
        let mut series = series(|t| (t * 2.0 + PI).rem_euclid(TAU) - PI);
        let mut remarks = Remarks::default();
        unwrap_turns(&mut series, &[], &mut remarks);
        assert_eq!(remarks.as_slice()[0].code, Code::Wrapped);
        unwrap_turns(&mut series, &["a".into()], &mut remarks);
        assert!((series.tracks[0].position()[499] - 2.0 * 4.99).abs() < 1e-9);
    }

    #[test]
    fn whole_turns_between_plan_and_measurement_are_no_error_of_a_joint_declared_continuous() {
        let plan = |t: f64| 0.5 * t - 0.4;
        let near_half_turn = |t: f64| PI + 0.01 * (40.0 * t).sin();
        let to_half_turn = |q: f64| (q + PI).rem_euclid(TAU) - PI;
        let cases: [[Series; 2]; 3] = [
            // An encoder that counts from 0 to a full turn, one that was set to zero after three turns, and rest at the wrap.
            [series(plan), series(|t| plan(t).rem_euclid(TAU))],
            [series(plan), series(|t| plan(t) + 3.0 * TAU)],
            [series(|_| -PI + 0.001), series(|t| to_half_turn(near_half_turn(t)))],
        ];
        for [mut planned, mut measured] in cases {
            let before = measured.clone();
            let mut off = |continuous: &[String], measured: &mut Series| {
                let sides = &mut [("planned", &mut planned), ("measured", measured)];
                unwrap_sides(sides, continuous, &mut Remarks::default());
                let both = planned.tracks[0].position().iter().zip(measured.tracks[0].position());
                both.map(|(plan, came)| (plan - came).abs()).fold(0.0, f64::max)
            };
            assert!(off(&[], &mut measured) > 6.0);
            assert_eq!(measured, before);
            assert!(off(&["a".into()], &mut measured) < 0.02);
        }
    }

    #[test]
    fn full_turns_of_plan_and_measurement_alike_are_undone_and_said_to_be() {
        let wrapped = |late_s: f64| series(move |t| (3.0 * (t - late_s)).rem_euclid(TAU));
        let (mut planned, mut measured, mut remarks) = (wrapped(0.0), wrapped(0.1), Remarks::default());
        let sides = &mut [("planned", &mut planned), ("measured", &mut measured)];
        assert_eq!(unwrap_sides(sides, &[], &mut remarks), ["a"]);
        let both = planned.tracks[0].position().iter().zip(measured.tracks[0].position()).skip(20);
        assert!(both.clone().all(|(plan, came)| (plan - came - 0.3).abs() < 1e-9));
        assert!(matches!(remarks.as_slice(), [one] if one.code == Code::Wrapped), "{remarks:?}");
    }

    #[test]
    fn a_length_that_steps_by_as_much_is_no_endless_joint() {
        let moves = |t: f64| 300.0 * (t * 0.5).sin() + if t > 2.0 { TAU } else { 0.0 };
        for (name, course) in
            [("boom", &moves as &dyn Fn(f64) -> f64), ("boom_cylinder", &|t| (3.0 * t).rem_euclid(TAU))]
        {
            let of = || Series::sampled(name, 500, course);
            let (mut planned, mut measured, mut remarks) = (of(), of(), Remarks::default());
            let sides = &mut [("planned", &mut planned), ("measured", &mut measured)];
            assert!(unwrap_sides(sides, &[], &mut remarks).is_empty(), "{name}");
            assert_eq!(planned, of());
        }
    }

    #[test]
    fn a_turn_that_is_lost_in_a_gap_is_undone_on_both_sides_of_it() {
        let plan = |t: f64| 3.0 * t;
        let gone = |t: &f64| !(2.0..3.5).contains(t);
        let t_s: Vec<f64> = (0..700).map(|k| 0.01 * f64::from(k)).filter(gone).collect();
        let angles: Vec<f64> = t_s.iter().map(|t| plan(*t).rem_euclid(TAU)).collect();
        let mut measured = Series { tracks: vec![Track::new("a", t_s, angles, &[200]).unwrap()] };
        let mut planned = Series::sampled("a", 700, plan);
        let sides = &mut [("planned", &mut planned), ("measured", &mut measured)];
        unwrap_sides(sides, &["a".into()], &mut Remarks::default());
        let track = &measured.tracks[0];
        for (t_s, came) in track.t_s().iter().zip(track.position()) {
            assert!((plan(*t_s) - came).abs() < 1e-9, "{t_s} s: {came}");
        }
    }
}
