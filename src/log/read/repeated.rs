//! Values that are slower than their log, of a sensor or of a planner: each is written again until the next one comes.

use super::{
    followed::{gone_before, off},
    sender::{CHANGES as SENT_CHANGES, sampled},
};
use crate::{
    remark::{Code, Remarks},
    series::{Series, Track, rounding, split_at_gaps},
};

/// Values that tell, at least, and how often each is written, at least: twice is no harm.
const CHANGES: usize = 30;
const LEAST: usize = 3;
/// Share of the values that are written so often, or a multiple of it where two are equal.
const MOST: f64 = 0.95;
/// From so many rows on a value may be written once more or less: sensor and log have clocks of their own.
const UNEVEN: usize = 5;
/// Longest time for which a sample of a plan is held, s; of what was sent, which goes from target to target only where its plan
/// does.
pub(super) const LONGEST_S: f64 = 0.3;
const LONGEST_SENT_S: f64 = 0.5;
/// Rows that are looked at first.
const HEAD: usize = 4000;

/// Samples of a plan are held for longer, s, or are fewer than tell by themselves, where the joint followed what goes on between them:
/// what it is off by is this many times less, and where they are held for longer it has gone this share of the way to a value before
/// that comes, which no machine does that answers it, or is off by much less.
const SLOWEST_S: f64 = 2.0;
const FEW: usize = 8;
const LESS: f64 = 2.0;
const MUCH_LESS: f64 = 5.0;
const BEFORE: f64 = 0.2;

/// A sender has one clock for all joints: each is held for as long as another, within this share.
const ONE_CLOCK: f64 = 0.1;

/// Keeps of each value that is written again its first row; it says no more of when it was measured or planned. `is_sent`: the plan
/// is what was sent.
pub(super) fn of_sides(
    [(_, planned), (_, measured)]: &mut [(&str, &mut Series); 2],
    is_sent: bool,
    remarks: &mut Remarks,
) {
    let longest_s = if is_sent { LONGEST_SENT_S } else { LONGEST_S };
    let mut held = planned_samples(planned, measured, longest_s).into_iter();
    of_side(planned, |_| held.next().flatten(), ["planned", "its planner", "interpolated"], remarks);
    of_side(measured, fresh, ["measured", "a sensor", "not judged"], remarks);
}

/// What there was of each plan that is held, by itself, by what its joint followed, or by the clock of another joint.
fn planned_samples(planned: &Series, measured: &Series, longest_s: f64) -> Vec<Option<Track>> {
    let by_itself = |plan: &Track| {
        let beside = || measured.tracks.iter().find(|beside| beside.name() == plan.name());
        sent(plan, longest_s).or_else(|| followed(plan, beside()?, longest_s))
    };
    let mut found: Vec<Option<Track>> = planned.tracks.iter().map(by_itself).collect();
    let clocks: Vec<(&[f64], f64)> = (planned.tracks.iter().zip(&found))
        .filter_map(|(plan, found)| Some((plan.t_s(), found.as_ref()?.sample_interval_s())))
        .collect();
    if clocks.is_empty() {
        return found;
    }
    for (plan, found) in planned.tracks.iter().zip(&mut found).filter(|(_, found)| found.is_none()) {
        let on_clock = |own: &Track| {
            let near = |held_s: f64| (own.sample_interval_s() / held_s - 1.0).abs() < ONE_CLOCK;
            clocks.iter().any(|(t_s, held_s)| plan.t_s() == *t_s && near(*held_s))
        };
        *found = sampled(plan, FEW).filter(|own| on_clock(own) && rounding(plan).is_none());
    }
    found
}

/// The same of what was sent: sent again as it is logged, it would come late and in steps.
pub(super) fn of_command(command: &mut Series, remarks: &mut Remarks) {
    of_side(
        command,
        |track| sent(track, LONGEST_SENT_S),
        ["commanded", "its sender", "interpolated"],
        remarks,
    );
}

/// `of`: what there was of a track, if it is held.
fn of_side(
    series: &mut Series,
    mut of: impl FnMut(&Track) -> Option<Track>,
    [side, source, between]: [&str; 3],
    remarks: &mut Remarks,
) {
    let (mut dropped, mut names) = (0, Vec::new());
    for track in &mut series.tracks {
        let Some(fresh) = of(track) else { continue };
        dropped += track.len().saturating_sub(fresh.len());
        names.push(track.name().to_owned());
        *track = fresh;
    }
    let message = format!(
        "{side} values of {} that only repeat the one before, in step with {source}, which is slower than the log: left out, \
         and the rows between its values are {between}",
        names.join(", ")
    );
    remarks.add(Code::Guessed, dropped as u64, message);
}

/// The samples of a motion that was sent slower than it was logged: set values that step from one to the next are held longer, and
/// those that are rounded change when the plan passes from one to the next. Between them it goes on smoothly.
fn sent(track: &Track, longest_s: f64) -> Option<Track> {
    let found = sampled(track, SENT_CHANGES)?;
    (found.sample_interval_s() <= longest_s && rounding(track).is_none()).then_some(found)
}

/// The samples of a motion that a joint followed.
fn followed(track: &Track, came: &Track, longest_s: f64) -> Option<Track> {
    let found = sampled(track, FEW).filter(|_| rounding(track).is_none())?;
    let held_s = found.sample_interval_s();
    let [by_lines, by_steps] = [off(&found, came), off(track, came)];
    let slow = || MUCH_LESS * by_lines < by_steps || gone_before(&found, came) > BEFORE;
    let follows = LESS * by_lines < by_steps && (held_s <= longest_s || held_s <= SLOWEST_S && slow());
    follows.then_some(found)
}

fn differ(a: f64, b: f64) -> bool {
    (a - b).abs() > 0.0
}

/// The track without rows that repeat; `None` if its values do not come in even steps of rows.
fn fresh(track: &Track) -> Option<Track> {
    let (t_s, q) = (track.t_s(), track.position());
    // Most logs tell by their first rows.
    let head = q.get(..HEAD.min(q.len())).unwrap_or_default();
    let changed = head.windows(2).filter(|two| differ(two[0], two[1])).count();
    if changed >= CHANGES && LEAST * changed > head.len() {
        return None;
    }
    let changes: Vec<usize> = (1..q.len()).filter(|&i| differ(q[i], q[i - 1])).collect();
    if changes.len() < CHANGES || LEAST * changes.len() > q.len() {
        return None;
    }
    let mut rows: Vec<usize> = changes.windows(2).map(|two| two[1] - two[0]).collect();
    let tenth = rows.len() / 10;
    let every = *rows.select_nth_unstable(tenth).1;
    let off = |rows: &usize| (rows % every).min(every - rows % every);
    let even = rows.iter().filter(|rows| off(rows) <= usize::from(every >= UNEVEN)).count();
    if every < LEAST || (even as f64) < MOST * rows.len() as f64 {
        return None;
    }
    // Where it stands, equal values come as often.
    let (mut kept, mut next) = (Vec::new(), 0);
    for i in 0..q.len() {
        if i == 0 || differ(q[i], q[i - 1]) || i >= next && i + 1 < q.len() && !differ(q[i], q[i + 1]) {
            kept.push(i);
            next = i + every;
        }
    }
    // A rest goes on to the end.
    if let [.., before, last] = kept[..]
        && last + 1 < q.len()
        && !differ(q[before], q[q.len() - 1])
    {
        kept.push(q.len() - 1);
    }
    let of = |values: &[f64]| kept.iter().map(|&i| values[i]).collect::<Vec<f64>>();
    let t_s = of(t_s);
    let cuts = split_at_gaps(&t_s);
    let fresh = Track::of(track.kind(), track.name(), t_s, of(q), &cuts).ok()?;
    match track.velocity() {
        Some(velocity) => fresh.with_velocity(of(velocity)).ok(),
        None => Some(fresh),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How many of 2000 rows at 100 Hz are kept of what a joint has, read at times.
    fn kept(read_s: impl Fn(usize) -> f64, step: f64) -> usize {
        let t_s: Vec<f64> = (0..2000).map(|k| f64::from(k) * 0.01).collect();
        let at = |k: usize| (0.3 * (0.7 * read_s(k)).sin() / step).round() * step;
        let track = Track::new("a", t_s, (0..2000).map(at).collect(), &[]).unwrap();
        let mut series = Series { tracks: vec![track] };
        of_side(&mut series, fresh, ["measured", "a sensor", "not judged"], &mut Remarks::default());
        series.tracks[0].len()
    }

    #[test]
    fn a_plan_that_is_held_keeps_its_rest_to_the_end() {
        let t_s: Vec<f64> = (0..1203).map(|k| f64::from(k) * 0.01).collect();
        let at = |k: usize| 1.0 - (0.4 * (0.05 * (k / 5) as f64).min(8.0)).cos();
        let track = Track::new("a", t_s, (0..1203).map(at).collect(), &[]).unwrap();
        let (mut planned, mut measured) = (Series { tracks: vec![track] }, Series::default());
        let mut remarks = Remarks::default();
        of_sides(&mut [("planned", &mut planned), ("measured", &mut measured)], false, &mut remarks);
        let kept = &planned.tracks[0];
        assert_eq!((kept.len(), kept.t_s().last()), (241, Some(&12.02)));
        let said = &remarks.as_slice()[0].message;
        assert!(said.starts_with("planned values of a") && said.ends_with("are interpolated"), "{said}");
        // A staircase of set values, and a plan in steps of 0.1 deg, are as they are.
        let steps: [fn(usize) -> f64; 2] =
            [|k| 0.05 * (k / 100) as f64, |k| (1.7e-4 * k as f64 / 1.7e-3).round() * 1.7e-3];
        for at in steps {
            let t_s: Vec<f64> = (0..4000).map(|k| f64::from(k) * 0.01).collect();
            let track = Track::new("a", t_s, (0..4000).map(at).collect(), &[]).unwrap();
            let (mut planned, mut measured) = (Series { tracks: vec![track] }, Series::default());
            of_sides(
                &mut [("planned", &mut planned), ("measured", &mut measured)],
                false,
                &mut Remarks::default(),
            );
            assert_eq!(planned.tracks[0].len(), 4000);
        }
    }

    #[test]
    fn what_was_sent_in_steps_of_a_slow_sender_is_what_it_sampled() {
        for held in [10, 25, 50] {
            let t_s: Vec<f64> = (0..4000).map(|k| f64::from(k) * 0.01).collect();
            let sent = |t_s: f64| 0.3 * (0.3 * t_s.clamp(5.0, 35.0)).sin();
            let at = |k: usize| sent(0.01 * (k / held * held) as f64);
            let track = Track::new("a", t_s, (0..4000).map(at).collect(), &[]).unwrap();
            let off = |track: &Track| {
                let one = |t_s: f64| (track.held_at(t_s).position - sent(t_s)).abs();
                (0..4000).map(|k| one(0.01 * f64::from(k))).fold(0.0, f64::max)
            };
            let mut command = Series { tracks: vec![track.clone()] };
            of_command(&mut command, &mut Remarks::default());
            let (before, after) = (off(&track), off(&command.tracks[0]));
            assert!(after < 0.2 * before, "{held} rows: {before} rad, {after} rad");
        }
    }

    #[test]
    fn a_plan_that_is_held_for_long_is_what_its_joint_followed() {
        let step = |t_s: f64, from_s: f64| ((t_s - from_s) / 3.0).clamp(0.0, 1.0);
        let sent = |t_s: f64| 0.3 * (step(t_s, 2.2) - step(t_s, 8.1) + step(t_s, 14.3));
        let held = |t_s: f64| sent((2.0 * t_s + 1e-9).floor() / 2.0);
        let track = |of: &dyn Fn(f64) -> f64| {
            let t_s: Vec<f64> = (0..2000).map(|k| f64::from(k) * 0.01).collect();
            Track::new("a", t_s.clone(), t_s.iter().map(|t_s| of(*t_s)).collect(), &[]).unwrap()
        };
        let read = |follows: &dyn Fn(f64) -> f64| {
            let (mut planned, mut measured) =
                (Series { tracks: vec![track(&held)] }, Series { tracks: vec![track(follows)] });
            of_sides(
                &mut [("planned", &mut planned), ("measured", &mut measured)],
                false,
                &mut Remarks::default(),
            );
            let off = |t_s: f64| (planned.tracks[0].held_at(t_s).position - sent(t_s)).abs();
            (0..1900).map(|k| off(f64::from(k) * 0.01)).fold(0.0, f64::max)
        };
        let (followed, stepped) = (read(&|t_s| sent(t_s - 0.3)), read(&|t_s| held(t_s - 0.3)));
        assert!(followed < 0.02, "{followed} rad");
        assert!(stepped > 0.04, "a joint that steps was asked for steps: {stepped} rad");
    }

    #[test]
    fn a_slow_sensor_is_read_when_it_has_a_value_and_an_encoder_of_few_steps_always() {
        assert_eq!(kept(|k| 0.1 * (k / 10) as f64, 1e-9), 200);
        let uneven = kept(|k| 0.095 * (k as f64 * 0.01 / 0.095).floor(), 1e-9);
        assert!((200..225).contains(&uneven), "{uneven}");
        assert_eq!(kept(|k| 0.01 * k as f64, 2e-3), 2000);
        assert_eq!(kept(|k| 0.02 * (k / 2) as f64, 1e-9), 2000, "twice each");
    }
}
