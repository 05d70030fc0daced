//! What a trajectory controller of ROS 2 refuses, and that nothing we write to be sent is refused.
//!
//! The rules are those of `JointTrajectoryController::validate_trajectory_msg` in the file
//! `joint_trajectory_controller/src/joint_trajectory_controller.cpp` of `ros-controls/ros2_controllers` (August 2026), with its
//! parameters as they are unless somebody sets them: no partial goals, no speed at the end, no integration.

use std::path::Path;

use crate::{
    log_write::decode::{Value, decode},
    support::{clean, json, scratch},
};

/// Joints of the controller.
const JOINTS: [&str; 6] = ["J1", "J2", "J3", "J4", "J5", "J6"];

/// The controller's clock, ns: later than any log.
const NOW_NS: i64 = 1_900_000_000_000_000_000;

/// A rule, in the controller's order, and whether a message keeps it.
type Rule = (&'static str, fn(&Value) -> bool);

fn points(message: &Value) -> &[Value] {
    message.at("points").list()
}

fn sized(message: &Value, field: &str, may_be_empty: bool) -> bool {
    let joints = message.at("joint_names").list().len();
    points(message).iter().all(|point| {
        let count = point.at(field).list().len();
        count == joints || (may_be_empty && count == 0)
    })
}

const RULES: [Rule; 13] = [
    ("it names as many joints as the controller has: no partial goals", |message| {
        message.at("joint_names").list().len() == JOINTS.len()
    }),
    ("it names joints", |message| !message.at("joint_names").list().is_empty()),
    ("it has points", |message| !points(message).is_empty()),
    ("every joint is one of the controller's", |message| {
        message.at("joint_names").texts().iter().all(|name| JOINTS.contains(name))
    }),
    (
        "no joint moves at the last point by more than the float's epsilon (since pull request 834)",
        |message| {
            let last =
                points(message).last().map(|point| point.at("velocities").numbers()).unwrap_or_default();
            last.iter().all(|speed| speed.abs() <= f64::from(f32::EPSILON))
        },
    ),
    ("it starts when it is received, or does not end in the past", |message| {
        let stamp_ns = message.at("header.stamp").time_ns();
        let last_ns = points(message).last().map_or(0, |point| point.at("time_from_start").time_ns());
        stamp_ns == 0 || stamp_ns + last_ns >= NOW_NS
    }),
    ("times of points increase strictly", |message| {
        let times: Vec<i64> = points(message).iter().map(|p| p.at("time_from_start").time_ns()).collect();
        times.windows(2).all(|pair| pair[0] < pair[1])
    }),
    ("every point has a position for each joint", |message| sized(message, "positions", false)),
    ("velocities are of each joint or of none", |message| sized(message, "velocities", true)),
    ("accelerations are of each joint or of none", |message| sized(message, "accelerations", true)),
    ("there are no efforts without an effort interface", |message| {
        points(message).iter().all(|point| point.at("effort").list().is_empty())
    }),
    // `Trajectory::sample` chooses the interpolation by the fields of both neighbours: all points are to have the same.
    ("all points hold the same fields", |message| {
        let fields =
            |point: &Value| ["velocities", "accelerations"].map(|field| point.at(field).list().len());
        points(message).windows(2).all(|pair| fields(&pair[0]) == fields(&pair[1]))
    }),
    ("every number is finite", |message| {
        let fields = ["positions", "velocities", "accelerations"];
        points(message).iter().all(|point| {
            fields.iter().all(|field| point.at(field).numbers().iter().all(|number| number.is_finite()))
        })
    }),
];

/// The trajectory in a log.
fn trajectory(path: &Path) -> Value {
    let bytes = std::fs::read(path).unwrap();
    let sent = mcap::MessageStream::new(&bytes)
        .unwrap()
        .map(Result::unwrap)
        .find(|message| message.channel.topic == "/arm_controller/joint_trajectory")
        .unwrap();
    decode(&sent)
}

#[test]
fn what_is_to_be_sent_keeps_every_rule_of_the_controller() {
    let folder = scratch();
    let folder = folder.path();
    clean(folder, "plan task-1.toml --times 0,7.744,15.307,22.863,30.976,38.72 -o plan.mcap");
    clean(folder, "simulate plan.mcap -o run.mcap --plant backlash");
    clean(folder, "replan run.mcap --evaluations 1000 -o next.mcap");
    clean(folder, "replan run.mcap -o kept.mcap --keep-plan");
    clean(folder, "export run.mcap --csv -o run.csv");
    json(folder, "replan run.csv --task task-1.toml --keep-plan -o samples.mcap");
    for log in ["plan.mcap", "next.mcap", "kept.mcap", "samples.mcap"] {
        let message = trajectory(&folder.join(log));
        for (rule, keeps) in RULES {
            assert!(keeps(&message), "{log}: {rule}");
        }
        // The arm stands at its first point until the trajectory is received.
        let first = &points(&message)[0];
        assert_eq!(first.at("time_from_start").time_ns(), 0);
        assert!(first.at("velocities").numbers().iter().all(|speed| speed.abs() < 1e-12));
    }
    assert!(trajectory(&folder.join("next.mcap")) != trajectory(&folder.join("plan.mcap")));
    // A plan that is known by its samples alone tells accelerations roughly: quintics through them jerk.
    let accelerations =
        |log: &str| points(&trajectory(&folder.join(log)))[0].at("accelerations").list().len();
    assert_eq!(["kept.mcap", "samples.mcap"].map(accelerations), [JOINTS.len(), 0]);
}
