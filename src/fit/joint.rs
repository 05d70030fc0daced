//! One joint from its runs to what is known of it.

use super::{
    censor::{ASKED, seen},
    estimate::{Estimate, Part, Problem, Workspace},
    interval::{Knowledge, discrepancy},
    outcome::{Estimated, JointFit},
    parameters::{ASYMMETRY, FEED_FORWARD, INTEGRAL_GAIN, LIMITS, POSITION_GAIN, Priors, SHARED},
    run::Run,
    skill::{HeldOutStart, Skill, skill, unexplained_rad},
};
use crate::{math::range, units::DEGREE_RAD};

/// Dead times to start from, s.
const DEAD_TIMES_S: [f64; 3] = [0.08, 0.2, 0.35];

/// A limit is looked for from this far above what was reached.
const ABOVE: [f64; 4] = [1.03, 1.03, 1.2, 1.2];

/// Limits are looked for from no lower than this: rad/s and rad/s².
const LOWEST: [f64; 4] = [DEGREE_RAD, DEGREE_RAD, 20.0 * DEGREE_RAD, 20.0 * DEGREE_RAD];

/// Statistical inefficiency until it is measured: correlated residuals per effective sample.
const INEFFICIENCY: f64 = 50.0;

/// Fits one joint, whose runs are not empty; with its held-out starts.
pub(super) fn joint(name: &str, runs: &[Run]) -> (JointFit, Vec<HeldOutStart>) {
    let most = |of: fn(&Run) -> f64| runs.iter().map(of).fold(0.0, f64::max);
    let reached = [
        most(|run| run.fastest_rad_s[0]),
        most(|run| run.fastest_rad_s[1]),
        most(|run| run.sharpest_rad_s2[0]),
        most(|run| run.sharpest_rad_s2[1]),
    ];
    let limits = [0, 1, 2, 3].map(|i| (ABOVE[i] * reached[i]).max(LOWEST[i]));
    let pose_rad = range(runs.iter().flat_map(|run| run.sent.iter().map(|sent| sent.0)));
    let priors = Priors::new(limits, pose_rad);
    let mut problem = Problem {
        runs,
        priors: &priors,
        seen: asked_for(runs, limits),
        part: Part::All,
        inefficiency: INEFFICIENCY,
    };
    let mut workspace = Workspace::default();
    let mut found = problem.search(&DEAD_TIMES_S, &vec![0.0; SHARED + runs.len()], &mut workspace);
    // What goes may have stood in for what stays.
    for _ in 0..2 {
        problem.inefficiency = problem.measured_inefficiency(&found.x, &mut workspace);
        let seen = seen(&problem, &found, &mut workspace);
        if seen == problem.seen {
            break;
        }
        problem.seen = seen;
        found = problem.descend(found.x, 30, &mut workspace);
    }
    let knowledge = Knowledge::new(&problem, &found.x, found.scale_rad, &mut workspace);
    let model = problem.model(&found.x);
    let skill = skill(&problem, model.dead_time_s, &mut workspace);
    let samples = runs.iter().map(|run| run.samples.len()).sum();
    (report(name, &problem, &found, &knowledge, reached, samples, &skill), skill.starts)
}

/// Limits that were asked for far enough to show; looking for others costs time.
fn asked_for(runs: &[Run], limits: [f64; 4]) -> [bool; 4] {
    [0, 1, 2, 3].map(|i| runs.iter().any(|run| run.asked[i] > ASKED / ABOVE[i] * limits[i]))
}

fn report(
    name: &str,
    problem: &Problem,
    found: &Estimate,
    knowledge: &Knowledge,
    reached: [f64; 4],
    samples: usize,
    skill: &Skill,
) -> JointFit {
    let model = problem.model(&found.x);
    let one = |i: usize, value: f64, discrepancy: f64| {
        knowledge.positive(value, &[(i, problem.priors.of(i).deviation)], discrepancy)
    };
    let limit = |i: usize, discrepancy: f64| {
        let bound = Some(reached[i]);
        if problem.seen[i] {
            let value = problem.priors.of(LIMITS + i).value(found.x[LIMITS + i]);
            Estimated { lower_bound: bound, ..one(LIMITS + i, value, discrepancy) }
        } else {
            Estimated { lower_bound: bound, ..Estimated::default() }
        }
    };
    let position_gain = knowledge.missed(discrepancy::POSITION_GAIN, discrepancy::SMOOTH_POSITION_GAIN);
    let integral_gain = knowledge.missed(discrepancy::INTEGRAL_GAIN, discrepancy::SMOOTH_INTEGRAL_GAIN);
    let [dead_band_rad_s, dead_band_error_rad] = knowledge.dead_band(problem, &found.x);
    JointFit {
        name: name.to_owned(),
        runs: problem.runs.len(),
        samples,
        residual_rad: found.scale_rad,
        inefficiency: knowledge.inefficiency,
        held_out_r2: skill.held_out_r2,
        unexplained_peak_rad: unexplained_rad(&skill.starts),
        lag_s: knowledge.lag(problem, &found.x),
        dead_band_rad_s,
        dead_band_error_rad,
        position_gain_1_s: one(POSITION_GAIN, model.position_gain_1_s, position_gain),
        integral_gain_1_s2: one(INTEGRAL_GAIN, model.integral_gain_1_s2, integral_gain),
        feed_forward: one(FEED_FORWARD, model.feed_forward, discrepancy::GAIN),
        gain_ratio: one(ASYMMETRY, model.asymmetry.exp(), discrepancy::GAIN),
        speed_limit_growing_rad_s: limit(0, discrepancy::GROWING),
        speed_limit_shrinking_rad_s: limit(1, discrepancy::SHRINKING),
        acceleration_limit_growing_rad_s2: limit(2, discrepancy::ACCELERATION),
        acceleration_limit_shrinking_rad_s2: limit(3, discrepancy::ACCELERATION),
        valve_dead_band: None,
        model,
    }
}
