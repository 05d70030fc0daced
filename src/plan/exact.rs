//! Plans that keep their limits between the instants that a search looks at, too.
//!
//! Splines are judged exactly on the way; torques, rods, flow and tool by eight instants a piece, between which a
//! peak may hide. Where one breaks its limit the search goes on from there under a limit that is tighter by as much.

use super::{
    Evaluator, Limit, Margin, Setup, Timing,
    descend::{FINE, NEARLY, descend},
    front::thinned,
    goal::{Goal, Merit},
};
use crate::{
    task::{Ceilings, Objective},
    threads,
};

/// Descents under ever tighter limits that a plan is given, and slowings down.
const TRIES: usize = 8;
const SLOWINGS: usize = 4;
/// Evaluations of each descent.
const EVALUATIONS: u64 = 400;
/// Distance kept from a limit that was found broken, as a share of it.
const CLEAR: f64 = 1e-6;

impl Setup {
    /// Whether a timing keeps all limits at every instant.
    pub fn keeps(&self, interval_s: &[f64], evaluator: &mut Evaluator) -> bool {
        self.exact(interval_s, evaluator).is_some_and(|margins| keeps(&margins))
    }

    fn exact(&self, interval_s: &[f64], evaluator: &mut Evaluator) -> Option<Vec<Margin>> {
        let motion = self.motion(&self.times_s(interval_s)).ok()?;
        Some(self.margins(&motion, evaluator))
    }

    /// The same with tighter limits where a plan breaks one by more than its evaluation shows.
    fn tightened(&self, interval_s: &[f64], margins: &[Margin], evaluator: &mut Evaluator) -> Self {
        let mut tight = self.clone();
        if evaluator.evaluate(self, interval_s).is_none() {
            return tight;
        }
        let width = Limit::OF_JOINT.len();
        for margin in margins.iter().filter(|margin| margin.broken()) {
            let place = |limits: &[Limit]| limits.iter().position(|limit| *limit == margin.limit);
            let row = match margin.joint {
                Some(joint) => place(&Limit::OF_JOINT).map(|k| joint * width + k),
                None => place(&Limit::OF_ARM).map(|k| self.joint_count() * width + k),
            };
            let Some(row) = row else { continue };
            let seen = evaluator.shares[row];
            if seen > 0.0 && seen < margin.share {
                tight.slack[row] *= margin.share / seen * (1.0 + CLEAR);
            }
        }
        tight
    }
}

fn keeps(margins: &[Margin]) -> bool {
    !margins.iter().any(Margin::broken)
}

/// Times that a plan is quickened, each by up to a tenth.
const QUICKENED: usize = 40;

/// The same motion in the least time that keeps its limits and a condition; `None` where that gains next to nothing.
pub(super) fn quickest(
    setup: &Setup,
    timing: Option<&Timing>,
    keeps: impl Fn(&Timing) -> bool,
) -> Option<Timing> {
    let quicker = std::iter::successors(quickened(setup, timing?), |quicker| quickened(setup, quicker));
    quicker.take(QUICKENED).take_while(keeps).last()
}

/// The same motion in less time, as far as it keeps its limits; `None` where that gains next to nothing.
pub(super) fn quickened(setup: &Setup, timing: &Timing) -> Option<Timing> {
    const HALVINGS: usize = 12;
    let mut evaluator = Evaluator::new(setup);
    let scaled = |by: f64| -> Option<Vec<f64>> {
        let scaled: Vec<f64> = timing.interval_s.iter().map(|s| s * by).collect();
        setup.has(&scaled).then_some(scaled)
    };
    let (mut broken, mut kept) = (0.9, 1.0);
    let keeps = |by: f64, evaluator: &mut Evaluator| {
        scaled(by).is_some_and(|interval_s| setup.keeps(&interval_s, evaluator))
    };
    if keeps(broken, &mut evaluator) {
        kept = broken;
    }
    for _ in 0..HALVINGS {
        if kept <= broken {
            break;
        }
        let middle = 0.5 * (broken + kept);
        if keeps(middle, &mut evaluator) {
            kept = middle;
        } else {
            broken = middle;
        }
    }
    let interval_s = scaled(kept).filter(|_| kept < 1.0 - 1e-4)?;
    evaluated(setup, &mut evaluator, interval_s).filter(|timing| timing.violation <= 0.0)
}

/// The plan if it keeps its limits, else the best by `merit` near it that does, with the evaluations it took.
/// `None` if none was found.
pub(super) fn kept(
    setup: &Setup,
    timing: &Timing,
    merit: Merit,
    ceilings: Ceilings,
) -> (Option<Timing>, u64) {
    let mut evaluator = Evaluator::new(setup);
    let mut tight = setup.clone();
    let (mut here, mut used) = (timing.interval_s.clone(), 0);
    for _ in 0..TRIES {
        let Some(margins) = setup.exact(&here, &mut evaluator) else { return (None, used) };
        if keeps(&margins) {
            return (evaluated(setup, &mut evaluator, here), used);
        }
        tight = tight.tightened(&here, &margins, &mut evaluator);
        let goal = Goal { merit, ceilings, evaluations: EVALUATIONS, trust: NEARLY, enough: FINE };
        let end = descend(&tight, &mut evaluator, &slowed(&here, &margins), &goal);
        used += end.evaluations;
        let Some(end) = end.timing else { return (None, used) };
        here = end.interval_s;
    }
    (slow(setup, &mut evaluator, &timing.interval_s), used)
}

/// The front without plans that break a limit somewhere: slowed down until they keep it, the fastest the best
/// near it, and those left out that others are then better than. With the evaluations it took.
pub(super) fn kept_front(setup: &Setup, front: &[Timing], most: usize) -> (Vec<Timing>, u64) {
    let checked: Vec<(Option<Timing>, bool)> = threads::mapped(
        front,
        || Evaluator::new(setup),
        |evaluator, timing| {
            if setup.keeps(&timing.interval_s, evaluator) {
                return (Some(timing.clone()), true);
            }
            (slow(setup, evaluator, &timing.interval_s), false)
        },
    );
    let sound = checked.iter().all(|(_, as_it_was)| *as_it_was);
    let mut slowed: Vec<Timing> = checked.into_iter().filter_map(|(timing, _)| timing).collect();
    if sound {
        return (slowed, 0);
    }
    // Slowing down all of it gave away time wherever the limit was kept, and a torque at rest is no less for it: the
    // plan before goes another way.
    let quicker = fastest_of(&slowed).map(|plan| Timing {
        interval_s: plan.interval_s.iter().map(|s| (s * QUICKER).max(setup.interval_s[0])).collect(),
        ..plan.clone()
    });
    let mut used = 0;
    for start in quicker.iter().chain(fastest_of(front)) {
        let (found, evaluations) = kept(setup, start, Merit::alone(Objective::Duration), Ceilings::NONE);
        used += evaluations;
        slowed.extend(found);
    }
    let mut front = thinned(setup, &slowed, most);
    front.sort_by(|a, b| a.objectives[Objective::Duration].total_cmp(&b.objectives[Objective::Duration]));
    (front, used)
}

fn fastest_of(front: &[Timing]) -> Option<&Timing> {
    front
        .iter()
        .min_by(|a, b| a.objectives[Objective::Duration].total_cmp(&b.objectives[Objective::Duration]))
}

/// Factor on the fastest plan's times before its last descent, so that it meets its limits again.
const QUICKER: f64 = 0.97;

/// The plan slowed down all along until it keeps its limits.
fn slow(setup: &Setup, evaluator: &mut Evaluator, interval_s: &[f64]) -> Option<Timing> {
    let mut here = interval_s.to_vec();
    for _ in 0..SLOWINGS {
        let margins = setup.exact(&here, evaluator)?;
        if keeps(&margins) {
            return evaluated(setup, evaluator, here);
        }
        here = slowed(&here, &margins);
        if !setup.has(&here) {
            return None;
        }
    }
    None
}

/// Longer by what the most broken limit is broken by: enough for speeds and flows, more than enough for jerk.
fn slowed(interval_s: &[f64], margins: &[Margin]) -> Vec<f64> {
    let worst = margins.iter().map(|margin| margin.share).fold(1.0, f64::max);
    let by = if worst > 1.0 { worst.min(2.0) * (1.0 + CLEAR) } else { 1.0 };
    interval_s.iter().map(|s| s * by).collect()
}

/// With its objectives.
pub(super) fn evaluated(setup: &Setup, evaluator: &mut Evaluator, interval_s: Vec<f64>) -> Option<Timing> {
    let objectives = evaluator.evaluate(setup, &interval_s)?;
    Some(Timing { interval_s, objectives, violation: evaluator.violation() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{arm::Arm, task::Task};

    #[test]
    fn a_plan_with_room_is_quickened_to_its_limit_and_one_without_is_left() {
        let task = Task::parse(include_str!("../../sample-logs/tasks/task-1.toml")).unwrap();
        let setup = Setup::new(&task, Arm::sample().unwrap()).unwrap();
        let mut evaluator = Evaluator::new(&setup);
        let slow = evaluated(&setup, &mut evaluator, vec![6.0; 5]).unwrap();
        let mut here = slow.clone();
        while let Some(quicker) = quickened(&setup, &here) {
            assert!(setup.keeps(&quicker.interval_s, &mut evaluator));
            here = quicker;
        }
        assert!(here.objectives[Objective::Duration] < slow.objectives[Objective::Duration]);
        let shorter: Vec<f64> = here.interval_s.iter().map(|s| s * 0.999).collect();
        assert!(!setup.keeps(&shorter, &mut evaluator));
    }
}
