//! Plans that are written only where they change, as historians and subscriptions write them: between two values the
//! first one holds.

use super::{
    followed::{gone_before, off},
    quality::is_of_gaps,
    recording::Command,
    repeated::LONGEST_S,
    select_topics::Choice,
};
use crate::{
    math::median,
    remark::{Code, Remark, Remarks},
    series::{Series, Track},
};

/// Fewer values tell nothing.
const LEAST: usize = 20;

/// Of so many values one may repeat the one before, as it is rounded.
const REPEATS: usize = 20;

/// A value after a silence is no farther from the one before than so many of the steps elsewhere: more was lost.
const STEPS: f64 = 3.0;

/// A plan whose values are farther apart in the median than samples of a motion are held, and so many times as far as those of the
/// measurement beside it, may be one of set values.
const SPARSER: f64 = 5.0;
/// It is if a joint has gone less than this share of the way to a value when that comes: no machine answers what is yet to come. A delay
/// as long as values are apart looks so, too; then lines between them, each at its best delay, are off by so many times less.
const BEFORE: f64 = 0.1;
const LESS: f64 = 2.0;

/// Holds the plan through its silences, up to the end of the measurement, if it is written so; and the measurement, if
/// that is, too. `one_file`: one recorder wrote both, so that a plan of few values is what was set, and no key points.
pub(super) fn of_sides(
    choice: &Choice,
    one_file: bool,
    sides: &mut [(&str, &mut Series); 2],
    remarks: &mut Remarks,
) {
    let [(_, planned), (_, measured)] = sides;
    // Trajectories say themselves how they go on.
    if choice.planned.iter().all(|candidate| candidate.field.is_some()) {
        if one_file {
            of_set_values(planned, measured, remarks);
        }
        let topics = [&choice.planned, &choice.measured];
        let topics =
            topics.map(|side| side.iter().map(|candidate| candidate.topic.as_str()).collect::<Vec<_>>());
        of_both([planned, measured], &topics, remarks);
    }
}

/// Holds what was sent as a plan is held.
pub(super) fn of_command(Command { topic, series }: &mut Command, measured: &Series, remarks: &mut Remarks) {
    if let Some([_, until_s]) = measured.span_s() {
        of_side(("command", &[topic]), series, (until_s, false), remarks);
    }
}

fn of_both([planned, measured]: [&mut Series; 2], topics: &[Vec<&str>; 2], remarks: &mut Remarks) {
    let Some([_, until_s]) = measured.span_s() else { return };
    let of_plan = of_side(("plan", &topics[0]), planned, (until_s, false), remarks);
    // A sensor that fails leaves cells empty, too, but goes to and fro.
    let is_empty = |topic: &&str| remarks.as_slice().iter().any(|remark| is_of_empty(remark, topic));
    let steadily = || measured.tracks.iter().all(goes_steadily);
    if of_plan || topics[1].iter().all(is_empty) && steadily() {
        // Plans are looked at where a measurement is.
        of_side(("measurement", &topics[1]), measured, (until_s, true), remarks);
    }
}

fn of_side(
    (side, topics): (&str, &[&str]),
    series: &mut Series,
    (until_s, dense): (f64, bool),
    remarks: &mut Remarks,
) -> bool {
    let on_change: Vec<bool> =
        series.tracks.iter().map(|track| is_written_on_change(track, &series.tracks)).collect();
    let (mut silences, mut names) = (0, Vec::new());
    for (track, _) in series.tracks.iter_mut().zip(on_change).filter(|(_, on_change)| *on_change) {
        if let Some((held, count)) = held(track, until_s, dense) {
            silences += count;
            names.push(track.name().to_owned());
            *track = held;
        }
    }
    if names.len() == series.tracks.len() {
        // What is held is no gap.
        let is_of = |remark: &Remark, topic: &&str| is_of_gaps(remark, topic) || is_of_empty(remark, topic);
        remarks.retain(|remark| !topics.iter().any(|topic| is_of(remark, topic)));
    }
    let message = format!(
        "silences of the {side} of {}, which hardly has a value twice in a row: it is written only where it changes, and \
         is held in between",
        names.join(", ")
    );
    remarks.add(Code::Guessed, silences, message);
    silences > 0
}

/// Holds each value of a plan of set values until the next one comes.
fn of_set_values(planned: &mut Series, measured: &Series, remarks: &mut Remarks) {
    let (mut values, mut names) = (0, Vec::new());
    for track in &mut planned.tracks {
        let Some(beside) = measured.tracks.iter().find(|beside| beside.name() == track.name()) else {
            continue;
        };
        let between_s = beside.sample_interval_s();
        let gaps_s: Vec<f64> = track.t_s().windows(2).map(|two| two[1] - two[0]).collect();
        if gaps_s.is_empty() || median(gaps_s) < LONGEST_S.max(SPARSER * between_s) {
            continue;
        }
        let until_s = beside.t_s().last().copied().unwrap_or_default();
        let lines =
            Track::of(track.kind(), track.name(), track.t_s().to_vec(), track.position().to_vec(), &[]);
        let both = lines.ok().zip(in_steps(track, between_s, until_s));
        let steps = |(lines, held): &(Track, Track)| {
            gone_before(track, beside) < BEFORE && off(held, beside) < LESS * off(lines, beside)
        };
        if let Some((_, held)) = both.filter(steps) {
            values += track.len() as u64;
            names.push(track.name().to_owned());
            *track = held;
        }
    }
    let message = format!(
        "values of the plan of {} that come {} s or more apart beside a denser measurement: each is taken for a set value and held \
         until the next; if the machine went on smoothly between them, put the plan into a log of its own and join it \
         (hydrotrace join)",
        names.join(", "),
        LONGEST_S
    );
    remarks.add(Code::Guessed, values, message);
}

/// A track that holds each of its values until the next one, the last to an instant, with a sample in every so many seconds: a step is
/// known as well as the measurement is.
fn in_steps(track: &Track, every_s: f64, until_s: f64) -> Option<Track> {
    let ends_s = track.t_s().iter().skip(1).copied().chain([until_s + 0.5 * every_s]);
    let (mut t_s, mut position) = (Vec::new(), Vec::new());
    for ((from_s, value), to_s) in track.t_s().iter().zip(track.position()).zip(ends_s) {
        let each_s = every_s.max((to_s - from_s) / MOST);
        let within =
            (0..).map(|k| from_s + each_s * f64::from(k)).take_while(|at_s| *at_s < to_s - 0.5 * each_s);
        t_s.extend(std::iter::once(*from_s).chain(within.skip(1)));
        position.resize(t_s.len(), *value);
    }
    Track::of(track.kind(), track.name(), t_s, position, &[]).ok()
}

/// Whether hardly a row repeats the one before, that of all joints at these instants, and none after a silence is far
/// from the one before.
fn is_written_on_change(track: &Track, all: &[Track]) -> bool {
    let parts = track.segments();
    if parts.len() < 2 || track.len() < LEAST {
        return false;
    }
    let step = |track: &Track, k: usize| (track.position()[k] - track.position()[k - 1]).abs();
    let rows = || parts.iter().flat_map(|part| part.start + 1..part.end);
    let beside: Vec<&Track> = all.iter().filter(|other| other.t_s() == track.t_s()).collect();
    let repeats = rows().filter(|k| beside.iter().all(|one| step(one, *k) <= 0.0)).count();
    let near = |one: &&Track| {
        let largest = rows().map(|k| step(one, k)).fold(0.0, f64::max);
        parts.iter().skip(1).all(|part| step(one, part.start) <= STEPS * largest)
    };
    REPEATS * repeats <= track.len() && beside.iter().all(near)
}

/// Whether a remark tells of cells of a topic that are empty.
fn is_of_empty(remark: &Remark, topic: &str) -> bool {
    remark.code == Code::NotFinite && remark.message.contains(&format!(" {topic}:"))
}

/// Of so many steps one may turn back.
const TURNS: usize = 5;

/// Whether a joint hardly goes to and fro from value to value, as one at rest does by its noise.
fn goes_steadily(track: &Track) -> bool {
    let steps = track
        .segments()
        .iter()
        .flat_map(|part| track.position()[part.clone()].windows(2).map(|two| two[1] - two[0]));
    let steps: Vec<f64> = steps.collect();
    let turns = steps.windows(2).filter(|two| two[0] * two[1] < 0.0).count();
    TURNS * turns < steps.len()
}

/// Samples in a silence, at most.
const MOST: f64 = 1e5;

/// Silences of a measurement within a stretch are as long, in samples and s.
const SHORT: f64 = 10.0;
const SHORT_S: f64 = 0.25;

/// The track with two samples more in each silence, or, `dense`, as many as elsewhere, and how many silences there are.
fn held(track: &Track, until_s: f64, dense: bool) -> Option<(Track, u64)> {
    let step_s = track.sample_interval_s();
    let (mut t_s, mut position) = (Vec::new(), Vec::new());
    let mut silences = 0;
    let mut hold = |from: f64, to_s: f64, q: f64, t_s: &mut Vec<f64>, position: &mut Vec<f64>| {
        if to_s - from > 3.0 * step_s {
            t_s.push(from + step_s);
            let each_s = step_s.max((to_s - from) / MOST);
            let more = (1..)
                .map(|k| from + step_s + each_s * f64::from(k))
                .take_while(|at_s| *at_s < to_s - 1.5 * step_s);
            t_s.extend(more.take_while(|_| dense));
            t_s.push(to_s - step_s);
            position.resize(t_s.len(), q);
            silences += 1;
        }
    };
    let parts = track.segments();
    for (k, part) in parts.iter().enumerate() {
        for k in part.clone() {
            let (at_s, before) = (track.t_s()[k], k.checked_sub(1).filter(|before| *before >= part.start));
            // A plan that creeps is no stairs; a joint that rests briefly is.
            let short_s = (SHORT * step_s).max(SHORT_S);
            if let Some(before) = before.filter(|before| dense && at_s - track.t_s()[*before] > short_s) {
                hold(track.t_s()[before], at_s, track.position()[before], &mut t_s, &mut position);
            }
            t_s.push(at_s);
            position.push(track.position()[k]);
        }
        let last = part.end.checked_sub(1)?;
        let to_s = parts.get(k + 1).map_or(until_s + step_s, |next| track.t_s()[next.start]);
        hold(track.t_s()[last], to_s, track.position()[last], &mut t_s, &mut position);
    }
    Some((Track::of(track.kind(), track.name(), t_s, position, &[]).ok()?, silences))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::read::quality::Gaps;

    /// Two moves with a rest of 6 s between, and rests around, sampled at 50 Hz.
    fn moves(t: f64) -> f64 {
        let step = |from: f64| {
            let x = ((t - from) / 3.0).clamp(0.0, 1.0);
            x * x * (3.0 - 2.0 * x)
        };
        0.2 + 0.5 * step(4.0) - 0.3 * step(13.0)
    }

    fn series(kept: impl Fn(usize, &[f64]) -> bool) -> Series {
        let t_s: Vec<f64> = (0..1000).map(|k| f64::from(k) * 0.02).collect();
        let q: Vec<f64> = t_s.iter().map(|t| moves(*t)).collect();
        let rows: Vec<usize> = (0..q.len()).filter(|k| kept(*k, &q)).collect();
        let of = |all: &[f64]| rows.iter().map(|k| all[*k]).collect::<Vec<f64>>();
        let cuts = crate::series::split_at_gaps(&of(&t_s));
        Series { tracks: vec![Track::new("J", of(&t_s), of(&q), &cuts).unwrap()] }
    }

    /// The plan, how many of its silences are held, and whether gaps are told of.
    fn told(mut plan: Series) -> (Series, u64, bool) {
        let (mut remarks, mut gaps) = (Remarks::default(), Gaps::default());
        let cuts: Vec<usize> = plan.tracks[0].segments().iter().skip(1).map(|part| part.start).collect();
        gaps.note(plan.tracks[0].t_s(), &cuts, &[]);
        gaps.remark("/plan", &mut remarks);
        of_both([&mut plan, &mut series(|_, _| true)], &[vec!["/plan"], vec!["/joints"]], &mut remarks);
        let of = |code: Code| remarks.as_slice().iter().filter(move |remark| remark.code == code);
        (plan, of(Code::Guessed).map(|remark| remark.count).sum(), of(Code::Gap).next().is_some())
    }

    #[test]
    fn a_plan_that_is_written_where_it_changes_is_held_in_between() {
        let changes = |k: usize, q: &[f64]| k == 0 || (q[k] - q[k - 1]).abs() > 0.0;
        let (held, silences, gaps) = told(series(changes));
        assert_eq!((silences, held.tracks[0].segments().len(), gaps), (3, 1, false));
        for k in 0..999 {
            let t = f64::from(k) * 0.02;
            let found = held.tracks[0].at(t).unwrap().position;
            assert!((found - moves(t)).abs() < 1e-9, "{t}: {found}");
        }
    }

    #[test]
    fn a_measurement_beside_it_that_is_written_so_has_a_sample_wherever_the_plan_may_start() {
        let changes = |k: usize, q: &[f64]| k == 0 || (q[k] - q[k - 1]).abs() > 0.0;
        let (mut plan, mut measured) = (series(changes), series(changes));
        of_both([&mut plan, &mut measured], &[vec!["/plan"], vec!["/joints"]], &mut Remarks::default());
        assert!(measured.tracks[0].t_s().windows(2).all(|two| two[1] - two[0] < 0.035));
        assert!(plan.tracks[0].len() < 400);
    }

    #[test]
    fn a_measurement_that_leaves_cells_empty_beside_a_plan_of_every_row_is_held() {
        let changes = |k: usize, q: &[f64]| k == 0 || (q[k] - q[k - 1]).abs() > 0.0;
        let cells = |count: u64| {
            let mut remarks = Remarks::default();
            remarks.add(
                Code::NotFinite,
                count,
                "values of /joints:position that are NaN or infinite, dropped",
            );
            remarks
        };
        let noisy = |k: usize, q: &[f64]| changes(k, q) || !(430..500).contains(&k);
        for (kept, mut remarks, holds) in [
            (&changes as &dyn Fn(usize, &[f64]) -> bool, cells(500), true),
            (&changes, cells(0), false),
            (&noisy, cells(70), false),
        ] {
            let (mut plan, mut measured) = (series(|_, _| true), series(kept));
            if !holds {
                let noise = |(k, q): (usize, &f64)| q + if k.is_multiple_of(2) { 1e-3 } else { -1e-3 };
                let track = &measured.tracks[0];
                let cuts: Vec<usize> = track.segments().iter().skip(1).map(|part| part.start).collect();
                let q = track.position().iter().enumerate().map(noise).collect();
                measured.tracks[0] = Track::new("J", track.t_s().to_vec(), q, &cuts).unwrap();
            }
            of_both([&mut plan, &mut measured], &[vec!["/plan"], vec!["/joints"]], &mut remarks);
            assert_eq!(measured.tracks[0].segments().len() == 1, holds);
            assert_eq!(
                remarks.as_slice().iter().all(|remark| remark.code == Code::Guessed),
                holds || remarks.is_empty()
            );
        }
    }

    #[test]
    fn set_values_that_come_seldom_are_held_and_samples_of_a_motion_are_not() {
        let told = |mut plan: Series, follows: &dyn Fn(f64) -> f64| {
            let mut remarks = Remarks::default();
            let t_s: Vec<f64> = (0..1000).map(|k| f64::from(k) * 0.02).collect();
            let q = t_s.iter().map(|t_s| follows(t_s - 0.2)).collect();
            let measured = Series { tracks: vec![Track::new("J", t_s, q, &[]).unwrap()] };
            of_set_values(&mut plan, &measured, &mut remarks);
            (plan, remarks.as_slice().len())
        };
        let (t_s, q) = (vec![0.0, 2.0, 3.7, 5.7, 9.1, 14.0], vec![0.2, 0.7, 0.7, 0.4, 0.4, 0.1]);
        let cuts = crate::series::split_at_gaps(&t_s);
        let set = Series { tracks: vec![Track::new("J", t_s.clone(), q.clone(), &cuts).unwrap()] };
        let steps = |at_s: f64| q[t_s.partition_point(|t_s| *t_s <= at_s).max(1) - 1];
        let (held, remarks) = told(set.clone(), &steps);
        let at = |t_s: f64| held.tracks[0].at(t_s).unwrap().position;
        assert_eq!(([1.97, 2.01, 9.0, 13.97, 19.9].map(at), remarks), ([0.2, 0.7, 0.4, 0.4, 0.1], 1));
        for every in [5, 30, 45] {
            let motion = series(|k, _| k % every == 0);
            assert_eq!(told(motion.clone(), &moves), (motion, 0), "{every}");
        }
        // Key points that are joined by lines.
        let lines = Track::new("J", t_s.clone(), q.clone(), &[]).unwrap();
        assert_eq!(told(set.clone(), &|t_s| lines.held_at(t_s).position), (set, 0));
    }

    #[test]
    fn a_plan_with_holes_is_left_as_it_is() {
        let lost = |within: std::ops::Range<usize>| series(move |k, _| !within.contains(&k));
        let moved =
            |k: usize, q: &[f64]| !(230..280).contains(&k) && (k == 0 || (q[k] - q[k - 1]).abs() > 0.0);
        for plan in [lost(225..275), lost(400..500), series(moved)] {
            assert_eq!(told(plan.clone()), (plan, 0, true));
        }
    }
}
