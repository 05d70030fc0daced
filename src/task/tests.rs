//! What a task file may say, and what it is told when it is wrong.

use std::path::Path;

use super::*;
use crate::units::DEGREE_RAD;

const TASK: &str = r#"title = "t"
arm = "sample"
joints = ["a", "b"]
[[point]]
angles_deg = { a = 0, b = 90 }
[[point]]
angles_deg = { b = 0, a = 45 }
dwell_s = 2
payload_kg = 10
[[point]]
tool = { x_m = 1, z_m = 2, pitch_deg = -90 }
[limits]
speed_deg_s = { b = 10 }
[objectives]
max_rms_jerk_deg_s3 = 180
"#;

fn error(text: &str) -> String {
    Task::parse(text).unwrap_err().to_string()
}

#[test]
fn degrees_become_radians_and_joints_take_their_order() {
    let task = Task::parse(TASK).unwrap();
    assert_eq!(task.points[1].place, Place::Joints(vec![45.0 * DEGREE_RAD, 0.0]));
    assert_eq!((task.points[1].dwell_s, task.points[1].payload_kg), (Some(2.0), Some(10.0)));
    let pitch_rad = -90.0 * DEGREE_RAD;
    assert_eq!(task.points[2].place, Place::Tool { x_m: 1.0, z_m: 2.0, pitch_rad, fixed_angles: false });
    let speeds = |joint: usize| task.limits[joint].velocity_rad_s.map(|rad_s| rad_s / DEGREE_RAD);
    assert_eq!(speeds(0).map(f64::is_infinite), [true; 2]);
    assert!((speeds(1)[0] + 10.0).abs() < 1e-12 && (speeds(1)[1] - 10.0).abs() < 1e-12);
    assert!((task.ceilings[Objective::RmsJerk] - std::f64::consts::PI).abs() < 1e-15);
    assert_eq!((task.degree, task.interval_s), (6, [0.3, 20.0]));
    assert_eq!(task.start.velocity_rad_s, [0.0, 0.0]);
}

#[test]
fn a_speed_has_one_limit_for_both_ways_or_the_lowest_and_the_highest() {
    let two = Task::parse(&TASK.replace("{ b = 10 }", "{ a = [-8, 12.5], b = 10 }")).unwrap();
    for (limits, said) in two.limits.iter().zip([[-8.0, 12.5], [-10.0, 10.0]]) {
        let off = limits.velocity_rad_s.iter().zip(said).map(|(rad_s, deg_s)| rad_s - deg_s * DEGREE_RAD);
        assert!(off.into_iter().all(|off| off.abs() < 1e-15), "{limits:?}");
    }
    for (wrong, found) in [("[8, 12]", "[8, 12]"), ("[12, -8]", "[12, -8]"), ("[-8, inf]", "[-8, inf]")] {
        let said = error(&TASK.replace("b = 10 }", &format!("b = {wrong} }}")));
        let expected = "a lowest speed below zero is expected first, then a highest above it, both finite";
        assert_eq!(said, format!("line 13: limits.speed_deg_s is {found}; {expected}"));
    }
    assert!(error(&TASK.replace("b = 10 }", "b = -10 }")).contains("is -10; limits above zero are expected"));
    let said = error(&TASK.replace("b = 10 }", "b = \"fast\" }"));
    assert!(said.contains("a speed is expected, or the lowest and the highest: [-8.0, 12.0]"), "{said}");
}

#[test]
fn an_unknown_joint_is_named_with_its_line() {
    let said = error(&TASK.replace("b = 0, a = 45", "b = 0, a = 45, c = 1"));
    assert_eq!(said, "line 7: angles_deg names the joint \"c\"; the task's joints are a, b");
    let said = error(&TASK.replace("b = 0, a = 45", "b = 0"));
    assert!(said.starts_with("line 7: angles_deg has no value for the joint \"a\""), "{said}");
}

#[test]
fn a_bound_without_a_unit_is_told_which_keys_there_are() {
    let said = error(&TASK.replace("max_rms_jerk_deg_s3", "max_rms_jerk"));
    assert!(said.starts_with("line 15: unknown field `max_rms_jerk`, expected one of"), "{said}");
    assert!(said.contains("max_rms_jerk_deg_s3") && said.ends_with("carries its unit in its key"), "{said}");
}

#[test]
fn a_time_vector_of_the_wrong_length_is_never_guessed() {
    let said = error(&TASK.replace("joints =", "times_s = [0, 1]\njoints ="));
    assert!(said.starts_with("line 3: times_s has 2 values, 3 are needed"), "{said}");
    let said = error(&TASK.replace("joints =", "times_s = [0, 2, 1]\njoints ="));
    assert!(said.contains("1 after 2"), "{said}");
}

#[test]
fn what_makes_no_sense_is_located() {
    for (from, to, expected) in [
        ("dwell_s = 2", "dwell_s = -1", "line 8: dwell_s is -1"),
        ("dwell_s = 2\n", "", "line 8: payload_kg is 10; a payload changes at a dwell"),
        ("speed_deg_s = { b = 10 }", "speed_deg_s = { b = 0 }", "line 13: limits.speed_deg_s is 0"),
        ("tool = {", "angles_deg = { a = 1, b = 2 }\ntool = {", "line 10: a key point has either"),
        ("joints = [\"a\", \"b\"]", "joints = [\"a\", \"a\"]", "line 3: joints is \"a\" twice"),
        ("joints =", "degree = 4\njoints =", "line 3: degree is 4; 5, 6 or 7 is expected"),
        ("[limits]", "[limits", "line 12: "),
    ] {
        let said = error(&TASK.replace(from, to));
        assert!(said.starts_with(expected), "{said}");
    }
}

#[test]
fn every_shipped_task_is_one() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("sample-logs/tasks");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let task = Task::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert_eq!(task.joint_count(), 6);
        count += 1;
    }
    assert_eq!(count, 3);
    let task =
        Task::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("sample-logs/tasks/task-1.toml")).unwrap();
    assert_eq!((task.points.len(), task.dwell_s()), (6, 2.0));
}
