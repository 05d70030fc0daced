//! Plans against values computed with SciPy and Pinocchio, and against each other.

use std::{ops::ControlFlow, path::Path};

use hydrotrace::{
    arm::Arm,
    moea::{Algorithm, Budget},
    plan::{Evaluator, Found, Limit, Margin, Reference, Rule, Search, Setup, Timing, choose, search},
    task::{Ceilings, Objective, Objectives, Place, Task},
    units::degrees_from_radians,
};
use proptest::prelude::*;

fn task(name: &str) -> Task {
    Task::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("sample-logs/tasks").join(name)).unwrap()
}

fn setup(name: &str) -> Setup {
    Setup::new(&task(name), Arm::sample().unwrap()).unwrap()
}

/// Objectives and margins of one timing.
fn judged(setup: &Setup, times_s: &[f64]) -> (Objectives, f64, Vec<Margin>) {
    let mut evaluator = Evaluator::new(setup);
    let objectives = evaluator.evaluate(setup, &setup.intervals_s(times_s).unwrap()).unwrap();
    let violation = evaluator.violation();
    (objectives, violation, setup.margins(&setup.motion(times_s).unwrap(), &mut evaluator))
}

const A: [f64; 7] = [0.0, 2.01, 3.77, 5.79, 6.53, 8.85, 10.48];
const B: [f64; 7] = [0.0, 3.51, 7.34, 10.91, 13.31, 15.32, 18.94];
const C: [f64; 7] = [0.0, 1.51, 5.09, 10.23, 15.67, 18.98, 23.27];
const TASK_1: [f64; 6] = [0.0, 7.744, 15.307, 22.863, 30.976, 38.72];
const TASK_2: [f64; 6] = [0.0, 9.431, 19.334, 34.66, 39.14, 49.043];

#[test]
fn the_papers_plans_have_the_objectives_computed_elsewhere_to_every_printed_digit() {
    let mut printed = task("task-2.toml");
    printed.points[2].dwell_s = Some(2.122);
    let as_printed = Setup::new(&printed, Arm::sample().unwrap()).unwrap();
    let (simulation, task_1) = (setup("simulation.toml"), setup("task-1.toml"));
    let cases: [(&Setup, &[f64], [&str; 3], bool); 5] = [
        (&simulation, &A, ["10.480", "61.6945", "306.67"], true),
        (&simulation, &B, ["18.940", "6.81517", "155.81"], true),
        (&simulation, &C, ["23.270", "35.8176", "358.99"], false),
        (&task_1, &TASK_1, ["38.720", "1.73633", "113.32"], true),
        (&as_printed, &TASK_2, ["49.043", "1.05795", "140.06"], true),
    ];
    for (setup, times_s, expected, feasible) in cases {
        let (found, violation, margins) = judged(setup, times_s);
        let digits = |text: &str| text.split('.').nth(1).unwrap().len();
        let [f1, f2, f3] = [
            found[Objective::Duration],
            degrees_from_radians(found[Objective::RmsJerk]),
            found[Objective::RmsPower],
        ];
        let shown = [f1, f2, f3].into_iter().zip(expected).map(|(f, text)| format!("{f:.*}", digits(text)));
        assert_eq!(shown.collect::<Vec<_>>(), expected);
        assert_eq!(violation == 0.0, feasible);
        assert_eq!(margins.iter().all(|margin| margin.share <= 1.0), feasible);
    }
}

#[test]
fn plan_c_breaks_the_range_and_the_torque_of_joint_3() {
    let (_, _, margins) = judged(&setup("simulation.toml"), &C);
    let broken: Vec<_> = margins.iter().filter(|m| m.share > 1.0).map(|m| (m.limit, m.joint)).collect();
    assert!(broken.contains(&(Limit::Position, Some(2))), "{broken:?}");
    let range = margins.iter().find(|m| m.limit == Limit::Position && m.joint == Some(2)).unwrap();
    assert!((degrees_from_radians(range.value) + 125.6).abs() < 0.05, "{range:?}");
}

fn front(setup: &Setup, options: &Search) -> Found {
    search(setup, options, |_| ControlFlow::Continue(())).unwrap()
}

fn evaluations(count: u64) -> Search {
    Search { budget: Budget::Evaluations(count), ..Search::default() }
}

#[test]
fn plans_of_a_front_keep_every_limit_exactly_and_none_beats_another() {
    for name in ["simulation.toml", "task-1.toml", "task-2.toml"] {
        let setup = setup(name);
        let found = front(&setup, &evaluations(3000));
        assert!(found.front.len() > 100 && found.evaluations <= 3000, "{name}: {}", found.front.len());
        for timing in found.front.iter().step_by(7) {
            let (objectives, _, margins) = judged(&setup, &setup.times_s(&timing.interval_s));
            assert_eq!(objectives, timing.objectives);
            let most = margins.iter().max_by(|a, b| a.share.total_cmp(&b.share)).unwrap();
            // Torques are judged between nodes by parabolas in the search, and exactly here.
            assert!(most.share < 1.0 + 1e-4, "{name}: {most:?}");
        }
        for a in &found.front {
            let beats = |b: &Timing| {
                let (a, b) = (a.objectives.plan(), b.objectives.plan());
                a != b && a.iter().zip(b).all(|(a, b)| a <= b)
            };
            assert!(!found.front.iter().any(beats));
        }
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let setup = setup("task-1.toml");
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| front(&setup, &evaluations(2000)))
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn a_start_from_descents_misses_far_less_of_the_hypervolume_than_a_random_one_at_equal_evaluations() {
    for name in ["simulation.toml", "task-1.toml", "task-2.toml"] {
        let setup = setup(name);
        let objectives = |options: &Search| -> Vec<Vec<f64>> {
            front(&setup, options).front.iter().map(|timing| timing.objectives.plan().to_vec()).collect()
        };
        let best = objectives(&Search { front: 1000, ..evaluations(15_000) });
        let reference = Reference::of(best.iter().map(Vec::as_slice));
        let all = reference.measure(best.iter().map(Vec::as_slice));
        let missing =
            |options: &Search| all - reference.measure(objectives(options).iter().map(Vec::as_slice));
        let seeded = missing(&evaluations(3000));
        let random = missing(&Search { seeded: false, algorithm: Algorithm::Nsga3, ..evaluations(3000) });
        assert!(2.0 * seeded < random, "{name}: {seeded} and {random} of {all}");
    }
}

#[test]
fn any_degree_finds_about_the_same_fastest_plan() {
    let fastest = |degree: u8| {
        let task = Task { degree, ..task("task-1.toml") };
        let setup = Setup::new(&task, Arm::sample().unwrap()).unwrap();
        let fastest = front(&setup, &evaluations(2000)).front.remove(0);
        // A quintic's jerk jumps at its ends, where no node of the quadrature lies.
        let (_, _, margins) = judged(&setup, &setup.times_s(&fastest.interval_s));
        let most = margins.iter().map(|margin| margin.share).fold(0.0, f64::max);
        assert!(most < 1.0 + 1e-4, "degree {degree}: {most}");
        fastest.objectives[Objective::Duration]
    };
    for degree in [5, 6, 7] {
        let duration_s = fastest(degree);
        assert!((9.0..14.0).contains(&duration_s), "degree {degree}: {duration_s} s");
    }
}

#[test]
fn key_points_given_by_the_tool_are_those_of_the_joints() {
    let by_joints = task("task-1.toml");
    let arm = Arm::sample().unwrap();
    let mut by_tool = by_joints.clone();
    for key in &mut by_tool.points {
        let Place::Joints(angles) = &key.place else { panic!("a task in joints") };
        let pose = arm.chain.tool_pose(angles);
        let forward = pose.rotation * nalgebra::Vector3::x();
        let pitch_rad = (-forward.z).atan2(forward.x);
        let at = pose.translation;
        key.place = Place::Tool { x_m: at.x, z_m: at.z, pitch_rad, fixed_angles: false };
    }
    let setup = Setup::new(&by_tool, arm.clone()).unwrap();
    let motion = setup.motion(&TASK_1).unwrap();
    for (point, key) in by_tool.points.iter().enumerate() {
        let Place::Tool { x_m, z_m, .. } = key.place else { panic!("a task by the tool") };
        let at = arm.chain.tool_pose(motion.points().of(point)).translation;
        assert!((at.x - x_m).abs() < 1e-9 && (at.z - z_m).abs() < 1e-9);
    }
}

#[test]
fn an_arm_of_any_number_of_joints_without_cylinders_is_planned() {
    let text =
        std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/reference/spatial-7.urdf"));
    // Its own limit is too little to hold the arm.
    let text = text.unwrap().replace("effort=\"100\"", "effort=\"1000\"");
    let arm = Arm::without_hydraulics(("spatial-7.urdf", &text), Some("tool")).unwrap();
    let joints: Vec<String> = arm.chain.joints().iter().map(|joint| joint.name.clone()).collect();
    let angles = |deg: f64| {
        let each = joints.iter().map(|name| format!("\"{name}\" = {deg}"));
        format!("{{ {} }}", each.collect::<Vec<_>>().join(", "))
    };
    let text = format!(
        "title = \"seven\"\narm = \"spatial-7.urdf\"\njoints = {joints:?}\n\
         [[point]]\nangles_deg = {}\n[[point]]\nangles_deg = {}\n[[point]]\nangles_deg = {}\n\
         [limits]\nacceleration_deg_s2 = {}\n",
        angles(0.0),
        angles(10.0),
        angles(4.0),
        angles(30.0)
    );
    let setup = Setup::new(&Task::parse(&text).unwrap(), arm).unwrap();
    let found = front(&setup, &evaluations(1500));
    assert!(found.front.len() > 20, "{} plans", found.front.len());
}

#[test]
fn a_task_that_no_timing_can_keep_names_what_is_nearest() {
    let mut slow = task("simulation.toml");
    slow.limits[2].velocity_rad_s = [-0.01, 0.01];
    let setup = Setup::new(&slow, Arm::sample().unwrap()).unwrap();
    let found = front(&setup, &evaluations(1000));
    assert!(found.front.is_empty());
    let nearest = found.nearest.unwrap();
    let (_, _, margins) = judged(&setup, &setup.times_s(&nearest.interval_s));
    let broken: Vec<_> = margins.iter().filter(|m| m.share > 1.0).map(|m| (m.limit, m.joint)).collect();
    assert_eq!(broken, [(Limit::Speed, Some(2))]);
}

#[test]
fn every_rule_chooses_the_plan_that_is_best_by_it() {
    let setup = setup("task-1.toml");
    let found = front(&setup, &evaluations(3000));
    let ceilings = Ceilings::NONE.with(Objective::Duration, 40.0);
    let chosen = |rule| choose(&setup, &found.front, &ceilings, (rule, None)).unwrap().timing;
    let least = |k: Objective| {
        let within = found.front.iter().filter(|timing| timing.objectives[Objective::Duration] <= 40.0);
        within.map(|timing| timing.objectives[k]).fold(f64::INFINITY, f64::min)
    };
    for &k in Objective::OF_PLAN {
        let rule = Rule::Best(k);
        let timing = chosen(rule);
        assert!(timing.objectives[k] <= least(k), "{rule:?}");
        assert!(timing.objectives[Objective::Duration] <= 40.0 && timing.violation == 0.0, "{rule:?}");
    }
    for rule in [Rule::Weights, Rule::Ideal, Rule::Knee] {
        let f = chosen(rule).objectives;
        let beaten =
            |b: &Timing| b.objectives.plan().iter().zip(f.plan()).all(|(b, f)| *b < f * (1.0 - 1e-4));
        assert!(!found.front.iter().any(beaten), "{rule:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn without_dwells_a_stretched_plan_has_the_shares_that_scaling_says(
        interval_s in prop::collection::vec(2.0_f64..6.0, 6),
        stretch in 1.1_f64..2.0,
    ) {
        let setup = setup("simulation.toml");
        let slow: Vec<f64> = interval_s.iter().map(|s| s * stretch).collect();
        let (fast, _, fast_margins) = judged(&setup, &setup.times_s(&interval_s));
        let (slow, _, slow_margins) = judged(&setup, &setup.times_s(&slow));
        let ratio = slow[Objective::RmsJerk] / fast[Objective::RmsJerk] * stretch.powi(3);
        prop_assert!((ratio - 1.0).abs() < 1e-9);
        for (fast, slow) in fast_margins.iter().zip(&slow_margins) {
            let power = match fast.limit {
                Limit::Position => 0,
                Limit::Speed | Limit::RodSpeed | Limit::PumpFlow => 1,
                Limit::Acceleration => 2,
                Limit::Jerk => 3,
                _ => continue,
            };
            let ratio = slow.share / fast.share * stretch.powi(power);
            prop_assert!((ratio - 1.0).abs() < 2e-5, "{:?} {ratio}", fast.limit);
        }
    }

    #[test]
    fn an_evaluation_judges_as_the_exact_margins_do_wherever_a_limit_is_near(
        interval_s in prop::collection::vec(0.8_f64..4.0, 6),
    ) {
        let setup = setup("simulation.toml");
        let times_s = setup.times_s(&interval_s);
        let (_, violation, margins) = judged(&setup, &times_s);
        let kept = margins.iter().all(|margin| margin.share <= 1.0);
        // Two local peaks that are nearly as high can change places between nodes.
        let far = margins.iter().all(|margin| (margin.share - 1.0).abs() > 2e-3);
        prop_assert!(kept == (violation == 0.0) || !far, "{violation}");
    }
}
