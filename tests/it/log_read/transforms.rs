//! A tool whose plan and measurement are transforms between frames, among those of the robot.

use serde_json::json;

use super::{
    cdr::{Cdr, Kind},
    poses::{INSTANTS, assert_truth, channel, measured, numbers, planned, reported},
    *,
};

/// Frame, parent and pose.
type Transform = (&'static str, &'static str, [f64; 7]);

/// What the robot sends at an instant: its links, the plan of its tool, and where a tracker sees it.
fn sent(k: i64) -> [Transform; 4] {
    let link = [0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 1.0];
    [
        ("boom", "base", link),
        ("tool_plan", "base", planned(k)),
        ("tool", "base", measured(k)),
        ("hook", "boom", link),
    ]
}

fn tf(topic: &str) -> Channel {
    let part = "MSG: geometry_msgs/TransformStamped\nstd_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n";
    let turn = "MSG: geometry_msgs/Transform\ngeometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n";
    let vector = "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";
    let root = "geometry_msgs/TransformStamped[] transforms\n";
    channel(topic, "tf2_msgs/msg/TFMessage", root, &[part, turn, vector])
}

fn message(ns: i64, transforms: &[Transform]) -> Vec<u8> {
    Cdr::message(Kind::LittleEndian, |cdr| {
        cdr.list(transforms, |cdr, (frame, parent, pose)| {
            cdr.time(ns);
            cdr.text(parent);
            cdr.text(frame);
            numbers(cdr, pose);
        });
    })
}

/// Every instant in two messages, as two nodes send them.
fn log_of(topic: &str) -> Log {
    let mut log = Log::default();
    let channel = log.channel(tf(topic));
    for k in 0..INSTANTS {
        let (links, tools) = (sent(k), sent(k));
        log.send(channel, stamp(k), message(stamp(k), &links[..2]));
        log.send(channel, stamp(k), message(stamp(k), &tools[2..]));
    }
    log
}

#[test]
fn transforms_are_poses_of_the_frames_that_are_named() {
    let log = log_of("/tf");
    for [plan, came] in [["/tf:tool_plan", "/tf:tool"], ["/tf:tool_plan@base", "/tf:/tool@base"]] {
        let report = reported(&log, options(&[plan], &[came], &[])).unwrap();
        assert_truth(&report);
        assert_eq!(report.source.planned_field, "tool_plan@base");
        assert_eq!(report.source.measured_field, "tool@base");
    }
}

#[test]
fn transforms_against_stamped_poses() {
    let mut log = log_of("/tf");
    let plan = |k| poses::pose_stamped(stamp(k), planned(k));
    log.add(poses::stamped("/planned/tool_pose"), 0..INSTANTS, plan);
    assert_truth(&reported(&log, options(&["/planned/tool_pose"], &["/tf:tool"], &[])).unwrap());
}

#[test]
fn transforms_in_json_are_read_alike() {
    let mut log = Log::default();
    let foxglove = Channel { type_name: "foxglove.FrameTransforms".into(), ..tf("/tf") };
    log.add(foxglove.with_schema("jsonschema", "{}").encoded("json"), 0..INSTANTS, |k| {
        let all = sent(k).map(|(frame, parent, [x, y, z, qx, qy, qz, qw])| {
            json!({
                "timestamp": {"sec": stamp(k) / 1_000_000_000, "nsec": stamp(k) % 1_000_000_000},
                "parent_frame_id": parent, "child_frame_id": frame,
                "translation": {"x": x, "y": y, "z": z},
                "rotation": {"x": qx, "y": qy, "z": qz, "w": qw},
            })
        });
        json!({ "transforms": all }).to_string().into_bytes()
    });
    assert_truth(&reported(&log, options(&["/tf:tool_plan"], &["/tf:tool"], &[])).unwrap());
}

#[test]
fn poses_of_foxglove_in_a_frame_are_read_as_stamped_ones() {
    let mut log = Log::default();
    let named = |topic| channel(topic, "foxglove.PoseInFrame", "", &[]);
    let ids = ["/planned/tool", "/tool"]
        .map(|topic| log.channel(named(topic).with_schema("jsonschema", "{}").encoded("json")));
    for k in 0..INSTANTS {
        for (id, [x, y, z, qx, qy, qz, qw]) in ids.into_iter().zip([planned(k), measured(k)]) {
            let message = json!({
                "timestamp": {"sec": stamp(k) / 1_000_000_000, "nsec": stamp(k) % 1_000_000_000},
                "frame_id": "base",
                "pose": {
                    "position": {"x": x, "y": y, "z": z},
                    "orientation": {"x": qx, "y": qy, "z": qz, "w": qw},
                },
            });
            log.send(id, stamp(k), message.to_string().into_bytes());
        }
    }
    assert_truth(&reported(&log, ReadOptions::default()).unwrap());
}

#[test]
fn what_a_topic_of_transforms_lacks_is_said_with_what_it_has() {
    let log = log_of("/tf");
    let said = |plan: &str, came: &str| error(&log, &options(&[plan], &[came], &[]));
    let present = "boom@base, tool_plan@base, tool@base, hook@boom";
    // No frame, one that is there only by way of another, one with a typing error.
    let several = said("/tf", "/tf:tool");
    assert!(several.contains("several transforms; it has") && several.contains(present), "{several}");
    let chained = said("/tf:tool_plan", "/tf:hook@base");
    assert!(chained.contains("no transform of \"hook@base\"") && chained.contains(present), "{chained}");
    assert!(chained.contains("not put together from others"), "{chained}");
    let mistyped = said("/tf:tool_plam", "/tf:tool");
    assert!(mistyped.contains("did you mean \"tool_plan\""), "{mistyped}");
    // Of two frames the difference is that of the frames.
    let apart = said("/tf:tool_plan", "/tf:hook");
    assert!(apart.contains("the plan is tool_plan@base, the measurement hook@boom"), "{apart}");
    assert!(apart.contains(present), "{apart}");
}

#[test]
fn transforms_are_never_chosen_by_themselves() {
    let log = log_of("/tf");
    let alone = error(&log, &ReadOptions::default());
    assert!(alone.contains("/tf (tf2_msgs/msg/TFMessage, 1200 messages)"), "{alone}");
    let mut both = plain_log();
    both.add(tf("/planned/tf"), 0..SAMPLES, |k| message(stamp(k), &sent(k)));
    assert_eq!(joints(&read(&both).planned), NAMES);
}
