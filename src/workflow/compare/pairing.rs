//! Which transition of one run is which of another.

use serde::{Deserialize, Serialize};

use super::plans::{PlanDifference, plan_difference};
use crate::{math::median, replay::Transition, series::Pair, workflow::report::Report};

/// Planned onsets at most this far apart, clocks aligned, are the same, s.
const SAME_ONSET_S: f64 = 0.3;
/// Planned onsets of another timing of the same task may be so far apart once its key points are laid onto
/// each other, s.
const SAME_MOTION_S: f64 = 2.0;
/// Different plans have one rhythm if this share of their onsets meets.
const SAME_RHYTHM: f64 = 0.8;
/// Transitions of a joint that may be missing at the beginning of a run.
const MOST_MISSING: usize = 8;

/// How two transitions were found to be the same one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum PairedBy {
    /// Their planned onsets are at the same time of the plan.
    Clock,
    /// Both runs hold the same task, and between the same of its key points they are nearest.
    Task,
    /// The joint starts equally often in the same directions, in another rhythm.
    Order,
}

/// How another run corresponds to the first.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Match {
    /// What is added to times of the first to get those of the other, s.
    pub(super) offset_s: f64,
    /// Largest difference of the plans at equal times, rad.
    pub(super) plans: Option<PlanDifference>,
    /// For each transition of the first the one of the other.
    pub(super) partners: Vec<Option<(usize, PairedBy)>>,
}

/// Matches the transitions of two runs in the joints given. Nothing is guessed: what neither time nor order
/// decides stays alone.
pub(super) fn matched(a: &Report, b: &Report, joints: &[String]) -> Match {
    let starts = Starts::new(&a.replay.transitions, &b.replay.transitions, joints);
    let pairs: Vec<(&Pair, &Pair)> = joints
        .iter()
        .filter_map(|joint| {
            let of = |report: &'_ Report| report.pairs.iter().position(|pair| pair.name == *joint);
            Some((&a.pairs[of(a)?], &b.pairs[of(b)?]))
        })
        .collect();
    let first_s = starts.first_offset_s().unwrap_or(0.0);
    let plans = plan_difference(&pairs, starts.refined_s(first_s));
    // Where the beginning of a run is missing, its first start is another one; the plans tell.
    let other = || plan_difference(&pairs, starts.best_offset_s(first_s)).filter(|plans| plans.same);
    let plans = if plans.is_some_and(|plans| plans.same) { plans } else { other().or(plans) };
    let same = plans.is_some_and(|plans| plans.same);
    let offset_s = plans.map_or(first_s, |plans| plans.offset_s);
    let partners = match (&a.schedule, &b.schedule) {
        (Some(a), Some(b)) if !same && a.same_task(b) => starts.partners_by_task(|t_s| b.at(a.phase(t_s))),
        _ => starts.partners(offset_s, same),
    };
    Match { offset_s, plans, partners }
}

/// Transitions of two runs, those of a joint in order of time.
struct Starts<'a> {
    a: &'a [Transition],
    b: &'a [Transition],
    /// For each joint the places of its transitions in both.
    joints: Vec<[Vec<usize>; 2]>,
}

impl<'a> Starts<'a> {
    fn new(a: &'a [Transition], b: &'a [Transition], joints: &[String]) -> Self {
        let of = |all: &[Transition], joint: &String| {
            let mut found: Vec<usize> = (0..all.len()).filter(|&i| all[i].joint == *joint).collect();
            found.sort_by(|&i, &j| all[i].planned_onset_s.total_cmp(&all[j].planned_onset_s));
            found
        };
        Self { a, b, joints: joints.iter().map(|joint| [of(a, joint), of(b, joint)]).collect() }
    }

    fn gap_s(&self, i: usize, j: usize) -> f64 {
        self.b[j].planned_onset_s - self.a[i].planned_onset_s
    }

    fn alike(&self, i: usize, j: usize) -> bool {
        self.a[i].direction == self.b[j].direction && self.a[i].kind == self.b[j].kind
    }

    /// Between the first planned onsets of the two runs, s.
    fn first_offset_s(&self) -> Option<f64> {
        let first = |all: &[Transition], side: usize| {
            let firsts = self.joints.iter().filter_map(|joint| joint[side].first());
            firsts.map(|&i| all[i].planned_onset_s).min_by(f64::total_cmp)
        };
        Some(first(self.b, 1)? - first(self.a, 0)?)
    }

    /// The offset at which most onsets meet, `first_s` if no other does better.
    fn best_offset_s(&self, first_s: f64) -> f64 {
        let count = |offset_s: f64| {
            self.joints
                .iter()
                .map(|joint| self.by_clock(joint, offset_s).iter().flatten().count())
                .sum::<usize>()
        };
        let mut best = (count(first_s), first_s);
        for [a, b] in &self.joints {
            let heads = a.iter().take(MOST_MISSING).filter_map(|&i| b.first().map(|&j| (i, j)));
            let tails = b.iter().take(MOST_MISSING).filter_map(|&j| a.first().map(|&i| (i, j)));
            for (i, j) in heads.chain(tails).filter(|&(i, j)| self.alike(i, j)) {
                let offset_s = self.gap_s(i, j);
                let met = count(offset_s);
                if met > best.0 {
                    best = (met, offset_s);
                }
            }
        }
        self.refined_s(best.1)
    }

    /// The same, from all onsets that meet at it.
    fn refined_s(&self, offset_s: f64) -> f64 {
        let gaps_s: Vec<f64> = self
            .joints
            .iter()
            .flat_map(|joint| {
                let partners = self.by_clock(joint, offset_s);
                let met = joint[0].iter().zip(partners);
                met.filter_map(|(&i, j)| Some(self.gap_s(i, j?))).collect::<Vec<_>>()
            })
            .collect();
        if gaps_s.is_empty() { offset_s } else { median(gaps_s) }
    }

    /// For each transition of a joint in the first run the one of the other that is nearest in time, and to
    /// which it is nearest.
    fn by_clock(&self, joint: &[Vec<usize>; 2], offset_s: f64) -> Vec<Option<usize>> {
        self.nearest(joint, |t_s| t_s + offset_s, SAME_ONSET_S)
    }

    /// The same on any clock that takes times of the first run, in order, to times of the other.
    fn nearest(
        &self,
        [a, b]: &[Vec<usize>; 2],
        clock: impl Fn(f64) -> f64,
        reach_s: f64,
    ) -> Vec<Option<usize>> {
        let from_s: Vec<f64> = a.iter().map(|&i| clock(self.a[i].planned_onset_s)).collect();
        let to_s: Vec<f64> = b.iter().map(|&j| self.b[j].planned_onset_s).collect();
        let around = |of: &[f64], at_s: f64| {
            of.partition_point(|t| *t < at_s - reach_s)..of.partition_point(|t| *t <= at_s + reach_s)
        };
        let off_s = |k: usize, l: usize| (to_s[l] - from_s[k]).abs();
        (0..a.len())
            .map(|k| {
                let l = around(&to_s, from_s[k])
                    .filter(|&l| self.alike(a[k], b[l]))
                    .min_by(|&l, &m| off_s(k, l).total_cmp(&off_s(k, m)))?;
                let back = around(&from_s, to_s[l])
                    .filter(|&m| self.alike(a[m], b[l]))
                    .min_by(|&m, &n| off_s(m, l).total_cmp(&off_s(n, l)));
                (back == Some(k)).then(|| b[l])
            })
            .collect()
    }

    /// What happens between the same key points, whatever the times.
    fn partners_by_task(&self, clock: impl Fn(f64) -> f64) -> Vec<Option<(usize, PairedBy)>> {
        let mut partners = vec![None; self.a.len()];
        for joint in &self.joints {
            for (&i, j) in joint[0].iter().zip(self.nearest(joint, &clock, SAME_MOTION_S)) {
                partners[i] = j.map(|j| (j, PairedBy::Task));
            }
        }
        partners
    }

    /// The same starts in the same order.
    fn equal_order(&self, [a, b]: &[Vec<usize>; 2]) -> bool {
        a.len() == b.len() && a.iter().zip(b).all(|(&i, &j)| self.alike(i, j))
    }

    fn partners(&self, offset_s: f64, same_plan: bool) -> Vec<Option<(usize, PairedBy)>> {
        let mut partners = vec![None; self.a.len()];
        let clocks: Vec<_> = self.joints.iter().map(|joint| self.by_clock(joint, offset_s)).collect();
        let met = clocks.iter().flatten().flatten().count() as f64;
        let rhythm = met >= SAME_RHYTHM * self.a.len().min(self.b.len()) as f64;
        for (joint, clock) in self.joints.iter().zip(clocks) {
            let all = joint[0].len() == joint[1].len() && clock.iter().all(Option::is_some);
            let ordered = self.equal_order(joint);
            if all || same_plan || (rhythm && !ordered) {
                for (&i, j) in joint[0].iter().zip(clock) {
                    partners[i] = j.map(|j| (j, PairedBy::Clock));
                }
            } else if ordered {
                for (&i, &j) in joint[0].iter().zip(&joint[1]) {
                    partners[i] = Some((j, PairedBy::Order));
                }
            }
        }
        partners
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn start(direction: i8, at_s: f64) -> Transition {
        Transition { joint: "a".into(), direction, planned_onset_s: at_s, ..Transition::default() }
    }

    fn partners(a: &[Transition], b: &[Transition], offset_s: f64, same: bool) -> Vec<Option<usize>> {
        let starts = Starts::new(a, b, &["a".to_owned()]);
        starts.partners(offset_s, same).into_iter().map(|partner| partner.map(|(j, _)| j)).collect()
    }

    fn task() -> Vec<Transition> {
        vec![start(1, 2.0), start(-1, 10.0), start(1, 21.0), start(-1, 30.0)]
    }

    #[test]
    fn a_run_without_its_beginning_is_laid_on_the_rest() {
        let late: Vec<Transition> =
            task().into_iter().skip(1).map(|t| start(t.direction, t.planned_onset_s - 7.0)).collect();
        let task = task();
        let starts = Starts::new(&task, &late, &["a".to_owned()]);
        let offset_s = starts.best_offset_s(starts.first_offset_s().unwrap());
        assert!((offset_s + 7.0).abs() < 1e-9, "{offset_s}");
        assert_eq!(partners(&task, &late, offset_s, true), [None, Some(0), Some(1), Some(2)]);
    }

    #[test]
    fn another_rhythm_pairs_by_order_where_directions_agree_and_guesses_nothing_elsewhere() {
        let slow: Vec<Transition> =
            task().into_iter().map(|t| start(t.direction, 1.5 * t.planned_onset_s)).collect();
        assert_eq!(partners(&task(), &slow, 1.0, false), [Some(0), Some(1), Some(2), Some(3)]);
        assert_eq!(partners(&task(), &slow[..3], 1.0, false), [None; 4]);
        let mut other_way = slow;
        other_way[2] = start(-1, other_way[2].planned_onset_s);
        assert_eq!(partners(&task(), &other_way, 1.0, false), [None; 4]);
    }

    #[test]
    fn another_timing_of_the_same_task_pairs_by_its_key_points_even_where_a_start_is_gone() {
        // Twice as slow between 2 and 21 s, and without the start at 10 s.
        let slow = [start(1, 2.0), start(1, 40.0), start(-1, 49.5)];
        let task = task();
        let starts = Starts::new(&task, &slow, &["a".to_owned()]);
        let clock = |t_s: f64| if t_s < 21.0 { 2.0 + 2.0 * (t_s - 2.0) } else { t_s + 19.0 };
        let found: Vec<_> = starts.partners_by_task(clock).into_iter().map(|p| p.map(|(j, _)| j)).collect();
        assert_eq!(found, [Some(0), None, Some(1), Some(2)]);
    }

    #[test]
    fn a_start_pairs_with_the_nearest_one_and_that_one_with_it() {
        let a = [start(1, 2.0), start(1, 2.25)];
        assert_eq!(partners(&a, &[start(1, 2.2)], 0.0, true), [None, Some(0)]);
        assert_eq!(partners(&a, &[start(-1, 2.0), start(1, 2.6)], 0.0, true), [None, None]);
    }
}
