//! One joint from its runs to what is known of it.

use super::{
    Character, Estimated, HeldOut, Oscillation,
    censor::{ASKED, clipped, least_limits, seen, told},
    edge::edge,
    estimate::{Estimate, Part, Problem, Workspace},
    feed_forward::FeedForward,
    interval::{Knowledge, discrepancy},
    model::Model,
    outcome::JointFit,
    parameters::{
        ASYMMETRY, Between, DEAD_TIME, INTEGRAL_GAIN, Integral, LIMITS, Priors, SHARED, Shown, Valve,
    },
    run::{Run, Sample},
    set_values::SetValues,
    skill::{HeldOutStart, Skill, skill, unexplained_rad},
    structure::structured,
    telling::{of, telling},
};
use crate::{
    math::{deviation, range},
    series::JointKind,
    units::DEGREE_RAD,
};

/// Dead times to start from, s.
const DEAD_TIMES_S: [f64; 3] = [0.08, 0.2, 0.35];

/// Share of the squared tracking error that a fit to several logs leaves, from which on what fits one of them is tried, too, for so many.
const WELL: f64 = 0.004;
const TRIED_LOGS: usize = 3;

/// A limit is looked for from this far above what was reached.
const ABOVE: [f64; 4] = [1.1, 1.1, 1.2, 1.2];

/// Limits are looked for from no lower than this: rad/s and rad/s².
const LOWEST: [f64; 4] = [DEGREE_RAD, DEGREE_RAD, 20.0 * DEGREE_RAD, 20.0 * DEGREE_RAD];

/// Motion that is enough to search in, s: of longer logs some runs are, and the rest counts in the last rounds.
const ENOUGH_S: f64 = 150.0;

/// The same for fits that leave a part out, s.
const ENOUGH_TO_HOLD_OUT_S: f64 = 450.0;

/// Slowest time constant of an integral that shows, s.
const SLOWEST_INTEGRAL_S: f64 = 20.0;

/// Rounds over all runs after a search in some.
const ROUNDS: usize = 4;

/// Rounds of the fits that leave a part out.
const FOLD_ROUNDS: usize = 3;

/// What is measured and what is sent correlate by less than this where a sign is wrong.
const AGAINST: f64 = -0.5;

/// A joint that moves by a smaller share of what it is sent stands.
const STANDS: f64 = 0.02;

/// Statistical inefficiency until it is measured: correlated residuals per effective sample.
const INEFFICIENCY: f64 = 50.0;

/// Fits one joint, whose runs are not empty; with the ratios of peaks at held-out starts, and what was held out.
pub(super) fn joint(named: (&str, JointKind), runs: &[Run]) -> (JointFit, Vec<f64>, Vec<HeldOut>) {
    let reached = [0, 1, 2, 3].map(|i| runs.iter().map(|run| run.reached[i]).fold(0.0, f64::max));
    let limits = [0, 1, 2, 3].map(|i| (ABOVE[i] * reached[i]).max(LOWEST[i]));
    let pose_rad = range(runs.iter().flat_map(|run| run.sent.iter().map(|sent| sent.0)));
    let priors = Priors::new(limits, pose_rad);
    let some = of(&telling(runs, ENOUGH_S), runs);
    let mut problem = Problem {
        runs: &some,
        priors: &priors,
        shown: Shown {
            limits: asked_for(runs, limits),
            valve: Valve::default(),
            late: false,
            between: Between::default(),
            integral: Integral::Free,
            feed_forward: true,
        },
        part: Part::All,
        inefficiency: INEFFICIENCY,
    };
    let mut workspace = Workspace::default();
    let mut found = problem.search(starts(&problem), &mut workspace);
    if problem.leaves(&found.x, &mut workspace) > WELL {
        let others = of_each_log(&problem, &mut workspace);
        if !others.is_empty() {
            found = problem.search(others.into_iter().chain([found.x]), &mut workspace);
        }
    }
    let from = starts(&problem).into_iter().chain([found.x.clone()]);
    if let Some(with) = clipped(&problem, &found, reached, from, &mut workspace) {
        (problem, found) = with;
    }
    // What goes may have stood in for what stays.
    for _ in 0..2 {
        problem.inefficiency = problem.measured_inefficiency(&found.x, &mut workspace);
        let seen = seen(&problem, &found, reached, &mut workspace);
        if seen == problem.shown.limits {
            break;
        }
        problem.shown.limits = seen;
        found = problem.descend(found.x, 30, &mut workspace);
    }
    let (plain, before) = (problem.clone(), found.clone());
    found = structured(&mut problem, found, &mut workspace);
    if problem.shown.valve.beyond
        && let SetValues::Late(late, shown, _) = SetValues::of(&plain, &before, &mut workspace)
    {
        // What opens beyond its speed may stand in for set values that come late.
        let mut other = Problem { shown, ..plain };
        let late = structured(&mut other, late, &mut workspace);
        let scale_rad = found.scale_rad;
        if other.cost_at(&late.x, scale_rad, &mut workspace)
            < problem.cost_at(&found.x, scale_rad, &mut workspace)
        {
            (problem, found) = (other, late);
        }
    }
    if let Some(edged) = edge(&problem, &found, &mut workspace) {
        problem.shown.valve.edge = true;
        found = edged;
    }
    let (mut found, rivals) = fed(&mut problem, found, &mut workspace);
    if some.len() < runs.len() {
        problem.runs = runs;
        found.x.truncate(SHARED);
        found.x.resize(SHARED + runs.len(), 0.0);
        found = problem.descend(found.x, ROUNDS, &mut workspace);
        problem.inefficiency = problem.measured_inefficiency(&found.x, &mut workspace);
    }
    let least = least_limits(&problem, &found.x, reached, &mut workspace);
    for i in (0..4).filter(|i| problem.shown.limits[*i]) {
        found.x[LIMITS + i] = found.x[LIMITS + i].max(priors.of(LIMITS + i).place(least[i]));
    }
    let mut knowledge = Knowledge::new(&problem, &found.x, found.scale_rad, &mut workspace);
    let place = telling(runs, ENOUGH_TO_HOLD_OUT_S);
    let held_out = of(&place, runs);
    let x: Vec<f64> = found.x[..SHARED].iter().copied().chain(of(&place, &found.x[SHARED..])).collect();
    let skill = skill(&Problem { runs: &held_out, ..problem.clone() }, &x, FOLD_ROUNDS, &mut workspace);
    let samples = runs.iter().map(|run| run.samples.len()).sum();
    let calm = Oscillation::is_little(problem.leaves(&found.x, &mut workspace)) || {
        let left_rad = problem.longest_left_rad(&found.x, &mut workspace);
        Oscillation::of(&left_rad).character == Character::Calm
    };
    knowledge.judge(calm, skill.held_out_r2, skill.unexplained_share(found.scale_rad));
    let nothing = skill.explains_nothing() || stands(runs) || goes_against(runs);
    let skill = if nothing { skill.without_model(&held_out) } else { skill };
    let told = told(&problem, &found.x, &mut workspace);
    let joint = report(named, &problem, &found, &knowledge, (least, told), samples, &skill);
    let joint = rivals.iter().fold(joint, JointFit::with_rival);
    let joint = if nothing { joint.without_model() } else { joint };
    let ratios = skill.starts.iter().flatten().filter_map(HeldOutStart::ratio).collect();
    let runs = held_out.iter().zip(&skill.errors).zip(&skill.starts);
    let stretches = runs.map(|((run, errors), starts)| HeldOut::of(named.0, run, errors, starts)).collect();
    (joint, ratios, stretches)
}

/// Whether speed is fed forward, and whether set values come late; with models that explain the data nearly as well.
fn fed(problem: &mut Problem, mut found: Estimate, workspace: &mut Workspace) -> (Estimate, Vec<Model>) {
    let mut rivals = Vec::new();
    if problem.shown.feed_forward {
        match FeedForward::of(problem, &found, workspace) {
            FeedForward::None(without) => {
                problem.shown.feed_forward = false;
                found = without;
            }
            FeedForward::MayBeNone(model) => rivals.push(*model),
            FeedForward::Some => {}
        }
    }
    if problem.shown.late {
        return (found, rivals);
    }
    match SetValues::of(problem, &found, workspace) {
        SetValues::Late(late, shown, prompt) => {
            let behind = Problem { shown, ..problem.clone() };
            // Behind a filter that makes up for it a feed-forward is none.
            match FeedForward::of(&behind, &late, workspace) {
                FeedForward::None(without) => {
                    problem.shown.feed_forward = false;
                    found = without;
                }
                may_be => {
                    problem.shown = shown;
                    found = late;
                    rivals = prompt;
                    if let FeedForward::MayBeNone(model) = may_be {
                        rivals.push(*model);
                    }
                }
            }
        }
        SetValues::MayBeLate(models) => rivals.extend(models),
        SetValues::Prompt => {}
    }
    (found, rivals)
}

/// Places to search from.
fn starts(problem: &Problem) -> [Vec<f64>; DEAD_TIMES_S.len()] {
    DEAD_TIMES_S.map(|dead_time_s| {
        let mut x = vec![0.0; SHARED + problem.runs.len()];
        x[DEAD_TIME] = problem.priors.of(DEAD_TIME).place(dead_time_s);
        x
    })
}

/// What fits the first of several logs alone.
fn of_each_log(problem: &Problem, workspace: &mut Workspace) -> Vec<Vec<f64>> {
    let mut logs: Vec<usize> = problem.runs.iter().map(|run| run.log).collect();
    logs.dedup();
    if logs.len() < 2 {
        return Vec::new();
    }
    let alone = |log: &usize| {
        let runs: Vec<Run> = problem.runs.iter().filter(|run| run.log == *log).cloned().collect();
        let own = Problem { runs: &runs, ..problem.clone() };
        let mut x = own.search(starts(&own), workspace).x;
        x.truncate(SHARED);
        x.resize(SHARED + problem.runs.len(), 0.0);
        x
    };
    logs.iter().take(TRIED_LOGS).map(alone).collect()
}

/// Whether the joint stands though it is sent elsewhere: what a model then predicts is the plan, not the joint.
fn stands(runs: &[Run]) -> bool {
    // By run, for a joint that stands elsewhere in the next one did not move in it either.
    let squares_rad2 = |of: &dyn Fn(&Run, &Sample) -> f64| -> f64 {
        let own =
            |run: &Run| deviation(&run.samples.iter().map(|sample| of(run, sample)).collect::<Vec<f64>>());
        runs.iter().map(|run| own(run).powi(2)).sum()
    };
    squares_rad2(&|_, sample| sample.measured_rad) < STANDS * STANDS * squares_rad2(&Run::sent_rad)
}

/// Whether the joint goes the other way than it is sent: a sign is wrong, and no lag.
fn goes_against(runs: &[Run]) -> bool {
    let mut sums = [0.0; 3];
    for run in runs {
        let count = run.samples.len().max(1) as f64;
        let both = || run.samples.iter().map(|sample| [run.sent_rad(sample), sample.measured_rad]);
        let means = [0, 1].map(|side| both().map(|pair| pair[side]).sum::<f64>() / count);
        for pair in both() {
            let [sent, came] = [pair[0] - means[0], pair[1] - means[1]];
            for (sum, product) in sums.iter_mut().zip([sent * came, sent * sent, came * came]) {
                *sum += product;
            }
        }
    }
    sums[0] < AGAINST * (sums[1] * sums[2]).sqrt()
}

/// Limits that were asked for far enough to show; looking for others costs time.
fn asked_for(runs: &[Run], limits: [f64; 4]) -> [bool; 4] {
    [0, 1, 2, 3].map(|i| runs.iter().any(|run| run.asked[i] > ASKED / ABOVE[i] * limits[i]))
}

fn report(
    (name, kind): (&str, JointKind),
    problem: &Problem,
    found: &Estimate,
    knowledge: &Knowledge,
    (least, told): ([f64; 4], [bool; 2]),
    samples: usize,
    skill: &Skill,
) -> JointFit {
    let model = problem.model(&found.x);
    let one = |i: usize, value: f64, discrepancy: f64| {
        knowledge.positive(value, &[(i, problem.priors.of(i).deviation)], discrepancy)
    };
    let limit = |i: usize| {
        let bound = Some(least[i]);
        if problem.shown.limits[i] && told.get(i).is_none_or(|told| *told) {
            let value = problem.priors.of(LIMITS + i).value(found.x[LIMITS + i]);
            Estimated { lower_bound: bound, ..one(LIMITS + i, value, discrepancy::LIMIT[i]) }
        } else {
            Estimated { lower_bound: bound, ..Estimated::default() }
        }
    };
    let integral_gain = knowledge.missed(discrepancy::INTEGRAL_GAIN, discrepancy::SMOOTH_INTEGRAL_GAIN);
    let mut integral = one(INTEGRAL_GAIN, model.integral_gain_1_s2, integral_gain);
    // One that acts more slowly than runs last cannot be told from none.
    integral.identified &= model.position_gain_1_s < SLOWEST_INTEGRAL_S * model.integral_gain_1_s2;
    if problem.shown.integral == Integral::None {
        integral = Estimated { value: Some(0.0), ..Estimated::default() };
    }
    let [dead_band_rad_s, dead_band_error_rad] = knowledge.dead_band(problem, &found.x);
    JointFit {
        name: name.to_owned(),
        kind,
        runs: problem.runs.len(),
        samples,
        residual_rad: found.scale_rad,
        inefficiency: knowledge.inefficiency,
        held_out_r2: skill.held_out_r2,
        model_holds: knowledge.holds,
        unexplained_peak_rad: unexplained_rad(&skill.starts),
        lag_s: knowledge.lag(problem, &found.x),
        dead_band_rad_s,
        dead_band_error_rad,
        position_gain_1_s: knowledge.position_gain(problem, &found.x),
        integral_gain_1_s2: integral,
        feed_forward: knowledge.feed_forward(problem, &found.x),
        set_values_late_s: knowledge.set_values_late(problem, &found.x),
        gain_ratio: one(
            ASYMMETRY,
            model.asymmetry.exp(),
            knowledge.missed(discrepancy::GAIN, discrepancy::SMOOTH_GAIN),
        ),
        speed_limit_growing_rad_s: limit(0),
        speed_limit_shrinking_rad_s: limit(1),
        acceleration_limit_growing_rad_s2: limit(2),
        acceleration_limit_shrinking_rad_s2: limit(3),
        valve_dead_band: None,
        model,
    }
}
