//! Plans against values computed with SciPy and Pinocchio, and against each other.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::float_cmp)]

use std::path::Path;

use hydrotrace::{
    arm::Arm,
    plan::{Evaluator, Limit, Margin, Objectives, Setup},
    task::Task,
    units::degrees_from_radians,
};

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
        let [f1, f2, f3] = [found.duration_s, degrees_from_radians(found.rms_jerk_rad_s3), found.rms_power_w];
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
