//! Whether a limit shows: a limit that the joint never reached must not be reported as a number.

use super::{
    estimate::{Estimate, Problem, Workspace},
    interval::{QUANTILE, discrepancy::LIMIT},
    kept::kept_rad_s,
    parameters::{LIMITS, Priors, SHARED},
    robust::{cost, inefficiency},
};

/// 95 % quantile of a chi-squared variable with one degree of freedom.
const THRESHOLD: f64 = 3.84;

/// A joint shows a limit only if it was asked for this many times as much: a model of another form
/// than the machine's may gain by clipping anywhere.
pub(super) const ASKED: f64 = 1.3;

/// Fastest growing and shrinking of the angle, as the model has it.
fn fastest(problem: &Problem, x: &[f64], workspace: &mut Workspace) -> [f64; 2] {
    let model = problem.model(x);
    let runs = problem.runs.iter().zip(x.iter().skip(SHARED));
    runs.fold([0.0; 2], |[up, down], (run, integral)| {
        workspace.simulate(&model, run, Priors::integral_rad_s(*integral));
        let [faster, slower] = workspace.fastest();
        [up.max(faster), down.max(slower)]
    })
}

/// A model that goes as fast as this share of what was reached explains it.
const EXPLAINS: f64 = 0.98;

/// The least that each limit may be: what was reached, and of a joint that swings beyond the speed that its valve leaves, as its model
/// does, that speed.
pub(super) fn least_limits(
    problem: &Problem,
    x: &[f64],
    reached: [f64; 4],
    workspace: &mut Workspace,
) -> [f64; 4] {
    let mut least = reached;
    if problem.shown.between.swing {
        let limits = least.iter_mut().zip(fastest(problem, x, workspace)).enumerate();
        for (i, (least, _)) in limits.filter(|(_, (least, model))| *model >= EXPLAINS * **least) {
            *least = least.min(problem.priors.of(LIMITS + i).value(x[LIMITS + i]));
        }
    }
    least
}

/// A speed is a limit if the joint kept this share of it over the time that it takes to that speed and from it, on average: one that
/// only accelerates and brakes as hard as it can keeps three quarters of its highest.
const KEPT: f64 = 0.94;
/// What a limit gains, as [`THRESHOLD`] is meant, that the model keeps it all the same, though it is not told.
const SURELY: f64 = 100.0;
/// Shortest and longest time over which that is asked, s.
const KEPT_OVER_S: [f64; 2] = [0.2, 2.0];

/// How much of each limit was asked for: what was sent, or less where the loop makes less of that.
fn asked(problem: &Problem, x: &[f64], workspace: &mut Workspace) -> [f64; 4] {
    let mut free = problem.clone();
    free.shown.limits = [false; 4];
    let unlimited = fastest(&free, x, workspace);
    std::array::from_fn(|limit| {
        let sent = problem.runs.iter().map(|run| run.asked[limit]).fold(0.0, f64::max);
        unlimited.get(limit).map_or(sent, |speed| sent.min(*speed))
    })
}

/// A joint that was asked for less than [`ASKED`] shows its speed limit only by keeping this share of it for so long, s.
const FLAT: f64 = 0.97;
const FLAT_S: f64 = 0.5;

/// Which of the speed limits of a model, growing and shrinking, are told as numbers.
pub(super) fn told(problem: &Problem, x: &[f64], workspace: &mut Workspace) -> [bool; 2] {
    let (kept, asked) = (sustained(problem, x, problem.shown.limits), asked(problem, x, workspace));
    [(0, 1.0), (1, -1.0)].map(|(limit, way)| {
        let value = problem.priors.of(LIMITS + limit).value(x[LIMITS + limit]);
        let flat = || kept_rad_s(problem.runs, way, FLAT_S, 2) >= FLAT * value;
        kept[limit] && (asked[limit] > ASKED * value || flat())
    })
}

/// Share of the squared tracking error that a fit leaves, from which on speed limits are tried that were hardly asked for.
const MISSED: f64 = 0.02;
/// The same of a joint that was asked for so many times its largest speed.
const MISSED_SHORT: f64 = 5e-4;
const SHORT: f64 = 1.05;

/// The problem with speed limits, and what fits it of descents from these places at what was `reached`, where much is left without them
/// and they gain surely: a joint that is asked for little more than it can do is at its limit while it catches up.
pub(super) fn clipped<'a>(
    problem: &Problem<'a>,
    found: &Estimate,
    reached: [f64; 4],
    from: impl IntoIterator<Item = Vec<f64>>,
    workspace: &mut Workspace,
) -> Option<(Problem<'a>, Estimate)> {
    let asked = |way: usize| problem.runs.iter().map(|run| run.asked[way]).fold(0.0, f64::max);
    let short = [0, 1].into_iter().any(|way| asked(way) > SHORT * reached[way]);
    let missed = if short { MISSED_SHORT } else { MISSED };
    if problem.shown.limits[..2] == [true; 2] || problem.leaves(&found.x, workspace) <= missed {
        return None;
    }
    let mut with = problem.clone();
    with.shown.limits[..2].fill(true);
    let at_reached = |mut x: Vec<f64>| {
        for limit in [LIMITS, LIMITS + 1] {
            x[limit] = problem.priors.of(limit).place(reached[limit - LIMITS]).max(-1.0);
        }
        x
    };
    let other = with.search(from.into_iter().map(at_reached), workspace);
    let cost = problem.cost_at(&found.x, found.scale_rad, workspace);
    let gain = cost - with.cost_at(&other.x, found.scale_rad, workspace);
    (2.0 * gain > SURELY).then_some((with, other))
}

/// Whether the joint kept its speed limits, growing and shrinking, for more than a moment between accelerations that are limited, as
/// `shown` says; without such accelerations that is not asked.
pub(super) fn sustained(problem: &Problem, x: &[f64], shown: [bool; 4]) -> [bool; 2] {
    let value = |limit: usize| problem.priors.of(LIMITS + limit).value(x[LIMITS + limit]);
    let rates: Vec<f64> = [2, 3].into_iter().filter(|limit| shown[*limit]).map(value).collect();
    if rates.is_empty() {
        return [true; 2];
    }
    let rate_s = rates.iter().map(|rate| rate.recip()).sum::<f64>() / rates.len() as f64;
    [(0, 1.0), (1, -1.0)].map(|(limit, way)| {
        let speed_rad_s = value(limit);
        let over_s = (speed_rad_s * rate_s).clamp(KEPT_OVER_S[0], KEPT_OVER_S[1]);
        kept_rad_s(problem.runs, way, over_s, 1) >= KEPT * speed_rad_s
    })
}

/// Which of the limits the data show.
///
/// The cost without a limit must exceed the cost with it by more than chance; both are divided by the statistical
/// inefficiency, and the cost without comes from a fit of its own. A limit whose interval ends below what was
/// `reached` is none.
pub(super) fn seen(
    problem: &Problem,
    found: &Estimate,
    reached: [f64; 4],
    workspace: &mut Workspace,
) -> [bool; 4] {
    let mut residuals = Vec::new();
    let data = |residuals: &[f64]| residuals.iter().map(|r| cost(r / found.scale_rad)).sum::<f64>();
    problem.residuals(&found.x, workspace, &mut residuals);
    let (with, kappa) = (data(&residuals), inefficiency(&residuals));
    let asked = asked(problem, &found.x, workspace);
    let (mut seen, mut gains) = (problem.shown.limits, [0.0; 4]);
    for limit in (0..problem.shown.limits.len()).filter(|&limit| problem.shown.limits[limit]) {
        let mut without = problem.clone();
        without.shown.limits[limit] = false;
        without.residuals(&found.x, workspace, &mut residuals);
        gains[limit] = 2.0 * (data(&residuals) - with) / kappa;
        if gains[limit] > THRESHOLD {
            let refitted = without.descend(found.x.clone(), 10, workspace);
            without.residuals(&refitted.x, workspace, &mut residuals);
            gains[limit] = 2.0 * (data(&residuals) - with) / kappa;
        }
        let shows = gains[limit] > THRESHOLD;
        let value = problem.priors.of(LIMITS + limit).value(found.x[LIMITS + limit]);
        let highest = value * (QUANTILE * LIMIT[limit]).exp();
        let enough = asked[limit] > ASKED * value || limit < 2 && gains[limit] > SURELY;
        seen[limit] &= shows && enough && highest >= reached[limit];
    }
    for (limit, kept) in sustained(problem, &found.x, seen).into_iter().enumerate() {
        seen[limit] &= kept || gains[limit] > SURELY;
    }
    seen
}
