//! What a free shape reaches on the sample tasks, judged by a dense look that shares no code with the descent.

use super::{NoShape, Shape, fastest_shape, shape};
use crate::{
    arm::Arm,
    moea::Budget,
    plan::{
        BETWEEN, Choice, Evaluator, Limit, PlanEvaluation, Rule, Search, Setup, Timing, choose,
        points::states, search,
    },
    spline::{Motion, Quantity, Segment},
    task::{Ceilings, Objective, Place, Task},
};
use nalgebra::Vector3;
use std::ops::ControlFlow;

const TASKS: [(&str, &str); 3] = [
    ("simulation", include_str!("../../../sample-logs/tasks/simulation.toml")),
    ("task 1", include_str!("../../../sample-logs/tasks/task-1.toml")),
    ("task 2", include_str!("../../../sample-logs/tasks/task-2.toml")),
];

fn setup(text: &str) -> Setup {
    Setup::new(&Task::parse(text).unwrap(), Arm::sample().unwrap()).unwrap()
}

fn chosen(setup: &Setup, rule: Rule, ceilings: &Ceilings) -> Choice {
    let settings = Search { budget: Budget::Evaluations(2000), ..Search::default() };
    let found = search(setup, &settings, |_| ControlFlow::Continue(())).unwrap();
    choose(setup, &found.front, ceilings, (rule, None)).unwrap()
}

/// De Boor's algorithm, term by term from its definition.
fn de_boor(knots: &[f64], control: &[f64], degree: usize, t_s: f64) -> f64 {
    let last = control.len() - 1;
    let span = (degree..=last).rev().find(|&k| knots[k] <= t_s && knots[k] < knots[k + 1]).unwrap_or(degree);
    let mut d: Vec<f64> = (0..=degree).map(|j| control[span - degree + j]).collect();
    for r in 1..=degree {
        for j in (r..=degree).rev() {
            let i = span - degree + j;
            let share = (t_s - knots[i]) / (knots[i + degree + 1 - r] - knots[i]);
            d[j] = (1.0 - share) * d[j - 1] + share * d[j];
        }
    }
    d[degree]
}

/// Control points and knots of the derivative.
fn derived(knots: &[f64], control: &[f64], degree: usize) -> (Vec<f64>, Vec<f64>) {
    let differences = control.windows(2).enumerate();
    let derivative = differences
        .map(|(i, pair)| degree as f64 * (pair[1] - pair[0]) / (knots[i + degree + 1] - knots[i + 1]));
    (knots[1..knots.len() - 1].to_vec(), derivative.collect())
}

/// Lowest and highest speed, acceleration and jerk of a joint among so many instants.
fn dense(segment: &Segment, joint: usize, instants: usize) -> [[f64; 2]; 3] {
    let spline = &segment.spline;
    let (mut knots, mut control) =
        (spline.knots_s().to_vec(), spline.control(joint, Quantity::Position).to_vec());
    let mut degree = spline.degree().order();
    let mut found = [[0.0_f64; 2]; 3];
    for ends in &mut found {
        (knots, control) = derived(&knots, &control, degree);
        degree -= 1;
        for i in 0..=instants {
            let t_s = spline.duration_s() * i as f64 / instants as f64;
            let value = de_boor(&knots, &control, degree, t_s);
            *ends = [ends[0].min(value), ends[1].max(value)];
        }
    }
    found
}

fn check(setup: &Setup, found: &Shape, motion: &Motion) {
    let mut highest: f64 = 0.0;
    for segment in motion.segments() {
        for (joint, limits) in setup.limits.iter().enumerate() {
            let limits = [limits.speed_rad_s, limits.acceleration(), limits.jerk()];
            for ([least, most], [low, high]) in dense(segment, joint, 4000).into_iter().zip(limits) {
                highest = highest.max(least / low).max(most / high);
            }
        }
    }
    assert!(highest <= 1.0 + 1e-9, "{highest}");
    // What a controller makes of the trajectory keeps them too.
    let points_hz = setup.points_hz(motion);
    let curve = setup.through_points(&states(motion, 0.0, 1.0 / points_hz), 1.0 / points_hz);
    let most = curve.iter().map(|(_, margin)| margin.share).fold(0.0, f64::max);
    assert!(most <= 1.0 + BETWEEN, "{most} with {points_hz} points a second");
    for margin in setup.margins(motion, &mut Evaluator::new(setup)) {
        assert!(!margin.broken(), "{margin:?}");
    }
    for (point, t_s) in found.evaluation.times_s.iter().enumerate() {
        let at = motion.at(*t_s);
        for joint in 0..setup.joint_count() {
            if setup.poses[point].is_some() {
                continue;
            }
            let want = setup.template().points().of(point)[joint];
            assert!(
                (at.of(Quantity::Position, joint)[0] - want).abs() < 1e-12,
                "point {point}, joint {joint}"
            );
        }
    }
    for segment in motion.segments() {
        for t_s in [segment.spline.span_s().0, segment.spline.span_s().1] {
            let at = segment.spline.at(t_s);
            let rates = Quantity::ALL[1..].iter().flat_map(|quantity| at.all(*quantity));
            assert!(rates.clone().all(|rate| rate.abs() < 1e-9), "{:?}", rates.collect::<Vec<_>>());
        }
    }
}

fn motion(setup: &Setup, found: &Shape) -> Motion {
    setup.motion_through(&found.evaluation.times_s, &found.evaluation.via).unwrap()
}

#[test]
fn the_fastest_shape_is_far_faster_than_any_timing_and_keeps_every_limit_between_all_instants() {
    for ((name, text), (timing_s, most_s)) in
        TASKS.into_iter().zip([(6.727, 6.279), (12.421, 11.3), (18.918, 14.8)])
    {
        let setup = setup(text);
        let choice = chosen(&setup, Rule::Best(Objective::Duration), &Ceilings::NONE);
        let start_s = choice.timing.objectives[Objective::Duration];
        assert!((start_s - timing_s).abs() < 1e-3, "{name}: {start_s}");
        let found = shape(&setup, &choice, &Ceilings::NONE, None).unwrap();
        let duration_s = found.evaluation.objectives[Objective::Duration];
        println!("{name}: {duration_s:.4} s, {} pieces, {} steps", found.pieces, found.steps);
        assert!(duration_s <= most_s, "{name}: {duration_s}");
        check(&setup, &found, &motion(&setup, &found));
    }
}

#[test]
fn where_no_timing_keeps_the_limits_the_fastest_shape_within_a_ceiling_is_a_slower_one() {
    let setup = setup(TASKS[0].1);
    let choice = chosen(&setup, Rule::Best(Objective::Duration), &Ceilings::NONE);
    // Twice as fast as the fastest: no limit is kept.
    let interval_s: Vec<f64> = choice.timing.interval_s.iter().map(|s| 0.5 * s).collect();
    let PlanEvaluation { objectives, .. } = PlanEvaluation::of(&setup, &setup.times_s(&interval_s)).unwrap();
    let timing = Timing { interval_s, objectives, violation: 1.0 };
    let free = fastest_shape(&setup, &timing, &Ceilings::NONE, None).unwrap().evaluation.objectives;
    for (objective, power) in [(Objective::RmsJerk, 3.0), (Objective::RmsPower, 1.0)] {
        let most = 0.8 * free[objective];
        let found = fastest_shape(&setup, &timing, &Ceilings::NONE.with(objective, most), None).unwrap();
        let objectives = found.evaluation.objectives;
        // The same shape more slowly.
        let slowed_s = free[Objective::Duration] * 0.8_f64.powf(-1.0 / power);
        println!("{objective:?}: {:.3} s, {slowed_s:.3} s the same slowed", objectives[Objective::Duration]);
        assert!(objectives[objective] <= most && objectives[Objective::Duration] < 1.01 * slowed_s);
        check(&setup, &found, &motion(&setup, &found));
    }
}

#[test]
fn a_joint_that_is_slower_one_way_is_slower_that_way_only() {
    let (_, text) = TASKS[1];
    let fastest = |by: [f64; 2]| {
        let mut task = Task::parse(text).unwrap();
        for limits in &mut task.limits {
            let [low, high] = limits.velocity_rad_s;
            limits.velocity_rad_s = [by[0] * low, by[1] * high];
        }
        let setup = Setup::new(&task, Arm::sample().unwrap()).unwrap();
        let choice = chosen(&setup, Rule::Best(Objective::Duration), &Ceilings::NONE);
        let timed = setup.motion_through(&setup.times_s(&choice.timing.interval_s), &[]).unwrap();
        for margin in setup.margins(&timed, &mut Evaluator::new(&setup)) {
            assert!(!margin.broken(), "{margin:?}");
        }
        let found = shape(&setup, &choice, &Ceilings::NONE, None).unwrap();
        let shaped = motion(&setup, &found);
        check(&setup, &found, &shaped);
        [&timed, &shaped].map(|motion| {
            let beyond = |joint: usize| {
                let at = motion.extrema(joint, Quantity::Velocity);
                let [low, high] = setup.limits[joint].speed_rad_s;
                at.greatest.value.max(-at.least.value) / high.min(-low)
            };
            (motion.duration_s(), (0..setup.joint_count()).map(beyond).fold(0.0, f64::max))
        })
    };
    let (weak, one_way, other, strong) =
        (fastest([0.5, 0.5]), fastest([0.5, 1.0]), fastest([1.0, 0.5]), fastest([1.0, 1.0]));
    println!("{weak:.3?} {one_way:.3?} {other:.3?} {strong:.3?}");
    for kind in 0..2 {
        for uneven in [&one_way, &other] {
            let [low, here, high] = [&strong, uneven, &weak].map(|plans| plans[kind].0);
            assert!(low * 0.999 <= here && here < 0.97 * high, "{low} {here} {high}");
            assert!(uneven[kind].1 > 1.2, "{}", uneven[kind].1);
        }
    }
}

#[test]
fn the_smoothest_shape_of_a_duration_beats_the_smoothest_timing_of_it() {
    for ((name, text), (by, gain)) in
        TASKS.into_iter().flat_map(|task| [(task, (1.1, 0.09)), (task, (2.0, 0.08))])
    {
        let setup = setup(text);
        let fastest = chosen(&setup, Rule::Best(Objective::Duration), &Ceilings::NONE);
        let within_s = by * fastest.timing.objectives[Objective::Duration];
        let ceilings = Ceilings::NONE.with(Objective::Duration, within_s);
        let choice = chosen(&setup, Rule::Best(Objective::RmsJerk), &ceilings);
        let found = shape(&setup, &choice, &ceilings, None).unwrap();
        let ratio =
            found.evaluation.objectives[Objective::RmsJerk] / choice.timing.objectives[Objective::RmsJerk];
        println!("{name} at {by}: {:.2} % less jerk, {} steps", 100.0 * (1.0 - ratio), found.steps);
        assert!(ratio < 1.0 - gain, "{name} at {by}: {ratio}");
        check(&setup, &found, &motion(&setup, &found));
    }
}

#[test]
fn a_shape_is_the_same_again_from_what_is_written_of_it() {
    let setup = setup(TASKS[0].1);
    let choice = chosen(&setup, Rule::Best(Objective::Duration), &Ceilings::NONE);
    let found = shape(&setup, &choice, &Ceilings::NONE, Some(2)).unwrap().evaluation;
    assert_eq!(PlanEvaluation::through(&setup, &found.times_s, &found.via).unwrap(), found);
    assert_eq!(shape(&setup, &choice, &Ceilings::NONE, Some(2)).unwrap().evaluation, found);
    let mut late = found.via.clone();
    late[1].t_s = found.times_s[3];
    assert!(setup.motion_through(&found.times_s, &late).is_err());
    let mut short = found.via.clone();
    short[0].position_rad.pop();
    assert!(setup.motion_through(&found.times_s, &short).is_err());
}

#[test]
fn one_piece_leaves_the_timing_as_it_is_and_more_give_more() {
    let setup = setup(TASKS[1].1);
    let choice = chosen(&setup, Rule::Best(Objective::Duration), &Ceilings::NONE);
    match shape(&setup, &choice, &Ceilings::NONE, Some(1)) {
        Err(NoShape::NoGain) => {}
        other => {
            let duration_s = other.unwrap().evaluation.objectives[Objective::Duration];
            assert!((duration_s - choice.timing.objectives[Objective::Duration]).abs() < 1e-5);
        }
    }
    let [coarse, fine] = [3, 6].map(|pieces| {
        let found = shape(&setup, &choice, &Ceilings::NONE, Some(pieces)).unwrap();
        found.evaluation.objectives[Objective::Duration]
    });
    assert!(fine < coarse, "{fine} {coarse}");
}

/// Where loads bind, in place of rates of angles.
fn loaded(text: &str, limits: &str) -> Setup {
    let from = text.find("[limits]").unwrap();
    let to = from + text[from..].find("[objectives]").unwrap_or(text.len() - from);
    let text = format!("{}[limits]\n{limits}\n{}", &text[..from], &text[to..]);
    setup(&text)
}

fn by_joint(key: &str, value: f64) -> String {
    let joints: Vec<String> = (1..=6).map(|joint| format!("J{joint} = {value:?}")).collect();
    format!("{key} = {{ {} }}\n", joints.join(", "))
}

#[test]
fn where_torques_rods_or_the_tool_bind_the_shape_keeps_them_and_is_faster() {
    let limits = [("acceleration_deg_s2", 100.0), ("jerk_deg_s3", 600.0), ("speed_deg_s", 90.0)];
    let rates: String = limits.into_iter().map(|(key, value)| by_joint(key, value)).collect();
    let tool = (Limit::ToolSpeed, "tool_speed_m_s = 0.5".to_owned());
    let rods = (Limit::RodSpeed, by_joint("rod_speed_m_s", 0.05));
    let free = loaded(TASKS[2].1, &rates);
    let choice = chosen(&free, Rule::Best(Objective::Duration), &Ceilings::NONE);
    let fastest = PlanEvaluation::of(&free, &free.times_s(&choice.timing.interval_s)).unwrap();
    let torques = fastest.margins.iter().filter(|margin| margin.limit == Limit::Torque);
    let largest = torques.map(|margin| margin.value.abs()).fold(0.0, f64::max);
    let torque = (Limit::Torque, by_joint("torque_n_m", 0.97 * largest));
    for ((name, text), (limit, line)) in TASKS.into_iter().zip([tool, rods, torque]) {
        let setup = loaded(text, &format!("{rates}{line}"));
        let choice = chosen(&setup, Rule::Best(Objective::Duration), &Ceilings::NONE);
        let start_s = choice.timing.objectives[Objective::Duration];
        let found = shape(&setup, &choice, &Ceilings::NONE, None).unwrap();
        let duration_s = found.evaluation.objectives[Objective::Duration];
        let own = found.evaluation.margins.iter().filter(|margin| margin.limit == limit);
        let share = own.fold(0.0, |most: f64, margin| most.max(margin.share));
        println!("{name}, {limit:?}: {start_s:.3} to {duration_s:.3} s, {} steps, {share:.6}", found.steps);
        check(&setup, &found, &motion(&setup, &found));
        assert!(duration_s < 0.9 * start_s && share > 0.99, "{name}, {limit:?}");
    }
}

#[test]
fn a_shape_follows_the_rule_that_chose_under_all_its_ceilings() {
    let setup = setup(TASKS[1].1);
    let fastest = chosen(&setup, Rule::Best(Objective::Duration), &Ceilings::NONE).timing.objectives;
    let smooth = Ceilings::NONE.with(Objective::RmsJerk, 0.5 * fastest[Objective::RmsJerk]);
    let slow = Ceilings::NONE.with(Objective::Duration, 2.0 * fastest[Objective::Duration]);
    let powered = slow.with(Objective::RmsPower, 0.45 * fastest[Objective::RmsPower]);
    let asked = [
        (Rule::Weights, Ceilings::NONE, 0.02),
        (Rule::Ideal, Ceilings::NONE, 0.02),
        (Rule::Best(Objective::Duration), smooth, 0.04),
        (Rule::Best(Objective::RmsPower), slow, 0.05),
        (Rule::Best(Objective::RmsJerk), powered, 0.1),
    ];
    for (rule, ceilings, gain) in asked {
        let choice = chosen(&setup, rule, &ceilings);
        let before = &choice.timing.objectives;
        let found = shape(&setup, &choice, &ceilings, None).unwrap();
        let after = &found.evaluation.objectives;
        let change =
            |k: &Objective| format!("{} {:+.2} %", k.row().short, 100.0 * (after[*k] / before[*k] - 1.0));
        let changes: Vec<String> = Objective::OF_PLAN.iter().map(change).collect();
        let better = choice.gain(before, after);
        println!("{rule:?}: {:.2} % better: {}, {} steps", 100.0 * better, changes.join(", "), found.steps);
        check(&setup, &found, &motion(&setup, &found));
        assert!(better > gain && after.within(&ceilings), "{rule:?}");
        if rule == Rule::Best(Objective::RmsPower) {
            let jerk = after[Objective::RmsJerk] / before[Objective::RmsJerk];
            assert!(jerk < 1.0 + 1e-5, "power is bought with {jerk} times the jerk");
        }
    }
}

/// The same task with its key points between the first and the last given by the tool.
fn task_by_tool(text: &str, fixed_angles: bool) -> Task {
    let mut task = Task::parse(text).unwrap();
    let (given, last) = (setup(text), task.points.len() - 1);
    for (point, key) in task.points.iter_mut().enumerate().take(last).skip(1) {
        let pose = given.arm.chain.tool_pose(given.template.points().of(point));
        let [x, z] = [pose.rotation * Vector3::x(), pose.rotation * Vector3::z()];
        let at = pose.translation.vector;
        key.place = Place::Tool { x_m: at.x, z_m: at.z, pitch_rad: z.x.atan2(x.x), fixed_angles };
    }
    task
}

#[test]
fn postures_that_inverse_kinematics_chooses_leave_room_for_a_plan() {
    for (name, text) in TASKS {
        let setup = Setup::new(&task_by_tool(text, false), Arm::sample().unwrap()).unwrap();
        let choice = chosen(&setup, Rule::Best(Objective::Duration), &Ceilings::NONE);
        let found = shape(&setup, &choice, &Ceilings::NONE, None).unwrap();
        let [before_s, after_s] =
            [&choice.timing.objectives, &found.evaluation.objectives].map(|f| f[Objective::Duration]);
        println!("{name} by its tool alone: {before_s:.3} to {after_s:.3} s, {} steps", found.steps);
        check(&setup, &found, &motion(&setup, &found));
        assert!(after_s < before_s);
    }
}

/// The task by its tool, with descents that start from the angles that it gave before.
fn by_tool(text: &str, fixed_angles: bool) -> Setup {
    let found = Setup::new(&task_by_tool(text, fixed_angles), Arm::sample().unwrap()).unwrap();
    Setup { poses: found.poses, ..setup(text) }
}

#[test]
fn angles_that_the_tool_leaves_free_are_sought_with_the_shape_or_kept_on_request() {
    for ((name, text), most_s) in TASKS.into_iter().zip([5.8, 11.0, 14.3]) {
        assert!(by_tool(text, true).poses.iter().all(Option::is_none));
        let setup = by_tool(text, false);
        let choice = chosen(&setup, Rule::Best(Objective::Duration), &Ceilings::NONE);
        let found = shape(&setup, &choice, &Ceilings::NONE, None).unwrap();
        let duration_s = found.evaluation.objectives[Objective::Duration];
        println!("{name}: {duration_s:.4} s, {most_s} s asked, {} steps", found.steps);
        let motion = motion(&setup, &found);
        check(&setup, &found, &motion);
        for (point, t_s) in found.evaluation.times_s.iter().enumerate() {
            let angles: Vec<f64> = (0..setup.joint_count())
                .map(|joint| motion.at(*t_s).of(Quantity::Position, joint)[0])
                .collect();
            let pose = setup.arm.chain.tool_pose(setup.template.points().of(point));
            assert!(setup.arm.chain.is_at(&pose, &angles, 1e-9), "{name}, point {point}");
        }
        let Shape { evaluation: PlanEvaluation { times_s, mut via, .. }, .. } = found.clone();
        assert_eq!(PlanEvaluation::through(&setup, &times_s, &via).unwrap(), found.evaluation);
        let own = via.iter_mut().find(|via| times_s.contains(&via.t_s)).unwrap();
        own.position_rad[0] += 1e-4;
        assert!(PlanEvaluation::through(&setup, &times_s, &via).is_err(), "the tool would be elsewhere");
        assert!(duration_s <= most_s, "{name}: {duration_s}");
    }
}
