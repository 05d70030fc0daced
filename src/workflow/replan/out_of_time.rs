//! Runs in which what was sent stood for a while in motion, ran at another pace than its plan, or is not logged to its end: what came
//! then is no error of the machine.

use crate::{
    log::Recording,
    math::deviation,
    remark::Code,
    series::{JointKind, Series, Track, moving_s},
    units::DEGREE_RAD,
};

/// Steps in which set values are looked at, s.
const STEP_S: f64 = 0.02;
/// Set values that move less in a step stand, rad or m.
const STILL: f64 = 1e-6;
/// They were held if they stand for so many steps while a plan goes on; more often than so they come in stairs.
const HELD_STEPS: usize = 7;
const MOST_HOLDS: usize = 3;
/// Steps before and after in which they go on, by so much of the speed of their plan.
const BESIDE_STEPS: usize = 5;
const GOES_ON: f64 = 0.4;
/// Planned speed that a hold shows in, rad/s, and m/s of joints that slide.
const fn shows(kind: JointKind) -> f64 {
    match kind {
        JointKind::Turns => DEGREE_RAD,
        JointKind::Slides => 0.01,
    }
}

/// A command leads its plan by this at most, s; a plan that moves farther after the end of what was sent goes on, rad or m.
const LEADS_AT_MOST_S: f64 = 1.0;
const MISSED: f64 = 0.5 * DEGREE_RAD;

/// What is sent runs at another pace if it is later in the last third of the motion than in the first by so much, s, late or far ahead
/// there, and the squares of what it is off by are then fewer by this factor than of what leads or lags alone.
const PACE_S: f64 = 0.1;
const LATE_S: f64 = 0.05;
const AHEAD_S: f64 = 0.5;
const CLEARLY: f64 = 0.25;
/// Less than this share is what clocks are apart by; what is off by less of the motion is in time.
const LEAST: f64 = 0.005;
const NEAR: f64 = 0.005;
/// Paces and leads, s, that are tried: steps, and so many of them to either side.
const PACE: f64 = 0.01;
const PACES: i32 = 30;
const LEADS_S: f64 = 0.1;
const LEADS: i32 = 6;
/// Instants at which they are.
const INSTANTS: u32 = 150;

/// What is to be said of such a run.
pub(super) fn out_of_time(run: &Recording) -> Option<(Code, String)> {
    let course = Course::of(&run.planned, &run.command.as_ref()?.series)?;
    course.unlogged().or_else(|| course.held()).or_else(|| course.other_pace())
}

/// A plan and what was sent for it, over the motion of the plan.
struct Course<'a> {
    joints: Vec<(&'a Track, &'a Track)>,
    from_s: f64,
    lasts_s: f64,
}

impl<'a> Course<'a> {
    fn of(planned: &'a Series, sent: &'a Series) -> Option<Self> {
        let [from_s, to_s] = moving_s(planned)?;
        let both = |plan: &'a Track| Some((plan, sent.track(plan.name())?));
        let joints: Vec<_> = planned.tracks.iter().filter_map(both).collect();
        (!joints.is_empty()).then_some(Self { joints, from_s, lasts_s: to_s - from_s })
    }

    /// What was sent is not in the log while the plan goes on; one written only where it changes ends before its plan, by a lead.
    fn unlogged(&self) -> Option<(Code, String)> {
        let to_s = self.from_s + self.lasts_s;
        let of = |(plan, sent): &(&Track, &Track)| {
            let ends_s = *sent.t_s().last()?;
            let from_s = ends_s + LEADS_AT_MOST_S;
            let place = |t_s: f64| plan.held_at(t_s).position;
            let left = self.instants([0.0, 1.0]).map(|t_s| self.from_s + t_s).filter(|t_s| *t_s > from_s);
            let moved = left.map(|t_s| (place(t_s) - place(from_s)).abs()).fold(0.0, f64::max);
            (moved > MISSED).then_some(ends_s)
        };
        let ends_s = self.joints.iter().filter_map(of).reduce(f64::min)?;
        let why = format!(
            "what was sent is logged until {ends_s:.2} s only, while its plan goes on to {to_s:.2} s"
        );
        Some((Code::Gap, why))
    }

    /// What was sent stood for a while, and went on.
    fn held(&self) -> Option<(Code, String)> {
        let Self { joints, from_s, lasts_s } = self;
        let instants =
            || (0..).map(|k| STEP_S * f64::from(k)).take_while(|t_s| t_s <= lasts_s).map(|t_s| from_s + t_s);
        let speeds = |track: &Track| -> Vec<f64> {
            let mut cursor = 0;
            // In a hole of the log nothing stands.
            let mut at = |t_s: f64| track.at_after(&mut cursor, t_s).map_or(f64::NAN, |state| state.position);
            let at: Vec<f64> = instants().map(&mut at).collect();
            at.windows(2).map(|pair| (pair[1] - pair[0]) / STEP_S).collect()
        };
        let speeds: Vec<[Vec<f64>; 2]> =
            joints.iter().map(|(plan, sent)| [plan, sent].map(|track| speeds(track))).collect();
        let stands = |k: usize| speeds.iter().all(|[_, sent]| sent[k].abs() * STEP_S < STILL);
        let steps = speeds.first()?[0].len();
        let (mut found, mut k) = (Vec::new(), 0);
        while k < steps {
            let length = (k..steps).take_while(|k| stands(*k)).count();
            let end = k + length;
            let hold = length >= HELD_STEPS && k >= BESIDE_STEPS && end + BESIDE_STEPS <= steps;
            let goes_on = |(joint, [plan, sent]): (usize, &[Vec<f64>; 2])| {
                let least = shows(joints[joint].0.kind());
                let toward = plan[k].signum();
                let moves = |k: usize| toward * plan[k] > least;
                let along = |k: usize| toward * sent[k] > GOES_ON * toward * plan[k];
                (k - BESIDE_STEPS..end + BESIDE_STEPS).all(moves)
                    && (k - BESIDE_STEPS..k - 1).chain(end + 1..end + BESIDE_STEPS).all(along)
            };
            if hold && speeds.iter().enumerate().any(goes_on) {
                found.push((from_s + STEP_S * k as f64, STEP_S * length as f64));
            }
            k = end + 1;
        }
        let (at_s, lasts_s) = *found.first().filter(|_| found.len() <= MOST_HOLDS)?;
        let why = format!(
            "what was sent stands from {at_s:.2} s on for {lasts_s:.1} s while its plan goes on: a hold or an emergency stop"
        );
        Some((Code::Paused, why))
    }

    /// What was sent took longer than its plan, or less.
    fn other_pace(&self) -> Option<(Code, String)> {
        let about = |middle: f64, step: f64, count: i32| -> Vec<f64> {
            (-count..=count).map(|k| middle + step * f64::from(k)).collect()
        };
        // A correction leads its plan, by a lag of each joint too; none comes late at the end alone.
        let (leads_s, fine_s) = (about(0.0, LEADS_S, LEADS), about(0.0, 0.2 * LEADS_S, 5 * LEADS));
        let led = |by_s: &f64| self.left_by_lag([0.0, 1.0], *by_s);
        let in_time = fine_s.iter().map(led).reduce(f64::min)?;
        if in_time < (NEAR * self.spread()).powi(2) {
            return None;
        }
        let (way, _) = self.least([0.0, 1.0], &about(1.0, PACE, PACES), &leads_s)?;
        let (fine, beside_s) = (about(way[0], 0.1 * PACE, 10), about(way[1], 0.2 * LEADS_S, 5));
        let ([pace, _], at_pace) = self.least([0.0, 1.0], &fine, &beside_s)?;
        let far_s = about(0.0, 0.5 * LEADS_S, 10 * LEADS);
        let lead_s = |part| self.least(part, &[1.0], &far_s).map(|([_, by_s], _)| by_s);
        let [early_s, late_s] = [lead_s([0.0, 1.0 / 3.0])?, -lead_s([2.0 / 3.0, 1.0])?];
        let longer = pace - 1.0;
        let behind = if longer > 0.0 { late_s > LATE_S } else { -late_s > AHEAD_S };
        let apart = longer.signum() * (late_s + early_s) > PACE_S;
        let inside = (LEAST..PACE * f64::from(PACES)).contains(&longer.abs());
        let why = || {
            format!(
                "what was sent lasts {:.1} % {} than its plan: an override, or the clock of another device",
                100.0 * longer.abs(),
                if longer > 0.0 { "longer" } else { "shorter" }
            )
        };
        (behind && apart && inside && at_pace < CLEARLY * in_time).then(|| (Code::Paused, why()))
    }

    /// Instants of a part of the motion, from 0 to 1, s from its start.
    fn instants(&self, [from, to]: [f64; 2]) -> impl Iterator<Item = f64> + use<'_> {
        (0..=INSTANTS).map(move |k| (from + (to - from) * f64::from(k) / f64::from(INSTANTS)) * self.lasts_s)
    }

    /// Mean square of the plan about its mean, over all joints, as a root.
    fn spread(&self) -> f64 {
        let of = |(plan, _): &(&Track, &Track)| {
            let q: Vec<f64> =
                self.instants([0.0, 1.0]).map(|t_s| plan.held_at(self.from_s + t_s).position).collect();
            deviation(&q).powi(2)
        };
        self.joints.iter().map(of).sum::<f64>().sqrt()
    }

    /// Mean square of what is off where what is sent is so much earlier and takes so many times as long.
    fn left(&self, part: [f64; 2], [pace, by_s]: [f64; 2]) -> f64 {
        let off = |(plan, sent): &(&Track, &Track)| {
            let (mut at, mut then) = (0, 0);
            let one = |t_s: f64| {
                let wanted = plan.held_after(&mut at, self.from_s + t_s).position;
                (wanted - sent.held_after(&mut then, self.from_s + pace * t_s - by_s).position).powi(2)
            };
            self.instants(part).map(one).sum::<f64>() / f64::from(INSTANTS)
        };
        self.joints.iter().map(off).sum()
    }

    /// The same where what is sent is in time, but for so much lead, and for shares of the speed and acceleration of the plan of each
    /// joint, as it is that compensates a lag or is behind a filter.
    fn left_by_lag(&self, part: [f64; 2], by_s: f64) -> f64 {
        let off = |(plan, sent): &(&Track, &Track)| {
            let (mut then, mut at) = (0, [0; 3]);
            let (mut own, mut with, mut squares) = ([[0.0; 2]; 2], [0.0; 2], 0.0);
            for t_s in self.instants(part) {
                let now_s = self.from_s + t_s + by_s;
                let mut place = |k: usize, t_s: f64| plan.held_after(&mut at[k], t_s).position;
                let [last, now, next] = [place(0, now_s - STEP_S), place(1, now_s), place(2, now_s + STEP_S)];
                let rates = [(next - last) / (2.0 * STEP_S), (next - 2.0 * now + last) / (STEP_S * STEP_S)];
                let off = sent.held_after(&mut then, self.from_s + t_s).position - now;
                squares += off * off;
                for i in 0..2 {
                    with[i] += off * rates[i];
                    own[i][0] += rates[i] * rates[0];
                    own[i][1] += rates[i] * rates[1];
                }
            }
            let determinant = own[0][0] * own[1][1] - own[0][1] * own[1][0];
            if determinant <= 1e-12 * own[0][0] * own[1][1] {
                return squares / f64::from(INSTANTS);
            }
            let told = own[1][1] * with[0] * with[0] - 2.0 * own[0][1] * with[0] * with[1]
                + own[0][0] * with[1] * with[1];
            (squares - told / determinant).max(0.0) / f64::from(INSTANTS)
        };
        self.joints.iter().map(off).sum()
    }

    /// The pace and lead that leave least, and what that is.
    fn least(&self, part: [f64; 2], paces: &[f64], leads_s: &[f64]) -> Option<([f64; 2], f64)> {
        let all = paces.iter().flat_map(|pace| leads_s.iter().map(|by_s| [*pace, *by_s]));
        all.map(|way| (way, self.left(part, way))).min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::smooth_step as step;

    fn held(plan: &Series, sent: &Series) -> Option<(Code, String)> {
        Course::of(plan, sent)?.held()
    }

    fn other_pace(plan: &Series, sent: &Series) -> Option<(Code, String)> {
        Course::of(plan, sent)?.other_pace()
    }

    fn series(at_s: impl Fn(f64) -> f64) -> Series {
        let plan = |size: f64, t: f64| size * (step((t - 2.0) / 4.0) - 0.6 * step((t - 9.0) / 5.0));
        let track = |name: &str, size: f64| Track::sampled(name, 1800, |t| plan(size, at_s(t)));
        Series { tracks: vec![track("swing", 1.0), track("boom", -0.5)] }
    }

    #[test]
    fn a_hold_and_another_pace_are_told_and_what_a_correction_does_is_not() {
        let plan = series(|t| t);
        let hold = |for_s: f64| series(move |t| if t < 4.0 { t } else { (t - for_s).max(4.0) });
        for for_s in [0.2, 0.35, 1.0] {
            let found = held(&plan, &hold(for_s)).map_or(String::new(), |found| found.1);
            let lasts = [0.0, 0.04, -0.04].map(|by| format!("for {:.1} s", for_s + by));
            assert!(found.contains("from 4.0") && lasts.iter().any(|lasts| found.contains(lasts)), "{found}");
        }
        for sent in [hold(0.08), series(|t| t + 0.3), series(|t| (5.0 * t).floor() / 5.0)] {
            assert_eq!(held(&plan, &sent), None);
        }
        for (pace, told) in [(1.02, 2.0), (1.06, 6.0), (1.25, 25.0), (0.92, -8.0)] {
            let found =
                other_pace(&plan, &series(|t| 2.0 + (t - 2.0) / pace)).map_or(String::new(), |found| found.1);
            let percent: f64 = found.split(' ').nth(4).and_then(|word| word.parse().ok()).unwrap_or(f64::NAN);
            let signed = if found.contains("longer") { percent } else { -percent };
            assert!((signed - told).abs() < 0.3, "{pace}: {found}");
        }
        let until = |s: f64| {
            let track = |track: &Track| {
                let n = track.t_s().partition_point(|t_s| *t_s <= s);
                Track::new(track.name(), track.t_s()[..n].to_vec(), track.position()[..n].to_vec(), &[])
                    .unwrap()
            };
            Series { tracks: plan.tracks.iter().map(track).collect() }
        };
        let unlogged = |sent: &Series| Course::of(&plan, sent).unwrap().unlogged();
        assert!(unlogged(&until(8.0)).is_some_and(|found| found.1.contains("until 8.00 s only")));
        assert_eq!([unlogged(&until(13.0)), unlogged(&plan)], [None, None]);
        // What a correction does: it leads at starts and comes back where the plan rests.
        let lead = |t: f64| t + 0.25 * (std::f64::consts::PI * ((t - 2.0) / 4.0).clamp(0.0, 1.0)).sin();
        for sent in [series(|t| t), series(|t| t + 0.3), series(lead)] {
            assert_eq!(other_pace(&plan, &sent), None);
        }
        // One smooth motion, behind a filter, or made for one.
        let t_s: Vec<f64> = (0..900).map(|k| f64::from(k) * 0.01).collect();
        let one = |t: f64| step((t - 2.0) / 4.0);
        let speed = |t: f64| 100.0 * (one(t + 0.005) - one(t - 0.005));
        let of = |q: &dyn Fn(f64) -> f64| {
            let q = t_s.iter().map(|t| q(*t)).collect();
            Series { tracks: vec![Track::new("swing", t_s.clone(), q, &[]).unwrap()] }
        };
        for lag_s in [0.3, 0.6, -0.3] {
            let sent = of(&|t| one(t + 0.3) + lag_s * speed(t + 0.3));
            assert_eq!(other_pace(&of(&one), &sent), None, "{lag_s}");
        }
    }
}
