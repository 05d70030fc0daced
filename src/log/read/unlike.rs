//! Finds joints that were recorded in another frame than their plan: sign, zero, unit or name.

use std::f64::consts::TAU;

use super::{
    alike::{Alike, LEAST_INSTANTS, both, speeds},
    quality::looks_like_degrees,
    recording::Command,
    scaled::scaled,
};
use crate::{
    log::source::AXES,
    math::range,
    remark::{Code, Remarks},
    series::{Series, Track},
    text::shell_word,
};

/// A joint follows its plan if the root mean square of its error is below this share of that of the planned motion.
const FOLLOWS: f64 = 0.3;

/// Errors below are no matter of frames: rad, and m.
const SMALL: [f64; 2] = [0.025, 0.02];

/// Correlation with the plan from which on they move alike, and below which against each other.
const ALIKE: f64 = 0.95;
const AGAINST: f64 = -0.8;

/// Share of the planned motion that one against it has at least.
const MOVES: f64 = 0.3;

/// Factors of the planned motion between which the unit is the same.
const SAME_UNIT: [f64; 2] = [0.5, 2.0];

/// An error stands all the time if its root mean square is below so many of its mean: one that grows from nothing has 1.15.
const STEADY: f64 = 1.1;

/// The plan of another joint is followed if its error is less than this share of its motion, and of the own error.
const OTHERS: f64 = 0.2;

/// Two joints whose names are exchanged move with each other's plan by this correlation at least, with their own by that at most, and
/// miss each other's by this share of what they miss of their own at most.
const WITH_EACH_OTHER: f64 = 0.8;
const WITH_OWN: f64 = 0.7;
const LESS: f64 = 0.6;
/// Plans that move by this share of what is small tell which they are.
const TELLS: f64 = 0.2;

/// An error of whole turns is one of them within this share of a turn: what a joint lags behind in the mean.
const A_TURN: f64 = 0.05;

/// A plan that correlates so with the speed of its measurement is one.
const AS_SPEED: f64 = 0.97;

/// Remarks joints whose measurement looks like their plan in another frame.
pub(super) fn of_sides(planned: &Series, measured: &Series, remarks: &mut Remarks) {
    if let Some(message) = stands(planned, measured) {
        remarks.add(Code::UnlikePlan, 1, message);
    }
    if let Some(message) = wired(planned, measured) {
        remarks.add(Code::SameRun, 1, message);
    }
    let exchanged = exchanged(planned, measured);
    for [one, other] in &exchanged {
        let message = format!(
            "{one} follows the plan of {other}, and {other} that of {one}, better than their own: are the names or columns of two \
             joints exchanged, or the names given in another order?"
        );
        remarks.add(Code::UnlikePlan, 1, message);
    }
    for track in &planned.tracks {
        if exchanged.iter().flatten().any(|name| name == track.name()) {
            continue;
        }
        let Some(came) = measured.track(track.name()).filter(|came| came.kind() == track.kind()) else {
            continue;
        };
        let others = || planned.tracks.iter().filter(|other| other.name() != track.name());
        if let Some(message) = of_joint(track, came, others()).or_else(|| scaled(track, came)) {
            remarks.add(Code::UnlikePlan, 1, message);
        }
    }
}

/// What is to be said of a plan that stands all the time while a joint goes to it from afar: what sinks or is pushed begins at it.
fn stands(planned: &Series, measured: &Series) -> Option<String> {
    let comes = |track: &&Track| {
        let begins = track.t_s().first().and_then(|t_s| planned.track(track.name())?.at(*t_s));
        let off = begins.zip(track.position().first()).map_or(0.0, |(plan, came)| plan.position - came);
        off.abs() > SMALL[usize::from(!track.turns())] && moved(track) > 2.0
    };
    let track = measured.tracks.iter().filter(comes).max_by(|a, b| moved(a).total_cmp(&moved(b)))?;
    planned.tracks.iter().all(|plan| moved(plan) < TELLS).then(|| {
        let [least, most] = range(track.position().iter().copied());
        format!(
            "the plan of every joint stands while {} moves by {}: if it is a goal, or of no part of this run, --planned names what was \
             wanted from moment to moment; `hydrotrace info` lists what the log has",
            track.name(),
            track.kind().says(most - least)
        )
    })
}

/// What is to be said of a measurement that is its plan, sample by sample.
fn wired(planned: &Series, measured: &Series) -> Option<String> {
    let is_it = |came: &&Track| {
        // A tool may keep a coordinate of its pose as an estimator is told to.
        let is_joint = !AXES.contains(&came.name());
        let plan = planned.track(came.name()).filter(|plan| is_joint && plan.len() == came.len());
        plan.is_some_and(|plan| plan.position() == came.position())
            && moved(came) > TELLS
            && came.len() >= LEAST_INSTANTS
    };
    let found: Vec<&str> = measured.tracks.iter().filter(is_it).map(Track::name).collect();
    (!found.is_empty()).then(|| {
        format!(
            "the measurement of {} is its plan to the last digit: one signal stands on both sides, and its errors say nothing; name the \
             measured topic or column with --measured",
            found.join(", ")
        )
    })
}

/// How far a joint goes, as a multiple of what is small.
fn moved(track: &Track) -> f64 {
    let [least, most] = range(track.position().iter().copied());
    (most - least) / SMALL[usize::from(!track.turns())]
}

/// Remarks joints whose command is farther from their plan than that moves: a correction is not, a signal to a valve may be.
pub(super) fn of_command(planned: &Series, command: Option<&Command>, topic: &str, remarks: &mut Remarks) {
    let Some(Command { series: sent, .. }) = command else { return };
    for track in &planned.tracks {
        let own = sent.track(track.name()).filter(|own| own.kind() == track.kind());
        let Some(alike) = own.and_then(|own| Alike::of(&both(track, own))) else { continue };
        let small = SMALL[usize::from(!track.turns())];
        if alike.motion > 0.0 && alike.rms_error > small.max(alike.motion) {
            let message = format!(
                "the command of {} is {} away from its plan (root mean square), farther than the plan moves: if it is no set value \
                 of the position, but a signal to a valve, --command {} takes the plan for what was sent",
                track.name(),
                track.kind().says(alike.rms_error),
                shell_word(topic)
            );
            remarks.add(Code::UnlikePlan, 1, message);
        }
    }
}

/// Pairs of joints of which each moves with the plan of the other, and not with its own.
fn exchanged(planned: &Series, measured: &Series) -> Vec<[String; 2]> {
    let found = |plan: &Track, came: &Track| {
        let found = (plan.kind() == came.kind()).then(|| Alike::of(&both(plan, came))).flatten();
        found.filter(|found| found.motion > TELLS * SMALL[usize::from(!plan.turns())])
    };
    let of_joint =
        |plan: &'_ Track| Some((plan.name().to_owned(), found(plan, measured.track(plan.name())?)?));
    let astray = planned.tracks.iter().filter_map(of_joint).filter(|(_, own)| own.correlation < WITH_OWN);
    let astray: Vec<(String, Alike)> = astray.collect();
    let follows = |(_, own): &(String, Alike), came: &str, plan: &str| {
        let other = planned.track(plan).zip(measured.track(came)).and_then(|(plan, came)| found(plan, came));
        other.is_some_and(|other| {
            other.correlation > WITH_EACH_OTHER && other.rms_error < LESS * own.rms_error
        })
    };
    let mut pairs: Vec<[String; 2]> = Vec::new();
    for (k, one) in astray.iter().enumerate() {
        let free = |other: &&(String, Alike)| !pairs.iter().flatten().any(|name| *name == other.0);
        let each =
            |other: &&(String, Alike)| follows(one, &one.0, &other.0) && follows(other, &other.0, &one.0);
        if let Some(other) = astray[k + 1..].iter().filter(free).find(each).filter(|_| free(&one)) {
            pairs.push([one.0.clone(), other.0.clone()]);
        }
    }
    pairs
}

fn of_joint<'a>(
    planned: &Track,
    measured: &Track,
    mut others: impl Iterator<Item = &'a Track>,
) -> Option<String> {
    let alike = Alike::of(&both(planned, measured))?;
    let small = SMALL[usize::from(!planned.turns())];
    if alike.rms_error < small.max(FOLLOWS * alike.motion) {
        return None;
    }
    let name = planned.name();
    let size = |value: f64| planned.kind().says(value);
    let followed = |other: &&Track| {
        let found = Alike::of(&both(other, measured)).filter(|_| other.kind() == planned.kind());
        found.is_some_and(|found| {
            found.rms_error < OTHERS * found.motion.min(alike.rms_error) && found.motion > small
        })
    };
    if let Some(other) = others.find(followed) {
        let other = other.name();
        return Some(format!(
            "{name} follows the plan of {other} and not its own, from which it is {} away (root mean square): are the \
             names or columns of two joints exchanged?",
            size(alike.rms_error)
        ));
    }
    let Alike { correlation, slope, mean_error, offset, motion, .. } = alike;
    if motion < small {
        return None;
    }
    if correlation < AGAINST && slope < -MOVES {
        return Some(format!(
            "{name} moves against its plan (correlation {correlation:.2}): is the sign of one of the two the other way \
             round?"
        ));
    }
    if correlation < ALIKE {
        let as_speed = speeds(measured).and_then(|speeds| Alike::of(&both(planned, &speeds)));
        let is_speed = as_speed.is_some_and(|found| {
            found.correlation > AS_SPEED && (SAME_UNIT[0]..=SAME_UNIT[1]).contains(&found.slope)
        });
        let says = || {
            format!(
                "the plan of {name} runs like the speed of its measurement (and not like its position): is it a measured speed, or \
                 a set value of the speed? --planned names the plan of the position"
            )
        };
        return if is_speed { Some(says()) } else { apart(planned, measured) };
    }
    if !(SAME_UNIT[0]..=SAME_UNIT[1]).contains(&slope) {
        if planned.turns() && [slope, 1.0 / slope].iter().any(|ratio| looks_like_degrees(*ratio)) {
            return None;
        }
        return Some(format!(
            "{name} moves {slope:.4} times as far as its plan (correlation {correlation:.2}): is one of the two in \
             another unit, or before a gear?"
        ));
    }
    // An error that grows with the speed is a lag, and one that grows with the time a drift or a slip.
    let beside = mean_error.abs().min(offset.abs());
    let steady = alike.rms_error < STEADY * mean_error.abs();
    let turns = mean_error / TAU;
    if steady && planned.turns() && turns.round().abs() > 0.5 && (turns - turns.round()).abs() < A_TURN {
        return Some(format!(
            "{name} was measured {} beside its plan all the time, whole turns: does its angle wrap? --continuous {} makes it \
             one without steps",
            size(mean_error.abs()),
            shell_word(name)
        ));
    }
    (steady && beside > FOLLOWS * motion).then(|| {
        format!(
            "{name} was measured {} beside its plan all the time: is the zero another?",
            size(mean_error.abs())
        )
    })
}

/// What is to be said of a joint whose plan and measurement have no position in common.
fn apart(planned: &Track, measured: &Track) -> Option<String> {
    let [plan, came] = [planned, measured].map(|track| range(track.position().iter().copied()));
    let says = |value: f64| planned.kind().says(value);
    (came[0] > plan[1] || came[1] < plan[0]).then(|| {
        format!(
            "{} is planned between {} and {} and measured between {} and {}, and they do not run alike: is one of them another quantity, \
             as the signal of a lever, or in another unit? --planned and --measured name others",
            planned.name(),
            says(plan[0]),
            says(plan[1]),
            says(came[0]),
            says(came[1])
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(name: &str, position: impl Fn(f64) -> f64) -> Track {
        Track::sampled(name, 3000, position)
    }

    /// Remarks on two joints of a plan, of which the first was measured so.
    fn remarks(boom: impl Fn(f64) -> f64, stick: impl Fn(f64) -> f64) -> Vec<String> {
        let planned = Series { tracks: vec![track("boom", plan), track("stick", of_stick)] };
        // To the last digit nothing is its plan.
        let stick = |t: f64| stick(t) + 1e-6;
        let measured = Series { tracks: vec![track("boom", boom), track("stick", stick)] };
        let mut remarks = Remarks::default();
        of_sides(&planned, &measured, &mut remarks);
        remarks.as_slice().iter().map(|remark| remark.message.clone()).collect()
    }

    fn plan(t: f64) -> f64 {
        0.3 + 0.5 * (0.2 * t).sin()
    }

    fn of_stick(t: f64) -> f64 {
        -0.8 + 0.4 * (0.31 * t).cos()
    }

    #[test]
    fn a_joint_in_another_frame_is_told_with_what_is_wrong() {
        for (boom, told) in [
            ((|t| -plan(t)) as fn(f64) -> f64, "moves against its plan (correlation -1.00)"),
            (|t| plan(t - 0.4) + 0.2, "beside its plan all the time: is the zero another?"),
            (|t| plan(t - 0.1) - TAU, "--continuous boom"),
            (|t| 7.0 + (0.9 * t).cos(), "is one of them another quantity"),
            (|t| 1e3 * plan(t), "moves 1000.0000 times as far"),
            (|t| 0.01 * plan(t), "moves 0.0100 times as far"),
        ] {
            let found = remarks(boom, of_stick);
            assert!(
                matches!(&found[..], [one] if one.starts_with("boom") && one.contains(told)),
                "{told}: {found:?}"
            );
        }
        let late: [fn(f64) -> f64; 2] = [|t| of_stick(t - 0.8), |t| plan(t - 0.8)];
        for [boom, stick] in [[of_stick, plan], late] {
            let found = remarks(boom, stick);
            let told =
                |one: &String| one.starts_with("boom follows the plan of stick, and stick that of boom");
            assert!(found.len() == 1 && found.iter().all(told), "{found:?}");
        }
        let found = remarks(of_stick, of_stick);
        assert!(
            found.len() == 1 && found[0].starts_with("boom follows the plan of stick and not"),
            "{found:?}"
        );
    }

    #[test]
    fn a_plan_on_both_sides_and_a_plan_that_stands_while_the_joint_moves_are_told() {
        let found = remarks(plan, of_stick);
        assert!(found.len() == 1 && found[0].contains("boom is its plan to the last digit"), "{found:?}");
        let said = |planned: &dyn Fn(f64) -> f64, came: &dyn Fn(f64) -> f64| {
            let [planned, came] = [planned, came].map(|q| Series { tracks: vec![track("boom", q)] });
            stands(&planned, &came)
        };
        let [goal, rests] = [|_: f64| 0.8, |t: f64| 0.8 + 0.01 * (0.3 * t).sin()];
        let sags = |t: f64| 0.8 - 0.005 * t;
        assert!(said(&goal, &plan).is_some_and(|said| said.contains("stands while boom moves by")));
        assert_eq!([said(&goal, &rests), said(&plan, &rests), said(&goal, &sags)], [None, None, None]);
    }

    #[test]
    fn a_plan_that_is_the_speed_of_its_measurement_is_told() {
        let [speed, position] = [|t: f64| 0.64 * (0.8 * t).cos(), |t: f64| 0.8 * (0.8 * t).sin()];
        let [planned, came] = [track("boom", speed), track("boom", position)];
        let said = of_joint(&planned, &came, std::iter::empty());
        assert!(said.as_ref().is_some_and(|said| said.contains("runs like the speed")), "{said:?}");
    }

    #[test]
    fn a_joint_that_follows_badly_or_not_at_all_is_not() {
        let late = |t: f64| plan(t - 1.0);
        let dead = |_: f64| plan(0.0);
        let soft = |t: f64| plan(t) + 0.1 * (6.0 * t).sin();
        let sags = |t: f64| 0.95 * plan(t) - 0.03;
        let odd = |t: f64| 0.3 + 0.5 * (1.7 * t).cos();
        for (name, boom) in
            [("late", &late as &dyn Fn(f64) -> f64), ("dead", &dead), ("soft", &soft), ("sags", &sags)]
        {
            assert_eq!(remarks(boom, of_stick), Vec::<String>::new(), "{name}");
        }
        assert_eq!(remarks(odd, of_stick), Vec::<String>::new());
    }

    #[test]
    fn a_lag_in_a_stretch_of_one_motion_is_no_other_zero() {
        let cut = |position: &dyn Fn(f64) -> f64| Series::sampled("boom", 200, position);
        let rises = |t: f64| 0.3 * (1.0 - (1.2 * t).cos());
        let count = |measured: &dyn Fn(f64) -> f64| {
            let mut remarks = Remarks::default();
            of_sides(&cut(&rises), &cut(measured), &mut remarks);
            remarks.as_slice().len()
        };
        assert_eq!((count(&|t| rises(t - 0.4)), count(&|t| rises(t) + 0.2)), (0, 1));
    }
}
