//! Where the numbers of joints lie in logs that other recorders wrote, as a layout for Foxglove names it.

use serde_json::Value;

use super::{
    cdr::Kind,
    encode::{Point, array, controller_state, dynamic, joint_state},
    file::Channel,
    *,
};
use crate::support::{run_line, said};

/// The paths of all plots of a log's layout, and what was said.
fn paths(log: &Log, options: &str) -> (Vec<String>, String) {
    let stored = store(&[("run.mcap", &log.bytes(mcap::WriteOptions::new()))]);
    let folder = stored.paths[0].parent().unwrap();
    let line = format!("export run.mcap --foxglove-layout layout.json{options}");
    let (code, text, error) = said(&run_line(folder, &line));
    assert!(matches!(code, 0 | 3), "{text}{error}");
    let layout = std::fs::read_to_string(folder.join("layout.json")).unwrap();
    let layout: Value = serde_json::from_str(&layout).unwrap();
    let plots = layout["configById"].as_object().unwrap().iter().filter(|(id, _)| *id != "Plot!worst");
    let paths = plots.flat_map(|(_, panel)| panel["paths"].as_array().cloned().unwrap_or_default());
    let mut paths: Vec<String> = paths.map(|path| path["value"].as_str().unwrap().to_owned()).collect();
    paths.sort();
    (paths, error)
}

/// The same of a log whose measurement is on a topic of another type.
fn paths_beside_a_plan(type_name: &str, message: impl Fn(i64, &[f64]) -> Vec<u8>) -> (Vec<String>, String) {
    let mut log = Log::of_plan();
    log.add(Channel::cdr("/state", type_name), 0..SAMPLES, |k| message(k, &measurement(k)));
    paths(&log, "")
}

fn ends_of(paths: &[String]) -> Vec<&str> {
    paths.iter().filter_map(|path| path.strip_prefix("/state")).collect()
}

#[test]
fn a_layout_of_a_controllers_state_has_its_plan_its_measurement_and_its_error() {
    let mut log = Log::default();
    let schema = schema::controller_state(&["reference", "feedback", "error", "output"], false, false);
    let channel = Channel::cdr("/state", "control_msgs/msg/JointTrajectoryControllerState");
    log.add(channel.with_schema("ros2msg", schema), 0..SAMPLES, |k| {
        let (planned, measured) = (plan(k), measurement(k));
        let error: Vec<f64> = planned.iter().zip(&measured).map(|(p, m)| p - m).collect();
        let points = [&planned[..], &measured, &error, &[]].map(Point::at);
        let points: Vec<Point> = points.into_iter().collect();
        controller_state(Kind::LittleEndian, stamp(k), &NAMES, &points, false, None)
    });
    let (found, _) = paths(&log, "");
    for expected in ["reference.positions", "feedback.positions", "error.positions"] {
        for place in 0..2 {
            let path = format!("/state.{expected}[{place}].@rad2deg");
            assert!(found.contains(&path), "{path} in {found:?}");
        }
    }
}

#[test]
fn a_layout_of_interfaces_counts_joints_and_their_values() {
    let (found, _) = paths_beside_a_plan("control_msgs/msg/DynamicJointState", |k, q| {
        let of = |q: f64| [("velocity", 0.0), ("position", q), ("valve_command", 0.5)];
        dynamic(Kind::LittleEndian, stamp(k), &[("a", &of(q[0])), ("b", &of(q[1])[1..])])
    });
    let expected = [
        ".interface_values[0].values[0].@rad2deg",
        ".interface_values[0].values[1].@rad2deg",
        ".interface_values[0].values[2]",
        ".interface_values[1].values[0].@rad2deg",
        ".interface_values[1].values[1]",
    ];
    assert_eq!(ends_of(&found), expected);
}

#[test]
fn a_layout_of_joint_states_of_foxglove_asks_for_names() {
    let mut log = Log::of_plan();
    log.add(Channel::json("/state", "foxglove.JointStates"), 0..SAMPLES, |k| {
        let q = measurement(k);
        let joint = |name: &str, q: f64| format!("{{\"name\":\"{name}\",\"position\":{q:?}}}");
        // Their order changes, which the names make good.
        let joints = if k % 2 == 0 {
            [joint("a", q[0]), joint("b", q[1])]
        } else {
            [joint("b", q[1]), joint("a", q[0])]
        };
        format!("{{\"joints\":[{}]}}", joints.join(",")).into_bytes()
    });
    let (found, _) = paths(&log, "");
    let expected = [".joints[:]{name==\"a\"}.position.@rad2deg", ".joints[:]{name==\"b\"}.position.@rad2deg"];
    assert_eq!(ends_of(&found), expected);
}

#[test]
fn a_layout_of_an_array_without_names_counts_its_places() {
    let mut log = Log::default();
    add_joint_state(&mut log, "/joint_states", measurement);
    let channel = Channel::cdr("/plan/of arm", "std_msgs/msg/Float64MultiArray");
    log.add(channel, 0..SAMPLES, |k| array(Kind::LittleEndian, &plan(k)));
    log.messages.sort_by_key(|message| message.log_ns);
    let (found, _) = paths(&log, " --joints a,b");
    assert!(found.contains(&"\"/plan/of arm\".data[1].@rad2deg".to_owned()), "{found:?}");
}

#[test]
fn joints_that_change_places_are_left_out_of_a_layout_and_said() {
    let (found, said) = paths_beside_a_plan("sensor_msgs/msg/JointState", |k, q| {
        let (names, q) = if k % 2 == 0 { (["a", "b"], [q[0], q[1]]) } else { (["b", "a"], [q[1], q[0]]) };
        joint_state(Kind::LittleEndian, stamp(k), &names, &q, &[])
    });
    assert_eq!(ends_of(&found), Vec::<&str>::new());
    assert!(found.contains(&"/planned/joint_states.position[0].@rad2deg".to_owned()), "{found:?}");
    assert!(said.contains("remark: joints-change") && said.contains("/state change places"), "{said}");
}

#[test]
fn two_logs_of_other_joints_give_two_layouts_and_the_caller_chooses() {
    let (all, _) = paths(&plain_log(), "");
    let (one, _) = paths(&plain_log(), " --joints b");
    assert_eq!(all.len(), 4);
    assert_eq!(one, ["/joint_states.position[1].@rad2deg", "/planned/joint_states.position[1].@rad2deg"]);
}
