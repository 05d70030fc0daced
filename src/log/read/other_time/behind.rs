//! Finds a run that fell behind its plan on the way, and stayed so: an override, or a pause.

use super::both::{BEGUN, Both, FAR, LEFT, LESS_THAN_LAG, Steps, apart, lagged, shift_s};
use crate::{
    math::{line, range, whole},
    series::{Series, whole_until_s},
};

/// Parts of a run, of each of which the lateness is sought among so many, s apart; one that grows on costs so much each time, beside
/// squares of errors by planned motions.
const PARTS: usize = 60;
const LATENESSES: usize = 301;
const STEP_S: f64 = 0.1;
const CHANGE: f64 = 0.02;

/// It grows by more than machines lag, s.
const GROWS_S: f64 = 1.0;

/// Share of its planned motion that a joint has left once it is as late as it stays: one that only takes long may be slow.
const AFTER: f64 = 0.2;

/// Errors that are explained by it leave less than this of those that are there.
const EXPLAINED: f64 = 0.3;

/// A run that falls behind evenly is never farther from that than this share of all that it falls behind, in so many parts.
const EVEN: f64 = 0.15;
const LEAST_PARTS: usize = 15;

/// A joint that falls behind alone and in this share of the parts goes as fast as it ever does, to within that share, is at a limit of its own.
const AT_LIMIT: [f64; 2] = [0.5, 0.9];

/// How a run fell behind.
pub(in crate::log::read) struct Behind {
    /// Ends of the parts, s, and how late the run is in each, s; that never falls.
    late_s: Vec<[f64; 2]>,
    /// Whether it moved on as late as it then was.
    stays: bool,
    /// When the plan first moves, s.
    begins_s: f64,
}

impl Behind {
    /// How a run fell behind, if that explains what it is off by, and a lag does not.
    pub(in crate::log::read) fn of(planned: &Series, measured: &Series) -> Option<Self> {
        let joints = Both::all(planned, measured);
        let as_it_is = apart(&joints, |joint, t_s| joints[joint].planned.held_at(t_s).position);
        if !as_it_is.is_finite() || as_it_is < FAR {
            return None;
        }
        let steps: Vec<Steps> = joints.iter().map(|joint| Steps::of(joint.planned)).collect::<Option<_>>()?;
        let found = Self {
            late_s: path(&joints, &steps)?,
            stays: false,
            begins_s: joints
                .iter()
                .filter_map(Both::start_s)
                .map(|[from_s, _]| from_s)
                .fold(f64::INFINITY, f64::min),
        };
        let [first_s, last_s] = [found.late_s.first()?[1], found.late_s.last()?[1]];
        let plan = |joint: usize, t_s: f64| steps[joint].at(t_s - found.late_at(t_s));
        if last_s - first_s < GROWS_S {
            return None;
        }
        let (left, left_by_lag) = (apart(&joints, plan), lagged(&joints, shift_s(&joints)).0);
        // Where a lag explains it, a motion that repeats itself fits a period later, too.
        if left_by_lag < FAR || left > LEFT[1] * as_it_is || left > LESS_THAN_LAG * left_by_lag {
            return None;
        }
        // Joints that are slow fall behind each by itself, and where they catch up nothing stays.
        let explained = |(k, joint): &(usize, &Both)| {
            joint.apart(|t_s| plan(*k, t_s)) < EXPLAINED * joint.apart(|t_s| steps[*k].at(t_s))
        };
        let count = joints.iter().enumerate().filter(explained).count();
        let stays_from_s = found.stays_from_s();
        let goes_on = |joint: &Both| {
            let after = joint.came.iter().filter(|[t_s, _]| *t_s > stays_from_s);
            let [low, high] = range(after.map(|[_, q]| *q));
            high - low > AFTER * joint.motion
        };
        let stays = joints.iter().any(goes_on);
        // One that stands for good falls behind, too.
        let moves = || joints.iter().any(|joint| found.moved_meanwhile(joint) > AFTER * joint.motion);
        if found.is_at_limit(&joints) {
            return None;
        }
        (stays || count > 1 && count == joints.len() && moves()).then_some(Self { stays, ..found })
    }

    /// Whether one joint alone moves where the run falls behind, and goes there as fast as it ever does.
    fn is_at_limit(&self, joints: &[Both]) -> bool {
        let mut moving = joints.iter().filter(|joint| self.moved_meanwhile(joint) > BEGUN * joint.motion);
        let Some(joint) = moving.next().filter(|_| moving.next().is_none()) else { return false };
        let place = |s: f64| joint.came.partition_point(|[t_s, _]| *t_s <= s);
        let speed = |two: &[[f64; 2]]| {
            let part = joint.came.get(place(two[0][0])..place(two[1][0]))?;
            let [from, to] = [part.first()?, part.last()?];
            Some(((to[1] - from[1]) / (to[0] - from[0])).abs()).filter(|speed| speed.is_finite())
        };
        let fastest = self.late_s.windows(2).filter_map(speed).fold(0.0, f64::max);
        let growing = self.late_s.windows(2).filter(|two| two[1][1] > two[0][1]);
        let speeds: Vec<f64> = growing.filter_map(speed).collect();
        let at_limit = speeds.iter().filter(|speed| **speed > AT_LIMIT[1] * fastest).count();
        at_limit as f64 > AT_LIMIT[0] * speeds.len() as f64
    }

    /// How far a joint moves in the parts in which it falls behind.
    fn moved_meanwhile(&self, joint: &Both) -> f64 {
        let growing = self.late_s.windows(2).filter(|two| two[1][1] > two[0][1]);
        let of = |two: &[[f64; 2]]| {
            let within = joint.came.iter().filter(|[t_s, _]| *t_s > two[0][0] && *t_s <= two[1][0]);
            let [low, high] = range(within.map(|[_, q]| *q));
            (high - low).max(0.0)
        };
        growing.map(of).sum()
    }

    fn late_at(&self, t_s: f64) -> f64 {
        let part = self.late_s.partition_point(|[end_s, _]| *end_s < t_s).min(self.late_s.len() - 1);
        self.late_s[part][1]
    }

    /// From when on it is as late as it stays, s.
    fn stays_from_s(&self) -> f64 {
        let last_s = self.late_s[self.late_s.len() - 1][1];
        let before = self.late_s.iter().rev().find(|[_, late_s]| *late_s < last_s);
        before.map_or(f64::NEG_INFINITY, |[end_s, _]| *end_s)
    }

    /// By how much it falls behind before and after a time in which it stands, s.
    pub(in crate::log::read) fn grows_outside(&self, [from_s, to_s]: [f64; 2]) -> bool {
        let each = self.late_s.windows(2).filter(|two| two[0][0] <= from_s || two[0][0] >= to_s);
        each.map(|two| two[1][1] - two[0][1]).sum::<f64>() >= GROWS_S
    }

    /// How many times as long as its plan a run took that fell behind evenly from its first motion on.
    fn throughout(&self) -> Option<f64> {
        let (first_s, stays_from_s) = (self.late_s[0][1], self.stays_from_s());
        // Before it moves it may be late by anything.
        let grows = self.late_s.iter().skip_while(|[_, late_s]| *late_s <= first_s);
        let (t_s, late_s): (Vec<f64>, Vec<f64>) = grows
            .filter(|[end_s, _]| *end_s <= stays_from_s)
            .map(|[end_s, late_s]| (*end_s, *late_s))
            .unzip();
        let most_s = late_s.last().copied().unwrap_or_default();
        let even = line(&t_s, &late_s);
        let far = |late_s: f64| late_s.abs() > EVEN * most_s;
        let at_first_s = late_s.first()? - even.left.first()? + even.slope * (self.begins_s - t_s.first()?);
        let evenly = t_s.len() >= LEAST_PARTS
            && !even.left.iter().any(|left_s| far(*left_s))
            && !far(at_first_s)
            && (0.0..1.0).contains(&even.slope);
        evenly.then(|| 1.0 / (1.0 - even.slope))
    }

    pub(in crate::log::read) fn message(&self, planned: &Series) -> String {
        if let Some(times) = self.throughout() {
            return format!(
                "the joints take about {times:.2} times as long as their plan, from its beginning on: was the machine run at another speed \
                 (override)? Errors at the same instant say little then, the distance to the path does"
            );
        }
        let first_s = self.late_s[0][1];
        let last_s = self.late_s[self.late_s.len() - 1][1];
        let from_s = self.late_s.iter().take_while(|[_, late_s]| *late_s <= first_s).map(|[end_s, _]| *end_s);
        let from_s = from_s.last().unwrap_or_default();
        let until = if self.stays {
            format!("until {:.0} s, and go on {last_s:.1} s late", self.stays_from_s())
        } else {
            format!("until the end, where they are {last_s:.1} s late")
        };
        let plans = planned.tracks.iter().map(|track| (track.t_s(), track.position()));
        let alone = whole_until_s(plans, from_s).map_or(String::new(), |until_s| {
            format!("; what was in time is read alone with --to {until_s:.1}")
        });
        format!(
            "all joints fall behind their plan by {:.1} s from about {from_s:.0} s {until}: the run was slowed or held meanwhile (override, \
             pause). Errors at the same instant say little from there on, the distance to the path does{alone}",
            last_s - first_s
        )
    }
}

/// The ends of parts of a run, s, and the lateness of each, s, that never falls and leaves least.
fn path(joints: &[Both], steps: &[Steps]) -> Option<Vec<[f64; 2]>> {
    let instants = || joints.iter().flat_map(|joint| &joint.came).map(|[t_s, _]| *t_s);
    let [first_s, last_s] = range(instants());
    let part_s = (last_s - first_s) / PARTS as f64;
    if !(part_s > 0.0 && part_s.is_finite()) {
        return None;
    }
    let mut costs = vec![[0.0; LATENESSES]; PARTS];
    for (joint, steps) in joints.iter().zip(steps) {
        for [t_s, q] in &joint.came {
            let part = whole((t_s - first_s) / part_s).min(PARTS - 1);
            for (k, cost) in costs[part].iter_mut().enumerate() {
                *cost += ((q - steps.at(t_s - k as f64 * STEP_S)) / joint.motion).powi(2);
            }
        }
    }
    // The least that leads to each lateness of each part, and the one before it: no run falls behind by more than the time that passes.
    let reach = whole((part_s / STEP_S).ceil());
    let mut least = costs[0];
    let mut before = Vec::with_capacity(PARTS - 1);
    for cost in &costs[1..] {
        let from = |k: usize| {
            let changed = (k.saturating_sub(reach)..k).min_by(|a, b| least[*a].total_cmp(&least[*b]));
            let changed = changed.map(|from| (least[from] + CHANGE, from));
            changed.filter(|(changes, _)| *changes < least[k]).unwrap_or((least[k], k))
        };
        let came: [(f64, usize); LATENESSES] = std::array::from_fn(from);
        before.push(came.map(|(_, from)| from));
        least = std::array::from_fn(|k| came[k].0 + cost[k]);
    }
    let mut at = (0..LATENESSES).min_by(|a, b| least[*a].total_cmp(&least[*b]))?;
    let mut late_s = Vec::with_capacity(PARTS);
    for part in (0..PARTS).rev() {
        late_s.push([first_s + (part + 1) as f64 * part_s, at as f64 * STEP_S]);
        if part > 0 {
            at = before[part - 1][at];
        }
    }
    late_s.reverse();
    Some(late_s)
}
