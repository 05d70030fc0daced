//! What came of what was sent, joint by joint.

use std::ops::Range;

use super::{
    super::{
        model::{Model, STEP_S, steps_in},
        run::sampled,
        zero::{moves, rests, shift_rad},
    },
    Trial,
};

/// Where nothing was measured while the plan moves, an error fades within this, s: what nobody saw teaches nothing.
const FADES_S: f64 = 0.3;

/// A plan that stays this close to where it was last measured rests, rad.
const RESTS_RAD: f64 = 1e-3;

/// What a joint does so long after its plan belongs to the run, s.
pub const AFTER_S: f64 = 4.0;

/// What was sent to one joint and what came of it, every [`STEP_S`].
#[derive(Default)]
pub(super) struct Answer {
    /// Which of all runs it is.
    pub(super) of_run: usize,
    pub(super) sent: Vec<(f64, f64)>,
    /// Made up where nothing was measured.
    pub(super) measured_rad: Vec<f64>,
    /// By how much the measurement was shifted, rad; zero if it was not.
    pub(super) shifted_rad: f64,
    /// Whether anything was, and may be learnt from.
    pub(super) seen: Vec<bool>,
    /// For how long the plan moves and nothing was measured, s.
    pub(super) unseen_s: f64,
    /// What the joint is off by after the plan, as far as it was measured and for four seconds at most, rad.
    pub(super) after_rad: Vec<f64>,
}

impl Answer {
    /// What came of a run of a plan.
    pub(super) fn of(
        of_run: usize,
        trial: &Trial,
        name: &str,
        from_s: f64,
        planned: &[(f64, f64)],
    ) -> Option<Self> {
        let at_s = |k: usize| from_s + k as f64 * STEP_S;
        let (sent, measured) = (trial.sent.track(name)?, trial.measured.track(name)?);
        let steps = planned.len();
        let mut made = Self {
            of_run,
            sent: sampled(sent, from_s, steps),
            measured_rad: (0..steps).map(|k| measured.held_at(at_s(k)).position).collect(),
            seen: (0..steps).map(|k| measured.at(at_s(k)).is_some()).collect(),
            ..Self::default()
        };
        made.shift(planned);
        made.unseen_s = made.unseen_s(planned);
        made.fill(planned);
        let end_rad = planned.last().map_or(0.0, |planned| planned.0) + made.shifted_rad;
        let after = (steps..steps + steps_in(AFTER_S)).map_while(|k| measured.at(at_s(k)));
        made.after_rad = after.map(|state| end_rad - state.position).collect();
        Some(made)
    }

    fn shift(&mut self, planned: &[(f64, f64)]) {
        let off_rad = |k: usize| self.seen[k].then(|| self.measured_rad[k] - planned[k].0);
        self.shifted_rad = shift_rad(planned, off_rad);
    }

    /// Planned less measured angles, rad; by the zero that the joint was measured from.
    pub(super) fn error_rad(&self, planned: &[(f64, f64)]) -> Vec<f64> {
        let error = |(planned, measured): (&(f64, f64), &f64)| planned.0 + self.shifted_rad - measured;
        planned.iter().zip(&self.measured_rad).map(error).collect()
    }

    /// The same, and what came after the plan.
    pub(super) fn whole_rad(&self, planned: &[(f64, f64)]) -> Vec<f64> {
        let mut whole_rad = self.error_rad(planned);
        whole_rad.extend_from_slice(&self.after_rad);
        whole_rad
    }

    /// Where nothing was measured, the error is that before and after it: as long as the plan rests, and fading from where
    /// it moves.
    pub(super) fn fill(&mut self, planned: &[(f64, f64)]) {
        let error_rad = self.error_rad(planned);
        let n = error_rad.len();
        let mut from = 0;
        while let Some(first) = (from..n).find(|&k| !self.seen[k]) {
            let end = (first..n).find(|&k| self.seen[k]).unwrap_or(n);
            let mut sums = vec![[0.0; 2]; end - first];
            let mut add = |from: usize, order: &mut dyn Iterator<Item = usize>| {
                for (k, share) in shares(planned, from, order) {
                    sums[k - first][0] += share;
                    sums[k - first][1] += share * error_rad[from];
                }
            };
            if let Some(before) = first.checked_sub(1) {
                add(before, &mut (first..end));
            }
            if end < n {
                add(end, &mut (first..end).rev());
            }
            for (k, [share, sum_rad]) in (first..end).zip(sums) {
                self.measured_rad[k] = planned[k].0 + self.shifted_rad - sum_rad / f64::max(share, 1.0);
            }
            from = end;
        }
    }

    /// Offset of the model where the measurement was shifted: that is no error then.
    pub(super) fn offset_rad(&self, model: &Model) -> f64 {
        if self.shifted_rad == 0.0 { 0.0 } else { model.offset_rad }
    }

    fn unseen_s(&self, planned: &[(f64, f64)]) -> f64 {
        let unseen = (0..planned.len()).filter(|&k| !self.seen[k] && moves(planned, k));
        unseen.count() as f64 * STEP_S
    }

    pub(super) fn correction_rad(&self, planned: &[(f64, f64)]) -> Vec<f64> {
        planned.iter().zip(&self.sent).map(|(planned, sent)| sent.0 - planned.0).collect()
    }
}

/// Motions of a plan, each from where it leaves rest to where the next one does.
pub(super) fn motions(planned: &[(f64, f64)]) -> impl Iterator<Item = Range<usize>> {
    let rests = rests(planned);
    let begins: Vec<usize> = rests.iter().map(|rest| rest.end).filter(|end| *end < planned.len()).collect();
    let ends: Vec<usize> = begins.iter().skip(1).copied().chain([planned.len()]).collect();
    begins.into_iter().zip(ends).map(|(begins, ends)| begins..ends)
}

/// What of the error at instant `from` is left at others, in their order away from it.
fn shares<'a>(
    planned: &'a [(f64, f64)],
    from: usize,
    order: &'a mut dyn Iterator<Item = usize>,
) -> impl Iterator<Item = (usize, f64)> + 'a {
    let mut share = 1.0_f64;
    order.map(move |k| {
        let rests = (planned[k].0 - planned[from].0).abs() < RESTS_RAD && share >= 1.0;
        share = if rests { 1.0 } else { (share - STEP_S / FADES_S).max(0.0) };
        (k, share)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plan that rests, moves and rests; 0.1 rad of error wherever it was measured.
    #[test]
    fn what_was_not_measured_is_no_error_but_at_rest() {
        let n = 2000;
        let plan = |k: usize| ((k as f64 * STEP_S - 1.0) / 2.0).clamp(0.0, 1.0);
        let planned: Vec<(f64, f64)> = (0..n).map(|k| (plan(k), 0.0)).collect();
        let at = |s: f64| (0..n).find(|&k| k as f64 * STEP_S >= s).unwrap_or(n - 1);
        let errors = |seen: &dyn Fn(usize) -> bool| {
            let mut last = 0.0;
            let measured_rad = (0..n).map(|k| {
                last = if seen(k) { plan(k) - 0.1 } else { last };
                last
            });
            let measured_rad = measured_rad.collect();
            let seen = (0..n).map(seen).collect();
            let mut answer = Answer { measured_rad, seen, ..Answer::default() };
            answer.fill(&planned);
            (answer.error_rad(&planned), answer.unseen_s(&planned))
        };
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
        let (whole, unseen_s) = errors(&|_| true);
        assert!(whole.iter().all(|e| near(*e, 0.1)) && unseen_s == 0.0);
        // A hole of a second within the motion: half a second of nothing, no step larger than the fading.
        let (hole, unseen_s) = errors(&|k| !(at(1.5)..at(2.5)).contains(&k));
        assert!(near(hole[at(2.0)], 0.0) && near(hole[at(1.4)], 0.1) && (unseen_s - 1.0).abs() < 0.05);
        assert!(hole.iter().all(|e| (-1e-12..0.1 + 1e-12).contains(e)));
        assert!(hole.windows(2).all(|two| (two[1] - two[0]).abs() < 0.11 * STEP_S / FADES_S + 1e-9));
        // A log that ends in the motion, and one that ends at rest.
        let (cut, _) = errors(&|k| k < at(2.0));
        assert!(near(cut[at(2.4)], 0.0) && near(cut[n - 1], 0.0));
        let (rest, unseen_s) = errors(&|k| k < at(3.5));
        assert!(rest.iter().all(|e| near(*e, 0.1)) && unseen_s == 0.0);
    }

    /// A joint that is off by `before` at first and by `after` at last, linear in between.
    #[test]
    fn what_a_joint_is_off_by_at_both_rests_is_its_zero() {
        let n = 800;
        let plan = |k: usize| ((k as f64 * STEP_S - 2.0) / 2.0).clamp(0.0, 1.0);
        let planned: Vec<(f64, f64)> = (0..n).map(|k| (plan(k), 0.0)).collect();
        let shifted = |before: f64, after: f64, seen: &dyn Fn(usize) -> bool| {
            let measured_rad = (0..n).map(|k| plan(k) + before + plan(k) * (after - before)).collect();
            let seen = (0..n).map(seen).collect();
            let mut answer = Answer { measured_rad, seen, ..Answer::default() };
            answer.shift(&planned);
            (answer.shifted_rad, answer.error_rad(&planned)[n / 2])
        };
        let (by, left) = shifted(0.035, 0.035, &|_| true);
        assert!((by - 0.035).abs() < 1e-9 && left.abs() < 1e-9);
        for (before, after) in [(0.035, 0.0), (0.0, 0.035), (0.035, -0.035), (0.02, 0.035), (0.015, 0.015)] {
            assert!(shifted(before, after, &|_| true).0.abs() < 1e-12, "{before} {after}");
        }
        assert!(shifted(0.035, 0.035, &|k| k > 250).0.abs() < 1e-12, "not seen at rest");
    }

    #[test]
    fn a_small_zero_is_told_from_a_dead_band_by_rests_that_are_reached_from_both_sides() {
        let n = 2000;
        let moved = |t_s: f64, from_s: f64| ((t_s - from_s) / 2.0).clamp(0.0, 1.0);
        let plan = |k: usize, down: f64| {
            let t_s = k as f64 * STEP_S;
            moved(t_s, 2.0) - down * moved(t_s, 7.0) + 0.5 * moved(t_s, 13.0)
        };
        let shifted = |down: f64, off_rad: [f64; 4]| {
            let planned: Vec<(f64, f64)> = (0..n).map(|k| (plan(k, down), 0.0)).collect();
            let at = |k: usize| off_rad[[3.0, 8.0, 14.0].iter().filter(|t| k as f64 * STEP_S > **t).count()];
            let measured_rad = (0..n).map(|k| plan(k, down) + at(k)).collect();
            let mut answer = Answer { measured_rad, seen: vec![true; n], ..Answer::default() };
            answer.shift(&planned);
            answer.shifted_rad
        };
        assert!((shifted(0.7, [0.01, 0.008, 0.012, 0.01]) - 0.01).abs() < 1e-9);
        assert!(shifted(-0.7, [0.01, 0.008, 0.012, 0.01]).abs() < 1e-12, "all from one side");
        assert!(shifted(0.7, [0.01, -0.01, 0.01, -0.01]).abs() < 1e-12, "a dead band");
        assert!(shifted(0.7, [0.004; 4]).abs() < 1e-12, "little");
    }
}
